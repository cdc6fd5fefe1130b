//! Models of several texts, and what their runs bring.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_diagram::{Compiled, Reader, Sources, compile};
use blocksim_sim::{Observer, Simulation};

/// Texts by their names.
struct Texts(BTreeMap<PathBuf, String>);

impl Reader for Texts {
    fn read(&self, path: &Path) -> Result<String, String> {
        self.0.get(path).cloned().ok_or_else(|| "there is no such file".to_owned())
    }
}

/// What a run has brought.
#[derive(Default)]
pub struct Run {
    pub names: Vec<String>,
    pub rows: Vec<(f64, Vec<f64>)>,
    pub events: Vec<(f64, String)>,
}

impl Observer for Run {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.rows.push((t, values.to_vec()));
    }

    fn event(&mut self, t: f64, path: &str, what: &str) {
        self.events.push((t, format!("{path} {what}")));
    }
}

impl Run {
    /// Times and values of a column.
    pub fn column(&self, name: &str) -> Vec<(f64, f64)> {
        let column = self.names.iter().position(|known| known == name);
        let column = column.unwrap_or_else(|| panic!("no `{name}` among {:?}", self.names));
        self.rows.iter().map(|(t, values)| (*t, values[column])).collect()
    }

    pub fn last(&self, name: &str) -> f64 {
        self.column(name).last().expect("a row").1
    }

    /// Times of an event.
    pub fn times(&self, event: &str) -> Vec<f64> {
        self.events.iter().filter(|(_, what)| what == event).map(|(t, _)| *t).collect()
    }
}

/// What the first of these files is compiled to.
pub fn checked(files: &[(&str, &str)]) -> Compiled {
    let texts = Texts(files.iter().map(|(name, text)| (PathBuf::from(name), (*text).to_owned())).collect());
    compile(&Sources::new(&texts), Path::new(files[0].0), &[])
}

/// The schedule of the first of these files, or what is wrong.
pub fn compiled(files: &[(&str, &str)]) -> Result<Schedule, String> {
    let compiled = checked(files);
    compiled.schedule.ok_or_else(|| {
        let problems = compiled.problems.iter();
        problems
            .map(|p| format!("{}: {}; {}", p.code, p.message, p.help.clone().unwrap_or_default()))
            .collect()
    })
}

/// The run of a model without errors.
pub fn run(files: &[(&str, &str)]) -> Run {
    tried(files).unwrap_or_else(|problems| panic!("{problems}"))
}

/// A run, or the reason why it fails.
pub fn tried(files: &[(&str, &str)]) -> Result<Run, String> {
    let schedule = compiled(files)?;
    let names = schedule.recorded.iter().map(|recorded| recorded.path.clone()).collect();
    let mut run = Run { names, ..Run::default() };
    let mut simulation = Simulation::new(Arc::new(schedule)).expect("a simulation");
    simulation.run(&mut run).map_err(|error| format!("{error:?}"))?;
    Ok(run)
}

/// Why a run ends.
pub fn failure(files: &[(&str, &str)]) -> String {
    let schedule = compiled(files).unwrap_or_else(|problems| panic!("{problems}"));
    let simulation = Simulation::new(Arc::new(schedule));
    let ended = simulation.and_then(|mut simulation| simulation.run(&mut Run::default()).map(|_| ()));
    ended.expect_err("an error").to_string()
}
