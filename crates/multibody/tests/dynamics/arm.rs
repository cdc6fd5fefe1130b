//! The ABB IRB 2600-12/1.85 with a welding torch, as numbers.
//!
//! Provenance. Offsets and axes: published, ROS-Industrial `abb_irb2600_support` (Apache-2.0, citing ABB data
//! sheet ROB0142EN_B and product specification 3HAC035959-001). Link masses: published in a thesis on this
//! robot (its table 6.10: CAD volumes times one density that gives ABB's total of 284 kg). Centres of mass
//! and inertias: derived, one uniform density integrated over the public CAD tessellation and scaled to
//! those masses; real castings may differ by 30 %. Torch (Fronius Robacta Drive CMT): mass measured, tensor
//! published in its data file and scaled to that mass, orientation on the flange assumed. Torch tip: that
//! of another gun, as a stand-in. Reflected inertia: derived from rotor and gear of each axis times the
//! squared ratio, which are estimates but for the gear of axis 3 and the motors of axes 4 to 6.

use blocksim_multibody::{BodyId, Inertia, Joint, Model, ModelBuilder, ModelError, Placement};

/// Inertia of rotor and gear input seen at the joint, kg m².
pub const REFLECTED: [f64; 6] = [27.60, 45.17, 11.28, 0.2646, 0.2646, 0.135];

/// Mass of the base, which does not move, kg.
pub const BASE_MASS: f64 = 87.87;

/// Torch tip in the frame of body 6: (0.1195, 0, 0.352) m in the tool frame, which is turned by 90° about y.
pub const TORCH_TIP: [f64; 3] = [0.352, 0.0, -0.1195];

/// One link: joint origin in the parent (m), axis, mass (kg), centre of mass (m), moments (Ixx, Iyy, Izz)
/// and products (Iyz, Izx, Ixy) about the centre of mass (kg m²).
struct Link {
    origin: [f64; 3],
    axis: [f64; 3],
    mass: f64,
    com: [f64; 3],
    moments: [f64; 3],
    products: [f64; 3],
}

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

#[rustfmt::skip]
const LINKS: [Link; 6] = [
    Link { origin: [0.0, 0.0, 0.445], axis: Z, mass: 69.88, com: [0.04062, 0.00784, -0.0671],
           moments: [1.2154, 1.7702, 1.6481], products: [-0.007373, -0.1382, -0.03357] },
    Link { origin: [0.150, 0.0, 0.0], axis: Y, mass: 43.28, com: [0.00006, -0.17255, 0.41736],
           moments: [3.062, 3.1148, 0.13203], products: [0.01814, 7.109e-4, 0.0] },
    Link { origin: [0.0, 0.0, 0.900], axis: Y, mass: 65.11, com: [0.04366, 0.01391, 0.07441],
           moments: [0.80886, 1.1076, 0.94861], products: [0.02654, -0.04758, 0.02141] },
    Link { origin: [0.0, 0.0, 0.115], axis: X, mass: 16.62, com: [0.60555, 0.00114, 0.00039],
           moments: [0.040422, 0.48489, 0.49437], products: [3.74e-5, -3.098e-4, -0.003736] },
    Link { origin: [0.795, 0.0, 0.0], axis: Y, mass: 0.99, com: [-0.00035, 0.00006, 0.00114],
           moments: [8.1187e-4, 0.0014203, 9.074e-4], products: [0.0, 0.0, 0.0] },
    Link { origin: [0.085, 0.0, 0.0], axis: X, mass: 0.24, com: [-0.04109, 0.0, -0.0001],
           moments: [5.8863e-5, 3.5632e-4, 3.5691e-4], products: [0.0, 0.0, 0.0] },
];

/// The arm without a tool; the frame of body 6 is the flange with its x axis forward.
pub fn bare() -> Result<Model, ModelError> {
    Ok(links()?.0.build())
}

/// The arm with the torch on its tool frame (flange turned by 90° about y).
pub fn with_torch() -> Result<Model, ModelError> {
    let (mut builder, flange) = links()?;
    let tool = Placement::from_rpy([0.0; 3], [0.0, std::f64::consts::FRAC_PI_2, 0.0]);
    let torch = Inertia::from_moments(
        5.25,
        [0.0892, 0.0066, 0.11276],
        [0.0019893, 0.011592, 0.01238],
        [-9.379e-5, 4.349e-4, 2.703e-3],
    )
    .map_err(|cause| ModelError::Inertia { body: flange.index(), cause })?;
    builder.add_inertia(flange, tool, torch)?;
    Ok(builder.build())
}

fn links() -> Result<(ModelBuilder, BodyId), ModelError> {
    let mut builder = ModelBuilder::new();
    let mut last = None;
    for (i, link) in LINKS.iter().enumerate() {
        let inertia = Inertia::from_moments(link.mass, link.com, link.moments, link.products)
            .map_err(|cause| ModelError::Inertia { body: i, cause })?;
        let placement = Placement::from_translation(link.origin);
        last = Some(builder.add_body(last, Joint::revolute(link.axis), placement, inertia)?);
    }
    Ok((builder, last.expect("the arm has links")))
}
