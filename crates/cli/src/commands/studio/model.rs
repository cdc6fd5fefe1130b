//! A model as the page shows it.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Instant, SystemTime};

use blocksim_block::problem::{Problem, Severity};
use blocksim_block::schedule::Schedule;
use blocksim_diagram::{SourceFile, Sources, model};
use blocksim_drawing::Facts;
use blocksim_report::{Report, texts};
use serde_json::{Value, json};

use super::edits;
use crate::args::model::{ModelArgs, PluginArgs};
use crate::commands::check::size;
use crate::commands::report::diagram;
use crate::disk::Disk;
use crate::loaded::{Loaded, load};
use crate::running::live::{panel, scopes};
use crate::scene::json as scene_json;
use crate::terminal::places::Texts;
use crate::terminal::render;
use crate::trust::{Purpose, is_about_trust};

/// Most names of signals that are offered.
const SIGNALS: usize = 20_000;
/// Most problems that are shown.
const PROBLEMS: usize = 100;

/// A model that was read.
pub struct Shown {
    /// Counts what was read.
    pub version: u64,
    /// When it was read.
    pub read: Instant,
    /// Its title, or what its file is called.
    pub title: String,
    /// Blocks, signals and sample times in a line; nothing if it cannot be run.
    pub size: Option<String>,
    /// How much keeps it from running.
    pub errors: usize,
    /// Why plug-ins are not there, as nobody has run the model yet.
    pub untrusted: Option<String>,
    /// How much is to be thought of.
    pub warnings: usize,
    /// All problems for the page.
    pub problems: Vec<Value>,
    /// For each of them the one likely remedy, where there is one.
    pub fixes: Vec<Option<Fix>>,
    /// Drawings of all levels, for the page.
    pub drawn: Arc<str>,
    /// Files that it was read from, and when each was written.
    pub files: Vec<(PathBuf, Option<SystemTime>)>,
    /// What its plug-ins offer, by their paths.
    pub offers: BTreeMap<String, String>,
    /// Libraries of plug-ins, and when each was written.
    pub libraries: Vec<(PathBuf, Option<SystemTime>)>,
    /// End of its simulation, s.
    pub until: f64,
    /// Names of its signals, one number each, and what sweeps can measure of them.
    pub signals: Value,
    /// Its panel, for the page.
    pub panel: Value,
    /// What is seen of its mechanism, where each of its joints has one freedom; null without.
    pub scene: Value,
}

impl Shown {
    /// The first problem whose code begins so.
    pub fn of(&self, code: &str, severity: &str) -> Option<&str> {
        let is_it = |problem: &&Value| {
            problem["severity"] == severity
                && problem["code"].as_str().is_some_and(|known| known.starts_with(code))
        };
        self.problems.iter().find(is_it)?["message"].as_str()
    }

    /// Whether plug-ins have been built since.
    pub fn has_other_plugins(&self) -> bool {
        self.libraries.iter().any(|(path, time)| modified(path) != *time)
    }
}

/// A change of a text that corrects a problem.
#[derive(Debug, Clone)]
pub struct Fix {
    /// The file.
    pub path: PathBuf,
    /// Its text, as it was read.
    pub old: String,
    /// Its text with the change.
    pub new: String,
}

impl Fix {
    /// The change that a problem carries, if it is about a file.
    fn of(problem: &Problem, files: &[SourceFile], on_disk: &[SourceFile]) -> Option<Fix> {
        let edit = problem.remedy()?;
        let file = files.get(edit.place.file.0 as usize)?;
        let is_file = on_disk.iter().any(|known| known.path == file.path);
        let fits = file.text.get(edit.place.span.clone()) == Some(edit.old.as_str());
        if !is_file || !fits {
            return None;
        }
        let old = file.text.to_string();
        let mut new = old.clone();
        new.replace_range(edit.place.span.clone(), &edit.new);
        Some(Fix { path: file.path.clone(), old, new })
    }
}

/// Reads a model that lies at `root` as `file`.
pub fn read(root: &Path, file: &Path, version: u64) -> Shown {
    let args = ModelArgs { model: place(root, file), set: Vec::new(), plugins: PluginArgs::default() };
    let mut shown = Shown {
        version,
        read: Instant::now(),
        title: file.display().to_string(),
        size: None,
        errors: 0,
        untrusted: None,
        warnings: 0,
        problems: Vec::new(),
        fixes: Vec::new(),
        drawn: "null".into(),
        files: Vec::new(),
        offers: BTreeMap::new(),
        libraries: Vec::new(),
        until: 0.0,
        panel: json!([]),
        signals: json!({ "all": [], "recorded": [] }),
        scene: Value::Null,
    };
    let (problems, loaded) = match load(&args, Purpose::Look) {
        Ok(mut loaded) => (std::mem::take(&mut loaded.compiled.problems), Some(loaded)),
        Err(failure) => (failure.into_problems(), None),
    };
    let (untrusted, problems): (Vec<Problem>, Vec<Problem>) = problems.into_iter().partition(is_about_trust);
    shown.read = Instant::now();
    shown.untrusted = untrusted.first().map(|problem| problem.message.clone());
    let sources = loaded.as_ref().map(|loaded| loaded.files.clone()).unwrap_or_default();
    let counts = |severity| problems.iter().filter(|problem| problem.severity == severity).count();
    (shown.errors, shown.warnings) = (counts(Severity::Error), counts(Severity::Warning));
    let told = Texts::of(&sources);
    let on_disk = loaded.as_ref().map(|loaded| loaded.on_disk.as_slice()).unwrap_or_default();
    for problem in render::first(&problems, PROBLEMS) {
        let fix = Fix::of(problem, &sources, on_disk);
        let mut data = data(problem, &told, root);
        data["fix"] = problem.remedy().filter(|_| fix.is_some()).map(|edit| edit.new.clone()).into();
        shown.problems.push(data);
        shown.fixes.push(fix);
    }
    let mut report = Report::default();
    if let Some(scene) = loaded.as_ref().and_then(Loaded::scene) {
        shown.scene = serde_json::from_str(&scene_json(scene, &HashMap::new())).unwrap_or_default();
    }
    if let Some(Loaded { compiled, on_disk, plugins, offers, .. }) = &loaded {
        shown.files = on_disk.iter().map(|file| (file.path.clone(), modified(&file.path))).collect();
        let libraries = plugins.iter().map(|used| PathBuf::from(&used.path));
        shown.libraries = libraries.map(|path| (path.clone(), modified(&path))).collect();
        shown.offers.clone_from(offers);
        shown.panel = panel::json(&compiled.panel, compiled.schedule.as_ref());
        if let Some(schedule) = &compiled.schedule {
            shown.size = Some(size(schedule));
            shown.until = schedule.settings.stop_time;
            shown.signals = signals(schedule);
            if !schedule.title.is_empty() {
                shown.title.clone_from(&schedule.title);
            }
            report.panels = scopes(schedule, &compiled.panel).into_iter().map(|scope| scope.panel).collect();
        }
    }
    let disk = Disk::default();
    let sources = Sources::new(&disk);
    let top = model(&sources, &args.model, &[]).0;
    if let Some(model) = &top {
        let schedule = loaded.as_ref().and_then(|loaded| loaded.compiled.schedule.as_ref());
        let facts = Facts::of(model, schedule);
        diagram::add(model, &sources, &[], Some(&facts), &mut report);
    }
    let mut drawn = texts(&report);
    if let Some(model) = &top {
        edits::wiring(model, &sources, &report, &mut drawn);
    }
    let paths = |panel: &blocksim_report::Panel| -> Vec<String> {
        panel.series.iter().map(|series| series.path.clone()).collect()
    };
    // As runs name it.
    drawn["model"] = args.model.display().to_string().into();
    drawn["panels"] = report.panels.iter().map(paths).collect();
    drawn["style"] = report.diagram.style.clone().into();
    shown.drawn = drawn.to_string().into();
    shown
}

/// Names of signals: of all outputs, of a vector one for each element, and of what is recorded.
fn signals(schedule: &Schedule) -> Value {
    let of = |signal: &blocksim_block::schedule::Signal| match signal.shape.len() {
        1 => vec![signal.path.clone()],
        count => (0..count).map(|n| format!("{}[{n}]", signal.path)).collect(),
    };
    let all: Vec<String> = schedule.signals.iter().flat_map(of).take(SIGNALS).collect();
    let recorded: Vec<&str> = schedule.recorded.iter().map(|one| one.path.as_str()).take(SIGNALS).collect();
    json!({ "all": all, "recorded": recorded })
}

/// Where a file of a project is, as one would type it.
pub fn place(root: &Path, file: &Path) -> PathBuf {
    if root == Path::new(".") { file.to_owned() } else { root.join(file) }
}

/// A problem for the page.
fn data(problem: &Problem, texts: &Texts, root: &Path) -> Value {
    let told = render::json(problem, texts, None);
    let label = &told["labels"][0];
    let file = label["file"]
        .as_str()
        .map(|file| Path::new(file).strip_prefix(root).unwrap_or(file.as_ref()).display().to_string());
    json!({
        "severity": told["severity"], "code": told["code"], "message": told["message"], "help": told["help"],
        "notes": told["notes"], "file": file, "line": label["line"], "column": label["column"],
    })
}

fn modified(path: &Path) -> Option<SystemTime> {
    path.metadata().ok().and_then(|data| data.modified().ok())
}

/// When any of these files was written last.
pub fn written(files: &[(PathBuf, Option<SystemTime>)]) -> Option<SystemTime> {
    files.iter().filter_map(|(_, written)| *written).max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_that_is_not_there_has_a_problem_and_no_drawing() {
        let shown = read(Path::new("nowhere"), Path::new("model.ron"), 3);
        assert_eq!((shown.version, shown.errors, shown.size.is_none()), (3, 1, true));
        assert!(shown.problems[0]["message"].as_str().unwrap().contains("model.ron"), "{:?}", shown.problems);
    }
}
