//! What a run was, for the head of the page and the table of parameters.

use std::path::Path;

use blocksim_diagram::fingerprint;
use blocksim_numbers::format::{count, duration, fixed, significant, simulated};
use blocksim_recording::{Ended, MOST_TEXT, Manifest, Run, limited_bytes, limited_text};
use blocksim_report::{Report, Rows};

use crate::running::solver;

/// Adds title, facts, parameters and warnings.
pub fn add(run: &Run, path: &Path, report: &mut Report) {
    let mut fact = |name: &str, value: String| report.facts.push((name.to_owned(), value));
    fact("run", run.name());
    if let Some(manifest) = run.manifest() {
        if let Some(name) = Path::new(&manifest.model.path).file_stem() {
            report.title = name.to_string_lossy().into_owned();
        }
        fact("model", manifest.model.path.clone());
        fact("started (UTC)", manifest.started.replace('T', " ").replace('Z', ""));
        fact("ended", ended(&manifest.ended));
        let speed = manifest.simulated_time / manifest.wall_time;
        let speed = if speed.is_finite() && speed > 0.0 {
            format!(" ({} times real time)", significant(speed, 3))
        } else {
            String::new()
        };
        // Of a run that was ended by force nobody wrote how far it came.
        let simulated = match (&manifest.ended, run.span()) {
            (Ended::Unfinished, Some((_, end))) => format!("until {} s at least", fixed(end, 3)),
            _ => {
                format!("{} in {}{speed}", simulated(manifest.simulated_time), duration(manifest.wall_time))
            }
        };
        fact("simulated", simulated);
        fact("solver", solver::described(&manifest.solver));
        let counts = manifest.counts;
        fact("work", format!("{} steps, {} rejected", count(counts.steps), count(counts.rejected)));
        fact("program", format!("{} {}", manifest.program.name, manifest.program.version));
        report.parameters = parameters(manifest);
        report.tables = lists(manifest);
        report.warnings.extend(changed(manifest));
    }
    let rows: u64 = (0..run.rates().len()).map(|base| run.rows(base)).max().unwrap_or(0);
    report
        .facts
        .push(("recorded".to_owned(), format!("{} signals, {} rows", run.signals().len(), count(rows))));
    if run.span().is_none() {
        report.warnings.push("This run has no values.".to_owned());
    }
    report.warnings.extend(told_in_log(path));
}

fn ended(ended: &Ended) -> String {
    match ended {
        Ended::Complete => "at stop time".to_owned(),
        Ended::Stopped { reason } => format!("stopped: {reason}"),
        Ended::Interrupted => "interrupted".to_owned(),
        Ended::Failed { reason } => format!("failed: {reason}"),
        Ended::Unfinished => "not at its end".to_owned(),
    }
}

fn parameters(manifest: &Manifest) -> Rows {
    let rows = manifest.overrides.iter().map(|set| vec![set.path.clone(), set.value.clone()]).collect();
    Rows { head: ["set for this run", "value"].map(str::to_owned).to_vec(), rows }
}

/// Variants and files, which are many.
fn lists(manifest: &Manifest) -> Vec<(String, Rows)> {
    let table = |title: &str, head: [&str; 2], rows: Vec<Vec<String>>| {
        (title.to_owned(), Rows { head: head.map(str::to_owned).to_vec(), rows })
    };
    let variants = manifest.variants.iter().map(|v| vec![v.variant.clone(), v.choice.clone()]).collect();
    let files = std::iter::once(&manifest.model).chain(&manifest.files);
    let files = files.map(|file| vec![file.path.clone(), file.hash.clone()]).collect();
    let mut lists = vec![
        table("variants", ["variant", "choice"], variants),
        table("files and their fingerprints", ["file", "fingerprint"], files),
    ];
    lists.retain(|(_, rows)| !rows.rows.is_empty());
    lists
}

/// Files that are not what they were.
fn changed(manifest: &Manifest) -> Option<String> {
    let files = std::iter::once(&manifest.model).chain(&manifest.files);
    let differs = |path: &str, known: &str| {
        limited_bytes(Path::new(path), MOST_TEXT)
            .is_ok_and(|bytes| fingerprint(&bytes) != known && !known.is_empty())
    };
    let changed: Vec<&str> =
        files.filter(|file| differs(&file.path, &file.hash)).map(|file| file.path.as_str()).collect();
    let shown = changed.iter().take(4).copied().collect::<Vec<_>>().join(", ");
    match changed.len() {
        0 => None,
        n if n > 4 => Some(format!("Changed since the run: {shown} and {} more files.", n - 4)),
        _ => Some(format!("Changed since the run: {shown}.")),
    }
}

/// First lines of the warnings in `log.txt`.
fn told_in_log(run: &Path) -> Vec<String> {
    let Ok(log) = limited_text(&run.join("log.txt"), MOST_TEXT) else { return Vec::new() };
    let warnings = log.lines().filter(|line| line.starts_with("warning"));
    warnings.take(20).map(|line| line.split_once(": ").map_or(line, |(_, said)| said).to_owned()).collect()
}
