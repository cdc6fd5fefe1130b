use std::f64::consts::TAU;

use blocksim_block::physical::{Domain, Element, Pin, Supply};
use blocksim_block::prelude::*;

use super::space_vector::turned;
use crate::drives::modulation::{Carrier, Modulation, Modulator, Sampling};

/// Three-phase inverter with every edge of its switching, on an ideal DC link.
///
/// $$ \dot\theta = 2\pi f, \qquad v^*_a = v \cos\theta, \qquad v_{aN} = s_a V_{dc}, \quad s_a \in \{0, 1\} $$
///
/// The legs are ideal: no dead time, no voltage across a switch. The references are compared with a triangular
/// carrier, once or twice in each of its periods (`sampling`), at the angle of the middle of the time that the sample
/// holds for; the edges follow from the duties and are hit exactly. It takes the same inputs as `AveragedInverter`, which
/// gives the mean of these voltages.
///
/// `integration: Together` leaves the circuit to the solver of the diagram, which stops at every edge. `Separate`
/// integrates the circuit by itself, from edge to edge, and couples it to the mechanics every so many periods of the
/// carrier: the shaft gets the mean torque of these periods, the machine the speed that is expected for them. That is
/// many times faster, and exact to second order in the length of a coupling step; what is recorded of the circuit are then
/// its values at the beginnings of coupling steps.
///
/// ```ron
/// SwitchedInverter(vdc: "560 V", switching_frequency: "8 kHz", integration: Separate(periods: 1))
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical")]
pub struct SwitchedInverter {
    /// Voltage of the DC link.
    #[block(unit = "V")]
    pub vdc: f64,
    /// Frequency of the carrier.
    #[block(unit = "Hz")]
    pub switching_frequency: f64,
    /// `Sine` or `SpaceVector`, or any other law of `PwmGenerator`.
    #[block(default = Modulation::Sine)]
    pub modulation: Modulation,
    /// `Symmetric` (one sample in each period of the carrier) or `Asymmetric` (two).
    #[block(default = Sampling::Symmetric)]
    pub sampling: Sampling,
    /// `Together` or `Separate(periods: ..)`.
    #[block(default = Integration::Together)]
    pub integration: Integration,
}

/// Who integrates the circuit of an inverter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Integration {
    /// The solver of the diagram.
    #[default]
    Together,
    /// The circuit by itself.
    Separate {
        /// Periods of the carrier in a coupling step, at least 1.
        periods: u32,
    },
}

const V: usize = 0;
const F: usize = 1;
const REVERSE: usize = 2;

const LEGS: usize = 3;

impl SwitchedInverter {
    fn modulator(&self) -> Modulator {
        let carrier = Carrier { frequency: self.switching_frequency };
        Modulator { carrier, sampling: self.sampling, dead_time: 0.0 }
    }

    /// Reference voltages of the phases, V.
    fn references(&self, c: &Law) -> [f64; LEGS] {
        let amplitude = c.scalar(V).clamp(0.0, self.modulation.limit(self.vdc));
        // Duties hold from one sample to the next: their references are those of the middle.
        let samples = if self.sampling == Sampling::Asymmetric { 2.0 } else { 1.0 };
        let middle = c.x[0] + 0.5 * TAU * c.scalar(F) / (samples * self.switching_frequency);
        let [a, b, c_] = Supply { voltage: turned([amplitude, 0.0], middle), ..Supply::default() }.phases();
        if c.scalar(REVERSE) == 0.0 { [a, b, c_] } else { [a, c_, b] }
    }

    /// Voltage of a leg against the negative rail, V.
    fn pole(&self, c: &Law, leg: usize) -> f64 {
        if Modulator::is_high(c.d, leg) { self.vdc } else { 0.0 }
    }
}

impl Block for SwitchedInverter {
    fn check(&self) -> Result<(), ParamError> {
        positive("vdc", self.vdc)?;
        positive("switching_frequency", self.switching_frequency)?;
        if self.sampling == Sampling::Natural {
            return Err(ParamError::new(
                "sampling",
                "`Natural` sampling has no edges that are known beforehand",
            )
            .help("write `Symmetric` or `Asymmetric`, or use PwmGenerator with a SixPulseInverter"));
        }
        if self.integration == (Integration::Separate { periods: 0 }) {
            return Err(ParamError::new("integration", "`periods` is 0, but a coupling step takes time")
                .help("write `Separate(periods: 1)`"));
        }
        Ok(())
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for SwitchedInverter {
    fn part(&self, _given: &Given) -> Part {
        let mut part = Part::new()
            .port("ac", Domain::ThreePhase, "phases a, b, c")
            .input(Input::real("v").scalar().unit("V").doc("amplitude: peak phase voltage"))
            .input(Input::real("f").scalar().unit("Hz").doc("frequency; may be negative"))
            .input(Input::boolean("reverse").scalar().default(0.0).doc("exchanges the phases b and c"))
            .measures("theta", "rad", Needs::State, "angle of the references")
            .output(
                Output::real("v_legs").unit("V").shape(Shape::Vector(LEGS)).doc("voltages of the legs"),
                Needs::State,
            )
            .measures("power", "W", Needs::Electrics, "power taken from the DC link")
            .state("theta", 0.0)
            .jumps()
            .time_events()
            .holds();
        for (i, cell) in Modulator::initial(LEGS).into_iter().enumerate() {
            part = part.discrete(&format!("modulator[{i}]"), cell);
        }
        for phase in 0..LEGS {
            part = part.element(Element::VoltageSource { p: Pin::Phase(0, phase), n: Pin::Ground });
        }
        match self.integration {
            Integration::Together => part,
            Integration::Separate { periods } => part.separate(f64::from(periods) / self.switching_frequency),
        }
    }

    fn voltages(&self, c: &Law, v: &mut [f64]) {
        v.iter_mut().enumerate().for_each(|(leg, v)| *v = self.pole(c, leg));
    }

    fn derivatives(&self, c: &Law, dx: &mut [f64]) {
        dx[0] = TAU * c.scalar(F);
    }

    fn jump(&self, c: &Law, _x: &mut [f64], d: &mut [f64]) -> bool {
        let duties = self.modulation.duties(self.references(c), self.vdc);
        self.modulator().settle(c.t, &duties, d)
    }

    fn next_event(&self, c: &Law) -> f64 {
        self.modulator().next_event(c.t, c.d)
    }

    fn measure(&self, c: &Law, needs: Needs, y: &mut [f64]) {
        match needs {
            Needs::State => {
                y[0] = c.x[0];
                self.voltages(c, &mut y[1..1 + LEGS]);
            }
            // The current of a source is counted from its positive pin through it.
            Needs::Electrics => y[1 + LEGS] = (0..LEGS).map(|leg| -self.pole(c, leg) * c.current[leg]).sum(),
            Needs::Motion => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INVERTER: SwitchedInverter = SwitchedInverter {
        vdc: 400.0,
        switching_frequency: 8e3,
        modulation: Modulation::SpaceVector,
        sampling: Sampling::Symmetric,
        integration: Integration::Together,
    };

    #[test]
    fn the_mean_of_the_voltages_between_the_legs_is_that_of_the_references() {
        let inputs = [(0, 1), (1, 2), (2, 3)];
        let mut memory = Modulator::initial(LEGS);
        let (mut t, mut mean) = (0.0, [0.0; LEGS]);
        let (x, u) = ([0.7], [150.0, 0.0, 0.0]);
        let end = 1.0 / INVERTER.switching_frequency;
        let law = |t: f64| Law { t, x: &x, u: &u, inputs: &inputs, ..Law::nothing() };
        while t < end {
            Component::jump(&INVERTER, &law(t), &mut [], &mut memory);
            let c = Law { d: &memory, ..law(t) };
            let next = Component::next_event(&INVERTER, &c).min(end);
            for (leg, mean) in mean.iter_mut().enumerate() {
                *mean += INVERTER.pole(&c, leg) * (next - t) / end;
            }
            t = next;
        }
        let references = INVERTER.references(&law(0.0));
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (found, wanted) = (mean[i] - mean[j], references[i] - references[j]);
            assert!((found - wanted).abs() < 1e-9, "{found} != {wanted}");
        }
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let refused = |inverter: SwitchedInverter| inverter.check().unwrap_err().param;
        assert_eq!(refused(SwitchedInverter { vdc: 0.0, ..INVERTER }), "vdc");
        assert_eq!(refused(SwitchedInverter { switching_frequency: 0.0, ..INVERTER }), "switching_frequency");
        assert_eq!(refused(SwitchedInverter { sampling: Sampling::Natural, ..INVERTER }), "sampling");
        let integration = Integration::Separate { periods: 0 };
        assert_eq!(refused(SwitchedInverter { integration, ..INVERTER }), "integration");
        assert_eq!(INVERTER.check(), Ok(()));
    }
}
