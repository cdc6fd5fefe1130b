//! Losses of gear meshes: what all gears have in common.

use blocksim_block::physical::{Domain, DryMesh, Element, LossModel, MeshLoss};
use blocksim_block::prelude::*;

/// Which way the output of a gear turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Direction {
    /// Against the input.
    #[default]
    Reversed,
    /// With the input.
    Same,
}

impl Direction {
    /// Speed of the follower over speed of the base when their amounts have this ratio.
    pub(crate) fn ratio(self, amount: f64) -> f64 {
        match self {
            Direction::Reversed => -amount,
            Direction::Same => amount,
        }
    }
}

/// How the loss of a gear sets in around standstill.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Loss {
    /// Over the speed of the base: the mesh never delivers power.
    #[default]
    Dissipative,
    /// Over the power through the mesh, as in widespread libraries of driveline parts. At standstill it is
    /// not zero when the efficiencies differ or are below one.
    Published,
    /// Fully at any speed, and stuck at rest while the torques on both sides are within the losses; with events.
    Stiction,
}

/// How the losses of a gear set in around standstill.
#[derive(Debug, Clone, Copy, PartialEq, Parameters)]
pub struct Onset {
    /// `Dissipative`, `Published` or `Stiction`: how the loss sets in around standstill.
    #[block(default = Loss::Dissipative)]
    pub loss: Loss,
    /// Speed of the base above which the full loss acts; for `Dissipative`.
    #[block(unit = "rad/s", positive, default = 1.0)]
    pub threshold: f64,
    /// Power above which the full loss acts; for `Published`.
    #[block(unit = "W", positive, default = 1e-3)]
    pub power_threshold: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl Onset {
    /// As it is where nothing is said.
    pub const DEFAULT: Onset =
        Onset { loss: Loss::Dissipative, threshold: 1.0, power_threshold: 1e-3, heat_port: false };
}

/// Losses of a gear with one efficiency for both directions of power.
#[derive(Debug, Clone, Copy, PartialEq, Parameters)]
pub struct BothWays {
    /// Efficiency, above 0 and at most 1.
    #[block(positive, at_most = 1.0, default = 1.0, remedy = "1 means no losses")]
    pub efficiency: f64,
    /// How they set in.
    #[block(group)]
    pub onset: Onset,
}

impl BothWays {
    /// No losses.
    pub const NONE: BothWays = BothWays { efficiency: 1.0, onset: Onset::DEFAULT };

    fn validate(&self, errors: &mut ParamErrors) {
        self.mesh().validate(errors);
    }

    pub(crate) fn mesh(&self) -> Mesh {
        let efficiency = ("efficiency", self.efficiency);
        Mesh { forward: efficiency, backward: efficiency, onset: self.onset }
    }
}

/// Losses of a gear with an efficiency for each direction of power.
#[derive(Debug, Clone, Copy, PartialEq, Parameters)]
pub struct EachWay {
    /// Efficiency when the base drives the follower, above 0 and at most 1.
    #[block(positive, at_most = 1.0, default = 1.0, remedy = "1 means no losses")]
    pub efficiency_forward: f64,
    /// Efficiency when the follower drives the base, above 0 and at most 1.
    #[block(positive, at_most = 1.0, default = 1.0, remedy = "1 means no losses")]
    pub efficiency_backward: f64,
    /// How they set in.
    #[block(group)]
    pub onset: Onset,
}

impl EachWay {
    /// No losses.
    pub const NONE: EachWay =
        EachWay { efficiency_forward: 1.0, efficiency_backward: 1.0, onset: Onset::DEFAULT };

    fn validate(&self, errors: &mut ParamErrors) {
        self.mesh().validate(errors);
    }

    pub(crate) fn mesh(&self) -> Mesh {
        Mesh {
            forward: ("efficiency_forward", self.efficiency_forward),
            backward: ("efficiency_backward", self.efficiency_backward),
            onset: self.onset,
        }
    }
}

/// Efficiencies of a mesh and how its loss sets in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mesh {
    /// Efficiency from the base to the follower, with the name of its parameter.
    pub forward: (&'static str, f64),
    /// Efficiency from the follower to the base, with the name of its parameter.
    pub backward: (&'static str, f64),
    pub onset: Onset,
}

/// Largest fall of the published loss with the torque, over `FL + BL`: the largest value of
/// `-(tanh(y) + y / cosh(y)^2) / 2`.
const STEEPEST: f64 = 0.59984;

impl Mesh {
    /// Reports efficiencies with which the published law of losses has several solutions.
    pub(crate) fn validate(&self, errors: &mut ParamErrors) {
        let (forward, backward) = (1.0 - self.forward.1, 1.0 / self.backward.1 - 1.0);
        let margin = 1.0 - 0.5 * (forward - backward) - STEEPEST * (forward + backward);
        if self.onset.loss == Loss::Published && margin <= 0.0 {
            let message = format!(
                "with efficiencies {} and {} the published law of losses has several solutions",
                self.forward.1, self.backward.1
            );
            let help = "write `loss: Dissipative`, which always has one solution, or raise the efficiencies";
            errors.add(ParamError::new(self.backward.0, message).beside(&[self.forward.0]).help(help));
        }
    }

    /// What a mesh with stiction loses.
    pub(crate) fn dry(&self) -> DryMesh {
        DryMesh { share: [1.0 / self.forward.1 - 1.0, 1.0 - self.backward.1], ..DryMesh::default() }
    }

    /// Ports, output and element of a gear whose base turns; the follower turns or slides.
    pub(crate) fn part(&self, follower: Domain, ratio: f64) -> Part {
        Part::new()
            .port("base", Domain::Rotational, "input side")
            .port("follower", follower, "output side")
            .reads("tau", "N*m", Reading::Mesh(0), "torque into the base")
            .element(Element::Gear { base: 0, follower: 1, ratio, loss: self.element() })
            .heat_port(self.onset.heat_port)
    }

    /// The loss for the network; `None` when nothing is lost.
    pub(crate) fn element(&self) -> Option<MeshLoss> {
        if self.forward.1 == 1.0 && self.backward.1 == 1.0 {
            return None;
        }
        let model = match self.onset.loss {
            Loss::Dissipative => LossModel::Dissipative { threshold: self.onset.threshold },
            Loss::Published => LossModel::Published { threshold: self.onset.power_threshold },
            Loss::Stiction => LossModel::Stiction,
        };
        Some(MeshLoss { forward: self.forward.1, backward: self.backward.1, model })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn losses(forward: f64, backward: f64, loss: Loss) -> EachWay {
        let onset = Onset { loss, ..Onset::DEFAULT };
        EachWay { efficiency_forward: forward, efficiency_backward: backward, onset }
    }

    #[test]
    fn a_gear_without_losses_is_ideal() {
        assert_eq!(losses(1.0, 1.0, Loss::Dissipative).mesh().element(), None);
        assert!(losses(1.0, 0.9, Loss::Dissipative).mesh().element().is_some());
    }

    #[test]
    fn efficiencies_lie_above_zero_and_are_at_most_one() {
        for bad in [0.0, -0.1, 1.01, f64::NAN] {
            let error = losses(bad, 0.9, Loss::Dissipative).errors()[0].clone();
            assert_eq!(error.param, "efficiency_forward");
            assert_eq!(losses(0.9, bad, Loss::Dissipative).errors()[0].param, "efficiency_backward");
        }
    }

    #[test]
    fn the_published_law_is_refused_where_it_has_several_solutions() {
        assert_eq!(losses(0.5, 0.5, Loss::Published).errors()[..], []);
        assert!(!losses(0.25, 0.25, Loss::Published).errors().is_empty());
        assert_eq!(losses(0.25, 0.25, Loss::Dissipative).errors()[..], []);
    }

    #[test]
    fn the_bound_of_the_published_law_is_its_steepest_fall() {
        let slope = |y: f64| 0.5 * (y.tanh() + y / y.cosh().powi(2));
        let steepest = (0..400_000).map(|i| slope(f64::from(i) * 1e-5)).fold(0.0, f64::max);
        assert!((steepest - STEEPEST).abs() < 1e-5, "{steepest}");
    }
}
