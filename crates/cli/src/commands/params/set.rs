use blocksim_block::problem::Problem;
use blocksim_diagram::{Found, Sources, Target, compile, find, read_tree, spelled, targets};

use super::table::unknown;
use crate::args::params::SetArgs;
use crate::commands::tell;
use crate::disk::{Disk, Overlaid, readable, write_file};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;
use crate::terminal::diff::difference;
use crate::terminal::render::{errors, plural};
use crate::trust::{Plugins, is_about_trust};

/// Writes another value of a parameter into the text that holds it, if the model accepts it.
pub fn set(args: &SetArgs, console: Console) -> Outcome {
    readable(&args.model)?;
    crate::loaded::tell_builds();
    let mut disk = Overlaid { disk: Disk::with(Plugins::looking()), ..Overlaid::default() };
    let sources = Sources::new(&disk);
    let (all, problems) = targets(&sources, &args.model);
    let files = sources.all();
    let refuse = |said: &str, help: &str| Err(Failure::usage(said).help(help).last("nothing was written"));
    let target = match find(&all, &args.target) {
        Found::One(one) => one,
        Found::Several(several) => {
            let names: Vec<&str> = several.iter().take(5).map(|target| target.name.as_str()).collect();
            let said = format!("`{}` holds {}", args.target, plural(several.len(), "value"));
            return refuse(&said, &format!("name one of them, such as {}", names.join(", ")));
        }
        Found::Nothing(help) => {
            tell(&problems, &files, console)?;
            return Err(unknown(&args.model, &args.target, &help));
        }
    };
    let Some(file) = files.get(target.site.place.file.0 as usize) else { return Ok(Exit::Files) };
    if target.sharers > 1 && !args.all {
        let said = format!("{} parts of the model are made of `{}`", target.sharers, file.path.display());
        return refuse(
            &said,
            &format!(
                "add --all to change all of them, or set one of them for a run: --set {}=...",
                target.name
            ),
        );
    }
    let new = match spelled(target, &args.value) {
        Ok(new) => new,
        Err((said, help)) => return refuse(&said, &help),
    };
    let text = changed(&file.text, target, &new);
    if *text == *file.text {
        console.data(&format!("{}: `{}` is {new} already\n", file.path.display(), target.name))?;
        return Ok(Exit::Done);
    }
    let (path, old_text) = (file.path.clone(), file.text.clone());
    disk.texts.insert(path.clone(), text.clone());
    let sources = Sources::new(&disk);
    let (is_diagram, problems) = match read_tree(&text) {
        Ok(_) if is_set(&sources, args) => (false, targets(&sources, &args.model).1),
        _ => (true, compile(&sources, &args.model, &[]).problems),
    };
    // That a plug-in is not trusted says nothing about the value.
    let problems: Vec<Problem> = problems.into_iter().filter(|problem| !is_about_trust(problem)).collect();
    let found = errors(&problems);
    if found > 0 {
        let what = if is_diagram { "the model" } else { "the set" };
        let last = format!(
            "{what} has {} with `{}` = {new}; nothing was written",
            plural(found, "error"),
            target.name
        );
        return Err(Failure::of(Exit::Model, problems, sources.all()).last(last));
    }
    // That nothing reads another parameter has nothing to do with this one.
    let about = |problem: &Problem| {
        problem.code != "unused_parameter" || problem.message.contains(&format!("`{}`", target.name))
    };
    let problems: Vec<Problem> = problems.into_iter().filter(about).collect();
    tell(&problems, &sources.all(), console)?;
    console.data(&difference(&path, &old_text, &text))?;
    if args.dry_run {
        console.say("nothing was written");
        return Ok(Exit::Done);
    }
    write_file(&path, text.as_bytes(), true)?;
    console.say(&format!("{}: `{}` was {}, is {new}", path.display(), target.name, target.written));
    Ok(Exit::Done)
}

/// The text with another value at the place of the target.
fn changed(text: &str, target: &Target, new: &str) -> String {
    let site = &target.site;
    let mut text = text.to_owned();
    text.replace_range(site.place.span.clone(), &format!("{}{new}{}", site.before, site.after));
    text
}

/// Whether the file is a set of values, which cannot be compiled.
fn is_set(sources: &Sources, args: &SetArgs) -> bool {
    let text = sources.open(&args.model).map(|file| sources.file(file).text);
    text.is_ok_and(|text| read_tree(&text).is_ok_and(|root| root.word() != Some("Diagram")))
}
