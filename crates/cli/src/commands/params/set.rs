use std::path::{Path, PathBuf};

use blocksim_block::problem::Problem;
use blocksim_diagram::{Found, SourceFile, Sources, Target, compile, find, spelled, targets};

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

/// Another value of a parameter in the text that holds it, which the model accepts.
pub struct Edit {
    /// The file that holds it.
    pub path: PathBuf,
    /// Its text as it is.
    pub old: String,
    /// Its text with the value.
    pub new: String,
    /// The parameter, what is written for it, and what is to be.
    name: String,
    written: String,
    value: String,
    /// What is to be said of it all the same.
    problems: Vec<Problem>,
    files: Vec<SourceFile>,
}

impl Edit {
    /// What is written there yet.
    pub fn written(&self) -> &str {
        &self.written
    }

    /// What is done, in a line.
    pub fn told(&self) -> String {
        let Edit { path, name, written, value, .. } = self;
        if self.old == self.new {
            return format!("{}: `{name}` is {value} already", path.display());
        }
        format!("{}: `{name}` was {written}, is {value}", path.display())
    }
}

/// Writes another value of a parameter into the text that holds it, if the model accepts it.
pub fn set(args: &SetArgs, console: Console) -> Outcome {
    let edit = edit(&args.model, &args.target, &args.value, args.all, console)?;
    if edit.old == edit.new {
        console.data(&format!("{}\n", edit.told()))?;
        return Ok(Exit::Done);
    }
    tell(&edit.problems, &edit.files, console)?;
    console.data(&difference(&edit.path, &edit.old, &edit.new))?;
    if args.dry_run {
        console.say("nothing was written");
        return Ok(Exit::Done);
    }
    write_file(&edit.path, edit.new.as_bytes(), true)?;
    console.say(&edit.told());
    Ok(Exit::Done)
}

/// What is to be written so that a parameter has another value; `all` says that several parts of the model may change with it.
///
/// # Errors
/// If there is no such parameter, or the model refuses the value.
pub fn edit(model: &Path, name: &str, value: &str, all: bool, console: Console) -> Result<Edit, Failure> {
    readable(model)?;
    crate::loaded::tell_builds();
    let mut disk = Overlaid { disk: Disk::with(Plugins::looking()), ..Overlaid::default() };
    let sources = Sources::new(&disk);
    let (known, problems) = targets(&sources, model);
    let files = sources.all();
    let refuse = |said: &str, help: &str| Err(Failure::usage(said).help(help).last("nothing was written"));
    let target = match find(&known, name) {
        Found::One(one) => one,
        Found::Several(several) => {
            let names: Vec<&str> = several.iter().take(5).map(|target| target.name.as_str()).collect();
            let said = format!("`{name}` holds {}", plural(several.len(), "value"));
            return refuse(&said, &format!("name one of them, such as {}", names.join(", ")));
        }
        Found::Nothing(help) => {
            tell(&problems, &files, console)?;
            return Err(unknown(model, name, &help));
        }
    };
    let Some(file) = files.get(target.site.place.file.0 as usize) else {
        return Err(Failure::told(Exit::Files));
    };
    if target.sharers > 1 && !all {
        let said = format!("{} parts of the model are made of `{}`", target.sharers, file.path.display());
        return refuse(
            &said,
            &format!(
                "add --all to change all of them, or set one of them for a run: --set {}=...",
                target.name
            ),
        );
    }
    let value = match spelled(target, value) {
        Ok(value) => value,
        Err((said, help)) => return refuse(&said, &help),
    };
    let (path, old) = (file.path.clone(), file.text.to_string());
    let new = changed(&old, target, &value);
    let made = |problems, files| Edit {
        path: path.clone(),
        old: old.clone(),
        new: new.clone(),
        name: target.name.clone(),
        written: target.written.clone(),
        value: value.clone(),
        problems,
        files,
    };
    if new == old {
        return Ok(made(Vec::new(), Vec::new()));
    }
    disk.texts.insert(path.clone(), new.clone());
    let sources = Sources::new(&disk);
    let (is_diagram, problems) = match blocksim_syntax::read(&new) {
        Ok(_) if is_set(&sources, model) => (false, targets(&sources, model).1),
        _ => (true, compile(&sources, model, &[]).problems),
    };
    // That a plug-in is not trusted says nothing about the value.
    let problems: Vec<Problem> = problems.into_iter().filter(|problem| !is_about_trust(problem)).collect();
    let found = errors(&problems);
    if found > 0 {
        let what = if is_diagram { "the model" } else { "the set" };
        let last = format!(
            "{what} has {} with `{}` = {value}; nothing was written",
            plural(found, "error"),
            target.name
        );
        return Err(Failure::of(Exit::Model, problems, sources.all()).last(last));
    }
    // That nothing reads another parameter has nothing to do with this one.
    let about = |problem: &Problem| {
        problem.code != "unused_parameter" || problem.message.contains(&format!("`{}`", target.name))
    };
    let problems = problems.into_iter().filter(about).collect();
    Ok(made(problems, sources.all()))
}

/// The text with another value at the place of the target.
fn changed(text: &str, target: &Target, new: &str) -> String {
    let site = &target.site;
    let mut text = text.to_owned();
    text.replace_range(site.place.span.clone(), &format!("{}{new}{}", site.before, site.after));
    text
}

/// Whether the file is a set of values, which cannot be compiled.
fn is_set(sources: &Sources, model: &Path) -> bool {
    let text = sources.open(model).map(|file| sources.file(file).text);
    text.is_ok_and(|text| blocksim_syntax::read(&text).is_ok_and(|root| root.word() != Some("Diagram")))
}
