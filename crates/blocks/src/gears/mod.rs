//! Blocks: gears.

mod cycloidal_drive;
mod differential;
mod elastic_gear;
mod harmonic_drive;
mod lossy_gear;
pub(crate) mod mesh;
mod planetary_gear;
mod simple_gear;
mod worm_gear;

pub use cycloidal_drive::CycloidalDrive;
pub use differential::Differential;
pub use elastic_gear::ElasticGear;
pub use harmonic_drive::HarmonicDrive;
pub use lossy_gear::LossyGear;
pub use mesh::{BothWays, Direction, EachWay, Loss, Onset};
pub use planetary_gear::PlanetaryGear;
pub use simple_gear::SimpleGear;
pub use worm_gear::WormGear;
