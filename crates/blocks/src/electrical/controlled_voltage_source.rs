use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

/// Ideal voltage source that a signal commands: $v_p - v_n = v$, whatever current that takes.
///
/// Capacitors across it take its voltage; the current through them contains its derivative: connect `dv` where something measures
/// that current.
///
/// ```ron
/// ControlledVoltageSource
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = VoltageSource)]
pub struct ControlledVoltageSource;

impl Component for ControlledVoltageSource {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .input(Input::real("v").scalar().unit("V").doc("voltage from p to n"))
            .input(Input::real("dv").scalar().unit("V/s").default(0.0).doc("derivative of v"))
            .rate_input()
            .element(Element::VoltageSource { p: Pin::Port(0), n: Pin::Port(1) })
            .voltage_is(Gives::Input(0))
    }

    fn voltage_rates(&self, c: &Moving, dv: &mut [f64]) {
        dv[0] = c.scalar(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn the_voltage_is_the_input() {
        let mut v = [0.0];
        let part = ControlledVoltageSource.part(&Given::nothing());
        part.write_voltages(&ControlledVoltageSource, &Seen { u: &[-48.0, 0.0], ..law() }.loaded(), &mut v);
        assert_eq!(v[0], -48.0);
    }
}
