//! Where a valve is on the edge, what comes next decides: its margin a little later, on the tangent of the states, while
//! inputs stay as they are.
//!
//! How much later follows from the circuit itself: until its voltages and currents have changed by a small part, which is
//! far more than rounding and far less than what bends them.

use blocksim_block::Context;

use crate::electrics::Conducting;
use crate::electrics::commutation::Wrong;
use crate::electrics::currents::Faulty;
use crate::network::Network;
use crate::work::Work;

/// By which part of their size voltages and currents change until it is looked again.
const CHANGE: f64 = 1e-5;
/// Changes of a margin below this, relative to the size of the circuit, are rounding.
const ROUNDING: f64 = 1e-13;
/// First guess of the time until then, s.
const GUESS: f64 = 1e-3;
/// Times that it is guessed.
const GUESSES: usize = 4;
/// What part of a time so far ahead that the circuit has no operating point there is looked at instead, and how often.
const NEARER: f64 = 1e-2;
const RETREATS: usize = 6;
/// What is small against what the circuit has had before is looked at as if it were this part of it.
const QUIET: f64 = 1e-4;

/// Room to look a little ahead.
#[derive(Debug, Default)]
pub(crate) struct Ahead {
    /// Derivatives of the states, and states a little later.
    pub rates: Vec<f64>,
    pub x: Vec<f64>,
    /// Given values and margins before.
    pub given: Vec<f64>,
    pub margins: Vec<f64>,
}

impl Ahead {
    pub(crate) fn new(network: &Network) -> Self {
        let valves = network.electrics.islands.iter().map(|island| island.valves.len()).max().unwrap_or(0);
        if valves == 0 {
            return Self::default();
        }
        Self {
            rates: vec![0.0; network.interface.states.len()],
            x: vec![0.0; network.interface.states.len()],
            given: vec![0.0; network.electrics.given()],
            margins: vec![0.0; valves],
        }
    }
}

impl Network {
    /// A valve on the edge that will be on the wrong side of it: that which goes there fastest. The island is evaluated
    /// and nothing contradicts.
    pub(crate) fn drifting(
        &self,
        island: usize,
        c: &Context,
        w: &mut Work,
        conducting: Conducting,
    ) -> Result<Wrong, Faulty> {
        let valves = self.electrics.islands[island].valves.len();
        let on = |bit: usize| conducting >> bit & 1 == 1;
        let size = self.size_with(island, c.d, w);
        let mut open: Conducting = 0;
        for bit in (0..valves).filter(|bit| w.drifted[island].1 >> bit & 1 == 0) {
            let edge = self.margin(island, bit, on(bit), size, w).is_some_and(|margin| margin.is_open());
            if edge && self.can_move(island, bit, on(bit), w) {
                open |= 1 << bit;
            }
        }
        if open == 0 {
            return Ok(Wrong::Nothing);
        }
        let mut ahead = std::mem::take(&mut w.ahead);
        let looked = self.look_ahead(island, c, w, &mut ahead, size, conducting);
        let mut worst = (0.0, Wrong::Nothing);
        if looked.is_ok() {
            let size = self.size_with(island, c.d, w);
            for bit in (0..valves).filter(|bit| open >> bit & 1 == 1) {
                let Some(margin) = self.margin(island, bit, on(bit), size, w) else { continue };
                let change = (margin.value - ahead.margins[bit]) / margin.scale;
                if change < -ROUNDING && change < worst.0 {
                    worst = (change, Wrong::Drifts(bit));
                }
            }
        }
        w.ahead = ahead;
        looked?;
        self.circuit(island, c, w)?;
        Ok(worst.1)
    }

    /// Whether the voltage of a valve that blocks follows from anything.
    fn can_move(&self, island: usize, bit: usize, on: bool, w: &Work) -> bool {
        let circuit = &self.electrics.islands[island];
        let two_pin = self.electrics.valves[circuit.valves[bit]].two_pin;
        let solved = w.circuits[island].now();
        let Some(position) = circuit.two_pins.iter().position(|pin| pin.index == two_pin) else {
            return false;
        };
        on || !solved.voltages[position].is_empty() || solved.floating.is_some()
    }

    /// Evaluates the island a little later, after the margins now have been noted.
    fn look_ahead(
        &self,
        island: usize,
        c: &Context,
        w: &mut Work,
        ahead: &mut Ahead,
        size: [f64; 2],
        conducting: Conducting,
    ) -> Result<(), Faulty> {
        let circuit = &self.electrics.islands[island];
        for bit in 0..circuit.valves.len() {
            let margin = self.margin(island, bit, conducting >> bit & 1 == 1, size, w);
            ahead.margins[bit] = margin.map_or(0.0, |margin| margin.value);
        }
        ahead.given.copy_from_slice(&w.given);
        let seats = || circuit.members.iter().map(|i| &self.seats[*i]).filter(|seat| !seat.x.is_empty());
        for seat in seats() {
            if let Some(component) = seat.component() {
                component.derivatives(&self.flowing_law(c, seat, w), &mut ahead.rates[seat.x.clone()]);
            }
        }
        for shift in &circuit.shifts {
            ahead.rates[self.seats[shift.member].x.start + shift.state] -= self.shift_rate(shift, w);
        }
        let mut later = GUESS;
        let (mut guesses, mut retreats) = (GUESSES, RETREATS);
        while guesses > 0 {
            ahead.x.copy_from_slice(c.x);
            for i in seats().flat_map(|seat| seat.x.clone()) {
                ahead.x[i] += later * ahead.rates[i];
            }
            let here = Context { t: c.t + later, x: &ahead.x, ..*c };
            let is_sound = !c.fault.is_raised();
            match self.circuit(island, &here, w) {
                Ok(()) => guesses -= 1,
                // The states will not come there: this is no fault of the circuit now.
                Err(_) if is_sound && retreats > 0 => {
                    c.fault.take();
                    retreats -= 1;
                    later *= NEARER;
                    continue;
                }
                Err(fault) => return Err(fault),
            }
            let change = self.change(island, w, &ahead.given, size);
            if change <= 2.0 * CHANGE || !change.is_finite() {
                break;
            }
            later *= CHANGE / change;
        }
        Ok(())
    }

    /// By which part the given values of an island have changed, against their size now and a little of their size so far.
    fn change(&self, island: usize, w: &Work, before: &[f64], size: [f64; 2]) -> f64 {
        let (mut changed, mut largest) = ([0.0_f64; 2], size.map(|size| QUIET * size));
        let mut look = |kind: usize, i: usize| {
            changed[kind] = changed[kind].max((w.given[i] - before[i]).abs());
            largest[kind] = largest[kind].max(w.given[i].abs()).max(before[i].abs());
        };
        for seat in self.electrics.islands[island].members.iter().map(|i| &self.seats[*i]) {
            seat.sources.clone().for_each(|i| look(0, i));
            seat.windings.clone().for_each(|i| look(1, self.electrics.sources + i));
        }
        (0..2).map(|kind| changed[kind] / largest[kind].max(f64::MIN_POSITIVE)).fold(0.0, f64::max)
    }
}
