//! What all classes of random models have in common: a model of a seed, its reference, its judge, smaller models.

use std::cell::OnceCell;
use std::fmt::{self, Debug};

use super::variants::Variant;
use crate::{Run, compile_text, run, run_audited};
use blocksim_sim::Missed;

/// Why nobody can say what comes out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Undecided {
    /// Switches more often than anyone counts.
    Chatters,
    /// A threshold is touched or nearly so.
    Grazes,
    /// Two things happen at nearly the same time.
    Coincides,
    /// Grows beyond all bounds.
    Grows,
    /// The steps of the reference are too long.
    Coarse,
    /// Turns out otherwise if something changes by some millionths.
    Sensitive,
}

impl fmt::Display for Undecided {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Undecided::Chatters => "chatters",
            Undecided::Grazes => "grazes a threshold",
            Undecided::Coincides => "two things coincide",
            Undecided::Grows => "grows",
            Undecided::Coarse => "the reference is too coarse",
            Undecided::Sensitive => "sensitive",
        })
    }
}

/// What is wrong with a run: its kind, and what it is in words.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// A word that tells kinds of faults apart.
    pub kind: &'static str,
    /// Where, what was expected, what was found.
    pub what: String,
}

impl Fault {
    /// What is wrong, in words.
    pub fn new(kind: &'static str, what: String) -> Self {
        Self { kind, what }
    }

    /// A value that is further from what is known than it may be.
    pub fn value(kind: &'static str, name: &str, found: f64, expected: f64, slack: f64) -> Option<Self> {
        let is_off = (found - expected).abs() > slack || found.is_nan();
        is_off.then(|| Self::new(kind, format!("{name} is {found} instead of {expected} (+-{slack:.1e})")))
    }
}

/// What became of a model.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// Engine and reference agree.
    Right,
    /// Nobody can say what comes out.
    Undecided(Undecided),
    /// They do not agree.
    Wrong(Fault),
}

/// A class of random models.
pub trait Puzzle: Sized + Clone + Debug + PartialEq {
    /// What the reference makes of a model.
    type Outcome;

    /// How often the reference may be made finer.
    const EFFORT: u32 = 1;

    /// The model of a seed.
    fn of(seed: u64) -> Self;

    /// Its diagram, put as the variant says.
    fn text(&self, variant: &Variant) -> String;

    /// What comes out, or why nobody knows. The greater the effort, the shorter the steps. What is changed to see what depends on
    /// it is changed by the part `change` of what a run at default settings may be off by.
    ///
    /// # Errors
    /// Says why nobody knows.
    fn refer(&self, effort: u32, change: f64) -> Result<Self::Outcome, Undecided>;

    /// The first difference between a run and what is known, if there is one.
    fn compare(&self, outcome: &Self::Outcome, run: &Run) -> Option<Fault>;

    /// Models that are a little simpler, the much simpler ones first.
    fn simpler(&self) -> Vec<Self>;

    /// The same with an earlier end, where signals may grow beyond all bounds.
    fn shorter(&self) -> Option<Self> {
        None
    }

    /// Runs it by the engine and by the reference. Where these differ, and where the reference is too coarse, it is made finer
    /// before it is believed. What grows is looked at as long as it is small.
    fn judge(&self, variant: &Variant) -> Finding {
        let run = OnceCell::new();
        let mut finding = Finding::Undecided(Undecided::Coarse);
        for effort in 0..=Self::EFFORT {
            let outcome = match self.refer(effort, 1.0) {
                Ok(outcome) => outcome,
                Err(why @ (Undecided::Coarse | Undecided::Grazes)) => {
                    if !matches!(finding, Finding::Wrong(_)) {
                        finding = Finding::Undecided(why);
                    }
                    continue;
                }
                Err(Undecided::Sensitive) => return self.judge_closely(effort, variant),
                Err(Undecided::Grows) => {
                    let shorter = self.shorter();
                    return shorter
                        .map_or(Finding::Undecided(Undecided::Grows), |shorter| shorter.judge(variant));
                }
                Err(why) => return Finding::Undecided(why),
            };
            let fault = match run.get_or_init(|| by_engine(&self.text(variant))) {
                Ok(run) => self.compare(&outcome, run),
                Err(fault) => return Finding::Wrong(fault.clone()),
            };
            match fault {
                None => return Finding::Right,
                Some(fault) => finding = Finding::Wrong(fault),
            }
        }
        finding
    }

    /// Runs it by the engine alone and looks at all watched conditions on a fine grid: none may have been passed over. Needs no reference, and
    /// sees what hardly changes any value.
    fn audit(&self, variant: &Variant) -> Finding {
        let (compiled, problems) = compile_text(&self.text(variant));
        let Some(schedule) = compiled.schedule else {
            return Finding::Wrong(Fault::new("refused", problems));
        };
        let (_, findings) = run_audited(schedule);
        if let Some(pair) = findings.iter().flat_map(|findings| &findings.undeclared).next() {
            let what = format!("the derivative of {} depends on {}", pair.derivative, pair.state);
            return Finding::Wrong(Fault::new("undeclared", what));
        }
        match findings.and_then(|findings| findings.missed.into_iter().next()) {
            // A few units in the last place of what is drawn here.
            Some(Missed { beyond, .. }) if beyond < ROUNDING => Finding::Undecided(Undecided::Grazes),
            Some(Missed { t, path, what, beyond }) => {
                let what = format!("{path} ({what}) was beyond zero by {beyond:e} at {t} s");
                Finding::Wrong(Fault::new("missed", what))
            }
            None => Finding::Right,
        }
    }

    /// Of a model that turns out otherwise if something changes by some millionths: a run that is as the reference says is
    /// right. Of another one nobody can tell, as long as tight tolerances bring what the reference says.
    fn judge_closely(&self, effort: u32, variant: &Variant) -> Finding {
        let mut finding = Finding::Undecided(Undecided::Sensitive);
        let Some(tight) = variant.tight() else { return finding };
        let runs = [variant, &tight].map(|variant| (variant, OnceCell::new()));
        for effort in effort..=Self::EFFORT {
            let Ok(outcome) = self.refer(effort, CLOSE) else { continue };
            for (variant, run) in &runs {
                let fault = match run.get_or_init(|| by_engine(&self.text(variant))) {
                    Ok(run) => self.compare(&outcome, run),
                    // So many steps may be too many for a memory.
                    Err(_) if variant.settings == tight.settings => {
                        return Finding::Undecided(Undecided::Sensitive);
                    }
                    Err(fault) => return Finding::Wrong(fault.clone()),
                };
                match fault {
                    None if variant.settings == tight.settings => {
                        return Finding::Undecided(Undecided::Sensitive);
                    }
                    None => return Finding::Right,
                    Some(fault) => finding = Finding::Wrong(fault),
                }
            }
        }
        finding
    }
}

/// What is closer to zero than this was not passed over but is rounding.
const ROUNDING: f64 = 1e-12;

/// By which part of that what depends on changes at tight tolerances is changed.
const CLOSE: f64 = 1e-3;

/// Runs a diagram; a fault where it is refused or fails.
pub(super) fn by_engine(text: &str) -> Result<Run, Fault> {
    let (compiled, problems) = compile_text(text);
    let schedule = compiled.schedule.ok_or_else(|| Fault::new("refused", problems))?;
    let run = run(schedule);
    match &run.error {
        Some(error) => Err(Fault::new("refused", format!("{} {}", error.code, error.message))),
        None => Ok(run),
    }
}

/// What becomes of a model: [`Puzzle::judge`] or [`Puzzle::audit`].
pub type Judge<P> = fn(&P, &Variant) -> Finding;

/// Smaller models that are tried at most.
const TRIES: usize = 400;

/// The smallest model that still fails in the same way.
pub fn least<P: Puzzle>(puzzle: &P, variant: &Variant, judge: Judge<P>) -> P {
    let Finding::Wrong(fault) = judge(puzzle, variant) else { return puzzle.clone() };
    let fails =
        |puzzle: &P| matches!(judge(puzzle, variant), Finding::Wrong(found) if found.kind == fault.kind);
    let mut best = puzzle.clone();
    let mut left = TRIES;
    loop {
        let mut candidates = best.simpler().into_iter().filter(|smaller| *smaller != best);
        let smaller = candidates.find(|smaller| {
            left = left.saturating_sub(1);
            left > 0 && fails(smaller)
        });
        match smaller {
            Some(smaller) => best = smaller,
            None => return best,
        }
    }
}
