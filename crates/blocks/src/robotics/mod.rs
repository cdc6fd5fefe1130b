//! Robots as one description: kinematics and dynamics of an arm.

pub(crate) mod arm;
mod description;
mod forward_kinematics;
mod gravity_compensation;
mod inverse_dynamics;
mod inverse_kinematics;
mod jacobian;
pub(crate) mod pose;
mod robot;
mod surroundings;

pub use arm::End;
pub use description::{
    BearingData, BodyData, DriveData, GearData, JointLink, MotorData, RobotDescription, Seat, TcpData,
};
pub use forward_kinematics::ForwardKinematics;
pub use gravity_compensation::GravityCompensation;
pub use inverse_dynamics::InverseDynamics;
pub use inverse_kinematics::{ElbowName, InverseKinematics, ShoulderName, WristName};
pub use jacobian::Jacobian;
pub use robot::Robot;
pub use surroundings::{Height, Surroundings, Thing};
