//! Whole diagrams: compiled from text, run, compared.

pub mod accounts;
pub mod mutants;
pub mod random;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use blocksim_block::problem::{Label, Problem};
use blocksim_block::schedule::{Recorded, Schedule};
use blocksim_block::{AnyCode, CodePolicy};
// Blocks register themselves when they are linked, and linked is only what is named.
use blocksim_blocks as _;
use blocksim_diagram::{Compiled, Reader, Sources, compile};
use blocksim_host as _;
use blocksim_sim::{Counts, Findings, Observer, SimError, Simulation};

/// The project's root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map(Path::to_path_buf).unwrap_or_default()
}

/// All files of diagrams below a folder of the project, in the order of their names.
///
/// # Panics
/// Panics where there is no such folder.
pub fn diagrams_below(folder: &str) -> Vec<PathBuf> {
    let mut folders = vec![root().join(folder)];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in
            std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display())).flatten()
        {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "ron") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Diagrams of the project that run in an instant, from several fields.
pub const SMALL_DIAGRAMS: [&str; 6] = [
    "diagrams/servo.ron",
    "diagrams/dc_motor_start.ron",
    "diagrams/asm_direct_on_line.ron",
    "diagrams/pendulum.ron",
    "diagrams/bouncing_mass.ron",
    "diagrams/pid_anti_windup.ron",
];

/// Reads files of the project, and texts that a test makes up.
#[derive(Debug, Default)]
pub struct Desk {
    files: BTreeMap<PathBuf, String>,
}

impl Desk {
    /// Only files on disk.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file that is not on disk.
    pub fn with(mut self, path: &str, text: &str) -> Self {
        self.files.insert(PathBuf::from(path), text.to_owned());
        self
    }
}

impl Reader for Desk {
    fn read(&self, path: &Path) -> Result<String, String> {
        match self.files.get(path) {
            Some(text) => Ok(text.clone()),
            None => std::fs::read_to_string(path).map_err(|_| "the file does not exist".to_owned()),
        }
    }

    // Tests run their models.
    fn code(&self) -> &dyn CodePolicy {
        &AnyCode
    }
}

/// Compiles a diagram of the project.
pub fn compile_file(path: &str, overrides: &[&str]) -> (Compiled, String) {
    compile_with(&Desk::new(), &root().join(path), overrides)
}

/// The schedule of a diagram of the project; panics with its problems where there is none.
pub fn schedule(path: &str, overrides: &[&str]) -> Schedule {
    let (compiled, problems) = compile_file(path, overrides);
    compiled.schedule.unwrap_or_else(|| panic!("{problems}"))
}

/// Compiles a diagram that a test makes up.
pub fn compile_text(text: &str) -> (Compiled, String) {
    compile_with(&Desk::new().with("model.ron", text), Path::new("model.ron"), &[])
}

/// Compiles; also returns all problems as text.
pub fn compile_with(desk: &Desk, path: &Path, overrides: &[&str]) -> (Compiled, String) {
    let sources = Sources::new(desk);
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    let compiled = compile(&sources, path, &overrides);
    let text = compiled.problems.iter().map(|problem| plain(&sources, problem)).collect();
    (compiled, text)
}

/// A problem in plain text: message, places with what stands there, notes, advice.
fn plain(sources: &Sources, problem: &Problem) -> String {
    let mut out = format!("{:?}[{}]: {}\n", problem.severity, problem.code, problem.message).to_lowercase();
    // Only the severity is lowered; the message keeps its capitals.
    out.replace_range(out.find(']').map_or(0, |at| at + 3).., &format!("{}\n", problem.message));
    for Label { place, text, .. } in &problem.labels {
        let file = sources.file(place.file);
        let line = file.text[..place.span.start].matches('\n').count() + 1;
        let column = place.span.start - file.text[..place.span.start].rfind('\n').map_or(0, |at| at + 1) + 1;
        let shown = file.text.get(place.span.clone()).unwrap_or_default().replace('\n', " ");
        let name = file.path.strip_prefix(root()).unwrap_or(&file.path).display().to_string();
        out.push_str(&format!("  {name}:{line}:{column} `{shown}` {text}\n"));
    }
    problem.notes.iter().for_each(|note| out.push_str(&format!("  note: {note}\n")));
    if let Some(help) = &problem.help {
        out.push_str(&format!("  help: {help}\n"));
    }
    out
}

/// What a run recorded.
#[derive(Debug, Clone)]
pub struct Run {
    /// Times, s.
    pub time: Vec<f64>,
    /// Columns.
    pub recorded: Vec<Recorded>,
    /// Values in SI units, one list for each column.
    pub columns: Vec<Vec<f64>>,
    /// Events: time, block, what.
    pub events: Vec<(f64, String, String)>,
    /// Work that was done.
    pub counts: Counts,
    /// What blocks say at its end about approximations of theirs.
    pub warnings: Vec<Problem>,
    /// How the run failed, if it did.
    pub error: Option<SimError>,
}

struct Keep(Run);

impl Observer for Keep {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.0.time.push(t);
        self.0.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(*value));
    }

    fn event(&mut self, t: f64, path: &str, what: &str) {
        self.0.events.push((t, path.to_owned(), what.to_owned()));
    }
}

impl Run {
    /// A column by its name.
    ///
    /// # Panics
    /// Panics when there is none, with the names that there are.
    pub fn column(&self, path: &str) -> &[f64] {
        let index = self.recorded.iter().position(|recorded| recorded.path == path);
        match index {
            Some(index) => &self.columns[index],
            None => panic!(
                "no `{path}`; there are {:?}",
                self.recorded.iter().map(|r| &r.path).collect::<Vec<_>>()
            ),
        }
    }

    /// The last value of a column.
    ///
    /// # Panics
    /// Panics when there is no such column or nothing was recorded.
    pub fn last(&self, path: &str) -> f64 {
        *self.column(path).last().expect("a recorded value")
    }

    /// The value of a column in the last row of a time: behind what happens then.
    ///
    /// # Panics
    /// Panics when there is no such column, or no row at that time.
    pub fn behind(&self, path: &str, t: f64) -> f64 {
        let row = self.time.iter().rposition(|other| (other - t).abs() < 1e-9);
        self.column(path)[row.unwrap_or_else(|| panic!("no row at {t} s"))]
    }

    /// The value of a column at a time, by linear interpolation.
    ///
    /// # Panics
    /// Panics when there is no such column or nothing was recorded.
    pub fn at(&self, path: &str, t: f64) -> f64 {
        let column = self.column(path);
        let after = self.time.partition_point(|time| *time < t).clamp(1, self.time.len() - 1);
        let (t0, t1) = (self.time[after - 1], self.time[after]);
        let share = if t1 > t0 { (t - t0) / (t1 - t0) } else { 1.0 };
        column[after - 1] + share * (column[after] - column[after - 1])
    }
}

/// All methods of variable step.
pub const METHODS: [&str; 10] =
    ["Auto", "Ode45", "Ode23", "Dop853", "Ode15s", "Radau5", "Rodas4", "Ode23tb", "Ode23t", "RosW3"];

/// Runs a compiled diagram to its end.
///
/// # Panics
/// Panics when the engine refuses the schedule.
pub fn run(schedule: Schedule) -> Run {
    simulate(schedule, false).0
}

/// The same, with all watched conditions looked at on a fine grid within each step; nothing of a method of fixed step.
pub fn run_audited(schedule: Schedule) -> (Run, Option<Findings>) {
    simulate(schedule, true)
}

fn simulate(schedule: Schedule, audited: bool) -> (Run, Option<Findings>) {
    let recorded = schedule.recorded.clone();
    let mut simulation = Simulation::new(Arc::new(schedule)).expect("a schedule that can run");
    let empty = Run {
        time: Vec::new(),
        columns: vec![Vec::new(); recorded.len()],
        recorded,
        events: Vec::new(),
        counts: simulation.counts(),
        warnings: Vec::new(),
        error: None,
    };
    let mut keep = Keep(empty);
    if audited {
        simulation.audit();
    }
    let error = simulation.run(&mut keep).err();
    keep.0.counts = simulation.counts();
    keep.0.warnings = simulation.warnings();
    keep.0.error = error;
    (keep.0, simulation.findings())
}

/// Compiles and runs a diagram of the project.
///
/// # Panics
/// Panics when it does not compile or fails, with the reasons.
pub fn run_file(path: &str, overrides: &[&str]) -> Run {
    let (compiled, problems) = compile_file(path, overrides);
    finished(compiled, &problems)
}

/// Compiles and runs a diagram that a test makes up.
///
/// # Panics
/// Panics when it does not compile or fails, with the reasons.
pub fn run_text(text: &str) -> Run {
    let (compiled, problems) = compile_text(text);
    finished(compiled, &problems)
}

/// Runs a diagram of these blocks and connections.
///
/// # Panics
/// As [`run_text`].
pub fn run_blocks(stop: &str, solver: &str, blocks: &str, connections: &str) -> Run {
    run_text(&format!(
        "Diagram(simulation: (stop_time: \"{stop}\", solver: {solver}), blocks: {{ {blocks} }}, connections: [ {connections} ])"
    ))
}

/// What is wrong with a diagram of these blocks and connections.
///
/// # Panics
/// If it compiles.
pub fn problems(blocks: &str, connections: &str) -> String {
    let (compiled, problems) = compile_text(&format!(
        r#"Diagram(simulation: (stop_time: "1 s"), blocks: {{ {blocks} }}, connections: [{connections}])"#
    ));
    assert!(compiled.schedule.is_none(), "it compiles");
    problems
}

/// Checks that a number is within a tolerance of another.
///
/// # Panics
/// If it is not.
#[track_caller]
pub fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{what}: {found} instead of {expected}, allowed are {tolerance}"
    );
}

fn finished(compiled: Compiled, problems: &str) -> Run {
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("the diagram has errors:\n{problems}"));
    let run = run(schedule);
    if let Some(error) = &run.error {
        panic!("the run failed: {error:?}");
    }
    run
}
