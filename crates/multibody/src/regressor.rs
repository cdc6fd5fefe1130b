//! The regressor: joint torques are linear in the inertial parameters of the bodies.

use crate::data::Data;
use crate::kinematics::forward_accelerations;
use crate::model::Model;
use crate::spatial_inertia::SpatialInertia;
use crate::symmetric::Symmetric;
use nalgebra::Vector3;

/// Inertial parameters of one body.
pub const PARAMETERS_PER_BODY: usize = 10;

/// Names of the inertial parameters of one body, in their order: the mass m, kg, the first moment m c, kg m, and the
/// inertia about the origin of the body frame, kg m² (tensor elements, `Iyz = -∫ y z dm`).
pub const PARAMETER_NAMES: [&str; PARAMETERS_PER_BODY] =
    ["m", "mx", "my", "mz", "Ixx", "Iyy", "Izz", "Iyz", "Izx", "Ixy"];

impl Model {
    /// Inertial parameters of all bodies, [`PARAMETERS_PER_BODY`] each, in the order of [`PARAMETER_NAMES`].
    pub fn inertial_parameters(&self) -> Vec<f64> {
        let of = |inertia: &SpatialInertia| {
            let (h, i) = (&inertia.moment, &inertia.rotational);
            [inertia.mass, h.x, h.y, h.z, i.xx, i.yy, i.zz, i.yz, i.zx, i.xy]
        };
        self.bodies.iter().skip(1).flat_map(|body| of(&body.inertia)).collect()
    }
}

/// Matrix `y` with `tau = y p` for the inertial parameters `p` ([`Model::inertial_parameters`]) and the torques that
/// [`rnea`](crate::rnea) gives: n rows, [`PARAMETERS_PER_BODY`] columns for each body, row-major.
///
/// The force on a body is linear in its parameters, `f = I a + v ×* I v`; each column is the force of a unit parameter,
/// brought to the joints that carry the body. O(n d) with d the depth of the tree.
///
/// Source: C. G. Atkeson, C. H. An, J. M. Hollerbach, *Estimation of Inertial Parameters of Manipulator Loads and
/// Links*, International Journal of Robotics Research 5 (1986) 101-119.
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn regressor(model: &Model, data: &mut Data, q: &[f64], v: &[f64], a: &[f64], y: &mut [f64]) {
    let columns = PARAMETERS_PER_BODY * (model.bodies.len() - 1);
    assert!(
        y.len() == model.dof() * columns,
        "the regressor has {} entries, not {} x {columns}",
        y.len(),
        model.dof()
    );
    forward_accelerations(model, data, q, v, a);
    y.fill(0.0);
    for i in 1..model.bodies.len() {
        // The weight enters as an acceleration of the ground by -g, as in RNEA.
        let (v, mut a) = (data.bodies[i].v, data.bodies[i].a);
        a.linear -= data.bodies[i].world.rotation.tr_mul(&model.gravity);
        for parameter in 0..PARAMETERS_PER_BODY {
            let inertia = unit(parameter);
            // f = I a + v ×* I v
            let mut force = inertia.times(&a) + v.cross_force(&inertia.times(&v));
            let column = PARAMETERS_PER_BODY * (i - 1) + parameter;
            let mut j = i;
            while j != 0 {
                let body = &model.bodies[j];
                // τ_j = S_jᵀ f
                body.joint().project(&force, |k, value| y[(body.v + k) * columns + column] = value);
                force = data.bodies[j].x.force_to_parent(&force);
                j = body.parent;
            }
        }
    }
}

/// The inertia whose parameters are zero but for a one.
fn unit(parameter: usize) -> SpatialInertia {
    let one = |index: usize| if parameter == index { 1.0 } else { 0.0 };
    SpatialInertia {
        mass: one(0),
        moment: Vector3::new(one(1), one(2), one(3)),
        rotational: Symmetric { xx: one(4), yy: one(5), zz: one(6), yz: one(7), zx: one(8), xy: one(9) },
    }
}
