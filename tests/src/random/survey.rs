//! Many models of a class.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;

use super::puzzle::{Fault, Finding, Judge, Puzzle};
use super::variants::Variant;

/// What became of many models.
#[derive(Debug, Default)]
pub struct Survey {
    /// Models that were tried.
    pub count: u64,
    /// Models that engine and reference agree about.
    pub right: u64,
    /// How many nobody can decide, by the reason.
    pub undecided: BTreeMap<String, u64>,
    /// Seeds of those they do not agree about, and what is wrong.
    pub wrong: Vec<(u64, Fault)>,
}

/// Judges the models of all seeds by `judge`. `tell` hears of each that is wrong, or, with its reason, not decided.
pub fn survey<P: Puzzle>(
    seeds: Range<u64>,
    variant: &Variant,
    judge: Judge<P>,
    mut tell: impl FnMut(u64, &P, &Finding),
) -> Survey {
    let mut survey = Survey::default();
    for seed in seeds {
        let model = P::of(seed);
        let finding = judge(&model, variant);
        survey.count += 1;
        if finding != Finding::Right {
            tell(seed, &model, &finding);
        }
        match finding {
            Finding::Right => survey.right += 1,
            Finding::Undecided(why) => *survey.undecided.entry(why.to_string()).or_default() += 1,
            Finding::Wrong(fault) => survey.wrong.push((seed, fault)),
        }
    }
    survey
}

impl Survey {
    /// Models that somebody can decide.
    pub fn decided(&self) -> u64 {
        self.right + self.wrong.len() as u64
    }
}

impl fmt::Display for Survey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Survey { count, right, undecided, wrong } = self;
        writeln!(f, "{count:6}  models")?;
        writeln!(f, "{right:6}  right")?;
        undecided.iter().try_for_each(|(why, count)| writeln!(f, "{count:6}  undecided: {why}"))?;
        let mut kinds: BTreeMap<&str, u64> = BTreeMap::new();
        wrong.iter().for_each(|(_, fault)| *kinds.entry(fault.kind).or_default() += 1);
        kinds.iter().try_for_each(|(kind, count)| writeln!(f, "{count:6}  wrong: {kind}"))
    }
}
