//! Capacitances in loops while a network runs: what sources add to their voltages, and how their charges divide when a
//! valve closes a loop of them; see `loops.rs` for the equations.

use blocksim_block::Context;
use blocksim_block::physical::ValveKind;
use nalgebra::DVector;

use crate::electrics::{Branch, Conducting, Shift, loops};
use crate::network::Network;
use crate::work::Work;

/// Voltages that a loop misses by less than this, relative to the largest of the circuit, are what integration leaves.
const REMAINDER: f64 = 1e-6;

/// What happens where charges divide.
#[derive(Debug)]
pub(crate) enum Divided {
    /// This valve, which conducts by itself, would have to let charge through backward.
    Against(usize),
    /// The charges have divided.
    Done,
}

impl Network {
    /// Adds what sources in their loops give to the voltages of capacitances, and finds the slopes of these sources.
    pub(crate) fn shift_capacitances(&self, island: usize, c: &Context, w: &mut Work, given: &mut [f64]) {
        let circuit = &self.electrics.islands[island];
        let mut own = std::mem::take(&mut w.own);
        for shift in &circuit.shifts {
            given[shift.source] += shift.by.of(given);
        }
        for shift in &circuit.shifts {
            if let Some(at) = self.seats[shift.member].shifted {
                own[at + shift.state] = given[shift.source];
            }
        }
        w.own = own;
        for seat in circuit.rated.iter().map(|i| &self.seats[*i]) {
            let Some(component) = seat.component() else { continue };
            let law = self.moving_law(c, seat, w);
            if let Some(first) =
                self.electrics.slope_of(seat.sources.start).filter(|_| !seat.sources.is_empty())
            {
                component.voltage_rates(&law, &mut given[first..first + seat.sources.len()]);
            }
            let first = self.electrics.sources + seat.windings.start;
            if let Some(first) = self.electrics.slope_of(first).filter(|_| !seat.windings.is_empty()) {
                component.current_rates(&law, &mut given[first..first + seat.windings.len()]);
            }
        }
    }

    /// What sources add to the derivative of the voltage of a capacitance; its state is without it.
    pub(crate) fn shift_rate(&self, shift: &Shift, w: &Work) -> f64 {
        let rate = |source: u32| self.electrics.slope_of(source as usize).map_or(0.0, |slope| w.given[slope]);
        shift.by.terms().iter().map(|(source, factor)| factor * rate(*source)).sum()
    }

    /// Whether conducting valves have closed loops of capacitances whose voltages do not fit. The island is evaluated.
    pub(crate) fn misses(&self, island: usize, c: &Context, w: &Work) -> bool {
        let circuit = &self.electrics.islands[island];
        let law = w.circuits[island].now().loops.as_ref().filter(|_| circuit.divides);
        law.is_some_and(|law| {
            let most =
                (0..law.b.nrows()).fold(0.0, |most: f64, l| most.max(self.missing(island, law, l, w).abs()));
            most > REMAINDER * self.size_with(island, c.d, w)[0]
        })
    }

    /// Voltage of a branch of a loop.
    pub(crate) fn prescribed(&self, island: usize, position: usize, w: &Work) -> f64 {
        match self.electrics.islands[island].two_pins[position].branch {
            Branch::Source(index) => w.given[index],
            Branch::Valve { on_resistance, forward_voltage, off_conductance, .. } => {
                forward_voltage * (1.0 - on_resistance * off_conductance)
            }
            _ => 0.0,
        }
    }

    /// By how much the voltages around a loop miss zero.
    fn missing(&self, island: usize, law: &loops::Law, row: usize, w: &Work) -> f64 {
        let of = |position: &usize| self.prescribed(island, *position, w);
        let others = law.others.iter().enumerate().map(|(k, position)| law.d[(row, k)] * of(position));
        let own = law.capacitances.iter().enumerate().map(|(k, position)| law.b[(row, k)] * of(position));
        others.sum::<f64>() - own.sum::<f64>()
    }

    /// Gives the capacitances that close loops exactly the voltage of the others, before a valve opens the loop: what integration
    /// has left would else open it again.
    pub(crate) fn trim(&self, island: usize, w: &Work, x: &mut [f64]) {
        let circuit = &self.electrics.islands[island];
        let Some(law) = w.circuits[island].now().loops.as_ref().filter(|_| circuit.divides) else { return };
        for (row, chord) in law.chords.iter().enumerate() {
            if let Some(c) = self.electrics.capacitance(&circuit.two_pins[law.capacitances[*chord]].branch) {
                x[self.seats[c.member].x.start + c.state] += self.missing(island, law, row, w);
            }
        }
    }

    /// Lets the charges divide, in the continuous and discrete `states`, where valves have closed loops of capacitances whose
    /// voltages do not fit. The island is evaluated.
    pub(crate) fn divide(
        &self,
        island: usize,
        w: &mut Work,
        states: (&mut [f64], &mut [f64]),
        conducting: Conducting,
    ) -> Divided {
        // What is less than this is not worth an event.
        let least = REMAINDER * self.size_with(island, states.1, w)[0];
        let circuits = std::mem::take(&mut w.circuits);
        let divided = match &circuits[island].now().loops {
            Some(law) => self.divide_by(island, law, w, (states, least), conducting),
            None => Divided::Done,
        };
        w.circuits = circuits;
        divided
    }

    fn divide_by(
        &self,
        island: usize,
        law: &loops::Law,
        w: &mut Work,
        ((x, d), least): ((&mut [f64], &mut [f64]), f64),
        conducting: Conducting,
    ) -> Divided {
        let circuit = &self.electrics.islands[island];
        let missing = DVector::from_fn(law.b.nrows(), |row, _| self.missing(island, law, row, w));
        let charges = law.charges(&missing);
        // Charge from p to n through what is no capacitance.
        let through = -(law.d.transpose() * &charges);
        let most = through.amax().max(charges.amax());
        for (position, charge) in law.others.iter().zip(through.iter()) {
            let Branch::Valve { index, .. } = circuit.two_pins[*position].branch else { continue };
            let kind = self.electrics.valves[circuit.valves[index]].kind;
            if kind != ValveKind::Switch && conducting >> index & 1 == 1 && *charge < -1e-9 * most {
                return Divided::Against(index);
            }
        }
        for (position, of) in law.others.iter().zip(through.iter()) {
            if let Branch::Source(_) = circuit.two_pins[*position].branch {
                w.energies.pushed -= of * self.prescribed(island, *position, w);
            }
        }
        let into = law.b.transpose() * charges;
        for ((position, charge), elastance) in law.capacitances.iter().zip(into.iter()).zip(&law.elastance) {
            if let Some(c) = self.electrics.capacitance(&circuit.two_pins[*position].branch) {
                let jump = charge * elastance;
                x[self.seats[c.member].x.start + c.state] += jump;
                if let Some(sum) = c.jumps.filter(|_| jump.abs() > least) {
                    d[sum] += jump;
                }
            }
        }
        Divided::Done
    }
}
