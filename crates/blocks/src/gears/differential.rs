use blocksim_block::physical::{Domain, DryMesh, Element};
use blocksim_block::prelude::*;

use super::mesh::{BothWays, Mesh};

/// Differential: the drive shaft turns with the mean of two output shafts and divides its torque equally.
///
/// $$ w_D = \frac{i}{2}(w_L + w_R), \qquad \tau_L = \tau_R = \frac{i}{2} \tau_D $$
///
/// Positive torques pass from the drive to the outputs; so they divide without losses. It has no inertia; the housing
/// stands still (an implied ground).
///
/// `efficiency` is that of the final drive, from the drive shaft to the cage; `inner_efficiency` that of the wheels in the
/// cage, which turn when the outputs differ: the slower output then gets $1/\eta$ of the torque of the faster one. Losses act
/// as in a `CycloidalDrive`; the bases are the drive shaft, and the left output against the cage.
///
/// ```ron
/// Differential(ratio: 4.1, efficiency: 0.96, inner_efficiency: 0.8)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Gears", symbol = Differential)]
pub struct Differential {
    /// Speed of the drive shaft over the mean speed of the outputs, $i$; negative when it reverses.
    #[block(
        not_zero,
        default = 1.0,
        zero = "the drive shaft would never turn: write 1.0 for a differential without a final drive"
    )]
    pub ratio: f64,
    /// Efficiency of the wheels in the cage, above 0 and at most 1.
    #[block(positive, at_most = 1.0, default = 1.0, remedy = "1 means no losses")]
    pub inner_efficiency: f64,
    /// Losses of the final drive; how all of them set in.
    #[block(group)]
    pub losses: BothWays,
}

impl Differential {
    /// Losses of the wheels in the cage.
    fn inner(&self) -> Mesh {
        let efficiency = ("inner_efficiency", self.inner_efficiency);
        Mesh { forward: efficiency, backward: efficiency, onset: self.losses.onset }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.inner().validate(errors);
    }
}

impl Component for Differential {
    fn part(&self, _given: &Given) -> Part {
        let half = 0.5 * self.ratio;
        let part = Part::new()
            .port("drive", Domain::Rotational, "drive shaft")
            .port("left", Domain::Rotational, "one output shaft")
            .port("right", Domain::Rotational, "the other output shaft")
            .heat_port(self.losses.onset.heat_port);
        let (final_drive, inner) = (self.losses.mesh().element(), self.inner().element());
        if final_drive.is_none() && inner.is_none() {
            return part.element(Element::Coupling { terms: vec![(0, 1.0), (1, -half), (2, -half)] });
        }
        let cage = part.ports.len();
        let part = part.inner("cage", Domain::Rotational).element(Element::Gear {
            base: 0,
            follower: cage,
            ratio: 1.0 / self.ratio,
            loss: final_drive,
        });
        match inner {
            None => part.element(Element::Coupling { terms: vec![(cage, 1.0), (1, -0.5), (2, -0.5)] }),
            // Seen from the cage it is a pair of wheels.
            loss => part
                .inner("left_on_cage", Domain::Rotational)
                .inner("right_on_cage", Domain::Rotational)
                .element(Element::Coupling { terms: vec![(cage + 1, 1.0), (1, -1.0), (cage, 1.0)] })
                .element(Element::Coupling { terms: vec![(cage + 2, 1.0), (2, -1.0), (cage, 1.0)] })
                .element(Element::Gear { base: cage + 1, follower: cage + 2, ratio: -1.0, loss }),
        }
    }

    fn mesh_losses(&self, _c: &Flowing, _speed: &[f64], losses: &mut [DryMesh]) {
        let lossy = [self.losses.mesh(), self.inner()].into_iter().filter(|mesh| mesh.element().is_some());
        losses.iter_mut().zip(lossy).for_each(|(to, mesh)| *to = mesh.dry());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_of_zero_is_refused() {
        let plain = |ratio| Differential { ratio, inner_efficiency: 1.0, losses: BothWays::NONE };
        let error = plain(0.0).errors()[0].clone();
        assert_eq!(error.param, "ratio");
        assert!(error.help.is_some());
        assert!(!plain(f64::NAN).errors().is_empty());
        assert_eq!(plain(-3.0).errors()[..], []);
        let lossy = Differential { inner_efficiency: 0.0, ..plain(3.0) };
        assert_eq!(lossy.errors()[0].param, "inner_efficiency");
    }
}
