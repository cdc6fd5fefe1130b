use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

/// Capacitor of a DC link, with the resistance in series to it.
///
/// $$ C \frac{dv}{dt} = i, \qquad v_p - v_n = v + R i $$
///
/// The output `v` is the voltage of the capacitor without that of the resistance: a state, so that a modulator or a chopper
/// may look at it without an algebraic loop. Without a resistance, in parallel to an ideal source, it is the voltage of that.
///
/// ```ron
/// DcLink(c: "1 mF", r: "20 mOhm", v0: "560 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Capacitor)]
pub struct DcLink {
    /// Capacitance, positive.
    #[block(unit = "F", positive)]
    pub c: f64,
    /// Resistance in series.
    #[block(unit = "Ohm", not_negative, default = 0.0)]
    pub r: f64,
    /// Voltage at the start. Where none is given it follows from ideal voltages around it, else zero.
    #[block(unit = "V", finite, default = None)]
    pub v0: Option<f64>,
}

impl Component for DcLink {
    fn part(&self, _given: &Given) -> Part {
        let inner = if self.r == 0.0 { Pin::Port(0) } else { Pin::Inner(0) };
        let part = Part::new()
            .pins()
            .state_in("v", self.v0.unwrap_or(0.0), "V")
            .element(Element::Capacitance {
                p: inner,
                n: Pin::Port(1),
                capacitance: self.c,
                state: 0,
                start: self.v0,
            })
            .voltage_is(Gives::State(0))
            .reads("v", "V", Reading::State(0), "voltage of the capacitor");
        match self.r {
            0.0 => part,
            resistance => part.element(Element::Resistance { p: Pin::Port(0), n: inner, resistance }),
        }
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.current[0] / self.c;
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::stored(0.5 * self.c * c.x[0] * c.x[0])
    }
}
