//! Parameters of induction machines that are more than a number.

use blocksim_block::in_unit::{self, Measure};
use blocksim_block::prelude::*;

use super::induction::Magnetisation;

/// How the windings are connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Connection {
    /// Each winding lies between two lines.
    #[default]
    Delta,
    /// Each winding lies between a line and a common point that is connected to nothing else.
    Wye,
    /// Both ends of each winding are connected outside of the machine.
    Open,
}

/// Fluxes at the start.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Start {
    /// No flux.
    #[default]
    Zero,
    /// The steady state of a supply and a slip.
    Magnetised {
        /// RMS voltage from line to line, V; with open windings, that of a winding.
        #[serde(deserialize_with = "in_unit::voltage")]
        voltage: f64,
        /// Frequency of the supply, Hz; zero for direct current.
        #[serde(deserialize_with = "in_unit::frequency")]
        frequency: f64,
        /// Slip against that frequency: 0 for no load, 1 for standstill.
        #[serde(deserialize_with = "in_unit::share")]
        slip: f64,
    },
    /// Flux linkages in per unit, in the frame of the states.
    Explicit {
        /// Stator: direct and quadrature axis.
        psi_s: [f64; 2],
        /// Cage: direct and quadrature axis.
        psi_r: [f64; 2],
        /// Second cage.
        #[serde(default)]
        psi_r2: [f64; 2],
        /// Zero sequence of the stator.
        #[serde(default)]
        psi_0s: f64,
    },
}

impl Start {
    /// Reports numbers that are none.
    pub(super) fn validate(&self, errors: &mut ParamErrors) {
        match *self {
            Start::Zero => {}
            Start::Magnetised { voltage, frequency, slip } => {
                errors.take(not_negative("start.voltage", voltage));
                errors.take(finite("start.frequency", frequency));
                errors.take(finite("start.slip", slip));
            }
            Start::Explicit { psi_s, psi_r, psi_r2, psi_0s } => {
                for (name, psi) in
                    [("psi_s", psi_s), ("psi_r", psi_r), ("psi_r2", psi_r2), ("psi_0s", [psi_0s; 2])]
                {
                    if let Some(psi) = psi.iter().find(|psi| !psi.is_finite()) {
                        errors.take(finite(&format!("start.{name}"), *psi));
                    }
                }
            }
        }
    }
}

/// In what resistances and reactances are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Impedances {
    /// In ohm.
    #[default]
    Ohm,
    /// In units of `3 V_n^2 / S_n`.
    PerUnit,
}

/// A resistance or reactance, in ohm or per unit.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct Impedance {
    #[serde(deserialize_with = "in_unit::impedance")]
    measure: Measure,
}

impl Inspect for Impedance {
    fn numbers(&self, place: &mut Vec<usize>, see: &mut dyn FnMut(&[usize], f64)) {
        see(place, self.measure.value);
    }
}

impl Impedance {
    /// A number without unit.
    pub const fn bare(value: f64) -> Self {
        Self { measure: Measure { value, has_unit: false } }
    }

    /// In per unit, on the base `z_base` (ohm).
    pub(super) fn per_unit(self, given: Impedances, z_base: f64) -> f64 {
        match given {
            Impedances::Ohm => self.measure.value / z_base,
            Impedances::PerUnit => self.measure.value,
        }
    }

    /// Whether the unit is the one that is expected.
    ///
    /// # Errors
    /// A unit where none is.
    pub(super) fn fits(self, name: &str, given: Impedances) -> Result<(), ParamError> {
        if given == Impedances::Ohm || !self.measure.has_unit {
            return Ok(());
        }
        let message = format!("`{name}` is in ohm, but `impedances: PerUnit` asks for none");
        Err(ParamError::new(name, message).help("leave the unit away, or write `impedances: Ohm`"))
    }
}

/// The cage of a rotor.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Cage {
    /// `r_r` and `x_lr` say everything.
    #[default]
    Single,
    /// A second circuit; also for deep bars, whose resistance rises with the slip.
    Double {
        /// Resistance of the second cage, referred to the stator.
        r_r2: Impedance,
        /// Leakage reactance of the second cage.
        x_lr2: Impedance,
        /// Leakage reactance that both cages have in common.
        #[serde(default = "nothing")]
        x_lr12: Impedance,
    },
}

impl Cage {
    /// The impedances of a second cage, with their names.
    pub(super) fn impedances(&self) -> Vec<(&'static str, Impedance)> {
        match *self {
            Cage::Single => Vec::new(),
            Cage::Double { r_r2, x_lr2, x_lr12 } => {
                vec![("cage.r_r2", r_r2), ("cage.x_lr2", x_lr2), ("cage.x_lr12", x_lr12)]
            }
        }
    }
}

fn nothing() -> Impedance {
    Impedance::bare(0.0)
}

/// Saturation of the main flux.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Saturation {
    /// None: `x_m` is the magnetising reactance.
    #[default]
    None,
    /// The curve of the machine turning without load at rated frequency, of a winding.
    Table {
        /// RMS current of a winding: in A with a unit, in per unit without.
        #[serde(deserialize_with = "in_unit::currents")]
        current: Vec<Measure>,
        /// RMS voltage of a winding: in V with a unit, in per unit without.
        #[serde(deserialize_with = "in_unit::voltages")]
        voltage: Vec<Measure>,
    },
}

impl Saturation {
    /// The curve; `None` without saturation. Rated current and voltage are RMS values of a winding, `l_ls` is in per
    /// unit.
    ///
    /// # Errors
    /// Units in some places only; a curve without meaning.
    pub(super) fn curve(
        &self,
        rated_current: f64,
        rated_voltage: f64,
        l_ls: f64,
    ) -> Result<Option<Magnetisation>, ParamError> {
        let Saturation::Table { current, voltage } = self else { return Ok(None) };
        let current = in_per_unit("current", current, rated_current)?;
        let voltage = in_per_unit("voltage", voltage, rated_voltage)?;
        Magnetisation::from_open_circuit(&current, &voltage, l_ls).map(Some)
    }
}

fn in_per_unit(name: &str, list: &[Measure], rated: f64) -> Result<Vec<f64>, ParamError> {
    // Zero is zero in any unit.
    let in_si = list.iter().any(|item| item.has_unit);
    if let Some(odd) = list.iter().position(|item| item.value != 0.0 && item.has_unit != in_si) {
        let message = "some values have a unit and some have not";
        return Err(ParamError::new(format!("saturation.{name}[{odd}]"), message)
            .help("write a unit at each of them, or none for values in per unit"));
    }
    Ok(list.iter().map(|item| if in_si { item.value / rated } else { item.value }).collect())
}

/// Whether a current of the zero sequence can flow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum ZeroSequence {
    /// It follows from `x_0`.
    #[default]
    Include,
    /// It is zero, whatever the voltage.
    Exclude,
}
