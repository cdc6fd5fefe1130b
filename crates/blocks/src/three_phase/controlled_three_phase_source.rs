use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Three ideal voltage sources in star that a signal commands: phase a, b, c against the star point `n`.
///
/// Capacitors across it take its voltages; the currents through them contain their derivatives: connect `dv` where something measures
/// these currents or the power.
///
/// Connect `n` to a reference where the star point is grounded. Left open it floats: the three currents add up to zero.
///
/// ```ron
/// ControlledThreePhaseSource
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Three-phase", symbol = AcSource)]
pub struct ControlledThreePhaseSource;

impl Component for ControlledThreePhaseSource {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new()
            .port("ac", Domain::ThreePhase, "phases a, b, c")
            .port("n", Domain::Electrical, "star point; may stay open")
            .open()
            .input(Input::real("v").shape(Shape::Vector(3)).unit("V").doc("voltages of a, b, c against n"))
            .input(Input::real("dv").shape(Shape::Vector(3)).unit("V/s").default(0.0).doc("derivatives of v"))
            .rate_input()
            .measures("power", "W", Needs::Electrics, "power that the source delivers");
        let source = |k| Element::VoltageSource { p: Pin::Phase(0, k), n: Pin::Port(1) };
        (0..3).map(source).fold(part, Part::element)
    }

    fn voltages(&self, c: &Moving, v: &mut [f64]) {
        v.copy_from_slice(c.input(0));
    }

    fn voltage_rates(&self, c: &Moving, dv: &mut [f64]) {
        dv.copy_from_slice(c.input(1));
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y[0] = -c.voltage.iter().zip(c.current).map(|(v, i)| v * i).sum::<f64>();
    }
}
