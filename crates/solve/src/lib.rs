//! Integration of ordinary differential equations, root finding and small dense linear algebra.
//!
//! A [`System`] is dx/dt = f(t, x) and nothing more. A [`Stepper`] makes one accepted step at a time and
//! interpolates within it; the caller owns time, events and recording.
//!
//! | stepper | order | for |
//! |---|---|---|
//! | [`Auto`] | 5(4), 1 to 5 | anything: `Ode45`, and `Ode15s` where that is stiff; the default |
//! | [`Ode45`] | 5(4) | anything that is not stiff |
//! | [`Ode23`] | 3(2) | loose tolerances, rough derivatives |
//! | [`Dop853`] | 8(5,3) | smooth systems at tight tolerances |
//! | [`Ode23tb`] | 2(3) | stiff systems at loose tolerances |
//! | [`Ode23t`] | 2 | the same without numerical damping |
//! | [`Ode15s`] | 1 to 5 | stiff systems, large and sparse ones too |
//! | [`Radau5`] | 5 | stiff systems at tight tolerances |
//! | [`Rodas4`] | 4(3) | small stiff systems |
//! | [`Ros34pw2`] | 3(2) | stiff systems that know a cheap part of their Jacobian |
//! | [`FixedStep`] | 1 to 5 | the same steps every time |
//!
//! ```
//! use blocksim_solve::{Ode45, StepLimits, Stepper, Tolerances, problems};
//!
//! let mut system = problems::van_der_pol(5.0);
//! let mut stepper = Ode45::new(Tolerances::uniform(2, 1e-6, 1e-9), StepLimits::default());
//! let (mut t, mut x) = (0.0, [2.0, 0.0]);
//! while t < 10.0 {
//!     stepper.step(&mut system, &mut t, &mut x, 10.0)?;
//! }
//! assert_eq!(t, 10.0);
//! # Ok::<(), blocksim_solve::StepError>(())
//! ```

mod adaptive;
mod auto;
mod bogacki_shampine;
mod combine;
mod dop853;
mod dormand_prince;
mod jacobian;
pub mod linear;
mod newton;
mod ode15s;
mod past;
pub mod problems;
mod radau;
mod rodas;
mod roots;
mod ros34pw2;
mod runge_kutta;
mod shake;
mod sparse;
mod start_slope;
mod step_size;
mod stepper;
mod system;
mod tableau;
mod tr_bdf2;
#[cfg(test)]
mod trees;
mod weights;
mod within;

pub use adaptive::Adaptive;
pub use auto::Auto;
pub use bogacki_shampine::Ode23;
pub use dop853::Dop853;
pub use dormand_prince::Ode45;
pub use ode15s::Ode15s;
pub use radau::Radau5;
pub use rodas::Rodas4;
pub use roots::locate;
pub use ros34pw2::Ros34pw2;
pub use runge_kutta::{FixedStep, Weights, add_stages};
pub use shake::shake;
pub use stepper::{Counts, Memory, Share, StepError, StepLimits, Stepper, integrate};
pub use system::{Failed, System, Tolerances};
pub use tr_bdf2::{Ode23t, Ode23tb};
pub use weights::least_absolute;
