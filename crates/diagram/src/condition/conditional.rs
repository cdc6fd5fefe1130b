//! A block inside a conditional subsystem.

use std::sync::Arc;

use blocksim_block::law::BlockLaw;
use blocksim_block::{Block, Context, Discrete, Given, Interface, InterfaceError, JumpPhrase, Scratch};
use blocksim_signal::SampleTime;

use super::gate::{GateState, gate_input};

/// A block that is called while its subsystem runs. Meanwhile its states stand still, its conditions are not watched, and it gives what
/// it gave last, which the engine keeps for it ([`Interface::holds`]).
///
/// Its discrete states are those of the block, the held outputs, then, if states are reset, the initial values of the continuous and
/// the discrete states and the times of the last reset of the discrete and of the continuous ones, and, if there is a trigger, the time
/// of the last update. Discrete states are reset before anything is made of them: others must not act on what they were, at an instant
/// at which that is no more. A block that measures the time since the last step has a time of its own, which stands still with it and
/// begins anew with its states: there follow
/// how far it is behind, and when it stopped.
#[derive(Debug, Clone)]
pub(crate) struct Conditional {
    inner: Arc<dyn Block>,
    /// Whether a subsystem around it has a trigger, sets states back, or does not always run.
    triggered: bool,
    resets: bool,
    pauses: bool,
    /// Output groups that need not ask the gate: they show states, which stand still.
    free: Vec<bool>,
    /// Output groups that show states alone, so that they have a value before the block has run.
    shows_states: Vec<bool>,
    /// The output ports of each group.
    ports: Vec<Vec<usize>>,
    /// First discrete state of the block itself that holds its outputs, if it has some.
    holds: Option<usize>,
    /// Whether the block measures the time since the last step or hit, or waits for a time.
    own_time: bool,
}

/// The time at which a block stopped that runs.
const RUNNING: f64 = -1.0;

/// Where the discrete states of a block lie.
struct Layout {
    /// Number of those of the block itself.
    own: usize,
    /// First of the held outputs.
    held: usize,
    /// First of the initial values: continuous states, then discrete ones.
    initial: usize,
    /// The time of the last reset of the discrete states, then that of the continuous ones.
    reset: usize,
    /// The time of the last update.
    updated: usize,
    /// How far the time of the block is behind, and then when it stopped.
    behind: usize,
}

impl Conditional {
    /// A block within subsystems of which one may have a trigger, set states back, or pause. `interface` is what is known of its
    /// ports before those of others are.
    pub fn new(
        inner: Arc<dyn Block>,
        interface: &Interface,
        triggered: bool,
        resets: bool,
        pauses: bool,
    ) -> Self {
        let sampled = matches!(interface.sample_time, Some(SampleTime::Discrete { .. }));
        let by_itself =
            interface.uses_time || interface.accepts || interface.time_events || interface.settles;
        // What is reset while nobody sees it must not be seen.
        let stands = !(sampled || by_itself || triggered || resets && pauses);
        let reads_nothing = |reads: &Option<Vec<usize>>| reads.as_ref().is_some_and(Vec::is_empty);
        let groups = interface.groups.iter();
        let shows_states: Vec<bool> = groups.map(|reads| !by_itself && reads_nothing(reads)).collect();
        let free = shows_states.iter().map(|shows| stands && *shows).collect();
        let of = |group: usize| {
            let ports = interface.group_of.iter().enumerate().filter(move |(_, of)| **of == group);
            ports.map(|(port, _)| port).collect()
        };
        let ports = (0..interface.groups.len()).map(of).collect();
        let own_time = interface.uses_time && (interface.accepts || sampled) || interface.waits;
        Self { free, shows_states, ports, own_time, holds: interface.holds, inner, triggered, resets, pauses }
    }

    /// The same with the law of the block inside, if that records one, and the interface that follows; `given` is what is known of the
    /// inputs, which lie so.
    ///
    /// # Errors
    /// What is wrong with the law.
    pub fn with_law(
        &self,
        given: &Given,
        inputs: &[(u32, u32)],
        outputs: &[(u32, u32)],
    ) -> Result<Option<(Self, Interface)>, String> {
        // With the same inputs it had an interface; without its law it would give nothing.
        let again = |error: InterfaceError| {
            format!("it takes its inputs once and refuses them then: {}", error.message)
        };
        let interface = self.inner.interface(given).map_err(again)?;
        let own = &inputs[..inputs.len().saturating_sub(1)];
        let Some(law) = BlockLaw::record(&self.inner, &interface, own, outputs)? else { return Ok(None) };
        let interface = law.complete(interface);
        let block = Self::new(Arc::new(law), &interface, self.triggered, self.resets, self.pauses);
        let interface = block.interface(given).map_err(again)?;
        Ok(Some((block, interface)))
    }

    fn layout(&self, c: &Context, states: usize, all: usize) -> Layout {
        let outputs = Self::count_outputs(c);
        let held = if self.holds.is_some() { 0 } else { outputs };
        let marks = if self.resets { states + 2 } else { 0 }
            + usize::from(self.triggered)
            + 2 * usize::from(self.own_time);
        let own = (all - held - marks) / if self.resets { 2 } else { 1 };
        let initial = own + held;
        let reset = initial + if self.resets { states + own } else { 0 };
        let updated = reset + if self.resets { 2 } else { 0 };
        Layout {
            own,
            held: self.holds.unwrap_or(own),
            initial,
            reset,
            updated,
            behind: updated + usize::from(self.triggered),
        }
    }

    /// What the block itself sees.
    fn inside<'a>(&self, c: &Context<'a>, d: &'a [f64], t: f64) -> Context<'a> {
        let inputs = &c.inputs[..c.inputs.len() - 1];
        let width = inputs.iter().map(|port| port.1 as usize).max().unwrap_or(0);
        Context { t, d, u: &c.u[..width], inputs, ..*c }
    }

    /// The same where nothing is handed mutably.
    fn looking<'a>(&self, c: &Context<'a>) -> Context<'a> {
        let layout = self.layout(c, c.x.len(), c.d.len());
        self.inside(c, &c.d[..layout.own], self.time(c, c.d, &layout))
    }

    /// The time as the block itself knows it; `all` are all discrete states.
    fn time(&self, c: &Context, all: &[f64], layout: &Layout) -> f64 {
        if self.own_time { c.t - all[layout.behind] } else { c.t }
    }

    /// Stops the time of the block while it does not run.
    fn keep_time(&self, c: &Context, d: &mut [f64], layout: &Layout) {
        if !self.own_time {
            return;
        }
        let [behind, stopped] = [layout.behind, layout.behind + 1];
        if !Self::runs(c) {
            if d[stopped] == RUNNING {
                d[stopped] = c.t;
            }
        } else if d[stopped] != RUNNING {
            let own = d[stopped] - d[behind];
            d[behind] = c.t - own;
            // It goes on where it stopped, and not a rounding before: the block has been there.
            while c.t - d[behind] < own {
                d[behind] = d[behind].next_down();
            }
            d[stopped] = RUNNING;
        }
    }

    /// Sets the discrete states of a block with so many continuous ones back, if they were not since the last reset; returns whether they
    /// change.
    fn begin_anew(&self, c: &Context, states: usize, d: &mut [f64], layout: &Layout) -> bool {
        let gate = Self::gate(c);
        if !self.resets || gate.reset < 0.0 || d[layout.reset] == gate.reset {
            return false;
        }
        // What the block inside holds it shows until it runs again, and is reset as late as that.
        let shown = match self.holds {
            Some(holds) if !gate.runs(c.t) => holds..holds + Self::count_outputs(c),
            _ => {
                d[layout.reset] = gate.reset;
                0..0
            }
        };
        let (own, rest) = d.split_at_mut(layout.own);
        let initial = &rest[layout.initial + states - layout.own..][..layout.own];
        let mut changes = false;
        for cells in [0..shown.start, shown.end..own.len()] {
            changes |= own[cells.clone()] != initial[cells.clone()];
            own[cells.clone()].copy_from_slice(&initial[cells]);
        }
        if self.own_time {
            // Its time begins anew, and stands if it does not run.
            d[layout.behind] = c.t;
            d[layout.behind + 1] = if gate.runs(c.t) { RUNNING } else { c.t };
        }
        changes
    }

    /// Number of values of all outputs.
    fn count_outputs(c: &Context) -> usize {
        c.outputs.iter().map(|port| port.1 as usize).max().unwrap_or(0)
    }

    fn gate(c: &Context) -> GateState {
        GateState::new(c.input(c.inputs.len() - 1))
    }

    fn runs(c: &Context) -> bool {
        Self::gate(c).runs(c.t)
    }

    /// Whether it has been updated at this very time: what it makes of its states from there on belongs to the next trigger.
    fn is_updated(&self, c: &Context, layout: &Layout) -> bool {
        self.triggered && c.d[layout.updated] == c.t
    }
}

impl Block for Conditional {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let mut interface = self.inner.interface(given)?;
        self.refuse(&interface)?;
        let gate = interface.inputs.len();
        interface.inputs.push(gate_input());
        for (group, reads) in interface.groups.iter_mut().enumerate() {
            if let Some(reads) = reads
                && !self.free.get(group).copied().unwrap_or(false)
            {
                reads.push(gate);
            }
        }
        let (own, states) = (interface.discrete.len(), interface.states.len());
        let outputs = interface.outputs.iter().map(|output| output.port_type.shape.len()).sum();
        if self.holds.is_none() {
            interface.holds = (outputs > 0).then_some(own);
            interface = interface.memory("held", outputs, 0.0);
        }
        if self.resets {
            interface = interface.memory("initial", states + own, 0.0).memory("reset", 2, -1.0);
            if own > 0 {
                interface.settles = true;
                interface.settling = interface.settling.map(|_| (0..interface.groups.len()).collect());
            }
            if states + own > 0 && !interface.jumps {
                interface.jumps = true;
                interface.jump_phrase = JumpPhrase("");
            }
        }
        // A time of its own stands still, so that nothing is pending at any time of the others.
        interface.pending_events = interface.time_events && !self.own_time;
        if self.triggered {
            interface.discrete.push(Discrete::new("updated", -1.0));
            // Updates come with the trigger, and there is no time in between that anything could be watched in.
            if matches!(interface.sample_time, Some(SampleTime::Discrete { .. })) {
                interface.sample_time = None;
                interface.subdivides = true;
            }
            interface.guards.clear();
            interface.time_events = false;
            interface.period = None;
            interface.turning_inputs.clear();
        }
        if self.own_time {
            interface.settles = true;
            interface.settling = interface.settling.map(|_| (0..interface.groups.len()).collect());
            interface = interface.discrete("behind", 0.0).discrete("stopped", RUNNING);
        }
        Ok(interface)
    }

    fn scratch(&self) -> Scratch {
        self.inner.scratch()
    }

    fn initialize(&self, c: &Context, x: &mut [f64], d: &mut [f64]) {
        let layout = self.layout(c, x.len(), d.len());
        self.inner.initialize(&self.inside(c, &[], c.t), x, &mut d[..layout.own]);
        if self.resets {
            d[layout.initial..][..x.len()].copy_from_slice(x);
            d.copy_within(..layout.own, layout.initial + x.len());
        }
        if self.holds.is_none() && self.shows_states.contains(&true) {
            let (own, rest) = d.split_at_mut(layout.own);
            let outputs = Self::count_outputs(c);
            let (mut w, now) = (self.inner.scratch(), Context { x, ..self.inside(c, own, c.t) });
            for (group, _) in self.shows_states.iter().enumerate().filter(|(_, shows)| **shows) {
                self.inner.outputs(group, &now, &mut w, &mut rest[..outputs]);
            }
        }
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        let layout = self.layout(c, c.x.len(), d.len());
        self.begin_anew(c, c.x.len(), d, &layout);
        self.keep_time(c, d, &layout);
        if Self::runs(c) {
            let t = self.time(c, d, &layout);
            self.inner.settle(&self.inside(c, &[], t), &mut d[..layout.own]);
        }
    }

    fn settle_in(&self, group: usize, c: &Context, d: &mut [f64]) {
        let layout = self.layout(c, c.x.len(), d.len());
        self.begin_anew(c, c.x.len(), d, &layout);
        self.keep_time(c, d, &layout);
        if Self::runs(c) {
            let t = self.time(c, d, &layout);
            self.inner.settle_in(group, &self.inside(c, &[], t), &mut d[..layout.own]);
        }
    }

    fn outputs(&self, group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let is_free = self.free.get(group).copied().unwrap_or(false);
        let layout = self.layout(c, c.x.len(), c.d.len());
        if is_free || Self::runs(c) && !self.is_updated(c, &layout) {
            self.inner.outputs(group, &self.looking(c), w, y);
        } else {
            let held = &c.d[layout.held..];
            for port in self.ports.get(group).into_iter().flatten() {
                let cells = c.output(*port);
                y[cells.clone()].copy_from_slice(&held[cells]);
            }
        }
    }

    fn derivatives(&self, c: &Context, w: &mut Scratch, dx: &mut [f64]) {
        if Self::runs(c) {
            self.inner.derivatives(&self.looking(c), w, dx);
        } else {
            dx.fill(0.0);
        }
    }

    fn update(&self, c: &Context, w: &mut Scratch, d: &mut [f64]) {
        if !Self::runs(c) {
            return;
        }
        let layout = self.layout(c, c.x.len(), d.len());
        if self.triggered {
            d[layout.updated] = Self::gate(c).trigger();
        }
        self.inner.update(&self.inside(c, &[], self.time(c, d, &layout)), w, &mut d[..layout.own]);
    }

    fn next_update(&self, c: &Context) -> f64 {
        let updated = self.layout(c, c.x.len(), c.d.len()).updated;
        let waits = self.triggered && Self::runs(c) && c.d[updated] != Self::gate(c).trigger();
        if waits { c.t } else { f64::INFINITY }
    }

    fn jump(&self, c: &Context, w: &mut Scratch, x: &mut [f64], d: &mut [f64]) -> bool {
        let layout = self.layout(c, x.len(), d.len());
        let gate = Self::gate(c);
        let mut jumped = self.begin_anew(c, x.len(), d, &layout);
        if self.resets && gate.reset >= 0.0 && d[layout.reset + 1] != gate.reset {
            let initial = &d[layout.initial..][..x.len()];
            jumped |= *x != *initial;
            x.copy_from_slice(initial);
            d[layout.reset + 1] = gate.reset;
        }
        if gate.runs(c.t) {
            jumped |=
                self.inner.jump(&self.inside(c, &[], self.time(c, d, &layout)), w, x, &mut d[..layout.own]);
        }
        jumped
    }

    fn guards(&self, c: &Context, w: &mut Scratch, g: &mut [f64]) {
        if Self::runs(c) {
            self.inner.guards(&self.looking(c), w, g);
        } else {
            g.fill(1.0);
        }
    }

    fn next_event(&self, c: &Context) -> f64 {
        if !Self::runs(c) {
            return f64::INFINITY;
        }
        let next = self.inner.next_event(&self.looking(c));
        if !self.own_time || next.is_infinite() {
            return next;
        }
        let behind = c.d[self.layout(c, c.x.len(), c.d.len()).behind];
        let mut t = next + behind;
        // By its own time the block must not be a rounding early.
        while t - behind < next {
            t = t.next_up();
        }
        t
    }

    fn pending_event(&self, c: &Context) -> f64 {
        if Self::runs(c) && !self.triggered { f64::INFINITY } else { self.inner.next_event(&self.looking(c)) }
    }

    fn accept(&self, c: &Context, d: &mut [f64]) -> bool {
        if !Self::runs(c) {
            return false;
        }
        let layout = self.layout(c, c.x.len(), d.len());
        let t = self.time(c, d, &layout);
        self.inner.accept(&self.inside(c, &[], t), &mut d[..layout.own])
    }

    fn end_time(&self) -> Option<f64> {
        self.inner.end_time()
    }
}

impl Conditional {
    /// Blocks that cannot stand still, or have no meaning at instants.
    fn refuse(&self, interface: &Interface) -> Result<(), InterfaceError> {
        let refused = |why: &str, help: &str| {
            Err(InterfaceError {
                code: "conditional",
                ports: Vec::new(),
                message: format!("it {why}"),
                help: Some(help.to_owned()),
            })
        };
        let outside = "place the block outside, and bring its signal in as an input of the subsystem";
        if interface.remembers.is_some() {
            return refused(
                "remembers a signal over time, which a subsystem that does not always run cannot do",
                outside,
            );
        }
        if interface.constraint.is_some() {
            return refused(
                "has outputs that are solved for, which a subsystem that does not always run cannot hold",
                outside,
            );
        }
        if interface.implicit || interface.subdivides {
            return refused(
                "chooses its own steps, which a subsystem that does not always run cannot do",
                outside,
            );
        }
        if self.triggered && !interface.states.is_empty() {
            return refused(
                "has continuous states, which do not change at the instants of a trigger",
                "use a sampled block such as DiscreteIntegrator, which is updated at each trigger, or `enable` in place of `trigger`",
            );
        }
        if self.triggered && interface.uses_time && interface.sample_time.is_some() {
            return refused("goes on from hit to hit, but between triggers nothing moves", outside);
        }
        if self.triggered && interface.accepts {
            return refused("follows its input over time, but between triggers it sees none", outside);
        }
        Ok(())
    }
}
