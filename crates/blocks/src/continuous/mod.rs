//! Blocks with continuous states.

mod derivative;
pub use derivative::Derivative;
mod history;
mod integrator;
pub use integrator::{Integrator, Wrap};
mod low_pass;
pub use low_pass::LowPass;
mod pid;
pub use pid::Pid;
pub(crate) mod pid_law;
pub use pid_law::{AntiWindup, Form, PidLaw};
pub(crate) mod rational;
mod reset;
pub use reset::Reset;
pub(crate) use reset::UNSEEN;
mod state_space;
pub use state_space::StateSpace;
mod transfer_function;
pub use transfer_function::TransferFunction;
mod transport_delay;
pub use transport_delay::TransportDelay;
pub(crate) mod units;
mod variable_transport_delay;
pub use variable_transport_delay::VariableTransportDelay;
