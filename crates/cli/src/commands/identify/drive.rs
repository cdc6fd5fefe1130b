//! What stands between the motor and the joint of an axis, from the parameters that are set.

use blocksim_block::physical::{Domain, LossModel};
use blocksim_blocks::mechanics::FrictionModel;
use blocksim_blocks::rotational::{IdealTorqueSource, LuGreFriction, RotationalFriction};
use blocksim_identify::{Curve, FrictionLaw, KnownFriction, Stage, Torques, Train};
use blocksim_network::{AxisView, Member, Network, PartView};

use super::law;
use super::look_into::look_into;

/// Ratios that differ by less than this part are one.
const SAME: f64 = 1e-9;

/// Shares of power that differ by less are one.
const WHOLE: f64 = 1e-6;

/// The drive of an axis.
#[derive(Debug, Clone)]
pub struct Drive {
    /// Turns of the motor for one of the joint.
    pub ratio: f64,
    /// Moment of inertia of motor and gear, brought to the joint, kg m².
    pub reflected: f64,
    /// Gears, and friction that the parameters give.
    pub train: Train,
    /// What the parts of `train.known` are.
    pub taken: Vec<Taken>,
    /// How the friction of the bearing goes over the speed.
    pub law: FrictionLaw,
    /// Friction of the bearing, if there is one.
    pub bearing: Option<Curve>,
    /// What acts on the axis beside the bearing and does not follow from the parameters.
    pub unknown: Vec<Obstacle>,
    /// What takes a part of the torque of the motor that is no friction, so that none can be measured.
    pub wandering: Option<Obstacle>,
    /// What the result holds beside what it seems to hold.
    pub notes: Vec<String>,
    /// The output that is the torque of the motor.
    pub torque_signal: Option<String>,
    /// The input of the network that is the torque of an ideal source in its place.
    pub torque_input: Option<usize>,
}

/// A part whose friction the parameters give.
#[derive(Debug, Clone)]
pub struct Taken {
    /// Path of the block.
    pub path: String,
    /// It turns with the motor.
    pub is_at_motor: bool,
}

/// What stands in the way of a measurement, and what helps.
#[derive(Debug, Clone)]
pub struct Obstacle {
    /// Which part, and why.
    pub reason: String,
    /// What helps.
    pub remedy: String,
}

/// What a diagram connects to the network of an axis.
pub struct Connected<'a> {
    /// Whether something is connected to an input of a member.
    pub input: &'a dyn Fn(usize, usize) -> bool,
    /// Whether there is a signal of this path.
    pub signal: &'a dyn Fn(&str) -> bool,
}

impl Drive {
    /// Of an axis of a network, which is measured about a position (rad).
    pub fn of(network: &Network, view: &AxisView, centre: f64, connected: &Connected) -> Drive {
        let members: Vec<&Member> = network.members().collect();
        let sources: Vec<&PartView> =
            view.parts.iter().filter(|part| is_source(members[part.member])).collect();
        let has_signal = |part: &&&PartView| (connected.signal)(&output_of(members[part.member]));
        let motor = sources.iter().find(has_signal).or(sources.first()).copied();
        let beside = sources.iter().find_map(|part| {
            // A machine without this output may have a block beside it that measures or computes the torque.
            let (folder, _) = members[part.member].path.rsplit_once('/')?;
            Some(format!("{folder}/torque.y")).filter(|path| (connected.signal)(path))
        });
        let direct =
            motor.map(|part| output_of(members[part.member])).filter(|path| (connected.signal)(path));
        let mut builder = Builder {
            view,
            members: &members,
            connected,
            motor: motor.map_or_else(|| vec![0.0; view.meshes.len()], |motor| motor.through.clone()),
            drive: Drive {
                ratio: motor.map_or(1.0, |motor| motor.ratio),
                reflected: view.reflected,
                train: Train::default(),
                taken: Vec::new(),
                law: FrictionLaw::Smooth,
                bearing: None,
                unknown: Vec::new(),
                wandering: None,
                notes: Vec::new(),
                torque_signal: direct.or(beside),
                torque_input: motor
                    .filter(|motor| look_into::<IdealTorqueSource>(&members[motor.member].block).is_some())
                    .and_then(|motor| network.input(motor.member, 0)),
            },
        };
        builder.stages();
        builder.joint(centre);
        let bearing = builder.bearing();
        for part in &view.parts {
            match motor {
                _ if bearing.is_some_and(|bearing| std::ptr::eq(part, bearing)) => {}
                Some(motor) if std::ptr::eq(part, motor) => builder.motor(part),
                _ => builder.part(part),
            }
        }
        for member in &view.shared {
            builder.drive.unknown.push(Obstacle {
                reason: format!("`{}` moves with other axes as well", members[*member].path),
                remedy: "only parts that belong to one axis can be separated".to_owned(),
            });
        }
        builder.drive
    }
}

/// Puts a drive together.
struct Builder<'a> {
    view: &'a AxisView,
    members: &'a [&'a Member],
    connected: &'a Connected<'a>,
    /// Where the motor is, see [`PartView::through`].
    motor: Vec<f64>,
    drive: Drive,
}

impl<'a> Builder<'a> {
    /// The gears between motor and joint.
    fn stages(&mut self) {
        let joint = vec![0.0; self.motor.len()];
        match self.between(&joint) {
            Ok(stages) => self.drive.train.stages = stages,
            Err(obstacle) => self.drive.unknown.push(obstacle),
        }
        for mesh in &self.view.meshes {
            if let LossModel::Published { threshold } = mesh.loss.model {
                self.drive.notes.push(format!(
                    "the loss of `{}` sets in with the power (`loss: Published`) and is taken as complete: slow moves \
                     with less than some {threshold} W lose less",
                    self.members[mesh.member].path
                ));
            }
        }
    }

    /// The lossy gears between the motor and a place.
    fn between(&self, place: &[f64]) -> Result<Vec<Stage>, Obstacle> {
        let mut stages = Vec::new();
        for (index, mesh) in self.view.meshes.iter().enumerate() {
            let path = &self.members[mesh.member].path;
            let unclear = || Obstacle {
                reason: format!("power goes through `{path}` on more than one way"),
                remedy: "only drives in which one gear follows another can be separated".to_owned(),
            };
            let side = |through: f64| {
                let whole = through.round();
                ((through - whole).abs() < WHOLE && whole.abs() <= 1.0).then_some(whole)
            };
            let (Some(motor), Some(place)) = (side(self.motor[index]), side(place[index])) else {
                return Err(unclear());
            };
            if motor == place {
                continue;
            }
            if motor * place != 0.0 {
                return Err(unclear());
            }
            let is_backward = motor < 0.0 || place > 0.0;
            let efficiency = |loss: f64| {
                let unlike = || Obstacle {
                    reason: format!("the losses of `{path}` are not the same at all speeds and torques"),
                    remedy: "give the gear an efficiency for the measurement".to_owned(),
                };
                if loss > 0.0 { Ok(loss) } else { Err(unlike()) }
            };
            let (efficiency, threshold) = match mesh.loss.model {
                LossModel::Stiction => {
                    let loss = law::mesh_loss(self.members[mesh.member], mesh.dry);
                    let loss = loss.filter(|loss| loss.bearing.iter().all(|bearing| bearing.value == 0.0));
                    let kept = loss.map_or(0.0, |loss| match is_backward {
                        false => 1.0 / (1.0 + loss.share[0]),
                        true => 1.0 - loss.share[1],
                    });
                    (efficiency(kept)?, 0.0)
                }
                LossModel::Dissipative { threshold } => {
                    (if is_backward { mesh.loss.backward } else { mesh.loss.forward }, threshold)
                }
                LossModel::Published { .. } => {
                    (if is_backward { mesh.loss.backward } else { mesh.loss.forward }, 0.0)
                }
            };
            stages.push(Stage { efficiency, threshold: threshold / mesh.ratio.abs(), is_backward });
        }
        Ok(stages)
    }

    /// Damping in the joint, and its input.
    fn joint(&mut self, centre: f64) {
        let joint = self.members[self.view.member].clone();
        let path = joint.path.clone();
        if (self.connected.input)(self.view.member, 0) {
            let name = joint.part.inputs.first().map_or("torque", |input| input.name.as_str());
            self.drive.unknown.push(Obstacle {
                reason: format!("blocks act on `{path}` by its input `{name}`"),
                remedy: "leave this input unconnected for the measurement".to_owned(),
            });
        }
        let damping =
            move |w: f64| law::inside_joint(&joint, centre, 0.0) - law::inside_joint(&joint, centre, w);
        let stages = self.drive.train.stages.clone();
        self.take(path, Torques::new(damping), stages, false);
    }

    /// What the motor loses itself.
    fn motor(&mut self, part: &PartView) {
        let (member, ratio) = (self.members[part.member].clone(), part.ratio);
        if look_into::<IdealTorqueSource>(&member.block).is_some() {
            return;
        }
        let path = member.path.clone();
        match law::idle_torque(&member, 1.0) {
            Some(_) => {
                let law = move |w: f64| ratio * law::idle_torque(&member, ratio * w).unwrap_or(f64::NAN);
                self.take(path, Torques::new(law), Vec::new(), true);
            }
            None => self.drive.unknown.push(Obstacle {
                reason: format!("the friction of `{path}` does not follow from its parameters"),
                remedy: "drive the joint by another machine or an `IdealTorqueSource`".to_owned(),
            }),
        }
    }

    fn part(&mut self, part: &PartView) {
        let member = self.members[part.member];
        let path = &member.path;
        if is_source(member) {
            let all = self.view.parts.iter().map(|part| self.members[part.member]);
            let names: Vec<String> =
                all.filter(|member| is_source(member)).map(|member| format!("`{}`", member.path)).collect();
            self.drive.wandering = Some(Obstacle {
                reason: format!("{} drive the axis together", names.join(" and ")),
                remedy: "drive the axis by one motor for the measurement".to_owned(),
            });
            return;
        }
        if !member.part.states.is_empty() {
            self.with_states(member);
            return;
        }
        if (0..member.part.inputs.len()).any(|input| (self.connected.input)(part.member, input)) {
            self.commanded(member);
            return;
        }
        let known = [1.0, -1.0].into_iter().all(|w| law::torque(member, w).is_some());
        match self.between(&part.through) {
            Err(obstacle) => self.drive.unknown.push(obstacle),
            Ok(_) if !known => self.drive.unknown.push(Obstacle {
                reason: format!("the torque of `{path}` does not follow from its speed alone"),
                remedy: "leave this part out for the measurement".to_owned(),
            }),
            Ok(stages) => {
                let (member, ratio) = (member.clone(), part.ratio);
                let is_at_motor = self.is_at_motor(part);
                let law = move |w: f64| ratio * law::torque(&member, ratio * w).unwrap_or(f64::NAN);
                self.take(path.clone(), Torques::new(law), stages, is_at_motor);
            }
        }
    }

    /// Whether a part turns with the motor.
    fn is_at_motor(&self, part: &PartView) -> bool {
        let mut through = part.through.iter().zip(&self.motor);
        self.turns_as(part.ratio, self.drive.ratio)
            && through.all(|(part, motor)| (part - motor).abs() < WHOLE)
    }

    fn turns_as(&self, ratio: f64, other: f64) -> bool {
        (ratio - other).abs() <= SAME * other.abs()
    }

    /// The friction at the joint is what is identified; of several that with the largest breakaway torque.
    fn bearing(&mut self) -> Option<&'a PartView> {
        let at_joint = |part: &&PartView| {
            part.through.iter().all(|through| through.abs() < WHOLE) && self.turns_as(part.ratio.abs(), 1.0)
        };
        let friction = |part: &PartView| look_into::<RotationalFriction>(&self.members[part.member].block);
        let (part, friction) = (self.view.parts.iter().filter(at_joint))
            .filter_map(|part| Some((part, friction(part)?)))
            .reduce(|largest, next| if next.1.breakaway > largest.1.breakaway { next } else { largest })?;
        self.drive.law = match friction.model {
            FrictionModel::Smooth => FrictionLaw::Smooth,
            FrictionModel::Stiction => FrictionLaw::Sliding,
        };
        self.drive.bearing = Some(Curve {
            viscous: friction.viscous,
            coulomb: friction.coulomb,
            breakaway: friction.breakaway,
            breakaway_velocity: friction.breakaway_velocity,
            law: self.drive.law,
        });
        Some(part)
    }

    /// A part with a memory.
    fn with_states(&mut self, member: &Member) {
        let path = &member.path;
        if look_into::<LuGreFriction>(&member.block).is_some() {
            self.drive.unknown.push(Obstacle {
                reason: format!("the bristles of `{path}` still bend in slow moves"),
                remedy: "put a `RotationalFriction` in its place for the measurement".to_owned(),
            });
            return;
        }
        self.drive.wandering = Some(Obstacle {
            reason: format!(
                "`{path}` counts its deflection from the start of a run, and each move starts elsewhere"
            ),
            remedy: "leave it out for the measurement, or use stiffness and limits of the joint".to_owned(),
        });
    }

    /// A part whose torque depends on its inputs.
    fn commanded(&mut self, member: &Member) {
        let path = &member.path;
        // Brakes and clutches are open while an axis moves.
        if member.part.outputs.iter().any(|(output, _)| output.name == "locked") {
            self.drive.notes.push(format!(
                "what `{path}` transmits follows its input; it counts as friction of the bearing"
            ));
            return;
        }
        self.drive.unknown.push(Obstacle {
            reason: format!("the torque of `{path}` follows an input"),
            remedy: "leave its inputs unconnected for the measurement".to_owned(),
        });
    }

    /// Adds a known friction to the train, except where it is zero.
    fn take(&mut self, path: String, torque: Torques, stages: Vec<Stage>, is_at_motor: bool) {
        if [1.0, -1.0].into_iter().any(|w| torque.at(w) != 0.0) {
            self.drive.train.known.push(KnownFriction { torque, stages });
            self.drive.taken.push(Taken { path, is_at_motor });
        }
    }
}

/// Whether a member can be the motor.
fn is_source(member: &Member) -> bool {
    let is_foreign =
        |domain: Domain| !matches!(domain, Domain::Rotational | Domain::Translational | Domain::Thermal);
    look_into::<IdealTorqueSource>(&member.block).is_some()
        || member.part.ports.iter().any(|port| is_foreign(port.domain))
        || member.part.outputs.iter().any(|(output, _)| output.name == "torque")
}

/// The output of a machine that is the torque of its motor.
fn output_of(member: &Member) -> String {
    format!("{}.torque", member.path)
}
