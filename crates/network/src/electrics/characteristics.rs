//! Currents that follow from voltages by a law of their own: diodes, varistors, resistances that depend on their temperature.
//!
//! The current of a characteristic is `i = g v + z` with a conductance `g` that the solution of the circuit contains, so that
//! its node hangs together with the rest whatever the law says, and a given value `z`. All voltages are linear forms over the given
//! values, so the voltages `v` of the characteristics of a circuit satisfy
//!
//! ```text
//! v = C z + o,    z = f(v) - g v
//! ```
//!
//! where `o` is what sources, states and currents of windings give. Beside them stand the two given values of each transformer whose
//! ratio varies, which are linear. Newton's method with the exact slopes of the laws finds all of them together; a step is
//! halved until what is left of the equations decreases, and once more if that leaves less. It begins at the voltages of the last major step, which are
//! discrete states, and ends where what is left is rounding: an evaluation is a function of time, states and inputs, whatever was tried before.

use std::ops::Range;

use blocksim_block::Context;
use blocksim_block::physical::Characteristics;
use blocksim_solve::linear::{lu_factor, lu_solve};

use crate::assembly::domains::Nodal;
use crate::electrics::currents::Faulty;
use crate::network::Network;
use crate::work::Work;
use crate::work::circuits::CharacteristicRoom;

/// A step below this, relative to the voltages, is the last one: what is left then is its square.
const LAST: f64 = 1e-9;
/// A step below this, relative to the voltages, may be the last one where rounding hides whether it helps.
const ROUNDING: f64 = 1e-7;
/// Voltages count as this part of the largest one of the circuit at least.
const QUIET: f64 = 1e-6;
/// Steps of Newton's method, and halvings of one.
const STEPS: usize = 200;
const HALVINGS: usize = 60;
/// What is left of an equation below this part of its terms is rounding; and below that, where no step makes it less.
const ROUNDED: f64 = 8.0 * f64::EPSILON;
const NEARLY: f64 = 1e-12;
/// Terms of an equation count as this at least, V.
const NOTHING: f64 = 1e-290;
/// A step that leaves more than this part of what was left is compared with half of it.
const POOR: f64 = 0.5;
/// What is left must decrease by this part of what a step without curvature would take.
const DECREASE: f64 = 1e-4;

impl Network {
    /// Finds the given values of the characteristics and of the variable transformers of an island.
    pub(crate) fn solve_characteristics(
        &self,
        island: usize,
        c: &Context,
        w: &mut Work,
    ) -> Result<(), Faulty> {
        let mut room = std::mem::take(&mut w.characteristics);
        self.ratios(island, c, &mut room.ratio);
        self.equations(island, w, &mut room);
        let found = self.search(island, c, w, &mut room);
        if found.is_ok() {
            let circuit = &self.electrics.islands[island];
            let n = circuit.characteristics.len();
            for (k, (_, number)) in circuit.characteristics.iter().enumerate() {
                room.voltage[*number] = room.unknown[k];
                w.given[self.electrics.characteristics[*number].rest] = self.rest(*number, &room);
            }
            for (k, (_, number)) in circuit.transformers.iter().enumerate() {
                let transformer = &self.electrics.transformers[*number];
                w.given[transformer.voltage] = room.unknown[n + 2 * k];
                w.given[transformer.current] = room.unknown[n + 2 * k + 1];
            }
        }
        if let Err(why) = &found {
            c.fail(self.not_found(island, c.t, why, &room));
        }
        w.characteristics = room;
        found.map_err(|_| Faulty)
    }

    /// What the current of a characteristic is more than its conductance tells, at the voltage that was found.
    fn rest(&self, number: usize, room: &CharacteristicRoom) -> f64 {
        room.current[number] - self.electrics.characteristics[number].conductance * room.voltage[number]
    }

    /// Writes `C` and `o`.
    fn equations(&self, island: usize, w: &Work, room: &mut CharacteristicRoom) {
        let circuit = &self.electrics.islands[island];
        let (curves, all) = (circuit.characteristics.len(), self.unknowns(island));
        let solved = w.circuits[island].now();
        room.coupling[..all * all].fill(0.0);
        for k in 0..all {
            let (form, factor) = match k.checked_sub(curves) {
                None => (&solved.voltages[circuit.characteristics[k].0], 1.0),
                Some(k) => {
                    let (position, number) = circuit.transformers[k / 2];
                    let ratio = room.ratio[number];
                    match k % 2 {
                        0 => (&solved.voltages[position + 1], ratio),
                        _ => (&solved.currents[position], -ratio),
                    }
                }
            };
            let mut offset = 0.0;
            for (i, by) in form.terms() {
                match room.unknown_of[*i as usize] {
                    u32::MAX => offset += by * w.given[*i as usize],
                    unknown => room.coupling[k * all + unknown as usize] += factor * by,
                }
            }
            room.offset[k] = factor * offset;
        }
    }

    fn unknowns(&self, island: usize) -> usize {
        let circuit = &self.electrics.islands[island];
        circuit.characteristics.len() + 2 * circuit.transformers.len()
    }

    /// Finds voltages and what transformers give, and leaves them in `room.unknown`, and currents in `room.current`.
    fn search(
        &self,
        island: usize,
        c: &Context,
        w: &Work,
        room: &mut CharacteristicRoom,
    ) -> Result<(), NotFound> {
        room.outside = None;
        self.set_out(island, c, true, room);
        let mut found = self.newton(island, c, w, room);
        if matches!(found, Err(NotFound::NotFinite)) {
            // What was right before may be out of the question after a jump.
            self.set_out(island, c, false, room);
            found = self.newton(island, c, w, room);
        }
        for kept in [true, false] {
            if !matches!(found, Err(NotFound::Stuck | NotFound::TooLong)) {
                break;
            }
            self.set_out(island, c, kept, room);
            let other = self.newton_by_steps(island, c, w, room);
            if other.is_ok() {
                found = other;
            }
        }
        found
    }

    /// Puts the unknowns where a search begins: at the voltages that are kept, or at those of the laws.
    fn set_out(&self, island: usize, c: &Context, kept: bool, room: &mut CharacteristicRoom) {
        room.way.clear();
        room.unknown[..self.unknowns(island)].fill(0.0);
        for (k, (_, number)) in self.electrics.islands[island].characteristics.iter().enumerate() {
            let characteristic = &self.electrics.characteristics[*number];
            let guess = characteristic.guess.filter(|_| kept).and_then(|cell| c.d.get(cell)).copied();
            room.unknown[k] = guess.unwrap_or(characteristic.first_guess);
        }
    }

    /// Newton's method for equations whose residuals have very different slopes, as where two steep laws stand in series: there a valley
    /// of small residuals is followed in small steps, if not for ever. What is to become smaller here is the step that is left, by the slopes at the
    /// last point, in parts of the unknowns (the natural test of P. Deuflhard, Newton Methods for Nonlinear Problems, 3.3). Currents that have gone too far
    /// along an exponential come back by a fixed voltage in a step, so there may be more of them.
    fn newton_by_steps(
        &self,
        island: usize,
        c: &Context,
        w: &Work,
        room: &mut CharacteristicRoom,
    ) -> Result<(), NotFound> {
        let n = self.unknowns(island);
        room.trial[..n].copy_from_slice(&room.unknown[..n]);
        if !self.evaluate(island, c, w, room).is_finite() {
            return Err(NotFound::NotFinite);
        }
        let mut factor = 1.0_f64;
        for _ in 0..10 * STEPS {
            if room.noise <= ROUNDED {
                return Ok(());
            }
            room.note(n);
            self.jacobian(island, room);
            if lu_factor(&mut room.jacobian[..n * n], &mut room.pivots[..n]).is_err() {
                return Err(NotFound::Singular);
            }
            room.step[..n].copy_from_slice(&room.residual[..n]);
            lu_solve(&room.jacobian[..n * n], &room.pivots[..n], &mut room.step[..n]);
            let size = room.relative_step(n);
            room.measure(n);
            let length = room.length_left(n);
            factor = (4.0 * factor).min(1.0);
            loop {
                room.go(n, factor);
                let is_finite = self.evaluate(island, c, w, room).is_finite();
                if is_finite && (size <= LAST || room.noise <= ROUNDED) {
                    break;
                }
                if is_finite && room.length_left(n) <= (1.0 - 0.25 * factor) * length {
                    break;
                }
                factor *= 0.5;
                if factor < 1e-12 {
                    return Err(NotFound::Stuck);
                }
            }
            room.unknown[..n].copy_from_slice(&room.trial[..n]);
            if size <= LAST {
                return Ok(());
            }
        }
        if room.noise <= NEARLY { Ok(()) } else { Err(NotFound::TooLong) }
    }

    /// Newton's method in which the residuals become smaller.
    fn newton(
        &self,
        island: usize,
        c: &Context,
        w: &Work,
        room: &mut CharacteristicRoom,
    ) -> Result<(), NotFound> {
        let n = self.unknowns(island);
        room.trial[..n].copy_from_slice(&room.unknown[..n]);
        let mut left = self.evaluate(island, c, w, room);
        if !left.is_finite() {
            return Err(NotFound::NotFinite);
        }
        for _ in 0..STEPS {
            if room.noise <= ROUNDED {
                return Ok(());
            }
            room.note(n);
            self.jacobian(island, room);
            let pivots = &mut room.pivots[..n];
            if lu_factor(&mut room.jacobian[..n * n], pivots).is_err() {
                return Err(NotFound::Singular);
            }
            room.step[..n].copy_from_slice(&room.residual[..n]);
            lu_solve(&room.jacobian[..n * n], pivots, &mut room.step[..n]);
            let size = room.relative_step(n);
            let mut factor = 1.0;
            let mut accepted = false;
            for _ in 0..HALVINGS {
                room.go(n, factor);
                let trial = self.evaluate(island, c, w, room);
                let decreases = trial <= left * (1.0 - DECREASE * factor);
                if decreases && trial > POOR * left && size > ROUNDING {
                    // Where a current follows the root of a voltage, a step goes twice too far, and the next one back.
                    room.go(n, 0.5 * factor);
                    let half = self.evaluate(island, c, w, room);
                    if half < trial {
                        (left, accepted) = (half, true);
                        break;
                    }
                    room.go(n, factor);
                    (left, accepted) = (self.evaluate(island, c, w, room), true);
                    break;
                }
                if decreases || (size <= LAST || room.noise <= ROUNDED) && trial.is_finite() {
                    (left, accepted) = (trial, true);
                    break;
                }
                if size <= ROUNDING && trial.is_finite() {
                    // Rounding is all that is left.
                    (left, accepted) = (trial, true);
                    factor = 0.0;
                    break;
                }
                factor *= 0.5;
            }
            if !accepted {
                let (trial, at) = (&mut room.trial[..n], &room.unknown[..n]);
                trial.copy_from_slice(at);
                let left = self.evaluate(island, c, w, room);
                return if left.is_finite() && room.noise <= NEARLY { Ok(()) } else { Err(NotFound::Stuck) };
            }
            room.unknown[..n].copy_from_slice(&room.trial[..n]);
            if size <= LAST || factor == 0.0 {
                return Ok(());
            }
        }
        if room.noise <= NEARLY { Ok(()) } else { Err(NotFound::TooLong) }
    }

    /// Evaluates the laws at `room.trial`: fills currents, slopes and what is left of the equations, whose length it returns.
    fn evaluate(&self, island: usize, c: &Context, w: &Work, room: &mut CharacteristicRoom) -> f64 {
        let circuit = &self.electrics.islands[island];
        let (curves, n) = (circuit.characteristics.len(), self.unknowns(island));
        room.slopes[..n * n].fill(0.0);
        let mut first = 0;
        while first < curves {
            let (position, _) = circuit.characteristics[first];
            let seat = &self.seats[circuit.two_pins[position].member];
            let own: Range<usize> =
                self.electrics.places[circuit.two_pins[position].member].characteristics.clone();
            let m = own.len();
            room.slope.clear();
            room.slope.resize(m * m, 0.0);
            if let Some(component) = seat.component() {
                let voltage = &room.trial[first..first + m];
                let current = &mut room.current[own.clone()];
                let mut view = Characteristics::new(&seat.places, voltage, current, &mut room.slope);
                component.characteristics(&self.moving_law(c, seat, w), &mut view);
            }
            for (row, number) in own.clone().enumerate() {
                let conductance = self.electrics.characteristics[number].conductance;
                let at = (first + row) * n + first;
                room.slopes[at..at + m].copy_from_slice(&room.slope[row * m..(row + 1) * m]);
                room.slopes[at + row] -= conductance;
                room.terms[first + row] =
                    room.current[number].abs() + (conductance * room.trial[first + row]).abs();
                room.given[first + row] = room.current[number] - conductance * room.trial[first + row];
            }
            first += m;
        }
        for k in curves..n {
            room.slopes[k * n + k] = 1.0;
            room.given[k] = room.trial[k];
            room.terms[k] = room.trial[k].abs();
        }
        let mut sum = 0.0;
        room.noise = 0.0;
        for k in 0..n {
            let row = &room.coupling[k * n..(k + 1) * n];
            let by: f64 = row.iter().zip(&room.given).map(|(c, z)| c * z).sum();
            let left = room.trial[k] - by - room.offset[k];
            let terms: f64 = row.iter().zip(&room.terms).map(|(c, z)| c.abs() * z).sum();
            let size = room.trial[k].abs() + terms + room.offset[k].abs();
            room.noise = room.noise.max(left.abs() / (size + NOTHING));
            room.residual[k] = left;
            sum += left * left;
        }
        let has_no_value = |k: &usize| !room.current[circuit.characteristics[*k].1].is_finite();
        if let Some(k) = (0..curves).find(has_no_value) {
            room.outside = Some(k);
            room.tried[..n].copy_from_slice(&room.trial[..n]);
        }
        sum.sqrt()
    }

    /// `1 - C dz/dx`.
    fn jacobian(&self, island: usize, room: &mut CharacteristicRoom) {
        let n = self.unknowns(island);
        for row in 0..n {
            let to = &mut room.jacobian[row * n..(row + 1) * n];
            to.fill(0.0);
            to[row] = 1.0;
            for (k, by) in room.coupling[row * n..(row + 1) * n].iter().enumerate() {
                if *by != 0.0 {
                    let slopes = &room.slopes[k * n..(k + 1) * n];
                    to.iter_mut().zip(slopes).for_each(|(to, slope)| *to -= by * slope);
                }
            }
        }
    }

    /// Shows the currents of characteristics as their laws give them.
    pub(crate) fn show_characteristics(&self, island: usize, w: &mut Work) {
        for (_, number) in &self.electrics.islands[island].characteristics {
            let two_pin = self.electrics.characteristics[*number].two_pin;
            w.current[two_pin] = w.characteristics.current[*number];
        }
    }

    /// Keeps the voltages of this major step: the next search begins there.
    pub(crate) fn keep_guesses(&self, w: &Work, d: &mut [f64]) {
        for (characteristic, voltage) in self.electrics.characteristics.iter().zip(&w.characteristics.voltage)
        {
            if let Some(guess) = characteristic.guess.and_then(|cell| d.get_mut(cell)) {
                *guess = *voltage;
            }
        }
    }

    /// Where a law has no value that a search has come to the border of.
    fn border(&self, island: usize, room: &CharacteristicRoom) -> Option<String> {
        let circuit = &self.electrics.islands[island];
        let member = |k: usize| circuit.two_pins[circuit.characteristics[k].0].member;
        let outside = member(room.outside?);
        let own = (0..circuit.characteristics.len()).filter(|k| member(*k) == outside);
        let mut values = Vec::new();
        for k in own {
            let (tried, at) = (room.tried[k], room.unknown[k]);
            if (tried - at).abs() > NEAR * tried.abs().max(at.abs()) {
                return None;
            }
            let two_pin = &circuit.two_pins[circuit.characteristics[k].0];
            // What goes from absolute zero or the surroundings into a port is counted from there.
            let value = if two_pin.p.is_none() { -tried } else { tried };
            let value: f64 = format!("{value:.4e}").parse().unwrap_or(value);
            values.push(format!("{value} {}", Nodal::of(two_pin.domain).unit));
        }
        let path = &self.seats[outside].member.path;
        Some(format!("the law of `{path}` has no value at {}", values.join(", ")))
    }

    fn not_found(&self, island: usize, t: f64, why: &NotFound, room: &CharacteristicRoom) -> String {
        let has_searched = matches!(why, NotFound::Stuck | NotFound::TooLong);
        if let Some(border) = self.border(island, room).filter(|_| has_searched) {
            return format!(
                "at {t} s no operating point was found: {border}, to which the search has come; check its parameters, and \
                 whether a quantity is larger than the law is made for"
            );
        }
        let circuit = &self.electrics.islands[island];
        let n = self.unknowns(island);
        let worst = (0..circuit.characteristics.len())
            .max_by(|a, b| room.residual[*a].abs().total_cmp(&room.residual[*b].abs()))
            .unwrap_or(0);
        let (position, _) = circuit.characteristics[worst];
        let words = Nodal::of(circuit.two_pins[position].domain);
        let path = &self.seats[circuit.two_pins[position].member].member.path;
        let steps = room.way.len() / n.max(1);
        let shown = steps.saturating_sub(SHOWN)..steps;
        let way: Vec<String> = shown.map(|step| format!("{:.4e}", room.way[step * n + worst])).collect();
        let Nodal { across, through, unit, beside, .. } = words;
        let (why, beside) = match why {
            NotFound::NotFinite => (
                format!("its {through} is not a finite number where the search starts"),
                "take a shorter step where a method of fixed step lets states of the circuit grow without bound",
            ),
            NotFound::Singular => {
                ("nothing determines it: the slopes of the circuit are singular".to_owned(), beside)
            }
            NotFound::Stuck => ("no step brings it closer to a solution".to_owned(), beside),
            NotFound::TooLong => ("the search does not end".to_owned(), beside),
        };
        let went = if way.is_empty() {
            String::new()
        } else {
            format!(" (the {across} went {} {unit})", way.join(", "))
        };
        format!(
            "at {t} s no operating point was found for `{path}` in its circuit: {why}{went}; check its parameters and \
             the sources, or {beside}"
        )
    }
}

/// How near to where a law has no value a search comes that is kept from going on by that.
const NEAR: f64 = 1e-2;
/// Iterates that a message shows.
const SHOWN: usize = 6;

/// Why the search has ended without voltages.
enum NotFound {
    NotFinite,
    Singular,
    Stuck,
    TooLong,
}

impl CharacteristicRoom {
    /// Puts the trial at this part of the step.
    fn go(&mut self, n: usize, factor: f64) {
        for ((trial, at), step) in self.trial.iter_mut().zip(&self.unknown).zip(&self.step).take(n) {
            *trial = at - factor * step;
        }
    }

    /// Takes the sizes of the unknowns at both ends of a whole step for units.
    fn measure(&mut self, n: usize) {
        let largest = self.unknown[..n]
            .iter()
            .zip(&self.step)
            .fold(0.0_f64, |most, (x, step)| most.max(x.abs()).max((x - step).abs()));
        for ((unit, x), step) in self.units.iter_mut().zip(&self.unknown).zip(&self.step).take(n) {
            *unit = x.abs().max((x - step).abs()).max(QUIET * largest).max(NOTHING);
        }
    }

    /// The length of the step that the residuals at hand ask for by the slopes that are factorised, in these units.
    fn length_left(&mut self, n: usize) -> f64 {
        let left = &mut self.left_step[..n];
        left.copy_from_slice(&self.residual[..n]);
        lu_solve(&self.jacobian[..n * n], &self.pivots[..n], left);
        left.iter().zip(&self.units).map(|(step, unit)| (step / unit).powi(2)).sum::<f64>().sqrt()
    }

    /// Notes where the search is; the oldest notes go first.
    fn note(&mut self, n: usize) {
        if self.way.len() >= SHOWN * n {
            self.way.drain(..n);
        }
        self.way.extend_from_slice(&self.unknown[..n]);
    }

    /// The step relative to the unknowns.
    fn relative_step(&self, n: usize) -> f64 {
        let largest = self.unknown[..n].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let sizes = self.unknown.iter().zip(&self.step).take(n).map(|(x, step)| {
            let size = x.abs().max((x - step).abs()).max(QUIET * largest);
            if *step == 0.0 { 0.0 } else { step.abs() / size }
        });
        sizes.fold(0.0, f64::max)
    }
}
