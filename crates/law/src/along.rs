//! Rates of some values of a law along a direction, and whether the law is smooth where they are taken.

use crate::{Binary, Code, Id, Op, Program, Sources, Unary, rates};

/// Distance from a kink or jump, as a part of the numbers that meet there or of the size below, within which the law counts as not smooth.
const NEAR: f64 = 1e-9;
/// What is smaller may be meant: flows of 1e-9 m^3/s and their limits are nothing unusual.
const SMALL: f64 = 1e-3;

/// Some values of a law, ready to be followed along directions in the space of its inputs, states and memories. Modes are held.
#[derive(Debug, Clone)]
pub struct Along {
    /// Number of the values.
    count: usize,
    rates: Code,
    /// By the instruction that they belong to, rising.
    edges: Vec<(usize, Edge)>,
    /// The values that meet at the edges, two for each, then those of the conditions.
    meeting: Code,
    /// What the values follow from; nothing without edges.
    ops: Vec<Op>,
    wanted: Vec<Id>,
    /// Truth values that others depend on.
    conditions: Vec<Id>,
}

/// Where a law has a kink or jumps: where two values are equal, or where one is a whole number, or a half more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Edge {
    Equal(Id, Id),
    Zero(Id),
    Whole(Id),
    Half(Id),
}

impl Edge {
    fn values(self) -> [Id; 2] {
        match self {
            Self::Equal(a, b) => [a, b],
            Self::Zero(a) | Self::Whole(a) | Self::Half(a) => [a, a],
        }
    }

    fn is_near(self, a: f64, b: f64) -> bool {
        // No number is near a limit that is infinite.
        let apart = |a: f64, b: f64| {
            let distance = (a - b).abs();
            distance.is_finite() && distance <= NEAR * a.abs().max(b.abs()).max(SMALL)
        };
        match self {
            // Both infinite: neither limits anything.
            Self::Equal(..) => a == b || apart(a, b),
            Self::Zero(_) => apart(a, 0.0),
            Self::Whole(_) => apart(a, a.round()),
            Self::Half(_) => apart(a - 0.5, (a - 0.5).round()),
        }
    }
}

impl Along {
    /// Those of `wanted`, of a law with as many inputs, states and memories.
    #[must_use]
    pub fn new(program: &Program, wanted: &[Id], widths: [usize; 3]) -> Self {
        let edges = edges(program, wanted);
        let ops: Vec<Op> = match edges.is_empty() {
            true => Vec::new(),
            false => program.instructions.iter().map(|instruction| instruction.op).collect(),
        };
        let mut conditions: Vec<Id> = ops.iter().flat_map(|op| decisive(*op)).collect();
        conditions.sort_unstable();
        conditions.dedup();
        let meeting = edges.iter().flat_map(|(_, edge)| edge.values());
        let meeting: Vec<Id> = meeting.chain(conditions.iter().copied()).collect();
        let (rates, meeting) = (rates_of(program, wanted, widths), Code::new(program, &meeting));
        Self { count: wanted.len(), rates, edges, meeting, ops, wanted: wanted.to_vec(), conditions }
    }

    /// Number of registers that [`run`](Self::run) needs.
    pub fn registers(&self) -> usize {
        self.rates.registers().max(self.meeting.registers())
    }

    /// What decides about the side on which the law is computed and is just about to change there, two values for each; a
    /// law is smooth along directions in which their rates are equal, or zero if there is but one. What has no say there, such as a
    /// comparison in a branch that is not taken, does not count.
    pub fn edges_at(&self, sources: &Sources, registers: &mut [f64]) -> Vec<(Id, Option<Id>)> {
        if self.edges.is_empty() {
            return Vec::new();
        }
        self.meeting.run(sources, registers);
        let value = |i: usize| self.meeting.result(registers, i);
        let mut near = vec![false; self.ops.len()];
        for (i, (at, edge)) in self.edges.iter().enumerate() {
            near[*at] |= edge.is_near(value(2 * i), value(2 * i + 1));
        }
        if !near.contains(&true) {
            return Vec::new();
        }
        let first = 2 * self.edges.len();
        let is_true = |id: Id| match self.conditions.binary_search(&id) {
            Ok(i) => value(first + i) != 0.0,
            Err(_) => false,
        };
        let counts = self.counting(&near, &is_true);
        let edges = self
            .edges
            .iter()
            .enumerate()
            .filter(|(i, (at, edge))| counts[*at] && edge.is_near(value(2 * i), value(2 * i + 1)));
        edges
            .map(|(_, (_, edge))| match *edge {
                Edge::Equal(a, b) => (a, Some(b)),
                Edge::Zero(a) | Edge::Whole(a) | Edge::Half(a) => (a, None),
            })
            .collect()
    }

    /// Instructions that have a say in the values, with those at whose edge the law is.
    fn counting(&self, near: &[bool], is_true: &dyn Fn(Id) -> bool) -> Vec<bool> {
        // What stays on its side, whatever happens at edges.
        let mut stays: Vec<bool> = Vec::with_capacity(self.ops.len());
        for (at, op) in self.ops.iter().enumerate() {
            let all = op.operands().all(|id| stays[id.at()]);
            let by = |id: Id, decides: bool| stays[id.at()] && is_true(id) == decides;
            stays.push(
                !near[at]
                    && match *op {
                        Op::Select(c, a, b) => stays[c.at()] && stays[if is_true(c) { a } else { b }.at()],
                        Op::And(a, b) => all || by(a, false) || by(b, false),
                        Op::Or(a, b) => all || by(a, true) || by(b, true),
                        _ => all,
                    },
            );
        }
        let mut counts = vec![false; self.ops.len()];
        self.wanted.iter().for_each(|id| counts[id.at()] = true);
        for at in (0..self.ops.len()).rev() {
            if !counts[at] {
                continue;
            }
            let by = |id: Id, decides: bool| stays[id.at()] && is_true(id) == decides;
            match self.ops[at] {
                Op::Select(c, a, b) if stays[c.at()] => counts[if is_true(c) { a } else { b }.at()] = true,
                Op::And(a, b) if by(a, false) || by(b, false) => {}
                Op::Or(a, b) if by(a, true) || by(b, true) => {}
                op => op.operands().for_each(|id| counts[id.at()] = true),
            }
        }
        counts
    }

    /// Writes the rates of the values along a direction. The inputs of the sources are those of the law, and behind them the direction:
    /// rates of inputs, states and memories.
    ///
    /// # Panics
    /// Panics if there are fewer sources or registers than that.
    pub fn run(&self, sources: &Sources, registers: &mut [f64], mut write: impl FnMut(usize, f64)) {
        self.rates.run(sources, registers);
        (0..self.count).for_each(|i| write(i, self.rates.result(registers, i)));
    }
}

/// The truth values that decide which others of an instruction have a say.
fn decisive(op: Op) -> impl Iterator<Item = Id> {
    let found = match op {
        Op::Select(c, ..) => [Some(c), None],
        Op::And(a, b) | Op::Or(a, b) => [Some(a), Some(b)],
        _ => [None, None],
    };
    found.into_iter().flatten()
}

/// A program for the rates of some values, with the direction behind the inputs.
fn rates_of(program: &Program, wanted: &[Id], [inputs, states, memories]: [usize; 3]) -> Code {
    let outputs = wanted.iter().map(|id| (String::new(), *id)).collect();
    let alone = Program {
        outputs,
        modes: Vec::new(),
        kinks: Vec::new(),
        turns: Vec::new(),
        requirements: Vec::new(),
        states: program
            .states
            .iter()
            .map(|state| crate::State { derivative: None, ..state.clone() })
            .collect(),
        memories: program
            .memories
            .iter()
            .map(|memory| crate::Memory { next: None, ..memory.clone() })
            .collect(),
        ..program.clone()
    };
    let seed = |op: Op| match op {
        Op::Input(i) => Some(Op::Input(inputs as u32 + i)),
        Op::State(i) => Some(Op::Input((2 * inputs) as u32 + i)),
        Op::Memory(i) => Some(Op::Input((2 * inputs + states) as u32 + i)),
        _ => None,
    };
    let mut found = rates(&alone, &seed);
    found.inputs.resize(2 * inputs + states + memories, String::new());
    let found = found.optimised();
    Code::new(&found, &found.output_values())
}

/// Where the values may have a kink or jump.
fn edges(program: &Program, wanted: &[Id]) -> Vec<(usize, Edge)> {
    let mut needed = vec![false; program.instructions.len()];
    wanted.iter().for_each(|id| needed[id.at()] = true);
    let mut edges = Vec::new();
    for at in (0..needed.len()).rev() {
        if !needed[at] {
            continue;
        }
        let op = program.instructions[at].op;
        op.operands().for_each(|id| needed[id.at()] = true);
        let own: [Option<Edge>; 2] = match op {
            Op::Compare(_, a, b) | Op::Binary(Binary::Min | Binary::Max, a, b) => {
                [Some(Edge::Equal(a, b)), None]
            }
            Op::Clamp(a, lower, upper) => [Some(Edge::Equal(a, lower)), Some(Edge::Equal(a, upper))],
            Op::Unary(Unary::Abs | Unary::Sign, a) => [Some(Edge::Zero(a)), None],
            Op::Unary(Unary::Floor | Unary::Ceil, a) => [Some(Edge::Whole(a)), None],
            Op::Unary(Unary::Round, a) => [Some(Edge::Half(a)), None],
            _ => [None, None],
        };
        edges.extend(own.into_iter().flatten().map(|edge| (at, edge)));
    }
    edges.reverse();
    edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Recorder, Relation};

    /// Rates of a function of two inputs at a point along a direction, and how many edges are there.
    fn at(program: &Program, point: [f64; 2], direction: [f64; 2]) -> (Vec<f64>, usize) {
        let along = Along::new(program, &program.output_values(), [2, 0, 0]);
        let mut registers = vec![0.0; along.registers()];
        let inputs = [&point[..], &direction[..]].concat();
        let sources = Sources { inputs: &inputs, ..Sources::default() };
        let edges = along.edges_at(&sources, &mut registers).len();
        let mut found = Vec::new();
        along.run(&sources, &mut registers, |_, rate| found.push(rate));
        (found, edges)
    }

    #[test]
    fn rates_are_sums_of_slopes() {
        let recorder = Recorder::new();
        let (u, v) = (recorder.input("u"), recorder.input("v"));
        recorder.output("y", u.sin() * v);
        recorder.output("z", u * 3.0 - v);
        let (found, edges) = at(&recorder.finish().optimised(), [0.4, 2.0], [1.0, -0.5]);
        let exact = 0.4_f64.cos() * 2.0 - 0.5 * 0.4_f64.sin();
        assert!((found[0] - exact).abs() < 1e-15 && found[1] == 3.5 && edges == 0, "{found:?}");
    }

    /// Conditional integration: an error that is zero matters only where the output is limited.
    #[test]
    fn what_has_no_say_is_no_edge() {
        let recorder = Recorder::new();
        let (e, v) = (recorder.input("e"), recorder.input("v"));
        let (zero, limit) = (recorder.constant(0.0), recorder.constant(1.0));
        let winds_up = v.live(Relation::Greater, limit).and(e.live(Relation::Greater, zero));
        recorder.output("y", winds_up.select(zero, 3.0 * e));
        let program = recorder.finish().optimised();
        assert_eq!(at(&program, [0.0, 0.5], [1.0, 0.0]), (vec![3.0], 0));
        assert_eq!(at(&program, [0.0, 1.5], [1.0, 0.0]).1, 1, "limited");
        assert_eq!(at(&program, [-1.0, 1.0], [1.0, 0.0]).1, 0, "pointing back");
        assert_eq!(at(&program, [0.5, 1.0], [1.0, 0.0]).1, 1, "at the limit, pushing");
        assert_eq!(at(&program, [0.0, 1.0], [1.0, 0.0]).1, 2, "both");
    }

    #[test]
    fn a_limit_that_is_infinite_is_no_edge() {
        let recorder = Recorder::new();
        let (u, v) = (recorder.input("u"), recorder.input("v"));
        recorder.output("y", u.min(v));
        let program = recorder.finish().optimised();
        assert_eq!(at(&program, [0.3, f64::INFINITY], [1.0, 0.0]), (vec![1.0], 0));
    }

    #[test]
    fn a_law_is_at_an_edge_only_where_its_sides_meet() {
        let recorder = Recorder::new();
        let (u, v) = (recorder.input("u"), recorder.input("v"));
        recorder.output("y", u.abs().min(v));
        let program = recorder.finish().optimised();
        for (point, count) in [([0.3, 5.0], 0), ([0.3, 0.3], 1), ([0.0, 0.0], 2), ([0.5, 0.5 + 1e-6], 0)] {
            assert_eq!(at(&program, point, [1.0, 0.0]).1, count, "{point:?}");
        }
    }
}
