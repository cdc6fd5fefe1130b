//! Blocks: mechanics.

mod body;
mod constant_torque;
mod cycloidal_drive;
mod ideal_speed_source;
mod ideal_torque_source;
mod inertia;
mod joint_limit;
mod mesh;
mod motion_sensor;
mod quadratic_load;
mod revolute_joint;
mod rotational_damper;
mod rotational_friction;
mod rotational_hard_stop;
mod rotational_reference;
mod rotational_spring;
mod rotational_spring_damper;
mod simple_gear;
#[cfg(test)]
pub(crate) mod testing;
mod torque_sensor;
mod transform;
mod world;

pub use body::Body;
pub use constant_torque::ConstantTorque;
pub use cycloidal_drive::CycloidalDrive;
pub use ideal_speed_source::IdealSpeedSource;
pub use ideal_torque_source::IdealTorqueSource;
pub use inertia::Inertia;
pub use mesh::{Direction, Loss};
pub use motion_sensor::MotionSensor;
pub use quadratic_load::QuadraticLoad;
pub use revolute_joint::RevoluteJoint;
pub use rotational_damper::RotationalDamper;
pub use rotational_friction::RotationalFriction;
pub use rotational_hard_stop::RotationalHardStop;
pub use rotational_reference::RotationalReference;
pub use rotational_spring::RotationalSpring;
pub use rotational_spring_damper::RotationalSpringDamper;
pub use simple_gear::SimpleGear;
pub use torque_sensor::TorqueSensor;
pub use transform::Transform;
pub use world::World;
