//! Exact slopes of the derivatives beside those of differences.

use blocksim_solve::{Failed, System};

use crate::diagnose::{failed, state_names};
use crate::evaluation::evaluate::Diagram;
use crate::{SimError, Simulation};

/// How a derivative changes with a state.
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    /// Path and name of the state whose derivative it is.
    pub derivative: String,
    /// Path and name of the state that is varied.
    pub state: String,
    /// The slope as the law says it.
    pub exact: f64,
    /// The same by central differences over a distance and half of it, extrapolated.
    pub difference: f64,
    /// By how much both differ, or the slopes on both sides: nearly nothing, unless there is a kink nearby.
    pub spread: f64,
}

/// Distance, as a part of a state or of one, over which differences are taken.
const DISTANCE: f64 = 1e-3;
/// Part of a slope by which those on both sides of a point differ at a kink.
const KINK: f64 = 0.1;

impl Simulation {
    /// The slopes of all derivatives over all states at the present time that are not zero; `None` where something that the
    /// derivatives depend on records no law, or has no value here. Modes and samples are held. A run may go on behind it with
    /// other last digits.
    ///
    /// # Errors
    /// If the diagram cannot be evaluated nearby.
    pub fn slopes(&mut self) -> Result<Option<Vec<Slope>>, SimError> {
        let names = state_names(&self.schedule);
        let n = self.x.len();
        let (mut slopes, mut direction, mut exact) = (Vec::new(), vec![0.0; n], vec![0.0; n]);
        for j in 0..n {
            direction[j] = 1.0;
            if !self.diagram.along(self.t, &self.x, &direction, &mut exact) {
                return Ok(None);
            }
            direction[j] = 0.0;
            let difference = self.diagram.difference(self.t, &self.x, j);
            let difference = difference.map_err(|_| failed(&self.schedule, &mut self.diagram))?;
            let pairs = exact.iter().zip(difference).enumerate();
            let pairs = pairs.filter(|(_, (a, (b, _)))| (**a, *b) != (0.0, 0.0));
            slopes.extend(pairs.map(|(i, (exact, (difference, spread)))| Slope {
                derivative: names[i].clone(),
                state: names[j].clone(),
                exact: *exact,
                difference,
                spread,
            }));
        }
        Ok(Some(slopes))
    }
}

impl Diagram {
    /// Slopes of all derivatives over state `j` by differences, and by how much those over two distances, or on both sides, differ.
    fn difference(&mut self, t: f64, x: &[f64], j: usize) -> Result<Vec<(f64, f64)>, Failed> {
        let mut at = x.to_vec();
        let mut moved = |by: f64| -> Result<Vec<f64>, Failed> {
            let mut dx = vec![0.0; x.len()];
            at[j] = x[j] + by;
            self.forget();
            self.derivatives(t, &at, &mut dx)?;
            Ok(dx)
        };
        let h = DISTANCE * x[j].abs().max(1.0);
        let here = moved(0.0)?;
        let (far, near) = ([moved(-h)?, moved(h)?], [moved(-h / 2.0)?, moved(h / 2.0)?]);
        let slope = |i: usize| {
            let (wide, narrow) = ((far[1][i] - far[0][i]) / (2.0 * h), (near[1][i] - near[0][i]) / h);
            let sides = [(here[i] - near[0][i]) / (h / 2.0), (near[1][i] - here[i]) / (h / 2.0)];
            let bend = (sides[1] - sides[0]).abs();
            let is_kink = bend > KINK * sides[0].abs().max(sides[1].abs());
            ((4.0 * narrow - wide) / 3.0, if is_kink { bend } else { (wide - narrow).abs() })
        };
        Ok((0..x.len()).map(slope).collect())
    }
}
