//! What the blocks that make gates have in common: what their times must be, the output of gates, memory.

use blocksim_block::prelude::*;

use super::modulation::{BRANCHES, Modulation, Modulator, Sampling};

/// The output of the gates, which comes first.
pub(super) const GATES: usize = 0;

/// Reports a dead time, s, that leaves no room for pulses of this frequency, Hz.
pub(super) fn validate(switching_frequency: f64, dead_time: f64, errors: &mut ParamErrors) {
    let half = 0.5 / switching_frequency;
    if dead_time >= half {
        let message =
            format!("`dead_time` is {dead_time} s, but must be less than half of a period, {half} s");
        let error = ParamError::new("dead_time", message).beside(&["switching_frequency"]);
        errors.add(error.help("usual are 0.5 us to 5 us"));
    }
}

/// The output `gates` with this many truth values.
pub(super) fn gates(number: usize, order: &'static str) -> Output {
    Output::like("gates", PortType::boolean().shaped(Shape::Vector(number))).doc(order)
}

/// Adds the memory, the events and, for natural sampling, the guards of a modulator of as many legs as there are names.
pub(super) fn remember(interface: Interface, sampling: Sampling, legs: &[&str]) -> Interface {
    let mut interface = interface.time_events();
    for (i, initial) in Modulator::initial(legs.len()).into_iter().enumerate() {
        interface = interface.discrete(format!("modulator[{i}]"), initial);
    }
    if sampling == Sampling::Natural {
        for leg in legs {
            interface = interface.guard(*leg).detail((legs.len() > 1).then(|| format!("leg {leg}")));
        }
        interface = interface.called("switches up", "switches down");
    }
    interface
}

/// Adds the branches of a law of modulation whose references are looked at all the time: memory and guards.
pub(super) fn hold_branches(interface: Interface, modulation: Modulation) -> Interface {
    let interface =
        interface.discrete("link", 0.0).guard("link").called("gets a DC link", "loses the DC link");
    if !modulation.is_discontinuous() {
        return interface;
    }
    let interface = interface.discrete("low_leads", 0.0).guard("low_leads");
    interface.called("lets another leg rest", "lets another leg rest")
}

/// Records the branches of a law of modulation for phase voltages, V, and a link, V: in the memory and the guards from these on.
/// Returns the branches that are held, and those of now, to which the memory is set.
pub(super) fn record_branches<'r>(
    l: &Recording<'r>,
    modulation: Modulation,
    (v, vdc): ([Value<'r>; 3], Value<'r>),
    [memory, guard]: [usize; 2],
) -> [[Value<'r>; BRANCHES]; 2] {
    let (mut held, now) = ([l.constant(0.0); BRANCHES], modulation.branches(v, vdc));
    for (i, jump) in modulation.jumps(v, vdc).enumerate() {
        held[i] = l.d()[memory + i];
        l.settle(memory + i, now[i]);
        l.guard(guard + i, jump);
    }
    [held, now]
}

/// Records what the memory of a modulator becomes, its guards and its first gates, those of all legs. Legs are turned by the
/// first duties, and watched by the second ones, which do not jump between the instants at which they may turn.
pub(super) fn record<'r>(l: &Recording<'r>, modulator: &Modulator, [turning, duties]: [&[Value<'r>]; 2]) {
    let (t, memory) = (l.time(), &l.d()[..Modulator::cells(duties.len())]);
    let settled = modulator.settled(t, turning, memory);
    settled.into_iter().enumerate().for_each(|(i, value)| l.settle(i, value));
    if modulator.sampling == Sampling::Natural {
        modulator.guards(t, duties, memory).enumerate().for_each(|(i, guard)| l.guard(i, guard));
    }
    for leg in 0..duties.len() {
        let gates = Modulator::leg(memory, leg);
        gates.into_iter().enumerate().for_each(|(i, gate)| l.set(GATES, 2 * leg + i, gate));
    }
}
