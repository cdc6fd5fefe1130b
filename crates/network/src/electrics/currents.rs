//! Second phase of an evaluation: supplies, voltages and currents.

use blocksim_block::Context;
use blocksim_block::physical::{Field, Supply, ValveKind, from_space_vector, space_vector};

use crate::electrics::{Conducting, Early, GivenBy, Joined, Unsolvable, coordinates, solve};
use crate::network::Network;
use crate::seat::{ELECTRICS, Role, Seat};
use crate::work::Work;

/// Why the circuit of an island could not be evaluated; the context knows the sentence.
pub(crate) struct Faulty;

/// What is held of a gate before the first instant: then its command counts.
pub(crate) const UNTOLD: f64 = -1.0;

impl Network {
    /// What sensors read that follows from states alone.
    pub(crate) fn early_readings(&self, c: &Context, w: &mut Work) {
        let mut given = std::mem::take(&mut w.given);
        for seat in self.active.circuit.iter().map(|i| &self.seats[*i]) {
            let Some(component) = seat.component() else { continue };
            if seat.is_capacitance {
                let own = &mut given[seat.sources.clone()];
                if !seat.gives.voltages(c, own) {
                    seat.member.part.write_voltages(component, &self.moving_own_law(c, seat, w), own);
                }
            }
        }
        self.given_currents(c, w, &mut given, &self.active.circuit, |by| by == GivenBy::State);
        for (two_pin, early) in self.electrics.early.iter().enumerate() {
            match early {
                Some(Early::Voltage(form)) => w.voltage[two_pin] = form.of(&given),
                Some(Early::Current(form)) => w.current[two_pin] = form.of(&given),
                None => {}
            }
        }
        w.given = given;
    }

    /// Currents of an island that are states.
    pub(crate) fn currents_of_states(&self, island: usize, c: &Context, w: &mut Work) {
        let mut given = std::mem::take(&mut w.given);
        let members = &self.active.islands[island].currents;
        self.given_currents(c, w, &mut given, members, |by| by == GivenBy::State);
        w.given = given;
    }

    /// Currents of these members that depend on what is asked for.
    pub(crate) fn given_currents(
        &self,
        c: &Context,
        w: &Work,
        given: &mut [f64],
        members: &[usize],
        which: impl Fn(GivenBy) -> bool,
    ) {
        let by_voltages = which(GivenBy::Voltage);
        let first = self.electrics.sources;
        for seat in members.iter().map(|i| &self.seats[*i]) {
            // A component writes all its currents; those that wait for a voltage are written again.
            if !seat.windings.clone().any(|i| which(self.electrics.windings[i])) {
                continue;
            }
            let own = &mut given[first + seat.windings.start..first + seat.windings.end];
            if seat.gives.currents(c, own) {
                continue;
            }
            let Some(component) = seat.component() else { continue };
            match seat.role {
                Role::Machine(_) => {
                    let phases = from_space_vector(component.line_current(&self.fed_law(c, seat, w)));
                    own.iter_mut().zip(phases).for_each(|(to, current)| *to = current);
                }
                _ if by_voltages => component.currents_by_voltages(&self.flowing_law(c, seat, w), own),
                _ => seat.member.part.write_currents(component, &self.moving_law(c, seat, w), own),
            }
        }
    }

    /// Voltages and currents of everything that the network does not integrate by itself.
    pub(crate) fn electrics_phase(&self, c: &Context, w: &mut Work) {
        if w.evaluation[ELECTRICS] == c.evaluation {
            return;
        }
        self.state_phase(c, w);
        w.evaluation[ELECTRICS] = c.evaluation;
        self.fed(c, w);
        for (island, circuit) in self.electrics.islands.iter().enumerate() {
            if circuit.separate.is_none() && self.circuit_behind(island, self.has_early, c, w).is_err() {
                return;
            }
        }
    }

    /// Voltages and currents of what the network integrates by itself, for those who look at them.
    pub(crate) fn held_circuits(&self, c: &Context, w: &mut Work) {
        if self.separate.is_empty() || w.held_evaluation == c.evaluation {
            return;
        }
        w.held_evaluation = c.evaluation;
        for separate in &self.separate {
            if self.circuit(separate.island, c, w).is_err() {
                return;
            }
        }
    }

    /// Ideal sources and the machines that they feed directly.
    fn fed(&self, c: &Context, w: &mut Work) {
        for seat in self.active.sources.iter().map(|i| &self.seats[*i]) {
            if let (Some(component), Some(slot)) = (seat.component(), seat.supply) {
                w.supply[slot] = component.supply(&self.known_law(c, seat));
                w.line_current[slot] = [0.0; 3];
            }
        }
        for seat in self.active.fed.iter().map(|i| &self.seats[*i]) {
            if let (Some(component), Some(slot)) = (seat.component(), seat.supply) {
                let current = component.line_current(&self.fed_law(c, seat, w));
                w.line_current[slot].iter_mut().zip(current).for_each(|(sum, i)| *sum += i);
            }
        }
    }

    /// Voltages that sources and capacitances of an island give.
    pub(crate) fn prescribed_voltages(&self, island: usize, c: &Context, w: &mut Work) {
        let members = &self.active.islands[island].voltages;
        self.take_states(island, c, w);
        let mut given = std::mem::take(&mut w.given);
        for seat in members.iter().map(|i| &self.seats[*i]) {
            let own = &mut given[seat.sources.clone()];
            if seat.gives.voltages(c, own) {
                continue;
            }
            let Some(component) = seat.component() else { continue };
            let law = self.moving_own_law(c, seat, w);
            match (seat.role, seat.supply) {
                (Role::Source, Some(slot)) => {
                    let supply = component.supply(&law);
                    own.copy_from_slice(&supply.phases());
                    w.supply[slot] = supply;
                }
                _ => seat.member.part.write_voltages(component, &law, own),
            }
        }
        self.shift_capacitances(island, c, w, &mut given);
        w.given = given;
    }

    /// Voltages and currents of one island.
    pub(crate) fn circuit(&self, island: usize, c: &Context, w: &mut Work) -> Result<(), Faulty> {
        self.circuit_behind(island, false, c, w)
    }

    /// The same, in an evaluation whose early readings have found the currents that follow from states already, if `early`.
    fn circuit_behind(&self, island: usize, early: bool, c: &Context, w: &mut Work) -> Result<(), Faulty> {
        let members = &self.active.islands[island].currents;
        self.prescribed_voltages(island, c, w);
        if !(early && self.active.islands[island].follows_states) {
            let mut given = std::mem::take(&mut w.given);
            self.given_currents(c, w, &mut given, members, |by| by != GivenBy::Voltage);
            w.given = given;
        }
        let conducting = self.conducting(island, c, w);
        if let Err(why) = self.choose(island, conducting, w) {
            // What conducts by itself lets go when a gate closes a loop, and takes over when one cuts a source off; which of it does
            // is settled in the jump that follows.
            let natural = self.natural_of(island);
            let loose = matches!(why, Unsolvable::Loop(_)) && conducting & natural != 0;
            let solved = match why {
                Unsolvable::Cut(_) => self.takes_all(island, c, w, conducting),
                _ => loose && self.choose(island, conducting & !natural, w).is_ok(),
            };
            if !solved {
                c.fail(self.unsolvable(island, conducting, &why));
                return Err(Faulty);
            }
        }
        if !self.electrics.islands[island].in_cuts.is_empty() {
            self.follow_sources(island, c, w);
        }
        self.find_unknown(island, c, w)?;
        self.voltages(island, w);
        self.float(island, c, w);
        if self.electrics.islands[island].waits {
            let mut given = std::mem::take(&mut w.given);
            self.given_currents(c, w, &mut given, members, |by| by == GivenBy::Voltage);
            w.given = given;
            self.find_unknown(island, c, w)?;
            self.voltages(island, w);
        }
        let Work { circuits, given, current, .. } = w;
        let solved = &circuits[island].now().currents;
        for (pin, form) in self.electrics.islands[island].two_pins.iter().zip(solved) {
            current[pin.index] = form.of(given);
        }
        self.show_characteristics(island, w);
        for seat in self.active.islands[island].vectors.iter().map(|i| &self.seats[*i]) {
            self.vectors(seat, w);
        }
        Ok(())
    }

    /// Given values that follow from the circuit itself.
    fn find_unknown(&self, island: usize, c: &Context, w: &mut Work) -> Result<(), Faulty> {
        if self.electrics.islands[island].characteristics.is_empty() {
            self.convert(island, c, w)
        } else {
            self.solve_characteristics(island, c, w)
        }
    }

    fn voltages(&self, island: usize, w: &mut Work) {
        let Work { circuits, given, voltage, .. } = w;
        for (pin, form) in
            self.electrics.islands[island].two_pins.iter().zip(&circuits[island].now().voltages)
        {
            voltage[pin.index] = form.of(given);
        }
    }

    /// The space vectors that machines and supplies of a circuit see.
    fn vectors(&self, seat: &Seat, w: &mut Work) {
        let Some(slot) = seat.supply else { return };
        match seat.role {
            Role::Machine(joined) => {
                let v = coordinates(joined, &w.voltage[seat.two_pins.clone()]);
                let field = seat.grid.map_or(Field::Unknown, |(source, exchanged)| {
                    let field = Field::Turns(w.supply[source].frequency);
                    if exchanged { field.exchanged() } else { field }
                });
                w.supply[slot] = Supply { voltage: [v[0], v[1]], zero: v[2], field, ..Supply::default() };
            }
            Role::Source => {
                let i = &w.current[seat.two_pins.clone()];
                let [alpha, beta, zero] = space_vector([-i[0], -i[1], -i[2]]);
                let (sin, cos) = w.supply[slot].angle.sin_cos();
                w.line_current[slot] = [cos * alpha + sin * beta, cos * beta - sin * alpha, zero];
            }
            Role::Fed | Role::Other => {}
        }
    }

    /// What the gates of an island are commanded to be.
    fn commanded(&self, island: usize, c: &Context, w: &mut Work) {
        let members = self.electrics.islands[island].members.iter().map(|i| &self.seats[*i]);
        let mut gates = std::mem::take(&mut w.gates);
        for seat in members.filter(|seat| !seat.valves.is_empty()) {
            if let Some(component) = seat.component() {
                component.gates(&self.known_law(c, seat), &mut gates[seat.valves.clone()]);
            }
        }
        w.gates = gates;
    }

    /// Takes over the gates that are commanded now; returns whether any has changed.
    pub(crate) fn take_gates(&self, island: usize, c: &Context, w: &mut Work, d: &mut [f64]) -> bool {
        self.commanded(island, &Context { d: &*d, ..*c }, w);
        let mut changed = false;
        for valve in &self.electrics.islands[island].valves {
            if let Some(cell) = self.gate_cells[*valve] {
                let gate = f64::from(w.gates[*valve]);
                changed |= d[cell] != gate && d[cell] != UNTOLD;
                d[cell] = gate;
            }
        }
        changed
    }

    /// Which valves of an island conduct: what the gates say and what the discrete states remember.
    pub(crate) fn conducting(&self, island: usize, c: &Context, w: &mut Work) -> Conducting {
        if self.electrics.islands[island].valves.is_empty() {
            return 0;
        }
        // Between jumps they are those of the last one.
        let cell = |valve: &usize| self.gate_cells[*valve].and_then(|cell| c.d.get(cell)).copied();
        let held = |valve: &usize| cell(valve).is_some_and(|held| held != UNTOLD);
        let valves = &self.electrics.islands[island].valves;
        let told = |valve: &usize| self.electrics.valves[*valve].kind == ValveKind::Diode || held(valve);
        if !valves.iter().all(told) {
            self.commanded(island, c, w);
        }
        let island = &self.electrics.islands[island];
        let mut gates = std::mem::take(&mut w.gates);
        for valve in &island.valves {
            if let Some(held) = cell(valve).filter(|held| *held != UNTOLD) {
                gates[*valve] = held != 0.0;
            }
        }
        let mut conducting = 0;
        for (bit, valve) in island.valves.iter().enumerate() {
            let latched = || c.d.get(self.first_latch + valve).is_some_and(|latch| *latch != 0.0);
            let on = match self.electrics.valves[*valve].kind {
                ValveKind::Switch => gates[*valve],
                ValveKind::Diode | ValveKind::Thyristor => latched(),
                ValveKind::GatedDiode => gates[*valve] && latched(),
            };
            conducting |= Conducting::from(on) << bit;
        }
        w.gates = gates;
        conducting
    }

    /// Makes the solution for a set of conducting valves the current one; it is worked out at its first use.
    pub(crate) fn choose(
        &self,
        island: usize,
        conducting: Conducting,
        w: &mut Work,
    ) -> Result<(), Unsolvable> {
        if !w.circuits[island].choose(conducting) {
            let solved = solve(&self.electrics, &self.electrics.islands[island], conducting)?;
            w.circuits[island].add(conducting, solved);
        }
        Ok(())
    }

    /// The valves of an island that conduct by themselves.
    pub(crate) fn natural_of(&self, island: usize) -> Conducting {
        let valves = self.electrics.islands[island].valves.iter().enumerate();
        let natural = valves.filter(|(_, valve)| self.electrics.valves[**valve].kind != ValveKind::Switch);
        natural.fold(0, |bits, (bit, _)| bits | 1 << bit)
    }

    /// What valves have done to a circuit that cannot be.
    fn unsolvable(&self, island: usize, conducting: Conducting, why: &Unsolvable) -> String {
        let circuit = &self.electrics.islands[island];
        let name = |two_pin: &usize| self.seats[circuit.two_pins[*two_pin].member].member.path.as_str();
        let valves = |on: bool| -> String {
            let which =
                circuit.valves.iter().enumerate().filter(|(bit, _)| (conducting >> bit & 1 == 1) == on);
            let mut names: Vec<&str> = which
                .map(|(_, v)| self.seats[self.electrics.valves[*v].member].member.path.as_str())
                .collect();
            names.dedup();
            names.join("`, `")
        };
        match why {
            Unsolvable::Loop(two_pins) => {
                let mut names: Vec<&str> = two_pins.iter().map(|(i, _)| name(i)).collect();
                names.dedup();
                format!(
                    "the conducting valves (`{}`) close a loop of ideal voltages among `{}`: give the valves a \
                     resistance, and do not let both valves of a leg conduct at once",
                    valves(true),
                    names.join("`, `")
                )
            }
            Unsolvable::Cut(two_pins) => format!(
                "the open valves (`{}`) leave the prescribed current of `{}` without a path: connect a resistance in \
                 parallel, or give the valves an off-state conductance",
                valves(false),
                two_pins.first().map_or("", name)
            ),
            Unsolvable::Slope(looks, source)
                if matches!(circuit.two_pins[*source].branch, crate::electrics::Branch::Given(_)) =>
            {
                format!(
                    "with the conducting valves (`{}`) the voltage of `{}` contains the slope of the current of `{}`, which \
                     is unknown: connect `di` of the source, or put a resistance in parallel to it, for instance of 1 MOhm",
                    valves(true),
                    name(looks),
                    name(source)
                )
            }
            Unsolvable::Slope(looks, source) => format!(
                "with the conducting valves (`{}`) the current of `{}` contains the slope of the voltage of `{}`, which \
                 is unknown: put a resistance in series to the source, for instance of 1 mOhm",
                valves(true),
                name(looks),
                name(source)
            ),
            Unsolvable::Floating(_) => format!(
                "the open valves (`{}`) leave a part of the circuit without any potential: connect it to a reference",
                valves(false)
            ),
        }
    }
}

/// Kinds of connection that have three voltages of their own.
impl Role {
    pub(crate) fn joined(self) -> Option<Joined> {
        if let Role::Machine(joined) = self { Some(joined) } else { None }
    }
}
