//! Currents that have lost their path when a contact opened. Of those of inductances, the volt-seconds of the arc that this would
//! mean tell which valves take them over. That of a source, with the windings in series to it, cannot end: let every open valve
//! leak by a conductance `g`, and voltages grow as `1 / g` where such a current must pass. The limit `g -> 0` of the
//! complementarity problem decides, in which nothing but these voltages counts.

use blocksim_block::Context;
use blocksim_block::physical::ValveKind;

use crate::electrics::commutation::Wrong;
use crate::electrics::float::TOGETHER;
use crate::electrics::{Branch, Conducting, GivenBy, Unsolvable, loops, solve};
use crate::network::Network;
use crate::work::Work;

/// Leakage that stands for ever so little, S.
const LEAK: f64 = 1e-9;
/// What may be missing at rest, as a part of the largest current or voltage of a circuit: what a search leaves over.
const MISFIT: f64 = 1e-6;
/// What rounding leaves of voltages at rest, as a part of the largest of a circuit.
const ROUNDED: f64 = 1e-12;
/// Marks the solution for a set of valves in which the others leak; a circuit with a valve for this bit has none.
const LEAKY: Conducting = 1 << (Conducting::BITS - 1);
/// Voltages of a cut current below this, relative to the current over the leakage, are rounding.
const LEAST_DRIVE: f64 = 1e-6;

impl Network {
    /// The valve that a source without a path drives hardest to conduct.
    pub(crate) fn takes_source(
        &self,
        island: usize,
        c: &Context,
        w: &mut Work,
        conducting: Conducting,
    ) -> Option<usize> {
        let circuit = &self.electrics.islands[island];
        if conducting & LEAKY != 0 || circuit.valves.len() >= Conducting::BITS as usize {
            return None;
        }
        if self.natural_of(island) & !conducting == 0 {
            return None;
        }
        if !w.circuits[island].choose(conducting | LEAKY) {
            let mut leaky = circuit.clone();
            for pin in &mut leaky.two_pins {
                match &mut pin.branch {
                    Branch::Valve { index, off_conductance, .. } if conducting >> *index & 1 == 0 => {
                        *off_conductance = (*off_conductance).max(LEAK);
                    }
                    _ => {}
                }
            }
            let solved = solve(&self.electrics, &leaky, conducting).ok()?;
            w.circuits[island].add(conducting | LEAKY, solved);
        }
        self.prescribed_voltages(island, c, w);
        let mut given = std::mem::take(&mut w.given);
        self.given_currents(c, w, &mut given, &self.active.islands[island].currents, |by| {
            by != GivenBy::Voltage
        });
        w.given = given;
        if !circuit.in_cuts.is_empty() {
            self.follow_sources(island, c, w);
        }
        let first = self.electrics.sources;
        let is_cut = |given: usize| {
            given.checked_sub(first).and_then(|i| self.electrics.windings.get(i)).is_some_and(|by| match by {
                GivenBy::Input => true,
                GivenBy::State => self.electrics.follows(given - first),
                GivenBy::Voltage | GivenBy::Ratio | GivenBy::Characteristic | GivenBy::Heat => false,
            })
        };
        let solved = w.circuits[island].now();
        // Where nothing flows, a path is held ready for what the sources count as positive.
        let all = first..first + self.electrics.windings.len();
        let rests = all.filter(|i| is_cut(*i)).all(|i| w.given[i] == 0.0);
        let is_source = |i: usize| self.electrics.windings[i - first] == GivenBy::Input;
        let value = |i: usize| if rests && is_source(i) { 1.0 } else { w.given[i] };
        let mut best = (0.0, None);
        for (pin, voltage) in circuit.two_pins.iter().zip(&solved.voltages) {
            let Branch::Valve { index: bit, .. } = pin.branch else { continue };
            let valve = circuit.valves[bit];
            let gated =
                matches!(self.electrics.valves[valve].kind, ValveKind::GatedDiode | ValveKind::Thyristor);
            let may = self.is_natural(valve) && (!gated || w.gates[valve]);
            if !may || conducting >> bit & 1 == 1 {
                continue;
            }
            let terms = voltage.terms().iter().map(|(i, factor)| (*i as usize, *factor));
            let driven: Vec<f64> =
                terms.filter(|(i, _)| is_cut(*i)).map(|(i, factor)| factor * value(i)).collect();
            let (drive, most) =
                (driven.iter().sum::<f64>(), driven.iter().fold(0.0_f64, |most, v| most.max(v.abs())));
            if drive > best.0 && drive > LEAST_DRIVE * most {
                best = (drive, Some(bit));
            }
        }
        best.1
    }

    /// Chooses the valves that conduct with those that take over what they cut off; returns whether there is a solution.
    pub(crate) fn takes_all(
        &self,
        island: usize,
        c: &Context,
        w: &mut Work,
        mut conducting: Conducting,
    ) -> bool {
        while let Some(bit) = self.takes_source(island, c, w, conducting) {
            conducting |= 1 << bit;
            match self.choose(island, conducting, w) {
                Ok(()) => return true,
                Err(Unsolvable::Cut(_)) => {}
                Err(_) => return false,
            }
        }
        false
    }

    /// Largest current that enters a floating part and does not leave it, A. Where current sources lead into it, none is lost.
    pub(crate) fn lost(&self, island: usize, w: &Work) -> f64 {
        let Some(floating) = &w.circuits[island].now().floating else { return 0.0 };
        let free = floating.leaving.iter().zip(&floating.cut).filter(|(_, cut)| !**cut);
        free.map(|(leaving, _)| leaving.iter().map(|(i, sign)| sign * w.given[*i]).sum::<f64>().abs())
            .fold(0.0, f64::max)
    }

    /// Gives capacitances in parallel the one voltage that the rest of the circuit knows of, and says so; or that currents of windings in
    /// series, which are one, differ. Nothing that moves depends on either.
    pub(crate) fn fit_at_rest(&self, c: &Context, w: &mut Work, x: &mut [f64]) -> Option<String> {
        let mut differs = None;
        for (index, island) in self.electrics.islands.iter().enumerate() {
            if island.separate.is_some() || self.circuit(index, c, w).is_err() {
                continue;
            }
            let name = |position: usize| self.seats[island.two_pins[position].member].member.path.as_str();
            let [most_v, most_i] = self.size(index, w);
            let lost = self.lost(index, w);
            if lost > MISFIT * most_i && !self.is_pull_rounding(index, c, w, most_v) {
                differs.get_or_insert_with(|| {
                    let path = &self.seats[island.members[0]].member.path;
                    format!("currents that are one differ by {lost:.3e} of {most_i:.3e} in the circuit of `{path}`")
                });
            }
            let fixed = |i: usize| {
                matches!(island.two_pins[i].branch, Branch::Source(_) | Branch::Variable(_) | Branch::Wire)
            };
            for found in loops::find(&self.electrics, island, fixed).unwrap_or_default() {
                let of = |(i, factor): &(usize, f64)| factor * self.prescribed(index, *i, w);
                let others: f64 = found.others.iter().map(of).sum();
                let own = self.prescribed(index, found.chord, w);
                let chord = self.electrics.capacitance(&island.two_pins[found.chord].branch);
                let Some(chord) = chord.filter(|_| (own - others).abs() > MISFIT * most_v) else { continue };
                x[self.seats[chord.member].x.start + chord.state] += others - own;
                let beside = found.others.first().map_or("", |(i, _)| name(*i));
                differs.get_or_insert_with(|| {
                    format!(
                        "`{}` stands at {own:.4e} and `{beside}`, in parallel with it, at {others:.4e}",
                        name(found.chord)
                    )
                });
            }
        }
        differs
    }

    /// Whether the voltages that bring currents together in a search are rounding beside the largest of the circuit, `most_v`. Where a
    /// capacitor lets no current through at rest, what is left of currents is that alone, and no measure of itself.
    fn is_pull_rounding(&self, island: usize, c: &Context, w: &mut Work, most_v: f64) -> bool {
        let kept = w.voltage.clone();
        self.clear_voltages(island, w);
        self.volt_seconds(island, c, w);
        let pull = TOGETHER * self.size(island, w)[0];
        w.voltage = kept;
        pull <= ROUNDED * most_v
    }

    fn clear_voltages(&self, island: usize, w: &mut Work) {
        for pin in &self.electrics.islands[island].two_pins {
            w.voltage[pin.index] = 0.0;
        }
    }

    /// Volt-seconds that would end the currents without a path: the potentials of the floating parts in `w.float.phi`,
    /// the voltages of all two-pins in `w.voltage`.
    fn volt_seconds(&self, island: usize, c: &Context, w: &mut Work) {
        let circuits = std::mem::take(&mut w.circuits);
        if let Some(floating) = &circuits[island].now().floating {
            let mut room = std::mem::take(&mut w.float);
            self.assemble_floating(floating, c, w, &mut room, false);
            let free =
                floating.leaving.iter().zip(&floating.cut).zip(&mut room.phi).filter(|((_, cut), _)| !**cut);
            for ((leaving, _), phi) in free {
                *phi = -leaving.iter().map(|(i, sign)| sign * w.given[*i]).sum::<f64>();
            }
            self.settle_floating(island, floating, &mut room, w);
            w.float = room;
        }
        w.circuits = circuits;
    }

    /// The valve that the arc would drive hardest to conduct.
    pub(crate) fn takes_over(
        &self,
        island: usize,
        c: &Context,
        w: &mut Work,
        conducting: Conducting,
    ) -> Wrong {
        self.clear_voltages(island, w);
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
    pub(crate) fn strike(&self, island: usize, c: &Context, w: &mut Work, x: &mut [f64]) {
        self.clear_voltages(island, w);
        self.volt_seconds(island, c, w);
        let circuits = std::mem::take(&mut w.circuits);
        if let Some(floating) = &circuits[island].now().floating {
            for crossing in &floating.crossing {
                let seat = &self.seats[crossing.member];
                let Some(component) = seat.component() else { continue };
                let mut flux = std::mem::take(&mut w.flux);
                self.winding_voltages(crossing.member, w, &mut flux);
                component.strike(&self.fed_law(c, seat, w), &flux, &mut x[seat.x.clone()]);
                w.flux = flux;
            }
        }
        w.circuits = circuits;
    }

    pub(crate) fn arc(&self, island: usize, c: &Context, w: &Work) -> String {
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
}
