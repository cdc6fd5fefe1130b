//! Accounts of energy: what a network stores, is supplied with and turns into heat.
//!
//! Components state what becomes of the power of their own laws ([`Component::energy`]); the rest is summed here: motion
//! and gravity, dry friction and meshes, resistances and valves, and what sources of speed, voltage and current bring.
//! The supplied and the dissipated energy are states that the solver integrates beside the others; the error of the
//! balance is `stored - stored at the start - supplied + dissipated`.
//!
//! Where states jump, the account books the step of the stored energy: impulses (what comes to rest, what is left of a
//! current when a valve opens) as heat, a payload that is taken up or let go as supplied. A circuit that the network integrates by itself lies
//! outside: the account books as supplied what its torques do at the shafts.
//!
//! A network without an account never comes here.

use blocksim_block::Context;
use blocksim_block::physical::{Component, Energy, LossModel};
use blocksim_multibody::{kinetic_energy, potential_energy};

use crate::accounts::{Account, GRAVITY, LISTS, MOTION, OPEN, OWN, TURNED};
use crate::electrics::{Branch, GivenBy};
use crate::network::Network;
use crate::seat::Seat;
use crate::work::Work;

impl Network {
    fn books(&self) -> impl Iterator<Item = (&Seat, &dyn Component)> {
        let seats = self.seats.iter().filter(|seat| seat.held.is_none());
        seats.filter_map(|seat| Some((seat, seat.component()?)))
    }

    /// Energy of motion and of gravity, with the payloads that the working space has.
    fn moving(&self, c: &Context, w: &mut Work) -> [f64; 2] {
        let (r, v) = (&self.rotation, self.speeds(c));
        let speed = |node: usize| r.nodes[node].of(v) + r.nodes_prescribed[node].of(&w.s);
        let turning: f64 = r.inertia.iter().enumerate().map(|(node, j)| 0.5 * j * speed(node).powi(2)).sum();
        let (Some(model), Some(data)) = (w.loaded.as_ref().or(self.frames.model.as_ref()), &mut w.data)
        else {
            return [turning, 0.0];
        };
        let q = self.positions(c);
        let potential = potential_energy(model, data, q);
        [turning + kinetic_energy(model, data, q, &w.joint_speed), potential]
    }

    /// What is stored where; speeds are known.
    fn stored(&self, c: &Context, w: &mut Work) {
        let mut parts = std::mem::take(&mut w.energies.parts);
        [parts[MOTION], parts[GRAVITY]] = self.moving(c, w);
        for (to, seat) in parts[OWN..].iter_mut().zip(&self.seats) {
            *to = match (&seat.held, seat.component()) {
                (None, Some(component)) => component.energy(&self.flowing_law(c, seat, w)).stored,
                _ => 0.0,
            };
        }
        w.energies.parts = parts;
    }

    /// What is supplied and what becomes heat, W; torques and currents are known.
    fn flows(&self, c: &Context, w: &Work) -> Energy {
        let mut sum = Energy::default();
        for (seat, component) in self.books() {
            let Energy { supplied, dissipated, .. } = component.energy(&self.flowing_law(c, seat, w));
            sum += Energy { stored: 0.0, supplied, dissipated };
        }
        let r = &self.rotation;
        let power = |branch: usize| w.torque[branch].value * w.pin_speed[r.branches[branch]];
        sum.dissipated += (r.smooth..r.branches.len()).map(power).sum::<f64>();
        let held = self.seats.iter().filter(|seat| seat.held.is_some());
        sum.supplied -= held.flat_map(|seat| seat.branches.clone()).map(power).sum::<f64>();
        for (gear, mesh) in self.meshes.iter().enumerate() {
            let stuck = mesh.model == LossModel::Stiction && w.mesh.dry[gear].1 == 0.0;
            sum.dissipated += if stuck { 0.0 } else { w.mesh.loss[gear] * w.mesh_speed[gear] };
        }
        let sources = self.accounts.sources.iter();
        sum.supplied -= sources.map(|pin| w.pin_torque[*pin] * w.pin_speed[*pin]).sum::<f64>();
        // Ends of a loop that drift apart, or are pulled together, move against what holds them.
        sum.dissipated -= w.loops.rate.iter().zip(&w.lambda).map(|(rate, lambda)| rate * lambda).sum::<f64>();
        self.electrical_flows(w, &mut sum);
        sum
    }

    fn electrical_flows(&self, w: &Work, sum: &mut Energy) {
        for island in self.electrics.islands.iter().filter(|island| island.separate.is_none()) {
            // Heat is not booked again on its way.
            for pin in island.two_pins.iter().filter(|pin| pin.domain.carries_power()) {
                let power = w.voltage[pin.index] * w.current[pin.index];
                match pin.branch {
                    branch if self.electrics.capacitance(&branch).is_some() => {}
                    Branch::Source(_) => sum.supplied -= power,
                    Branch::Given(index) => {
                        if self.electrics.windings[index - self.electrics.sources] == GivenBy::Input {
                            sum.supplied -= power;
                        }
                    }
                    Branch::Conductance(_) | Branch::Valve { .. } => sum.dissipated += power,
                    // Only the component knows what becomes of it.
                    Branch::Characteristic(..)
                    | Branch::Wire
                    | Branch::Probe
                    | Branch::Primary(_)
                    | Branch::Secondary
                    | Branch::Variable(_) => {}
                }
            }
        }
        for slot in self.active.sources.iter().filter_map(|i| self.seats[*i].supply) {
            let (supply, [d, q, zero]) = (&w.supply[slot], w.line_current[slot]);
            sum.supplied += 1.5 * (supply.voltage[0] * d + supply.voltage[1] * q) + 3.0 * supply.zero * zero;
        }
    }

    /// Derivatives of the accounts, after the phase of motion.
    pub(crate) fn account_rates(&self, c: &Context, w: &mut Work, dx: &mut [f64]) {
        if self.accounts.is_empty() {
            return;
        }
        if !self.accounts.sources.is_empty() {
            self.inner_torques(w);
        }
        let flows = self.flows(c, w);
        for account in &self.accounts.list {
            dx[self.seats[account.seat].x.clone()].copy_from_slice(&[flows.supplied, flows.dissipated]);
        }
    }

    /// Outputs of the accounts, after inner torques.
    pub(crate) fn account_outputs(&self, c: &Context, w: &mut Work, y: &mut [f64]) {
        if self.accounts.is_empty() {
            return;
        }
        self.stored(c, w);
        let flows = self.flows(c, w);
        for account in &self.accounts.list {
            let seat = &self.seats[account.seat];
            let Some([supplied, heat]) = c.x.get(seat.x.clone()).and_then(|x| x.first_chunk()) else {
                continue;
            };
            let supplied = supplied + self.brought(account, c, c.d, w);
            let parts = &w.energies.parts;
            let (error, turned) = account.balance(c.d, self.accounts.payloads, parts, [supplied, *heat]);
            let most = turned.max(c.d[account.cells + TURNED]).max(account.floor);
            y[seat.y.clone()].copy_from_slice(&[
                parts.iter().sum(),
                flows.supplied,
                flows.dissipated,
                supplied,
                *heat,
                error,
                most,
                error / most,
            ]);
        }
    }

    /// Closes all accounts, with nothing in their books: they open anew where the run begins.
    pub(crate) fn close_accounts(&self, x: &mut [f64], d: &mut [f64]) {
        for account in &self.accounts.list {
            (d[account.cells + OPEN], d[account.cells + TURNED]) = (0.0, 0.0);
            x[self.seats[account.seat].x.clone()].fill(0.0);
        }
    }

    /// Notes what is stored before a jump, after the phase of motion, and books payloads that have come or gone.
    /// Returns whether there were any.
    pub(crate) fn before_jump(&self, c: &Context, w: &mut Work, x: &mut [f64], d: &mut [f64]) -> bool {
        if self.accounts.is_empty() {
            return false;
        }
        self.stored(c, w);
        let energies = &mut w.energies;
        energies.before.copy_from_slice(&energies.parts);
        energies.pushed = 0.0;
        let mut booked = false;
        for account in &self.accounts.list {
            let brought = self.brought(account, c, d, w);
            x[self.seats[account.seat].x.start] += brought;
            booked |= brought != 0.0;
            account.shares_mut(d, self.accounts.payloads).copy_from_slice(&w.load);
        }
        booked
    }

    /// Energy that payloads have brought since an account last looked at them, J. What is stored now is known.
    fn brought(&self, account: &Account, c: &Context, d: &[f64], w: &mut Work) -> f64 {
        let before = account.shares(d, self.accounts.payloads);
        if d[account.cells + OPEN] == 0.0 || before == w.load {
            return 0.0;
        }
        w.energies.shares.copy_from_slice(before);
        std::mem::swap(&mut w.load, &mut w.energies.shares);
        self.weigh(w);
        let [motion, gravity] = self.moving(c, w);
        std::mem::swap(&mut w.load, &mut w.energies.shares);
        self.weigh(w);
        w.energies.parts[MOTION] + w.energies.parts[GRAVITY] - motion - gravity
    }

    /// Books what a jump has changed as heat, opens accounts, and fails where a balance is further off than allowed.
    pub(crate) fn after_jump(&self, c: &Context, jumped: bool, w: &mut Work, x: &mut [f64], d: &mut [f64]) {
        // The states of a search are none of a run.
        if d[self.seeks] > 0.0 {
            return;
        }
        if self.accounts.is_empty() {
            return;
        }
        if jumped {
            w.evaluation = [u64::MAX; 3];
            let here = Context { x: &*x, d: &*d, ..*c };
            self.state_phase(&here, w);
            if self.seats.iter().any(|seat| seat.shifted.is_some()) || self.electrics.has_fields() {
                self.electrics_phase(&here, w);
            }
            self.stored(&here, w);
            w.evaluation = [u64::MAX; 3];
        }
        let parts = &w.energies.parts;
        let lost: f64 = w.energies.before.iter().zip(parts).map(|(before, after)| before - after).sum();
        for account in &self.accounts.list {
            let seat = &self.seats[account.seat];
            let cells = account.cells;
            if d[cells + OPEN] == 0.0 {
                let first = cells + LISTS + self.accounts.payloads;
                d[first..first + parts.len()].copy_from_slice(parts);
                d[cells + OPEN] = 1.0;
                continue;
            }
            if jumped {
                x[seat.x.start] += w.energies.pushed;
                x[seat.x.start + 1] += lost + w.energies.pushed;
            }
            let books = [x[seat.x.start], x[seat.x.start + 1]];
            let (error, turned) = account.balance(d, self.accounts.payloads, parts, books);
            let most = turned.max(d[cells + TURNED]).max(account.floor);
            d[cells + TURNED] = most;
            if let Some(tolerance) = account.tolerance.filter(|tolerance| error.abs() > tolerance * most) {
                c.fail(format!(
                    "the account `{}` does not balance: {error:.3e} J are {} of the {most:.3e} J turned over so far, \
                     {:.1e} of them, and {tolerance:.1e} are allowed; make `rtol` and `atol` of the solver smaller, \
                     or raise `tolerance`",
                    seat.member.path,
                    if error > 0.0 { "too much" } else { "missing" },
                    error.abs() / most,
                ));
            }
        }
    }
}
