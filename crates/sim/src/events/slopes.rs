//! What is known of how guards move.

/// What is known of the guards from the step before, and what is suspected in this one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Turns {
    /// Values at the start of the step before, and its length in s; zero if there is none to compare with.
    pub before: Vec<f64>,
    pub length: f64,
    /// Slopes at the start of the step, 1/s.
    pub start: Vec<f64>,
    /// Whether they are known.
    pub start_known: bool,
    /// Slopes at its end, 1/s.
    pub end: Vec<f64>,
    /// Whether they are known.
    pub end_known: bool,
    /// How many looks there were within this step.
    pub looks: usize,
    /// The guards to be looked at.
    pub turning: Vec<Turn>,
}

/// An extremum that may lie beyond zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turn {
    pub guard: usize,
    /// Where it is expected, in parts of the step.
    pub at: f64,
    /// Value at the end of the step.
    pub end: f64,
}

impl Turns {
    pub fn new(guards: usize) -> Self {
        let zeros = vec![0.0; guards];
        Self {
            before: zeros.clone(),
            length: 0.0,
            start: zeros.clone(),
            start_known: false,
            end: zeros,
            end_known: false,
            looks: 0,
            turning: Vec::with_capacity(guards),
        }
    }

    /// The step has ended and the next one goes on from there; `start` are its values at the start.
    pub fn pass(&mut self, start: &[f64], length: f64) {
        self.before.copy_from_slice(start);
        self.length = length;
        std::mem::swap(&mut self.start, &mut self.end);
        self.start_known = std::mem::take(&mut self.end_known);
    }

    /// Slopes have changed by a jump.
    pub fn forget_slopes(&mut self) {
        (self.start_known, self.end_known) = (false, false);
    }

    /// Values have changed by a jump.
    pub fn forget(&mut self) {
        self.forget_slopes();
        self.length = 0.0;
    }
}
