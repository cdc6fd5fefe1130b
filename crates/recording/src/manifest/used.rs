//! What a run was made with: files, values, solver, what was recorded, work.

use serde::{Deserialize, Serialize};

use crate::store::{Layout, Rate};

/// Name and version of a program.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Its name.
    pub name: String,
    /// Its version: `0.1.0`.
    pub version: String,
}

/// A file that a run read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileUsed {
    /// Path as given, with `/` between its parts.
    pub path: String,
    /// Fingerprint with the name of its algorithm: `fnv1a64:cbf29ce484222325`.
    pub hash: String,
}

/// A parameter value that differs from the files.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Override {
    /// Path of the parameter: `axis1.pid.kp`.
    pub path: String,
    /// The value as it was written, with its unit: `0.1 deg`.
    pub value: String,
}

/// A variant and the choice made for it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Choice {
    /// Name of the variant: `drive`.
    pub variant: String,
    /// What was chosen: `dc`.
    pub choice: String,
}

/// Solver and settings; what a solver does not use is `None`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SolverUsed {
    /// Its name: `rk45`.
    pub name: String,
    /// Relative tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rtol: Option<f64>,
    /// Absolute tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub atol: Option<f64>,
    /// Fixed step, or the maximum step allowed, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
}

/// What was recorded, and who said so.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordedUsed {
    /// Patterns of the command line with their rates, as written; without any the diagram has said what is recorded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub patterns: Vec<String>,
    /// The time bases in their order.
    pub bases: Vec<BaseUsed>,
}

/// Signals that have the same times.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BaseUsed {
    /// Which rows of the run they have.
    pub rate: Rate,
    /// How many they are.
    pub signals: usize,
}

/// Work of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Counts {
    /// Steps accepted.
    pub steps: u64,
    /// Steps rejected by the error control.
    pub rejected: u64,
    /// Evaluations of the right-hand side.
    pub evaluations: u64,
    /// Zero crossings handled.
    pub events: u64,
    /// Sample hits, over all rates; 0 in manifests that do not tell it.
    #[serde(default)]
    pub sample_hits: u64,
}

impl RecordedUsed {
    /// What a layout says, chosen by patterns of the command line if there are any.
    pub fn of(layout: &Layout, patterns: Vec<String>) -> RecordedUsed {
        let base = |(base, &rate)| BaseUsed { rate, signals: layout.of_base(base).count() };
        RecordedUsed { patterns, bases: layout.rates.iter().enumerate().map(base).collect() }
    }
}
