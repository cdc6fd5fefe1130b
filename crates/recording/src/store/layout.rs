//! The header of a recording: which signals there are, and on which time bases.

use serde::{Deserialize, Serialize};

use crate::recording::{Kind, Recording};

/// All that is known of a recording before its first row.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Layout {
    /// One time base for each rate. The first has all rows of the run, unless nobody wants them.
    pub rates: Vec<Rate>,
    /// The signals.
    pub signals: Vec<SignalInfo>,
}

/// Which rows of a run a time base has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Rate {
    /// All.
    All,
    /// Every n-th, and the last.
    Nth(u32),
    /// The first one at or behind each multiple of this time, s, and the last.
    Every(f64),
    /// Of each window of this length, s, the least and the largest value of its only signal, at their times.
    Extremes(f64),
}

/// A signal of a recording. Values are in SI units, whatever it is shown in.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SignalInfo {
    /// Where it comes from: `control/joint1/scope.set`; elements of vectors end in their number: `arm.q[2]`.
    pub path: String,
    /// SI unit as text, `1` where there is none.
    pub unit: String,
    /// Unit to show it in, such as `deg`; without one that is `unit`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub display: Option<String>,
    /// What its scope and the subsystems around it are called by their labels, the outermost first: `["Joint velocities",
    /// "Axes 1 - 3"]`. Empty where they have none; [`titles`](crate::titles) makes headings of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub title: Vec<String>,
    /// What legends call it; without, that is the name of the port.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub legend: Option<String>,
    /// Path of the signal over which it is drawn; over time without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub over: Option<String>,
    /// What the values are.
    #[serde(default)]
    pub kind: Kind,
    /// Whether it keeps the value of a row until the next one, as what is sampled does. [`Run`](crate::Run) hands out rows
    /// on both sides of its jumps.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub held: bool,
    /// Its time base: position among [`Layout::rates`].
    #[serde(default)]
    pub base: usize,
}

impl SignalInfo {
    /// Name and number of an element of a vector: `arm.q[2]` is `("arm.q", 2)`.
    pub fn element(&self) -> Option<(&str, usize)> {
        let (name, rest) = self.path.rsplit_once('[')?;
        Some((name, rest.strip_suffix(']')?.parse().ok()?))
    }
}

impl Layout {
    /// The layout of signals that all have all rows.
    pub fn of(recording: &Recording) -> Layout {
        let info = |signal: &crate::Signal| SignalInfo {
            path: signal.path.clone(),
            unit: signal.unit.clone(),
            kind: signal.kind,
            ..SignalInfo::default()
        };
        Layout { rates: vec![Rate::All], signals: recording.signals.iter().map(info).collect() }
    }

    /// Positions of the signals of a time base.
    pub fn of_base(&self, base: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.signals.len()).filter(move |&at| self.signals[at].base == base)
    }

    /// What is wrong with it, if anything.
    pub(super) fn mistake(&self) -> Option<String> {
        let lost = self.signals.iter().find(|signal| signal.base >= self.rates.len())?;
        Some(format!("`{}` has no time base", lost.path))
    }
}
