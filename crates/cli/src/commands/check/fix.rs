//! `blocksim check --fix`: the changes that problems carry, written into the texts.

use std::path::PathBuf;

use blocksim_block::problem::Problem;
use blocksim_diagram::{Options, Reader, SourceFile, Sources, Units, compile_with};

use crate::args::model::{CheckArgs, Format, ModelArgs};
use crate::disk::{Disk, Overlaid, readable, write_file};
use crate::failure::Failure;
use crate::loaded::tell_builds;
use crate::terminal::console::Console;
use crate::terminal::diff::difference;
use crate::terminal::render::plural;
use crate::trust::{Plugins, Purpose};

/// What is mended may show what was hidden behind it; so often is looked anew.
const ROUNDS: usize = 20;

/// What became of the edits of all files.
#[derive(Default)]
struct Outcome {
    mended: Overlaid,
    count: usize,
    /// Files whose edits contradict each other.
    contradictory: Vec<PathBuf>,
}

/// Writes the changes that problems carry, and shows them; all files of a model or none.
///
/// # Errors
/// If a file cannot be read or written.
pub fn fix(args: &CheckArgs, console: Console) -> Result<(), Failure> {
    readable(&args.model.model)?;
    tell_builds();
    let outcome = outcome(&args.model, args.units.into());
    for path in &outcome.contradictory {
        console.say(&format!(
            "`{}` is left as it is: two changes meet at one place\n  = help: fix one of them by hand, then run it again",
            path.display()
        ));
    }
    let is_data = args.output_format == Format::Json;
    for (path, text) in &outcome.mended.texts {
        let Ok(old) = Disk::default().read(path) else { continue };
        if !is_data {
            console.data(&difference(path, &old, text))?;
        }
        write_file(path, text.as_bytes(), true)?;
    }
    if outcome.count > 0 {
        let files = plural(outcome.mended.texts.len(), "file");
        console.say(&format!("fixed {} in {files}", plural(outcome.count, "problem")));
    }
    Ok(())
}

/// Mends texts in memory until no problem carries a change any more.
fn outcome(model: &ModelArgs, units: Units) -> Outcome {
    let mut outcome = Outcome::default();
    outcome.mended.disk = Disk::with(Plugins::of(model.plugins, Purpose::Look));
    for _ in 0..ROUNDS {
        let sources = Sources::new(&outcome.mended);
        let options = Options { overrides: &model.set, units, ..Options::default() };
        let problems = compile_with(&sources, &model.model, &options).problems;
        let files = sources.all();
        let mut changed = Vec::new();
        for file in &files {
            // What stands on the command line is no file.
            let is_file =
                outcome.mended.disk.has_read(&file.path) || outcome.mended.texts.contains_key(&file.path);
            if is_file && !outcome.contradictory.contains(&file.path) {
                changed.extend(mended(file, &files, &problems).map(|found| (file.path.clone(), found)));
            }
        }
        if changed.is_empty() {
            break;
        }
        for (path, found) in changed {
            match found {
                Ok((text, count)) => {
                    outcome.count += count;
                    outcome.mended.texts.insert(path, text);
                }
                Err(Contradiction) => outcome.contradictory.push(path),
            }
        }
    }
    // A file whose later changes contradict each other keeps none of the earlier ones.
    outcome.mended.texts.retain(|path, _| !outcome.contradictory.contains(path));
    outcome
}

/// Two changes of the same place.
#[derive(Debug, PartialEq, Eq)]
struct Contradiction;

/// The text of a file with the changes of its problems, and how many there are; `None` without any.
fn mended(
    file: &SourceFile,
    files: &[SourceFile],
    problems: &[Problem],
) -> Option<Result<(String, usize), Contradiction>> {
    let edits = problems.iter().flat_map(Problem::remedies);
    let mut edits: Vec<_> = edits
        .filter(|edit| files.get(edit.place.file.0 as usize).is_some_and(|of| of.path == file.path))
        .filter(|edit| file.text.get(edit.place.span.clone()) == Some(edit.old.as_str()))
        .map(|edit| (edit.place.span.start, edit.place.span.end, edit.new.as_str()))
        .collect();
    edits.sort_unstable();
    edits.dedup();
    if edits.is_empty() {
        return None;
    }
    let meets = |(a, b): (&(usize, usize, &str), &(usize, usize, &str))| b.0 < a.1 || b.0 == a.0;
    if edits.iter().zip(&edits[1..]).any(meets) {
        return Some(Err(Contradiction));
    }
    let mut text = file.text.to_string();
    for (start, end, new) in edits.iter().rev() {
        text.replace_range(*start..*end, new);
    }
    // A text that could be read stays one.
    if blocksim_syntax::read(&file.text).is_ok() && blocksim_syntax::read(&text).is_err() {
        return Some(Err(Contradiction));
    }
    Some(Ok((text, edits.len())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::problem::{FileId, Place};

    fn problem(span: std::ops::Range<usize>, old: &str, new: &str) -> Problem {
        let place = Place { file: FileId(0), span };
        Problem::error("syntax", "").at(&place, "").edit(place, old, new)
    }

    fn of(text: &str, problems: &[Problem]) -> Option<Result<(String, usize), Contradiction>> {
        let file = SourceFile { path: "a.ron".into(), text: text.into() };
        mended(&file, std::slice::from_ref(&file), problems)
    }

    #[test]
    fn changes_that_do_not_meet_are_all_made() {
        let problems = [problem(7..8, "2", "3"), problem(1..2, "a", "alpha"), problem(1..2, "a", "alpha")];
        assert_eq!(of("(a: 1, 2)", &problems), None.or(Some(Ok(("(alpha: 1, 3)".to_owned(), 2)))));
    }

    #[test]
    fn changes_that_meet_leave_the_text_alone() {
        let problems = [problem(1..3, "ab", "c"), problem(2..3, "b", "d")];
        assert_eq!(of("(ab)", &problems), Some(Err(Contradiction)));
        let problems = [problem(1..3, "ab", "c"), problem(1..3, "ab", "d")];
        assert_eq!(of("(ab)", &problems), Some(Err(Contradiction)));
        assert_eq!(of("(ab)", &[problem(1..3, "ab", ")")]), Some(Err(Contradiction)), "it would be no RON");
        assert_eq!(of("(ab)", &[problem(1..3, "cd", "x")]), None, "something else stands there");
    }
}
