//! What must hold before a network can run.

use blocksim_block::physical::{Domain, Flowing};
use blocksim_block::{Context, Fault, Resolution};
use nalgebra::{DMatrix, DVector};

use crate::assembly::domains::Nodal;
use crate::electrics::commutation::REMAINDER;
use crate::electrics::{Branch, Capacitance, Crossing, Floating, loops};
use crate::network::Network;
use crate::problem::NetworkProblem;
use crate::seat::Role;
use crate::work::Work;

/// Voltages around a loop that miss zero by less than this, relative to the largest of them, are rounding.
const MISFIT: f64 = 1e-9;

/// Currents that leave each part of a circuit and do not come back.
fn missing(floating: &Floating, w: &Work) -> DVector<f64> {
    let sum = |leaving: &Vec<(usize, f64)>| leaving.iter().map(|(i, sign)| sign * w.given[*i]).sum::<f64>();
    DVector::from_iterator(floating.parts, floating.leaving.iter().map(sum))
}

impl Network {
    /// At the start pose every independent speed must move something.
    pub(crate) fn mass_matrix_is_definite(&self) -> Result<(), Vec<NetworkProblem>> {
        let mut work = Work::new(self);
        let n = self.rotation.free;
        self.mass(&self.frames.position, &mut work);
        if !self.frames.loops.is_empty() {
            self.close_loops(&self.frames.position, &mut work);
        }
        work.factor.copy_from_slice(&work.mass);
        if self.envelope.factor(&mut work.factor).is_ok() {
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

    /// Currents that are states must obey Kirchhoff's law from the start: those that are not given follow the others, by the
    /// volt-seconds that would make them. Currents that come as signals count as zero before the start. Where valves may open a
    /// path, the first instant tells.
    pub(crate) fn fit_currents(&mut self) -> Result<(), Vec<NetworkProblem>> {
        let mut work = Work::new(self);
        let x: Vec<f64> = self.interface.states.iter().map(|state| state.initial).collect();
        let d: Vec<f64> = self.interface.discrete.iter().map(|state| state.initial).collect();
        let inputs = self.seats.last().map_or(0, |seat| seat.u.end);
        let u = vec![0.0; inputs];
        let fault = Fault::default();
        let c = Context {
            t: 0.0,
            x: &x,
            d: &d,
            u: &u,
            inputs: &[],
            outputs: &[],
            evaluation: 0,
            resolution: Resolution::default(),
            seed: 0,
            fault: &fault,
        };
        self.state_phase(&c, &mut work);
        let mut problems = Vec::new();
        let mut starts = Vec::new();
        for (index, island) in self.electrics.islands.iter().enumerate() {
            if !island.valves.is_empty() || self.circuit(index, &c, &mut work).is_err() {
                continue;
            }
            let circuits = std::mem::take(&mut work.circuits);
            if let Some(floating) = &circuits[index].now().floating {
                let size = |w: &Work| {
                    let of = |i: &usize| w.given[*i].abs();
                    floating.leaving.iter().flatten().map(|(i, _)| of(i)).fold(0.0, f64::max)
                };
                self.take_states(index, &c, &mut work);
                self.currents_of_states(index, &c, &mut work);
                let before = size(&work);
                let fitted = self.share_currents(floating, &c, &mut work);
                let lost = missing(floating, &work).amax();
                if lost > REMAINDER * before.max(size(&work)) {
                    problems.push(self.misfit(floating, lost));
                } else {
                    starts.extend(fitted);
                }
            }
            work.circuits = circuits;
        }
        for (member, start) in starts {
            (0..start.len()).for_each(|state| self.start_state(member, state, start[state]));
        }
        if problems.is_empty() { Ok(()) } else { Err(problems) }
    }

    /// Changes the given currents that follow others at the start, by the smallest volt-seconds after which the law of nodes holds;
    /// returns the states of their members.
    fn share_currents(&self, floating: &Floating, c: &Context, w: &mut Work) -> Vec<(usize, Vec<f64>)> {
        let k = floating.parts;
        let mut matrix = DMatrix::zeros(k, k);
        let follows = |crossing: &&Crossing| self.seats[crossing.member].member.part.currents_follow;
        let border =
            |crossing: &Crossing| DMatrix::from_row_slice(crossing.weights.len(), k, &crossing.border);
        for crossing in floating.crossing.iter().filter(follows) {
            let seat = &self.seats[crossing.member];
            let Some(component) = seat.component() else { continue };
            let m = crossing.weights.len();
            let (mut internal, mut inverse) = (vec![0.0; m], vec![0.0; m * m]);
            let law = Flowing { fed: self.fed_own_law(c, seat, w), ..self.flowing_law(c, seat, w) };
            component.reluctance(&law, &mut internal, &mut inverse);
            let weights = DMatrix::from_diagonal(&DVector::from_column_slice(&crossing.weights));
            let border = border(crossing);
            matrix += border.transpose() * weights * DMatrix::from_row_slice(m, m, &inverse) * border;
        }
        let missing = -missing(floating, w);
        let largest = matrix.amax();
        if missing.amax() == 0.0 || largest == 0.0 {
            return Vec::new();
        }
        let Ok(psi) = matrix.svd(true, true).solve(&missing, 1e-12 * largest) else { return Vec::new() };
        let mut starts = Vec::new();
        for crossing in floating.crossing.iter().filter(follows) {
            let seat = &self.seats[crossing.member];
            let Some(component) = seat.component() else { continue };
            let mut law = self.fed_own_law(c, seat, w);
            let mut x = law.x.to_vec();
            component.strike(&law, (border(crossing) * &psi).as_slice(), &mut x);
            law.x = &x;
            let mut currents = vec![0.0; seat.windings.len()];
            seat.member.part.write_currents(component, &law, &mut currents);
            let first = self.electrics.sources + seat.windings.start;
            w.given[first..first + currents.len()].copy_from_slice(&currents);
            starts.push((crossing.member, x));
        }
        starts
    }

    /// Start currents that do not obey Kirchhoff's law.
    fn misfit(&self, floating: &Floating, lost: f64) -> NetworkProblem {
        let sources = floating.cut.contains(&true);
        let problem = NetworkProblem::new(
            "start_conflict",
            format!("the currents at the start do not obey Kirchhoff's law: {lost} A have no path"),
            if sources {
                "leave out `i0` of the inductances in series with a current source, or make them add up to zero: what comes as a \
                 signal counts as zero before the start"
            } else {
                "leave out `i0` of one of these inductances, or make their start currents add up to zero at every node"
            },
        );
        floating
            .crossing
            .iter()
            .fold(problem, |problem, crossing| problem.with(crossing.member, "has a current at the start"))
    }

    /// Gives a state of a member another start.
    fn start_state(&mut self, member: usize, state: usize, start: f64) {
        let seat = &self.seats[member];
        match &seat.held {
            None => self.interface.states[seat.x.start + state].initial = start,
            Some(held) => {
                self.interface.discrete[seat.x.start + state].initial = start;
                self.interface.discrete[held.x_end.start + state].initial = start;
            }
        }
    }

    /// Voltages of capacitances in loops must obey Kirchhoff's law from the start: those that are not given follow the others.
    /// Voltages that come as signals count as zero before the start.
    pub(crate) fn fit_voltages(&mut self) -> Result<(), Vec<NetworkProblem>> {
        let mut work = Work::new(self);
        let x: Vec<f64> = self.interface.states.iter().map(|state| state.initial).collect();
        let d: Vec<f64> = self.interface.discrete.iter().map(|state| state.initial).collect();
        let u = vec![0.0; self.seats.last().map_or(0, |seat| seat.u.end)];
        let fault = Fault::default();
        let c = Context {
            t: 0.0,
            x: &x,
            d: &d,
            u: &u,
            inputs: &[],
            outputs: &[],
            evaluation: 0,
            resolution: Resolution::default(),
            seed: 0,
            fault: &fault,
        };
        let mut starts = Vec::new();
        let mut problems = Vec::new();
        for (index, island) in self.electrics.islands.iter().enumerate() {
            let Some(law) = &island.loops else { continue };
            self.prescribed_voltages(index, &c, &mut work);
            let of = |position: &usize| self.electrics.capacitance(&island.two_pins[*position].branch);
            let capacitances: Vec<_> = law.capacitances.iter().filter_map(of).collect();
            let own = capacitances.iter().map(|c| c.start.unwrap_or_else(|| self.begins(c)));
            let y = DVector::from_iterator(capacitances.len(), own);
            let others = law.others.iter().map(|position| match island.two_pins[*position].branch {
                Branch::Source(index) => work.given[index],
                _ => 0.0,
            });
            let e = DVector::from_iterator(law.others.len(), others);
            let given: Vec<bool> = capacitances.iter().map(|c| c.start.is_some()).collect();
            let (fitted, left) = law.fit(&y, &e, &given);
            let size = fitted.amax().max(if e.is_empty() { 0.0 } else { e.amax() });
            if left.amax() > MISFIT * size {
                problems.push(self.voltages_conflict(index, law, &left));
                continue;
            }
            for (k, capacitance) in capacitances.iter().enumerate() {
                let shift = island.shifts.iter().find(|shift| shift.source == capacitance.source);
                let added = shift.map_or(0.0, |shift| shift.by.of(&work.given));
                starts.push((capacitance.member, capacitance.state, fitted[k] - added));
            }
        }
        starts.into_iter().for_each(|(member, state, start)| self.start_state(member, state, start));
        if problems.is_empty() { Ok(()) } else { Err(problems) }
    }

    /// What a component says of its state at the start, where it may follow from others.
    fn begins(&self, c: &Capacitance) -> f64 {
        let seat = &self.seats[c.member];
        let states = self.interface.states.get(seat.x.start + c.state).filter(|_| seat.held.is_none());
        states.map_or(0.0, |state| state.initial)
    }

    /// Start values that do not obey Kirchhoff's law of loops.
    fn voltages_conflict(&self, island: usize, law: &loops::Law, left: &DVector<f64>) -> NetworkProblem {
        let circuit = &self.electrics.islands[island];
        let worst = left.iamax();
        let first = law.capacitances.first().map(|i| circuit.two_pins[*i].domain);
        let domain = first.unwrap_or(Domain::Electrical);
        let Nodal { across, several, unit, stores, start, resist, .. } = Nodal::of(domain);
        let misses = left[worst].abs();
        let problem = if domain != Domain::Electrical {
            NetworkProblem::new(
                "start_conflict",
                format!(
                    "the {several} at the start do not fit each other: of what is directly connected they differ by {misses} {unit}"
                ),
                format!(
                    "leave out `{start}` of one of the {stores}, or give all of them the same; what comes as a signal counts as 0 {unit} \
                     before the start: put {resist} between"
                ),
            )
        } else {
            NetworkProblem::new(
                "start_conflict",
                format!(
                    "the voltages at the start do not obey Kirchhoff's law: around a loop of capacitors they miss zero by {misses} V"
                ),
                "leave out `v0` of one of them, or give values that fit; what comes as a signal counts as zero before the start",
            )
        };
        let list = law.capacitances.iter().enumerate().map(|(k, i)| (i, law.b[(worst, k)]));
        let others = law.others.iter().enumerate().map(|(k, i)| (i, law.d[(worst, k)]));
        let mut named = Vec::new();
        for (position, _) in list.chain(others).filter(|(_, factor)| *factor != 0.0) {
            let pin = &circuit.two_pins[*position];
            let role = match self.electrics.capacitance(&pin.branch) {
                Some(c) if c.start.is_some() => format!("has a {across} at the start"),
                Some(_) => "belongs to the loop".to_owned(),
                None => format!("gives a {across}"),
            };
            let one = (pin.member, role);
            if !named.contains(&one) && matches!(pin.branch, Branch::Source(_)) {
                named.push(one);
            }
        }
        named.into_iter().fold(problem, |problem, (member, role)| problem.with(member, role))
    }

    /// Turns the fluxes that machines start with to the voltage that their circuit has at the start, where sources alone
    /// decide it. A machine that a source feeds directly is in the frame of that source already.
    pub(crate) fn turn_machines(&self, c: &Context, x: &mut [f64], d: &[f64]) {
        let is_machine = |i: &&usize| matches!(self.seats[**i].role, Role::Machine(_));
        let islands = self.electrics.islands.iter().enumerate();
        let mut known = islands.filter(|(_, island)| {
            island.valves.is_empty()
                && island.separate.is_none()
                && island.members.iter().any(|i| is_machine(&i))
        });
        let Some(first) = known.next() else { return };
        let mut work = Work::new(self);
        let before = x.to_vec();
        let c = Context { x: &before, d, ..*c };
        self.state_phase(&c, &mut work);
        for (index, island) in std::iter::once(first).chain(known) {
            if self.circuit(index, &c, &mut work).is_err() || !work.circuits[index].is_stiff() {
                continue;
            }
            for seat in island.members.iter().filter(is_machine).map(|i| &self.seats[*i]) {
                let [d, q] = seat.supply.map_or([0.0; 2], |slot| work.supply[slot].voltage);
                if let Some(component) = seat.component().filter(|_| d != 0.0 || q != 0.0) {
                    component.turn(q.atan2(d), &mut x[seat.x.clone()]);
                }
            }
        }
    }
}
