//! The manual of errors: a page for every code that the program can show, and what stands on it is true.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use blocksim_block::problem::{Problem, Severity};
use blocksim_diagram::{Sources, compile};
use blocksim_sim::Simulation;
use blocksim_tests::{Desk, root, run};

/// Pages without a diagram that could fail here, and why.
const WITHOUT_DIAGRAM: [(&str, &str); 30] = [
    ("bare_number", "is an error by an option; the tests of the program run it"),
    ("below_floor", "is told at the end of a run, and tested with heat and with liquids"),
    ("coarse_step", "is told at the end of a run, and tested with audits"),
    ("coupling_error", "is told at the end of a run, and tested with inverters"),
    ("exists", "comes from a command; the tests of the program run it"),
    ("identify", "comes from a command; the tests of the program run it"),
    ("ignored_state", "is told at the end of a run, and tested with tolerances"),
    ("import", "comes from a command; the tests of the program run it"),
    ("law", "a mistake that no block of the library makes"),
    ("left_out", "needs a program that was built without a part"),
    ("export", "comes from a command; the tutorial about C code shows one"),
    ("linearise", "comes from a command, at points that the blocks of the library refuse before"),
    ("plugin_abi", "needs a plug-in of another version"),
    ("plugin_build", "needs a crate that does not build"),
    ("plugin_crash", "needs a plug-in that crashes; the tests of the program have many"),
    ("plugin_missing", "the path is that of the reader"),
    ("plugin_panic", "needs a plug-in that panics"),
    ("plugin_parameter", "needs a built plug-in"),
    ("plugin_symbol", "needs a library of something else"),
    ("plugin_untrusted", "needs a plug-in"),
    ("settings", "comes from the command line; the compiler refuses such numbers before"),
    ("grade", "comes from a command; the tests of the program run it"),
    ("studio", "comes from a command; the tests of the program run it"),
    ("tuning", "comes from a command; the tests of the program run it"),
    ("unreadable", "comes from a command; the tests of the program run it"),
    ("unwritable", "comes from a command; the tests of the program run it"),
    ("usage", "comes from a command; the tests of the program run it"),
    ("workbook", "comes from a command; the tests of workbooks have its words"),
    ("time_event", "a mistake that no block of the library makes"),
    ("too_many_valves", "needs a circuit of more than a hundred valves"),
];

/// Pages whose diagram fails while it runs.
const AT_RUN_TIME: [&str; 6] =
    ["block_failed", "chatter", "endless_events", "no_steady_state", "not_finite", "step_size"];

/// Pages whose diagram fails by what the command line says.
const WITH_OVERRIDE: [(&str, &str, &str); 1] = [("unknown_override", "levle=2", "level=2")];

/// Files that a page speaks of: page, name, contents. Columns of a table cannot stand in a diagram.
const BESIDE: [(&str, &str, &str); 3] = [
    ("table", "speed.csv", "time [s],speed [rad/s]\n0,0\n1,5\n1.5\n"),
    ("table", "repaired.csv", "time [s],speed [rad/s]\n0,0\n1,5\n1.5,5\n"),
    ("unknown_column", "speed.csv", "time [s],speed [rad/s]\n0,0\n1,5\n"),
];

/// Codes that a page's diagram shows beside that of the page.
const COMPANIONS: [(&str, &str); 0] = [];

struct Page {
    code: String,
    text: String,
}

impl Page {
    /// Blocks of this language, in order, with where they begin.
    fn fenced(&self, language: &str) -> Vec<(usize, &str)> {
        let (open, mut found, mut from) = (format!("```{language}\n"), Vec::new(), 0);
        while let Some(start) = self.text[from..].find(&open).map(|at| from + at) {
            let inside = start + open.len();
            let end = self.text[inside..].find("```").map_or(self.text.len(), |at| inside + at);
            found.push((start, &self.text[inside..end]));
            from = end + 3;
        }
        found
    }

    /// The first diagram below this heading.
    fn diagram(&self, heading: &str) -> Option<&str> {
        let at = self.text.find(&format!("## {heading}\n"))?;
        self.fenced("ron").into_iter().find(|(start, _)| *start > at).map(|(_, text)| text)
    }

    fn desk(&self, model: &str) -> Desk {
        let beside = BESIDE.iter().filter(|(page, ..)| *page == self.code);
        let desk = beside.fold(Desk::new(), |desk, (_, name, text)| desk.with(name, text));
        // A file whose text stands on the page itself: "where `part.ron` holds".
        let blocks = self.fenced("ron");
        let named = blocks.iter().filter_map(|(start, text)| {
            let line = self.text[..*start].trim_end().lines().last()?;
            Some((line.strip_prefix("where `")?.strip_suffix("` holds")?, *text))
        });
        named.fold(desk, |desk, (name, text)| desk.with(name, text)).with("model.ron", model)
    }
}

fn pages() -> Vec<Page> {
    let folder = root().join("docs/errors");
    let mut pages: Vec<Page> = std::fs::read_dir(folder)
        .expect("the manual of errors")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .map(|path| Page {
            code: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            text: std::fs::read_to_string(&path).expect("a page"),
        })
        .filter(|page| page.code != "README")
        .collect();
    pages.sort_by(|a, b| a.code.cmp(&b.code));
    pages
}

fn sources() -> Vec<PathBuf> {
    let (mut files, mut folders) = (Vec::new(), vec![root().join("crates")]);
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(&folder).expect("sources").map(|entry| entry.expect("an entry").path())
        {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            match path.is_dir() {
                true if !["tests", "benches", "examples", "target"].contains(&name.as_str()) => {
                    folders.push(path)
                }
                false if name.ends_with(".rs") && !name.ends_with("tests.rs") => files.push(path),
                _ => {}
            }
        }
    }
    files
}

/// The first text in quotes, if nothing but names and commas stands before it.
fn word(rest: &str) -> Option<&str> {
    let (before, rest) = rest.split_once('"')?;
    let plain = before.chars().all(|c| c.is_ascii_whitespace());
    let word = rest.split('"').next()?;
    (plain && !word.is_empty() && word.chars().all(|c| c.is_ascii_lowercase() || c == '_')).then_some(word)
}

/// All codes that stand in the sources, with a file for each.
fn codes() -> BTreeMap<String, PathBuf> {
    let mut codes = BTreeMap::new();
    for path in sources() {
        let text = std::fs::read_to_string(&path).expect("a source");
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
        let code = lines.collect::<Vec<_>>().join("\n");
        let mut add = |word: &str| {
            codes.entry(word.to_owned()).or_insert_with(|| path.clone());
        };
        for start in
            ["Problem::error(", "Problem::warning(", "NetworkProblem::new(", "SimError::new(", " code:"]
        {
            code.split(start).skip(1).filter_map(word).for_each(&mut add);
        }
        // `InterfaceError` has a function for each code.
        if path.ends_with("block/src/interface.rs") {
            code.split("Self::new(").skip(1).filter_map(word).for_each(&mut add);
        }
        // The code behind the parameter at fault.
        let second = |rest: &'_ str| {
            word(rest)
                .and_then(|first| rest.split_once(&format!("\"{first}\",")))
                .map(|(_, rest)| rest.to_owned())
        };
        // The program names its exit code first.
        let behind = |rest: &'_ str| rest.split_once(',').map(|(_, rest)| rest.to_owned());
        code.split("Failure::new(")
            .skip(1)
            .filter_map(behind)
            .for_each(|rest| word(&rest).into_iter().for_each(&mut add));
        code.split("self.error(")
            .skip(1)
            .filter_map(second)
            .for_each(|rest| word(&rest).into_iter().for_each(&mut add));
        if path.ends_with("host/src/fault.rs") || path.ends_with("block/src/code.rs") {
            code.split(": &str =").skip(1).filter_map(word).for_each(&mut add);
        }
    }
    codes
}

#[test]
fn every_code_has_its_page_and_every_page_its_code() {
    let (codes, pages) = (codes(), pages());
    let paged: BTreeSet<&str> = pages.iter().map(|page| page.code.as_str()).collect();
    let without: Vec<_> = codes.iter().filter(|(code, _)| !paged.contains(code.as_str())).collect();
    let needless: Vec<_> = paged.iter().filter(|code| !codes.contains_key(**code)).collect();
    assert!(without.is_empty(), "codes without a page: {without:?}");
    assert!(needless.is_empty(), "pages of codes that nothing shows: {needless:?}");
    assert!(codes.len() > 50, "the scan found only {}", codes.len());
    for page in &pages {
        assert!(page.text.starts_with(&format!("# {}\n\n", page.code)), "{} has another title", page.code);
    }
}

/// What the compiler says of a diagram.
fn problems(
    page: &Page,
    model: &str,
    overrides: &[&str],
) -> (Vec<Problem>, Option<blocksim_block::schedule::Schedule>, Vec<String>) {
    let desk = page.desk(model);
    let sources = Sources::new(&desk);
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    let compiled = compile(&sources, Path::new("model.ron"), &overrides);
    let places = compiled.problems.iter().map(|problem| match problem.labels.first() {
        Some(label) => {
            let file = sources.file(label.place.file);
            let before = &file.text[..label.place.span.start];
            let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
            format!("{}:{}:{column}", file.path.display(), before.matches('\n').count() + 1)
        }
        None => String::new(),
    });
    let places = places.collect();
    (compiled.problems, compiled.schedule, places)
}

/// What a page shows as the answer to its diagram, as the program would: first lines, places, notes and advice.
fn shown(page: &Page) -> Vec<String> {
    let text = page.fenced("text").into_iter().map(|(_, text)| text).next().unwrap_or_default();
    let lines = text.lines().filter_map(|line| {
        let line = line.trim_start();
        let kept = line.starts_with("error[")
            || line.starts_with("warning[")
            || line.starts_with("--> ")
            || line.starts_with("= ");
        kept.then(|| line.to_owned())
    });
    lines.collect()
}

#[test]
fn what_a_page_says_that_fails_fails_in_these_words() {
    let mut wrong = Vec::new();
    let mut looked_at = 0;
    for page in pages() {
        let later = WITHOUT_DIAGRAM.iter().any(|(code, _)| *code == page.code)
            || AT_RUN_TIME.contains(&page.code.as_str());
        let Some(model) = page.diagram("Fails").filter(|_| !later) else {
            if !later {
                wrong.push(format!("{} has no diagram that fails", page.code));
            }
            continue;
        };
        let set: Vec<&str> =
            WITH_OVERRIDE.iter().filter(|(code, ..)| *code == page.code).map(|(_, bad, _)| *bad).collect();
        let (problems, _, places) = problems(&page, model, &set);
        let said = problems.iter().zip(places).flat_map(|(problem, place)| {
            let severity = match problem.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
                Severity::Note => "note",
            };
            let first = format!("{severity}[{}]: {}", problem.code, problem.message);
            let notes = problem.notes.iter().map(|note| format!("= note: {note}"));
            let help = problem.help.iter().map(|help| format!("= help: {help}"));
            let rest: Vec<String> = notes.chain(help).collect();
            [first, format!("--> {place}")].into_iter().chain(rest).collect::<Vec<_>>()
        });
        let said: Vec<String> = said.collect();
        if said != shown(&page) {
            wrong.push(format!("{} says\n{:#?}\nbut the program\n{said:#?}", page.code, shown(&page)));
        }
        for problem in &problems {
            let companion =
                COMPANIONS.iter().any(|(code, other)| *code == page.code && *other == problem.code);
            if problem.code != page.code && !companion {
                wrong.push(format!("{} shows {} as well", page.code, problem.code));
            }
        }
        looked_at += 1;
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    assert!(looked_at > 40, "only {looked_at} pages were looked at");
}

#[test]
fn what_fails_while_it_runs_fails_in_these_words() {
    for page in pages().iter().filter(|page| AT_RUN_TIME.contains(&page.code.as_str())) {
        let model = page.diagram("Fails").unwrap_or_else(|| panic!("{} has no diagram", page.code));
        let (problems, schedule, _) = problems(page, model, &[]);
        assert!(problems.is_empty(), "{}: {problems:?}", page.code);
        let schedule = schedule.expect("a schedule");
        let refused = Simulation::new(Arc::new(schedule.clone())).err();
        let error = refused.or_else(|| run(schedule).error);
        let error = error.unwrap_or_else(|| panic!("{} does not fail", page.code));
        assert_eq!(error.code, page.code);
        let shown = shown(page).join("\n");
        let first = format!("error[{}]: {} at t = ", error.code, error.message);
        assert!(shown.starts_with(&first), "{} shows\n{shown}\nbut the program\n{first}", page.code);
        if let Some(help) = &error.help {
            assert!(
                shown.contains(&format!("= help: {help}")),
                "{} shows\n{shown}\nbut the help is\n{help}",
                page.code
            );
        }
    }
}

#[test]
fn what_a_page_says_is_repaired_compiles_and_runs() {
    let mut wrong = Vec::new();
    for page in pages() {
        let set: Vec<&str> =
            WITH_OVERRIDE.iter().filter(|(code, ..)| *code == page.code).map(|(.., good)| *good).collect();
        let heading = if set.is_empty() { "Repaired" } else { "Fails" };
        let Some(model) = page.diagram(heading) else {
            if !WITHOUT_DIAGRAM.iter().any(|(code, _)| *code == page.code) {
                wrong.push(format!("{} has no repaired diagram", page.code));
            }
            continue;
        };
        let (problems, schedule, _) = problems(&page, model, &set);
        let errors: Vec<String> =
            problems.iter().map(|problem| format!("{}: {}", problem.code, problem.message)).collect();
        let Some(schedule) = schedule.filter(|_| errors.is_empty()) else {
            wrong.push(format!("{}, repaired: {errors:?}", page.code));
            continue;
        };
        if let Err(error) = Simulation::new(Arc::new(schedule.clone())) {
            wrong.push(format!("{}, repaired: {error}", page.code));
        } else if let Some(error) = run(schedule).error {
            wrong.push(format!("{}, repaired: {error}", page.code));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn the_lists_of_exceptions_speak_of_pages_that_exist() {
    let pages = pages();
    let known: BTreeSet<&str> = pages.iter().map(|page| page.code.as_str()).collect();
    let listed = WITHOUT_DIAGRAM.iter().map(|(code, _)| *code).chain(AT_RUN_TIME);
    let listed = listed
        .chain(WITH_OVERRIDE.iter().map(|(code, ..)| *code))
        .chain(BESIDE.iter().map(|(code, ..)| *code));
    for code in listed {
        assert!(known.contains(code), "there is no page {code}");
    }
    for page in pages.iter().filter(|page| WITHOUT_DIAGRAM.iter().any(|(code, _)| *code == page.code)) {
        assert!(page.diagram("Fails").is_none(), "{} has a diagram that could be tried", page.code);
    }
}
