//! The equivalent circuit of a squirrel-cage machine as data.

use blocksim_block::prelude::{not_negative, positive};
use blocksim_block::{ParamError, ParamErrors};

use super::complex::{Complex, J, ZERO, complex};
use super::magnetisation::Magnetisation;

/// Equivalent circuit of one winding, in per unit, referred to the stator.
#[derive(Debug, Clone, PartialEq)]
pub struct Circuit {
    /// Resistance of the stator.
    pub r_s: f64,
    /// Leakage inductance of the stator.
    pub l_ls: f64,
    /// The main flux, which links the stator and all cages.
    pub magnetisation: Magnetisation,
    /// The rotor.
    pub cages: Cages,
    /// Inductance of the zero sequence, positive; `None` when no current of the zero sequence can flow.
    pub l_0: Option<f64>,
}

/// Rotor circuits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cages {
    /// One cage.
    Single {
        /// Resistance.
        r: f64,
        /// Leakage inductance.
        l: f64,
    },
    /// Two cages, or the two that a deep bar behaves like.
    Double {
        /// Resistances.
        r: [f64; 2],
        /// Leakage inductances of each cage alone.
        l: [f64; 2],
        /// Leakage inductance that both have in common: flux that crosses the slot above both bars.
        common: f64,
    },
}

impl Cages {
    /// Number of rotor circuits for each axis.
    pub fn count(&self) -> usize {
        match self {
            Cages::Single { .. } => 1,
            Cages::Double { .. } => 2,
        }
    }

    /// Resistances; the second is zero for a single cage.
    pub fn resistances(&self) -> [f64; 2] {
        match *self {
            Cages::Single { r, .. } => [r, 0.0],
            Cages::Double { r, .. } => r,
        }
    }

    /// Leakage inductances: own one of the first, common one, own one of the second, each with the common part.
    pub fn leakage(&self) -> (f64, f64, f64) {
        match *self {
            Cages::Single { l, .. } => (l, 0.0, 0.0),
            Cages::Double { l, common, .. } => (l[0] + common, common, l[1] + common),
        }
    }

    /// Currents of the cages for a main flux of 1 that turns at the speed `slip` against the rotor (in per unit):
    /// `(r_k + j slip L) i = -j slip`.
    pub fn currents(&self, slip: f64) -> [Complex; 2] {
        // Without slip nothing is induced, even if the rotor has no resistance.
        if slip == 0.0 {
            return [ZERO; 2];
        }
        let ([r_1, r_2], (l_1, l_12, l_2)) = (self.resistances(), self.leakage());
        let (z_1, z_2) = (complex(r_1, slip * l_1), complex(r_2, slip * l_2));
        let induced = complex(0.0, -slip);
        if self.count() == 1 {
            return [induced / z_1, ZERO];
        }
        let z_12 = slip * l_12 * J;
        let determinant = z_1 * z_2 - z_12 * z_12;
        [induced * (z_2 - z_12) / determinant, induced * (z_1 - z_12) / determinant]
    }
}

impl Circuit {
    /// Reports a second cage that makes no sense, and currents that nothing limits, with the names that the parameters have in all blocks.
    pub fn validate(&self, errors: &mut ParamErrors) {
        let nothing = "so nothing limits the currents";
        match self.cages {
            Cages::Single { l, .. } if self.l_ls + l == 0.0 => {
                let error = ParamError::new("x_ls", format!("`x_ls` and `x_lr` are both 0, {nothing}"));
                errors.add(error.beside(&["x_lr"]).help("give stator or rotor its leakage reactance"));
            }
            Cages::Single { .. } => {}
            Cages::Double { r, l, common } => {
                for (name, value) in [("cage.r_r2", r[1]), ("cage.x_lr2", l[1]), ("cage.x_lr12", common)] {
                    errors.take(not_negative(name, value));
                }
                if l == [0.0; 2] {
                    let message = "`x_lr` and `x_lr2` are both 0, so nothing separates the cages";
                    let help = "write `cage: Single` with both resistances in parallel, or give one cage its leakage";
                    errors.add(ParamError::new("cage.x_lr2", message).beside(&["x_lr"]).help(help));
                } else if self.l_ls == 0.0 && common == 0.0 && l.contains(&0.0) {
                    let message = format!("`x_ls` and the leakage reactance of a cage are 0, {nothing}");
                    let error = ParamError::new("x_ls", message).beside(&["x_lr", "cage"]);
                    errors.add(error.help("give the stator its leakage reactance"));
                }
            }
        }
        if let Some(l_0) = self.l_0 {
            errors.take(
                positive("x_0", l_0)
                    .map_err(|error| error.help("`zero_sequence: Exclude` leaves the zero sequence out")),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SINGLE: Cages = Cages::Single { r: 0.02, l: 0.1 };

    fn circuit(l_ls: f64, cages: Cages) -> Circuit {
        Circuit { r_s: 0.03, l_ls, magnetisation: Magnetisation::linear(2.0), cages, l_0: None }
    }

    #[test]
    fn two_equal_cages_are_one_of_half_the_impedance() {
        let double = Cages::Double { r: [0.04; 2], l: [0.2; 2], common: 0.0 };
        let shared = Cages::Double { r: [0.04; 2], l: [0.1; 2], common: 0.05 };
        for slip in [-2.0, -0.01, 0.01, 0.3, 1.0] {
            let one = SINGLE.currents(slip)[0];
            for cages in [double, shared] {
                let [a, b] = cages.currents(slip);
                assert!((a - b).abs() < 1e-14 && (a + b - one).abs() < 1e-14 * one.abs(), "{slip}");
            }
        }
    }

    #[test]
    fn without_slip_nothing_is_induced() {
        assert_eq!(Cages::Single { r: 0.0, l: 0.0 }.currents(0.0), [ZERO; 2]);
    }

    #[test]
    fn currents_that_nothing_limits_are_refused() {
        let errors = |l_ls, cages| {
            let mut errors = ParamErrors::default();
            circuit(l_ls, cages).validate(&mut errors);
            errors
        };
        let refused = |l_ls, cages| errors(l_ls, cages)[0].param.clone();
        assert_eq!(refused(0.0, Cages::Single { r: 0.02, l: 0.0 }), "x_ls");
        assert_eq!(refused(0.1, Cages::Double { r: [0.02; 2], l: [0.0; 2], common: 0.1 }), "cage.x_lr2");
        assert_eq!(refused(0.0, Cages::Double { r: [0.02; 2], l: [0.1, 0.0], common: 0.0 }), "x_ls");
        assert_eq!(refused(0.1, Cages::Double { r: [0.02, -1.0], l: [0.1; 2], common: 0.0 }), "cage.r_r2");
        assert!(errors(0.0, SINGLE).is_empty());
        assert!(errors(0.0, Cages::Double { r: [0.02; 2], l: [0.1, 0.0], common: 0.1 }).is_empty());
    }
}
