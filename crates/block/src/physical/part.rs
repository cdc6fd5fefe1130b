//! What a component declares before a network is assembled.

use blocksim_scene::Shape;
use blocksim_signal::Unit;

use super::{Component, Domain, Element, Gives, Handle, Moving, PhysicalPort, Pin, Reading};
use crate::event::{Change, Event, FRICTION, Subject};
use crate::{Crossing, Discrete, Floor, Guard, Input, Interface, Output, State};

/// What an output of a component needs before it can be computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Needs {
    /// States, positions and speeds: no input at the same instant.
    State,
    /// Voltages and currents as well.
    Electrics,
    /// Torques and accelerations as well.
    Motion,
}

/// The heat that leaves by the port of [`Part::heat_port`]: its voltage is the temperature there, K.
pub const HEAT: Handle = Handle::new("heat");

/// What the changes of the modes of friction are called.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionWords(pub &'static [Change]);

impl Default for FrictionWords {
    fn default() -> Self {
        Self(FRICTION)
    }
}

/// Ports, signals, states and elements of a component.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Part {
    /// Conserving ports.
    pub ports: Vec<PhysicalPort>,
    /// Signal inputs.
    pub inputs: Vec<Input>,
    /// Signal outputs and what they need.
    pub outputs: Vec<(Output, Needs)>,
    /// The number of the network that each output is; none where the component computes it, as in
    /// [`measure_state`](super::Component::measure_state).
    pub readings: Vec<Option<Reading>>,
    /// Which outputs are currents in per unit.
    pub currents_per_unit: Vec<usize>,
    /// Continuous states.
    pub states: Vec<State>,
    /// States that may go on moving where everything else is steady, by number.
    pub drifting: Vec<usize>,
    /// Discrete states; [`Component::jump`](super::Component::jump) changes them.
    pub discrete: Vec<Discrete>,
    /// Guards.
    pub guards: Vec<Guard>,
    /// The guards read positions, speeds and states alone; see [`Part::guards_of_state`].
    pub guards_of_state: bool,
    /// What the changes of the modes of friction are called: 0 where it sticks, 1 and -1 for the direction of slip, 2 where nothing
    /// presses.
    pub friction: FrictionWords,
    /// Lower and upper end of travel of its joint, rad or m, where a start that nobody gives must not be beyond them.
    pub travel: [Option<f64>; 2],
    /// Has [`Component::jump`](super::Component::jump).
    pub jumps: bool,
    /// Currents of its windings follow from its states by a curve.
    pub curved: bool,
    /// Has [`Component::next_event`](super::Component::next_event).
    pub time_events: bool,
    /// Has [`Component::linearize`](super::Component::linearize).
    pub linear: bool,
    /// Longest step of the solver while valves wait for a zero of the voltage, s: they must not sleep through one.
    pub max_step: Option<f64>,
    /// Voltages depend on time.
    pub uses_time: bool,
    /// Voltages and prescribed currents stay as they are until inputs or discrete states change.
    pub holds: bool,
    /// Has [`Component::voltage_rates`](super::Component::voltage_rates), or
    /// [`Component::current_rates`](super::Component::current_rates) if it gives currents.
    pub rates: bool,
    /// The input, by number, that tells these derivatives: there are [`rates`](Self::rates) where it is connected.
    pub rate_input: Option<usize>,
    /// Currents of windings at the start are not given: where the law of nodes asks for it, the network chooses others.
    pub currents_follow: bool,
    /// What the component contributes.
    pub elements: Vec<Element>,
    /// The voltage of each source and capacitance, where [`Component::voltages`] need not compute them.
    pub voltages: Vec<Gives>,
    /// The current of each winding and current source, where [`Component::currents`] need not compute them.
    pub currents: Vec<Gives>,
    /// Names of elements, with their indices in `elements`.
    pub handles: Vec<(Handle, usize)>,
    /// What is seen of the component: a frame port and a shape fixed to it. It acts on nothing.
    pub shapes: Vec<(usize, Shape)>,
    /// The electrical circuit that the component belongs to is integrated by the network itself, between the edges of
    /// its valves, and coupled to the mechanics in steps of this length, s; see [`Part::separate`].
    pub separate: Option<f64>,
}

impl Part {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a conserving port; they are numbered in this order.
    pub fn port(mut self, name: &str, domain: Domain, doc: &'static str) -> Self {
        self.ports.push(PhysicalPort { name: name.to_owned(), domain, doc, inner: false, open: false });
        self
    }

    /// Lets the last port stay unconnected: then no current flows there, and its potential is that which the rest gives it.
    pub fn open(mut self) -> Self {
        self.ports.iter_mut().last().into_iter().for_each(|port| port.open = true);
        self
    }

    /// Adds a node inside the component: numbered like the ports, but nothing can be connected to it. Inner nodes come
    /// after the ports.
    pub fn inner(mut self, name: &str, domain: Domain) -> Self {
        self.ports.push(PhysicalPort { name: name.to_owned(), domain, doc: "", inner: true, open: false });
        self
    }

    /// Adds the ports `r` (rod) and `c` (case).
    pub fn rod_and_case(self) -> Self {
        self.port("r", Domain::Rotational, "rod").port("c", Domain::Rotational, "case")
    }

    /// Adds the ports `p` and `n`.
    pub fn pins(self) -> Self {
        self.port("p", Domain::Electrical, "positive pin").port("n", Domain::Electrical, "negative pin")
    }

    /// Adds an input.
    pub fn input(mut self, input: Input) -> Self {
        self.inputs.push(input);
        self
    }

    /// Adds an output.
    pub fn output(mut self, output: Output, needs: Needs) -> Self {
        self.outputs.push((output, needs));
        self.readings.push(None);
        self
    }

    /// Adds a scalar output that is a number of the network: functions such as [`measure_state`](super::Component::measure_state) leave
    /// it alone.
    pub fn output_read(mut self, output: Output, reading: Reading) -> Self {
        self.outputs.push((output, reading.needs()));
        self.readings.push(Some(reading));
        self
    }

    /// Adds a scalar output in a unit.
    pub fn measures(self, name: &str, unit: &str, needs: Needs, doc: &'static str) -> Self {
        self.output(Output::real(name).unit(unit).doc(doc), needs)
    }

    /// The last output is a current, although its unit does not say so.
    pub fn is_current(mut self) -> Self {
        self.currents_per_unit.extend(self.outputs.len().checked_sub(1));
        self
    }

    /// Adds a scalar output in a unit that is a number of the network.
    pub fn reads(self, name: &str, unit: &str, reading: Reading, doc: &'static str) -> Self {
        self.output_read(Output::real(name).unit(unit).doc(doc), reading)
    }

    /// Adds a state.
    pub fn state(mut self, name: &str, initial: f64) -> Self {
        self.states.push(State::new(name, initial));
        self
    }

    /// Adds a state that is measured in a unit.
    pub fn state_in(self, name: &str, initial: f64, unit: &str) -> Self {
        let mut part = self.state(name, initial);
        let dimension = Unit::parse(unit).ok().map(|unit| unit.dimension);
        part.states.iter_mut().last().into_iter().for_each(|state| state.dimension = dimension);
        part
    }

    /// Adds a state with a nominal value: see [`State::nominal`].
    pub fn nominal_state(self, name: &str, initial: f64, nominal: f64) -> Self {
        let mut part = self.state(name, initial);
        part.states.iter_mut().last().into_iter().for_each(|state| state.nominal = Some(nominal));
        part
    }

    /// Says the least value that the law of the state added last knows: see [`Floor`].
    pub fn floor(mut self, floor: Floor) -> Self {
        self.states.iter_mut().last().into_iter().for_each(|state| state.floor = Some(floor));
        self
    }

    /// Adds a state that may go on moving where everything else is steady, of which a magnitude counts as nothing.
    pub fn drifting_sum(self, name: &str, negligible: f64) -> Self {
        let mut part = self.drifting_state(name, 0.0);
        part.states.iter_mut().last().into_iter().for_each(|state| state.negligible = negligible);
        part
    }

    /// Adds a state that may go on moving where everything else is steady: a place, a phase, what has flowed.
    pub fn drifting_state(mut self, name: &str, initial: f64) -> Self {
        self.drifting.push(self.states.len());
        self.state(name, initial)
    }

    /// Adds a discrete state. The component changes it in [`Component::jump`](super::Component::jump).
    pub fn discrete(mut self, name: &str, initial: f64) -> Self {
        self.discrete.push(Discrete::new(name, initial));
        self
    }

    /// Adds a mode, 0 at the start: a discrete state that the component changes in [`Component::jump`](super::Component::jump), with
    /// names for its changes, and a guard that is not negative while the mode is right.
    pub fn mode(mut self, name: &str, changes: &'static [Change]) -> Self {
        self.discrete.push(Discrete::new(name, 0.0).changes(changes, Subject::default()));
        self.guards.push(Guard { event: Event::Mode, ..Guard::new(name, Crossing::Holds) });
        self.jumps()
    }

    /// Steps may not be longer than this, s, where valves conduct by themselves.
    pub fn max_step(mut self, step: f64) -> Self {
        self.max_step = Some(step);
        self
    }

    /// What the component gives depends on time: it changes although no state and no input does.
    pub fn uses_time(mut self) -> Self {
        self.uses_time = true;
        self
    }

    /// Has [`Component::linearize`](super::Component::linearize); the component has one branch.
    pub fn linear(mut self) -> Self {
        self.linear = true;
        self
    }

    /// Has [`Component::voltage_rates`](super::Component::voltage_rates): the voltages are functions of time alone.
    pub fn rates(mut self) -> Self {
        self.rates = true;
        self
    }

    /// The last input tells the derivatives of the voltages or currents that the component gives.
    pub fn rate_input(mut self) -> Self {
        self.rate_input = self.inputs.len().checked_sub(1);
        self
    }

    /// Lets the network choose the currents of windings at the start where the law of nodes asks for it.
    pub fn currents_follow(mut self) -> Self {
        self.currents_follow = true;
        self
    }

    /// Promises that voltages and prescribed currents stay as they are until inputs or discrete states change.
    pub fn holds(mut self) -> Self {
        self.holds = true;
        self
    }

    /// Lets the network integrate the circuit that this component belongs to by itself: from one instant where a
    /// component of it changes by itself ([`Component::next_event`](super::Component::next_event)) to the next, at the speeds that are expected for
    /// the coupling step; the mechanics gets the mean of the torques. For circuits that switch much faster than the
    /// mechanics moves.
    pub fn separate(mut self, step: f64) -> Self {
        self.separate = Some(step);
        self
    }

    /// Adds a guard; its crossings are called like this.
    pub fn guard(mut self, name: &str, upwards: &'static str, downwards: &'static str) -> Self {
        let event = Event::Crossing { upwards, downwards };
        self.guards.push(Guard { event, ..Guard::new(name, Crossing::Either) });
        self
    }

    /// Adds a guard of a kink that is not held on its side between events; its crossings are called like this.
    pub fn kink(mut self, name: &str, upwards: &'static str, downwards: &'static str) -> Self {
        let event = Event::Crossing { upwards, downwards };
        self.guards.push(Guard { event, ..Guard::of_kink(name) });
        self
    }

    /// Adds a guard of a bend: where a smooth law grows so steeply that between two looks nothing of it may be seen. Steps end there as at a
    /// kink, which is no event.
    pub fn bend(mut self, name: impl Into<String>) -> Self {
        self.guards.push(Guard { event: Event::Bend, ..Guard::of_kink(name) });
        self
    }

    /// Has [`Component::guards_of_state`](super::Component::guards_of_state) in the place of `guards`, so that no torques have to be known
    /// for them.
    pub fn guards_of_state(mut self) -> Self {
        self.guards_of_state = true;
        self
    }

    /// Which of several things in the component the last guard is about, and the mode that it belongs to: `axis 2`.
    pub fn detail(mut self, detail: String) -> Self {
        let Some(guard) = self.guards.last_mut() else { return self };
        if let (Event::Mode, Some(changes)) =
            (guard.event, self.discrete.last_mut().and_then(|discrete| discrete.changes.as_mut()))
        {
            changes.subject.detail = Some(detail.clone());
        }
        guard.subject.detail = Some(detail);
        self
    }

    /// What the changes of the modes of friction are called, see [`Part::friction`].
    pub fn friction_called(mut self, table: &'static [Change]) -> Self {
        self.friction = FrictionWords(table);
        self
    }

    /// Where the joint, which has one freedom, ends; a start that nobody gives is checked against it.
    pub fn travel(mut self, lower: Option<f64>, upper: Option<f64>) -> Self {
        self.travel = [lower, upper];
        self
    }

    /// Currents of its windings follow from its states by a curve: those of windings in series, whose states are integrated each for itself,
    /// then differ by the errors of the method, and the network brings them together again.
    pub fn curved(mut self) -> Self {
        self.curved = true;
        self
    }

    /// Has [`Component::jump`](super::Component::jump).
    pub fn jumps(mut self) -> Self {
        self.jumps = true;
        self
    }

    /// Has [`Component::next_event`](super::Component::next_event).
    pub fn time_events(mut self) -> Self {
        self.time_events = true;
        self
    }

    /// Adds an element.
    pub fn element(mut self, element: Element) -> Self {
        self.elements.push(element);
        self
    }

    /// The voltage of the next source or capacitance; all of them or none.
    pub fn voltage_is(mut self, gives: Gives) -> Self {
        self.voltages.push(gives);
        self
    }

    /// The current of the next winding or current source; all of them or none.
    pub fn current_is(mut self, gives: Gives) -> Self {
        self.currents.push(gives);
        self
    }

    /// Writes the voltage of each source and capacitance, V.
    pub fn write_voltages(&self, component: &dyn Component, law: &Moving, v: &mut [f64]) {
        if self.voltages.is_empty() {
            component.voltages(law, v);
        } else {
            v.iter_mut().zip(&self.voltages).for_each(|(v, gives)| *v = gives.of(law));
        }
    }

    /// Writes the current of each winding and current source, A.
    pub fn write_currents(&self, component: &dyn Component, law: &Moving, i: &mut [f64]) {
        if self.currents.is_empty() {
            component.currents(law, i);
        } else {
            i.iter_mut().zip(&self.currents).for_each(|(i, gives)| *i = gives.of(law));
        }
    }

    /// Adds an element with a name, by which laws find its values.
    pub fn named(mut self, handle: Handle, element: Element) -> Self {
        self.handles.push((handle, self.elements.len()));
        self.element(element)
    }

    /// Adds the thermal port `h`, by which all heat of the component leaves, if that is wanted; behind all other ports.
    pub fn heat_port(self, wanted: bool) -> Self {
        if wanted { self.heat_port_named("h", HEAT, "thermal port that the heat leaves by") } else { self }
    }

    /// Adds a thermal port that heat of the component leaves by, behind the other ports and before the nodes inside.
    pub fn heat_port_named(self, name: &str, handle: Handle, doc: &'static str) -> Self {
        assert!(self.ports.iter().all(|port| !port.inner), "ports come before the nodes inside");
        let port = self.ports.len();
        self.port(name, Domain::Thermal, doc).named(handle, Element::Heat { port })
    }

    /// The domain of an electrical element, or of one with the same assembly: that of the ports it ends at.
    pub fn domain_of(&self, element: &Element) -> Domain {
        let port = |pin: Pin| match pin {
            Pin::Port(port) => self.ports.get(port).map(|port| port.domain),
            Pin::Phase(..) | Pin::Inner(_) | Pin::Ground => None,
        };
        element.pins().into_iter().find_map(port).unwrap_or(Domain::Electrical)
    }

    /// Adds a shape that is fixed to a frame port.
    pub fn shape(mut self, frame: usize, shape: Shape) -> Self {
        self.shapes.push((frame, shape));
        self
    }

    /// What the compiler needs to know of the component as a block, before its network is assembled.
    pub fn interface(self) -> Interface {
        let mut interface = Interface::new();
        interface.inputs = self.inputs;
        interface.ports = self.ports;
        interface.ports.retain(|port| !port.inner);
        interface.states = self.states;
        interface.discrete = self.discrete;
        interface.guards = self.guards;
        interface.jumps = self.jumps;
        interface.time_events = self.time_events;
        for (output, needs) in self.outputs {
            interface = match needs {
                Needs::State => interface.output_from_state(output),
                Needs::Electrics | Needs::Motion => interface.output(output),
            };
        }
        interface
    }
}
