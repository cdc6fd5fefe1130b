//! Which modes follow at an event: a complementarity problem.
//!
//! What is stuck bears no more than it can hold, and what slides from rest accelerates the way it slides. It is solved by
//! least-index pivoting: every friction at rest begins stuck, and of those whose mode is wrong the first is changed, until
//! none is. For matrices that are positive definite this ends (K. G. Murty, Note on a Bard-type scheme for solving the
//! complementarity problem, Opsearch 11 (1974)). Where more is held at rest than while sliding, there may be several
//! solutions, and of these that one counts in which what has been stuck stays so: what has no choice is changed first (freewheels, stops),
//! then what slid until now, and what has broken loose is stuck again if it can be. Where pivoting goes round in circles, what is held
//! counts as what slides, which has one solution.
//!
//! A friction beside a mesh that stands does not slide, though its torque has reached what it holds: it bears that much, and the mesh
//! the rest (`torques.rs`).

use blocksim_block::Context;
use blocksim_block::physical::{Grip, Torque};

use super::parts::{Place, Rest, Sets};
use super::{OPEN, ROUNDING};
use crate::mechanics::loops::AT_REST;
use crate::mechanics::schur::DEPENDENT;
use crate::network::Network;
use crate::work::Work;

/// Most that the speeds of a network may change, as a multiple of the speed of a part that comes to rest.
const LEVER: f64 = 1e4;

/// The same up to which it makes no difference whether it is asked before or after the stop what is held.
const GENTLE: f64 = 100.0;

/// Part of an acceleration that a rigid part may miss where constraints depend on each other.
const MISSING: f64 = 1e-3;

/// A slip is zero up to this many times what the loops have drifted: one part may stand where others have to share its misfit.
const SLACK: f64 = 10.0;

impl Network {
    /// Chooses all modes at a major step, when `w` holds the evaluation at `c`. Speeds that come to rest become zero
    /// by an impulse, which is of the size of the rounding if the crossing was located. Returns whether anything
    /// changed.
    pub(crate) fn choose_modes(&self, c: &Context, w: &mut Work, x: &mut [f64], d: &mut [f64]) -> bool {
        if self.stiction.parts.is_empty() {
            return false;
        }
        self.without_drift(c, w, |w| self.must_choose(c, w) && self.change_modes(c, w, x, d))
    }

    /// Whether a mode is wrong; sorts the frictions by what is to be decided about them.
    fn must_choose(&self, c: &Context, w: &mut Work) -> bool {
        let mut wrong = false;
        w.struck = false;
        for (i, mode) in self.stiction.of(c.d).iter().copied().enumerate() {
            if self.is_open(i, w) {
                wrong |= mode != OPEN;
                w.rests[i] = Rest::Open;
                continue;
            }
            wrong |= mode == OPEN;
            let speed = self.slip(i, c.x, &w.s).0;
            // A freewheel that is struck, a mesh that jams: they stop at once.
            let never = speed != 0.0 && w.grip[i].hold[usize::from(speed < 0.0)] == f64::INFINITY
                || self.jam(i, mode, w) < 0.0;
            let threshold = self.stands_below(i, c, w);
            let may_move =
                if mode == 0.0 { self.is_thrown(i, c, w) } else { mode == OPEN || mode * speed > 0.0 };
            let moves = speed.abs() > threshold && may_move;
            w.struck |= never && speed.abs() > threshold;
            w.rests[i] = if moves && !never {
                wrong |= mode == 0.0;
                Rest::Moves(speed.signum())
            } else {
                wrong |= moves || speed.abs() > threshold || self.verdict(i, mode, w, false).is_some();
                self.stands(i, w)
            };
        }
        wrong
    }

    /// Most that a slip changes where the speeds are made to fit the closed loops, of which they are off by the error of the steps.
    fn loop_slack(&self, c: &Context, w: &mut Work) -> f64 {
        if self.frames.loops.is_empty() || w.rows.is_empty() {
            return 0.0;
        }
        let v = self.speeds(c);
        w.product.copy_from_slice(v);
        w.schur.impose_first(&w.rows, w.first_stuck, &mut w.product, |row| w.loops.target[row]);
        let changed = (0..self.stiction.len()).map(|i| {
            let form = self.sticky(i).0;
            (form.of(&w.product) - form.of(v)).abs()
        });
        changed.fold(0.0, f64::max)
    }

    /// Chooses all modes, when `w` holds the evaluation at `c` and what is to be decided.
    fn change_modes(&self, c: &Context, w: &mut Work, x: &mut [f64], d: &mut [f64]) -> bool {
        let (mut at, mut modes) = (std::mem::take(&mut w.trial_x), std::mem::take(&mut w.trial_d));
        at.copy_from_slice(c.x);
        modes.copy_from_slice(c.d);
        if w.struck {
            self.collide(c, w, &mut at, &mut modes);
        }
        let range = self.stiction.modes.clone();
        for (i, mode) in modes[range].iter_mut().enumerate() {
            *mode = match w.rests[i] {
                Rest::Moves(sign) => sign,
                Rest::Stands => 0.0,
                Rest::Open => OPEN,
                Rest::Free if *mode == 0.0 || *mode == OPEN => 1.0,
                Rest::Free => *mode,
            };
        }
        if self.rest_together(c, w, &at, &mut modes) {
            let fitting = std::mem::take(&mut w.fitting_x);
            self.pivot(c, w, &fitting, &mut modes);
            w.fitting_x = fitting;
        } else {
            self.pivot(c, w, &at, &mut modes);
        }
        self.come_to_rest(c, w, &mut at, &mut modes);

        let speeds = self.positions..self.positions + self.rotation.free;
        let changed = x[speeds.clone()] != at[speeds.clone()] || *d != *modes;
        x[speeds.clone()].copy_from_slice(&at[speeds]);
        d[self.stiction.modes.clone()].copy_from_slice(self.stiction.of(&modes));
        (w.trial_x, w.trial_d) = (at, modes);
        w.evaluation = [u64::MAX; 3];
        changed
    }

    /// Finds what comes to rest together through loops, and the states at rest, in `w.fitting_x`, for which it is decided what is held:
    /// speeds differ by what the loops have drifted, and the slightest motion has accelerations that constraints which depend on each
    /// other contradict. Returns whether there are such.
    fn rest_together(&self, c: &Context, w: &mut Work, at: &[f64], modes: &mut [f64]) -> bool {
        if self.frames.loops.is_empty() || !w.rests.contains(&Rest::Stands) {
            return false;
        }
        let slack = SLACK * self.loop_slack(c, w);
        let stands_almost = |i: usize, w: &Work| self.slip(i, c.x, &w.s).0.abs() <= slack;
        let range = self.stiction.modes.clone();
        w.kept.copy_from_slice(&modes[range.clone()]);
        for (i, mode) in modes[range.clone()].iter_mut().enumerate() {
            let rests =
                w.rests[i] == Rest::Stands || matches!(w.rests[i], Rest::Moves(_)) && stands_almost(i, w);
            *mode = if rests { 0.0 } else { *mode };
        }
        self.again(&Context { x: at, d: modes, ..*c }, w);
        let (blow, slip) = self.blow(at, w);
        if blow > slack.max(GENTLE * slip) {
            modes[range].copy_from_slice(&w.kept);
            return false;
        }
        let mut fitting = std::mem::take(&mut w.fitting_x);
        fitting.copy_from_slice(at);
        self.stop(w, &mut fitting);
        w.fitting_x = fitting;
        for (rest, mode) in w.rests.iter_mut().zip(&modes[range]) {
            if *mode == 0.0 && *rest != Rest::Free {
                *rest = Rest::Stands;
            }
        }
        true
    }

    /// Makes the speeds of what is stuck zero, and of what starts to slide where they are on the wrong side. They are
    /// zero already up to rounding where crossings are located, and up to a part of a step where they are not: no
    /// friction takes more than that from a motion in an instant.
    fn come_to_rest(&self, c: &Context, w: &mut Work, at: &mut [f64], modes: &mut [f64]) {
        let backward = |i: usize, mode: f64, w: &Work| {
            let (speed, zero, _) = self.slip(i, at, &w.s);
            let least = if self.frames.loops.is_empty() { 0.0 } else { zero };
            w.rests[i] == Rest::Stands && mode * speed < -least
        };
        let range = self.stiction.modes.clone();
        let sliding = self.stiction.of(modes).iter().enumerate();
        if sliding.clone().any(|(i, mode)| backward(i, *mode, w)) {
            w.kept.copy_from_slice(self.stiction.of(modes));
            for i in 0..self.stiction.len() {
                if backward(i, w.kept[i], w) {
                    modes[range.start + i] = 0.0;
                }
            }
            self.again(&Context { x: at, d: modes, ..*c }, w);
            let throws = self.throws(at, w);
            modes[range.clone()].copy_from_slice(&w.kept);
            if throws {
                // It goes on the way it went, and passes through zero when it gets there.
                for i in 0..self.stiction.len() {
                    if backward(i, w.kept[i], w) {
                        modes[range.start + i] = -w.kept[i];
                    }
                }
                self.again(&Context { x: at, d: modes, ..*c }, w);
            }
        }
        if self.throws(at, w) {
            // What has slid until now goes on, through zero.
            for i in 0..self.stiction.len() {
                let before = self.stiction.of(c.d)[i];
                if self.stiction.of(modes)[i] == 0.0 && before.abs() == 1.0 {
                    let (speed, zero, _) = self.slip(i, at, &w.s);
                    modes[range.start + i] = if before * speed > zero { before } else { -before };
                }
            }
            return self.again(&Context { x: at, d: modes, ..*c }, w);
        }
        // Where nothing is stuck nobody asks loops to fit better than they have done: that would move what is at zero just now.
        if !w.stuck.is_empty() {
            self.stop(w, at);
        }
    }

    /// Whether the speeds of what is stuck could only be made zero by a blow to all that moves: at a dead centre of a loop the
    /// slightest speed there belongs to any speed elsewhere, and no dry friction stops that. Where loops have drifted by the
    /// error of the steps, such a part may be on the wrong side of zero by as much.
    fn throws(&self, at: &[f64], w: &mut Work) -> bool {
        let (blow, slip) = self.blow(at, w);
        blow > LEVER * slip
    }

    /// Most that a speed changes where what is stuck is stopped, and the largest slip that ends by that.
    fn blow(&self, at: &[f64], w: &mut Work) -> (f64, f64) {
        if self.frames.loops.is_empty() || w.rows.is_empty() {
            return (0.0, AT_REST);
        }
        let speeds = self.positions..self.positions + self.rotation.free;
        let slip = w.stuck.iter().map(|i| self.slip(*i, at, &w.s).0.abs()).fold(AT_REST, f64::max);
        // What the loops have drifted is taken out first: that is no blow.
        let v = &mut w.fitting_x[speeds.clone()];
        v.copy_from_slice(&at[speeds]);
        let (rows, first, stuck, s) = (&w.rows, w.first_stuck, &w.stuck, &w.s);
        w.schur.impose_first(rows, first, v, |row| w.loops.target[row]);
        w.product.copy_from_slice(v);
        w.schur.impose(rows, &mut w.product, |row| match row.checked_sub(first) {
            Some(k) => -self.sticky(stuck[k]).1.of(s),
            None => w.loops.target[row],
        });
        let blow = w.product.iter().zip(&*v).fold(0.0_f64, |blow, (after, v)| blow.max((after - v).abs()));
        (blow, slip)
    }

    /// Takes speeds onto the constraints of the last evaluation by an impulse.
    pub(super) fn stop(&self, w: &mut Work, x: &mut [f64]) {
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
            self.first_modes(soft, false, c, w, at, modes);
            for _ in 0..10 + 10 * count * count {
                let now = Context { x: at, d: modes, ..*c };
                self.again(&now, w);
                match self.wrong(soft, c, w, modes) {
                    None => {
                        if self.contradicted(soft, w).is_some() {
                            self.try_rigid(soft, c, w, at, modes);
                        }
                        return self.hold_on(soft, c, w, at, modes);
                    }
                    Some((i, mode)) => modes[self.stiction.modes.start + i] = mode,
                }
            }
        }
        if self.meshes.is_empty() {
            // Pivoting turns in circles where values are zero to rounding. The bounded problem is convex while no more is
            // held than slides: its solution holds as it stands.
            self.first_modes(true, true, c, w, at, modes);
            return self.again(&Context { x: at, d: modes, ..*c }, w);
        }
        c.fail(
            self.self_locking(w).unwrap_or_else(|| {
                "the dry frictions find no modes that agree: make one of them smooth".into()
            }),
        );
    }

    /// The first part that is rigid and slides all the same, as others that are stuck ask for another motion: a prescribed speed that drives
    /// a freewheel into a stop.
    fn contradicted(&self, soft: bool, w: &mut Work) -> Option<usize> {
        if w.stuck.iter().all(|i| self.sticky(*i).1.is_empty()) || !w.schur.has_dependent_rows(&w.rows) {
            return None;
        }
        w.product.copy_from_slice(&w.force);
        self.envelope.solve(&w.factor, &mut w.product);
        let rows = &w.rows;
        w.schur.impose(rows, &mut w.product, |k| rows.b[k]);
        w.stuck.iter().enumerate().find_map(|(k, i)| {
            let row = w.first_stuck + k;
            let (is, asked) = (w.rows.of(row, &w.product), w.rows.b[row]);
            let missing = is - asked;
            let is_rigid = self.held(*i, soft, w)[usize::from(missing < 0.0)] == f64::INFINITY;
            (is_rigid && missing.abs() > MISSING * (is.abs() + asked.abs())).then_some(*i)
        })
    }

    /// Tries each set of the parts at rest that hold rigidly in one direction, until all modes are right; where none is, nothing can move as it
    /// has to.
    fn try_rigid(&self, soft: bool, c: &Context, w: &mut Work, at: &[f64], modes: &mut [f64]) {
        let (count, first) = (self.stiction.len(), self.stiction.modes.start);
        let gives_way = |i: usize, w: &Work| match self.held(i, soft, w) {
            _ if w.rests[i] != Rest::Stands => None,
            [f64::INFINITY, back] if back < f64::INFINITY => Some(-1.0),
            [forth, f64::INFINITY] if forth < f64::INFINITY => Some(1.0),
            _ => None,
        };
        let sets = Sets { parts: (0..count).filter(|i| gives_way(*i, w).is_some()).count() };
        for set in 0..sets.len() {
            let mut part = 0;
            for i in 0..count {
                if let Some(way) = gives_way(i, w) {
                    modes[first + i] = if sets.has(set, part) { 0.0 } else { way };
                    part += 1;
                }
            }
            self.again(&Context { x: at, d: modes, ..*c }, w);
            if self.wrong(soft, c, w, modes).is_none() && self.contradicted(soft, w).is_none() {
                return;
            }
        }
        for i in 0..count {
            if gives_way(i, w).is_some() {
                modes[first + i] = 0.0;
            }
        }
        self.again(&Context { x: at, d: modes, ..*c }, w);
        let is_rigid = |i: &usize| self.held(*i, soft, w).contains(&f64::INFINITY);
        let seat_of = |i: usize| self.seats.iter().find(|seat| seat.frictions.contains(&i));
        let mut rigid: Vec<String> = w
            .stuck
            .iter()
            .filter(|i| is_rigid(i))
            .filter_map(|i| seat_of(*i))
            .map(|seat| format!("`{}`", seat.member.path))
            .collect();
        rigid.dedup();
        c.fail(format!(
            "a prescribed speed drives parts against each other that do not give way ({}): no motion fits all of them; put a spring, a clutch \
             or a torque in the place of one",
            rigid.join(", ")
        ));
    }

    /// The first part at rest whose mode is wrong while `w` holds the evaluation with these, and the mode to be tried. What can push and not
    /// pull comes first, freewheels and stops: they have no choice. What slid before `c` comes before what was stuck.
    fn wrong(&self, soft: bool, c: &Context, w: &mut Work, modes: &[f64]) -> Option<(usize, f64)> {
        let rank = |i: usize, w: &Work| match w.grip[i].hold.contains(&f64::INFINITY) {
            true => 0,
            false if self.stiction.of(c.d)[i] != 0.0 => 1,
            false => 2,
        };
        let mut order = (0..3).flat_map(|of| (0..self.stiction.len()).map(move |i| (of, i)));
        order.find_map(|(of, i)| {
            if rank(i, w) != of {
                return None;
            }
            let mode = self.stiction.of(modes)[i];
            let rests = !matches!(w.rests[i], Rest::Moves(_) | Rest::Open);
            Some((i, self.verdict(i, mode, w, soft).filter(|_| rests)?))
        })
    }

    /// Sticks again, one by one, what was stuck before `c` and need not slide, while `w` holds the evaluation with modes that agree.
    fn hold_on(&self, soft: bool, c: &Context, w: &mut Work, at: &[f64], modes: &mut [f64]) {
        for i in 0..self.stiction.len() {
            let cell = self.stiction.modes.start + i;
            let (before, mode) = (self.stiction.of(c.d)[i], modes[cell]);
            if before != 0.0 || mode.abs() != 1.0 || w.rests[i] != Rest::Stands {
                continue;
            }
            modes[cell] = 0.0;
            self.again(&Context { x: at, d: modes, ..*c }, w);
            if self.wrong(soft, c, w, modes).is_some() || self.contradicted(soft, w).is_some() {
                modes[cell] = mode;
                self.again(&Context { x: at, d: modes, ..*c }, w);
            }
        }
    }

    /// Where pivoting begins: with everything at rest stuck, or where several frictions hold the same parts, which give
    /// no one solution one at a time, with the modes of the bounded problem; with `fit`, always with these.
    fn first_modes(&self, soft: bool, fit: bool, c: &Context, w: &mut Work, at: &[f64], modes: &mut [f64]) {
        for (mode, rest) in modes[self.stiction.modes.clone()].iter_mut().zip(&w.rests) {
            if *rest == Rest::Stands {
                *mode = 0.0;
            }
        }
        self.again(&Context { x: at, d: modes, ..*c }, w);
        if w.stuck.is_empty() || !self.meshes.is_empty() {
            return;
        }
        if fit || w.schur.has_dependent_rows(&w.rows) {
            self.fitting_modes(soft, w, modes);
        }
    }

    /// What is held in each direction; with `soft`, no more than slides.
    pub(super) fn held(&self, i: usize, soft: bool, w: &Work) -> [f64; 2] {
        let grip = w.grip[i];
        let mut hold = grip.hold;
        if soft {
            for (hold, slide) in hold.iter_mut().zip(&grip.slide).filter(|(hold, _)| hold.is_finite()) {
                *hold = hold.min(slide.value);
            }
        }
        hold
    }

    /// The mode that is to be tried instead of a wrong one, at rest; `None` if it is right. With `soft`, no more is
    /// held than slides.
    fn verdict(&self, i: usize, mode: f64, w: &mut Work, soft: bool) -> Option<f64> {
        let grip = w.grip[i];
        let hold = self.held(i, soft, w);
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
        let (form, prescribed) = self.sticky(i);
        if form.is_empty() && prescribed.is_empty() {
            // Between parts that turn as one nothing ever slips, and no mode is wrong.
            return None;
        }
        if grip.hold[side] == f64::INFINITY || self.jam(i, mode, w) < 0.0 {
            return Some(0.0);
        }
        let acceleration = mode * (form.of(&w.dv) + prescribed.of(&w.ds));
        if acceleration >= 0.0 {
            return None;
        }
        // D M^-1 D': what a torque of one does.
        w.product.fill(0.0);
        form.add_to(1.0, &mut w.product);
        self.envelope.solve(&w.factor, &mut w.product);
        let largest = [hold[0], hold[1], grip.slide[side].value].into_iter().filter(|t| t.is_finite());
        let square = form.of(&w.product);
        let rounding = ROUNDING * (square * largest.fold(0.0, f64::max) + square.max(0.0).sqrt() * w.pull);
        match acceleration < -rounding {
            true if is_free => Some(-mode),
            true => Some(0.0),
            false => None,
        }
    }

    /// What is to be decided about a part at rest.
    pub(super) fn stands(&self, i: usize, w: &Work) -> Rest {
        if self.is_free(i, w) { Rest::Free } else { Rest::Stands }
    }

    /// Whether nothing presses a friction: it neither holds anything nor brakes what slides, however fast.
    pub(super) fn is_open(&self, i: usize, w: &Work) -> bool {
        let Place::Pin(_) = self.stiction.parts[i] else { return false };
        let Grip { hold, slide, stop } = w.grip[i];
        stop.is_none() && hold == [0.0; 2] && slide == [Torque::default(); 2]
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

    /// Acceleration of a part that counts as stuck but which nothing holds, because the loops move it: a slider at its dead
    /// centre. `None` where it can be held.
    fn escapes(&self, i: usize, hold: [f64; 2], w: &mut Work) -> Option<f64> {
        let row = self.row_of(i, w).filter(|row| w.schur.is_dependent(*row))?;
        w.product.copy_from_slice(&w.force);
        self.envelope.solve(&w.factor, &mut w.product);
        let rows = &w.rows;
        w.schur.impose(rows, &mut w.product, |k| rows.b[k]);
        let acceleration = rows.of(row, &w.product) - rows.b[row];
        // So little moves a row that counts as dependent.
        let scale = w.schur.scale(row);
        let hold = hold[usize::from(acceleration < 0.0)];
        let held = DEPENDENT * scale * scale * hold + ROUNDING * scale * w.pull;
        (acceleration.abs() > held).then_some(acceleration)
    }
}
