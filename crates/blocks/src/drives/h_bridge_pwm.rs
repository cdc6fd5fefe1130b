use blocksim_block::prelude::*;

use super::modulation::{Amount, Carrier, Modulator, Sampling};
use super::switching::{self, GATES};

/// Gates of an H bridge (two legs, four switches) for a DC machine or one phase: pulse-width modulation.
///
/// The mean of the voltage between the legs over a period of the carrier is $m V_{dc}$, with $-1 \le m \le 1$; more is
/// cut off.
///
/// - `Bipolar`: both legs turn together, against each other; the voltage is $V_{dc}$ during $d = (1 + m)/2$ of the
///   period and $-V_{dc}$ during the rest.
/// - `Unipolar`: leg a is high for $(1 + m)/2$ of the period, leg b for $(1 - m)/2$. The voltage is 0 or that of the sign
///   of $m$, in two pulses a period: half the step and twice the frequency in the current.
///
/// Sampling and dead time are those of `PwmGenerator`.
///
/// ```ron
/// HBridgePwm(switching_frequency: "20 kHz", scheme: Unipolar)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Curve(Modulation))]
pub struct HBridgePwm {
    /// Periods of the carrier per second, positive.
    #[block(unit = "Hz", positive, remedy = "drives switch at 2 kHz to 20 kHz")]
    pub switching_frequency: f64,
    /// `Bipolar` or `Unipolar`.
    #[block(default = Scheme::Unipolar)]
    pub scheme: Scheme,
    /// `Natural`, `Symmetric` or `Asymmetric`.
    #[block(default = Sampling::Symmetric)]
    pub sampling: Sampling,
    /// For how long both switches of a leg are off when it turns; less than half of a period.
    #[block(unit = "s", not_negative, default = 0.0)]
    pub dead_time: f64,
}

/// How the two legs of an H bridge go together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Scheme {
    /// Leg b is the opposite of leg a.
    Bipolar,
    /// Each leg has a duty of its own.
    Unipolar,
}

const DUTY: usize = 1;

impl HBridgePwm {
    fn modulator(&self) -> Modulator {
        Modulator {
            carrier: Carrier { frequency: self.switching_frequency },
            sampling: self.sampling,
            dead_time: self.dead_time,
        }
    }

    /// Legs that are compared with the carrier.
    fn legs(&self) -> usize {
        match self.scheme {
            Scheme::Bipolar => 1,
            Scheme::Unipolar => 2,
        }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        switching::validate(self.switching_frequency, self.dead_time, errors);
    }
}

impl Block for HBridgePwm {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let interface = Interface::new()
            .input(Input::real("m").scalar().unit("1").doc("voltage over that of the DC link, -1 to 1"))
            .output(switching::gates(4, "a+, a-, b+, b-"))
            .output(
                Output::like("duty", PortType::vector(2))
                    .doc("share of the period during which leg a, leg b is high"),
            );
        Ok(switching::remember(interface, self.sampling, &["a", "b"][..self.legs()]))
    }

    fn law(&self, l: &Recording) -> bool {
        // Not limited, as natural sampling needs no limits.
        let duties = [0.5 * (1.0 + l.u(0)), 0.5 * (1.0 - l.u(0))];
        switching::record(l, &self.modulator(), [&duties[..self.legs()]; 2]);
        if self.scheme == Scheme::Bipolar {
            let [upper, lower] = Modulator::leg(l.d(), 0);
            l.set(GATES, 2, lower);
            l.set(GATES, 3, upper);
        }
        l.each(DUTY, |leg| match (self.sampling, self.scheme) {
            (Sampling::Natural, _) => duties[leg].within(0.0, 1.0),
            (_, Scheme::Bipolar) if leg == 1 => 1.0 - Modulator::duty(l.d(), 0),
            _ => Modulator::duty(l.d(), leg),
        });
        true
    }

    fn next_event(&self, c: &Context) -> f64 {
        self.modulator().next_event(c.t, c.d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    const PERIOD: f64 = 1.0 / 20e3;

    fn pwm(scheme: Scheme, dead_time: f64) -> HBridgePwm {
        HBridgePwm { switching_frequency: 20e3, scheme, sampling: Sampling::Symmetric, dead_time }
    }

    /// Runs ten periods and hands out start, end and gates of each interval.
    fn walk(block: HBridgePwm, m: f64, mut seen: impl FnMut(f64, f64, &[f64])) {
        let mut bench = Bench::new(block);
        bench.set(0, &[m]);
        while bench.t < 9.999 * PERIOD {
            let start = bench.t;
            let y = bench.major();
            let end = bench.next_event();
            assert!(end > start);
            seen(start, end, &y[..4]);
            bench.t = end;
        }
    }

    #[test]
    fn the_mean_voltage_is_the_modulation_and_more_is_cut_off() {
        for scheme in [Scheme::Bipolar, Scheme::Unipolar] {
            for m in [-1.5, -1.0, -0.3, 0.0, 0.25, 0.9, 1.0, 2.0] {
                let mut area = 0.0;
                walk(pwm(scheme, 0.0), m, |start, end, g| area += (g[0] - g[2]) * (end - start));
                let mean = area / (10.0 * PERIOD);
                assert!((mean - m.clamp(-1.0, 1.0)).abs() < 1e-12, "{scheme:?}, {m}: {mean}");
            }
        }
    }

    #[test]
    fn bipolar_legs_are_opposed_and_unipolar_ones_give_one_sign_twice_a_period() {
        walk(pwm(Scheme::Bipolar, 0.0), 0.4, |_, _, g| assert_eq!([g[0], g[1]], [g[3], g[2]]));
        let (mut last, mut rises) = (0.0, 0);
        walk(pwm(Scheme::Unipolar, 0.0), 0.4, |_, _, g| {
            let v = g[0] - g[2];
            assert!(v >= 0.0);
            rises += i32::from(v > last);
            last = v;
        });
        assert_eq!(rises, 20);
    }

    #[test]
    fn no_leg_is_ever_short_circuited() {
        for scheme in [Scheme::Bipolar, Scheme::Unipolar] {
            let mut both_off = 0.0;
            walk(pwm(scheme, 1e-6), 0.4, |start, end, g| {
                assert!(g[0] * g[1] == 0.0 && g[2] * g[3] == 0.0);
                both_off += if g[0] + g[1] == 0.0 { end - start } else { 0.0 };
            });
            // Two turns a period.
            assert!((both_off - 20.0 * 1e-6).abs() < 1e-12, "{both_off}");
        }
    }

    #[test]
    fn natural_sampling_has_a_guard_for_each_reference() {
        for (scheme, guards) in [(Scheme::Bipolar, 1), (Scheme::Unipolar, 2)] {
            let mut bench = Bench::new(HBridgePwm { sampling: Sampling::Natural, ..pwm(scheme, 0.0) });
            bench.t = 0.25 * PERIOD;
            bench.set(0, &[0.5]).major();
            let expected = [0.25, -0.25];
            let found = bench.guards();
            assert_eq!(found.len(), guards);
            assert!(found.iter().zip(expected).all(|(g, e)| (g - e).abs() < 1e-12), "{found:?}");
        }
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let good = pwm(Scheme::Bipolar, 0.0);
        assert_eq!(
            HBridgePwm { switching_frequency: 0.0, ..good.clone() }.errors()[0].param,
            "switching_frequency"
        );
        assert_eq!(HBridgePwm { dead_time: PERIOD, ..good }.errors()[0].param, "dead_time");
    }
}
