//! Profiles of piecewise constant jerk: the trapezoid of the velocity and the S-curve.

/// Bounds of a profile along its way; all positive, the jerk may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileLimits {
    /// Largest speed, 1/s in units of the way.
    pub speed: f64,
    /// Largest acceleration, 1/s².
    pub acceleration: f64,
    /// Largest jerk, 1/s³; infinite for a trapezoid.
    pub jerk: f64,
}

/// The fastest profile from rest to rest within bounds of speed, acceleration and jerk.
///
/// Seven phases of constant jerk: +j, 0, -j, 0, -j, 0, +j. Over a short way some of them vanish: without a phase of
/// constant speed the peak speed follows from
///
/// $$ v \left(\frac{v}{a} + \frac{a}{j}\right) = d \quad\text{or}\quad 2 v \sqrt{v / j} = d $$
///
/// where the maximum acceleration is reached ($v \ge a^2/j$) or is not. With infinite jerk the phases of jerk have no
/// length, and the profile is the trapezoid, whose acceleration jumps.
///
/// Source: L. Biagiotti, C. Melchiorri, *Trajectory Planning for Automatic Machines and Robots*, 2008, section 3.4.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JerkLimited {
    distance: f64,
    /// Length of a phase of jerk, of constant acceleration and of constant speed, s.
    t_jerk: f64,
    t_acc: f64,
    t_speed: f64,
    /// Jerk and acceleration that are used, not negative; the jerk is zero where it is infinite.
    jerk: f64,
    acceleration: f64,
    speed: f64,
}

impl JerkLimited {
    /// The fastest profile over a way, which may be negative or zero.
    ///
    /// `None` unless the way is finite, speed and acceleration are positive and finite, and the jerk is positive.
    pub fn fastest(distance: f64, limits: ProfileLimits) -> Option<Self> {
        let ProfileLimits { speed: v, acceleration: a, jerk: j } = limits;
        let sound = |bound: f64| bound > 0.0 && bound.is_finite();
        if !(sound(v) && sound(a) && j > 0.0 && distance.is_finite()) {
            return None;
        }
        let d = distance.abs();
        if d == 0.0 {
            return Some(Self {
                distance,
                t_jerk: 0.0,
                t_acc: 0.0,
                t_speed: 0.0,
                jerk: 0.0,
                acceleration: 0.0,
                speed: 0.0,
            });
        }
        // The peak speed that the way has room for.
        let ramp = a / j;
        let with_plateau = 0.5 * a * ((ramp * ramp + 4.0 * d / a).sqrt() - ramp);
        let without = (0.25 * d * d * j).cbrt();
        let room = if with_plateau >= a * ramp { with_plateau } else { without };
        let speed = v.min(room);
        let (t_jerk, t_acc) =
            if speed >= a * ramp { (ramp, speed / a - ramp) } else { ((speed / j).sqrt(), 0.0) };
        let acceleration = speed / (t_jerk + t_acc);
        // Rounding must not make the rest negative.
        let t_speed = (d / speed - (2.0 * t_jerk + t_acc)).max(0.0);
        let jerk = if t_jerk > 0.0 { acceleration / t_jerk } else { 0.0 };
        (speed > 0.0 && acceleration.is_finite() && t_speed.is_finite()).then_some(Self {
            distance,
            t_jerk,
            t_acc,
            t_speed,
            jerk,
            acceleration,
            speed,
        })
    }

    /// Way, signed.
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Time from rest to rest, s.
    pub fn duration(&self) -> f64 {
        2.0 * self.ramp() + self.t_speed
    }

    /// Largest speed, not negative.
    pub fn peak_velocity(&self) -> f64 {
        self.speed
    }

    /// Largest acceleration, not negative.
    pub fn peak_acceleration(&self) -> f64 {
        self.acceleration
    }

    /// Largest jerk, not negative; infinite for a trapezoid that moves.
    pub fn peak_jerk(&self) -> f64 {
        if self.t_jerk == 0.0 && self.speed > 0.0 { f64::INFINITY } else { self.jerk }
    }

    /// Position, velocity and acceleration after `t` s, signed as the way; at rest before the start and after the end.
    pub fn at(&self, t: f64) -> (f64, f64, f64) {
        let sign = if self.distance < 0.0 { -1.0 } else { 1.0 };
        let end = self.duration();
        if t <= 0.0 || self.speed == 0.0 {
            (0.0, 0.0, 0.0)
        } else if t >= end {
            (self.distance, 0.0, 0.0)
        } else if t <= end - self.ramp() {
            let (s, v, a) = self.start(t);
            (sign * s, sign * v, sign * a)
        } else {
            // Braking is starting backwards in time, which makes the profile symmetric and its end exact.
            let (s, v, a) = self.start(end - t);
            (self.distance - sign * s, sign * v, -sign * a)
        }
    }

    /// Length of the ramp of the speed, s.
    fn ramp(&self) -> f64 {
        2.0 * self.t_jerk + self.t_acc
    }

    /// Way, speed and acceleration up to the end of the phase of constant speed.
    fn start(&self, t: f64) -> (f64, f64, f64) {
        let (j, a, tj) = (self.jerk, self.acceleration, self.t_jerk);
        let ramp = self.ramp();
        if t < tj {
            (j * t * t * t / 6.0, 0.5 * j * t * t, j * t)
        } else if t <= tj + self.t_acc {
            let (v, u) = (0.5 * a * tj, t - tj);
            (a * tj * tj / 6.0 + v * u + 0.5 * a * u * u, v + a * u, a)
        } else if t < ramp {
            // From the speed reached, backwards: its middle is reached in the middle of the ramp.
            let u = ramp - t;
            let (s, v, a) = (j * u * u * u / 6.0, 0.5 * j * u * u, j * u);
            (0.5 * self.speed * ramp - self.speed * u + s, self.speed - v, a)
        } else {
            (self.speed * (t - 0.5 * ramp), self.speed, 0.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(speed: f64, acceleration: f64, jerk: f64) -> ProfileLimits {
        ProfileLimits { speed, acceleration, jerk }
    }

    /// With and without phases of constant speed and of constant acceleration.
    fn samples() -> Vec<(JerkLimited, ProfileLimits)> {
        let ways =
            [(2.0, 1.0, 2.0, 10.0), (-0.3, 1.0, 2.0, 10.0), (0.01, 1.0, 2.0, 10.0), (5.0, 0.2, 2.0, 4.0)];
        let curves = ways.map(|(d, v, a, j)| (d, limits(v, a, j)));
        let trapezoids = [(2.0, limits(1.0, 2.0, f64::INFINITY)), (0.1, limits(1.0, 2.0, f64::INFINITY))];
        curves
            .into_iter()
            .chain(trapezoids)
            .map(|(d, limits)| (JerkLimited::fastest(d, limits).expect("a profile"), limits))
            .collect()
    }

    fn seams(p: &JerkLimited) -> Vec<f64> {
        let (ramp, end) = (p.ramp(), p.duration());
        let up = [0.0, p.t_jerk, p.t_jerk + p.t_acc, ramp];
        up.into_iter().chain(up.map(|t| end - t)).collect()
    }

    #[test]
    fn position_speed_and_acceleration_have_no_jump() {
        for (p, limits) in samples() {
            for seam in seams(&p) {
                let h = 1e-15 * p.duration();
                let ((s0, v0, a0), (s1, v1, a1)) = (p.at(seam - h), p.at(seam + h));
                assert!((s1 - s0).abs() < 1e-12, "{p:?} at {seam}: {s0} to {s1}");
                assert!((v1 - v0).abs() < 1e-12, "{p:?} at {seam}: {v0} to {v1}");
                if limits.jerk.is_finite() {
                    assert!((a1 - a0).abs() < 1e-12, "{p:?} at {seam}: {a0} to {a1}");
                }
            }
        }
    }

    #[test]
    fn the_way_ends_at_its_end_to_the_bit() {
        for (p, _) in samples() {
            assert_eq!(p.at(p.duration()), (p.distance(), 0.0, 0.0));
            assert_eq!(p.at(f64::INFINITY), (p.distance(), 0.0, 0.0));
            assert_eq!(p.at(-1.0), (0.0, 0.0, 0.0));
        }
    }

    #[test]
    fn every_curve_is_the_integral_of_the_next() {
        for (p, limits) in samples() {
            let mut seams = seams(&p);
            seams.sort_by(f64::total_cmp);
            // Simpson's rule is exact for the cubics between two seams, up to a hair inside of the jumps of a trapezoid.
            for pair in seams.windows(2) {
                let (a, b) = (pair[0], pair[1]);
                let inside = |share: f64| p.at(a + share * (b - a));
                let ((s0, v0, a0), (_, v1, a1), (s2, v2, a2)) =
                    (inside(1e-12), inside(0.5), inside(1.0 - 1e-12));
                let way = (b - a) / 6.0 * (v0 + 4.0 * v1 + v2);
                let speed = (b - a) / 6.0 * (a0 + 4.0 * a1 + a2);
                let bound = 1e-10 * (1.0 + limits.acceleration);
                assert!((s2 - s0 - way).abs() < bound, "{p:?} from {a} to {b}: {} and {way}", s2 - s0);
                assert!((v2 - v0 - speed).abs() < bound, "{p:?} from {a} to {b}: {} and {speed}", v2 - v0);
            }
        }
    }

    #[test]
    fn limits_are_kept_and_one_of_them_is_reached() {
        for (p, limits) in samples() {
            for k in 0..=1000 {
                let (_, v, a) = p.at(p.duration() * f64::from(k) / 1000.0);
                assert!(v.abs() <= limits.speed * (1.0 + 1e-14));
                assert!(a.abs() <= limits.acceleration * (1.0 + 1e-14));
            }
            assert!(p.peak_jerk() <= limits.jerk * (1.0 + 1e-12), "{p:?}");
            let full = |value: f64, limit: f64| limit.is_infinite() || value >= limit * (1.0 - 1e-9);
            assert!(full(p.peak_velocity(), limits.speed) || full(p.peak_jerk(), limits.jerk), "{p:?}");
        }
    }

    #[test]
    fn durations_are_those_of_the_closed_forms() {
        // d/v + v/a + a/j where all phases are there; 4 cbrt(d / 2j) where only jerk limits; 2 sqrt(d/a) for a triangle.
        let full = JerkLimited::fastest(2.0, limits(1.0, 2.0, 10.0)).unwrap();
        assert!((full.duration() - (2.0 + 0.5 + 0.2)).abs() < 1e-14);
        let short = JerkLimited::fastest(0.01, limits(1.0, 2.0, 10.0)).unwrap();
        assert!((short.duration() - 4.0 * (0.01_f64 / 20.0).cbrt()).abs() < 1e-14);
        let triangle = JerkLimited::fastest(0.1, limits(1.0, 2.0, f64::INFINITY)).unwrap();
        assert!((triangle.duration() - 2.0 * (0.1_f64 / 2.0).sqrt()).abs() < 1e-14);
    }

    #[test]
    fn no_way_takes_no_time_and_impossible_limits_give_no_profile() {
        let rest = JerkLimited::fastest(0.0, limits(1.0, 1.0, 1.0)).unwrap();
        assert_eq!((rest.duration(), rest.at(0.5)), (0.0, (0.0, 0.0, 0.0)));
        for (v, a, j) in [(0.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, 0.0), (f64::NAN, 1.0, 1.0)] {
            assert!(JerkLimited::fastest(1.0, limits(v, a, j)).is_none());
        }
        assert!(JerkLimited::fastest(f64::INFINITY, limits(1.0, 1.0, 1.0)).is_none());
    }
}
