//! Parameters from measurements: numbers in, estimates with their accuracy out.
//!
//! | question | function |
//! |---|---|
//! | linear and nonlinear least squares with standard errors | [`least_squares`], [`nonlinear_least_squares`] |
//! | Coulomb and viscous friction from two or many speeds | [`two_point`], [`line()`] |
//! | breakaway, Coulomb and viscous friction through gear and motor | [`curve`] |
//! | unknowns of a model of which each look costs a run | [`fit()`] |
//! | the same from several signals, each with its own noise | [`fit_signals`] |
//! | which combinations of masses and inertias decide the torques | [`BaseParameters`] |
//! | a motion that shows them well | [`excitation`] |
//! | their values from torques along a motion | [`identify`], [`prediction_error`] |
//! | samples of a recorded motion, with derivatives where they are missing | [`Recording`] |
//! | gear, friction and inertia of a drive from a recorded motion | [`drive()`] |
//!
//! All angles are in rad, torques in N m.

mod base_parameters;
mod drive;
mod dynamics;
mod error;
mod excitation;
mod fit;
mod friction;
mod least_squares;
mod random;
mod recording;
mod signals;
mod smooth;
mod student;

pub use base_parameters::{BaseParameter, BaseParameters, inertial_name};
pub use drive::{DriveFit, DriveSample, drive};
pub use dynamics::{Identified, Sample, identify, prediction_error};
pub use error::IdentifyError;
pub use excitation::{Excitation, Fourier, JointRange, excitation};
pub use fit::{Fitted, Model, Stopped, correlations, fit, nonlinear_least_squares};
pub use friction::{
    Curve, CurveFit, FrictionLaw, KnownFriction, Line, Point, Stage, Torques, Train, TwoPoint, curve, line,
    two_point,
};
pub use least_squares::{Estimate, Fit, least_squares};
pub use random::Random;
pub use recording::{Recording, Treated};
pub use signals::{Signal, fit_signals};
pub use smooth::{derivative, low_pass, on_grid};
pub use student::interval_95;
