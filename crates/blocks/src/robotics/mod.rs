//! Robots as one description: kinematics and dynamics of an arm.

mod description;
pub use description::{
    BearingData, BodyData, DriveData, GearData, JointLink, MotorData, RobotDescription, Seat, TcpData,
};
