//! Blocks: valves, converters and inverters.

mod average_value_converter;
mod averaged_inverter;
mod brake_chopper;
mod dc_link;
mod diode;
mod h_bridge;
mod ideal_switch;
mod igbt;
mod mosfet;
mod rectifier_bridge;
mod reversing_contactor;
mod single_phase_rectifier;
mod six_pulse_inverter;
mod switched_inverter;
mod thyristor;
pub(crate) mod valve;
mod vector_inverter;

pub use average_value_converter::AverageValueConverter;
pub use averaged_inverter::AveragedInverter;
pub use brake_chopper::BrakeChopper;
pub use dc_link::DcLink;
pub use diode::Diode;
pub use h_bridge::HBridge;
pub use ideal_switch::IdealSwitch;
pub use igbt::Igbt;
pub use mosfet::Mosfet;
pub use rectifier_bridge::RectifierBridge;
pub use reversing_contactor::ReversingContactor;
pub use single_phase_rectifier::SinglePhaseRectifier;
pub use six_pulse_inverter::SixPulseInverter;
pub use switched_inverter::{Integration, SwitchedInverter};
pub use thyristor::Thyristor;
pub use valve::Device;
pub use vector_inverter::VectorInverter;
