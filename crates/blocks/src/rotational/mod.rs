//! Blocks: rotation: inertias, springs, friction, clutches, sources, sensors.

mod brake;
mod clutch;
mod constant_torque;
mod ideal_angle_source;
mod ideal_speed_source;
mod ideal_torque_source;
mod inertia;
mod lugre_friction;
mod motion_sensor;
mod one_way_clutch;
mod quadratic_load;
mod rotational_damper;
mod rotational_friction;
mod rotational_hard_stop;
mod rotational_reference;
mod rotational_spring;
mod rotational_spring_damper;
mod torque_sensor;

pub use brake::Brake;
pub use clutch::Clutch;
pub use constant_torque::ConstantTorque;
pub use ideal_angle_source::IdealAngleSource;
pub use ideal_speed_source::IdealSpeedSource;
pub use ideal_torque_source::IdealTorqueSource;
pub use inertia::Inertia;
pub use lugre_friction::LuGreFriction;
pub use motion_sensor::MotionSensor;
pub use one_way_clutch::OneWayClutch;
pub use quadratic_load::QuadraticLoad;
pub use rotational_damper::RotationalDamper;
pub use rotational_friction::RotationalFriction;
pub use rotational_hard_stop::RotationalHardStop;
pub use rotational_reference::RotationalReference;
pub use rotational_spring::RotationalSpring;
pub use rotational_spring_damper::RotationalSpringDamper;
pub use torque_sensor::TorqueSensor;
