//! Dry friction that sticks: each friction slides forward, slides backward, or is stuck.
//!
//! The modes are discrete states of the network. While it slides, friction is a torque like others. While it is stuck,
//! its speed is constrained to zero and its torque follows from the constraint. Guards end both: a speed that comes to
//! zero, a torque that reaches what is held.
//!
//! Which modes follow is a complementarity problem: what is stuck bears no more than it can hold, and what slides from
//! rest accelerates the way it slides. It is solved by least-index pivoting: every friction at rest begins stuck, and
//! of those whose mode is wrong the first is changed, until none is. For matrices that are positive definite this
//! ends (K. G. Murty, Note on a Bard-type scheme for solving the complementarity problem, Opsearch 11 (1974)). Where
//! more is held at rest than while sliding, there may be several solutions and pivoting may go round in circles; then
//! what is held counts as what slides, which has one solution.

use std::ops::Range;

use blocksim_block::physical::{Grip, LossModel, Torque};
use blocksim_block::{Context, Interface};
use blocksim_solve::linear::cholesky_solve;

use crate::assembly::eliminate::Form;
use crate::mechanics::constraints::DEPENDENT;
use crate::mechanics::loops::AT_REST;
use crate::mechanics::rotation::Rotation;
use crate::network::Network;
use crate::seat::Seat;
use crate::work::Work;

/// Speeds below this part of those that they are the difference of are zero: some thousand units in the last place.
const STANDS: f64 = 1e-12;

/// What is stuck may have drifted by this part before it counts as struck.
const DRIFT: f64 = 1e-9;

/// Accelerations and torques that are rounding, relative to all that pulls at the network and to what the friction itself
/// causes.
const ROUNDING: f64 = 1e-12;

/// Largest product of the share of a loss and its effect on the torque that passes; at 1 there would be no solution.
const STEEPEST: f64 = 0.99;

/// A distance from breakaway that is as good as infinite, N*m.
const FAR: f64 = 1e9;

/// What sticks in a network: frictions and meshes of gears.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stiction {
    /// Where their modes lie among the discrete states.
    modes: Range<usize>,
    /// Where their guards lie.
    guards: Range<usize>,
    /// Frictions, then meshes.
    parts: Vec<Place>,
    /// Number of frictions.
    frictions: usize,
    /// Index of the first friction among the branches.
    first: usize,
}

/// Where something that sticks is.
#[derive(Debug, Clone, Copy)]
enum Place {
    /// Index of the pin of a friction.
    Pin(usize),
    /// Index of a gear with losses.
    Gear(usize),
}

impl Stiction {
    /// Adds modes and guards to the interface, behind those of the members.
    pub(crate) fn new(seats: &[Seat], rotation: &Rotation, interface: &mut Interface) -> Self {
        let (d, g) = (interface.discrete.len(), interface.guards.len());
        let mut parts: Vec<Place> =
            rotation.branches[rotation.smooth..].iter().map(|pin| Place::Pin(*pin)).collect();
        let frictions = parts.len();
        let gears = rotation.gears.iter().enumerate();
        let dry = gears.filter(|(_, gear)| gear.loss.model == LossModel::Stiction);
        parts.extend(dry.map(|(i, _)| Place::Gear(i)));
        for of in [|seat: &Seat| seat.frictions.len(), |seat: &Seat| seat.dry.len()] {
            for seat in seats {
                for i in 0..of(seat) {
                    let number = if of(seat) > 1 { (i + 1).to_string() } else { String::new() };
                    let name = format!("{}.mode{number}", seat.member.path);
                    interface.discrete.push(blocksim_block::Discrete { name: name.clone(), initial: 0.0 });
                    interface.guards.push(name);
                }
            }
        }
        interface.jumps |= !parts.is_empty();
        Self {
            modes: d..d + parts.len(),
            guards: g..g + parts.len(),
            parts,
            frictions,
            first: rotation.smooth,
        }
    }

    /// Number of parts that stick.
    pub(crate) fn len(&self) -> usize {
        self.parts.len()
    }

    /// Number of meshes that stick.
    pub(crate) fn meshes(&self) -> usize {
        self.parts.len() - self.frictions
    }

    /// The modes among discrete states.
    fn of<'a>(&self, d: &'a [f64]) -> &'a [f64] {
        d.get(self.modes.clone()).unwrap_or(&[])
    }
}

impl Network {
    /// Modes of the frictions or meshes of a member.
    #[inline]
    pub(crate) fn modes_of<'a>(&self, c: &Context<'a>, seat: &Seat) -> &'a [f64] {
        let first = if seat.frictions.is_empty() { self.stiction.frictions } else { 0 };
        let range = if seat.frictions.is_empty() { &seat.dry } else { &seat.frictions };
        self.stiction.of(c.d).get(first + range.start..first + range.end).unwrap_or(&[])
    }

    /// Speed of what sticks over the independent and over the prescribed speeds.
    fn sticky(&self, i: usize) -> (&Form, &Form) {
        match self.stiction.parts[i] {
            Place::Pin(pin) => (&self.rotation.pins[pin].speed, &self.rotation.pins[pin].prescribed),
            Place::Gear(gear) => {
                (&self.rotation.gears[gear].base, &self.rotation.gears[gear].base_prescribed)
            }
        }
    }

    /// Torque against forward motion.
    fn resistance(&self, i: usize, w: &Work) -> f64 {
        match self.stiction.parts[i] {
            Place::Pin(_) => w.torque[self.stiction.first + i].value,
            Place::Gear(gear) => w.mesh.loss[gear],
        }
    }

    /// Speed of what sticks, and the amounts below which it is zero: while it slides, and while it is stuck.
    fn slip(&self, i: usize, x: &[f64], s: &[f64]) -> (f64, f64, f64) {
        let (form, prescribed) = self.sticky(i);
        let v = &x[self.positions..self.positions + self.rotation.free];
        let mut speed = 0.0;
        let mut scale = 0.0;
        let own = form.terms().iter().map(|(k, factor)| factor * v[*k as usize]);
        let given = prescribed.terms().iter().filter_map(|(k, factor)| Some(factor * s.get(*k as usize)?));
        for term in own.chain(given) {
            speed += term;
            scale += f64::abs(term);
        }
        // The stabilisation of closed loops moves what stands by as much as it has drifted.
        let drift = if self.frames.loops.is_empty() { 0.0 } else { AT_REST };
        (speed, STANDS * scale + drift, DRIFT * scale + drift)
    }

    /// Modes that the speeds alone tell: at the start, and after impacts.
    pub(crate) fn follow_speeds(&self, x: &[f64], s: &[f64], d: &mut [f64]) {
        for i in 0..self.stiction.len() {
            let (speed, zero, _) = self.slip(i, x, s);
            if speed.abs() > zero {
                d[self.stiction.modes.start + i] = speed.signum();
            }
        }
    }

    /// The speed of what is stuck is zero, not nearly zero.
    pub(crate) fn still_pins(&self, c: &Context, w: &mut Work) {
        for (place, mode) in self.stiction.parts.iter().zip(self.stiction.of(c.d)) {
            if let (Place::Pin(pin), 0.0) = (place, mode) {
                w.pin_speed[*pin] = 0.0;
            }
        }
    }

    /// Torques of what slides.
    pub(crate) fn sliding_torques(&self, c: &Context, w: &mut Work) {
        if self.stiction.frictions == 0 {
            return;
        }
        let mut grip = std::mem::take(&mut w.grip);
        for seat in self.active.frictions.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                component.grips(&self.law(c, seat, w), &mut grip[seat.frictions.clone()]);
            }
        }
        let torques = w.torque[self.stiction.first..].iter_mut();
        for ((torque, grip), mode) in torques.zip(&grip).zip(self.stiction.of(c.d)) {
            *torque = match *mode {
                m if m > 0.0 => grip.slide[0],
                m if m < 0.0 => Torque { value: -grip.slide[1].value, slope: grip.slide[1].slope },
                _ => Torque::default(),
            };
        }
        w.grip = grip;
    }

    /// Constraints of what is stuck, behind those that are there.
    pub(crate) fn stuck_rows(&self, c: &Context, w: &mut Work) {
        w.first_stuck = w.rows.len();
        w.rows.yielding = w.first_stuck;
        w.stuck.clear();
        for (i, mode) in self.stiction.of(c.d).iter().enumerate() {
            if *mode == 0.0 {
                let (form, prescribed) = self.sticky(i);
                // What a mesh can hold is not known yet: brakes beside it come first.
                let weight = match self.stiction.parts[i] {
                    Place::Pin(_) => w.grip[i].hold[0].max(w.grip[i].hold[1]).clamp(1e-12, 1e12),
                    Place::Gear(_) => 1e-9,
                };
                form.add_to(1.0, w.rows.push(-prescribed.of(&w.ds), weight));
                w.stuck.push(i);
            }
            if i + 1 == self.stiction.frictions {
                w.rows.last = w.rows.len();
            }
        }
        if self.stiction.frictions == 0 {
            w.rows.last = w.first_stuck;
        }
        w.lock.prepare(&w.stuck, |i| self.sticky(i));
    }

    /// Torques of what is stuck, from the multipliers of its constraints.
    pub(crate) fn holding_torques(&self, w: &mut Work) {
        for (i, lambda) in w.stuck.iter().zip(&w.lambda[w.first_stuck..]) {
            match self.stiction.parts[*i] {
                Place::Pin(_) => w.torque[self.stiction.first + i].value = -lambda,
                Place::Gear(gear) => w.mesh.loss[gear] = -lambda,
            }
        }
    }

    /// Laws and directions of the meshes that stick.
    pub(crate) fn dry_meshes(&self, c: &Context, w: &mut Work) {
        if self.stiction.meshes() == 0 {
            return;
        }
        let first = self.stiction.frictions;
        let (mut dry, mut speed) = (std::mem::take(&mut w.dry), std::mem::take(&mut w.dry_speed));
        let modes = &self.stiction.of(c.d)[first..];
        for (k, (speed, mode)) in speed.iter_mut().zip(modes).enumerate() {
            *speed = mode * self.slip(first + k, c.x, &w.s).0;
        }
        for seat in self.active.dry.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                let range = seat.dry.clone();
                component.mesh_losses(&self.law(c, seat, w), &speed[range.clone()], &mut dry[range]);
            }
        }
        for ((place, law), mode) in self.stiction.parts[first..].iter().zip(&dry).zip(modes) {
            if let Place::Gear(gear) = place {
                w.mesh.dry[*gear] = (*law, *mode);
            }
        }
        (w.dry, w.dry_speed) = (dry, speed);
    }

    /// Constraint and index of each mesh that is stuck.
    pub(crate) fn stuck_meshes<'a>(&'a self, w: &'a Work) -> impl Iterator<Item = (usize, usize)> + 'a {
        let rows = w.stuck.iter().enumerate();
        rows.filter_map(move |(k, i)| match self.stiction.parts[*i] {
            Place::Gear(gear) => Some((w.first_stuck + k, gear)),
            Place::Pin(_) => None,
        })
    }

    /// What is stuck, by its constraint, and what its torque adds to that through a gear.
    pub(crate) fn stuck_shares<'a>(
        &'a self,
        gear: usize,
        w: &'a Work,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        let gear = &self.rotation.gears[gear];
        w.stuck.iter().enumerate().map(move |(k, i)| {
            let by = match self.stiction.parts[*i] {
                Place::Pin(_) => gear.by_torque.at(self.stiction.first + i),
                Place::Gear(other) => gear.by_loss[other],
            };
            (w.first_stuck + k, by)
        })
    }

    /// Finds the meshes that would lock themselves while they slide. Where the share of the loss is so large that no
    /// torque fits once the load overruns the base, the loss goes on from that while the base drives, up to the event
    /// at which the mesh jams.
    pub(crate) fn find_jams(&self, w: &mut Work) {
        let g = self.meshes.len();
        for (i, (law, sense)) in w.mesh.dry.iter_mut().enumerate() {
            w.may_jam[i] = *sense != 0.0 && w.coupling[i * g + i] * law.share[1] > STEEPEST;
            if w.may_jam[i] {
                law.share[1] = -law.share[0];
                law.bearing[1] = law.bearing[0];
            }
        }
    }

    /// What is to be said where no torques fit the laws and gears lock themselves: what drives them backward is the most
    /// likely cause.
    pub(crate) fn self_locking(&self, w: &Work) -> Option<String> {
        let locks = |gear: &usize| w.may_jam[*gear] || w.mesh.dry[*gear].0.share[1] >= 1.0;
        let path_of = |gear: usize| self.seats.iter().find(|seat| seat.gears.contains(&gear));
        let mut paths: Vec<String> = (0..self.meshes.len())
            .filter(locks)
            .filter_map(path_of)
            .map(|seat| format!("`{}`", seat.member.path))
            .collect();
        paths.dedup();
        (!paths.is_empty()).then(|| {
            format!(
                "a speed or a load behind {} drives it backward, but it locks itself and no torque turns it: drive it \
                 from its base, or let it give way by a softer coupling or an efficiency backward above 0",
                paths.join(" and ")
            )
        })
    }

    /// How far a mesh that slides is from jamming: the torque that passes, N*m.
    fn jam(&self, i: usize, mode: f64, w: &Work) -> f64 {
        match self.stiction.parts[i] {
            Place::Gear(gear) if w.may_jam[gear] => mode * w.mesh.torque[gear],
            _ => FAR,
        }
    }

    /// What the meshes hold, which depends on the torque that passes.
    pub(crate) fn mesh_grips(&self, w: &mut Work) {
        let first = self.stiction.frictions;
        for (k, (place, law)) in self.stiction.parts[first..].iter().zip(&w.dry).enumerate() {
            if let Place::Gear(gear) = place {
                let torque = w.mesh.torque[*gear];
                let [forward, backward] = [1.0, -1.0].map(|sense| law.loss(torque, sense).0.abs());
                w.grip[first + k] = Grip {
                    hold: [forward, backward],
                    slide: [forward, backward].map(|value| Torque { value, slope: 0.0 }),
                };
            }
        }
    }

    /// The constraint of a part that is stuck.
    fn row_of(&self, i: usize, w: &Work) -> Option<usize> {
        w.stuck.iter().position(|stuck| *stuck == i).map(|k| w.first_stuck + k)
    }

    /// What rounding makes of the torque of a part that is stuck, N*m: a part of what pulls at the network, as it reaches
    /// this part.
    fn noise(&self, i: usize, w: &Work) -> f64 {
        let scale = self.row_of(i, w).map_or(0.0, |row| w.schur.scale(row));
        if scale > 0.0 { ROUNDING * w.pull / scale } else { 0.0 }
    }

    /// What a part that is stuck could still bear in either direction, N*m: the guard and the verdict are the same number.
    fn reserve(&self, i: usize, hold: [f64; 2], w: &Work) -> [f64; 2] {
        let (torque, noise) = (self.resistance(i, w), self.noise(i, w));
        [(hold[0] - torque) + noise, (hold[1] + torque) + noise]
    }

    /// Acceleration of a part that counts as stuck but which nothing holds, because the loops move it: a slider at its dead
    /// centre. `None` where it can be held.
    fn escapes(&self, i: usize, hold: [f64; 2], w: &mut Work) -> Option<f64> {
        let row = self.row_of(i, w).filter(|row| w.schur.is_dependent(*row))?;
        w.product.copy_from_slice(&w.force);
        cholesky_solve(&w.factor, &mut w.product);
        let rows = &w.rows;
        w.schur.impose(rows, &mut w.product, |k| rows.b[k]);
        let acceleration = rows.of(row, &w.product) - rows.b[row];
        // So little moves a row that counts as dependent.
        let scale = w.schur.scale(row);
        let hold = hold[usize::from(acceleration < 0.0)];
        let held = DEPENDENT * scale * scale * hold + ROUNDING * scale * w.pull;
        (acceleration.abs() > held).then_some(acceleration)
    }

    /// Evaluates as if the loops had not drifted, and lets `then` read it: what closes the gaps that steps have left is no
    /// load on a friction. Without loops, `w` holds the evaluation at `c` already.
    fn without_drift<T>(&self, c: &Context, w: &mut Work, then: impl FnOnce(&mut Work) -> T) -> T {
        if self.frames.loops.is_empty() {
            return then(w);
        }
        w.loops.drifts = false;
        self.again(c, w);
        let result = then(w);
        w.loops.drifts = true;
        w.evaluation = [u64::MAX; 3];
        result
    }

    /// Distance from the end of each mode.
    pub(crate) fn stiction_guards(&self, c: &Context, w: &mut Work, g: &mut [f64]) {
        if !self.stiction.parts.is_empty() {
            self.without_drift(c, w, |w| self.distances(c, w, g));
        }
    }

    fn distances(&self, c: &Context, w: &Work, g: &mut [f64]) {
        let g = &mut g[self.stiction.guards.clone()];
        for (i, (g, mode)) in g.iter_mut().zip(self.stiction.of(c.d)).enumerate() {
            *g = if *mode == 0.0 {
                let [forward, backward] = self.reserve(i, w.grip[i].hold, w);
                forward.min(backward).min(FAR)
            } else {
                let (speed, zero, _) = self.slip(i, c.x, &w.s);
                (mode * speed + zero).min(self.jam(i, *mode, w))
            };
        }
    }

    /// Chooses all modes at a major step, when `w` holds the evaluation at `c`. Speeds that come to rest become zero
    /// by an impulse, which is of the size of the rounding if the crossing was located. Returns whether anything
    /// changed.
    pub(crate) fn choose_modes(&self, c: &Context, w: &mut Work, x: &mut [f64], d: &mut [f64]) -> bool {
        if self.stiction.parts.is_empty() {
            return false;
        }
        self.without_drift(c, w, |w| self.must_choose(c, w) && self.change_modes(c, w, x, d))
    }

    /// Chooses all modes, when `w` holds the evaluation at `c` and what is to be decided.
    fn change_modes(&self, c: &Context, w: &mut Work, x: &mut [f64], d: &mut [f64]) -> bool {
        let (mut at, mut modes) = (std::mem::take(&mut w.trial_x), std::mem::take(&mut w.trial_d));
        at.copy_from_slice(c.x);
        modes.copy_from_slice(c.d);
        let range = self.stiction.modes.clone();
        for (i, mode) in modes[range].iter_mut().enumerate() {
            *mode = match w.rests[i] {
                Rest::Moves(sign) => sign,
                Rest::Stands => 0.0,
                Rest::Free if *mode == 0.0 => 1.0,
                Rest::Free => *mode,
            };
        }
        self.again(&Context { x: &at, d: &modes, ..*c }, w);
        self.stop(w, &mut at);
        self.pivot(c, w, &at, &mut modes);

        // What slides on keeps its speed, unless that is on the wrong side of zero.
        let sliding = self.stiction.of(&modes).iter().enumerate();
        let mut wrong = sliding
            .filter(|(i, mode)| w.rests[*i] == Rest::Stands && **mode * self.slip(*i, c.x, &w.s).0 < 0.0);
        if wrong.next().is_none() {
            at.copy_from_slice(c.x);
            self.stop(w, &mut at);
        }
        let speeds = self.positions..self.positions + self.rotation.free;
        let changed = x[speeds.clone()] != at[speeds.clone()] || *d != *modes;
        x[speeds.clone()].copy_from_slice(&at[speeds]);
        d[self.stiction.modes.clone()].copy_from_slice(self.stiction.of(&modes));
        (w.trial_x, w.trial_d) = (at, modes);
        w.evaluation = [u64::MAX; 3];
        changed
    }

    /// Sorts the frictions by what is to be decided about them; returns whether a mode is wrong.
    fn must_choose(&self, c: &Context, w: &mut Work) -> bool {
        let mut wrong = false;
        for (i, mode) in self.stiction.of(c.d).iter().copied().enumerate() {
            let (speed, zero, drifted) = self.slip(i, c.x, &w.s);
            // A freewheel that is struck, a mesh that jams: they stop at once.
            let never = speed != 0.0 && w.grip[i].hold[usize::from(speed < 0.0)] == f64::INFINITY
                || self.jam(i, mode, w) < 0.0;
            let threshold = if mode == 0.0 { drifted } else { zero };
            let moves = speed.abs() > threshold && (mode == 0.0 || mode * speed > 0.0);
            w.rests[i] = if moves && !never {
                wrong |= mode == 0.0;
                Rest::Moves(speed.signum())
            } else {
                wrong |= moves || speed.abs() > threshold || self.verdict(i, mode, w, false).is_some();
                if self.is_free(i, w) { Rest::Free } else { Rest::Stands }
            };
        }
        wrong
    }

    /// Nothing holds it, or nothing would move if it were held.
    fn is_free(&self, i: usize, w: &Work) -> bool {
        let nothing_holds = match self.stiction.parts[i] {
            Place::Pin(_) => w.grip[i].hold == [0.0; 2],
            // Without a load it holds nothing, but the load may come.
            Place::Gear(_) => false,
        };
        nothing_holds || self.sticky(i).0.is_empty()
    }

    /// The mode that is to be tried instead of a wrong one, at rest; `None` if it is right. With `soft`, no more is
    /// held than slides.
    fn verdict(&self, i: usize, mode: f64, w: &mut Work, soft: bool) -> Option<f64> {
        let grip = w.grip[i];
        let mut hold = grip.hold;
        if soft {
            for (hold, slide) in hold.iter_mut().zip(&grip.slide).filter(|(hold, _)| hold.is_finite()) {
                *hold = hold.min(slide.value);
            }
        }
        let is_free = self.is_free(i, w);
        if mode == 0.0 {
            if is_free {
                return Some(1.0);
            }
            if let Some(acceleration) = self.escapes(i, hold, w) {
                return Some(acceleration.signum());
            }
            return match self.reserve(i, hold, w) {
                [forward, _] if forward < 0.0 => Some(1.0),
                [_, backward] if backward < 0.0 => Some(-1.0),
                _ => None,
            };
        }
        let side = usize::from(mode < 0.0);
        if grip.hold[side] == f64::INFINITY || self.jam(i, mode, w) < 0.0 {
            return Some(0.0);
        }
        let (form, prescribed) = self.sticky(i);
        let acceleration = mode * (form.of(&w.dv) + prescribed.of(&w.ds));
        if acceleration >= 0.0 {
            return None;
        }
        // D M^-1 D': what a torque of one does.
        w.product.fill(0.0);
        form.add_to(1.0, &mut w.product);
        cholesky_solve(&w.factor, &mut w.product);
        let largest = [hold[0], hold[1], grip.slide[side].value].into_iter().filter(|t| t.is_finite());
        let square = form.of(&w.product);
        let rounding = ROUNDING * (square * largest.fold(0.0, f64::max) + square.max(0.0).sqrt() * w.pull);
        match acceleration < -rounding {
            true if is_free => Some(-mode),
            true => Some(0.0),
            false => None,
        }
    }

    /// Evaluates at changed states and modes.
    fn again(&self, c: &Context, w: &mut Work) {
        w.evaluation = [u64::MAX; 3];
        self.motion_phase(c, w);
    }

    /// Takes speeds onto the constraints of the last evaluation by an impulse.
    fn stop(&self, w: &mut Work, x: &mut [f64]) {
        let v = &mut x[self.positions..self.positions + self.rotation.free];
        if w.rows.is_empty() {
            return;
        }
        let (first, stuck, s) = (w.first_stuck, &w.stuck, &w.s);
        w.schur.impose(&w.rows, v, |row| match row.checked_sub(first) {
            Some(k) => -self.sticky(stuck[k]).1.of(s),
            None => w.loops.target[row],
        });
        w.lock.settle(v, &w.s);
    }

    /// Least-index pivoting over what stands.
    fn pivot(&self, c: &Context, w: &mut Work, at: &[f64], modes: &mut [f64]) {
        let count = self.stiction.len();
        for soft in [false, true] {
            for _ in 0..10 + 10 * count * count {
                let now = Context { x: at, d: modes, ..*c };
                self.again(&now, w);
                let next = (0..count).find_map(|i| {
                    let mode = self.stiction.of(modes)[i];
                    let rests = !matches!(w.rests[i], Rest::Moves(_));
                    Some((i, self.verdict(i, mode, w, soft).filter(|_| rests)?))
                });
                match next {
                    None => return,
                    Some((i, mode)) => modes[self.stiction.modes.start + i] = mode,
                }
            }
        }
        c.fail(
            self.self_locking(w).unwrap_or_else(|| {
                "the dry frictions find no modes that agree: make one of them smooth".into()
            }),
        );
    }
}

/// What is to be decided about a friction at an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Rest {
    /// Nothing: it slides in this direction.
    Moves(f64),
    /// Whether it sticks, and which way it slides otherwise.
    Stands,
    /// Which way it slides; nothing holds it.
    Free,
}
