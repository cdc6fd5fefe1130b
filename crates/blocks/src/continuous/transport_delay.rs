use blocksim_block::prelude::*;

use super::history::{self, History, Told, note, pass};
use super::units::agrees;

/// Delays a signal by a fixed time (dead time).
///
/// $$ y(t) = \begin{cases} y_0 & t < t_0 + T \\ u(t - T) & t \ge t_0 + T \end{cases} \qquad G(s) = e^{-T s} $$
///
/// where $t_0$ is the start. The input is remembered as exactly as the method knows it: each accepted step as a polynomial
/// of degree four through its dense output. A jump of the input comes out as a jump, which is hit exactly; where its slope,
/// curvature or third derivative jumps, a step ends, too. Steps are a little shorter than the delay; a method of fixed step
/// needs one that is not longer than it. No direct feedthrough, so it breaks an algebraic loop. Vectors are delayed element
/// by element.
///
/// ```ron
/// TransportDelay(delay: "20 ms")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Continuous", symbol = Text("e⁻ˢᵀ"))]
pub struct TransportDelay {
    /// Delay $T$, positive.
    #[block(unit = "s", positive)]
    pub delay: f64,
    /// Output until the first input comes out, in the unit of the input.
    #[block(finite, default = 0.0)]
    pub y0: f64,
    /// Most steps within the delay that can be remembered, at least 16. Where there are more, the run ends with an error.
    #[block(at_least = 16, at_most = history::MOST_PIECES, default = 4096)]
    pub buffer: usize,
}

impl Block for TransportDelay {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees(given, "y0", "u", u.dimension)?;
        let ports = Interface::new().input(Input::real("u")).output_from_state(Output::like("y", u));
        let states = history::states(ports, u.shape.len(), self.buffer)?;
        Ok(states.uses_time().time_events().remembers(self.delay).delays(self.delay))
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        if !History::new(c.d, y.len()).read(c.t - self.delay, y) {
            y.fill(self.y0);
        }
    }

    fn next_event(&self, c: &Context) -> f64 {
        History::new(c.d, c.input(0).len()).next_jump() + self.delay
    }

    fn next_kink(&self, c: &Context) -> f64 {
        History::new(c.d, c.input(0).len()).next_kink() + self.delay
    }

    fn rest(&self, c: &Context, d: &mut [f64]) -> bool {
        history::rest(c.t, c.input(0), self.delay, d);
        true
    }

    fn remember(&self, c: &Context, piece: &Piece, d: &mut [f64]) {
        let n = c.input(0).len();
        note(c, d, piece, Told { n, initial: self.y0, delay: self.delay, longest: self.delay });
    }

    fn reach(&self, c: &Context, d: &mut [f64]) {
        pass(c, d, self.delay);
    }
}

#[cfg(test)]
#[path = "transport_delay_tests.rs"]
mod tests;
