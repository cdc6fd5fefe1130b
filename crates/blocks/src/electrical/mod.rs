//! Blocks: electrical.

mod asynchronous_machine;
mod asynchronous_machine_by_name_plate;
mod asynchronous_machine_component;
mod asynchronous_machine_outputs;
mod asynchronous_machine_parameters;
mod averaged_inverter;
mod capacitor;
mod controlled_current_source;
mod controlled_voltage_source;
mod current_sensor;
mod dc_motor;
mod dc_motor_by_rating;
mod dc_motor_by_stall;
mod dc_motor_line;
mod electrical_reference;
pub mod induction;
mod inductor;
mod permanent_magnet_machine;
mod resistor;
mod space_vector;
mod switched_inverter;
mod three_phase_source;
mod universal_motor;
mod vector_inverter;
mod voltage_sensor;
mod voltage_source;
mod volts_per_hertz;
mod wound_field_dc_motor;

pub use asynchronous_machine::AsynchronousMachine;
pub use asynchronous_machine_by_name_plate::{AsynchronousMachineByNamePlate, LockedRotor};
pub use asynchronous_machine_parameters::{
    Cage, Connection, Impedance, Impedances, Saturation, Start, ZeroSequence,
};
pub use averaged_inverter::AveragedInverter;
pub use capacitor::Capacitor;
pub use controlled_current_source::ControlledCurrentSource;
pub use controlled_voltage_source::ControlledVoltageSource;
pub use current_sensor::CurrentSensor;
pub use dc_motor::DcMotor;
pub use dc_motor_by_rating::DcMotorByRating;
pub use dc_motor_by_stall::DcMotorByStall;
pub use dc_motor_line::TorqueLine;
pub use electrical_reference::ElectricalReference;
pub use inductor::Inductor;
pub use permanent_magnet_machine::PermanentMagnetMachine;
pub use resistor::Resistor;
pub use switched_inverter::{Integration, SwitchedInverter};
pub use three_phase_source::ThreePhaseSource;
pub use universal_motor::UniversalMotor;
pub use vector_inverter::VectorInverter;
pub use voltage_sensor::VoltageSensor;
pub use voltage_source::VoltageSource;
pub use volts_per_hertz::VoltsPerHertz;
pub use wound_field_dc_motor::WoundFieldDcMotor;
