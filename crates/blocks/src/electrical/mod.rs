//! Blocks: electrical.

mod asynchronous_machine;
mod averaged_inverter;
mod controlled_voltage_source;
mod current_sensor;
mod dc_motor;
mod electrical_reference;
mod machine_per_unit;
mod three_phase_source;
mod voltage_sensor;
mod voltage_source;
mod volts_per_hertz;

pub use asynchronous_machine::{AsynchronousMachine, Connection, Start};
pub use averaged_inverter::{AveragedInverter, Modulation};
pub use controlled_voltage_source::ControlledVoltageSource;
pub use current_sensor::CurrentSensor;
pub use dc_motor::DcMotor;
pub use electrical_reference::ElectricalReference;
pub use machine_per_unit::PerUnit;
pub use three_phase_source::ThreePhaseSource;
pub use voltage_sensor::VoltageSensor;
pub use voltage_source::VoltageSource;
pub use volts_per_hertz::VoltsPerHertz;
