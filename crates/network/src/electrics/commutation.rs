//! Which valves conduct after something has changed.
//!
//! Each valve that conducts by itself is a pair of which one is zero: the voltage over its forward voltage, the current over
//! what leaks at it. All pairs of a circuit are one linear complementarity problem. It is solved by principal pivoting:
//! the valve with the greatest contradiction changes, later the first one, until none contradicts. (The rule of the first
//! one never comes back to a set: K. G. Murty, *Note on a Bard-type scheme for solving the complementarity problem*,
//! Opsearch 11 (1974).) Where a pair is zero to rounding, its derivative decides; see `drift.rs`.
//!
//! A contact that opens may leave the current of an inductance without a path: then the volt-seconds of the arc that this
//! would mean tell which valves take the current over; where none can, the simulation ends with an error. A current source
//! that is cut off has its current taken over by the valve that it drives hardest through what ever so little leaks (`arc.rs`).

use blocksim_block::Context;
use blocksim_block::physical::ValveKind;

use crate::electrics::charges::Divided;
use crate::electrics::margin::NOTHING;
use crate::electrics::{Branch, Conducting, Unsolvable};
use crate::network::Network;
use crate::work::Work;

/// Currents below this, relative to the largest of the circuit, are what the location of an event leaves over.
pub(crate) const REMAINDER: f64 = 1e-6;

/// Currents without a path, relative to the largest of the circuit, that are rounding just behind an event.
const STRUCK: f64 = 1e-14;

/// The same, relative to the largest of now, where nothing has changed: currents of inductances in series differ by the errors of
/// the method, as all states do.
const DRIFTED: f64 = 1e-8;

/// The same beyond which they cannot be those errors, at the loosest of tolerances: up to there they are made to fit once more.
const ASTRAY: f64 = 1e-2;

/// Time in which an event cannot be told from another, s, relative to the time of the simulation if that is larger than 1 s.
const INSTANT: f64 = 1e-9;

/// What is wrong with the set of conducting valves.
pub(crate) enum Wrong {
    Nothing,
    /// This valve of the island must change; the current against it that it had while it conducted.
    Valve(usize, f64),
    /// Nothing is wrong now, but this valve of the island must change for what comes.
    Drifts(usize),
    /// Currents of inductances have no path, and no valve can take them over.
    Arc,
    /// The voltages of capacitances do not fit each other while these valves conduct.
    Charges(Conducting),
    /// A small current has no path any more: an event was a little late.
    Remainder,
}

impl Network {
    /// Notes how late events are: what valves carry backward that were to let go at zero.
    pub(crate) fn note_late(&self, c: &Context, w: &mut Work) {
        for island in &self.active.valves {
            let conducting = self.conducting(*island, c, w) & self.natural_of(*island);
            let valves = self.electrics.islands[*island].valves.iter().enumerate();
            let conducting = valves.filter(|(bit, _)| conducting >> bit & 1 == 1);
            let backward = conducting.map(|(_, valve)| -w.current[self.electrics.valves[*valve].two_pin]);
            w.late[*island] = backward.filter(|current| *current > 0.0).sum();
        }
    }

    /// Sets the valves of an island right; `stirred` where something else has changed at this instant, `gated` where a gate has. Returns
    /// whether any of them, or a state, changed.
    pub(crate) fn commutate(
        &self,
        island: usize,
        (stirred, gated): (bool, bool),
        c: &Context,
        w: &mut Work,
        x: &mut [f64],
        d: &mut [f64],
    ) -> bool {
        let circuit = &self.electrics.islands[island];
        let natural = circuit.valves.iter().any(|valve| self.is_natural(*valve));
        if !natural && !circuit.has_windings && !circuit.divides {
            return false;
        }
        let mut changed = false;
        // A jump repeats its instant until nothing changes; a derivative has its say once at an instant.
        if w.drifted[island].0 != c.t {
            w.drifted[island] = (c.t, 0);
        }
        // Currents at which valves have been let go of because they were negative. What a gate leads backward through a valve has not come
        // too late: it is interrupted.
        let mut late = if gated { w.late[island] } else { 0.0 };
        let most = 8 * circuit.valves.len() + 8;
        for round in 0..most {
            let here = Context { x: &*x, d: &*d, ..*c };
            let drift = if stirred || changed { 0.0 } else { DRIFTED };
            let wrong = match self.contradiction(island, &here, w, (late, drift), round > most / 2) {
                Ok(wrong) => wrong,
                Err(_) => return false,
            };
            match wrong {
                Wrong::Nothing => {
                    let forgotten = self.latched_in_vain(island, w, &here);
                    if let Some(bit) = forgotten {
                        self.turn_over(island, bit, d);
                        changed = true;
                        continue;
                    }
                    self.note_size(island, w, d);
                    return changed;
                }
                Wrong::Valve(bit, against) => {
                    late += if gated { 0.0 } else { against };
                    self.trim(island, w, x);
                    self.turn_over(island, bit, d);
                    changed = true;
                }
                Wrong::Drifts(bit) => {
                    w.drifted[island].1 |= 1 << bit;
                    self.trim(island, w, x);
                    self.turn_over(island, bit, d);
                    changed = true;
                }
                Wrong::Charges(conducting) => {
                    if let Divided::Against(bit) = self.divide(island, w, (&mut *x, &mut *d), conducting) {
                        self.turn_over(island, bit, d);
                    }
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
        c.fail(self.undecided(island, c.t));
        false
    }

    /// A thyristor that nothing fires any longer and that carries nothing: others in series block, or its gate has ended before any
    /// current came. One that remembered would conduct without a gate when they conduct again.
    fn latched_in_vain(&self, island: usize, w: &mut Work, c: &Context) -> Option<usize> {
        let is_thyristor = |valve: &usize| self.electrics.valves[*valve].kind == ValveKind::Thyristor;
        if !self.electrics.islands[island].valves.iter().any(is_thyristor) {
            return None;
        }
        let conducting = self.conducting(island, c, w);
        let size = self.size_with(island, c.d, w);
        let mut bits = 0..self.electrics.islands[island].valves.len();
        bits.find(|bit| {
            let index = self.electrics.islands[island].valves[*bit];
            let fired = !is_thyristor(&index) || w.gates[index];
            let on = conducting >> bit & 1 == 1;
            // One without a margin has no current whatever happens.
            on && !fired && self.margin(island, *bit, on, size, w).is_none_or(|margin| margin.is_over())
        })
    }

    /// The current of the valve that conducts most backward, the largest current of its circuit so far, and its member.
    pub(crate) fn late_valve(&self, c: &Context, w: &mut Work) -> Option<(f64, f64, &str)> {
        let mut worst: Option<(f64, f64, usize)> = None;
        for (island, circuit) in self.electrics.islands.iter().enumerate() {
            if circuit.valves.is_empty() || circuit.separate.is_some() || self.circuit(island, c, w).is_err()
            {
                continue;
            }
            let conducting = self.conducting(island, c, w) & self.natural_of(island);
            let largest = self.size_with(island, c.d, w)[1];
            for bit in (0..circuit.valves.len()).filter(|bit| conducting >> bit & 1 == 1) {
                let valve = circuit.valves[bit];
                let backward = -w.current[self.electrics.valves[valve].two_pin];
                if backward > worst.map_or(0.0, |(most, ..)| most) {
                    worst = Some((backward, largest, valve));
                }
            }
        }
        let (backward, largest, valve) = worst?;
        Some((backward, largest, self.seats[self.electrics.valves[valve].member].member.path.as_str()))
    }

    fn turn_over(&self, island: usize, bit: usize, d: &mut [f64]) {
        let latch = &mut d[self.first_latch + self.electrics.islands[island].valves[bit]];
        *latch = 1.0 - *latch;
    }

    pub(crate) fn is_natural(&self, valve: usize) -> bool {
        self.electrics.valves[valve].kind != ValveKind::Switch
    }

    /// Evaluates an island and finds what is wrong with its valves. `first` takes the first contradiction instead of the
    /// greatest, so that no cycle can arise. Currents up to the part `drift` of all may be without a path.
    fn contradiction(
        &self,
        island: usize,
        c: &Context,
        w: &mut Work,
        (late, drift): (f64, f64),
        first: bool,
    ) -> Result<Wrong, crate::electrics::currents::Faulty> {
        let conducting = self.conducting(island, c, w);
        let chosen = self.choose(island, conducting, w);
        if let Err(Unsolvable::Cut(_)) = &chosen
            && let Some(bit) = self.takes_source(island, c, w, conducting)
        {
            return Ok(Wrong::Valve(bit, 0.0));
        }
        if let Err(Unsolvable::Loop(two_pins)) = chosen
            && let Some(bit) = self.lets_go(island, w, conducting, &two_pins)
        {
            return Ok(Wrong::Valve(bit, 0.0));
        }
        self.circuit(island, c, w)?;
        if self.misses(island, c, w) {
            return Ok(Wrong::Charges(conducting));
        }
        let [most_v, most_i] = self.size(island, w);
        let lost = self.lost(island, w);
        let so_far = self.size_with(island, c.d, w)[1];
        if lost <= (STRUCK * so_far).max(drift * most_i) + NOTHING {
            return Ok(match self.worst(island, c, w, conducting, first) {
                Wrong::Nothing => self.drifting(island, c, w, conducting)?,
                wrong => wrong,
            });
        }
        // No path has gone.
        if drift > 0.0 && lost <= ASTRAY * most_i {
            return Ok(Wrong::Remainder);
        }
        let arc = self.takes_over(island, c, w, conducting);
        // Volt-seconds that the voltages of the circuit have in a time that an event cannot be located in.
        let most_arc = self.size(island, w)[0];
        if most_arc <= most_v * INSTANT * c.resolution.size(c.t) || lost <= REMAINDER * so_far {
            return Ok(Wrong::Remainder);
        }
        Ok(match arc {
            // Where steps end behind the zero of a current, what is left of it ends with them.
            Wrong::Arc if lost <= late * (1.0 + 1e-6) => Wrong::Remainder,
            arc => arc,
        })
    }

    /// Which of the valves that conduct by themselves lets go in a loop of ideal voltages: the first of those through which what is
    /// left of the voltages drives a current backward, however small the resistances are.
    fn lets_go(
        &self,
        island: usize,
        w: &Work,
        conducting: Conducting,
        two_pins: &[(usize, f64)],
    ) -> Option<usize> {
        let circuit = &self.electrics.islands[island];
        let voltage = |i: usize| match circuit.two_pins[i].branch {
            Branch::Source(given) | Branch::Variable(given) => w.given[given],
            Branch::Valve { forward_voltage, .. } => forward_voltage,
            _ => 0.0,
        };
        let left: f64 = two_pins.iter().map(|(i, factor)| factor * voltage(*i)).sum();
        let natural = conducting & self.natural_of(island);
        let factor_of = |bit: &usize| {
            let valve = &self.electrics.valves[circuit.valves[*bit]];
            let in_loop = two_pins.iter().find(|(i, _)| circuit.two_pins[*i].index == valve.two_pin);
            in_loop.filter(|_| natural >> bit & 1 == 1).map(|(_, factor)| *factor)
        };
        let bits = 0..circuit.valves.len();
        let backward = bits.clone().find(|bit| factor_of(bit).is_some_and(|factor| factor * left > 0.0));
        backward.or_else(|| bits.clone().find(|bit| factor_of(bit).is_some()))
    }

    /// The valve whose voltage or current contradicts most what it does.
    fn worst(&self, island: usize, c: &Context, w: &Work, conducting: Conducting, first: bool) -> Wrong {
        let size = self.size_with(island, c.d, w);
        let mut worst = (0.0, Wrong::Nothing);
        for bit in 0..self.electrics.islands[island].valves.len() {
            let on = conducting >> bit & 1 == 1;
            let Some(margin) = self.margin(island, bit, on, size, w) else { continue };
            if margin.holds() {
                continue;
            }
            let found = Wrong::Valve(bit, if on { -margin.value } else { 0.0 });
            if first {
                return found;
            }
            let against = -margin.value / margin.scale;
            if against > worst.0 {
                worst = (against, found);
            }
        }
        worst.1
    }

    fn undecided(&self, island: usize, t: f64) -> String {
        let circuit = &self.electrics.islands[island];
        let mut names: Vec<&str> = circuit
            .valves
            .iter()
            .filter(|valve| self.is_natural(**valve))
            .map(|valve| self.seats[self.electrics.valves[*valve].member].member.path.as_str())
            .collect();
        names.dedup();
        format!(
            "at {t} s no set of conducting valves fits the circuit of `{}` (valves `{}`): is a resistance missing?",
            self.seats[circuit.members[0]].member.path,
            names.join("`, `")
        )
    }
}
