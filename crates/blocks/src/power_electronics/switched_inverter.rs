use std::f64::consts::{FRAC_PI_3, TAU};

use blocksim_block::physical::{Domain, Element, Pin, Supply};
use blocksim_block::prelude::*;

use crate::drives::modulation::{Carrier, Modulation, Modulator, Sampling};
use crate::machines::space_vector::turned;

/// Three-phase inverter with every edge of its switching, on an ideal DC link.
///
/// $$ \dot\theta = 2\pi f, \qquad v^*_a = v \cos\theta, \qquad v_{aN} = s_a V_{dc}, \quad s_a \in \{0, 1\} $$
///
/// The legs are ideal: no dead time, no voltage across a switch. The references are compared with a triangular
/// carrier, once or twice in each of its periods (`sampling`), at the angle of the middle of the time that the sample
/// holds for; the edges follow from the duties and are hit exactly. With `Natural` sampling they lie where the references
/// themselves cross the carrier: the angle runs on within each half of a period, at the amplitude and frequency of its
/// beginning, so that the crossing is known beforehand; where the references of a discontinuous law jump, they are looked at again. It
/// takes the same inputs as `AveragedInverter`, which gives the mean of these voltages.
///
/// `integration: Together` leaves the circuit to the solver of the diagram, which stops at every edge. `Separate`
/// integrates the circuit by itself, from edge to edge, and couples it to the mechanics every so many periods of the
/// carrier: the shaft gets the mean torque of these periods, the machine the speed that is expected for them. That is
/// many times faster, and exact to third order in the length of a coupling step, but for what the ripple of the torque does to loads,
/// which falls with the square of the switching frequency. Inputs that change all the time, such as a ramp of the frequency, are
/// expected to go on over a coupling step as they did in the last two; those of a controller that is sampled stay where they are. Where
/// they turn out otherwise, as about a kink, the step is integrated once more when it is over, and where an input of the circuit jumps
/// within a step, the step ends there and what is left of it begins anew; the impulse that the shaft lacks by then is made up for. Where
/// the coupling misses the relative tolerance of the run, as with a light rotor and a slow carrier, a coupling step is divided into up
/// to 64 parts, whose torques follow the ripple. What remains beyond the tolerance is estimated in a warning at the end of the run, which
/// knows nothing of kinks of inputs; and where a shaft does not move at all as its circuit has expected, the run ends with an
/// error, as it does where something in the circuit is thousands of times faster than the carrier.
/// Diodes, and breakers that open at zero current, cannot belong to such a circuit. Methods of fixed step do not divide. What needs
/// voltages (powers, RMS voltages, slip, `v_legs`) is measured on the means over whole coupling steps, a step late; currents, fluxes and
/// states are those at the beginning of a step or a part. A mean over a part of a turn of the field is shorter than the field (by 2 % for 2
/// ms at 55 Hz, and powers, which are products of such means, by 4 %), and without the power of the ripple: for energies write `periods:
/// 1`, or `Together`.
///
/// Amplitudes beyond what the link and the modulation give are limited, as `limited` reports; a negative one turns the voltages
/// by half a turn.
///
/// ```ron
/// SwitchedInverter(vdc: "560 V", switching_frequency: "8 kHz", integration: Separate(periods: 1))
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Converter("=","~"))]
pub struct SwitchedInverter {
    /// Voltage of the DC link.
    #[block(unit = "V", positive)]
    pub vdc: f64,
    /// Frequency of the carrier.
    #[block(unit = "Hz", positive)]
    pub switching_frequency: f64,
    /// `Sine` or `SpaceVector`, or any other law of `PwmGenerator`.
    #[block(default = Modulation::Sine)]
    pub modulation: Modulation,
    /// `Symmetric` (one sample in each period of the carrier), `Asymmetric` (two) or `Natural`.
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

/// Part of a half of the carrier below which an angle counts as reached: more than rounding, and no pulse.
const REACHED: f64 = 1e-9;

impl SwitchedInverter {
    fn modulator(&self) -> Modulator {
        let carrier = Carrier { frequency: self.switching_frequency };
        // A crossing that is known beforehand is the edge of a duty that holds for half a period.
        let sampling = match self.sampling {
            Sampling::Natural => Sampling::Asymmetric,
            regular => regular,
        };
        Modulator { carrier, sampling, dead_time: 0.0 }
    }

    /// Reference voltages of the phases, V, this time later, s.
    fn references(&self, c: &Known, later: f64) -> [f64; LEGS] {
        let limit = self.modulation.limit(self.vdc);
        let amplitude = c.scalar(V).clamp(-limit, limit);
        let angle = c.x[0] + TAU * c.scalar(F) * later;
        let [a, b, c_] = Supply { voltage: turned([amplitude, 0.0], angle), ..Supply::default() }.phases();
        if c.scalar(REVERSE) == 0.0 { [a, b, c_] } else { [a, c_, b] }
    }

    /// Duties that a sample taken now holds.
    fn duties(&self, c: &Known) -> [f64; LEGS] {
        let (carrier, period) = (self.modulator().carrier, 1.0 / self.switching_frequency);
        // Regular samples hold from one to the next: their references are those of the middle.
        let middle = |share: f64| self.modulation.duties(self.references(c, share * period), self.vdc);
        match self.sampling {
            Sampling::Symmetric => middle(0.5),
            Sampling::Asymmetric => middle(0.25),
            Sampling::Natural => {
                let (half, span) = (carrier.half(c.t), [c.t, self.known_until(c)]);
                // Rounding leaves open on which side of a jump the ends are.
                let inside = self.references(c, 0.5 * (span[0] + span[1]) - c.t);
                let branches = self.modulation.branches(inside, self.vdc);
                let of_leg = |leg: usize, t: f64| {
                    let v = self.references(c, t - c.t);
                    0.5 * (1.0 + self.modulation.references_of(v, self.vdc, branches)[leg])
                };
                [0, 1, 2].map(|leg| carrier.natural_duty(half, span, |t| of_leg(leg, t)))
            }
        }
    }

    /// Until when the references of natural sampling run on without a jump, s: to the end of the half, or to the next angle
    /// at which another leg rests.
    fn known_until(&self, c: &Known) -> f64 {
        let (carrier, speed) = (self.modulator().carrier, TAU * c.scalar(F));
        let [start, end] = carrier.span(carrier.half(c.t));
        let Some(jumps_at) = self.modulation.jumps_at() else { return end };
        // In the direction of the turning; what is that close is reached.
        let sector = (c.x[0] - jumps_at) * speed.signum() / FRAC_PI_3;
        let left = 1.0 - sector.rem_euclid(1.0);
        let reached = (end - start) * REACHED;
        let times = [left, left + 1.0].map(|sectors| c.t + sectors * FRAC_PI_3 / speed.abs());
        times.into_iter().find(|t| *t > c.t + reached).map_or(end, |t| t.min(end))
    }

    /// Whether natural sampling has to look at the references again within a half, since they jump.
    fn looks_again(&self) -> bool {
        self.sampling == Sampling::Natural && self.modulation.is_discontinuous()
    }

    /// What the voltages of the legs need: an instant of legs that switch within a coupling step says nothing.
    fn legs_need(&self) -> Needs {
        match self.integration {
            Integration::Together => Needs::State,
            Integration::Separate { .. } => Needs::Electrics,
        }
    }

    /// Voltage of a leg against the negative rail, V.
    fn pole(&self, c: &Known, leg: usize) -> f64 {
        if Modulator::is_high(c.d, leg) { self.vdc } else { 0.0 }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.integration == (Integration::Separate { periods: 0 }) {
            let error =
                ParamError::new("integration.periods", "`periods` is 0, but a coupling step takes time");
            errors.add(error.help("write `Separate(periods: 1)`"));
        }
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
                self.legs_need(),
            )
            .measures("power", "W", Needs::Electrics, "power taken from the DC link")
            .output(Output::boolean("limited").doc("the DC link limits the amplitude"), Needs::Electrics)
            .drifting_state("theta", 0.0)
            .jumps()
            .time_events()
            .holds();
        for (i, cell) in Modulator::initial(LEGS).into_iter().enumerate() {
            part = part.discrete(&format!("modulator[{i}]"), cell);
        }
        if self.looks_again() {
            part = part.discrete("known_until", 0.0);
        }
        for phase in 0..LEGS {
            part = part.element(Element::VoltageSource { p: Pin::Phase(0, phase), n: Pin::Ground });
        }
        match self.integration {
            Integration::Together => part,
            Integration::Separate { periods } => part.separate(f64::from(periods) / self.switching_frequency),
        }
    }

    fn voltages(&self, c: &Moving, v: &mut [f64]) {
        v.iter_mut().enumerate().for_each(|(leg, v)| *v = self.pole(c, leg));
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = TAU * c.scalar(F);
    }

    fn jump(&self, c: &Flowing, _x: &mut [f64], d: &mut [f64]) -> bool {
        let modulator = self.modulator();
        let (memory, known_until) = d.split_at_mut(Modulator::cells(LEGS));
        // Instants that are one but for rounding are hit at the last of them.
        if known_until.first().is_some_and(|until| *until <= c.t) {
            Modulator::sample_at(c.t, memory);
        }
        if !modulator.samples(c.t, memory) {
            return modulator.settle(c.t, &[0.0; LEGS], memory);
        }
        // Crossings are looked for when they are needed.
        let changed = modulator.settle(c.t, &self.duties(c), memory);
        let moved = known_until.first_mut().is_some_and(|until| {
            let next = self.known_until(c);
            std::mem::replace(until, next) != next
        });
        changed || moved
    }

    fn next_event(&self, c: &Known) -> f64 {
        let (memory, known_until) = c.d.split_at(Modulator::cells(LEGS));
        let next = self.modulator().next_event(c.t, memory);
        known_until.iter().filter(|until| **until > c.t).fold(next, |next, until| next.min(*until))
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y[0] = c.x[0];
        if self.legs_need() == Needs::State {
            self.voltages(c, &mut y[1..1 + LEGS]);
        }
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        // The current of a source is counted from its positive pin through it.
        if self.legs_need() == Needs::Electrics {
            y[1..1 + LEGS].copy_from_slice(&c.voltage[..LEGS]);
        }
        y[1 + LEGS] = -c.voltage.iter().zip(c.current).map(|(v, i)| v * i).sum::<f64>();
        y[2 + LEGS] = f64::from(c.scalar(V).abs() > self.modulation.limit(self.vdc));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::Seen;

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
        let law = |t: f64| Seen { t, x: &x, u: &u, inputs: &inputs, ..Seen::NOTHING };
        while t < end {
            Component::jump(&INVERTER, &law(t).loaded(), &mut [], &mut memory);
            let c = Seen { d: &memory, ..law(t) }.loaded();
            let next = Component::next_event(&INVERTER, &c).min(end);
            for (leg, mean) in mean.iter_mut().enumerate() {
                *mean += INVERTER.pole(&c, leg) * (next - t) / end;
            }
            t = next;
        }
        let references = INVERTER.references(&law(0.0).loaded(), 0.0);
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (found, wanted) = (mean[i] - mean[j], references[i] - references[j]);
            assert!((found - wanted).abs() < 1e-9, "{found} != {wanted}");
        }
    }

    /// Edges of leg a: time and level after it.
    fn edges(inverter: &SwitchedInverter, u: [f64; 3], end: f64) -> Vec<(f64, bool)> {
        let inputs = [(0, 1), (1, 2), (2, 3)];
        let (mut memory, mut t, mut edges) = (Modulator::initial(LEGS), 0.0, Vec::new());
        while t < end {
            let (x, before) = ([TAU * u[F] * t], Modulator::is_high(&memory, 0));
            let seen = Seen { t, x: &x, u: &u, inputs: &inputs, ..Seen::NOTHING };
            let law = seen.loaded();
            let old = memory.clone();
            Component::jump(inverter, &law, &mut [], &mut memory);
            let settled = memory.clone();
            assert!(!Component::jump(inverter, &law, &mut [], &mut memory) && settled == memory);
            if Modulator::is_high(&memory, 0) != before && old[0] >= 0.0 {
                edges.push((t, !before));
            }
            t = Component::next_event(inverter, &Seen { d: &memory, ..seen }.loaded());
        }
        edges
    }

    /// `(1 + m cos(w t)) / 2` against the carrier, whose straight lines are inverted again and again: each edge is a fixed
    /// point.
    #[test]
    fn natural_edges_are_the_crossings_of_the_reference_with_the_carrier() {
        let inverter =
            SwitchedInverter { modulation: Modulation::Sine, sampling: Sampling::Natural, ..INVERTER };
        let (f, m, fs) = (137.0, 0.85, 8e3);
        let edges = edges(&inverter, [m * 200.0, f, 0.0], 0.05);
        assert_eq!(edges.len(), 800);
        for (half, (t, high)) in edges.iter().enumerate() {
            assert_eq!(*high, half % 2 == 0);
            let mut expected = *t;
            for _ in 0..60 {
                let duty = 0.5 * (1.0 + m * (TAU * f * expected).cos());
                let share = if *high { 1.0 - duty } else { duty };
                expected = (half as f64 + share) / (2.0 * fs);
            }
            assert!((t - expected).abs() < 1e-14, "half {half}: {t} != {expected}");
        }
    }

    /// Sidebands of the carrier that fall on the fundamental are Bessel functions of order 20: below 1e-15.
    #[test]
    fn the_fundamental_of_natural_sampling_is_the_reference_itself() {
        let fundamental = |sampling: Sampling| {
            let inverter = SwitchedInverter {
                modulation: Modulation::Sine,
                switching_frequency: 21.0 * 50.0,
                sampling,
                ..INVERTER
            };
            let edges = edges(&inverter, [0.8 * 200.0, 50.0, 0.0], 0.02);
            let (mut cos, mut sin) = (0.0, 0.0);
            for (t, high) in edges {
                let sign = if high { -1.0 } else { 1.0 };
                cos += sign * 400.0 * (TAU * 50.0 * t).sin() / std::f64::consts::PI;
                sin -= sign * 400.0 * (TAU * 50.0 * t).cos() / std::f64::consts::PI;
            }
            (cos, sin)
        };
        let (cos, sin) = fundamental(Sampling::Natural);
        assert!((cos - 160.0).abs() < 1e-9 && sin.abs() < 1e-9, "{cos}, {sin}");
        let (cos, sin) = fundamental(Sampling::Symmetric);
        assert!((cos - 160.0).hypot(sin) > 1e-2, "{cos}, {sin}");
    }

    /// Where the references jump a leg may turn and turn back within a half: the carrier is looked at again and again.
    #[test]
    fn natural_legs_are_high_wherever_their_references_are_above_the_carrier() {
        use Modulation::*;
        let (u_of, end, parts) = (|f: f64, reverse: f64| [150.0, f, reverse], 0.04, 64_000);
        for modulation in [
            Discontinuous60,
            Discontinuous60Leading,
            Discontinuous60Lagging,
            Discontinuous30,
            Discontinuous120Upper,
            SpaceVector,
        ] {
            for (u, late) in [
                (u_of(50.0, 0.0), 0.0),
                (u_of(-37.0, 0.0), 1e-13),
                (u_of(61.0, 1.0), 0.0),
                (u_of(61.0, 1.0), 1e-13),
            ] {
                let fs = 17.0 * 53.0;
                let inverter = SwitchedInverter {
                    modulation,
                    switching_frequency: fs,
                    sampling: Sampling::Natural,
                    ..INVERTER
                };
                let inputs = [(0, 1), (1, 2), (2, 3)];
                let mut memory = Modulator::initial(LEGS);
                memory.extend(inverter.looks_again().then_some(0.0));
                let (mut t, mut k, mut wrong) = (0.0, 0, 0);
                while t < end {
                    let x = [0.3 + TAU * u[F] * t];
                    let seen = Seen { t, x: &x, u: &u, inputs: &inputs, ..Seen::NOTHING };
                    Component::jump(&inverter, &seen.loaded(), &mut [], &mut memory);
                    let next = Component::next_event(&inverter, &Seen { d: &memory, ..seen }.loaded());
                    assert!(next > t);
                    while k < parts && end * (f64::from(k) + 0.5) / f64::from(parts) < next {
                        let at = end * (f64::from(k) + 0.5) / f64::from(parts);
                        let carrier = 1.0 - (1.0 - 2.0 * (at * fs).fract()).abs();
                        let angle = 0.3 + TAU * u[F] * at;
                        let mut v = [0.0, 1.0, 2.0].map(|k| 150.0 * (angle - k * TAU / 3.0).cos());
                        if u[REVERSE] != 0.0 {
                            v.swap(1, 2);
                        }
                        for (leg, duty) in modulation.references(v, 400.0).iter().enumerate() {
                            let above = 0.5 * (1.0 + duty) > 1.0 - carrier;
                            wrong += i32::from(above != Modulator::is_high(&memory, leg));
                        }
                        k += 1;
                    }
                    t = next + late;
                }
                assert_eq!((k, wrong), (parts, 0), "{modulation:?}, {u:?}");
            }
        }
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let refused = |inverter: SwitchedInverter| inverter.errors()[0].param.clone();
        assert_eq!(refused(SwitchedInverter { vdc: 0.0, ..INVERTER }), "vdc");
        assert_eq!(refused(SwitchedInverter { switching_frequency: 0.0, ..INVERTER }), "switching_frequency");
        let integration = Integration::Separate { periods: 0 };
        assert_eq!(refused(SwitchedInverter { integration, ..INVERTER }), "integration.periods");
        assert_eq!(INVERTER.errors()[..], []);
    }
}
