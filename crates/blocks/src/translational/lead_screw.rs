use std::f64::consts::TAU;

use blocksim_block::physical::{Domain, DryMesh};
use blocksim_block::prelude::*;

use crate::gears::mesh::{Direction, Loss, Mesh, Onset};

use super::converter::self_locking;

/// Screw (`base`, turns) and nut (`follower`, slides): $v_F = \pm \frac{l}{2\pi} w_B$ with the lead $l$.
///
/// Ball screws and trapezoidal screws. Without losses the force $F$ on the nut is the torque $F l / 2\pi$ at the screw,
/// and a mass on the nut counts as the moment of inertia $m (l/2\pi)^2$. Far above the thresholds the side that is
/// driven gets the share `efficiency_forward` (the screw drives) or `efficiency_backward` (the nut drives), as in a
/// `CycloidalDrive`. Both follow from friction in a `LeadScrewByFriction`. Screw and nut have neither inertia nor mass;
/// the bearing of the screw stands still (an implied ground).
///
/// A screw that locks itself lets no nut drive it: its `efficiency_backward` is zero or less, $\tau / (F l / 2\pi)$ with the
/// torque $\tau$ at the screw that lowers the load, counted negative. A curve of losses over the speed cannot hold the
/// load then; `Stiction` does, exactly.
///
/// ```ron
/// LeadScrew(lead: "10 mm", efficiency_forward: 0.92, efficiency_backward: 0.9)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Screw)]
pub struct LeadScrew {
    /// Way $l$ of the nut in one turn of the screw.
    #[block(
        unit = "m",
        positive,
        remedy = "the direction of the follower is set by `direction: Same` or `Reversed`"
    )]
    pub lead: f64,
    /// `Same`: the nut moves forward while the base turns in the positive sense; or `Reversed`.
    #[block(default = Direction::Same)]
    pub direction: Direction,
    /// Efficiency when the screw drives the nut, above 0 and at most 1.
    #[block(positive, at_most = 1.0, default = 1.0, remedy = "1 means no losses")]
    pub efficiency_forward: f64,
    /// Efficiency when the nut drives the screw, at most 1; zero or less, for a screw that locks itself, with `Stiction`.
    #[block(finite, at_most = 1.0, default = 1.0, remedy = "1 means no losses")]
    pub efficiency_backward: f64,
    /// How losses set in.
    #[block(group)]
    pub onset: Onset,
}

impl LeadScrew {
    fn mesh(&self) -> Mesh {
        Mesh {
            forward: ("efficiency_forward", self.efficiency_forward),
            backward: ("efficiency_backward", self.efficiency_backward),
            onset: self.onset,
        }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        let locks = self.efficiency_backward <= 0.0;
        if locks && self.onset.loss != Loss::Stiction {
            let fact = format!("`efficiency_backward` is {}", self.efficiency_backward);
            errors.add(self_locking("efficiency_backward", fact));
        }
        let backward = if locks { 1.0 } else { self.efficiency_backward };
        Mesh { backward: ("efficiency_backward", backward), ..self.mesh() }.validate(errors);
    }
}

impl Component for LeadScrew {
    fn part(&self, _given: &Given) -> Part {
        self.mesh().part(Domain::Translational, self.direction.ratio(self.lead / TAU))
    }

    fn mesh_losses(&self, _c: &Flowing, _speed: &[f64], losses: &mut [DryMesh]) {
        losses.fill(self.mesh().dry());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREW: LeadScrew = LeadScrew {
        lead: 0.01,
        direction: Direction::Same,
        efficiency_forward: 0.9,
        efficiency_backward: 0.8,
        onset: Onset::DEFAULT,
    };

    #[test]
    fn a_screw_that_locks_itself_is_refused_with_a_way_out() {
        for efficiency_backward in [0.0, -0.3] {
            let error = LeadScrew { efficiency_backward, ..SCREW }.errors()[0].clone();
            assert_eq!(error.param, "efficiency_backward");
            assert!(error.message.contains("locks itself"), "{}", error.message);
            assert!(error.help.is_some());
        }
        assert_eq!(SCREW.errors()[..], []);
        let locks = LeadScrew {
            efficiency_backward: -0.3,
            onset: Onset { loss: Loss::Stiction, ..Onset::DEFAULT },
            ..SCREW
        };
        assert_eq!(locks.errors()[..], []);
        let endless = LeadScrew { efficiency_backward: f64::NEG_INFINITY, ..locks };
        assert_eq!(endless.errors()[0].param, "efficiency_backward");
    }

    #[test]
    fn a_lead_against_the_direction_is_refused() {
        let error = LeadScrew { lead: -0.01, ..SCREW }.errors()[0].clone();
        assert_eq!(error.param, "lead");
        assert!(error.help.is_some_and(|help| help.contains("direction")));
    }
}
