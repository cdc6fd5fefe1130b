use std::f64::consts::{FRAC_PI_2, PI};

use blocksim_block::prelude::*;

use crate::gears::{Direction, Loss, Onset};

use super::converter::self_locking;
use super::lead_screw::LeadScrew;

/// A `LeadScrew` described by its thread and friction instead of efficiencies.
///
/// With the pitch diameter $d$, the coefficient of friction $\mu$ and the angle $\alpha$ between a flank and the normal
/// of the axis, the lead angle is $\lambda$ and the friction angle $\rho$:
///
/// $$ \tan\lambda = \frac{l}{\pi d}, \qquad \tan\rho = \frac{\mu}{\cos\alpha}, \qquad
///    \eta_{forward} = \frac{\tan\lambda}{\tan(\lambda + \rho)}, \qquad
///    \eta_{backward} = \frac{\tan(\lambda - \rho)}{\tan\lambda} $$
///
/// With $\rho \ge \lambda$ the screw locks itself: the nut cannot drive it. Only `loss: Stiction` describes that.
///
/// ```ron
/// LeadScrewByFriction(lead: "10 mm", diameter: "18 mm", friction: 0.08, flank_angle: "15 deg")
/// ```
///
/// Source: the torque on a power screw of the textbooks of machine elements, for lead angles that are small against
/// 90 degrees.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Screw, builds = LeadScrew)]
pub struct LeadScrewByFriction {
    /// Way $l$ of the nut in one turn of the screw.
    #[block(
        unit = "m",
        positive,
        remedy = "the direction of the follower is set by `direction: Same` or `Reversed`"
    )]
    pub lead: f64,
    /// Pitch diameter $d$ of the thread.
    #[block(unit = "m", positive)]
    pub diameter: f64,
    /// Coefficient of friction $\mu$ between the flanks.
    #[block(not_negative)]
    pub friction: f64,
    /// Angle $\alpha$ of the flanks: half the angle of the thread, 15 degrees for a trapezoidal one, zero for a square one.
    #[block(
        unit = "rad", at_least = 0.0, below = FRAC_PI_2, default = 0.0,
        remedy = "write half the angle of the thread: 15 deg for a trapezoidal one, 30 deg for a metric one",
    )]
    pub flank_angle: f64,
    /// `Same`: the nut moves forward while the base turns in the positive sense; or `Reversed`.
    #[block(default = Direction::Same)]
    pub direction: Direction,
    /// How losses set in.
    #[block(group)]
    pub onset: Onset,
}

impl LeadScrewByFriction {
    /// Lead angle and friction angle, rad.
    fn angles(&self) -> (f64, f64) {
        let lambda = (self.lead / (PI * self.diameter)).atan();
        (lambda, (self.friction / self.flank_angle.cos()).atan())
    }

    /// Forward and backward; exactly one without friction.
    fn efficiencies(&self) -> (f64, f64) {
        let (lambda, rho) = self.angles();
        ((lambda.tan() / (lambda + rho).tan()).min(1.0), ((lambda - rho).tan() / lambda.tan()).min(1.0))
    }

    /// The screw that follows.
    fn screw(&self) -> LeadScrew {
        let Self { lead, direction, onset, .. } = *self;
        let (efficiency_forward, efficiency_backward) = self.efficiencies();
        LeadScrew { lead, direction, efficiency_forward, efficiency_backward, onset }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        let (lambda, rho) = self.angles();
        let others = ["lead", "diameter", "flank_angle"];
        if rho >= lambda && self.onset.loss != Loss::Stiction {
            let [rho, lambda] = [rho, lambda].map(f64::to_degrees);
            let fact =
                format!("the friction angle ({rho:.2} deg) is not below the lead angle ({lambda:.2} deg)");
            errors.add(self_locking("friction", fact).beside(&others));
        }
        if lambda + rho >= FRAC_PI_2 {
            let message = format!(
                "lead angle and friction angle make {:.2} deg together, so no torque at the screw moves the nut",
                (lambda + rho).to_degrees()
            );
            let error = ParamError::new("friction", message).beside(&others);
            errors.add(error.help("take a shorter `lead` or less `friction`"));
        }
    }

    fn build(self, errors: &mut ParamErrors) -> Option<LeadScrew> {
        let screw = self.screw();
        for error in screw.errors() {
            errors.add(ParamError { param: "friction".to_owned(), ..error });
        }
        Some(screw)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn screw(lead: f64, friction: f64, flank_angle: f64) -> LeadScrewByFriction {
        LeadScrewByFriction {
            lead,
            diameter: 0.018,
            friction,
            flank_angle,
            direction: Direction::Same,
            onset: Onset::DEFAULT,
        }
    }

    #[test]
    fn efficiencies_are_those_of_a_block_on_an_inclined_plane() {
        // Work out over work in while the block climbs by the lead, with the forces along the plane resolved by hand.
        let slope = 0.01 / (std::f64::consts::PI * 0.018);
        let up = slope * (1.0 - 0.08 * slope) / (slope + 0.08);
        let down = (slope - 0.08) / (1.0 + 0.08 * slope) / slope;
        let (forward, backward) = screw(0.01, 0.08, 0.0).efficiencies();
        assert!((forward - up).abs() < 1e-15 && (backward - down).abs() < 1e-14, "{forward}, {backward}");
        let ideal = screw(0.01, 0.0, 0.0);
        assert!((ideal.efficiencies().0 - 1.0).abs() < 1e-15 && ideal.try_build().is_ok());
        let pointed = screw(0.01, 0.08, 0.5);
        assert!(pointed.efficiencies().0 < forward, "steeper flanks are pressed harder");
    }

    #[test]
    fn screws_that_nothing_moves_or_no_load_drives_are_refused() {
        let locks = screw(0.004, 0.08, 0.0).errors()[0].clone();
        assert_eq!(locks.param, "friction");
        assert!(locks.message.contains("locks itself") && locks.help.is_some(), "{}", locks.message);
        let onset = Onset { loss: Loss::Stiction, ..Onset::DEFAULT };
        let holds = LeadScrewByFriction { onset, ..screw(0.004, 0.08, 0.0) };
        assert_eq!(holds.errors()[..], []);
        let steep = screw(0.2, 0.5, 0.0).errors().last().unwrap().clone();
        assert!(steep.message.contains("no torque"), "{}", steep.message);
        let flat = screw(0.01, 0.08, 2.0).errors()[0].clone();
        assert_eq!(flat.param, "flank_angle");
        assert_eq!(screw(0.01, 0.08, 0.26).errors()[..], []);
    }
}
