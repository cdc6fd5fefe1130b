//! The sin² profile of one axis.

use std::f64::consts::PI;

/// A move from rest to rest whose acceleration is a sin² bump, then zero, then the mirrored bump.
///
/// $$ \ddot s = a_m \sin^2\frac{\pi t}{T_{acc}}, \qquad v_m = \frac{d}{T_{dec}}, \qquad
///    a_m = \frac{2 v_m}{T_{acc}}, \qquad T_{end} = T_{acc} + T_{dec} $$
///
/// for $0 \le t \le T_{acc}$; velocity is constant until $T_{dec}$, where braking begins. The acceleration
/// starts and ends every phase at zero, so the jerk stays finite: at most $\pi a_m / T_{acc}$.
///
/// Source: W. Weber, Industrieroboter, 2017, sections on sinusoidal profiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    t_acc: f64,
    t_dec: f64,
    distance: f64,
    v_m: f64,
    a_m: f64,
}

impl Profile {
    /// A profile that accelerates for `t_acc` s, brakes from `t_dec` s on and covers `distance`, which may be
    /// negative or zero.
    ///
    /// `None` unless all three are finite and `0 < t_acc <= t_dec`.
    pub fn new(t_acc: f64, t_dec: f64, distance: f64) -> Option<Profile> {
        let sound = t_acc > 0.0 && t_acc <= t_dec && t_dec.is_finite() && distance.is_finite();
        let v_m = distance / t_dec;
        let a_m = 2.0 * v_m / t_acc;
        (sound && a_m.is_finite()).then_some(Profile { t_acc, t_dec, distance, v_m, a_m })
    }

    /// Length of the acceleration phase and of the braking phase, s.
    pub fn t_acc(&self) -> f64 {
        self.t_acc
    }

    /// Time at which braking begins, s.
    pub fn t_dec(&self) -> f64 {
        self.t_dec
    }

    /// Time at which the axis is at rest again, s.
    pub fn duration(&self) -> f64 {
        self.t_acc + self.t_dec
    }

    /// Distance covered, signed.
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Velocity of the middle phase, signed as the distance.
    pub fn peak_velocity(&self) -> f64 {
        self.v_m
    }

    /// Largest acceleration, signed as the distance; braking reaches its negative.
    pub fn peak_acceleration(&self) -> f64 {
        self.a_m
    }

    /// Distance covered after `t` s; 0 before the start, the whole distance after the end.
    pub fn position(&self, t: f64) -> f64 {
        if t <= 0.0 {
            0.0
        } else if t <= self.t_acc {
            self.ramp_position(t)
        } else if t <= self.t_dec {
            self.v_m * (t - self.t_acc / 2.0)
        } else if t < self.duration() {
            self.distance - self.ramp_position(self.duration() - t)
        } else {
            self.distance
        }
    }

    /// Velocity after `t` s; 0 outside the move.
    pub fn velocity(&self, t: f64) -> f64 {
        if t <= 0.0 || t >= self.duration() {
            0.0
        } else if t <= self.t_acc {
            self.ramp_velocity(t)
        } else if t <= self.t_dec {
            self.v_m
        } else {
            self.ramp_velocity(self.duration() - t)
        }
    }

    /// Acceleration after `t` s; 0 outside the move.
    pub fn acceleration(&self, t: f64) -> f64 {
        if t <= 0.0 || t >= self.duration() || (t > self.t_acc && t <= self.t_dec) {
            0.0
        } else if t <= self.t_acc {
            self.ramp_acceleration(t)
        } else {
            -self.ramp_acceleration(self.duration() - t)
        }
    }

    // The acceleration phase. Braking is the same phase run backwards from the end, which makes the whole
    // profile exactly symmetric and the end exactly the target.

    fn ramp_position(&self, t: f64) -> f64 {
        let sine = (PI * t / self.t_acc).sin();
        self.a_m * (t * t / 4.0 - (self.t_acc / (2.0 * PI) * sine).powi(2))
    }

    fn ramp_velocity(&self, t: f64) -> f64 {
        self.a_m * (t / 2.0 - self.t_acc / (4.0 * PI) * (2.0 * PI * t / self.t_acc).sin())
    }

    fn ramp_acceleration(&self, t: f64) -> f64 {
        self.a_m * (PI * t / self.t_acc).sin().powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples() -> Vec<Profile> {
        [(0.3, 0.8, 1.2), (0.3, 0.3, -2.0), (2.0, 50.0, 3.0), (1e-3, 0.5, 0.1)]
            .map(|(t_acc, t_dec, d)| Profile::new(t_acc, t_dec, d).unwrap())
            .to_vec()
    }

    #[test]
    fn all_three_curves_are_continuous_at_every_seam() {
        for p in samples() {
            for seam in [0.0, p.t_acc(), p.t_dec(), p.duration()] {
                // One part in 1e16 of the longest time either side; the curves may move by slope times this.
                let h = 1e-15 * p.duration();
                let (before, after) = (seam - h, seam + h);
                let scale = 1.0 + p.peak_velocity().abs() + p.peak_acceleration().abs();
                let gap = |f: fn(&Profile, f64) -> f64| (f(&p, after) - f(&p, before)).abs();
                assert!(gap(Profile::position) < 1e-12 * scale, "{p:?} at {seam}");
                assert!(gap(Profile::velocity) < 1e-12 * scale, "{p:?} at {seam}");
                assert!(gap(Profile::acceleration) < 1e-12 * scale, "{p:?} at {seam}");
            }
        }
    }

    #[test]
    fn the_phases_agree_with_the_printed_closed_forms() {
        // The braking phase as textbooks print it, not by symmetry.
        for p in samples() {
            let (t_acc, t_dec, t_end) = (p.t_acc(), p.t_dec(), p.duration());
            for k in 0..=20 {
                let t = t_dec + t_acc * f64::from(k) / 20.0;
                let printed = p.peak_acceleration() / 2.0
                    * (t_end * (t + t_acc) - (t * t + t_end * t_end + 2.0 * t_acc * t_acc) / 2.0
                        + t_acc * t_acc / (4.0 * PI * PI) * (1.0 - (2.0 * PI / t_acc * (t - t_dec)).cos()));
                // The printed form cancels terms of size a_m t_end².
                let tolerance = 1e-15 * 8.0 * (p.peak_acceleration() * t_end * t_end).abs();
                assert!((p.position(t) - printed).abs() < tolerance, "{p:?} at {t}");
            }
        }
    }

    /// Simpson's rule over each phase, where the integrand is smooth.
    fn integral(p: &Profile, f: impl Fn(f64) -> f64) -> f64 {
        let seams = [0.0, p.t_acc(), p.t_dec(), p.duration()];
        let panels = 400;
        let phase = |a: f64, b: f64| {
            let h = (b - a) / f64::from(panels);
            let weight = |k| if k == 0 || k == panels { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
            (0..=panels).map(|k| weight(k) * f(a + h * f64::from(k))).sum::<f64>() * h / 3.0
        };
        seams.windows(2).map(|s| phase(s[0], s[1])).sum()
    }

    #[test]
    fn velocity_integrates_to_the_distance_and_acceleration_to_zero() {
        for p in samples() {
            assert!((integral(&p, |t| p.velocity(t)) - p.distance()).abs() < 1e-9 * p.distance().abs());
            assert!(integral(&p, |t| p.acceleration(t)).abs() < 1e-9 * p.peak_velocity().abs());
        }
    }

    #[test]
    fn velocity_and_acceleration_are_the_derivatives() {
        for p in samples() {
            for k in 1..200 {
                let t = p.duration() * (f64::from(k) + 0.37) / 200.0;
                let h = 1e-4 * p.t_acc();
                if [p.t_acc(), p.t_dec(), p.duration()].iter().any(|seam| (t - seam).abs() < 2.0 * h) {
                    continue;
                }
                let slope = |f: fn(&Profile, f64) -> f64| (f(&p, t + h) - f(&p, t - h)) / (2.0 * h);
                let jerk = PI * p.peak_acceleration().abs() / p.t_acc();
                // Central difference: h² times a sixth of the third derivative, and rounding eps / h.
                let tolerance = h * h * jerk + 1e-15 * p.distance().abs() / h;
                assert!((slope(Profile::position) - p.velocity(t)).abs() < tolerance, "{p:?} at {t}");
                let tolerance = 10.0 * h * h * jerk / p.t_acc() + 1e-15 * p.peak_velocity().abs() / h;
                assert!((slope(Profile::velocity) - p.acceleration(t)).abs() < tolerance, "{p:?} at {t}");
            }
        }
    }

    #[test]
    fn nothing_moves_before_the_start_or_after_the_end() {
        let p = Profile::new(0.3, 0.8, 1.2).unwrap();
        for t in [f64::NEG_INFINITY, -1.0, -0.0, 0.0] {
            assert_eq!((p.position(t), p.velocity(t), p.acceleration(t)), (0.0, 0.0, 0.0));
        }
        for t in [p.duration(), 2.0, f64::INFINITY] {
            assert_eq!((p.position(t), p.velocity(t), p.acceleration(t)), (1.2, 0.0, 0.0));
        }
    }

    #[test]
    fn peaks_are_reached_and_not_passed() {
        for p in samples() {
            assert_eq!(p.velocity(p.t_dec()), p.velocity(p.t_dec()).clamp(-p.v_m.abs(), p.v_m.abs()));
            assert!((p.acceleration(p.t_acc() / 2.0) - p.a_m).abs() <= 1e-15 * p.a_m.abs());
            for k in 0..=1000 {
                let t = p.duration() * f64::from(k) / 1000.0;
                assert!(p.velocity(t).abs() <= p.v_m.abs() * (1.0 + 1e-14));
                assert!(p.acceleration(t).abs() <= p.a_m.abs());
            }
        }
    }

    #[test]
    fn impossible_times_give_no_profile() {
        for (t_acc, t_dec, d) in [
            (0.0, 1.0, 1.0),
            (-1.0, 1.0, 1.0),
            (2.0, 1.0, 1.0),
            (f64::NAN, 1.0, 1.0),
            (1.0, f64::INFINITY, 1.0),
        ] {
            assert!(Profile::new(t_acc, t_dec, d).is_none(), "{t_acc} {t_dec} {d}");
        }
        assert!(Profile::new(1.0, 1.0, f64::NAN).is_none());
        assert!(Profile::new(1.0, 1.0, 0.0).is_some());
    }
}
