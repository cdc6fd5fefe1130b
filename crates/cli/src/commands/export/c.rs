//! C99 of a subsystem or of a whole model.

use std::fs;

use blocksim_block::schedule::Schedule;
use blocksim_codegen::{Method, Part, Target, generate};
use blocksim_diagram::{Content, Model, ModelBlock, Sources, origins};

use crate::args::export_c::{ExportCArgs, MethodName};
use crate::commands::tell;
use crate::disk::{Disk, free, reason, write_file};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::loaded::load;
use crate::terminal::console::Console;
use crate::terminal::render::{self, plural};
use crate::trust::{Plugins, Purpose};

/// Writes code for a target, with a test against the simulation.
///
/// # Errors
/// What is wrong with the model, all that cannot be translated, and files that are there already or cannot be written.
pub(super) fn export(args: &ExportCArgs, console: Console) -> Outcome {
    let mut loaded = load(&args.model, Purpose::Run)?;
    let schedule = loaded.take_schedule("nothing was exported", console)?;
    let part = part(args, &schedule)?;
    let stem = || args.model.model.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let below = args.subsystem.as_ref().and_then(|path| path.rsplit('/').next()).map(str::to_owned);
    let target = Target {
        name: args.name.clone().or(below).or_else(stem).unwrap_or_default(),
        step: args.rate,
        method: args.method.map(|method| match method {
            MethodName::Euler => Method::Euler,
            MethodName::Rk4 => Method::Rk4,
        }),
        float: args.float,
        test_steps: args.test_steps as usize,
    };
    let made = generate(&schedule, &part, &target).map_err(|problems| {
        let last = format!("{}; nothing was exported", render::tally(&problems));
        Failure::of(Exit::Model, problems, loaded.files.clone()).last(last)
    })?;
    let files: Vec<_> = made.files.iter().map(|(name, text)| (args.out.join(name), text)).collect();
    // All or none.
    files.iter().try_for_each(|(path, _)| free(path, args.yes))?;
    fs::create_dir_all(&args.out).map_err(|error| {
        let said = format!("cannot make the folder `{}`: {}", args.out.display(), reason(&error));
        Failure::unwritable(said).help("name another folder with --out")
    })?;
    files.iter().try_for_each(|(path, text)| write_file(path, text.as_bytes(), args.yes))?;
    tell(&made.warnings, &[], console)?;
    console.data(&files.iter().map(|(path, _)| format!("{}\n", path.display())).collect::<String>())?;
    console.say(&format!(
        "{} and {} every {:?} s; {}.md shows how to compile the test, which has {}",
        plural(part.inputs.len(), "input"),
        plural(part.outputs.len(), "output"),
        args.rate,
        made.name,
        plural(made.test_steps, "step")
    ));
    if !made.functions.is_empty() && !args.float {
        console.say(&format!(
            "note: the last digit of {} is up to the mathematical library of the target",
            made.functions.join(", ")
        ));
    }
    Ok(Exit::Done)
}

/// What runs on the target.
fn part(args: &ExportCArgs, schedule: &Schedule) -> Result<Part, Failure> {
    let Some(path) = &args.subsystem else { return Ok(Part::whole(schedule)) };
    let disk = Disk::with(Plugins::of(args.model.plugins, Purpose::Run));
    let sources = Sources::new(&disk);
    let (model, _) = blocksim_diagram::model(&sources, &args.model.model, &args.model.set);
    let found = model.as_ref().and_then(|model| block(model, path).zip(Some(model)));
    match found {
        Some((block, model)) if matches!(block.content, Content::Diagram(_)) => {
            Ok(Part::subsystem(schedule, path, &block.inputs(), &block.outputs(), &origins(model)))
        }
        Some((block, _)) => {
            Err(Failure::usage(format!("`{path}` is not a subsystem but a single block ({})", block.kind))
                .help("name the subsystem around it, or put it into one"))
        }
        None => {
            let mut known = Vec::new();
            model.iter().for_each(|model| subsystems(model, &mut known));
            let help = match known.as_slice() {
                [] => "the model has none; leave `--subsystem` away to export all of it".to_owned(),
                known => format!("it has {}", known.join(", ")),
            };
            Err(Failure::usage(format!("there is no subsystem `{path}`")).help(help))
        }
    }
}

/// The block at a path.
fn block<'m>(model: &'m Model, path: &str) -> Option<&'m ModelBlock> {
    let (first, rest) = path.split_once('/').map_or((path, None), |(first, rest)| (first, Some(rest)));
    let found = model.block(first)?;
    match (rest, &found.content) {
        (None, _) => Some(found),
        (Some(rest), Content::Diagram(inside)) => block(inside, rest),
        (Some(_), _) => None,
    }
}

/// Paths of the first subsystems.
fn subsystems(model: &Model, found: &mut Vec<String>) {
    for block in &model.blocks {
        if let Content::Diagram(inside) = &block.content
            && found.len() < 12
        {
            found.push(format!("`{}`", block.path));
            subsystems(inside, found);
        }
    }
}
