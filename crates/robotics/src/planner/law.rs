//! Length of a path over time.

use crate::motion::{JerkLimited, Profile, ProfileLimits};

/// How the length of the path goes with time, from rest to rest.
#[derive(Debug, Clone, PartialEq)]
pub enum TimeLaw {
    /// Acceleration in bumps of sin².
    Sin2(Profile),
    /// Constant jerk in phases; a trapezoid where the jerk is infinite.
    JerkLimited(JerkLimited),
    /// Constant acceleration between knots: times of the knots (s), length and speed there.
    Phases {
        /// s.
        times: Vec<f64>,
        /// Distance of knots, m.
        step: f64,
        /// Speed at the knots, m/s.
        speeds: Vec<f64>,
    },
}

impl TimeLaw {
    /// Acceleration in bumps of sin² with the peaks `v` and `a`; slower where the way is too short for `v`.
    ///
    /// $$ v \le \sqrt{a d / 2}, \quad T_{acc} = 2 v / a, \quad T_{end} = d / v + T_{acc} $$
    pub fn sin2(distance: f64, v: f64, a: f64) -> Option<TimeLaw> {
        let v = v.min((a * distance / 2.0).sqrt());
        let t_dec = distance / v;
        Profile::new((2.0 * v / a).min(t_dec), t_dec, distance).map(TimeLaw::Sin2)
    }

    /// The fastest with bounds of speed, acceleration and jerk, which may be infinite.
    pub fn jerk_limited(distance: f64, speed: f64, acceleration: f64, jerk: f64) -> Option<TimeLaw> {
        JerkLimited::fastest(distance, ProfileLimits { speed, acceleration, jerk }).map(TimeLaw::JerkLimited)
    }

    /// From the squares of the speed at equally distant knots; zero at the ends alone.
    pub fn phases(step: f64, squares: &[f64]) -> TimeLaw {
        let speeds: Vec<f64> = squares.iter().map(|x| x.max(0.0).sqrt()).collect();
        let mut times = vec![0.0];
        let mut t = 0.0;
        for pair in speeds.windows(2) {
            t += 2.0 * step / (pair[0] + pair[1]);
            times.push(t);
        }
        TimeLaw::Phases { times, step, speeds }
    }

    /// Time from rest to rest, s.
    pub fn duration(&self) -> f64 {
        match self {
            TimeLaw::Sin2(profile) => profile.duration(),
            TimeLaw::JerkLimited(profile) => profile.duration(),
            TimeLaw::Phases { times, .. } => times.last().copied().unwrap_or(0.0),
        }
    }

    /// Length (m), speed (m/s) and acceleration (m/s²) after `t` s; at rest before and after.
    pub fn at(&self, t: f64) -> [f64; 3] {
        match self {
            TimeLaw::Sin2(profile) => [profile.position(t), profile.velocity(t), profile.acceleration(t)],
            TimeLaw::JerkLimited(profile) => profile.at(t).into(),
            TimeLaw::Phases { times, step, speeds } => {
                let last = times.len() - 1;
                if t <= 0.0 {
                    return [0.0; 3];
                }
                if t >= times[last] {
                    return [step * last as f64, 0.0, 0.0];
                }
                let k = times.partition_point(|begin| *begin <= t).saturating_sub(1).min(last - 1);
                let (v, w) = (speeds[k], speeds[k + 1]);
                let (u, elapsed) = ((w * w - v * v) / (2.0 * step), t - times[k]);
                [step * k as f64 + v * elapsed + 0.5 * u * elapsed * elapsed, v + u * elapsed, u]
            }
        }
    }

    /// Times at which the course over time has a kink: start, ends of phases, end.
    pub fn seams(&self) -> Vec<f64> {
        match self {
            TimeLaw::Sin2(profile) => vec![0.0, profile.t_acc(), profile.t_dec(), profile.duration()],
            TimeLaw::JerkLimited(profile) => {
                let mut seams = vec![0.0];
                let (v, a, j) = (profile.peak_velocity(), profile.peak_acceleration(), profile.peak_jerk());
                let rise = if j.is_finite() && j > 0.0 { a / j } else { 0.0 };
                let ramp = v / a + rise;
                seams.extend([rise, ramp - rise, ramp]);
                let end = profile.duration();
                seams.extend([end - ramp, end - ramp + rise, end - rise, end]);
                seams
            }
            TimeLaw::Phases { times, .. } => times.clone(),
        }
    }

    /// The time at which a length is reached, s.
    pub fn time_of(&self, s: f64) -> f64 {
        let (mut low, mut high) = (0.0, self.duration());
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.at(middle)[0] < s { low = middle } else { high = middle }
        }
        high
    }
}
