//! Blocks: three-phase networks.

mod controlled_three_phase_source;
mod floating_neutral;
mod grounded_neutral;
mod neutral_point;
mod phase_permute;
mod phase_splitter;
mod three_phase_breaker;
mod three_phase_current_sensor;
mod three_phase_rlc;
pub(crate) mod three_phase_source;
mod three_phase_voltage_sensor;

pub use controlled_three_phase_source::ControlledThreePhaseSource;
pub use floating_neutral::FloatingNeutral;
pub use grounded_neutral::GroundedNeutral;
pub use neutral_point::NeutralPoint;
pub use phase_permute::PhasePermute;
pub use phase_splitter::PhaseSplitter;
pub use three_phase_breaker::{Opening, ThreePhaseBreaker};
pub use three_phase_current_sensor::ThreePhaseCurrentSensor;
pub use three_phase_rlc::ThreePhaseRlc;
pub use three_phase_source::ThreePhaseSource;
pub use three_phase_voltage_sensor::ThreePhaseVoltageSensor;
