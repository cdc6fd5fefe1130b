//! The main flux over the current that drives it.

use blocksim_block::ParamError;

/// How the main flux follows the magnetising current, in per unit: straight lines from knot to knot, from the
/// origin on, and beyond the last knot along the last line. Odd: turning the current turns the flux.
#[derive(Debug, Clone, PartialEq)]
pub struct Magnetisation {
    /// Knots `(current, flux)`, both strictly increasing, the first `(0, 0)`; at least two. The last line goes on.
    knots: Vec<(f64, f64)>,
}

impl Magnetisation {
    /// Without saturation: `psi_m = l_m i_m`; `l_m` is positive.
    pub fn linear(l_m: f64) -> Self {
        Self { knots: vec![(0.0, 0.0), (1.0, l_m)] }
    }

    /// From the curve of a machine that turns without load: RMS current and RMS voltage of a winding in per unit, at
    /// rated frequency. The resistance is neglected: `v = l_ls i + psi_m`.
    ///
    /// # Errors
    /// Lists of different lengths, less than two points, a first point other than (0, 0), values that do not rise,
    /// a voltage that rises by less than the leakage `l_ls` takes.
    pub fn from_open_circuit(current: &[f64], voltage: &[f64], l_ls: f64) -> Result<Self, ParamError> {
        let fail = |member: &str, message: String| ParamError::new(format!("saturation.{member}"), message);
        if current.len() != voltage.len() {
            let message = format!("{} voltages for {} currents", voltage.len(), current.len());
            return Err(fail("voltage", message).help("give one voltage for each current"));
        }
        if current.len() < 2 {
            return Err(fail("current", format!("{} points make no curve", current.len()))
                .help("begin with 0, 0 and add at least one point; for a constant inductance write `saturation: None`"));
        }
        if (current[0], voltage[0]) != (0.0, 0.0) {
            let message = format!("the curve begins at {}, {} instead of 0, 0", current[0], voltage[0]);
            return Err(fail("current", message).help("put 0 in front of both lists"));
        }
        for k in 1..current.len() {
            let (di, dv) = (current[k] - current[k - 1], voltage[k] - voltage[k - 1]);
            if !(di > 0.0 && di.is_finite()) {
                let message = format!("{} does not follow {}: currents rise", current[k], current[k - 1]);
                return Err(fail(&format!("current[{k}]"), message).help("sort the points by current"));
            }
            if !(dv > l_ls * di && dv.is_finite()) {
                let message = format!(
                    "from {} to {} the voltage rises by {dv:.4} in per unit, but the leakage reactance alone takes {:.4}",
                    voltage[k - 1],
                    voltage[k],
                    l_ls * di
                );
                return Err(fail(&format!("voltage[{k}]"), message)
                    .help("leave the point out, or make `x_ls` smaller than the slope of the curve"));
            }
        }
        let knots = current.iter().zip(voltage).map(|(i, v)| (*i, v - l_ls * i)).collect();
        Ok(Self { knots })
    }

    /// Whether there is but one inductance.
    pub fn is_linear(&self) -> bool {
        self.knots.len() == 2
    }

    /// Inductance at no current.
    pub fn unsaturated(&self) -> f64 {
        self.knots[1].1 / self.knots[1].0
    }

    /// Knots `(current, flux)`; beyond the last, the line through the last two goes on.
    pub fn knots(&self) -> &[(f64, f64)] {
        &self.knots
    }
}

/// A rising function through the origin, linear between its knots and beyond the last.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rising {
    /// Arguments of all knots but the last: where a new line begins; the first is 0.
    starts: Vec<f64>,
    /// Value at the start and slope of each line.
    lines: Vec<(f64, f64)>,
}

impl Rising {
    /// Through points of strictly increasing arguments, the first (0, 0).
    pub(super) fn through(points: impl Iterator<Item = (f64, f64)>) -> Self {
        let points: Vec<(f64, f64)> = points.collect();
        let lines = points.windows(2).map(|p| (p[0].1, (p[1].1 - p[0].1) / (p[1].0 - p[0].0))).collect();
        Self { starts: points[..points.len() - 1].iter().map(|p| p.0).collect(), lines }
    }

    /// Value over argument (its limit at 0) and slope, at an argument that is not negative.
    #[inline]
    pub(super) fn ratio_and_slope(&self, z: f64) -> (f64, f64) {
        let line = self.starts.partition_point(|start| *start <= z).max(1) - 1;
        let (value, slope) = self.lines[line];
        let ratio = if line == 0 { slope } else { (value + slope * (z - self.starts[line])) / z };
        (ratio, slope)
    }

    /// The integral from 0 to an argument that is not negative.
    pub(super) fn integral(&self, z: f64) -> f64 {
        let ends = self.starts.iter().skip(1).copied().chain([f64::INFINITY]);
        let pieces = self.starts.iter().zip(ends).zip(&self.lines).take_while(|((start, _), _)| **start < z);
        pieces.fold(0.0, |sum, ((start, end), (value, slope))| {
            let width = z.min(end) - start;
            sum + width * (value + 0.5 * slope * width)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_open_circuit_curve_loses_the_voltage_of_the_leakage() {
        let curve = Magnetisation::from_open_circuit(&[0.0, 0.5, 1.5], &[0.0, 0.9, 1.2], 0.1).unwrap();
        let expected = [(0.0, 0.0), (0.5, 0.85), (1.5, 1.05)];
        for (found, expected) in curve.knots().iter().zip(expected) {
            assert!((found.0 - expected.0).abs() + (found.1 - expected.1).abs() < 1e-15, "{found:?}");
        }
        assert!(!curve.is_linear() && (curve.unsaturated() - 1.7).abs() < 1e-15);
    }

    #[test]
    fn a_rising_function_keeps_its_knots_and_its_last_slope() {
        let f = Rising::through([(0.0, 0.0), (0.5, 1.0), (1.5, 1.2)].into_iter());
        for (z, value, slope) in [(0.25, 0.5, 2.0), (0.5, 1.0, 0.2), (1.0, 1.1, 0.2), (3.5, 1.6, 0.2)] {
            let (ratio, found) = f.ratio_and_slope(z);
            assert!(
                (ratio * z - value).abs() < 1e-15 && (found - slope).abs() < 1e-15,
                "{z}: {ratio} {found}"
            );
        }
        assert_eq!(f.ratio_and_slope(0.0), (2.0, 2.0));
    }

    #[test]
    fn curves_without_meaning_are_refused_at_the_place_of_the_mistake() {
        let refused = |current: &[f64], voltage: &[f64]| {
            Magnetisation::from_open_circuit(current, voltage, 0.1).unwrap_err().param
        };
        assert_eq!(refused(&[0.0, 1.0], &[0.0]), "saturation.voltage");
        assert_eq!(refused(&[0.0], &[0.0]), "saturation.current");
        assert_eq!(refused(&[0.1, 1.0], &[0.1, 1.0]), "saturation.current");
        assert_eq!(refused(&[0.0, 1.0, 1.0], &[0.0, 1.0, 1.1]), "saturation.current[2]");
        assert_eq!(refused(&[0.0, 1.0, 2.0], &[0.0, 1.0, 1.05]), "saturation.voltage[2]");
        assert_eq!(refused(&[0.0, f64::NAN], &[0.0, 1.0]), "saturation.current[1]");
        assert_eq!(refused(&[0.0, 1.0], &[0.0, f64::INFINITY]), "saturation.voltage[1]");
    }
}
