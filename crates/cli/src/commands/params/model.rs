//! Whether a model accepts new numbers.

use std::cell::Cell;
use std::path::{Path, PathBuf};

use blocksim_block::CodePolicy;
use blocksim_block::problem::Problem;
use blocksim_diagram::{Reader, SourceFile, Sources, compile};
use blocksim_params::{Change, quantities};

use crate::commands::tell;
use crate::disk::{Disk, readable};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::terminal::console::Console;
use crate::terminal::render;
use crate::trust::{Plugins, is_about_trust};

/// The disk, with other texts for some of its files.
struct Instead<'a> {
    disk: Disk,
    /// By canonical paths.
    texts: Vec<(PathBuf, &'a str)>,
    read: Cell<bool>,
}

impl Reader for Instead<'_> {
    fn read(&self, path: &Path) -> Result<String, String> {
        if let Some((_, text)) = self.texts.iter().find(|(known, _)| is_file(path, known)) {
            self.read.set(true);
            return Ok((*text).to_owned());
        }
        self.disk.read(path)
    }

    fn code(&self) -> &dyn CodePolicy {
        self.disk.code()
    }
}

fn is_file(path: &Path, canonical: &Path) -> bool {
    path.canonicalize().is_ok_and(|path| path == canonical)
}

/// Compiles a model with these texts in the place of those of the set. Problems are told with the changed cells that they may
/// be about.
///
/// # Errors
/// If the model does not read the set, or has errors with it.
pub fn sound(
    model: &Path,
    set: &Path,
    texts: &[(PathBuf, String)],
    edits: &[Change],
    console: Console,
) -> Result<(), Failure> {
    readable(model)?;
    let path = set.canonicalize()?;
    let canonical = texts.iter().map(|(path, text)| Ok((path.canonicalize()?, text.as_str())));
    let texts = canonical.collect::<Result<Vec<_>, std::io::Error>>()?;
    let (disk, is_changed) = (Disk::with(Plugins::looking()), !texts.is_empty());
    let reader = Instead { disk, texts, read: Cell::new(false) };
    let sources = Sources::new(&reader);
    let compiled = compile(&sources, model, &[]);
    let files = sources.all();
    // That a plug-in is not trusted says nothing about the numbers.
    let problems = compiled.problems.into_iter().filter(|problem| !is_about_trust(problem));
    let problems: Vec<Problem> = problems.map(|problem| with_cells(problem, &files, &path, edits)).collect();
    if is_changed && !reader.read.get() {
        let said = format!("`{}` does not read `{}`", model.display(), set.display());
        return Err(Failure::new(Exit::Model, "usage", said)
            .help("name the model that reads the set, or leave --model out"));
    }
    if render::errors(&problems) > 0 {
        return Err(Failure::of(Exit::Model, problems, files));
    }
    tell(&problems, &files, console)?;
    Ok(())
}

/// Notes which changed cells a problem may be about: those of the place in the set, or of the names in the
/// expression that it points to.
fn with_cells(mut problem: Problem, files: &[SourceFile], set: &Path, edits: &[Change]) -> Problem {
    let mut notes = Vec::new();
    for label in &problem.labels {
        let Some(file) = files.get(label.place.file.0 as usize) else { continue };
        let at = label.place.span.start;
        let known = if is_file(&file.path, set) { quantities(&file.text) } else { Ok(Vec::new()) };
        let known = known.unwrap_or_default();
        let here = known.iter().find(|quantity| quantity.place.contains(&at));
        let here = here.map(|quantity| quantity.path.as_str());
        let expression = file.text.get(label.place.span.clone()).unwrap_or_default();
        for edit in edits.iter().filter(|edit| here == Some(&edit.path) || speaks_of(expression, &edit.path))
        {
            let Some(spot) = &edit.cell else { continue };
            let note =
                format!("changed in the workbook: {}, cell {} (`{}`)", spot.sheet, spot.cell, edit.path);
            if !notes.contains(&note) {
                notes.push(note);
            }
        }
    }
    problem.notes.extend(notes);
    problem
}

/// Whether an expression has a name such as `axis.motor.inertia` that may mean `axis1.motor.inertia`: inside a
/// subsystem the first word is that of its parameter.
fn speaks_of(expression: &str, path: &str) -> bool {
    let names = expression.split(|c: char| !(c.is_alphanumeric() || "_.[]".contains(c)));
    let mut below = names.filter_map(|name| Some(name.split_once('.')?.1));
    below.any(|below| {
        !below.is_empty()
            && path.strip_suffix(below).is_some_and(|head| head.is_empty() || head.ends_with('.'))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_inside_subsystems_mean_quantities_of_the_set() {
        assert!(speaks_of("2 * axis.motor.inertia", "axis1.motor.inertia"));
        assert!(speaks_of("\"robot.general.mass\"", "general.mass"));
        assert!(!speaks_of("axis.motor.inertia", "axis1.motor.damping"));
        assert!(!speaks_of("body.mass", "link1.overmass"));
        assert!(!speaks_of("mass", "link1.mass") && !speaks_of("", "link1.mass"));
    }
}
