use blocksim_block::physical::{Domain, DryMesh, Element, LossModel, MeshLoss};
use blocksim_block::prelude::*;

use super::mesh::Direction;

/// Pair of gear wheels with losses of the mesh and friction of the bearings, that sticks: $w_B = \mp i\, w_F$.
///
/// The torque $T$ that passes from the base to the follower, counted at the base, is for a base that turns forward
///
/// $$ T = \min\left(\eta_{BF}\,T_B - \tau_{BF},\; \frac{T_B}{\eta_{FB}} - \tau_{FB}\right) $$
///
/// and the mirror image of it backward. The first line is the one of a base that drives, the second that of a follower
/// that drives; the law changes from one to the other where they meet, so it never jumps. The rest, $T_B - T$, is lost.
/// At rest any loss between both directions is taken, and the gear stands still exactly until the torques on both sides
/// move it.
/// Efficiencies and bearing torques are given over the amount of the base's speed; between two rows they are
/// interpolated, beyond the last they stay. The gear has no inertia; its housing stands still (an implied ground).
/// An impact, which changes speeds within no time (`RotationalRigidStop`), passes the mesh without loss.
///
/// Each row of `losses` holds the speed (rad/s), $\eta_{BF}$, $\eta_{FB}$, $\tau_{BF}$ and $\tau_{FB}$ (N*m).
///
/// ```ron
/// LossyGear(ratio: 40.0, direction: Same, losses: [
///     (0.0, 0.70, 0.55, "0.02 N*m", "0.02 N*m"),
///     ("300 rad/s", 0.85, 0.80, "0.03 N*m", "0.03 N*m"),
/// ])
/// ```
///
/// Source: C. Pelchen, C. Schweiger, M. Otter, *Modeling and Simulating the Efficiency of Gearboxes and of Planetary
/// Gearboxes*, 2nd International Modelica Conference (2002).
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Gears", symbol = Gear)]
pub struct LossyGear {
    /// Teeth of the follower over teeth of the base: the reduction $i$.
    #[block(positive, remedy = "the sign of the ratio is given by `direction: Reversed` or `Same`")]
    pub ratio: f64,
    /// `Reversed` or `Same`.
    #[block(default = Direction::Reversed)]
    pub direction: Direction,
    /// Rows of speed, two efficiencies (above 0 and at most 1) and two bearing torques, by increasing speed.
    #[block(not_empty, empty = "a gear without losses is (0.0, 1.0, 1.0, 0.0, 0.0)")]
    pub losses: Vec<[f64; 5]>,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl LossyGear {
    /// Shares and bearing torques at a speed of the base; smooth through zero.
    fn at(&self, speed: f64) -> DryMesh {
        let w = speed.abs();
        let after = self.losses.partition_point(|row| row[0] <= w);
        let (low, high) = (after.saturating_sub(1), after.min(self.losses.len() - 1));
        let (low, high) = (&self.losses[low], &self.losses[high]);
        let width = high[0] - low[0];
        let share = if width > 0.0 { (w - low[0]) / width } else { 0.0 };
        let mix = |column: usize| low[column] + share * (high[column] - low[column]);
        // Over the torque that passes: T_B = (T + tau_BF) / eta_BF and T_B = eta_FB (T + tau_FB).
        let (forward, backward) = (1.0 / mix(1), mix(2));
        let bearing = |column: usize, factor: f64| {
            let slope = if width > 0.0 { (high[column] - low[column]) / width } else { 0.0 };
            Torque { value: factor * mix(column), slope: factor * slope.max(0.0) }
        };
        DryMesh {
            share: [forward - 1.0, 1.0 - backward],
            bearing: [bearing(3, forward), bearing(4, backward)],
        }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        let mut before = f64::NEG_INFINITY;
        for (i, [speed, efficiencies @ .., bearing_forward, bearing_backward]) in
            self.losses.iter().enumerate()
        {
            let mut refuse = |column: usize, message: &str, help: &str| {
                let error =
                    ParamError::new(format!("losses[{i}][{column}]"), format!("row {} {message}", i + 1));
                errors.add(error.help(help));
            };
            if !(*speed >= 0.0 && speed.is_finite() && *speed > before) {
                let message = format!("has the speed {speed}, but speeds begin at 0 or above and increase");
                refuse(0, &message, "sort the rows by their speed");
            }
            before = *speed;
            for (k, efficiency) in efficiencies.iter().enumerate() {
                if !(*efficiency > 0.0 && *efficiency <= 1.0) {
                    let message = format!(
                        "has the efficiency {efficiency}, but an efficiency lies above 0 and is at most 1"
                    );
                    refuse(1 + k, &message, "for a mesh that locks itself use a WormGear");
                }
            }
            for (k, torque) in [bearing_forward, bearing_backward].into_iter().enumerate() {
                if !(*torque >= 0.0 && torque.is_finite()) {
                    let message = format!("has the bearing torque {torque}, which must be zero or more");
                    refuse(3 + k, &message, "write 0 where the bearings take nothing");
                }
            }
        }
    }
}

impl Component for LossyGear {
    fn part(&self, _given: &Given) -> Part {
        let [_, forward, backward, ..] = self.losses.first().copied().unwrap_or([0.0, 1.0, 1.0, 0.0, 0.0]);
        Part::new()
            .port("base", Domain::Rotational, "input side")
            .port("follower", Domain::Rotational, "output side")
            .measures("tau", "N*m", Needs::Motion, "torque into the base")
            .output(Output::boolean("locked").doc("it is stuck"), Needs::Motion)
            .element(Element::Gear {
                base: 0,
                follower: 1,
                ratio: self.direction.ratio(1.0 / self.ratio),
                loss: Some(MeshLoss { forward, backward, model: LossModel::Stiction }),
            })
            .heat_port(self.heat_port)
    }

    fn mesh_losses(&self, _c: &Flowing, speed: &[f64], losses: &mut [DryMesh]) {
        losses[0] = self.at(speed[0]);
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        y[..2].copy_from_slice(&[c.mesh[0], f64::from(c.mode[0] == 0.0)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gear(losses: &[[f64; 5]]) -> LossyGear {
        LossyGear { ratio: 10.0, direction: Direction::Same, losses: losses.to_vec(), heat_port: false }
    }

    #[test]
    fn losses_are_interpolated_over_the_speed_and_stay_beyond_the_ends() {
        let gear = gear(&[[0.0, 0.5, 0.8, 1.0, 2.0], [10.0, 0.7, 0.9, 2.0, 2.0]]);
        for (w, forward, backward, bearing) in
            [(0.0, 0.5, 0.8, 1.0), (5.0, 0.6, 0.85, 1.5), (-5.0, 0.6, 0.85, 1.5), (99.0, 0.7, 0.9, 2.0)]
        {
            let law = gear.at(w);
            assert!((law.share[0] - (1.0 / forward - 1.0)).abs() < 1e-15, "{w}");
            assert!((law.share[1] - (1.0 - backward)).abs() < 1e-15, "{w}");
            assert!((law.bearing[0].value - bearing / forward).abs() < 1e-14, "{w}");
            assert!((law.bearing[1].value - 2.0 * backward).abs() < 1e-15, "{w}");
        }
    }

    #[test]
    fn the_torque_that_passes_is_the_lower_of_both_lines_and_never_jumps() {
        let (eta, back, tau, tau_back) = (0.75, 0.6, 0.02, 0.05);
        let law = gear(&[[0.0, eta, back, tau, tau_back]]).at(3.0);
        let mut before = None;
        for i in -2000..2000 {
            let base = f64::from(i) * 1e-4;
            let passes = f64::min(eta * base - tau, base / back - tau_back);
            for sense in [1.0, -1.0] {
                let (loss, ..) = law.loss(sense * passes, sense);
                assert!((loss - sense * (base - passes)).abs() < 1e-14, "{base}");
            }
            let loss = base - passes;
            assert!(before.is_none_or(|before: f64| (loss - before).abs() < 1e-4), "it jumps at {base}");
            before = Some(loss);
        }
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        let good = [0.0, 0.9, 0.9, 0.1, 0.1];
        assert_eq!(gear(&[good]).errors()[..], []);
        assert_eq!(gear(&[]).errors()[0].param, "losses");
        for (column, bad) in [(0, -1.0), (1, 0.0), (1, 1.1), (2, -0.5), (3, -1.0), (4, f64::NAN)] {
            let mut row = good;
            row[column] = bad;
            assert_eq!(gear(&[row]).errors()[0].param, format!("losses[0][{column}]"));
        }
        assert!(!gear(&[good, good]).errors().is_empty(), "two rows at one speed");
        assert_eq!(LossyGear { ratio: 0.0, ..gear(&[good]) }.errors()[0].param, "ratio");
    }
}
