//! Blocks: thermal networks: resistances, capacities, sources of heat and temperature, sensors.

mod ambient;
mod heat_capacity;
mod heat_flow_sensor;
mod heat_source;
mod temperature_sensor;
mod temperature_source;
mod thermal_radiation;
mod thermal_resistance;

pub use ambient::Ambient;
pub use heat_capacity::HeatCapacity;
pub use heat_flow_sensor::HeatFlowSensor;
pub use heat_source::HeatSource;
pub use temperature_sensor::TemperatureSensor;
pub use temperature_source::TemperatureSource;
pub use thermal_radiation::ThermalRadiation;
pub use thermal_resistance::ThermalResistance;
