//! What states of a block obey wherever it can be.

/// Values that are zero by law, so that as many states follow from the others: closed loops of bodies, windings in series.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Invariant {
    /// What is zero, all of one kind.
    pub gaps: Vec<f64>,
    /// Which states may be said to follow from others by them; the second ones where the first ones do not suffice.
    pub followers: [Vec<usize>; 2],
    /// What they are made of, where that is more: slopes of gaps that are small against those of the terms are rounding.
    pub terms: Vec<f64>,
    /// Whether no impulse brings it about where it does not hold: bodies cannot jump to where their loop is closed.
    pub is_lasting: bool,
}
