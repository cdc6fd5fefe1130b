//! From voltages to modulation and duties.

use std::f64::consts::FRAC_PI_6;

use serde::Deserialize;

use super::amount::Amount;

/// How a bridge makes its voltages: what is added to all three references alike, which no winding sees.
///
/// The laws other than `Sine` reach the voltage of space vectors. The discontinuous ones hold one leg at a time still, which
/// saves a third of the switching. Source: D. G. Holmes, T. A. Lipo, *Pulse Width Modulation for Power Converters*,
/// chapters 5 and 6, where they are called DPWM1, DPWM0, DPWM2, DPWM3, DPWMMAX and DPWMMIN.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Modulation {
    /// Sine against a carrier, nothing added: phase voltages up to half of the DC link.
    #[default]
    Sine,
    /// Space vectors, the same as half of the middle reference added: up to the DC link over the square root of three.
    SpaceVector,
    /// Each leg rests for 60 degrees around each peak of its voltage.
    Discontinuous60,
    /// As `Discontinuous60`, 30 degrees earlier: for currents that lead.
    Discontinuous60Leading,
    /// As `Discontinuous60`, 30 degrees later: for currents that lag.
    Discontinuous60Lagging,
    /// Each leg rests four times for 30 degrees, before and behind the 60 degrees around each peak.
    Discontinuous30,
    /// Each leg rests high for 120 degrees.
    Discontinuous120Upper,
    /// Each leg rests low for 120 degrees.
    Discontinuous120Lower,
}

/// How many [branches](Modulation::branches) a law has.
pub const BRANCHES: usize = 2;

/// Share of a period during which a leg is high, from its modulation: $(1 + m)/2$, limited to 0 to 1. What is not a number
/// stays so.
#[inline]
pub fn duty<N: Amount>(modulation: N) -> N {
    ((modulation + 1.0) * 0.5).within(0.0, 1.0)
}

impl Modulation {
    /// Largest peak phase voltage, V, of a DC link of `vdc`, V, up to which the mean voltages are sines.
    pub fn limit(self, vdc: f64) -> f64 {
        match self {
            Self::Sine => vdc / 2.0,
            _ => vdc / 3.0_f64.sqrt(),
        }
    }

    /// Modulation of the legs a, b, c for phase voltages `v`, V, from a DC link of `vdc`, V: -1 is always low, 1 always
    /// high. Not limited: beyond ±1 the bridge is overmodulated. Without a DC link all are 0.
    pub fn references<N: Amount>(self, v: [N; 3], vdc: N) -> [N; 3] {
        self.references_of(v, vdc, self.branches(v, vdc))
    }

    /// The same, continuous in `v` and `vdc`, where the branches of the law are given; see [`branches`](Self::branches).
    pub fn references_of<N: Amount>(self, v: [N; 3], vdc: N, [link, low_leads]: [N; BRANCHES]) -> [N; 3] {
        let (zero, one) = (vdc.fixed(0.0), vdc.fixed(1.0));
        // Nothing is divided by the voltage of a link that is not there.
        let half = vdc.greater(zero, vdc * 0.5, one);
        // What is not a number stays so.
        let none = vdc * 0.0 + 0.0;
        self.per_unit(v.map(|v| v / half), low_leads).map(|m| link.equal(one, m, none))
    }

    /// Between which pieces of the law its references jump, each 0 or 1: whether there is a DC link, and whether the lowest of
    /// the keys is further from zero than the highest, which tells the discontinuous laws on which side a leg rests.
    ///
    /// Whoever looks at references all the time holds them from one zero of [`jumps`](Self::jumps) to the next: else a jump
    /// between two looks hides what is crossed on its other side.
    pub fn branches<N: Amount>(self, v: [N; 3], vdc: N) -> [N; BRANCHES] {
        let (zero, one) = (vdc.fixed(0.0), vdc.fixed(1.0));
        let low_leads = self.lead(v).map_or(zero, |lead| zero.greater(lead, one, zero));
        [vdc.greater(zero, one, zero), low_leads]
    }

    /// Functions, V, whose changes of sign change the [branches](Self::branches) in their order; without the second for laws that
    /// are continuous in the references.
    pub fn jumps<N: Amount>(self, v: [N; 3], vdc: N) -> impl Iterator<Item = N> {
        std::iter::once(vdc).chain(self.lead(v))
    }

    /// Whether the references jump while there is a DC link.
    pub fn is_discontinuous(self) -> bool {
        self.jumps_at().is_some()
    }

    /// Angle of phase a, rad, at which balanced references jump, and again after each 60 degrees; none if they never do.
    pub fn jumps_at(self) -> Option<f64> {
        match self {
            Self::Discontinuous60 | Self::Discontinuous30 => Some(FRAC_PI_6),
            Self::Discontinuous60Leading | Self::Discontinuous60Lagging => Some(0.0),
            Self::Sine | Self::SpaceVector | Self::Discontinuous120Upper | Self::Discontinuous120Lower => {
                None
            }
        }
    }

    /// How much further from zero the highest of the keys is than the lowest, V, where that matters.
    fn lead<N: Amount>(self, v: [N; 3]) -> Option<N> {
        let keys = self.keys(v);
        self.is_discontinuous().then(|| of_highest(keys, keys) + of_lowest(keys, keys))
    }

    /// What the legs are judged by. The sum of the keys of a discontinuous law is zero; where two of them are equal without
    /// being the ones in the middle, the third is further from zero, so that the law jumps only from one side to the other.
    fn keys<N: Amount>(self, [a, b, c]: [N; 3]) -> [N; 3] {
        match self {
            Self::Discontinuous60 | Self::Discontinuous30 => {
                [a * 2.0 - b - c, b * 2.0 - c - a, c * 2.0 - a - b]
            }
            Self::Discontinuous60Leading => [a - b, b - c, c - a],
            Self::Discontinuous60Lagging => [a - c, b - a, c - b],
            _ => [a, b, c],
        }
    }

    /// References from voltages over half of the link.
    fn per_unit<N: Amount>(self, u: [N; 3], low_leads: N) -> [N; 3] {
        let one = low_leads.fixed(1.0);
        let keys = self.keys(u);
        // The leg that rests is exactly at its side, so that it does not switch.
        let resting = |leg: N, side: N| u.map(|x| side + (x - leg));
        let either = |low: N, high: N| low_leads.equal(one, low, high);
        match self {
            Self::Sine => u,
            Self::SpaceVector => {
                let middle = (of_highest(u, u) + of_lowest(u, u)) * 0.5;
                u.map(|u| u - middle)
            }
            Self::Discontinuous60 | Self::Discontinuous60Leading | Self::Discontinuous60Lagging => {
                resting(either(of_lowest(u, keys), of_highest(u, keys)), either(-one, one))
            }
            Self::Discontinuous30 => resting(either(of_highest(u, u), of_lowest(u, u)), either(one, -one)),
            Self::Discontinuous120Upper => resting(of_highest(u, u), one),
            Self::Discontinuous120Lower => resting(of_lowest(u, u), -one),
        }
    }

    /// Duties of the legs a, b, c, each 0 to 1; see [`references`](Self::references).
    pub fn duties(self, v: [f64; 3], vdc: f64) -> [f64; 3] {
        self.references(v, vdc).map(duty)
    }
}

/// The value whose key is greatest; the first of those.
fn of_highest<N: Amount>(values: [N; 3], keys: [N; 3]) -> N {
    let mut best = (values[0], keys[0]);
    for i in 1..3 {
        best = (keys[i].greater(best.1, values[i], best.0), keys[i].greater(best.1, keys[i], best.1));
    }
    best.0
}

/// The value whose key is least; the first of those.
fn of_lowest<N: Amount>(values: [N; 3], keys: [N; 3]) -> N {
    let mut best = (values[0], keys[0]);
    for i in 1..3 {
        best = (best.1.greater(keys[i], values[i], best.0), best.1.greater(keys[i], keys[i], best.1));
    }
    best.0
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const ALL: [Modulation; 8] = [
        Modulation::Sine,
        Modulation::SpaceVector,
        Modulation::Discontinuous60,
        Modulation::Discontinuous60Leading,
        Modulation::Discontinuous60Lagging,
        Modulation::Discontinuous30,
        Modulation::Discontinuous120Upper,
        Modulation::Discontinuous120Lower,
    ];
    const VDC: f64 = 560.0;

    fn phases(amplitude: f64, angle: f64) -> [f64; 3] {
        [0.0, 1.0, 2.0].map(|k| amplitude * (angle - k * TAU / 3.0).cos())
    }

    /// Angles over a turn that meet no boundary between sectors.
    fn angles() -> impl Iterator<Item = f64> {
        (0..3600).map(|k| (f64::from(k) + 0.37) * TAU / 3600.0)
    }

    #[test]
    fn mean_line_voltages_are_those_asked_for_up_to_the_limit_of_each_law() {
        for law in ALL {
            for share in [0.0, 0.01, 0.5, 1.0 - 1e-12] {
                for angle in angles() {
                    let v = phases(share * law.limit(VDC), angle);
                    let d = law.duties(v, VDC);
                    for (x, y) in [(0, 1), (1, 2), (2, 0)] {
                        let mean = (d[x] - d[y]) * VDC;
                        assert!((mean - (v[x] - v[y])).abs() < 1e-12 * VDC, "{law:?} at {share}, {angle}");
                    }
                    assert!(law.references(v, VDC).iter().all(|m| m.abs() <= 1.0 + 1e-12), "{law:?}");
                }
            }
        }
    }

    #[test]
    fn sine_modulation_gives_each_pole_its_phase_voltage() {
        for angle in angles() {
            let v = phases(200.0, angle);
            let d = Modulation::Sine.duties(v, VDC);
            assert!((0..3).all(|x| ((d[x] - 0.5) * VDC - v[x]).abs() < 1e-12 * VDC));
        }
    }

    #[test]
    fn beyond_the_limit_some_leg_is_cut_off_and_duties_stay_duties() {
        for law in ALL {
            let beyond = |share: f64| {
                angles().any(|angle| {
                    let m = law.references(phases(share * law.limit(VDC), angle), VDC);
                    m.iter().any(|m| m.abs() > 1.0 + 1e-9)
                })
            };
            assert!(!beyond(1.0 - 1e-9), "{law:?}");
            assert!(beyond(1.001), "{law:?}");
            for angle in angles() {
                let d = law.duties(phases(5.0 * VDC, angle), VDC);
                assert!(d.iter().all(|d| (0.0..=1.0).contains(d)), "{law:?}: {d:?}");
            }
        }
    }

    /// For how much of a turn leg a rests high and low, and where the middle of the time high lies (rad).
    fn rests(law: Modulation) -> (f64, f64, f64) {
        let (mut high, mut low, mut moment) = (0.0, 0.0, (0.0, 0.0));
        for angle in angles() {
            let m = law.references(phases(0.7 * VDC / 2.0, angle), VDC)[0];
            if m == 1.0 {
                high += 0.1;
                moment = (moment.0 + angle.cos(), moment.1 + angle.sin());
            } else if m == -1.0 {
                low += 0.1;
            }
        }
        (high, low, f64::atan2(moment.1, moment.0))
    }

    #[test]
    fn discontinuous_laws_rest_exactly_for_a_third_of_the_turn_where_they_say() {
        let expected = [
            (Modulation::Discontinuous60, 60.0, 60.0, Some(0.0)),
            (Modulation::Discontinuous60Leading, 60.0, 60.0, Some(-FRAC_PI_6)),
            (Modulation::Discontinuous60Lagging, 60.0, 60.0, Some(FRAC_PI_6)),
            (Modulation::Discontinuous30, 60.0, 60.0, Some(0.0)),
            (Modulation::Discontinuous120Upper, 120.0, 0.0, Some(0.0)),
            (Modulation::Discontinuous120Lower, 0.0, 120.0, None),
        ];
        for (law, high, low, middle) in expected {
            let found = rests(law);
            assert!((found.0 - high).abs() < 0.25 && (found.1 - low).abs() < 0.25, "{law:?}: {found:?}");
            if let Some(middle) = middle {
                assert!((found.2 - middle).abs() < 2e-3, "{law:?}: {found:?}");
            }
        }
        // Not in the sixty degrees around the peak, but before and behind them.
        let m = |degrees: f64| {
            Modulation::Discontinuous30.references(phases(200.0, degrees.to_radians()), VDC)[0]
        };
        assert!(m(45.0) == 1.0 && m(-45.0) == 1.0 && m(15.0) < 1.0 && m(61.0) < 1.0);
    }

    #[test]
    fn what_is_common_to_all_phases_changes_nothing_but_sine_modulation() {
        for law in ALL.into_iter().skip(1) {
            for angle in angles().step_by(10) {
                let v = phases(200.0, angle);
                let (plain, shifted) = (law.references(v, VDC), law.references(v.map(|v| v + 33.0), VDC));
                assert!((0..3).all(|x| (plain[x] - shifted[x]).abs() < 1e-12), "{law:?} at {angle}");
            }
        }
    }

    #[test]
    fn without_a_dc_link_all_legs_are_high_for_half_of_the_time() {
        for law in ALL {
            assert_eq!(law.duties([100.0, -50.0, -50.0], 0.0), [0.5; 3]);
        }
    }

    #[test]
    fn what_is_no_number_gives_no_duty() {
        assert!(duty(f64::NAN).is_nan());
        assert!(Modulation::SpaceVector.duties([1.0, 2.0, 3.0], f64::NAN).iter().all(|d| d.is_nan()));
    }
}
