//! When a conditional subsystem runs.

use blocksim_block::event::{Change, Subject};
use blocksim_block::{
    Block, CONDITION, Context, Crossing, Discrete, Given, Input, Interface, InterfaceError, Output, PortType,
    Scratch,
};
use blocksim_signal::{Kind, Shape};

use super::{Condition, WhenEnabled};

/// What a gate gives: whether the subsystem is enabled, the time at which it runs, and the time of the last reset.
const SHAPE: Shape = Shape::Vector(3);
/// The time at which a subsystem without trigger runs: always.
const ALWAYS: f64 = -1.0;
/// The time of what has not happened yet.
const NEVER: f64 = -2.0;

/// Places of the discrete states; the first three are what the gate gives.
const ENABLED: usize = 0;
const AT: usize = 1;
const RESET: usize = 2;
/// Whether it is enabled, whatever the subsystem around it is.
const OWN: usize = 3;
/// On which side of zero `trigger` and `reset` were.
const TRIGGER_SIDE: usize = 4;
const RESET_SIDE: usize = 5;
/// First of those that say which inputs have guards; they do not change.
const GUARDED: usize = 6;

/// Memory of a trigger that was never looked at.
const UNSEEN: f64 = 2.0;

const SWITCHED: &[Change] = &[Change::to(1.0, "is enabled"), Change::to(0.0, "is disabled")];
const TRIGGERED: &[Change] = &[Change::any("is triggered")];
const WAS_RESET: &[Change] = &[Change::any("is reset")];

/// What a gate gave, as a block inside sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GateState {
    pub enabled: bool,
    at: f64,
    /// When states were set to their initial values last; negative if never.
    pub reset: f64,
}

impl GateState {
    /// From the values of an input that comes from a gate.
    pub fn new(values: &[f64]) -> Self {
        Self { enabled: values[ENABLED] > 0.0, at: values[AT], reset: values[RESET] }
    }

    /// Whether the subsystem runs at this time.
    pub fn runs(self, t: f64) -> bool {
        self.enabled && (self.at == ALWAYS || self.at == t)
    }

    /// The time of the last trigger.
    pub fn trigger(self) -> f64 {
        self.at
    }
}

/// The input by which a block asks a gate.
pub(crate) fn gate_input() -> Input {
    Input { kind: Some(Kind::Real), ..Input::any(CONDITION).shape(SHAPE) }
}

/// The block that knows when a conditional subsystem runs.
#[derive(Debug)]
pub(crate) struct Gate {
    pub condition: Condition,
    /// Whether the subsystem is within another conditional one, whose gate is the last input.
    pub nested: bool,
}

impl Gate {
    /// The value of one of its inputs, if there is one.
    fn value(&self, c: &Context, name: &str) -> Option<f64> {
        self.condition.inputs().position(|input| input == name).map(|input| c.scalar(input))
    }

    fn outer(&self, c: &Context) -> GateState {
        if self.nested {
            GateState::new(c.input(self.condition.inputs().count()))
        } else {
            GateState { enabled: true, at: ALWAYS, reset: NEVER }
        }
    }

    /// The inputs that are watched for zero crossings, if they are real.
    fn watched(&self) -> impl Iterator<Item = (&'static str, Crossing)> {
        let Condition { enable, trigger, reset, .. } = &self.condition;
        let crossings = [enable.map(|_| Crossing::Either), *trigger, *reset];
        super::INPUTS.into_iter().zip(crossings).filter_map(|(name, crossing)| Some((name, crossing?)))
    }
}

impl Block for Gate {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let mut interface = Interface::new();
        for name in self.condition.inputs() {
            interface = interface.input(Input::any(name).scalar());
        }
        if self.nested {
            interface = interface.input(gate_input());
        }
        let initial = |name: &str, value: f64| Discrete::new(name, value);
        let has_enable = self.condition.enable.is_some();
        let enabled = initial("enabled", 0.0);
        let at = initial("at", if self.condition.trigger.is_some() { NEVER } else { ALWAYS });
        let reset = initial("reset", NEVER);
        let called = |state: Discrete, is: bool, table| {
            if is { state.changes(table, Subject::default()) } else { state }
        };
        interface.discrete = vec![
            called(enabled, has_enable, SWITCHED),
            called(at, self.condition.trigger.is_some(), TRIGGERED),
            called(reset, self.condition.reset.is_some(), WAS_RESET),
            initial("own", 0.0),
            initial("trigger_side", UNSEEN),
            initial("reset_side", UNSEEN),
        ];
        for (name, crossing) in self.watched() {
            // A truth value changes at major steps alone.
            let guarded = given.input_or_unknown(name).kind == Kind::Real;
            interface = interface.discrete(format!("guarded_{name}"), f64::from(guarded));
            if guarded {
                interface = interface.guard_when(crossing, name);
            }
        }
        Ok(interface
            .output(Output::like(CONDITION, PortType::scalar().shaped(SHAPE)))
            .called_by_mode()
            .settles())
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        let outer = self.outer(c);
        if outer.runs(c.t) {
            let own = self.value(c, "enable").is_none_or(|enable| enable > 0.0);
            let was = d[OWN] > 0.0;
            d[OWN] = f64::from(own);
            if was && !own && self.condition.enable == Some(WhenEnabled::Reset) {
                // Nobody sees the states until it is enabled again.
                d[RESET] = c.t;
            }
            for (name, edge, side, time) in [
                ("trigger", self.condition.trigger, TRIGGER_SIDE, AT),
                ("reset", self.condition.reset, RESET_SIDE, RESET),
            ] {
                if let (Some(edge), Some(value)) = (edge, self.value(c, name))
                    && happens(edge, &mut d[side], value)
                    && own
                {
                    d[time] = c.t;
                }
            }
        }
        d[ENABLED] = f64::from(d[OWN] > 0.0 && outer.enabled);
        if self.condition.trigger.is_none() {
            d[AT] = outer.at;
        }
        d[RESET] = d[RESET].max(outer.reset);
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        y.copy_from_slice(&c.d[..y.len()]);
    }

    fn guards(&self, c: &Context, _w: &mut Scratch, g: &mut [f64]) {
        let guarded = self.watched().zip(&c.d[GUARDED..]).filter(|(_, guarded)| **guarded > 0.0);
        let values = guarded.filter_map(|((name, _), _)| self.value(c, name));
        g.iter_mut().zip(values).for_each(|(g, value)| *g = value);
    }
}

/// Whether a signal of this value has gone through zero in this way since it was looked at last. `memory` is at first
/// [`UNSEEN`], and the first look is no edge. A value of zero is half of the sign that it is about to get: what reaches
/// zero has crossed it, and does not cross it again when it leaves.
fn happens(edge: Crossing, memory: &mut f64, value: f64) -> bool {
    let before = *memory;
    let now = match before {
        _ if value != 0.0 => value.signum(),
        1.0 => -0.5,
        -1.0 => 0.5,
        UNSEEN => 0.0,
        stays => stays,
    };
    *memory = now;
    let seen = before != UNSEEN;
    let rises = seen && before <= 0.0 && now > 0.0;
    let falls = seen && before >= 0.0 && now < 0.0;
    match edge {
        Crossing::Rising => rises,
        Crossing::Falling => falls,
        _ => rises || falls,
    }
}
