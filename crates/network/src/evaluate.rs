//! A network as a block: what happens in one evaluation.

use std::ops::Range;

use blocksim_block::physical::{Element, JointMotion, Law, MeshLoss, Needs, Supply, Torque};
use blocksim_block::{Block, Context, Given, Input, Interface, InterfaceError, Output, Scratch};
use blocksim_multibody::{Data, mass_and_bias};
use blocksim_solve::linear::{cholesky_factor, cholesky_solve};

use crate::assembly::Member;
use crate::electrics::{CurrentOf, Electrics};
use crate::frames::Frames;
use crate::mesh::{self, MeshScratch};
use crate::problem::NetworkProblem;
use crate::rotation::Rotation;

/// A physical network as one block.
///
/// States: joint angles, independent speeds, then the states of the members. Output group 0 (of the three that
/// [`Needs`] names) depends on states alone, group 1 on the inputs of electrical sources, group 2 on everything.
#[derive(Debug)]
pub struct Network {
    seats: Vec<Seat>,
    rotation: Rotation,
    electrics: Electrics,
    frames: Frames,
    meshes: Vec<MeshLoss>,
    /// Member of each supply.
    supplies: Vec<usize>,
    interface: Interface,
    joints: usize,
    /// Some currents are measured before voltages are known.
    has_early: bool,
    active: Active,
}

/// Indices of the members that have something to say in a phase.
#[derive(Debug, Default)]
struct Active {
    speed_sources: Vec<usize>,
    machines: Vec<usize>,
    sources: Vec<usize>,
    windings: Vec<usize>,
    branches: Vec<usize>,
    states: Vec<usize>,
    measures: [Vec<usize>; 3],
}

impl Active {
    fn new(seats: &[Seat]) -> Self {
        let which = |has: &dyn Fn(&Seat) -> bool| {
            seats.iter().enumerate().filter(|(_, seat)| has(seat)).map(|(i, _)| i).collect::<Vec<_>>()
        };
        Self {
            speed_sources: which(&|seat| !seat.speed_sources.is_empty()),
            machines: which(&|seat| seat.is_machine),
            sources: which(&|seat| !seat.sources.is_empty()),
            windings: which(&|seat| !seat.windings.is_empty()),
            branches: which(&|seat| !seat.branches.is_empty()),
            states: which(&|seat| !seat.x.is_empty()),
            measures: [STATE, ELECTRICS, MOTION].map(|group| which(&|seat| seat.measures[group].is_some())),
        }
    }
}

/// A member and where its values lie.
#[derive(Debug)]
struct Seat {
    member: Member,
    x: Range<usize>,
    u: Range<usize>,
    inputs: Vec<(u32, u32)>,
    y: Range<usize>,
    pins: Range<usize>,
    two_pins: Range<usize>,
    gears: Range<usize>,
    branches: Range<usize>,
    sources: Range<usize>,
    windings: Range<usize>,
    speed_sources: Range<usize>,
    joint: Option<usize>,
    supply: Option<usize>,
    is_machine: bool,
    /// Which outputs it has, by group, under the need that the component knows them by.
    measures: [Option<Needs>; 3],
}

/// Values of one evaluation.
struct Work {
    data: Option<Data>,
    evaluation: [u64; 3],
    s: Vec<f64>,
    ds: Vec<f64>,
    joint_speed: Vec<f64>,
    joint_motion: Vec<JointMotion>,
    pin_speed: Vec<f64>,
    pin_acceleration: Vec<f64>,
    pin_torque: Vec<f64>,
    supply: Vec<Supply>,
    line_current: Vec<[f64; 2]>,
    source: Vec<f64>,
    voltage: Vec<f64>,
    winding: Vec<f64>,
    current: Vec<f64>,
    torque: Vec<Torque>,
    joint_torque: Vec<Torque>,
    /// Mass matrix over the independent speeds, and its Cholesky factor.
    mass: Vec<f64>,
    factor: Vec<f64>,
    joint_mass: Vec<f64>,
    bias: Vec<f64>,
    force: Vec<f64>,
    dv: Vec<f64>,
    residual: Vec<f64>,
    mesh: MeshScratch,
    mesh_speed: Vec<f64>,
    coupling: Vec<f64>,
    through: Vec<f64>,
    columns: Vec<f64>,
    all_mesh: Vec<f64>,
    /// For the implicit solve.
    damping: Vec<f64>,
    implicit: Vec<f64>,
    product: Vec<f64>,
    hg: f64,
}

const NO_SUPPLY: Supply = Supply { amplitude: 0.0, offset: 0.0, frequency: 0.0, angle: 0.0 };
const NO_JOINT: JointMotion = JointMotion { q: 0.0, w: 0.0, a: 0.0, drive: 0.0 };

const STATE: usize = 0;
const ELECTRICS: usize = 1;
const MOTION: usize = 2;

impl Network {
    pub(crate) fn new(
        members: Vec<Member>,
        rotation: Rotation,
        electrics: Electrics,
        frames: Frames,
        supplies: Vec<usize>,
        supply_of: Vec<Option<usize>>,
    ) -> Result<Self, Vec<NetworkProblem>> {
        let joints = frames.joint_members.len();
        let mut interface = Interface::new().implicit();
        let names: Vec<String> =
            frames.joint_members.iter().map(|m| format!("{}.q", members[*m].path)).collect();
        for (name, position) in names.iter().zip(&frames.position) {
            interface = interface.state(name.clone(), *position);
        }
        for (name, start) in rotation.names.iter().zip(&rotation.start) {
            interface = interface.state(name.clone(), *start);
        }

        // Inputs of prescribed speeds and of electrical sources: what groups 0 and 1 read.
        let mut reads = [Vec::new(), Vec::new()];
        let mut seats = Vec::new();
        let mut has_early = false;
        let (mut x, mut u, mut y) = (joints + rotation.free, 0, 0);
        let mut at = [0usize; 7];
        for (index, (member, supply)) in members.into_iter().zip(supply_of).enumerate() {
            let mut counts = [0usize; 7];
            let (mut is_machine, mut drives_electrics) = (false, false);
            for element in &member.part.elements {
                let kinds: &[usize] = match element {
                    Element::Branch { .. } => &[0, 3],
                    Element::SpeedSource { .. } => &[0, 6],
                    Element::Rigid { .. } | Element::SpeedProbe { .. } => &[0],
                    Element::VoltageSource { .. } => &[1, 4],
                    Element::Winding { .. } => &[1, 5],
                    Element::VoltageProbe { .. } | Element::CurrentProbe { .. } => &[1],
                    Element::Gear { .. } => &[2],
                    _ => &[],
                };
                kinds.iter().for_each(|kind| counts[*kind] += 1);
                is_machine |= matches!(element, Element::Machine { .. });
                drives_electrics |= matches!(element, Element::VoltageSource { .. } | Element::Supply { .. });
            }
            let mut range = |kind: usize| {
                let start = at[kind];
                at[kind] += counts[kind];
                start..at[kind]
            };
            let (pins, two_pins, gears) = (range(0), range(1), range(2));
            let (branches, sources, windings, speed_sources) = (range(3), range(4), range(5), range(6));

            let first_input = interface.inputs.len();
            let mut inputs = Vec::new();
            let mut cells = 0;
            for (input, length) in member.part.inputs.iter().zip(&member.input_lengths) {
                inputs.push((cells as u32, (cells + length) as u32));
                cells += length;
                let index = interface.inputs.len();
                interface
                    .inputs
                    .push(Input { name: format!("{}.{}", member.path, input.name), ..input.clone() });
                if !speed_sources.is_empty() {
                    reads[STATE].push(index);
                }
                if drives_electrics || !speed_sources.is_empty() {
                    reads[ELECTRICS].push(index);
                }
            }
            debug_assert_eq!(interface.inputs.len() - first_input, inputs.len());
            for state in &member.part.states {
                interface = interface.state(format!("{}.{}", member.path, state.name), state.initial);
            }
            let outputs: usize = member.part.outputs.iter().map(|(o, _)| o.port_type.shape.len()).sum();
            // An ammeter reads a state when every current that it sums up is one: no algebraic loop through it.
            let early = !two_pins.is_empty()
                && sources.is_empty()
                && windings.is_empty()
                && two_pins
                    .clone()
                    .all(|i| matches!(electrics.currents[i], CurrentOf::Balance(_)) && electrics.is_state(i));
            let measures = [Needs::State, Needs::Electrics, Needs::Motion].map(|needs| {
                let needs_of = |declared: Needs| {
                    if early && declared == Needs::Electrics { Needs::State } else { declared }
                };
                member
                    .part
                    .outputs
                    .iter()
                    .map(|(_, declared)| *declared)
                    .find(|declared| needs_of(*declared) == needs)
            });
            for (output, declared) in &member.part.outputs {
                let name = format!("{}.{}", member.path, output.name);
                let group = if early && *declared == Needs::Electrics { STATE } else { *declared as usize };
                interface.outputs.push(Output { name, ..output.clone() });
                interface.group_of.push(group);
            }
            has_early |= early;
            let states = member.part.states.len();
            seats.push(Seat {
                x: x..x + states,
                u: u..u + cells,
                inputs,
                y: y..y + outputs,
                pins,
                two_pins,
                gears,
                branches,
                sources,
                windings,
                speed_sources,
                joint: frames.joint_members.iter().position(|m| *m == index),
                supply,
                is_machine,
                measures,
                member,
            });
            x += states;
            u += cells;
            y += outputs;
        }
        interface.groups = vec![Some(reads[STATE].clone()), Some(reads[ELECTRICS].clone()), None];
        let meshes = rotation.gears.iter().map(|gear| gear.loss).collect();
        let active = Active::new(&seats);
        let network = Self {
            active,
            seats,
            rotation,
            electrics,
            frames,
            meshes,
            supplies,
            interface,
            joints,
            has_early,
        };
        network.mass_matrix_is_definite()?;
        Ok(network)
    }

    /// The members, in the order of their inputs and outputs.
    pub fn members(&self) -> impl Iterator<Item = &Member> {
        self.seats.iter().map(|seat| &seat.member)
    }

    /// At the start pose every independent speed must move something.
    fn mass_matrix_is_definite(&self) -> Result<(), Vec<NetworkProblem>> {
        let mut work = self.work();
        let n = self.rotation.free;
        self.mass(&self.frames.position, &mut work);
        work.factor.copy_from_slice(&work.mass);
        if cholesky_factor(&mut work.factor, n).is_ok() {
            return Ok(());
        }
        let weak = (0..n).min_by(|i, j| work.mass[i * n + i].total_cmp(&work.mass[j * n + j])).unwrap_or(0);
        let problem = NetworkProblem::new(
            "no_inertia",
            format!(
                "the mass matrix is not positive definite: `{}` moves {} kg*m^2",
                self.rotation.names[weak],
                work.mass[weak * n + weak]
            ),
            "give the bodies behind it mass, or couple an Inertia to its drive side",
        );
        let member = self.frames.joint_members.get(weak);
        Err(vec![
            member.into_iter().fold(problem, |problem, member| problem.with(*member, "moves too little")),
        ])
    }

    fn work(&self) -> Work {
        let r = &self.rotation;
        let (n, j, g) = (r.free, self.joints, self.meshes.len());
        Work {
            data: self.frames.data(),
            evaluation: [u64::MAX; 3],
            s: vec![0.0; r.sources],
            ds: vec![0.0; r.sources],
            joint_speed: vec![0.0; j],
            joint_motion: vec![JointMotion::default(); j],
            pin_speed: vec![0.0; r.pins.len()],
            pin_acceleration: vec![0.0; r.pins.len()],
            pin_torque: vec![0.0; r.pins.len()],
            supply: vec![Supply::default(); self.supplies.len()],
            line_current: vec![[0.0; 2]; self.supplies.len()],
            source: vec![0.0; self.electrics.sources],
            voltage: vec![0.0; self.electrics.voltages.len()],
            winding: vec![0.0; self.electrics.windings],
            current: vec![0.0; self.electrics.voltages.len()],
            torque: vec![Torque::default(); r.branches.len()],
            joint_torque: vec![Torque::default(); j],
            mass: vec![0.0; n * n],
            factor: vec![0.0; n * n],
            joint_mass: vec![0.0; j * j],
            bias: vec![0.0; j],
            force: vec![0.0; n],
            dv: vec![0.0; n],
            residual: vec![0.0; r.nodes.len() + j],
            mesh: MeshScratch::new(g),
            mesh_speed: vec![0.0; g],
            coupling: vec![0.0; g * g],
            through: vec![0.0; g],
            columns: vec![0.0; g * n],
            all_mesh: vec![0.0; r.all_gears.len()],
            damping: vec![0.0; n * n],
            implicit: vec![0.0; n * n],
            product: vec![0.0; n],
            hg: 0.0,
        }
    }

    /// What a member sees before accelerations are known.
    #[inline]
    fn law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Law<'a> {
        let electrical = !seat.two_pins.is_empty();
        Law {
            t: c.t,
            x: &c.x[seat.x.clone()],
            u: &c.u[seat.u.clone()],
            inputs: &seat.inputs,
            speed: &w.pin_speed[seat.pins.clone()],
            acceleration: &[],
            torque: &[],
            mesh: &[],
            voltage: if electrical { &w.voltage[seat.two_pins.clone()] } else { &[] },
            current: if electrical { &w.current[seat.two_pins.clone()] } else { &[] },
            supply: seat.supply.map_or(NO_SUPPLY, |i| w.supply[i]),
            line_current: seat.supply.map_or([0.0; 2], |i| w.line_current[i]),
            joint: seat.joint.map_or(NO_JOINT, |i| w.joint_motion[i]),
        }
    }

    /// What a member sees in the end.
    fn whole_law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Law<'a> {
        Law {
            acceleration: &w.pin_acceleration[seat.pins.clone()],
            torque: &w.pin_torque[seat.pins.clone()],
            mesh: &w.all_mesh[seat.gears.clone()],
            ..self.law(c, seat, w)
        }
    }

    /// Speeds of everything.
    fn state_phase(&self, c: &Context, w: &mut Work) {
        if w.evaluation[STATE] == c.evaluation {
            return;
        }
        w.evaluation[STATE] = c.evaluation;
        let (q, v) = (&c.x[..self.joints], &c.x[self.joints..self.joints + self.rotation.free]);
        if !w.s.is_empty() {
            let (mut s, mut ds) = (std::mem::take(&mut w.s), std::mem::take(&mut w.ds));
            for seat in self.active.speed_sources.iter().map(|i| &self.seats[*i]) {
                if let Some(component) = seat.member.block.component() {
                    let range = seat.speed_sources.clone();
                    component.speeds(&self.law(c, seat, w), &mut s[range.clone()], &mut ds[range]);
                }
            }
            (w.s, w.ds) = (s, ds);
        }
        let r = &self.rotation;
        for (i, q) in q.iter().enumerate() {
            w.joint_speed[i] = r.joints[i].of(v) + r.joints_prescribed[i].of(&w.s);
            w.joint_motion[i] = JointMotion { q: *q, w: w.joint_speed[i], a: 0.0, drive: 0.0 };
        }
        for (to, pin) in w.pin_speed.iter_mut().zip(&r.pins) {
            *to = pin.speed.of(v) + pin.prescribed.of(&w.s);
        }
        if self.has_early {
            self.currents(c, w, true);
        }
    }

    /// Currents of windings, and what follows from them; of those that are states, or of all.
    fn currents(&self, c: &Context, w: &mut Work, early: bool) {
        let mut winding = std::mem::take(&mut w.winding);
        for seat in self.active.windings.iter().map(|i| &self.seats[*i]) {
            // What follows from states was computed with them.
            let from_state = seat.windings.clone().all(|i| self.electrics.from_state[i]);
            if self.has_early && early != from_state {
                continue;
            }
            if let Some(component) = seat.member.block.component() {
                component.currents(&self.law(c, seat, w), &mut winding[seat.windings.clone()]);
            }
        }
        for (to, from) in w.current.iter_mut().zip(&self.electrics.currents) {
            *to = match from {
                CurrentOf::Winding(i) => winding[*i],
                CurrentOf::Balance(form) => form.of(&winding),
                CurrentOf::Open => 0.0,
            };
        }
        w.winding = winding;
    }

    /// Voltages and currents.
    fn electrics_phase(&self, c: &Context, w: &mut Work) {
        if w.evaluation[ELECTRICS] == c.evaluation {
            return;
        }
        self.state_phase(c, w);
        w.evaluation[ELECTRICS] = c.evaluation;
        for (i, member) in self.supplies.iter().enumerate() {
            let seat = &self.seats[*member];
            if let Some(component) = seat.member.block.component() {
                w.supply[i] = component.supply(&self.law(c, seat, w));
            }
        }
        if !w.supply.is_empty() {
            w.line_current.fill([0.0; 2]);
            for seat in self.active.machines.iter().map(|i| &self.seats[*i]) {
                if let (Some(component), Some(i)) = (seat.member.block.component(), seat.supply) {
                    let [d, q] = component.line_current(&self.law(c, seat, w));
                    w.line_current[i][0] += d;
                    w.line_current[i][1] += q;
                }
            }
        }
        if w.voltage.is_empty() {
            return;
        }
        let mut source = std::mem::take(&mut w.source);
        for seat in self.active.sources.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.member.block.component() {
                component.voltages(&self.law(c, seat, w), &mut source[seat.sources.clone()]);
            }
        }
        for (to, form) in w.voltage.iter_mut().zip(&self.electrics.voltages) {
            *to = form.of(&source);
        }
        w.source = source;
        self.currents(c, w, false);
    }

    /// Mass matrix over the independent speeds, bias forces of the joints.
    fn mass(&self, q: &[f64], w: &mut Work) {
        let (n, j) = (self.rotation.free, self.joints);
        w.mass.copy_from_slice(&self.rotation.reflected);
        let (Some(model), Some(data)) = (&self.frames.model, &mut w.data) else { return };
        mass_and_bias(model, data, q, &w.joint_speed, &mut w.joint_mass, &mut w.bias);
        if self.rotation.joints_are_free {
            for row in 0..j {
                for column in 0..j {
                    w.mass[row * n + column] += w.joint_mass[row * j + column];
                }
            }
            return;
        }
        for row in 0..j {
            for column in 0..j {
                let value = w.joint_mass[row * j + column];
                for (a, fa) in self.rotation.joints[row].terms() {
                    for (b, fb) in self.rotation.joints[column].terms() {
                        w.mass[*a as usize * n + *b as usize] += fa * value * fb;
                    }
                }
            }
        }
    }

    /// Torques and accelerations.
    fn motion_phase(&self, c: &Context, w: &mut Work) {
        if w.evaluation[MOTION] == c.evaluation {
            return;
        }
        self.electrics_phase(c, w);
        w.evaluation[MOTION] = c.evaluation;
        let r = &self.rotation;
        let n = r.free;

        let mut torque = std::mem::take(&mut w.torque);
        for seat in self.active.branches.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.member.block.component() {
                component.torques(&self.law(c, seat, w), &mut torque[seat.branches.clone()]);
            }
        }
        w.torque = torque;
        for (joint, member) in self.frames.joint_members.iter().enumerate() {
            let seat = &self.seats[*member];
            if let Some(component) = seat.member.block.component() {
                w.joint_torque[joint] = component.joint_torque(&self.law(c, seat, w));
            }
        }

        // (M + T'JT) dv = T' tau - T_j' (h + M P ds) - T_n' J P ds
        self.mass(&c.x[..self.joints], w);
        w.force.fill(0.0);
        for (torque, pin) in w.torque.iter().zip(&r.branches) {
            r.pins[*pin].speed.add_to(-torque.value, &mut w.force);
        }
        for joint in 0..self.joints {
            let mut value = w.joint_torque[joint].value - w.bias[joint];
            if !w.ds.is_empty() {
                for other in 0..self.joints {
                    value -= w.joint_mass[joint * self.joints + other] * r.joints_prescribed[other].of(&w.ds);
                }
            }
            r.joints[joint].add_to(value, &mut w.force);
        }
        if !w.ds.is_empty() {
            for (node, inertia) in r.inertia.iter().enumerate().filter(|(_, inertia)| **inertia != 0.0) {
                r.nodes[node].add_to(-inertia * r.nodes_prescribed[node].of(&w.ds), &mut w.force);
            }
        }
        w.factor.copy_from_slice(&w.mass);
        if cholesky_factor(&mut w.factor, n).is_err() {
            c.fail("the mass matrix lost its positive definiteness: check masses and inertias");
            w.dv.fill(0.0);
            return;
        }
        w.dv.copy_from_slice(&w.force);
        cholesky_solve(&w.factor, &mut w.dv);
        if !self.meshes.is_empty() {
            self.meshes(c, w);
        }
    }

    /// Losses of gear meshes, and what they change about the accelerations.
    fn meshes(&self, c: &Context, w: &mut Work) {
        let r = &self.rotation;
        let (n, g) = (r.free, self.meshes.len());
        let v = &c.x[self.joints..self.joints + n];
        for (i, gear) in r.gears.iter().enumerate() {
            w.mesh_speed[i] = gear.base.of(v) + gear.base_prescribed.of(&w.s);
            let torques: f64 =
                gear.by_torque.terms().iter().map(|(b, f)| f * w.torque[*b as usize].value).sum();
            w.through[i] = gear.by_acceleration.of(&w.dv) + gear.by_prescribed.of(&w.ds) + torques;
        }
        // Columns M^-1 t' of all meshes. A loss takes its column from the accelerations, and acts at its base.
        w.columns.fill(0.0);
        for (h, gear) in r.gears.iter().enumerate() {
            let column = &mut w.columns[h * n..(h + 1) * n];
            gear.base.add_to(1.0, column);
            cholesky_solve(&w.factor, column);
        }
        for (i, gear) in r.gears.iter().enumerate() {
            for h in 0..g {
                let column = &w.columns[h * n..(h + 1) * n];
                w.coupling[i * g + h] = gear.by_acceleration.of(column) - gear.by_loss[h];
            }
        }
        if !mesh::solve(&mut w.mesh, &self.meshes, &w.mesh_speed, &w.coupling, &w.through) {
            c.fail(
                "the losses of the gears have no solution: is a gear self-locking (efficiencies below 0.3)?",
            );
            return;
        }
        for (h, loss) in w.mesh.loss.iter().enumerate() {
            for i in 0..n {
                w.dv[i] -= loss * w.columns[h * n + i];
            }
        }
    }

    /// `J dw - tau` of every node: what the rigid parts must supply.
    fn residuals(&self, w: &mut Work) {
        let r = &self.rotation;
        for (node, (to, inertia)) in w.residual.iter_mut().zip(&r.inertia).enumerate() {
            let inertia = *inertia;
            *to = if inertia == 0.0 {
                0.0
            } else {
                inertia * (r.nodes[node].of(&w.dv) + r.nodes_prescribed[node].of(&w.ds))
            };
        }
        for (torque, (rod, case)) in w.torque.iter().zip(&r.branch_nodes) {
            w.residual[*rod] += torque.value;
            w.residual[*case] -= torque.value;
        }
        for (gear, loss) in r.gears.iter().zip(&w.mesh.loss) {
            w.residual[gear.base_node] += loss;
        }
    }

    /// `M qdd + h - tau` of every joint: what its drive side must supply.
    fn joint_residuals(&self, w: &mut Work) {
        let j = self.joints;
        for joint in 0..j {
            let row = &w.joint_mass[joint * j..(joint + 1) * j];
            let inertial: f64 = row.iter().zip(&w.joint_motion).map(|(mass, motion)| mass * motion.a).sum();
            w.residual[self.rotation.nodes.len() + joint] =
                inertial + w.bias[joint] - w.joint_torque[joint].value;
        }
    }

    /// Accelerations and inner torques, for sensors.
    fn inner_torques(&self, w: &mut Work) {
        let r = &self.rotation;
        for joint in 0..self.joints {
            w.joint_motion[joint].a = r.joints[joint].of(&w.dv) + r.joints_prescribed[joint].of(&w.ds);
        }
        self.residuals(w);
        if r.needs_joint_balance {
            self.joint_residuals(w);
        }
        for (motion, drive) in w.joint_motion.iter_mut().zip(&r.drives) {
            motion.drive = drive.of(&w.residual);
        }
        for (i, pin) in r.pins.iter().enumerate() {
            w.pin_acceleration[i] = pin.speed.of(&w.dv) + pin.prescribed.of(&w.ds);
            w.pin_torque[i] = match pin.branch {
                Some(branch) => w.torque[branch].value,
                None => pin.reaction.of(&w.residual),
            };
        }
        for (i, (through, lossy)) in r.all_gears.iter().enumerate() {
            let loss = lossy.map_or(0.0, |lossy| w.mesh.loss[lossy]);
            w.all_mesh[i] = through.of(&w.residual) + loss;
        }
    }
}

impl Block for Network {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(self.interface.clone())
    }

    fn scratch(&self) -> Scratch {
        Scratch::new(self.work())
    }

    fn outputs(&self, group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let Some(w) = w.get::<Work>() else { return };
        match group {
            STATE => self.state_phase(c, w),
            ELECTRICS => self.electrics_phase(c, w),
            _ => {
                self.motion_phase(c, w);
                self.inner_torques(w);
            }
        }
        for seat in self.active.measures[group].iter().map(|i| &self.seats[*i]) {
            if let (Some(needs), Some(component)) = (seat.measures[group], seat.member.block.component()) {
                component.measure(&self.whole_law(c, seat, w), needs, &mut y[seat.y.clone()]);
            }
        }
    }

    fn derivatives(&self, c: &Context, w: &mut Scratch, dx: &mut [f64]) {
        let Some(w) = w.get::<Work>() else { return };
        self.motion_phase(c, w);
        dx[..self.joints].copy_from_slice(&w.joint_speed);
        dx[self.joints..self.joints + self.rotation.free].copy_from_slice(&w.dv);
        for seat in self.active.states.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.member.block.component() {
                component.derivatives(&self.law(c, seat, w), &mut dx[seat.x.clone()]);
            }
        }
    }

    /// `J` holds the slopes of torques over speeds and the angles as integrals of speeds: for speeds
    /// `(M + hg D) dv = M r`, for angles `r + hg T dv`.
    fn prepare(&self, c: &Context, hg: f64, w: &mut Scratch) {
        let Some(w) = w.get::<Work>() else { return };
        self.motion_phase(c, w);
        let r = &self.rotation;
        let n = r.free;
        w.damping.fill(0.0);
        for (torque, pin) in w.torque.iter().zip(&r.branches).filter(|(torque, _)| torque.slope != 0.0) {
            r.pins[*pin].speed.square_to(torque.slope, &mut w.damping, n);
        }
        for (torque, joint) in w.joint_torque.iter().zip(&r.joints).filter(|(torque, _)| torque.slope != 0.0)
        {
            joint.square_to(torque.slope, &mut w.damping, n);
        }
        for (gear, slope) in r.gears.iter().zip(&w.mesh.by_speed) {
            gear.base.square_to(*slope, &mut w.damping, n);
        }
        for ((to, mass), damping) in w.implicit.iter_mut().zip(&w.mass).zip(&w.damping) {
            *to = mass + hg * damping;
        }
        w.hg = hg;
        if cholesky_factor(&mut w.implicit, n).is_err() {
            c.fail("the mass matrix lost its positive definiteness: check masses and inertias");
        }
    }

    fn solve(&self, w: &mut Scratch, r: &mut [f64]) {
        let Some(w) = w.get::<Work>() else { return };
        let n = self.rotation.free;
        let (q, rest) = r.split_at_mut(self.joints);
        let v = &mut rest[..n];
        for (row, to) in w.product.iter_mut().enumerate() {
            *to = w.mass[row * n..(row + 1) * n].iter().zip(v.iter()).map(|(m, v)| m * v).sum();
        }
        cholesky_solve(&w.implicit, &mut w.product);
        v.copy_from_slice(&w.product);
        for (q, joint) in q.iter_mut().zip(&self.rotation.joints) {
            *q += w.hg * joint.of(v);
        }
    }
}
