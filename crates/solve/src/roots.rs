//! Location of a sign change between two points that bracket it.
//!
//! T. R. Chandrupatla: A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear function without
//! using derivatives, Adv. Eng. Softw. 28 (1997), doi 10.1016/S0965-9978(96)00051-8.

/// Evaluations after which only halving is trusted.
const PATIENCE: usize = 60;

/// Narrows the bracket `a < b`, where `f` has the values `fa` and `fb` of different sign, to a width of at most
/// `tolerance` or to neighbouring numbers. Returns (left, right): at `left` the sign is still that of `fa`, at `right`
/// it is no longer. Zero belongs to the far side, but if `fa` itself is zero, to the near one. A value that is not a number
/// counts as near.
///
/// Always ends: inverse quadratic interpolation where it is safe, else halving. If `fb` is on the near side, which is no
/// bracket, the result is some interval at the right end.
pub fn locate(mut f: impl FnMut(f64) -> f64, a: f64, fa: f64, b: f64, fb: f64, tolerance: f64) -> (f64, f64) {
    let far = |v: f64| {
        if fa > 0.0 {
            v <= 0.0
        } else if fa < 0.0 {
            v >= 0.0
        } else {
            v * fb > 0.0
        }
    };
    // The root is between x1, the newest point, and x2; x3 is the one before.
    let (mut x1, mut f1, mut x2, mut f2) = (b, fb, a, fa);
    let mut x1_far = true;
    let mut fraction = 0.5;
    for count in 0.. {
        if (x2 - x1).abs() <= tolerance {
            break;
        }
        let middle = x1 + 0.5 * (x2 - x1);
        let mut x = x1 + fraction * (x2 - x1);
        if x == x1 || x == x2 || x.is_nan() {
            x = middle;
        }
        if x == x1 || x == x2 {
            break;
        }
        let fx = f(x);
        let (x3, f3);
        if far(fx) == x1_far {
            (x3, f3) = (x1, f1);
        } else {
            (x3, f3) = (x2, f2);
            (x2, f2) = (x1, f1);
            x1_far = !x1_far;
        }
        (x1, f1) = (x, fx);

        let (xi, phi) = ((x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2));
        let safe = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        fraction = if safe && count < PATIENCE {
            let t = f1 / (f2 - f1) * (f3 / (f2 - f3))
                + (x3 - x1) / (x2 - x1) * (f1 / (f3 - f1)) * (f2 / (f3 - f2));
            // Half a tolerance from either end, so that the other end follows at once.
            let least = (0.5 * tolerance / (x2 - x1).abs()).min(0.5);
            t.max(least).min(1.0 - least)
        } else {
            0.5
        };
    }
    (x1.min(x2), x1.max(x2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(f: fn(f64) -> f64, a: f64, b: f64, tolerance: f64) -> (f64, f64, usize) {
        let mut count = 0;
        let counting = |x| {
            count += 1;
            f(x)
        };
        let (left, right) = locate(counting, a, f(a), b, f(b), tolerance);
        assert!(right - left <= tolerance || right == left.next_up(), "{left} {right}");
        assert!(f(left) * f(a) > 0.0 && f(right) * f(a) <= 0.0, "{left} {right}");
        (left, right, count)
    }

    #[test]
    fn a_smooth_root_takes_few_evaluations() {
        let (left, right, count) = counted(|x| x.cos() - x, 0.0, 1.0, 1e-12);
        let root = 0.739_085_133_215_160_6;
        assert!(left <= root && root <= right);
        assert!(count <= 9, "{count}");
    }

    #[test]
    fn falling_and_rising_both_end_beyond_the_root() {
        counted(|x| 2.0 - x * x, 0.0, 2.0, 1e-10);
        counted(|x| x * x - 2.0, 0.0, 2.0, 1e-10);
    }

    #[test]
    fn a_jump_a_flat_root_and_a_steep_one_cost_little_more_than_halving() {
        for f in [
            |x: f64| if x < 0.3 { -1.0 } else { 1e6 },
            |x: f64| (x - 0.3).powi(9),
            |x: f64| (x - 0.3).cbrt(),
            |x: f64| (x - 1e-7) / (x + 1e-9),
        ] {
            let (_, _, count) = counted(f, 0.0, 1.0, 1e-12);
            assert!(count <= 100, "{count}");
        }
    }

    #[test]
    fn without_tolerance_the_ends_are_neighbours() {
        let (left, right, _) = counted(|x| x * x - 2.0, 1.0, 2.0, 0.0);
        assert_eq!(right, left.next_up());
    }

    #[test]
    fn a_root_that_is_hit_exactly_is_on_the_far_side() {
        let (left, right, _) = counted(|x| x - 0.5, 0.0, 1.0, 1e-9);
        assert!(left < 0.5 && right >= 0.5);
        let (_, right) = locate(|x| (x - 1.0).min(0.0), 0.0, -1.0, 1.0, 0.0, 1e-9);
        assert_eq!(right, 1.0);
    }

    #[test]
    fn zero_at_the_start_is_left_behind() {
        let f = |x: f64| if x < 0.25 { 0.0 } else { x - 0.25 };
        let (left, right) = locate(f, 0.0, 0.0, 1.0, 0.75, 1e-9);
        assert!(left <= 0.25 && right > 0.25 && right - left <= 1e-9);
    }

    #[test]
    fn values_that_are_no_numbers_do_not_stop_it() {
        let (left, right) = locate(|_| f64::NAN, 0.0, -1.0, 1.0, 1.0, 1e-9);
        assert!(right == 1.0 && right - left <= 1e-9);
    }
}
