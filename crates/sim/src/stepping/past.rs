//! What blocks remember of accepted steps: their inputs, as exactly as the method knows them.

use blocksim_block::schedule::{Schedule, Solver};
use blocksim_block::{NODES, Piece, roughness};

use crate::{SimError, Simulation, diagnose};

/// Most halvings of a step.
const HALVINGS: i32 = 10;

/// What is left where large values cancel is rough from rounding, as a share of the largest value so far.
const ROUNDING: f64 = 1e-12;

/// The inputs of blocks that remember over the present piece of a step.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Past {
    /// Of each block the values of its inputs at each node.
    inputs: Vec<f64>,
    /// Number of values of the inputs of each block.
    widths: Vec<usize>,
    /// Whether something may have jumped since the last piece.
    pub fresh: bool,
    /// When a derivative of what is remembered jumps next, s.
    pub kink: f64,
    /// How rough, as a share of its size, a signal over a piece may be.
    roughness: f64,
    /// The largest absolute value of each input so far.
    sizes: Vec<f64>,
}

impl Past {
    pub fn new(schedule: &Schedule) -> Self {
        let remembering = schedule.blocks.iter().filter(|block| block.interface.remembers.is_some());
        let widths: Vec<usize> =
            remembering.map(|block| block.gather.iter().map(|copy| copy.1 as usize).sum()).collect();
        Self {
            inputs: vec![0.0; NODES.len() * widths.iter().sum::<usize>()],
            sizes: vec![0.0; widths.iter().sum()],
            widths,
            fresh: true,
            kink: f64::INFINITY,
            roughness: match schedule.settings.solver {
                Solver::Fixed { .. } => 1e-4,
                Solver::Variable { rtol, .. } => rtol.clamp(1e-8, 1e-3),
            },
        }
    }

    /// Whether the present step begins with something that will come out of a memory and be stopped at.
    pub fn is_new(&self) -> bool {
        self.fresh && !self.widths.is_empty()
    }

    /// The values at the end of the last piece are those at the beginning of the next one.
    fn go_on(&mut self) {
        let mut at = 0;
        for &width in &self.widths {
            let last = at + (NODES.len() - 1) * width;
            self.inputs.copy_within(last..last + width, at);
            at += NODES.len() * width;
        }
    }

    /// Whether the polynomial through the nodes does not tell enough of an input.
    fn is_rough(&mut self) -> bool {
        let Self { inputs, widths, sizes, .. } = self;
        let (mut at, mut first, mut rough) = (0, 0, false);
        for &width in widths.iter() {
            for (input, largest) in sizes[first..first + width].iter_mut().enumerate() {
                let values = std::array::from_fn(|node| inputs[at + node * width + input]);
                let size = values.iter().fold(0.0_f64, |size, value: &f64| size.max(value.abs()));
                *largest = largest.max(size);
                rough |= roughness(values) > (self.roughness * size).max(ROUNDING * *largest);
            }
            at += NODES.len() * width;
            first += width;
        }
        rough
    }
}

impl Simulation {
    /// Lets blocks remember the step that began at `start`. A step over which an input is rough, because it depends on time
    /// and not on states alone, is told in parts.
    pub(crate) fn remember(&mut self, start: f64) -> Result<(), SimError> {
        if self.diagram.plan.remembering.is_empty() || self.t <= start {
            return Ok(());
        }
        // What comes out of a memory and goes in again must not lose digits on its way through.
        self.stepper.iter_mut().for_each(|stepper| stepper.sharpen(&mut self.diagram));
        let whole = self.t - start;
        let (mut begin, mut length) = (start, whole);
        while begin < self.t {
            let end = if begin + length >= self.t - 1e-6 * length { self.t } else { begin + length };
            let is_fresh = self.past.fresh && begin == start;
            for (node, share) in NODES.into_iter().enumerate() {
                if node == 0 && !is_fresh {
                    self.past.go_on();
                } else {
                    self.look(node, if share == 1.0 { end } else { begin + share * (end - begin) })?;
                }
            }
            // What is no longer than the resolution of time is rough from rounding alone.
            if self.past.is_rough() && length > (whole * 0.5_f64.powi(HALVINGS)).max(2.0 * self.same()) {
                // What was the end is not the beginning of the next piece: it is looked at again.
                length *= 0.5;
                self.look(NODES.len() - 1, begin)?;
                continue;
            }
            let piece = Piece { begin, end, is_fresh, inputs: &self.past.inputs };
            let told = self.diagram.remember(&piece);
            self.held(told)?;
            begin = end;
        }
        self.past.fresh = false;
        Ok(())
    }

    /// Lets out what blocks remember, up to the present time.
    pub(crate) fn reach(&mut self) -> Result<(), SimError> {
        if self.diagram.plan.remembering.is_empty() {
            return Ok(());
        }
        let evaluated = self.diagram.continuous(self.t, &self.x);
        self.held(evaluated)?;
        let reached = self.diagram.reach();
        // The breaks that are next may stand in their guards.
        self.guards.known = false;
        self.held(reached)
    }

    /// Takes the inputs at a time within the last step.
    fn look(&mut self, node: usize, t: f64) -> Result<(), SimError> {
        let evaluated = match &self.stepper {
            Some(stepper) if t != self.t => {
                stepper.interpolate(t, &mut self.guards.x);
                self.diagram.continuous(t, &self.guards.x)
            }
            _ => self.diagram.continuous(t, &self.x),
        };
        self.held(evaluated)?;
        self.diagram.inputs(node, &mut self.past.inputs);
        if self.past.inputs.iter().all(|value| value.is_finite()) {
            return Ok(());
        }
        Err(diagnose::not_finite(&self.schedule, &self.diagram, &self.x))
    }
}
