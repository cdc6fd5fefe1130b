//! Exact slopes of the derivatives beside those of differences.

use blocksim_solve::{Failed, System};

use crate::diagnose::{failed, state_names};
use crate::evaluate::Diagram;
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
    /// By how much both differ: nearly nothing, unless there is a kink nearby.
    pub spread: f64,
}

/// Distance, as a part of a state or of one, over which differences are taken.
const DISTANCE: f64 = 1e-3;

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
    /// Slopes of all derivatives over state `j` by differences, and by how much those over two distances differ.
    fn difference(&mut self, t: f64, x: &[f64], j: usize) -> Result<Vec<(f64, f64)>, Failed> {
        let mut central = |h: f64| -> Result<Vec<f64>, Failed> {
            let mut sides = [vec![0.0; x.len()], vec![0.0; x.len()]];
            let mut at = x.to_vec();
            for (side, dx) in [h, -h].into_iter().zip(&mut sides) {
                at[j] = x[j] + side;
                self.forget();
                self.derivatives(t, &at, dx)?;
            }
            let [above, below] = sides;
            Ok(above.iter().zip(below).map(|(a, b)| (a - b) / (2.0 * h)).collect())
        };
        let h = DISTANCE * x[j].abs().max(1.0);
        let (wide, narrow) = (central(h)?, central(h / 2.0)?);
        let both = wide.iter().zip(narrow);
        Ok(both.map(|(wide, narrow)| ((4.0 * narrow - wide) / 3.0, (wide - narrow).abs())).collect())
    }
}
