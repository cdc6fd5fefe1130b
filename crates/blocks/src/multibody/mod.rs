//! Blocks: bodies, joints, and what acts on them.

pub(crate) mod axis;
mod body;
mod cylindrical_joint;
mod external_force;
mod frame_spring_damper;
mod free_joint;
pub(crate) mod joint_limit;
mod payload;
mod planar_joint;
mod point_plane_contact;
mod prismatic_joint;
mod quaternion;
mod revolute_joint;
mod spherical_joint;
mod transform;
mod transform_sensor;
mod universal_joint;
mod vector;
mod weld_joint;
mod world;

pub use body::Body;
pub use cylindrical_joint::CylindricalJoint;
pub use external_force::{Axes, ExternalForce};
pub use frame_spring_damper::FrameSpringDamper;
pub use free_joint::FreeJoint;
pub use payload::Payload;
pub use planar_joint::PlanarJoint;
pub use point_plane_contact::PointPlaneContact;
pub use prismatic_joint::PrismaticJoint;
pub use revolute_joint::RevoluteJoint;
pub use spherical_joint::SphericalJoint;
pub use transform::Transform;
pub use transform_sensor::TransformSensor;
pub use universal_joint::UniversalJoint;
pub use weld_joint::WeldJoint;
pub use world::World;
