use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Measures the voltages between three phases, and of each against their mean.
///
/// The mean is what the star point of a symmetric load has. For the voltage against a certain point use a
/// `PhaseSplitter` and a `VoltageSensor`.
///
/// ```ron
/// ThreePhaseVoltageSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Three-phase", symbol = Meter("V"))]
pub struct ThreePhaseVoltageSensor;

impl Component for ThreePhaseVoltageSensor {
    fn part(&self, _given: &Given) -> Part {
        let three = |name: &str| Output::real(name).shape(Shape::Vector(3)).unit("V");
        let part = Part::new()
            .port("ac", Domain::ThreePhase, "phases a, b, c")
            .output(three("v").doc("phases a, b, c against their mean"), Needs::Electrics)
            .output(three("v_line").doc("from a to b, from b to c, from c to a"), Needs::Electrics);
        let probe = |k| Element::VoltageProbe { p: Pin::Phase(0, k), n: Pin::Phase(0, (k + 1) % 3) };
        (0..3).map(probe).fold(part, Part::element)
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        for k in 0..3 {
            y[k] = (c.voltage[k] - c.voltage[(k + 2) % 3]) / 3.0;
            y[3 + k] = c.voltage[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn voltages_against_the_mean_follow_from_those_between_the_phases() {
        let v: [f64; 3] = [100.0, -20.0, 40.0];
        let between: Vec<f64> = (0..3).map(|k| v[k] - v[(k + 1) % 3]).collect();
        let mut y = [0.0; 6];
        ThreePhaseVoltageSensor.measure_electrics(&Seen { voltage: &between, ..law() }.loaded(), &mut y);
        for (found, expected) in y.iter().zip([60.0, -60.0, 0.0, 120.0, -60.0, -60.0]) {
            assert!((found - expected).abs() < 1e-13);
        }
    }
}
