//! A robot of a diagram on the test bench: its axes, their drives, and experiments with them.

use std::sync::Arc;

use blocksim_block::physical::Element;
use blocksim_block::schedule::{Instance, OutputTimes, Recorded, Schedule};
use blocksim_blocks::motion::{JointMove, Limits};
use blocksim_multibody::Model;
use blocksim_network::{AxisView, Member, Network};
use blocksim_sim::{Control, Counts, Ended, Observer, SimError, Simulation};

use super::course::{Course, Rest, SetValues};
use super::drive::{Connected, Drive};
use super::law;
use super::look_into::look_into;
use super::pose::range;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::running::{interrupt, parallel};

/// Why an experiment makes no sense, and what helps.
fn refused(message: impl Into<String>, help: impl Into<String>) -> Failure {
    Failure::new(Exit::Model, "identify", message).help(help)
}

/// Where users read what a model must have to stand on the bench.
const PAGE: &str = "`blocksim explain identify` lists what a model needs, with an example";

/// A robot on the bench.
pub struct Bench {
    schedule: Schedule,
    /// Index of the block that is the arm.
    network: usize,
    /// The bodies.
    pub tree: Model,
    /// The axes, by their numbers, which is also their order in the tree.
    pub axes: Vec<Axis>,
}

/// An axis on the bench.
pub struct Axis {
    /// From 1, as in the manual of the robot.
    pub number: usize,
    /// What it can do.
    pub limits: Limits,
    /// Path of the joint.
    pub joint: String,
    /// What stands between motor and joint.
    pub drive: Drive,
    /// Index of the joint among the members of the network.
    member: usize,
    /// Block that gives its set values.
    reference: usize,
    /// Its position among the states of the network.
    position: usize,
    /// Position, speed and acceleration of the joint, torque on the joint, torque of the motor: cells of signals.
    cells: [usize; 4],
    /// Cell of the torque of the motor, if it is known.
    motor: Option<usize>,
}

/// What is measured, one number at each time.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// s.
    pub t: Vec<f64>,
    /// Of the joints that were asked for: q, w, a, torque on the joint, torque of the motor (zero where not known).
    pub values: Vec<[f64; 5]>,
}

/// An experiment: what the axes do, and which of them are measured.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// Set values of all axes.
    pub courses: Vec<Arc<dyn Course>>,
    /// Axes that are measured, by index.
    pub measured: Vec<usize>,
    /// End, s.
    pub end: f64,
    /// Time between two rows, s.
    pub every: f64,
}

impl Experiment {
    /// All axes rest in a pose but one.
    pub fn one_axis(pose: &[f64], axis: usize, course: Arc<dyn Course>, end: f64, every: f64) -> Experiment {
        let rest = |q: &f64| Arc::new(Rest(*q)) as Arc<dyn Course>;
        let mut courses: Vec<_> = pose.iter().map(rest).collect();
        courses[axis] = course;
        Experiment { courses, measured: vec![axis], end, every }
    }
}

impl Bench {
    /// Puts the robot of a diagram on the bench.
    ///
    /// # Errors
    /// A diagram without such a robot.
    pub fn new(schedule: Schedule) -> Result<Bench, Failure> {
        let no_arm = || {
            let help = format!("connect `World`, a `RevoluteJoint` for each axis and its `Body`; {PAGE}");
            refused("the model has no arm of bodies and joints", help)
        };
        let networks = schedule.blocks.iter().enumerate();
        let (network, view) = networks
            .filter_map(|(index, instance)| Some((index, look_into::<Network>(&instance.block)?)))
            .find(|(_, view)| view.tree().is_some_and(|tree| tree.dof() > 0))
            .ok_or_else(no_arm)?;
        let tree = view.tree().ok_or_else(no_arm)?.clone();
        if !view.is_plain_tree() {
            return Err(refused(
                "the arm has closed loops, spherical joints, payloads or prescribed speeds",
                format!("only open chains of revolute joints with drives can be identified; {PAGE}"),
            ));
        }
        let mut axes = Vec::new();
        for view_of_axis in view.axes() {
            axes.push(axis(&schedule, view, network, view_of_axis)?);
        }
        if axes.len() != tree.dof() || axes.iter().enumerate().any(|(index, axis)| axis.number != index + 1) {
            let found: Vec<String> =
                axes.iter().map(|axis| format!("{} moves `{}`", axis.number, axis.joint)).collect();
            return Err(refused(
                format!("the axes are not numbered from the base to the tip: {}", found.join(", ")),
                "number them by `axis` of their `JointMove`: 1 at the base, one for each joint",
            ));
        }
        Ok(Bench { schedule, network, tree, axes })
    }

    /// Parts that act on the bodies with forces, beside joints and drives.
    pub fn forces(&self) -> Vec<String> {
        let acts = |member: &&Member| {
            member.part.elements.iter().any(|element| matches!(element, Element::FrameForce { .. }))
        };
        self.members().filter(acts).map(|member| member.path.clone()).collect()
    }

    /// Torque of spring, damper and ends of travel inside a joint, N m, at a position and a speed.
    pub fn inside(&self, axis: usize, q: f64, w: f64) -> f64 {
        self.members().nth(self.axes[axis].member).map_or(0.0, |joint| law::inside_joint(joint, q, w))
    }

    fn members(&self) -> impl Iterator<Item = &Member> {
        look_into::<Network>(&self.schedule.blocks[self.network].block).into_iter().flat_map(Network::members)
    }

    /// Runs an experiment; the joints start at rest where their courses start.
    ///
    /// # Errors
    /// What the simulation says; `interrupted` after Ctrl-C.
    pub fn run(&self, experiment: &Experiment) -> Result<Rows, SimError> {
        let mut schedule = self.schedule.clone();
        for (axis, course) in self.axes.iter().zip(&experiment.courses) {
            schedule.blocks[axis.reference].block = Arc::new(SetValues(course.clone()));
            let states = &mut schedule.blocks[self.network].interface.states;
            if let Some(state) = states.get_mut(axis.position) {
                state.initial = course.at(0.0)[0];
            }
        }
        let cell = |cell: usize| Recorded {
            path: String::new(),
            cell,
            kind: blocksim_signal::Kind::Real,
            dimension: None,
            display: None,
            title: Vec::new(),
            legend: None,
            over: None,
            keep: blocksim_block::schedule::Keep::All,
            held: false,
        };
        let measured: Vec<&Axis> = experiment.measured.iter().map(|index| &self.axes[*index]).collect();
        let cells = measured.iter().flat_map(|axis| {
            let [q, w, a, tau] = axis.cells;
            [q, w, a, tau, axis.motor.unwrap_or(tau)].map(cell)
        });
        schedule.recorded = cells.collect();
        schedule.settings.stop_time = experiment.end;
        schedule.settings.output = OutputTimes::Every(experiment.every);
        let mut simulation = Simulation::new(Arc::new(schedule))?;
        let mut rows = Rows::default();
        match simulation.run(&mut rows)? {
            Ended::Finished | Ended::Stopped => Ok(rows),
            Ended::Interrupted => Err(SimError {
                code: INTERRUPTED,
                t: simulation.time(),
                path: None,
                message: "the experiment was interrupted".to_owned(),
                help: None,
            }),
        }
    }

    /// Runs experiments on all processors; results in the order of the experiments. `told` hears of each that is done.
    pub fn run_all(
        &self,
        experiments: &[Experiment],
        told: impl Fn(usize) + Sync,
    ) -> Vec<Result<Rows, SimError>> {
        parallel::all(experiments, parallel::processors(), |experiment| self.run(experiment), told)
    }
}

/// Code of the error of an experiment that Ctrl-C ended.
pub const INTERRUPTED: &str = "interrupted";

impl Observer for Rows {
    fn row(&mut self, t: f64, values: &[f64]) {
        for group in values.chunks_exact(5) {
            self.t.push(t);
            self.values.push([group[0], group[1], group[2], group[3], group[4]]);
        }
    }

    fn progress(&mut self, _t: f64, _counts: &Counts) -> Control {
        if interrupt::is_requested() { Control::Stop } else { Control::Go }
    }
}

/// Whether a block gets a cell as an input.
fn gets(instance: &Instance, cell: usize) -> bool {
    instance.gather.iter().any(|(from, length)| (*from as usize..(*from + *length) as usize).contains(&cell))
}

/// The cell that an element of the inputs of a block is gathered from.
fn source_of(instance: &Instance, element: usize) -> Option<usize> {
    let mut first = 0;
    instance.gather.iter().find_map(|(from, length)| {
        let within = element.checked_sub(first).filter(|within| *within < *length as usize);
        first += *length as usize;
        within.map(|within| *from as usize + within)
    })
}

fn axis(schedule: &Schedule, network: &Network, at: usize, view: AxisView) -> Result<Axis, Failure> {
    let cell = |port: &str| {
        let path = format!("{}.{port}", view.path);
        schedule.signals.iter().find(|signal| signal.path == path).map(|signal| signal.offset)
    };
    let measured = [cell("q"), cell("w"), cell("a"), cell("tau")];
    let [Some(q), Some(w), Some(a), Some(tau)] = measured else {
        return Err(refused(
            format!("`{}` is not a revolute joint", view.path),
            format!("all axes of the arm turn; {PAGE}"),
        ));
    };
    // The controller is what compares a set value with the position.
    let moves = schedule.blocks.iter().enumerate();
    let moves = moves.filter_map(|(index, block)| Some((index, look_into::<JointMove>(&block.block)?)));
    let found: Vec<(usize, &JointMove)> = moves
        .filter(|(index, _)| {
            let wanted = schedule.blocks[*index].y;
            schedule.blocks.iter().enumerate().any(|(other, block)| {
                let is_shown_only = block.interface.outputs.is_empty();
                other != at && other != *index && !is_shown_only && gets(block, wanted) && gets(block, q)
            })
        })
        .collect();
    let [(reference, course)] = found[..] else {
        let joint = &view.path;
        return Err(match found.len() {
            0 => refused(
                format!("no controller compares `{joint}.q` with the `q` of a `JointMove`"),
                format!(
                    "add a `JointMove` for this axis and a block that gets its `q` and `{joint}.q`, as a `Sum` in \
                     front of a `Pid` does; {PAGE}"
                ),
            ),
            several => refused(
                format!("{several} blocks `JointMove` command the joint `{joint}`"),
                "connect the `q` of one of them to the controller of the joint",
            ),
        });
    };
    let (Some(limits), number) = (course.limits.get(course.axis - 1), course.axis) else {
        return Err(refused(
            format!("the `JointMove` of `{}` has no limits for axis {}", view.path, course.axis),
            "give `limits` an entry for each axis",
        ));
    };
    let offset =
        |path: &str| schedule.signals.iter().find(|signal| signal.path == path).map(|signal| signal.offset);
    let source = |input: usize| source_of(&schedule.blocks[at], input);
    // The cells behind the last signal hold the values of inputs that are not connected.
    let cells = schedule.signals.iter().map(|signal| signal.offset + signal.shape.len()).max();
    let is_connected = |member: usize, port: usize| {
        network.input(member, port).and_then(source).is_some_and(|cell| Some(cell) < cells)
    };
    let connected = Connected { input: &is_connected, signal: &|path| offset(path).is_some() };
    let (lower, upper) = range(limits);
    let drive = Drive::of(network, &view, 0.5 * (lower + upper), &connected);
    let measured = drive.torque_signal.as_deref().and_then(offset);
    let motor = measured.or_else(|| source(drive.torque_input?));
    Ok(Axis {
        number,
        limits: *limits,
        joint: view.path,
        drive,
        member: view.member,
        reference,
        position: view.position,
        cells: [q, w, a, tau],
        motor,
    })
}

impl Axis {
    /// Whether the torque of the motor is measured.
    pub fn has_motor(&self) -> bool {
        self.motor.is_some()
    }
}
