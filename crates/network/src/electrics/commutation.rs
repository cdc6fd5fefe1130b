//! Which valves conduct after something has changed.
//!
//! A valve that conducts by itself does so as long as its current is positive, and begins when its voltage exceeds the
//! forward voltage. After a gate, a source or another valve has changed, one valve after the other is set right, that
//! with the greatest contradiction first, until none contradicts. A contact that opens may leave the current of an
//! inductance without a path: then the volt-seconds of the arc that this would mean tell which valves take the current
//! over; where none can, the simulation ends with an error.

use blocksim_block::Context;
use blocksim_block::physical::ValveKind;

use crate::electrics::{Conducting, Unsolvable};
use crate::network::Network;
use crate::problem::NetworkProblem;
use crate::work::Work;

/// Currents and voltages below this, relative to the largest of the circuit, are rounding.
const ROUNDING: f64 = 1e-9;

/// Currents below this, relative to the largest of the circuit, are what the location of an event leaves over.
const REMAINDER: f64 = 1e-6;

/// Time in which an event cannot be told from another, s, relative to the time of the simulation if that is larger than 1 s.
const INSTANT: f64 = 1e-9;

/// What is wrong with the set of conducting valves.
enum Wrong {
    Nothing,
    /// This valve of the island must change; the current against it that it had while it conducted.
    Valve(usize, f64),
    /// Currents of inductances have no path, and no valve can take them over.
    Arc,
    /// A small current has no path any more: an event was a little late.
    Remainder,
}

impl Network {
    /// Sets the valves of an island right. Returns whether any of them, or a state, changed.
    pub(crate) fn commutate(
        &self,
        island: usize,
        c: &Context,
        w: &mut Work,
        x: &mut [f64],
        d: &mut [f64],
    ) -> bool {
        let circuit = &self.electrics.islands[island];
        if !circuit.valves.iter().any(|valve| self.is_natural(*valve)) && !circuit.has_windings {
            return false;
        }
        let mut changed = false;
        // A jump repeats its instant until nothing changes: what rounding says of valves that have changed at this
        // instant must not change them back.
        if w.commutated[island].0 != c.t {
            w.commutated[island] = (c.t, 0);
        }
        // Currents at which valves have been let go of because they were negative.
        let mut late = 0.0;
        let most = 8 * circuit.valves.len() + 8;
        for round in 0..most {
            let here = Context { x: &*x, d: &*d, ..*c };
            let wrong = match self.contradiction(island, &here, w, late, round > most / 2) {
                Ok(wrong) => wrong,
                Err(_) => return false,
            };
            match wrong {
                Wrong::Nothing => return changed,
                Wrong::Valve(bit, against) => {
                    late += against;
                    let latch = &mut d[self.first_latch + circuit.valves[bit]];
                    *latch = 1.0 - *latch;
                    w.commutated[island].1 |= 1 << bit;
                    changed = true;
                }
                Wrong::Remainder => {
                    let before = x.to_vec();
                    let here = Context { x: &before, d: &*d, ..*c };
                    self.strike(island, &here, w, x);
                    changed = true;
                }
                Wrong::Arc => {
                    c.fail(self.arc(island, &here, w));
                    return false;
                }
            }
        }
        c.fail(format!(
            "no set of conducting valves fits the circuit of `{}`: is a resistance missing?",
            self.seats[circuit.members[0]].member.path
        ));
        false
    }

    fn is_natural(&self, valve: usize) -> bool {
        self.electrics.valves[valve].kind != ValveKind::Switch
    }

    /// Evaluates an island and finds what is wrong with its valves. `any` takes the first contradiction instead of
    /// the greatest, so that no cycle can arise.
    fn contradiction(
        &self,
        island: usize,
        c: &Context,
        w: &mut Work,
        late: f64,
        any: bool,
    ) -> Result<Wrong, crate::electrics::currents::Faulty> {
        let conducting = self.conducting(island, c, w);
        if let Err(Unsolvable::Loop(two_pins)) = self.choose(island, conducting, w) {
            // A loop of ideal voltages: the first of those that conduct by themselves lets go.
            let two_pins: Vec<usize> =
                two_pins.iter().map(|i| self.electrics.islands[island].two_pins[*i].index).collect();
            let natural = conducting & self.natural_of(island);
            let in_loop = |bit: &usize| {
                let valve = self.electrics.islands[island].valves[*bit];
                natural >> bit & 1 == 1 && two_pins.contains(&self.electrics.valves[valve].two_pin)
            };
            let bits = 0..self.electrics.islands[island].valves.len();
            if let Some(bit) = bits.clone().find(in_loop) {
                return Ok(Wrong::Valve(bit, 0.0));
            }
        }
        self.circuit(island, c, w)?;
        let circuit = &self.electrics.islands[island];
        let largest =
            |values: &[f64]| circuit.two_pins.iter().fold(0.0, |m: f64, p| m.max(values[p.index].abs()));
        let (most_v, most_i) = (largest(&w.voltage), largest(&w.current));
        let lost = self.lost(island, w);
        // Where all currents have ended, the largest so far tells what rounding has left of them.
        let so_far = w.most_current[island].max(most_i);
        w.most_current[island] = so_far;
        if lost <= 1e-14 * so_far {
            return Ok(self.worst(island, w, conducting, any, most_v, so_far));
        }
        let arc = self.takes_over(island, c, w, conducting);
        // Volt-seconds that the voltages of the circuit have in a time that an event cannot be located in.
        let most_arc = circuit.two_pins.iter().fold(0.0, |m: f64, p| m.max(w.voltage[p.index].abs()));
        if most_arc <= most_v * INSTANT * c.t.abs().max(1.0) || lost <= REMAINDER * most_i {
            return Ok(Wrong::Remainder);
        }
        Ok(match arc {
            // Where steps end behind the zero of a current, what is left of it ends with them.
            Wrong::Arc if lost <= late * (1.0 + 1e-6) => Wrong::Remainder,
            arc => arc,
        })
    }

    /// The valve whose voltage or current contradicts most what it does.
    fn worst(
        &self,
        island: usize,
        w: &Work,
        conducting: Conducting,
        any: bool,
        most_v: f64,
        most_i: f64,
    ) -> Wrong {
        let changed = w.commutated[island].1;
        let mut worst = (0.0, Wrong::Nothing);
        for (bit, index) in self.electrics.islands[island].valves.iter().enumerate() {
            let valve = &self.electrics.valves[*index];
            let on = conducting >> bit & 1 == 1;
            let may = match valve.kind {
                ValveKind::Switch => false,
                ValveKind::Diode => true,
                ValveKind::GatedDiode => w.gates[*index],
                ValveKind::Thyristor => on || w.gates[*index],
            };
            if !may {
                continue;
            }
            let (v, i) = (w.voltage[valve.two_pin], w.current[valve.two_pin]);
            let (against, scale) = if on { (-i, most_i) } else { (v - valve.forward_voltage, most_v) };
            let least = if changed >> bit & 1 == 1 { ROUNDING * scale } else { 0.0 };
            if against > least {
                let size = against / scale.max(f64::MIN_POSITIVE);
                let found = Wrong::Valve(bit, if on { against } else { 0.0 });
                if any {
                    return found;
                }
                if size > worst.0 {
                    worst = (size, found);
                }
            }
        }
        worst.1
    }

    /// Largest current that enters a floating part and does not leave it, A.
    fn lost(&self, island: usize, w: &Work) -> f64 {
        let Some(floating) = &w.circuits[island].now().floating else { return 0.0 };
        floating
            .leaving
            .iter()
            .map(|leaving| leaving.iter().map(|(i, sign)| sign * w.given[*i]).sum::<f64>().abs())
            .fold(0.0, f64::max)
    }

    /// Volt-seconds that would end the currents without a path: the potentials of the floating parts in `w.float.phi`,
    /// the voltages of all two-pins in `w.voltage`.
    fn volt_seconds(&self, island: usize, c: &Context, w: &mut Work) {
        let circuits = std::mem::take(&mut w.circuits);
        if let Some(floating) = &circuits[island].now().floating {
            let mut room = std::mem::take(&mut w.float);
            self.assemble_floating(floating, c, w, &mut room, false);
            for (phi, leaving) in room.phi.iter_mut().zip(&floating.leaving) {
                *phi = -leaving.iter().map(|(i, sign)| sign * w.given[*i]).sum::<f64>();
            }
            self.settle_floating(island, floating, &mut room, w);
            w.float = room;
        }
        w.circuits = circuits;
    }

    /// Start values of currents that do not obey Kirchhoff's law.
    pub(crate) fn misfit(&self, island: usize, w: &Work) -> Option<NetworkProblem> {
        let circuit = &self.electrics.islands[island];
        let most = circuit.two_pins.iter().fold(0.0, |m: f64, p| m.max(w.current[p.index].abs()));
        let lost = self.lost(island, w);
        if lost <= REMAINDER * most {
            return None;
        }
        let problem = NetworkProblem::new(
            "start_conflict",
            format!("the currents at the start do not obey Kirchhoff's law: {lost} A have no path"),
            "make the start currents of these inductances add up to zero at every node",
        );
        let floating = w.circuits[island].now().floating.as_ref()?;
        Some(
            floating.crossing.iter().fold(problem, |problem, crossing| {
                problem.with(crossing.member, "has a current at the start")
            }),
        )
    }

    /// The valve that the arc would drive hardest to conduct.
    fn takes_over(&self, island: usize, c: &Context, w: &mut Work, conducting: Conducting) -> Wrong {
        for pin in &self.electrics.islands[island].two_pins {
            w.voltage[pin.index] = 0.0;
        }
        self.volt_seconds(island, c, w);
        let mut best = (0.0, None);
        for (bit, index) in self.electrics.islands[island].valves.iter().enumerate() {
            let valve = &self.electrics.valves[*index];
            let gated = matches!(valve.kind, ValveKind::GatedDiode | ValveKind::Thyristor);
            let may = self.is_natural(*index) && (!gated || w.gates[*index]);
            if may && conducting >> bit & 1 == 0 && w.voltage[valve.two_pin] > best.0 {
                best = (w.voltage[valve.two_pin], Some(bit));
            }
        }
        best.1.map_or(Wrong::Arc, |bit| Wrong::Valve(bit, 0.0))
    }

    /// Ends the currents that have no path.
    fn strike(&self, island: usize, c: &Context, w: &mut Work, x: &mut [f64]) {
        for pin in &self.electrics.islands[island].two_pins {
            w.voltage[pin.index] = 0.0;
        }
        self.volt_seconds(island, c, w);
        let circuits = std::mem::take(&mut w.circuits);
        if let Some(floating) = &circuits[island].now().floating {
            for crossing in &floating.crossing {
                let seat = &self.seats[crossing.member];
                let Some(component) = seat.component() else { continue };
                let mut flux = std::mem::take(&mut w.flux);
                self.winding_voltages(crossing.member, w, &mut flux);
                component.strike(&self.law(c, seat, w), &flux, &mut x[seat.x.clone()]);
                w.flux = flux;
            }
        }
        w.circuits = circuits;
    }

    fn arc(&self, island: usize, c: &Context, w: &Work) -> String {
        let circuit = &self.electrics.islands[island];
        let mut opened: Vec<&str> = circuit
            .valves
            .iter()
            .map(|valve| &self.electrics.valves[*valve])
            .map(|valve| self.seats[valve.member].member.path.as_str())
            .collect();
        opened.dedup();
        let floating = w.circuits[island].now().floating.as_ref();
        let mut interrupted: Vec<&str> = floating
            .into_iter()
            .flat_map(|floating| &floating.crossing)
            .map(|crossing| self.seats[crossing.member].member.path.as_str())
            .collect();
        interrupted.dedup();
        format!(
            "at {} s the valves (`{}`) interrupt the current of an inductance (`{}`): connect a freewheeling diode or \
             a resistance in parallel, or give the valve an off-state conductance",
            c.t,
            opened.join("`, `"),
            interrupted.join("`, `")
        )
    }

    /// Current of what conducts by itself, voltage over its forward voltage of what does not: guards of the valves.
    pub(crate) fn valve_guards(&self, c: &Context, w: &mut Work, g: &mut [f64]) {
        for island in 0..self.electrics.islands.len() {
            if self.electrics.islands[island].valves.is_empty() {
                continue;
            }
            let conducting = self.conducting(island, c, w);
            for (bit, index) in self.electrics.islands[island].valves.iter().enumerate() {
                let valve = &self.electrics.valves[*index];
                let Some(place) = self.natural.iter().position(|natural| natural == index) else { continue };
                let on = conducting >> bit & 1 == 1;
                g[place] = match valve.kind {
                    _ if on => w.current[valve.two_pin],
                    ValveKind::GatedDiode | ValveKind::Thyristor if !w.gates[*index] => -1.0,
                    _ => w.voltage[valve.two_pin] - valve.forward_voltage,
                };
            }
        }
    }
}
