//! A network as a block: its values, laid out.

use blocksim_block::physical::{Law, MeshLoss};
use blocksim_block::{Block, Context, Fault, Given, Interface, InterfaceError, Scratch};
use blocksim_scene::Scene;
use blocksim_solve::linear::cholesky_factor;

use crate::assembly::Member;
use crate::electrics::Electrics;
use crate::electrics::separate::Separate;
use crate::energy::Accounts;
use crate::mechanics::frames::Frames;
use crate::mechanics::rotation::Rotation;
use crate::mechanics::scene;
use crate::mechanics::stiction::Stiction;
use crate::problem::NetworkProblem;
use crate::seat::{Active, CHARGE, ELECTRICS, MOTION, STATE, Seat};
use crate::work::Work;

/// A physical network as one block.
///
/// States: positions of joints, independent speeds, then the states of the members. Output groups 0
/// and 3 depend on states alone, group 1 on the inputs of electrical sources, group 2 on everything, as
/// [`Needs`](blocksim_block::physical::Needs) says.
#[derive(Debug)]
pub struct Network {
    pub(crate) seats: Vec<Seat>,
    pub(crate) rotation: Rotation,
    pub(crate) stiction: Stiction,
    pub(crate) electrics: Electrics,
    pub(crate) frames: Frames,
    pub(crate) meshes: Vec<MeshLoss>,
    /// Number of supplies: those of sources, and those that machines in circuits see.
    pub(crate) supplies: usize,
    /// Where the discrete states of valves begin: whether each conducts by itself.
    pub(crate) first_latch: usize,
    /// Valves that conduct by themselves, in the order of their guards, which come behind those of the members.
    pub(crate) natural: Vec<usize>,
    pub(crate) first_natural: usize,
    pub(crate) interface: Interface,
    /// Number of positions of joints.
    pub(crate) positions: usize,
    /// Where the positions of joints stand among the outputs, if the mechanism has shapes.
    pub(crate) first_pose: usize,
    /// Number of speeds of joints.
    pub(crate) joints: usize,
    /// Some currents are measured before voltages are known.
    pub(crate) has_early: bool,
    pub(crate) active: Active,
    /// Circuits that the network integrates by itself.
    pub(crate) separate: Vec<Separate>,
    pub(crate) accounts: Accounts,
}

impl Network {
    /// The members, in the order of their inputs and outputs.
    pub fn members(&self) -> impl Iterator<Item = &Member> {
        self.seats.iter().map(|seat| &*seat.member)
    }

    /// What is seen of the mechanism.
    pub fn scene(&self) -> &Scene {
        &self.frames.scene
    }

    /// Signals that tell where the bodies of a mechanism with shapes are: the name to record each by and its output.
    pub fn pose_signals(&self) -> impl Iterator<Item = (&str, usize)> {
        let outputs = self.interface.outputs.len();
        let recorded = scene::outputs(&self.frames).len();
        self.frames.signals.iter().map(String::as_str).zip(outputs - recorded..outputs)
    }

    /// At the start pose every independent speed must move something.
    pub(crate) fn mass_matrix_is_definite(&self) -> Result<(), Vec<NetworkProblem>> {
        let mut work = Work::new(self);
        let n = self.rotation.free;
        self.mass(&self.frames.position, &mut work);
        if !self.frames.loops.is_empty() {
            self.close_loops(&self.frames.position, &mut work);
        }
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
        let joint = self.frames.speeds.get(weak);
        Err(vec![
            joint.into_iter().fold(problem, |problem, joint| problem.with(joint.member, "moves too little")),
        ])
    }

    /// Prescribed speeds may jump, and loops pass that on.
    pub(crate) fn loops_meet_sources(&self) -> bool {
        self.rotation.sources > 0 && !self.frames.loops.is_empty()
    }

    /// Currents that are states must obey Kirchhoff's law from the start. Where valves may open a path, the first
    /// instant tells.
    pub(crate) fn currents_fit(&self) -> Result<(), Vec<NetworkProblem>> {
        let mut work = Work::new(self);
        let x: Vec<f64> = self.interface.states.iter().map(|state| state.initial).collect();
        let d: Vec<f64> = self.interface.discrete.iter().map(|state| state.initial).collect();
        let inputs = self.seats.last().map_or(0, |seat| seat.u.end);
        let u = vec![0.0; inputs];
        let fault = Fault::default();
        let c =
            Context { t: 0.0, x: &x, d: &d, u: &u, inputs: &[], outputs: &[], evaluation: 0, fault: &fault };
        self.state_phase(&c, &mut work);
        let mut problems = Vec::new();
        for (index, island) in self.electrics.islands.iter().enumerate() {
            if !island.valves.is_empty() || self.circuit(index, &c, &mut work).is_err() {
                continue;
            }
            problems.extend(self.misfit(index, &work));
        }
        if problems.is_empty() { Ok(()) } else { Err(problems) }
    }

    /// What a member sees before accelerations are known.
    #[inline(always)]
    pub(crate) fn law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Law<'a> {
        // Most members have a share of few of these lists, and this is called some hundred times in an evaluation.
        let (x, d) = seat.states(c);
        let mut law = Law { t: c.t, x, d, inputs: &seat.inputs, ..Law::nothing() };
        if !seat.u.is_empty() {
            law.u = &c.u[seat.u.clone()];
        }
        if !seat.pins.is_empty() {
            law.speed = &w.pin_speed[seat.pins.clone()];
        }
        if !(seat.frictions.is_empty() && seat.dry.is_empty()) {
            law.mode = self.modes_of(c, seat);
        }
        if !seat.two_pins.is_empty() {
            law.voltage = &w.voltage[seat.two_pins.clone()];
            law.current = &w.current[seat.two_pins.clone()];
        }
        if let Some(i) = seat.supply {
            law.supply = &w.supply[i];
            law.line_current = &w.line_current[i];
        }
        if seat.is_spatial() {
            law.joint = &w.joint_motion[seat.joint.clone()];
            law.frames = &w.frame_motion[seat.frames.clone()];
            if let Some(i) = seat.ball {
                law.orientation = &w.orientation[i];
            }
        }
        law
    }

    /// What a member sees in the end.
    #[inline(always)]
    pub(crate) fn whole_law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Law<'a> {
        let mut law = self.law(c, seat, w);
        if !seat.pins.is_empty() {
            law.acceleration = &w.pin_acceleration[seat.pins.clone()];
            law.torque = &w.pin_torque[seat.pins.clone()];
        }
        if !seat.gears.is_empty() {
            law.mesh = &w.all_mesh[seat.gears.clone()];
        }
        law
    }

    /// What a member sees when nothing but time, inputs and states is known.
    fn still<'a>(&'a self, c: &Context<'a>, seat: &'a Seat) -> Law<'a> {
        let (x, d) = seat.states(c);
        Law { t: c.t, x, d, u: &c.u[seat.u.clone()], inputs: &seat.inputs, ..Law::nothing() }
    }
}

impl Block for Network {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(self.interface.clone())
    }

    fn scratch(&self) -> Scratch {
        Scratch::new(Work::new(self))
    }

    fn initialize(&self, _c: &Context, x: &mut [f64], d: &mut [f64]) {
        self.follow_speeds(x, &[], d);
    }

    fn outputs(&self, group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let Some(w) = w.get::<Work>() else { return };
        match group {
            STATE | CHARGE => self.state_phase(c, w),
            ELECTRICS => self.electrics_phase(c, w),
            _ => {
                self.motion_phase(c, w);
                self.inner_torques(w);
            }
        }
        if matches!(group, ELECTRICS | MOTION) {
            self.held_circuits(c, w);
        }
        for seat in self.active.measures[group].iter().map(|i| &self.seats[*i]) {
            if let (Some(needs), Some(component)) = (seat.measures[group], seat.component()) {
                let law = if group == MOTION { self.whole_law(c, seat, w) } else { self.law(c, seat, w) };
                component.measure(&law, needs, &mut y[seat.y.clone()]);
            }
        }
        if group == MOTION {
            self.account_outputs(c, w, y);
        }
        if group == STATE {
            // Nothing where there are no shapes.
            for (y, q) in y[self.first_pose..].iter_mut().zip(self.positions(c)) {
                *y = *q;
            }
        }
    }

    fn derivatives(&self, c: &Context, w: &mut Scratch, dx: &mut [f64]) {
        let Some(w) = w.get::<Work>() else { return };
        self.motion_phase(c, w);
        self.position_rates(self.positions(c), &w.joint_speed, &mut dx[..self.positions]);
        dx[self.positions..self.positions + self.rotation.free].copy_from_slice(&w.dv);
        for seat in self.active.states.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                component.derivatives(&self.law(c, seat, w), &mut dx[seat.x.clone()]);
            }
        }
        self.account_rates(c, w, dx);
    }

    fn guards(&self, c: &Context, w: &mut Scratch, g: &mut [f64]) {
        let Some(w) = w.get::<Work>() else { return };
        self.motion_phase(c, w);
        self.inner_torques(w);
        for seat in self.active.guards.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                component.guards(&self.whole_law(c, seat, w), &mut g[seat.g.clone()]);
            }
        }
        self.stiction_guards(c, w, g);
        if !self.natural.is_empty() {
            self.valve_guards(c, w, &mut g[self.first_natural..]);
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
        let booked = self.before_jump(&here, w, x, d);
        let mut jumped = self.loops_meet_sources() && self.meet_loops(&here, w, x);
        for seat in self.active.jumps.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                let (x, d) = (&mut x[seat.x.clone()], &mut d[seat.d.clone()]);
                jumped |= component.jump(&self.whole_law(&here, seat, w), x, d);
            }
        }
        if jumped {
            // What has been struck slides.
            self.follow_speeds(x, &w.s, d);
        } else {
            jumped = self.choose_modes(&here, w, x, d);
        }
        (w.before, w.modes) = (before, modes);
        let here = Context { x: &[], d: &[], ..*c };
        for island in &self.active.valves {
            jumped |= self.commutate(*island, &here, w, x, d);
        }
        self.after_jump(&here, jumped, w, x, d);
        jumped |= booked;
        if jumped {
            // What is in the working space belongs to the states before.
            w.evaluation = [u64::MAX; 3];
        }
        jumped
    }

    fn update(&self, c: &Context, w: &mut Scratch, d: &mut [f64]) {
        if let Some(w) = w.get::<Work>() {
            self.couple(c, w, d);
        }
    }

    fn next_event(&self, c: &Context) -> f64 {
        let seats = self.active.time_events.iter().map(|i| &self.seats[*i]);
        let times = seats.filter_map(|seat| Some(seat.component()?.next_event(&self.still(c, seat))));
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
