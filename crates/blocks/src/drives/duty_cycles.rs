use blocksim_block::prelude::*;

use super::modulation::{Modulation, duty};
use super::switching;

/// Duties of a three-phase bridge for phase voltages, for a converter without its switching.
///
/// $$ m_x = \frac{v_x + v_0}{V_{dc}/2}, \qquad d_x = \min(\max((1 + m_x)/2, 0), 1) $$
///
/// The laws of modulation, which differ in $v_0$, are those of `PwmGenerator`; here nothing is sampled. An
/// `AverageValueConverter` makes phase voltages of the duties whose differences are those of $v$, as long as no duty is
/// at its limit. Without a DC link the duties are 1/2. Where the duties jump, since another leg rests or the link comes or
/// goes, the solver stops; in between the piece of the law is held.
///
/// ```ron
/// DutyCycles(modulation: SpaceVector)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Text("duty"))]
pub struct DutyCycles {
    /// `Sine`, `SpaceVector`, or any other law of `PwmGenerator`.
    #[block(default = Modulation::SpaceVector)]
    pub modulation: Modulation,
}

const V: usize = 0;
const VDC: usize = 1;

impl Block for DutyCycles {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let three = PortType::vector(3);
        let wanted =
            Input::real("v").shape(Shape::Vector(3)).unit("V").doc("required phase voltages a, b, c");
        let interface = Interface::new()
            .input(wanted)
            .input(Input::real("vdc").scalar().unit("V").doc("voltage of the DC link"))
            .output(Output::like("duty", three).doc("share of the time during which each leg is high"))
            .output(Output::like("modulation", three).doc("of each leg, -1 (always low) to 1 (always high)"));
        Ok(switching::hold_branches(interface, self.modulation))
    }

    fn law(&self, l: &Recording) -> bool {
        let v = [0, 1, 2].map(|phase| l.input(V)[phase]);
        let [held, _] = switching::record_branches(l, self.modulation, (v, l.u(VDC)), [0, 0]);
        let duties = self.modulation.references_of(v, l.u(VDC), held).map(duty);
        l.each(0, |leg| duties[leg]);
        l.each(1, |leg| 2.0 * duties[leg] - 1.0);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn differences_of_the_duties_are_the_voltages_between_the_phases() {
        let inputs = vec![("v".to_owned(), PortType::vector(3)), ("vdc".to_owned(), PortType::scalar())];
        for modulation in [Modulation::Sine, Modulation::SpaceVector, Modulation::Discontinuous60] {
            let mut bench = Bench::with_inputs(DutyCycles { modulation }, inputs.clone());
            let y = bench.set(V, &[200.0, -40.0, -160.0]).set(VDC, &[560.0]).major();
            assert!((560.0 * (y[0] - y[1]) - 240.0).abs() < 1e-12, "{y:?}");
            assert!((560.0 * (y[1] - y[2]) - 120.0).abs() < 1e-12, "{y:?}");
            assert_eq!(y[3], 2.0 * y[0] - 1.0);
        }
        let mut bench = Bench::with_inputs(DutyCycles { modulation: Modulation::Sine }, inputs);
        assert_eq!(bench.set(V, &[600.0, -600.0, 0.0]).set(VDC, &[560.0]).major()[..3], [1.0, 0.0, 0.5]);
        assert_eq!(bench.set(VDC, &[0.0]).major()[..3], [0.5; 3]);
    }
}
