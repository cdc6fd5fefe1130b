use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

/// Inductor: $v = L \frac{di}{dt}$. Its current is a state.
///
/// Where only inductances and current sources meet at a node their currents depend on each other: start values must then obey
/// Kirchhoff's law.
///
/// ```ron
/// Inductor(l: "2.5 mH")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Inductor)]
pub struct Inductor {
    /// Inductance, positive.
    #[block(unit = "H", positive, zero = "without inductance it is a wire: join the two nodes instead")]
    pub l: f64,
    /// Current at the start, from `p` to `n`. Where none is given it follows from the inductances in series with it, else zero.
    #[block(unit = "A", finite, default = None)]
    pub i0: Option<f64>,
}

impl Component for Inductor {
    fn part(&self, _given: &Given) -> Part {
        let winding = Element::Winding { p: Pin::Port(0), n: Pin::Port(1), from_state: true };
        let start = self.i0.unwrap_or(0.0);
        let part = Part::new().pins().state_in("i", start, "A").element(winding).current_is(Gives::State(0));
        let part = part.reads("i", "A", Reading::State(0), "current from p to n");
        if self.i0.is_none() { part.currents_follow() } else { part }
    }

    fn reluctance(&self, _c: &Flowing, _internal: &mut [f64], inverse: &mut [f64]) {
        inverse[0] = 1.0 / self.l;
    }

    fn strike(&self, _c: &Fed, volt_seconds: &[f64], x: &mut [f64]) {
        x[0] += volt_seconds[0] / self.l;
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.voltage[0] / self.l;
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::stored(0.5 * self.l * c.x[0] * c.x[0])
    }
}
