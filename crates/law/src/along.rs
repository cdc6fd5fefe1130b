//! Rates of some values of a law along a direction, and whether the law is smooth where they are taken.

use crate::{Binary, Code, Id, Op, Program, Sources, Unary, rates};

/// Distance from a kink or jump, as a part of the numbers that meet there or of one, within which the law counts as not smooth.
const NEAR: f64 = 1e-9;

/// Some values of a law, ready to be followed along directions in the space of its inputs, states and memories. Modes are held.
#[derive(Debug, Clone)]
pub struct Along {
    /// Number of the values.
    count: usize,
    rates: Code,
    edges: Vec<Edge>,
    /// The values that meet at the edges, two for each.
    meeting: Code,
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
        let apart = |a: f64, b: f64| (a - b).abs() <= NEAR * a.abs().max(b.abs()).max(1.0);
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
        let meeting: Vec<Id> = edges.iter().flat_map(|edge| edge.values()).collect();
        let (rates, meeting) = (rates_of(program, wanted, widths), Code::new(program, &meeting));
        Self { count: wanted.len(), rates, edges, meeting }
    }

    /// Number of registers that [`run`](Self::run) needs.
    pub fn registers(&self) -> usize {
        self.rates.registers().max(self.meeting.registers())
    }

    /// What decides about the side on which the law is computed and is just about to change there, two values for each; a
    /// law is smooth along directions in which their rates are equal, or zero if there is but one.
    pub fn edges_at(&self, sources: &Sources, registers: &mut [f64]) -> Vec<(Id, Option<Id>)> {
        if self.edges.is_empty() {
            return Vec::new();
        }
        self.meeting.run(sources, registers);
        let value = |i: usize| self.meeting.result(registers, i);
        let edges = self.edges.iter().enumerate();
        let near = edges.filter(|(i, edge)| edge.is_near(value(2 * i), value(2 * i + 1)));
        near.map(|(_, edge)| match *edge {
            Edge::Equal(a, b) => (a, Some(b)),
            Edge::Zero(a) | Edge::Whole(a) | Edge::Half(a) => (a, None),
        })
        .collect()
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
fn edges(program: &Program, wanted: &[Id]) -> Vec<Edge> {
    let mut needed = vec![false; program.instructions.len()];
    wanted.iter().for_each(|id| needed[id.at()] = true);
    let mut edges = Vec::new();
    for at in (0..needed.len()).rev() {
        if !needed[at] {
            continue;
        }
        let op = program.instructions[at].op;
        op.operands().for_each(|id| needed[id.at()] = true);
        match op {
            Op::Compare(_, a, b) | Op::Binary(Binary::Min | Binary::Max, a, b) => {
                edges.push(Edge::Equal(a, b))
            }
            Op::Clamp(a, lower, upper) => edges.extend([Edge::Equal(a, lower), Edge::Equal(a, upper)]),
            Op::Unary(Unary::Abs | Unary::Sign, a) => edges.push(Edge::Zero(a)),
            Op::Unary(Unary::Floor | Unary::Ceil, a) => edges.push(Edge::Whole(a)),
            Op::Unary(Unary::Round, a) => edges.push(Edge::Half(a)),
            _ => {}
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Recorder;

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
