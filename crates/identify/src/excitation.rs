//! Motions that show the inertial parameters well.

use std::f64::consts::TAU;

use blocksim_multibody::{Model, PARAMETERS_PER_BODY, regressor};
use nalgebra::DMatrix;

use crate::base_parameters::BaseParameters;
use crate::error::IdentifyError;
use crate::random::Random;

/// Share of the limits that is used.
const USED: f64 = 0.8;
/// Instants at which a motion is looked at while it is searched for.
const INSTANTS: usize = 80;

/// What a joint may do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointRange {
    /// Lowest position, rad.
    pub lower: f64,
    /// Highest position, rad.
    pub upper: f64,
    /// Largest speed, rad/s.
    pub speed: f64,
    /// Largest acceleration, rad/s².
    pub acceleration: f64,
}

/// A periodic motion of one joint that starts at rest, with `w = 2 pi / period`:
///
/// $$ q = c + \sum_k \frac{a_k}{k w} \sin k w t - \frac{b_k}{k w} \cos k w t, \qquad \sum_k a_k = 0, \qquad \sum_k k b_k = 0 $$
///
/// Source: J. Swevers, C. Ganseman, D. B. Tükel, J. De Schutter, H. Van Brussel, *Optimal Robot Excitation and
/// Identification*, IEEE Transactions on Robotics and Automation 13 (1997) 730-740.
#[derive(Debug, Clone, PartialEq)]
pub struct Fourier {
    /// s.
    pub period: f64,
    /// c, rad.
    pub centre: f64,
    /// a, rad/s.
    pub sines: Vec<f64>,
    /// b, rad/s.
    pub cosines: Vec<f64>,
}

impl Fourier {
    /// Position, rad, speed, rad/s, and acceleration, rad/s², at a time, s.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let mut y = [self.centre, 0.0, 0.0];
        for (k, (a, b)) in self.sines.iter().zip(&self.cosines).enumerate() {
            let w = TAU * (k + 1) as f64 / self.period;
            let (sin, cos) = (w * t).sin_cos();
            y[0] += (a * sin - b * cos) / w;
            y[1] += a * cos + b * sin;
            y[2] += w * (b * cos - a * sin);
        }
        y
    }

    /// The largest deviation from the centre to each side, speed and acceleration within a period.
    fn extremes(&self) -> [f64; 4] {
        let mut found = [0.0_f64; 4];
        for i in 0..4 * INSTANTS {
            let [q, v, a] = self.at(self.period * i as f64 / (4 * INSTANTS) as f64);
            found[0] = found[0].max(self.centre - q);
            found[1] = found[1].max(q - self.centre);
            found[2] = found[2].max(v.abs());
            found[3] = found[3].max(a.abs());
        }
        found
    }

    /// The same shape as large as the limits allow, moved so that it stays inside.
    fn fitted(mut self, range: &JointRange) -> Fourier {
        let [below, above, speed, acceleration] = self.extremes();
        let room = USED * (range.upper - range.lower);
        let scale = (room / (below + above))
            .min(USED * range.speed / speed)
            .min(USED * range.acceleration / acceleration);
        let scale = if scale.is_finite() { scale } else { 0.0 };
        self.sines.iter_mut().chain(&mut self.cosines).for_each(|x| *x *= scale);
        let margin = 0.5 * (1.0 - USED) * (range.upper - range.lower);
        let (lowest, highest) = (range.lower + margin + scale * below, range.upper - margin - scale * above);
        self.centre = self.centre.clamp(lowest.min(highest), highest.max(lowest));
        self
    }
}

/// A motion of all joints, and how well it shows the base parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Excitation {
    /// One for each joint.
    pub joints: Vec<Fourier>,
    /// Condition number of the regression with columns scaled to length one.
    pub condition: f64,
}

/// Searches a motion whose regression is well conditioned: the best of random ones, then better ones near it. The same
/// seed gives the same motion.
///
/// # Errors
/// [`IdentifyError::NoRoom`] for limits that allow no motion.
pub fn excitation(
    model: &Model,
    base: &BaseParameters,
    ranges: &[JointRange],
    period: f64,
    harmonics: usize,
    seed: u64,
) -> Result<Excitation, IdentifyError> {
    /// Motions that are drawn, and steps from the best of them.
    const DRAWN: usize = 20;
    const STEPS: usize = 60;
    if ranges.len() != model.dof() {
        return Err(IdentifyError::Lengths {
            what: "the limits",
            found: ranges.len(),
            expected: model.dof(),
        });
    }
    for (joint, range) in ranges.iter().enumerate() {
        let is_sound = range.lower < range.upper
            && range.upper - range.lower < f64::INFINITY
            && range.speed > 0.0
            && range.acceleration > 0.0;
        if !is_sound {
            return Err(IdentifyError::NoRoom { joint, reason: "the limits allow no motion".to_owned() });
        }
    }
    let mut random = Random::new(seed);
    let rate = |joints: Vec<Fourier>| {
        let condition = condition(model, base, &joints);
        Excitation { joints, condition }
    };
    let mut best: Option<Excitation> = None;
    for _ in 0..DRAWN {
        let joints = ranges.iter().map(|range| draw(&mut random, range, period, harmonics)).collect();
        let found = rate(joints);
        if best.as_ref().is_none_or(|best| found.condition < best.condition) {
            best = Some(found);
        }
    }
    let mut best = best.unwrap_or_else(|| rate(Vec::new()));
    for _ in 0..STEPS {
        let joints = best.joints.iter().zip(ranges).map(|(joint, range)| {
            let other = draw(&mut random, range, period, harmonics);
            let mix = 0.3 * random.share();
            let blend = |a: &[f64], b: &[f64]| -> Vec<f64> {
                a.iter().zip(b).map(|(a, b)| a + mix * (b - a)).collect()
            };
            let mixed = Fourier {
                period,
                centre: joint.centre + mix * (other.centre - joint.centre),
                sines: blend(&joint.sines, &other.sines),
                cosines: blend(&joint.cosines, &other.cosines),
            };
            mixed.fitted(range)
        });
        let found = rate(joints.collect());
        if found.condition < best.condition {
            best = found;
        }
    }
    Ok(best)
}

fn draw(random: &mut Random, range: &JointRange, period: f64, harmonics: usize) -> Fourier {
    let mut draw = || -> Vec<f64> { (0..harmonics).map(|_| random.between(-1.0, 1.0)).collect() };
    let (mut sines, mut cosines) = (draw(), draw());
    // At rest at the start: the sum of a, and of k b, is zero.
    let mean = sines.iter().sum::<f64>() / harmonics as f64;
    sines.iter_mut().for_each(|a| *a -= mean);
    let k = |i: usize| (i + 1) as f64;
    let along: f64 = cosines.iter().enumerate().map(|(i, b)| k(i) * b).sum();
    let square: f64 = (0..harmonics).map(|i| k(i) * k(i)).sum();
    cosines.iter_mut().enumerate().for_each(|(i, b)| *b -= k(i) * along / square);
    let centre = random.between(range.lower, range.upper);
    Fourier { period, centre, sines, cosines }.fitted(range)
}

/// Condition number of the regression of a motion; infinite where it shows less than all.
fn condition(model: &Model, base: &BaseParameters, joints: &[Fourier]) -> f64 {
    let columns = PARAMETERS_PER_BODY * model.bodies().count();
    let (n, mut data) = (model.dof(), model.data());
    let (mut full, mut rows) = (vec![0.0; n * columns], Vec::new());
    for i in 0..INSTANTS {
        let period = joints.first().map_or(1.0, |joint| joint.period);
        let now: Vec<[f64; 3]> =
            joints.iter().map(|joint| joint.at(period * i as f64 / INSTANTS as f64)).collect();
        let of = |k: usize| -> Vec<f64> { now.iter().map(|row| row[k]).collect() };
        regressor(model, &mut data, &of(0), &of(1), &of(2), &mut full);
        base.reduce(&full, columns, &mut rows);
    }
    let mut stack = DMatrix::from_row_slice(n * INSTANTS, base.len(), &rows);
    for mut column in stack.column_iter_mut() {
        let length = column.norm();
        if length == 0.0 {
            return f64::INFINITY;
        }
        column /= length;
    }
    let singular = stack.qr().r().svd(false, false).singular_values;
    singular.max() / singular.min()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range() -> JointRange {
        JointRange { lower: -1.0, upper: 2.0, speed: 3.0, acceleration: 10.0 }
    }

    #[test]
    fn a_motion_starts_at_rest_repeats_itself_and_keeps_the_limits() {
        let mut random = Random::new(3);
        for _ in 0..20 {
            let joint = draw(&mut random, &range(), 4.0, 5);
            let [q, v, a] = joint.at(0.0);
            assert!(v.abs() < 1e-12 && a.abs() < 1e-11, "{v} {a}");
            assert!((joint.at(4.0)[0] - q).abs() < 1e-12);
            for i in 0..1000 {
                let [q, v, a] = joint.at(0.004 * f64::from(i));
                assert!((-1.0..=2.0).contains(&q) && v.abs() <= 3.0 && a.abs() <= 10.0, "{q} {v} {a}");
            }
        }
    }

    #[test]
    fn speed_and_acceleration_are_the_derivatives() {
        let joint = draw(&mut Random::new(8), &range(), 4.0, 5);
        for t in [0.3, 1.7, 3.1] {
            let h = 1e-5;
            let (before, after) = (joint.at(t - h), joint.at(t + h));
            for k in 0..2 {
                let difference = (after[k] - before[k]) / (2.0 * h);
                assert!((difference - joint.at(t)[k + 1]).abs() < 1e-6);
            }
        }
    }
}
