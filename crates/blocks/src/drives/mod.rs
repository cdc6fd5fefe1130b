//! Blocks: electronics of drives, as signals.

mod chopper_control;
mod clarke;
mod direction_reverser;
mod duty_cycles;
mod h_bridge_pwm;
mod inverse_clarke;
mod inverse_park;
pub mod modulation;
mod park;
mod phase_reference;
mod phase_swap;
mod pwm_generator;
mod slip_controlled_vf;
mod stepper_driver;
mod switching;
mod transforms;
mod volts_per_hertz;

pub use chopper_control::ChopperControl;
pub use clarke::Clarke;
pub use direction_reverser::DirectionReverser;
pub use duty_cycles::DutyCycles;
pub use h_bridge_pwm::{HBridgePwm, Scheme};
pub use inverse_clarke::InverseClarke;
pub use inverse_park::InversePark;
pub use park::Park;
pub use phase_reference::PhaseReference;
pub use phase_swap::PhaseSwap;
pub use pwm_generator::PwmGenerator;
pub use slip_controlled_vf::SlipControlledVf;
pub use stepper_driver::{Command, Drive, StepperDriver};
pub use volts_per_hertz::VoltsPerHertz;
