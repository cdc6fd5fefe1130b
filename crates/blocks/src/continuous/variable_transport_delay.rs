use blocksim_block::prelude::*;

use super::history::{self, History, Told, note, pass, same};
use super::units::agrees;

/// Delays a signal by a time that is a signal, as a pipe does whose flow varies.
///
/// $$ y(t) = u(t - \tau), \qquad \tau = \min(\max(\tau_u, T_{min}), T_{max}) $$
///
/// with the delay $\tau_u$ at the second input; before the start the input was $y_0$. What comes out has gone in already:
/// the delay is never below $T_{min}$, and steps are a little shorter than that. The input is remembered as exactly as the
/// method knows it. Where the input jumped, or a derivative of it, the time at which that comes out is found as a zero
/// crossing. Direct feedthrough of the delay alone. Vectors are delayed element by element.
///
/// ```ron
/// VariableTransportDelay(min_delay: "10 ms", max_delay: "2 s")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Continuous", symbol = Text("e⁻ˢᵀ"))]
pub struct VariableTransportDelay {
    /// Least delay $T_{min}$, positive; steps are no longer.
    #[block(unit = "s", positive)]
    pub min_delay: f64,
    /// Maximum delay $T_{max}$: the input is remembered for that long.
    #[block(unit = "s", above = min_delay)]
    pub max_delay: f64,
    /// Output until the first input comes out, in the unit of the input.
    #[block(finite, default = 0.0)]
    pub y0: f64,
    /// Most steps within the largest delay that can be remembered, at least 16. Where there are more, the run ends with an
    /// error.
    #[block(at_least = 16, at_most = history::MOST_PIECES, default = 4096)]
    pub buffer: usize,
}

impl VariableTransportDelay {
    fn delay(&self, c: &Context) -> f64 {
        c.scalar(1).clamp(self.min_delay, self.max_delay)
    }
}

impl Block for VariableTransportDelay {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees(given, "y0", "u", u.dimension)?;
        let delay = Input::real("delay").scalar().unit("s");
        let ports =
            Interface::new().input(Input::real("u")).input(delay).output_reading(&[1], Output::like("y", u));
        let states = history::states(ports, u.shape.len(), self.buffer)?;
        let guarded = states.guard_when(Crossing::Holds, "next").guard_when(Crossing::Holds, "last");
        let guarded = guarded.called("passes a jump of its input on", "passes a jump of its input on");
        Ok(guarded.uses_time().remembers(self.min_delay))
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        let history = History::new(c.d, y.len());
        let (last, next) = history.window();
        if !history.read((c.t - self.delay(c)).clamp(last, next), y) {
            y.fill(self.y0);
        }
    }

    /// What is read lies between the breaks ahead and behind: how far it is from them.
    fn guards(&self, c: &Context, _w: &mut Scratch, g: &mut [f64]) {
        let (last, next) = History::new(c.d, c.input(0).len()).window();
        let s = c.t - self.delay(c);
        // Nothing is infinite that the engine takes for a distance.
        g[0] = if next == f64::INFINITY { self.max_delay } else { next - s };
        g[1] = if last == f64::MIN { self.max_delay } else { s - last + 3.0 * same(c.resolution, c.t) };
    }

    fn rest(&self, c: &Context, d: &mut [f64]) -> bool {
        history::rest(c.t, c.input(0), self.max_delay, d);
        true
    }

    fn remember(&self, c: &Context, piece: &Piece, d: &mut [f64]) {
        let told =
            Told { n: c.input(0).len(), initial: self.y0, delay: self.delay(c), longest: self.max_delay };
        note(c, d, piece, told);
    }

    fn reach(&self, c: &Context, d: &mut [f64]) {
        pass(c, d, self.delay(c));
    }
}

#[cfg(test)]
#[path = "variable_transport_delay_tests.rs"]
mod tests;
