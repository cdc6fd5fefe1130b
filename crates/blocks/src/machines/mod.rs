//! Blocks: electrical machines.

mod asynchronous_machine;
mod asynchronous_machine_by_name_plate;
mod asynchronous_machine_component;
mod asynchronous_machine_outputs;
mod asynchronous_machine_parameters;
mod dc_motor;
mod dc_motor_by_rating;
mod dc_motor_by_stall;
mod dc_motor_line;
pub mod induction;
mod permanent_magnet_machine;
pub(crate) mod space_vector;
mod stepper_motor;
mod universal_motor;
mod warm_winding;
mod wound_field_dc_motor;

pub use asynchronous_machine::AsynchronousMachine;
pub use asynchronous_machine_by_name_plate::{AsynchronousMachineByNamePlate, LockedRotor};
pub use asynchronous_machine_parameters::{
    Cage, Connection, Impedance, Impedances, Saturation, Start, ZeroSequence,
};
pub use dc_motor::DcMotor;
pub use dc_motor_by_rating::DcMotorByRating;
pub use dc_motor_by_stall::DcMotorByStall;
pub use dc_motor_line::TorqueLine;
pub use permanent_magnet_machine::PermanentMagnetMachine;
pub use stepper_motor::StepperMotor;
pub use universal_motor::UniversalMotor;
pub use warm_winding::WarmWinding;
pub use wound_field_dc_motor::WoundFieldDcMotor;
