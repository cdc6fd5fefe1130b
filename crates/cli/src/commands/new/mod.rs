//! `blocksim new`: a project that runs at once.

mod templates;

use std::fs;
use std::io;
use std::path::Path;

use blocksim_block::shell::quoted;
use clap::ValueEnum;

use self::templates::{Template, template};
use super::plugin;
use crate::args::plugin::PluginNewArgs;
use crate::args::start::{NewArgs, TemplateName};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;

/// Results and what cargo builds do not belong into the history of a project.
const IGNORED: &str = "runs/\ntarget/\n";

/// Makes a project of a template.
///
/// # Errors
/// If it cannot be made.
pub fn new(args: &NewArgs, console: Console) -> Outcome {
    let Some(folder) = args.folder.as_deref().filter(|_| !args.list) else {
        console.data(&list())?;
        return Ok(Exit::Done);
    };
    let template = template(args.template);
    made(folder, &template, args)?;
    let mut said = format!("{}\n", folder.display());
    let names = template.files.iter().map(|file| file.name.len());
    let width = names.chain([if template.plugin.is_some() { 10 } else { 9 }]).max().unwrap_or_default();
    for file in template.files {
        said += &format!("  {:width$}  {}\n", file.name, file.about);
    }
    if let Some(language) = template.plugin {
        let source = plugin::source(language);
        said += &format!("  {:width$}  your controller: write its law in {source}\n", "controller");
    }
    said += &format!("  {:width$}  what to try\n\n", "README.md");
    said += &commands(&format!("{}/", folder.display()), &template);
    console.data(&said)?;
    Ok(Exit::Done)
}

fn list() -> String {
    let line = |name: &TemplateName| {
        let value = name.to_possible_value()?;
        let about = value.get_help().map(ToString::to_string).unwrap_or_default();
        Some(format!("{:8}{about}\n", value.get_name()))
    };
    TemplateName::value_variants().iter().filter_map(line).collect()
}

/// The three commands, with the folder before the file.
fn commands(folder: &str, template: &Template) -> String {
    let model = quoted(Path::new(&format!("{folder}{}", template.model)));
    let lines = [
        (format!("blocksim run {model}{}", template.change), "simulate"),
        (format!("blocksim graph {model}"), "draw the block diagram"),
        (format!("blocksim check {model} --watch"), "every problem, while you write"),
    ];
    let width = lines.iter().map(|(line, _)| line.len()).max().unwrap_or_default();
    lines.iter().map(|(line, about)| format!("{line:width$}  # {about}\n")).collect()
}

/// Writes the project, whole or not at all.
fn made(folder: &Path, template: &Template, args: &NewArgs) -> Result<(), Failure> {
    let failed = |error: &io::Error| {
        Failure::unwritable(format!("cannot make `{}`: {error}", folder.display()))
            .help("name a folder elsewhere")
    };
    if fs::read_dir(folder).map_or(folder.exists(), |mut entries| entries.next().is_some()) {
        let said = format!("`{}` already exists", folder.display());
        return Err(Failure::new(Exit::Files, "exists", said).help("name a new folder; nothing was changed"));
    }
    let Some(name) = folder.file_name().map(|name| name.to_string_lossy().into_owned()) else {
        let said = format!("`{}` names no folder", folder.display());
        return Err(Failure::usage(said).help("name a new folder, such as lab"));
    };
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(parent).map_err(|error| failed(&error))?;
    let partial = parent.join(format!(".{name}.{}", std::process::id()));
    let write = || -> io::Result<()> {
        fs::create_dir(&partial)?;
        for file in template.files {
            fs::write(partial.join(file.name), template.text(file))?;
        }
        fs::write(partial.join("README.md"), readme(&name, template))?;
        fs::write(partial.join(".gitignore"), IGNORED)
    };
    let with_plugin = || match template.plugin {
        Some(language) => plugin::made(
            &PluginNewArgs {
                folder: partial.join("controller"),
                kind: Some("Controller".to_owned()),
                language,
                blocksim: args.blocksim.clone(),
            },
            "controller",
            "Controller",
        ),
        None => Ok(()),
    };
    let finish = || {
        // An empty folder may stand there.
        let _ = fs::remove_dir(folder);
        fs::rename(&partial, folder).map_err(|error| failed(&error))
    };
    write().map_err(|error| failed(&error)).and_then(|()| with_plugin()).and_then(|()| finish()).inspect_err(
        |_| {
            let _ = fs::remove_dir_all(&partial);
        },
    )
}

fn readme(name: &str, template: &Template) -> String {
    format!(
        "# {name}\n\n{}\n\n```sh\n{}```\n\nResults go into `runs`. `blocksim blocks` lists the kinds of block, \
         `blocksim blocks KIND` describes one.\n",
        template.about,
        commands("", template)
    )
}
