//! A network as a block: its values, laid out.

use blocksim_block::physical::{Element, JointMotion, Law, MeshLoss, Needs, Supply};
use blocksim_block::{Block, Context, Given, Input, Interface, InterfaceError, Output, Scratch};
use blocksim_solve::linear::cholesky_factor;

use crate::assembly::Member;
use crate::electrics::Electrics;
use crate::frames::Frames;
use crate::problem::NetworkProblem;
use crate::rotation::Rotation;
use crate::seat::{Active, ELECTRICS, STATE, Seat};
use crate::work::Work;

/// A physical network as one block.
///
/// States: joint angles, independent speeds, then the states of the members. Output group 0 (of the three that
/// [`Needs`] names) depends on states alone, group 1 on the inputs of electrical sources, group 2 on everything.
#[derive(Debug)]
pub struct Network {
    pub(crate) seats: Vec<Seat>,
    pub(crate) rotation: Rotation,
    pub(crate) electrics: Electrics,
    pub(crate) frames: Frames,
    pub(crate) meshes: Vec<MeshLoss>,
    /// Member of each supply.
    pub(crate) supplies: Vec<usize>,
    pub(crate) interface: Interface,
    pub(crate) joints: usize,
    /// Some currents are measured before voltages are known.
    pub(crate) has_early: bool,
    pub(crate) active: Active,
}

const NO_SUPPLY: Supply = Supply { amplitude: 0.0, offset: 0.0, frequency: 0.0, angle: 0.0 };
const NO_JOINT: JointMotion = JointMotion { q: 0.0, w: 0.0, a: 0.0, drive: 0.0 };

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
        let (mut d, mut g) = (0, 0);
        let mut at = [0usize; 7];
        for (index, (member, supply)) in members.into_iter().zip(supply_of).enumerate() {
            let mut counts = [0usize; 7];
            let (mut is_machine, mut is_capacitance, mut drives_electrics) = (false, false, false);
            for element in &member.part.elements {
                let kinds: &[usize] = match element {
                    Element::Branch { .. } => &[0, 3],
                    Element::SpeedSource { .. } => &[0, 6],
                    Element::Rigid { .. } | Element::SpeedProbe { .. } => &[0],
                    Element::VoltageSource { .. } | Element::Capacitance { .. } => &[1, 4],
                    Element::Winding { .. } | Element::CurrentSource { .. } => &[1, 5],
                    Element::VoltageProbe { .. }
                    | Element::CurrentProbe { .. }
                    | Element::Resistance { .. } => &[1],
                    Element::Gear { .. } => &[2],
                    _ => &[],
                };
                kinds.iter().for_each(|kind| counts[*kind] += 1);
                is_machine |= matches!(element, Element::Machine { .. });
                is_capacitance |= matches!(element, Element::Capacitance { .. });
                drives_electrics |= matches!(
                    element,
                    Element::VoltageSource { .. } | Element::CurrentSource { .. } | Element::Supply { .. }
                );
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
            for memory in &member.part.discrete {
                interface = interface.discrete(format!("{}.{}", member.path, memory.name), memory.initial);
            }
            for guard in &member.part.guards {
                interface = interface.guard(format!("{}.{guard}", member.path));
            }
            interface.jumps |= member.part.jumps;
            interface.time_events |= member.part.time_events;
            let (memories, guards) = (member.part.discrete.len(), member.part.guards.len());
            let outputs: usize = member.part.outputs.iter().map(|(o, _)| o.port_type.shape.len()).sum();
            // A sensor that reads states alone closes no algebraic loop.
            let early = !two_pins.is_empty() && two_pins.clone().all(|i| electrics.is_early(i));
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
                d: d..d + memories,
                g: g..g + guards,
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
                is_capacitance,
                measures,
                member,
            });
            x += states;
            d += memories;
            g += guards;
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
        let mut work = Work::new(self);
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

    /// What a member sees before accelerations are known.
    #[inline]
    pub(crate) fn law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Law<'a> {
        let electrical = !seat.two_pins.is_empty();
        Law {
            t: c.t,
            x: c.x.get(seat.x.clone()).unwrap_or(&[]),
            d: c.d.get(seat.d.clone()).unwrap_or(&[]),
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

    /// What a member sees when nothing but time, inputs and states is known.
    fn still<'a>(&'a self, c: &Context<'a>, seat: &'a Seat) -> Law<'a> {
        Law {
            t: c.t,
            x: c.x.get(seat.x.clone()).unwrap_or(&[]),
            d: c.d.get(seat.d.clone()).unwrap_or(&[]),
            u: &c.u[seat.u.clone()],
            inputs: &seat.inputs,
            ..Law::nothing()
        }
    }

    /// What a member sees in the end.
    pub(crate) fn whole_law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Law<'a> {
        Law {
            acceleration: &w.pin_acceleration[seat.pins.clone()],
            torque: &w.pin_torque[seat.pins.clone()],
            mesh: &w.all_mesh[seat.gears.clone()],
            ..self.law(c, seat, w)
        }
    }
}

impl Block for Network {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(self.interface.clone())
    }

    fn scratch(&self) -> Scratch {
        Scratch::new(Work::new(self))
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

    fn guards(&self, c: &Context, w: &mut Scratch, g: &mut [f64]) {
        let Some(w) = w.get::<Work>() else { return };
        self.motion_phase(c, w);
        self.inner_torques(w);
        for seat in self.active.guards.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.member.block.component() {
                component.guards(&self.whole_law(c, seat, w), &mut g[seat.g.clone()]);
            }
        }
    }

    fn jump(&self, c: &Context, w: &mut Scratch, x: &mut [f64], d: &mut [f64]) -> bool {
        let Some(w) = w.get::<Work>() else { return false };
        // Members see the states as they were while they change them.
        let (mut before, mut modes) = (std::mem::take(&mut w.before), std::mem::take(&mut w.modes));
        before.copy_from_slice(x);
        modes.copy_from_slice(d);
        let here = Context { x: &before, d: &modes, ..*c };
        self.motion_phase(&here, w);
        self.inner_torques(w);
        let mut jumped = false;
        for seat in self.active.jumps.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.member.block.component() {
                let (x, d) = (&mut x[seat.x.clone()], &mut d[seat.d.clone()]);
                jumped |= component.jump(&self.whole_law(&here, seat, w), x, d);
            }
        }
        (w.before, w.modes) = (before, modes);
        jumped
    }

    fn next_event(&self, c: &Context) -> f64 {
        let seats = self.active.time_events.iter().map(|i| &self.seats[*i]);
        let times =
            seats.filter_map(|seat| Some(seat.member.block.component()?.next_event(&self.still(c, seat))));
        times.fold(f64::INFINITY, f64::min)
    }

    fn prepare(&self, c: &Context, hg: f64, w: &mut Scratch) {
        if let Some(w) = w.get::<Work>() {
            self.prepare_implicit(c, hg, w);
        }
    }

    fn solve(&self, w: &mut Scratch, r: &mut [f64]) {
        if let Some(w) = w.get::<Work>() {
            self.solve_implicit(w, r);
        }
    }
}
