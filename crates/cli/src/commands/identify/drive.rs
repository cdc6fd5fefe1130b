//! What stands between the motor and the joint of an axis, from the parameters that are set.

use blocksim_block::physical::LossModel;
use blocksim_blocks::machines::DcMotor;
use blocksim_blocks::mechanics::FrictionModel;
use blocksim_blocks::multibody::OneAxisJoint;
use blocksim_blocks::rotational::{IdealTorqueSource, RotationalDamper, RotationalFriction};
use blocksim_identify::{Curve, Train};
use blocksim_network::{AxisView, Network};

use super::look_into::look_into;

/// Ratios that differ by less than this part are one.
const SAME: f64 = 1e-9;

/// The drive of an axis.
#[derive(Debug, Clone)]
pub struct Drive {
    /// Turns of the motor for one of the joint.
    pub ratio: f64,
    /// Moment of inertia of motor and gear, brought to the joint, kg m².
    pub reflected: f64,
    /// Gear and dampers.
    pub train: Train,
    /// Friction of the bearing, if it is one smooth curve.
    pub bearing: Option<Curve>,
    /// Signals that are the torque of the motor if its kind has this output.
    pub torque_signals: Vec<String>,
    /// The input of the network that is the torque of an ideal source in its place.
    pub torque_input: Option<usize>,
}

impl Drive {
    /// Of an axis of a network.
    pub fn of(network: &Network, view: &AxisView) -> Drive {
        let members: Vec<_> = network.members().collect();
        let ratios = view.parts.iter().map(|part| part.ratio);
        let ratio =
            ratios.fold(1.0, |largest: f64, ratio| if ratio.abs() > largest.abs() { ratio } else { largest });
        let mut drive = Drive {
            ratio,
            reflected: view.reflected,
            train: Train::NONE,
            bearing: None,
            torque_signals: Vec::new(),
            torque_input: None,
        };
        let joint = members.iter().find(|member| member.path == view.path);
        if let Some(joint) = joint.and_then(|joint| look_into::<OneAxisJoint>(&joint.block)) {
            drive.train.beside += joint.damping();
        }
        let mut beside = Vec::new();
        for part in &view.parts {
            let member = members[part.member];
            let square = part.ratio * part.ratio;
            let mut damp = |d: f64| {
                let behind = (part.ratio - ratio).abs() > SAME * ratio.abs();
                let side = if behind { &mut drive.train.beside } else { &mut drive.train.damping };
                *side += d * square;
            };
            if let Some(loss) = &part.mesh {
                drive.train.efficiency *= loss.forward;
                if let LossModel::Dissipative { threshold } = loss.model {
                    drive.train.threshold = drive.train.threshold.max(threshold / part.ratio.abs());
                }
            } else if let Some(damper) = look_into::<RotationalDamper>(&member.block) {
                damp(damper.d);
            } else if let Some(friction) = look_into::<RotationalFriction>(&member.block) {
                if friction.model == FrictionModel::Smooth && (square - 1.0).abs() < SAME {
                    drive.bearing = Some(Curve {
                        viscous: friction.viscous,
                        coulomb: friction.coulomb,
                        breakaway: friction.breakaway,
                        breakaway_velocity: friction.breakaway_velocity,
                    });
                }
            } else {
                if let Some(motor) = look_into::<DcMotor>(&member.block) {
                    damp(motor.damping);
                }
                if look_into::<IdealTorqueSource>(&member.block).is_some() {
                    drive.torque_input = network.input(part.member, 0);
                }
                drive.torque_signals.push(format!("{}.torque", member.path));
                // A machine without this output may have a block beside it that measures or computes the torque.
                if let Some((folder, _)) = member.path.rsplit_once('/') {
                    beside.push(format!("{folder}/torque.y"));
                }
            }
        }
        drive.torque_signals.append(&mut beside);
        drive
    }
}
