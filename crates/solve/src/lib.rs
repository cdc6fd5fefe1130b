//! Integration of ordinary differential equations, root finding and small dense linear algebra.
//!
//! A [`System`] is dx/dt = f(t, x) and nothing more. A [`Stepper`] makes one accepted step at a time and
//! interpolates within it; the caller owns time, events and recording.
//!
//! | stepper | order | for |
//! |---|---|---|
//! | [`Ode45`] | 5(4) | anything that is not stiff; the default |
//! | [`Ode23`] | 3(2) | loose tolerances, rough derivatives |
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
mod bogacki_shampine;
mod combine;
mod dormand_prince;
pub mod linear;
pub mod problems;
mod rodas;
mod roots;
mod ros34pw2;
mod runge_kutta;
mod step_size;
mod stepper;
mod system;
mod tableau;
#[cfg(test)]
mod trees;

pub use adaptive::Adaptive;
pub use bogacki_shampine::Ode23;
pub use dormand_prince::Ode45;
pub use rodas::Rodas4;
pub use roots::locate;
pub use ros34pw2::Ros34pw2;
pub use runge_kutta::FixedStep;
pub use stepper::{Counts, Memory, StepError, StepLimits, Stepper, integrate};
pub use system::{Failed, System, Tolerances};
