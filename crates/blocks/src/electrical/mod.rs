//! Blocks: electrical networks: passive elements, sources, sensors, transformers.

mod ac_voltage_source;
mod capacitor;
mod controlled_current_source;
mod controlled_voltage_source;
mod coupled;
mod current_sensor;
mod electrical_reference;
mod exponential_diode;
mod ideal_transformer;
mod inductor;
mod mutual_inductance;
mod resistor;
mod saturating_inductor;
#[cfg(test)]
pub(crate) mod testing;
mod transformer;
mod variable_transformer;
mod varistor;
mod voltage_sensor;
mod voltage_source;

pub use ac_voltage_source::{AcVoltageSource, Amplitude};
pub use capacitor::Capacitor;
pub use controlled_current_source::ControlledCurrentSource;
pub use controlled_voltage_source::ControlledVoltageSource;
pub use current_sensor::CurrentSensor;
pub use electrical_reference::ElectricalReference;
pub use exponential_diode::ExponentialDiode;
pub use ideal_transformer::IdealTransformer;
pub use inductor::Inductor;
pub use mutual_inductance::MutualInductance;
pub use resistor::Resistor;
pub use saturating_inductor::SaturatingInductor;
pub use transformer::Transformer;
pub use variable_transformer::VariableTransformer;
pub use varistor::Varistor;
pub use voltage_sensor::VoltageSensor;
pub use voltage_source::VoltageSource;
