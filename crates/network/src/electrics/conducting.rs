//! Sets of conducting valves, and why an island may have no solution with one.

/// Which valves of an island conduct, one bit each.
pub(crate) type Conducting = u128;

/// Why there is no solution.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Unsolvable {
    /// Branches that prescribe voltages close a loop: indices of two-pins, with the factors with which their voltages add up to zero;
    /// factors of zero where it is not known which of them do.
    Loop(Vec<(usize, f64)>),
    /// The current of a two-pin that somebody looks at, the first, asks for the slope of a voltage, the second, that
    /// nobody knows; or its voltage for the slope of a current.
    Slope(usize, usize),
    /// Nothing determines the potential of a part of the circuit: its nodes.
    Floating(Vec<usize>),
    /// Given currents that are no states have no path: indices of two-pins.
    Cut(Vec<usize>),
}
