//! Blocks: mechanics of parts that slide.

mod constant_force;
mod converter;
mod force_sensor;
mod ideal_force_source;
mod ideal_velocity_source;
mod lead_screw;
mod lead_screw_by_friction;
mod mass;
mod rack_and_pinion;
mod translational_damper;
mod translational_friction;
mod translational_hard_stop;
mod translational_motion_sensor;
mod translational_reference;
mod translational_rigid_stop;
mod translational_spring;
mod translational_spring_damper;
mod wheel_and_axle;

pub use constant_force::ConstantForce;
pub use force_sensor::ForceSensor;
pub use ideal_force_source::IdealForceSource;
pub use ideal_velocity_source::IdealVelocitySource;
pub use lead_screw::LeadScrew;
pub use lead_screw_by_friction::LeadScrewByFriction;
pub use mass::Mass;
pub use rack_and_pinion::RackAndPinion;
pub use translational_damper::TranslationalDamper;
pub use translational_friction::TranslationalFriction;
pub use translational_hard_stop::TranslationalHardStop;
pub use translational_motion_sensor::TranslationalMotionSensor;
pub use translational_reference::TranslationalReference;
pub use translational_rigid_stop::TranslationalRigidStop;
pub use translational_spring::TranslationalSpring;
pub use translational_spring_damper::TranslationalSpringDamper;
pub use wheel_and_axle::WheelAndAxle;
