//! Which models a folder has, and how fresh everything is.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use blocksim_diagram::fingerprint;
use blocksim_numbers::format::{duration, simulated};
use blocksim_recording::{Kept, history, limited_bytes};
use serde_json::{Value, json};

use super::model::{Shown, place, written};
use super::motion;
use super::plugins::{self, State};
use crate::args::values::RUNS;
use crate::disk::text_files;
use crate::terminal::render::plural;

/// Bytes at the beginning of a file in which it says what it is.
const BEGINNING: usize = 16_384;

/// The models of a folder and of those below it, relative to it, by name.
pub fn models(root: &Path) -> Vec<PathBuf> {
    let files = text_files(root).unwrap_or_default();
    let inside = files.into_iter().filter(|file| is_model(file));
    inside.filter_map(|file| Some(file.strip_prefix(root).ok()?.to_owned())).collect()
}

/// Whether a text is a diagram that stands alone: parts of others have ports to the outside, and no end.
fn is_model(file: &Path) -> bool {
    let mut text = vec![0; BEGINNING];
    let read = fs::File::open(file).and_then(|mut file| std::io::Read::read(&mut file, &mut text));
    text.truncate(read.unwrap_or(0));
    let text = String::from_utf8_lossy(&text);
    let code: String = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim()).collect();
    let is_diagram = code.trim_start().starts_with("Diagram");
    let has_ports = ["inputs:", "outputs:", "connectors:"].iter().any(|port| code.contains(port));
    is_diagram && (!has_ports || code.contains("simulation:"))
}

/// The model that is shown at first: one that is called as its folder, or the first.
pub fn first(root: &Path, models: &[PathBuf]) -> Option<PathBuf> {
    let name = root.canonicalize().ok()?.file_name()?.to_owned();
    let alike = models.iter().find(|model| model.file_stem() == Some(&name));
    alike.or(models.first()).cloned()
}

/// A row of the table: what it is, how it is, what is known of it, when it was written, and what leads there.
fn row(
    item: &str,
    state: &str,
    detail: String,
    time: Option<SystemTime>,
    (screen, action): (&str, &str),
) -> Value {
    let seconds = time.and_then(|time| time.duration_since(UNIX_EPOCH).ok()).map(|since| since.as_secs_f64());
    let mut row =
        json!({ "item": item, "state": state, "detail": detail, "written": seconds, "action": action });
    if !screen.is_empty() {
        row["screen"] = screen.into();
    }
    row
}

/// How fresh everything is, and what can be done next.
pub fn rows(root: &Path, file: &Path, shown: &Shown) -> (Vec<Value>, Vec<[String; 2]>) {
    let (of_model, others): (Vec<_>, Vec<_>) =
        shown.files.iter().cloned().partition(|(path, _)| path.ends_with(file));
    let state = if shown.errors > 0 { "error" } else { "ready" };
    let detail = match &shown.size {
        _ if shown.errors > 0 => plural(shown.errors, "error"),
        Some(size) if shown.warnings > 0 => format!("{size}; {}", plural(shown.warnings, "warning")),
        None => "what it consists of is known when its plug-ins are".to_owned(),
        Some(size) => size.clone(),
    };
    let mut rows = vec![row(
        &format!("Model {}", file.display()),
        state,
        detail,
        written(&of_model),
        ("diagram", "diagram"),
    )];
    if !others.is_empty() {
        let detail = plural(others.len(), "file") + " that it is made of";
        rows.push(row(
            "Subsystems and parameters",
            "ready",
            detail,
            written(&others),
            ("values", "parameters"),
        ));
    }
    rows.extend(plugins::state(shown).map(|State { state, detail, built }| {
        row("Plug-ins", state, detail, built, ("plugins", "plug-ins"))
    }));
    rows.extend(robot(&place(root, file), shown));
    let mut next = Vec::new();
    match last_run(file) {
        None => rows.push(row(
            "Last run",
            "missing",
            "this model has not been run yet".to_owned(),
            None,
            ("run", "run"),
        )),
        Some(kept) => {
            let (state, detail) = freshness(&kept);
            let time = kept.path.metadata().and_then(|data| data.modified()).ok();
            let screen = format!("runs/{}", kept.name);
            rows.push(row("Last run", state, detail, time, (&screen, "results")));
            if shown.errors == 0 {
                next.push([screen, format!("Look at the last run, {}", kept.name)]);
            }
        }
    }
    if shown.errors > 0 {
        next.push(["diagram".to_owned(), "Correct what is wrong; the page follows each save".to_owned()]);
    } else {
        next.insert(0, ["run".to_owned(), "Run the model (F5)".to_owned()]);
        next.push(["values".to_owned(), "Change a parameter".to_owned()]);
        next.push(["diagram".to_owned(), "Look at the diagram".to_owned()]);
    }
    (rows, next)
}

/// The robot of a model and its move, if it has one.
fn robot(model: &Path, shown: &Shown) -> Vec<Value> {
    let motion = ("motion", "motion");
    let written = |name: &str| {
        let (path, time) = shown.files.iter().find(|(path, _)| path.ends_with(name))?;
        path.is_file().then_some(*time)?
    };
    let Some(robot) = motion::robot_in_words(model) else { return Vec::new() };
    let mut rows = vec![match robot {
        Ok(axes) => row("Robot", "ready", axes, None, motion),
        Err(problem) => row("Robot", "error", problem, None, motion),
    }];
    let kept = match motion::moves(model).len() {
        0 => String::new(),
        count => format!("; {} kept", plural(count, "move")),
    };
    rows.push(match motion::move_of(model) {
        None => row("Move", "missing", format!("the model names no move{kept}"), None, motion),
        Some(used) => {
            // A move that stands in a file of its own is as old as that.
            let time = used.split('"').nth(1).and_then(written);
            match (shown.of("move_", "error"), shown.of("move_", "warning")) {
                (Some(problem), _) => row("Move", "error", format!("{used}: {problem}"), time, motion),
                (_, Some(problem)) => row("Move", "ready", format!("{used}: {problem}{kept}"), time, motion),
                _ => row("Move", "ready", format!("{used}{kept}"), time, motion),
            }
        }
    });
    rows
}

/// The newest run of a model.
fn last_run(file: &Path) -> Option<Kept> {
    let kept = history(Path::new(RUNS)).ok()?;
    let is_of = |kept: &Kept| {
        let manifest = kept.manifest.as_ref();
        !kept.is_unfinished()
            && manifest
                .is_some_and(|manifest| Path::new(&manifest.model.path).file_name() == file.file_name())
    };
    kept.into_iter().rev().find(is_of)
}

/// Whether a run is one of the files as they are now.
fn freshness(kept: &Kept) -> (&'static str, String) {
    let Some(manifest) = &kept.manifest else { return ("stale", "nothing is known of it".to_owned()) };
    let took = format!("{} in {}", simulated(manifest.simulated_time), duration(manifest.wall_time));
    let has_changed = |used: &&blocksim_recording::FileUsed| {
        let bytes = limited_bytes(Path::new(&used.path), u64::from(u32::MAX));
        !used.hash.is_empty() && bytes.is_ok_and(|bytes| fingerprint(&bytes) != used.hash)
    };
    let files = std::iter::once(&manifest.model).chain(&manifest.files);
    let changed: Vec<&str> = files.filter(has_changed).map(|used| used.path.as_str()).collect();
    match changed.as_slice() {
        _ if kept.ended() == "failed" => ("error", format!("failed after {took}")),
        [] => ("ready", format!("{}: {took}", kept.ended())),
        [one] => ("stale", format!("{one} has changed since; {took}")),
        several => ("stale", format!("{} have changed since; {took}", plural(several.len(), "file"))),
    }
}

/// A run by its name.
pub fn run(name: &str) -> Option<Kept> {
    history(Path::new(RUNS)).ok()?.into_iter().find(|kept| kept.name == name)
}

/// All runs of a project for the page, the oldest first.
pub fn runs() -> Vec<Value> {
    let kept = history(Path::new(RUNS)).unwrap_or_default();
    let told = |kept: &Kept| {
        let manifest = kept.manifest.as_ref();
        json!({
            "name": kept.name, "ended": kept.ended(), "started": kept.started,
            "model": manifest.map(|manifest| manifest.model.path.clone()),
            "simulated": manifest.map(|manifest| simulated(manifest.simulated_time)),
            "took": manifest.map(|manifest| duration(manifest.wall_time)),
        })
    };
    kept.iter().map(told).collect()
}
