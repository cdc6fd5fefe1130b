//! `manifest.json`: what was run, with what, and how it ended.

use serde::{Deserialize, Serialize};

use crate::store::{Layout, Rate};

/// The manifest of a run. Enough to repeat it and to know whether a repetition used the same inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of this structure; see [`Manifest::SCHEMA`].
    pub schema: u32,
    /// Program that ran.
    pub program: Program,
    /// The model, its top-level file.
    pub model: FileUsed,
    /// All other files read: diagrams, parameters, plug-ins.
    pub files: Vec<FileUsed>,
    /// Parameter values that differ from the files.
    pub overrides: Vec<Override>,
    /// Variants chosen.
    pub variants: Vec<Choice>,
    /// Solver and its settings.
    pub solver: SolverUsed,
    /// What was recorded; `None` in manifests that do not tell it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recorded: Option<RecordedUsed>,
    /// Start in UTC, ISO 8601: `2026-11-21T14:03:22Z`.
    pub started: String,
    /// Duration of the run on the clock on the wall, s.
    pub wall_time: f64,
    /// Time simulated, s.
    pub simulated_time: f64,
    /// Work done.
    pub counts: Counts,
    /// How it ended.
    pub ended: Ended,
}

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
    /// Fixed step, or the largest step allowed, s.
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

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "how", rename_all = "lowercase")]
pub enum Ended {
    /// It has not: it still runs, or its program was ended by force.
    Unfinished,
    /// It reached its end time.
    Complete,
    /// The model ended it, for example by a stop block.
    Stopped {
        /// Which block and why.
        reason: String,
    },
    /// The user interrupted it; what was recorded until then is kept.
    Interrupted,
    /// It could not go on; what was recorded until then is kept.
    Failed {
        /// Why.
        reason: String,
    },
}

impl RecordedUsed {
    /// What a layout says, chosen by patterns of the command line if there are any.
    pub fn of(layout: &Layout, patterns: Vec<String>) -> RecordedUsed {
        let base = |(base, &rate)| BaseUsed { rate, signals: layout.of_base(base).count() };
        RecordedUsed { patterns, bases: layout.rates.iter().enumerate().map(base).collect() }
    }
}

impl Manifest {
    /// The version that this program writes and reads.
    pub const SCHEMA: u32 = 1;

    /// Pretty JSON with a line feed at the end.
    ///
    /// # Errors
    ///
    /// Only if a number is not finite, which JSON cannot hold.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let numbers = [Some(self.wall_time), Some(self.simulated_time)];
        let settings = [self.solver.rtol, self.solver.atol, self.solver.step];
        if numbers.iter().chain(&settings).flatten().any(|x| !x.is_finite()) {
            return Err(serde::ser::Error::custom("a time or tolerance of the manifest is not finite"));
        }
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        Ok(text)
    }

    /// Reads a manifest.
    ///
    /// # Errors
    ///
    /// If the text is no manifest, or one of another schema version.
    pub fn from_json(text: &str) -> Result<Manifest, serde_json::Error> {
        #[derive(Deserialize)]
        struct Version {
            schema: u32,
        }
        let Version { schema } = serde_json::from_str(text)?;
        if schema != Manifest::SCHEMA {
            let message =
                format!("this manifest has schema {schema}, this program reads schema {}", Manifest::SCHEMA);
            return Err(serde::de::Error::custom(message));
        }
        serde_json::from_str(text)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use expect_test::expect;

    pub(crate) fn example() -> Manifest {
        Manifest {
            schema: Manifest::SCHEMA,
            program: Program { name: "blocksim".into(), version: "0.1.0".into() },
            model: FileUsed { path: "diagrams/arm.ron".into(), hash: crate::hash::fingerprint(b"arm") },
            files: vec![FileUsed { path: "params/arm.ron".into(), hash: crate::hash::fingerprint(b"p") }],
            overrides: vec![Override { path: "axis1.control.kp".into(), value: "2.5".into() }],
            variants: vec![Choice { variant: "drive".into(), choice: "dc".into() }],
            solver: SolverUsed { name: "rk45".into(), rtol: Some(1e-6), atol: Some(1e-9), step: None },
            recorded: Some(RecordedUsed {
                patterns: vec!["arm/**@10ms".into(), "drive".into()],
                bases: vec![
                    BaseUsed { rate: Rate::Every(0.01), signals: 12 },
                    BaseUsed { rate: Rate::All, signals: 3 },
                ],
            }),
            started: "2026-11-21T14:03:22Z".into(),
            wall_time: 0.42,
            simulated_time: 10.0,
            counts: Counts { steps: 4183, rejected: 96, evaluations: 25_674, events: 3, sample_hits: 1724 },
            ended: Ended::Complete,
        }
    }

    #[test]
    fn a_manifest_reads_like_this() {
        expect![[r#"
            {
              "schema": 1,
              "program": {
                "name": "blocksim",
                "version": "0.1.0"
              },
              "model": {
                "path": "diagrams/arm.ron",
                "hash": "fnv1a64:e756c0190570ccb5"
              },
              "files": [
                {
                  "path": "params/arm.ron",
                  "hash": "fnv1a64:af63ed4c8602096f"
                }
              ],
              "overrides": [
                {
                  "path": "axis1.control.kp",
                  "value": "2.5"
                }
              ],
              "variants": [
                {
                  "variant": "drive",
                  "choice": "dc"
                }
              ],
              "solver": {
                "name": "rk45",
                "rtol": 1e-6,
                "atol": 1e-9
              },
              "recorded": {
                "patterns": [
                  "arm/**@10ms",
                  "drive"
                ],
                "bases": [
                  {
                    "rate": {
                      "every": 0.01
                    },
                    "signals": 12
                  },
                  {
                    "rate": "all",
                    "signals": 3
                  }
                ]
              },
              "started": "2026-11-21T14:03:22Z",
              "wall_time": 0.42,
              "simulated_time": 10.0,
              "counts": {
                "steps": 4183,
                "rejected": 96,
                "evaluations": 25674,
                "events": 3,
                "sample_hits": 1724
              },
              "ended": {
                "how": "complete"
              }
            }
        "#]]
        .assert_eq(&example().to_json().unwrap());
    }

    #[test]
    fn what_was_written_is_read_back() {
        for ended in [
            Ended::Unfinished,
            Ended::Complete,
            Ended::Stopped { reason: "arm/limit: above 3 rad".into() },
            Ended::Interrupted,
            Ended::Failed { reason: "step size fell below 1e-12 s".into() },
        ] {
            let manifest = Manifest { ended, ..example() };
            assert_eq!(Manifest::from_json(&manifest.to_json().unwrap()).unwrap(), manifest);
        }
    }

    #[test]
    fn a_manifest_without_sample_hits_is_read() {
        let text = example().to_json().unwrap().replace(",\n    \"sample_hits\": 1724", "");
        assert!(!text.contains("sample_hits"));
        assert_eq!(Manifest::from_json(&text).unwrap().counts.sample_hits, 0);
    }

    #[test]
    fn another_schema_version_is_refused_with_both_numbers() {
        let text = example().to_json().unwrap().replace("\"schema\": 1", "\"schema\": 7");
        let error = Manifest::from_json(&text).unwrap_err().to_string();
        assert_eq!(error, "this manifest has schema 7, this program reads schema 1");
    }

    #[test]
    fn a_number_that_json_cannot_hold_is_refused() {
        assert!(Manifest { wall_time: f64::NAN, ..example() }.to_json().is_err());
    }
}
