//! The largest torque that a machine can give at a voltage.

use super::circuit::Circuit;

/// Slips at which the search looks first, a decade.
const PER_DECADE: i32 = 16;

impl Circuit {
    /// Slip and torque where the torque is largest between synchronism and standstill, at the voltage `v` and the
    /// frequency `w`, in per unit. Two cages can have two maxima; this is the higher one.
    pub fn breakdown(&self, v: f64, w: f64) -> (f64, f64) {
        let torque = |exponent: f64| self.steady_state(v, w, w * exponent.exp()).torque;
        let places = -4 * PER_DECADE..=0;
        let step = std::f64::consts::LN_10 / f64::from(PER_DECADE);
        let at = |place: i32| step * f64::from(place);
        let best = places.max_by(|a, b| torque(at(*a)).total_cmp(&torque(at(*b)))).unwrap_or(0);
        let exponent = maximum(torque, at(best - 1), at(best + 1).min(0.0));
        // At the end of the range the torque may still rise.
        let exponent = if torque(0.0) >= torque(exponent) { 0.0 } else { exponent };
        (exponent.exp(), torque(exponent))
    }
}

/// Where a function that rises and then falls between `a` and `b` is largest: golden sections, then one parabola, as
/// values near a maximum are too equal to be compared.
fn maximum(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut left, mut right) = (b - golden * (b - a), a + golden * (b - a));
    let (mut f_left, mut f_right) = (f(left), f(right));
    let end = b;
    while b - a > 2e-3 {
        if f_left > f_right {
            (b, right, f_right) = (right, left, f_left);
            left = b - golden * (b - a);
            f_left = f(left);
        } else {
            (a, left, f_left) = (left, right, f_right);
            right = a + golden * (b - a);
            f_right = f(right);
        }
    }
    let (middle, h) = (0.5 * (a + b), 1e-3);
    let (below, here, above) = (f(middle - h), f(middle), f(middle + h));
    let curvature = below - 2.0 * here + above;
    let shift = if curvature < 0.0 { 0.5 * h * (below - above) / curvature } else { 0.0 };
    (middle + shift.clamp(-2.0 * h, 2.0 * h)).min(end)
}

#[cfg(test)]
mod tests {
    use super::super::{Cages, samples};
    use super::*;

    #[test]
    fn the_breakdown_of_a_known_machine_is_found() {
        let (slip, torque) = samples::single().breakdown(1.0, 1.0);
        assert!((slip - 0.108_714).abs() < 0.51e-6, "{slip}");
        assert!((samples::base().t * torque - 114.7643).abs() < 0.51e-4, "{torque}");
    }

    #[test]
    fn breakdown_torque_is_that_of_the_source_seen_by_the_rotor() {
        // Thevenin: T = v_t^2 / (2 (r_t + sqrt(r_t^2 + (x_t + x_r)^2))), independent of the resistance of the rotor.
        let circuit = samples::single();
        let (r_s, l_s, l_m) = (circuit.r_s, circuit.l_ls, circuit.magnetisation.unsaturated());
        let square = r_s * r_s + (l_s + l_m).powi(2);
        let (v_t, r_t) = (l_m * l_m / square, r_s * l_m * l_m / square);
        let x_t = l_m * (r_s * r_s + l_s * (l_s + l_m)) / square;
        for r in [0.003, 0.014, 0.05] {
            let Cages::Single { l, .. } = circuit.cages else { panic!("one cage") };
            let circuit = Circuit { cages: Cages::Single { r, l }, ..circuit.clone() };
            let x = r_t.hypot(x_t + l);
            let (slip, torque) = circuit.breakdown(1.0, 1.0);
            assert!((torque - v_t / (2.0 * (r_t + x))).abs() < 1e-10, "{r}: {torque}");
            assert!((slip - r / x).abs() < 1e-8 * slip, "{r}: {slip}");
        }
    }

    #[test]
    fn a_rotor_of_high_resistance_is_strongest_at_standstill() {
        let circuit = Circuit { cages: Cages::Single { r: 1.0, l: 0.05 }, ..samples::single() };
        let (slip, torque) = circuit.breakdown(1.0, 1.0);
        assert!(slip == 1.0, "{slip}");
        assert!((torque - circuit.steady_state(1.0, 1.0, 1.0).torque).abs() < 1e-9);
    }
}
