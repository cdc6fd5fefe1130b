//! What all classes of random models have in common: a model of a seed, its judge, smaller models.

use std::fmt::Debug;

/// What became of a model.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// Engine and reference agree.
    Right,
    /// Nobody can say what comes out, and why.
    Undecided(&'static str),
    /// They do not agree: the kind of fault, and what it is in words.
    Wrong(&'static str, String),
}

/// A class of random models.
pub trait Puzzle: Sized + Clone + Debug + PartialEq {
    /// The model of a seed.
    fn of(seed: u64) -> Self;

    /// Its diagram; `settings` follow the stop time, such as `, solver: Ode23()`.
    fn text(&self, settings: &str) -> String;

    /// Runs it by the engine and by the reference.
    fn judge(&self, settings: &str) -> Finding;

    /// Models that are a little simpler, the much simpler ones first.
    fn simpler(&self) -> Vec<Self>;
}

/// The smallest model that still fails in the same way.
pub fn least<P: Puzzle>(puzzle: &P, settings: &str) -> P {
    let Finding::Wrong(kind, _) = puzzle.judge(settings) else { return puzzle.clone() };
    let fails = |puzzle: &P| matches!(puzzle.judge(settings), Finding::Wrong(found, _) if found == kind);
    let mut best = puzzle.clone();
    for _ in 0..50 {
        let Some(smaller) = best.simpler().into_iter().find(|smaller| *smaller != best && fails(smaller))
        else {
            return best;
        };
        best = smaller;
    }
    best
}
