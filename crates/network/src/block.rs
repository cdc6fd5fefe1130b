//! A network as a block.

use blocksim_block::physical::Component;
use blocksim_block::problem::Problem;
use blocksim_block::{Block, Context, Given, Interface, InterfaceError, Invariant, Scratch};

use crate::network::Network;
use crate::seat::{CHARGE, ELECTRICS, MOTION, STATE};
use crate::work::Work;

impl Block for Network {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(self.interface.clone())
    }

    fn scratch(&self) -> Scratch {
        Scratch::new(Work::new(self))
    }

    fn initialize(&self, c: &Context, x: &mut [f64], d: &mut [f64]) {
        self.follow_speeds(x, d);
        self.turn_machines(c, x, d);
    }

    fn outputs(&self, group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let Some(w) = w.get::<Work>() else { return };
        match group {
            STATE | CHARGE => self.state_phase(c, w),
            ELECTRICS => self.electrics_phase(c, w),
            _ => {
                self.motion_phase(c, w);
                self.inner_torques(w);
                if self.active.accelerations {
                    self.frame_accelerations(self.positions(c), w);
                }
            }
        }
        if matches!(group, ELECTRICS | MOTION) {
            self.held_circuits(c, w);
        }
        self.show(group, c, w, y);
        for seat in self.active.measures[group].iter().map(|i| &self.seats[*i]) {
            if let (ELECTRICS, Some(held)) = (group, &seat.held) {
                let mut instant = std::mem::take(&mut w.instant);
                self.measure_mean(c, (seat, held), w, &mut instant, &mut y[seat.y.clone()]);
                w.instant = instant;
            } else {
                self.measure(c, seat, group, w, &mut y[seat.y.clone()]);
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
        if c.d[self.seeks] > 0.0 {
            self.keep_length(self.positions(c), &mut dx[..self.positions]);
        }
        dx[self.positions..self.positions + self.rotation.free].copy_from_slice(&w.dv);
        for seat in self.active.states.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                component.derivatives(&self.flowing_law(c, seat, w), &mut dx[seat.x.clone()]);
            }
        }
        for shift in self.electrics.islands.iter().flat_map(|island| &island.shifts) {
            let seat = &self.seats[shift.member];
            if seat.held.is_none() {
                dx[seat.x.start + shift.state] -= self.shift_rate(shift, w);
            }
        }
        self.account_rates(c, w, dx);
    }

    fn guards(&self, c: &Context, w: &mut Scratch, g: &mut [f64]) {
        let Some(w) = w.get::<Work>() else { return };
        if self.active.guards_of_state && self.stiction.len() == 0 && self.natural.is_empty() {
            // Torques and accelerations would cost more than all else at the end of a step.
            self.state_phase(c, w);
            for seat in self.active.guards.iter().map(|i| &self.seats[*i]) {
                if let Some(component) = seat.component() {
                    component.guards_of_state(&self.moving_law(c, seat, w), &mut g[seat.g.clone()]);
                }
            }
            return;
        }
        self.motion_phase(c, w);
        for seat in self.active.guards.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                let g = &mut g[seat.g.clone()];
                if seat.member.part.guards_of_state {
                    component.guards_of_state(&self.moving_law(c, seat, w), g);
                } else {
                    component.guards(&self.flowing_law(c, seat, w), g);
                }
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
        self.note_late(&here, w);
        let booked = self.before_jump(&here, w, x, d);
        let met = self.loops_meet_sources() && self.meet_loops(&here, w, x);
        if met {
            self.slide_on(&here, w, x, d);
        }
        let mut jumped = met;
        for seat in self.active.jumps.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                let (x, d) = (&mut x[seat.x.clone()], &mut d[seat.d.clone()]);
                jumped |= component.jump(&self.flowing_law(&here, seat, w), x, d);
            }
        }
        if !jumped {
            jumped = self.choose_modes(&here, w, x, d);
            if !self.stiction.sources.is_empty() {
                // What has jumped until now has been heard.
                d[self.stiction.sources.clone()][..w.s.len()].copy_from_slice(&w.s);
            }
        }
        self.strike_circuits(c, &before, x, d);
        (w.before, w.modes) = (before, modes);
        let here = Context { x: &[], d: &[], ..*c };
        for island in &self.active.valves {
            let gated = self.take_gates(*island, &Context { x: &*x, ..here }, w, d);
            jumped |= gated;
            jumped |= self.commutate(*island, (jumped, gated), &here, w, x, d);
        }
        self.keep_guesses(w, d);
        self.after_jump(&here, jumped, w, x, d);
        jumped |= booked;
        if jumped {
            // What is in the working space belongs to the states before.
            w.evaluation = [u64::MAX; 3];
        }
        jumped
    }

    fn accept(&self, c: &Context, d: &mut [f64]) -> bool {
        self.note_prescribed_speeds(c, d);
        self.note_inputs(c, d);
        false
    }

    fn update(&self, c: &Context, w: &mut Scratch, d: &mut [f64]) {
        if let Some(w) = w.get::<Work>() {
            self.couple(c, w, d);
        }
    }

    fn next_update(&self, c: &Context) -> f64 {
        self.next_part(c)
    }

    fn seek_rest(&self, begins: bool, x: &mut [f64], d: &mut [f64]) {
        d[self.seeks] = f64::from(u8::from(begins));
        self.close_accounts(x, d);
    }

    fn fit(&self, c: &Context, w: &mut Scratch, x: &mut [f64]) -> Option<String> {
        let w = w.get::<Work>()?;
        let mut differs = self.close_at_rest(c, w, x);
        for seat in self.active.states.iter().map(|i| &self.seats[*i]) {
            let elsewhere = |component: &dyn Component| {
                component.fit(&self.flowing_law(c, seat, w), &mut x[seat.x.clone()])
            };
            if let Some(what) = seat.component().and_then(elsewhere) {
                differs.get_or_insert_with(|| format!("`{}` {what}", seat.member.path));
            }
        }
        self.fit_at_rest(c, w, x).or(differs)
    }

    fn invariants(&self, c: &Context, w: &mut Scratch) -> Vec<Invariant> {
        w.get::<Work>().map_or_else(Vec::new, |w| self.all_invariants(c, w))
    }

    fn interrupt(&self, c: &Context, d: &mut [f64]) {
        self.note_inputs(c, d);
        self.separate.iter().for_each(|separate| d[separate.cells().interrupted] = 1.0);
    }

    fn tolerate(&self, rtol: f64, d: &mut [f64]) {
        self.separate.iter().for_each(|separate| d[separate.cells().rtol] = rtol);
    }

    fn warnings(&self, d: &[f64], rtol: f64) -> Vec<Problem> {
        self.coupling_warnings(d, rtol)
    }

    fn lateness(&self, c: &Context, w: &mut Scratch) -> Option<(f64, f64, &str)> {
        self.late_valve(c, w.get::<Work>()?)
    }

    fn next_event(&self, c: &Context) -> f64 {
        let seats = self.active.time_events.iter().map(|i| &self.seats[*i]);
        let times = seats.filter_map(|seat| Some(seat.component()?.next_event(&self.known_law(c, seat))));
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
