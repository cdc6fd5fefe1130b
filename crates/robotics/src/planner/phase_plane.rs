//! The fastest way along a path: speed over length under bounds that are linear in its square.
//!
//! With x = ṡ² and u = s̈ every bound |q' u + q'' x| ≤ a of an axis is linear, and on an interval of constant u the next
//! x is x + 2 Δ u. Backwards from the end, the largest x of each knot is found from which the end can be reached;
//! forwards, u is taken as large as bounds and these allow. Bounds hold at both ends of each interval.
//!
//! Source: H. Pham, Q.-C. Pham, *A New Approach to Time-Optimal Path Parameterization Based on Reachability Analysis*,
//! IEEE Transactions on Robotics 34 (2018).

use crate::motion::AxisLimits;

/// First and second derivative by the length of the position of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot {
    /// dq/ds.
    pub first: f64,
    /// d²q/ds².
    pub second: f64,
}

/// What bounds the motion along a path.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    /// Of each axis.
    pub axes: Vec<AxisLimits>,
    /// Speed along the path, m/s.
    pub speed: f64,
    /// Acceleration of the tool, m/s²: along the path and across it together.
    pub acceleration: f64,
}

/// The squares of the speed at the knots of the fastest motion from rest to rest. `step` is the distance of knots, m;
/// `derivative` gives those of a knot and an axis, `curvature` that of the path of the tool at a knot, 1/m.
///
/// `None` where there are fewer than two intervals, or no motion is possible.
pub fn time_optimal(
    intervals: usize,
    step: f64,
    derivative: impl Fn(usize, usize) -> Knot,
    curvature: impl Fn(usize) -> f64,
    bounds: &Bounds,
) -> Option<Vec<f64>> {
    if intervals < 2 {
        return None;
    }
    let plane = Plane { step, derivative, curvature, bounds };
    let mut reach = vec![0.0; intervals + 1];
    for k in (1..intervals).rev() {
        reach[k] = plane.largest(k, reach[k + 1]);
    }
    let mut x = vec![0.0; intervals + 1];
    for k in 0..intervals {
        let (_, fastest) = plane.accelerations(k, x[k])?;
        x[k + 1] = (x[k] + 2.0 * step * fastest).min(reach[k + 1]).max(0.0);
    }
    let moves = x[1..intervals].iter().all(|x| *x > 0.0 && x.is_finite());
    moves.then_some(x)
}

struct Plane<'b, D, C> {
    step: f64,
    derivative: D,
    curvature: C,
    bounds: &'b Bounds,
}

impl<D: Fn(usize, usize) -> Knot, C: Fn(usize) -> f64> Plane<'_, D, C> {
    /// The largest x at a knot from which one can get to at most `next` at the one behind it.
    fn largest(&self, k: usize, next: f64) -> f64 {
        let possible = |x: f64| {
            self.accelerations(k, x).is_some_and(|(low, high)| {
                x + 2.0 * self.step * low <= next && x + 2.0 * self.step * high >= 0.0
            })
        };
        let top = self.fastest(k);
        if possible(top) {
            return top;
        }
        // what is possible is convex and contains rest
        let (mut low, mut high) = (0.0, top);
        for _ in 0..52 {
            let middle = 0.5 * (low + high);
            if possible(middle) { low = middle } else { high = middle }
        }
        low
    }

    /// The largest x that the bounds of the speeds allow at a knot.
    fn fastest(&self, k: usize) -> f64 {
        let Bounds { axes, speed, acceleration } = self.bounds;
        let tool = (speed * speed).min(acceleration / (self.curvature)(k));
        axes.iter().enumerate().fold(tool, |x, (i, limits)| {
            let share = limits.speed / (self.derivative)(k, i).first;
            x.min(share * share)
        })
    }

    /// From which to which u the bounds of the accelerations allow on the interval behind a knot, with x there.
    fn accelerations(&self, k: usize, x: f64) -> Option<(f64, f64)> {
        let Bounds { axes, acceleration, .. } = self.bounds;
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut within = |slope: f64, offset: f64, bound: f64| {
            if slope.abs() > 1e-12 {
                let (a, b) = ((-bound - offset) / slope, (bound - offset) / slope);
                low = low.max(a.min(b));
                high = high.min(a.max(b));
                true
            } else {
                offset.abs() <= bound * (1.0 + 1e-9)
            }
        };
        for (i, limits) in axes.iter().enumerate() {
            let (here, there) = ((self.derivative)(k, i), (self.derivative)(k + 1, i));
            let both = within(here.first, here.second * x, limits.acceleration)
                && within(
                    there.first + 2.0 * self.step * there.second,
                    there.second * x,
                    limits.acceleration,
                );
            if !both {
                return None;
            }
        }
        // (κ x)² + u² ≤ a² at both ends
        for (bend, growth) in [((self.curvature)(k), 0.0), ((self.curvature)(k + 1), 2.0 * self.step)] {
            let (a, b) = (1.0 + (bend * growth).powi(2), bend * bend * growth * x);
            let c = (bend * x).powi(2) - acceleration * acceleration;
            let root = b * b - a * c;
            if root < 0.0 {
                return None;
            }
            low = low.max((-b - root.sqrt()) / a);
            high = high.min((-b + root.sqrt()) / a);
        }
        (low <= high).then_some((low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::AxisKind;

    fn bounds(speed: f64, acceleration: f64, axes: &[(f64, f64)]) -> Bounds {
        let limits = |&(speed, acceleration): &(f64, f64)| AxisLimits {
            kind: AxisKind::Turning,
            lower: -9.0,
            upper: 9.0,
            speed,
            acceleration,
        };
        Bounds { axes: axes.iter().map(limits).collect(), speed, acceleration }
    }

    fn duration(x: &[f64], step: f64) -> f64 {
        x.windows(2).map(|x| 2.0 * step / (x[0].sqrt() + x[1].sqrt())).sum()
    }

    #[test]
    fn one_axis_moves_as_the_trapezoid_of_its_limits() {
        // q = 2 s over 1 m: 2 rad with 1 rad/s and 4 rad/s²: 2 / 1 + 1 / 4 s
        let n = 400;
        let step = 1.0 / n as f64;
        let knot = |_, _| Knot { first: 2.0, second: 0.0 };
        let x = time_optimal(n, step, knot, |_| 0.0, &bounds(9.0, 90.0, &[(1.0, 4.0)])).unwrap();
        assert!((duration(&x, step) - 2.25).abs() < 1e-9, "{}", duration(&x, step));
        // without room for the speed: 2 √(d / a)
        let x = time_optimal(n, step, knot, |_| 0.0, &bounds(9.0, 90.0, &[(50.0, 4.0)])).unwrap();
        assert!((duration(&x, step) - 2.0 * (2.0_f64 / 4.0).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn where_speeds_alone_bound_it_the_time_is_the_integral_of_the_slowest_axis() {
        // q1 = s², q2 = s on 0 to 1: the first is slower from s = 1/2 on: 1/2 + ∫ 2 s ds = 1/2 + 3/4 s
        let n = 4000;
        let step = 1.0 / f64::from(n);
        let knot = |k: usize, axis: usize| match axis {
            0 => Knot { first: 2.0 * k as f64 * step, second: 2.0 },
            _ => Knot { first: 1.0, second: 0.0 },
        };
        let free = bounds(1e9, 1e12, &[(1.0, 1e9), (1.0, 1e9)]);
        let x = time_optimal(n as usize, step, knot, |_| 0.0, &free).unwrap();
        assert!((duration(&x, step) - 1.25).abs() < 1e-3, "{}", duration(&x, step));
    }

    #[test]
    fn on_a_circle_the_tool_keeps_to_its_acceleration() {
        // with κ = 1/r the maximum speed is √(a r)
        let (n, radius, a) = (2000, 0.5, 2.0);
        let step = 3.0 / n as f64;
        let x = time_optimal(
            n,
            step,
            |_, _| Knot { first: 0.1, second: 0.0 },
            |_| 1.0 / radius,
            &bounds(9.0, a, &[(9.0, 99.0)]),
        )
        .unwrap();
        let top = x.iter().fold(0.0_f64, |m, x| m.max(*x));
        assert!((top - a * radius).abs() < 1e-3 * a, "{top}");
        for (x, u) in x.windows(2).map(|x| (x[0], (x[1] - x[0]) / (2.0 * step))) {
            assert!((x / radius).hypot(u) < a * (1.0 + 1e-9), "{x} {u}");
        }
    }
}
