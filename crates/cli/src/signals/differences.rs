//! What several runs are called where they stand beside each other: by what differs between them.

use std::collections::BTreeMap;
use std::path::Path;

use blocksim_diagram::{Sources, model, targets};
use blocksim_numbers::format::significant;
use blocksim_recording::Run;

use super::traces::Book;
use crate::mechanism::text::text;

/// Most values that a name tells.
const VALUES: usize = 3;
/// Longest value in a name.
const LONGEST: usize = 24;

/// What a run was made of.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Made {
    /// Title of its model.
    pub title: Option<String>,
    /// Everything that could be set, as it was.
    pub values: BTreeMap<String, String>,
    /// Solver and tolerance.
    pub solver: String,
}

impl Made {
    /// That of a run; of what has no text of its model any more, only what was set.
    fn of(run: &Run) -> Made {
        let Some(manifest) = run.manifest() else { return Made::default() };
        let mut made = Made { solver: manifest.solver.name.clone(), ..Made::default() };
        if let Some(rtol) = manifest.solver.rtol {
            made.solver.push_str(&format!(", rtol {}", significant(rtol, 3)));
        }
        if let Ok(Some(text)) = text(run.path(), manifest) {
            let sources = Sources::new(&*text.reader);
            made.title = title(&sources, &text.root, &text.overrides);
            let all = targets(&sources, &text.root).0.into_iter().filter(|target| !target.is_item);
            made.values = all.map(|target| (target.name, plain(&target.written))).collect();
        }
        made.values.extend(manifest.overrides.iter().map(|set| (set.path.clone(), plain(&set.value))));
        made
    }
}

fn title(sources: &Sources, root: &Path, overrides: &[String]) -> Option<String> {
    model(sources, root, overrides).0.and_then(|model| model.ast.title.clone())
}

/// A value as people write it on the command line: without quotes, in one line, numbers in one way.
fn plain(written: &str) -> String {
    if let Ok(number) = written.parse::<f64>() {
        return number.to_string();
    }
    written.trim_matches('"').split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Gives runs names that tell what differs between them, such as `pid.kp = 12`, in place of those of their folders, and
/// returns the title of the whole: that of the model, where they have one in common, else their names.
pub fn tell_apart(books: &mut [Book]) -> String {
    let made: Vec<Option<Made>> = books.iter().map(|book| book.run().map(Made::of)).collect();
    let names: Vec<String> = books.iter().map(|book| book.name.clone()).collect();
    let runs: Vec<&Made> = made.iter().flatten().collect();
    let labels = labels(&runs).into_iter();
    let places = (0..books.len()).filter(|&n| made[n].is_some());
    for (n, label) in places.zip(labels) {
        books[n].label = label.unwrap_or_else(|| names[n].clone());
    }
    match runs.first().and_then(|first| first.title.clone()) {
        Some(title) if runs.iter().all(|run| run.title.as_ref() == Some(&title)) => title,
        _ => names.join(", "),
    }
}

/// A name for each run; none where nothing that is known tells it from every other one.
fn labels(runs: &[&Made]) -> Vec<Option<String>> {
    let value = |run: &Made, name: &str| run.values.get(name).cloned();
    let mut names: Vec<&String> = runs.iter().flat_map(|run| run.values.keys()).collect();
    names.sort();
    names.dedup();
    let differs = |name: &&String| runs.iter().any(|run| value(run, name) != value(runs[0], name));
    let names: Vec<&String> = names.into_iter().filter(differs).collect();
    let same_solver = runs.iter().all(|run| run.solver == runs[0].solver);
    let same_title = runs.iter().all(|run| run.title == runs[0].title);
    let label = |run: &&Made| {
        let mut parts: Vec<String> = Vec::new();
        if !same_title {
            parts.extend(run.title.clone());
        } else {
            let told = names.iter().take(VALUES);
            parts.extend(told.map(|name| match value(run, name) {
                Some(value) => format!("{name} = {}", short(&value)),
                None => format!("no {name}"),
            }));
            if names.len() > VALUES {
                parts.push("...".to_owned());
            }
        }
        if !same_solver {
            parts.push(run.solver.clone());
        }
        parts.join(", ")
    };
    let labels: Vec<String> = runs.iter().map(label).collect();
    let is_own = |n: usize| labels.iter().filter(|other| **other == labels[n]).count() == 1;
    (0..labels.len())
        .map(|n| (runs.len() > 1 && !labels[n].is_empty() && is_own(n)).then(|| labels[n].clone()))
        .collect()
}

fn short(value: &str) -> String {
    if value.chars().count() <= LONGEST {
        return value.to_owned();
    }
    format!("{}…", value.chars().take(LONGEST - 1).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(title: &str, values: &[(&str, &str)]) -> Made {
        let values = values.iter().map(|(name, value)| ((*name).to_owned(), plain(value))).collect();
        Made { title: Some(title.to_owned()), values, solver: "Ode45".to_owned() }
    }

    #[test]
    fn runs_are_named_by_what_differs() {
        let a = made("Servo", &[("pid.kp", "8.0"), ("tau", "\"0.2 s\""), ("only", "1")]);
        let b = made("Servo", &[("pid.kp", "12"), ("tau", "\"0.2 s\"")]);
        let named = |runs: &[&Made]| labels(runs).into_iter().map(Option::unwrap).collect::<Vec<_>>();
        assert_eq!(named(&[&a, &b]), ["only = 1, pid.kp = 8", "no only, pid.kp = 12"]);
        assert_eq!(labels(&[&made("Servo", &[("kp", "8.0")]), &made("Servo", &[("kp", "8")])]), [None, None]);
        let other = Made { solver: "RosW3".to_owned(), ..b.clone() };
        assert_eq!(named(&[&b, &other]), ["Ode45", "RosW3"]);
        let model = made("Lift", &[("mass", "3")]);
        assert_eq!(named(&[&a, &model]), ["Servo", "Lift"]);
    }

    #[test]
    fn what_nothing_tells_apart_keeps_its_folder() {
        let a = made("Servo", &[("kp", "8")]);
        let b = made("Servo", &[("kp", "9")]);
        assert_eq!(labels(&[&a, &a.clone()]), [None, None]);
        assert_eq!(labels(&[&a, &a.clone(), &b]), [None, None, Some("kp = 9".to_owned())]);
        assert_eq!(labels(&[&a]), [None]);
    }
}
