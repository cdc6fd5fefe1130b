//! `manifest.json`: what was run, with what, and how it ended.

mod used;

use serde::{Deserialize, Serialize};

pub use used::{BaseUsed, Choice, Counts, FileUsed, Override, Program, RecordedUsed, SolverUsed};

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
    use crate::store::Rate;
    use expect_test::expect;

    pub(crate) fn example() -> Manifest {
        Manifest {
            schema: Manifest::SCHEMA,
            program: Program { name: "blocksim".into(), version: "0.1.0".into() },
            model: FileUsed { path: "diagrams/arm.ron".into(), hash: "fnv1a64:e756c0190570ccb5".into() },
            files: vec![FileUsed { path: "params/arm.ron".into(), hash: "fnv1a64:af63ed4c8602096f".into() }],
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
