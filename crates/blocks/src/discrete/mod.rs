//! Blocks that sample.

mod delay;
pub use delay::Delay;
mod discrete_derivative;
pub use discrete_derivative::DiscreteDerivative;
mod discrete_integrator;
pub use discrete_integrator::DiscreteIntegrator;
mod discrete_pid;
pub use discrete_pid::DiscretePid;
mod discrete_transfer_function;
pub use discrete_transfer_function::DiscreteTransferFunction;
mod method;
pub use method::Method;
mod unit_delay;
pub use unit_delay::UnitDelay;
mod zero_order_hold;
pub use zero_order_hold::ZeroOrderHold;
mod discrete_state_space;
pub use discrete_state_space::DiscreteStateSpace;
mod edge_detector;
pub use edge_detector::EdgeDetector;
mod first_order_hold;
pub use first_order_hold::FirstOrderHold;
mod memory;
pub use memory::Memory;
