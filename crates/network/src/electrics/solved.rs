//! Modified nodal analysis of an island for one set of conducting valves.
//!
//! With the conductances `G`, the incidence `A` of all branches that prescribe a voltage (sources, capacitances, wires,
//! ideal contacts, transformers) and that of the branches whose current is given, `A_w`,
//!
//! ```text
//! | G  A' | | v |   | -A_w' i_w |      Kirchhoff's law at every node
//! | A -R  | | i | = |     e     |      prescribed voltages
//! ```
//!
//! with the resistances `R` of conducting valves, which may be zero: as conductances they would make currents out of the
//! rounding of potentials. Ordinary resistances are among them where something else conducts far less ([`resist`]): beside 1 S,
//! the sum of the conductances of a node has nine digits of a leak of 1e-7 S. So
//! every voltage and every current is a linear form over the given values `(e, i_w, 1)`. Parts of the circuit that
//! nothing but given currents connects to ground float: one of their nodes is held at zero here, through which no
//! current flows as long as the given currents obey Kirchhoff's law, and [`Floating`] finds the true potential.
//! Where capacitances close loops, the equations of their currents stand in the place of their voltages ([`loops`]).

use std::collections::HashMap;
use std::ops::Range;

use petgraph::unionfind::UnionFind;

use super::conducting::{Conducting, Unsolvable};
use super::floating::Floating;
use super::loops::{self, Loop};
use super::sparse::{Row, System, plus};
use super::{Branch, Electrics, Island, TwoPin, slopes};
use crate::assembly::eliminate::{Form, Relations};

/// Voltages and currents of the two-pins of an island, in their order.
#[derive(Debug, Clone)]
pub(crate) struct Solved {
    pub voltages: Vec<Form>,
    pub currents: Vec<Form>,
    pub floating: Option<Floating>,
    /// Conducting valves whose current is zero because its way ends in a part that floats.
    pub idle: Conducting,
    /// No voltage follows from a current that components give.
    pub stiff: bool,
    /// Loops that capacitances close.
    pub loops: Option<Box<loops::Law>>,
}

/// What a branch is while certain valves conduct.
#[derive(Debug, Clone, Copy)]
enum Now {
    /// Prescribes the voltage: index of a given value and its factor.
    Row(Option<(usize, f64)>),
    /// Resistance above zero, and the voltage that remains: index of a given value and its factor.
    Resistance(f64, Option<(usize, f64)>),
    Conductance(f64),
    /// A conductance and a given current beside it.
    Characteristic(f64, usize),
    Given(usize),
    Open,
    Primary(f64),
    Secondary,
    /// A capacitance whose voltage follows from the others of a loop.
    Chord,
}

fn now(branch: Branch, conducting: Conducting, one: usize) -> Now {
    match branch {
        Branch::Source(index) | Branch::Variable(index) => Now::Row(Some((index, 1.0))),
        Branch::Wire => Now::Row(None),
        Branch::Given(index) => Now::Given(index),
        Branch::Conductance(g) => Now::Conductance(g),
        Branch::Characteristic(g, rest) => Now::Characteristic(g, rest),
        Branch::Probe => Now::Open,
        Branch::Primary(ratio) => Now::Primary(ratio),
        Branch::Secondary => Now::Secondary,
        Branch::Valve { index, on_resistance, forward_voltage, off_conductance } => {
            // Both lines meet at the forward voltage and the leakage that flows there.
            let remains = forward_voltage * (1.0 - on_resistance * off_conductance);
            let forward = (remains != 0.0).then_some((one, remains));
            if conducting >> index & 1 == 0 {
                match off_conductance {
                    0.0 => Now::Open,
                    g => Now::Conductance(g),
                }
            } else if on_resistance == 0.0 {
                Now::Row(forward)
            } else {
                Now::Resistance(on_resistance, forward)
            }
        }
    }
}

/// Solves an island while certain valves conduct.
pub(crate) fn solve(
    electrics: &Electrics,
    island: &Island,
    conducting: Conducting,
) -> Result<Solved, Unsolvable> {
    let (nodes, given) = (island.nodes.len(), electrics.given());
    let mut branches: Vec<Now> =
        island.two_pins.iter().map(|pin| now(pin.branch, conducting, given - 1)).collect();
    resist(&mut branches);
    let floating = floating(electrics, island, conducting, &branches)?;

    let loops = loops::find(electrics, island, |i| matches!(branches[i], Now::Row(_)));
    let loops = loops.map_err(Unsolvable::Loop)?;
    loops.iter().for_each(|l| branches[l.chord] = Now::Chord);
    let has_row = |b: &&Now| matches!(b, Now::Row(_) | Now::Resistance(..) | Now::Primary(_) | Now::Chord);
    let rows = branches.iter().filter(has_row).count();
    let size = nodes + rows;
    let mut system = System::new(size, given);
    let mut row_of = vec![None; branches.len()];
    let mut row = nodes;
    for (i, (pin, branch)) in island.two_pins.iter().zip(&branches).enumerate() {
        match *branch {
            Now::Row(value) | Now::Resistance(_, value) => {
                couple(&mut system, row, pin, 1.0);
                if let Now::Resistance(r, _) = *branch {
                    system.add(row, row, -r);
                }
                if let Some((index, factor)) = value {
                    system.add_right(row, index, factor);
                }
                row_of[i] = Some((row, 1.0));
                row += 1;
            }
            Now::Primary(ratio) => {
                couple(&mut system, row, pin, 1.0);
                couple(&mut system, row, &island.two_pins[i + 1], -ratio);
                row_of[i] = Some((row, 1.0));
                row_of[i + 1] = Some((row, -ratio));
                row += 1;
            }
            Now::Conductance(g) => conduct(&mut system, pin, g),
            Now::Characteristic(g, rest) => {
                if g != 0.0 {
                    conduct(&mut system, pin, g);
                }
                ends(pin).for_each(|(node, sign)| system.add_right(node, rest, -sign));
            }
            Now::Given(index) => ends(pin).for_each(|(node, sign)| system.add_right(node, index, -sign)),
            Now::Chord => {
                ends(pin).for_each(|(node, sign)| system.add(node, row, sign));
                row_of[i] = Some((row, 1.0));
                row += 1;
            }
            Now::Open | Now::Secondary => {}
        }
    }
    loops.iter().for_each(|l| in_loop(electrics, island, l, &row_of, &mut system));
    for node in floating.iter().flat_map(|floating| &floating.nodes) {
        system.add(*node, *node, 1.0);
    }
    let Some(solution) = system.solve().filter(|solution| well(&system, solution)) else {
        let closed = |b: &Now| matches!(b, Now::Row(_) | Now::Chord | Now::Primary(_) | Now::Secondary);
        let all = island.two_pins.iter().zip(&branches).enumerate();
        return Err(Unsolvable::Loop(all.filter(|(_, (_, b))| closed(b)).map(|(i, _)| (i, 0.0)).collect()));
    };

    let nothing = Row::new();
    let potential = |node: Option<usize>| node.map_or(&nothing, |node| &solution[node]);
    // The voltage of a branch that gives it; as a difference of potentials it would be rounding where it is zero.
    let known = |i: usize| {
        let of_given = |given: Option<(usize, f64)>| -> Row {
            given.map(|(index, factor)| (index as u32, factor)).into_iter().collect()
        };
        match (branches[i], row_of[i]) {
            (Now::Resistance(r, given), Some((row, _))) => plus(&of_given(given), &solution[row], r),
            (Now::Row(given), _) => of_given(given),
            _ => Row::new(),
        }
    };
    let (beside, units) = (Beside::new(island, &branches), Units::of(electrics, island, &branches));
    let law = (!loops.is_empty()).then(|| Box::new(loops::Law::of(electrics, island, &loops)));
    let mut solved =
        Solved { voltages: Vec::new(), currents: Vec::new(), floating, idle: 0, stiff: false, loops: law };
    for (i, (pin, branch)) in island.two_pins.iter().zip(&branches).enumerate() {
        let voltage = match beside.closed(i, pin) {
            Some((closed, sign)) => plus(&nothing, &known(closed), sign),
            None => plus(potential(pin.p), potential(pin.n), -1.0),
        };
        let current = match (*branch, row_of[i]) {
            (_, Some((row, factor))) => plus(&nothing, &solution[row], factor),
            (Now::Conductance(g), _) => plus(&nothing, &voltage, g),
            (Now::Characteristic(g, rest), _) => plus(&[(rest as u32, 1.0)], &voltage, g),
            (Now::Given(index), _) => vec![(index as u32, 1.0)],
            _ => Row::new(),
        };
        solved.voltages.push(units.clean(&voltage));
        solved.currents.push(units.clean(&current));
    }
    solved.idle = idle(island, &branches, &solved, given);
    let of_sources = |form: &Form| {
        form.terms().iter().all(|(i, _)| (*i as usize) < electrics.sources || *i as usize == given - 1)
    };
    solved.stiff = solved.floating.is_none() && solved.voltages.iter().all(of_sources);
    slopes::known(electrics, island, &solved)?;
    Ok(solved)
}

/// A conductance beside which another one of its circuit is this small is written as a resistance.
const LEAKS: f64 = 1e-3;

/// Conductances beside far smaller ones become resistances, with a current of their own.
fn resist(branches: &mut [Now]) {
    let conductance = |branch: &Now| match *branch {
        Now::Conductance(g) | Now::Characteristic(g, _) if g != 0.0 => Some(g.abs()),
        _ => None,
    };
    let least = branches.iter().filter_map(conductance).fold(f64::INFINITY, f64::min);
    for branch in branches {
        if let Now::Conductance(g) = *branch
            && g.recip().is_finite()
            && g.abs() * LEAKS > least
        {
            *branch = Now::Resistance(g.recip(), None);
        }
    }
}

/// The parts that float while certain valves conduct.
fn floating(
    electrics: &Electrics,
    island: &Island,
    conducting: Conducting,
    branches: &[Now],
) -> Result<Option<Floating>, Unsolvable> {
    let part = parts(island, branches);
    if island.valves.is_empty() {
        return Floating::find(electrics, island, conducting, &part, &part);
    }
    let all: Vec<Now> = island.two_pins.iter().map(|pin| now(pin.branch, Conducting::MAX, 0)).collect();
    Floating::find(electrics, island, conducting, &part, &parts(island, &all))
}

/// The parts that float whatever valves do, if there is any solution.
pub(super) fn always_floating(electrics: &Electrics, island: &Island) -> Option<Floating> {
    let all: Vec<Now> = island.two_pins.iter().map(|pin| now(pin.branch, Conducting::MAX, 0)).collect();
    floating(electrics, island, Conducting::MAX, &all).ok().flatten()
}

/// The equation of the current that closes a loop: its voltage changes as the others of the loop do,
/// `j = C (sum a i_k / C_k + sum a e')`.
fn in_loop(
    electrics: &Electrics,
    island: &Island,
    l: &Loop,
    row_of: &[Option<(usize, f64)>],
    system: &mut System,
) {
    let capacitance = |i: usize| electrics.capacitance(&island.two_pins[i].branch).map(|c| c.capacitance);
    let (Some(own), Some((row, _))) = (capacitance(l.chord), row_of[l.chord]) else { return };
    system.add(row, row, 1.0);
    for (i, factor) in &l.others {
        if let (Some(other), Some((column, _))) = (capacitance(*i), row_of[*i]) {
            system.add(row, column, -factor * own / other);
        } else if let Branch::Source(index) = island.two_pins[*i].branch
            && let Some(slope) = electrics.slope_of(index)
        {
            system.add_right(row, slope, factor * own);
        }
    }
}

/// Valves whose current is a sum of currents that leave floating parts, which are zero.
fn idle(island: &Island, branches: &[Now], solved: &Solved, given: usize) -> Conducting {
    if island.valves.is_empty() {
        return 0;
    }
    let mut ended = Relations::new(given, 0);
    for leaving in solved.floating.iter().flat_map(|floating| &floating.leaving) {
        ended.add(leaving, &[]);
    }
    let ended = ended.eliminate(|_| 0);
    let is_zero = |form: &Form| {
        let mut rest = vec![0.0; ended.free.len()];
        let mut size = 0.0_f64;
        for (i, factor) in form.terms() {
            size = size.max(factor.abs());
            rest.iter_mut().zip(&ended.over_free[*i as usize]).for_each(|(to, by)| *to += factor * by);
        }
        rest.iter().all(|rest| rest.abs() <= 1e-9 * size)
    };
    let valves = island.two_pins.iter().zip(branches).zip(&solved.currents);
    valves.fold(0, |idle, ((pin, now), current)| match pin.branch {
        Branch::Valve { index, .. } if !matches!(now, Now::Open | Now::Conductance(_)) => {
            idle | Conducting::from(is_zero(current)) << index
        }
        _ => idle,
    })
}

/// Between which nodes a branch gives the voltage.
struct Beside<'a> {
    branches: &'a [Now],
    /// The first such branch between two nodes, and whether it points the same way.
    first: HashMap<(Option<usize>, Option<usize>), (usize, f64)>,
}

impl<'a> Beside<'a> {
    fn new(island: &Island, branches: &'a [Now]) -> Self {
        let mut first = HashMap::new();
        for (i, pin) in island.two_pins.iter().enumerate().filter(|(i, _)| gives(&branches[*i])) {
            first.entry((pin.p, pin.n)).or_insert((i, 1.0));
            first.entry((pin.n, pin.p)).or_insert((i, -1.0));
        }
        Self { branches, first }
    }

    /// The two-pin itself if it gives its voltage, or else the first that does beside it.
    fn closed(&self, i: usize, pin: &TwoPin) -> Option<(usize, f64)> {
        if gives(&self.branches[i]) { Some((i, 1.0)) } else { self.first.get(&(pin.p, pin.n)).copied() }
    }
}

fn gives(branch: &Now) -> bool {
    matches!(branch, Now::Row(_) | Now::Resistance(..))
}

/// The ends of a two-pin that are no ground, with the sign of the current into the two-pin.
fn ends(pin: &TwoPin) -> impl Iterator<Item = (usize, f64)> + use<> {
    [(pin.p, 1.0), (pin.n, -1.0)].into_iter().filter_map(|(node, sign)| node.map(|node| (node, sign)))
}

fn conduct(system: &mut System, pin: &TwoPin, g: f64) {
    for (a, sign_a) in ends(pin) {
        for (b, sign_b) in ends(pin) {
            system.add(a, b, g * sign_a * sign_b);
        }
    }
}

fn couple(system: &mut System, row: usize, pin: &TwoPin, factor: f64) {
    for (node, sign) in ends(pin) {
        system.add(row, node, sign * factor);
        system.add(node, row, sign * factor);
    }
}

/// Whether a solution satisfies its equations: elimination of a singular matrix may end with garbage.
fn well(system: &System, solution: &[Row]) -> bool {
    let (error, scale) = system.error(solution);
    error <= 1e-8 * scale
}

/// Rounding must not make one part of a circuit depend on another.
pub(super) fn clean(row: &[(u32, f64)]) -> Form {
    clean_in(row, |_| 1.0)
}

/// The same where given values are measured in units of their own. What counts in these or in SI units is no rounding.
fn clean_in(row: &[(u32, f64)], unit: impl Fn(u32) -> f64) -> Form {
    let sizes = |(i, value): &(u32, f64)| [value.abs(), value.abs() * unit(*i)];
    let scale =
        row.iter().map(sizes).fold([0.0_f64; 2], |max, size| [max[0].max(size[0]), max[1].max(size[1])]);
    let counts =
        |term: &(u32, f64)| sizes(term).iter().zip(&scale).any(|(size, scale)| *size >= 1e-12 * scale);
    Form::from_terms(row.iter().copied().filter(|term| term.1 != 0.0 && counts(term)))
}

/// Units in which the coefficients of given voltages, currents and slopes can be compared: in SI units a current of 1 stands beside
/// conductances of 1e-13, which are those of leaks where pressures are voltages, and not their rounding.
struct Units {
    voltages: usize,
    /// First of the slopes; the last given value is the constant.
    slopes: Range<usize>,
    /// The largest conductance, by which rounding is as large as that of 1.
    conductance: f64,
    /// The largest capacitance.
    capacitance: f64,
}

impl Units {
    fn of(electrics: &Electrics, island: &Island, branches: &[Now]) -> Self {
        let conductances = branches.iter().map(|branch| match *branch {
            Now::Conductance(g) | Now::Characteristic(g, _) => g.abs(),
            Now::Resistance(r, _) => r.recip(),
            _ => 0.0,
        });
        let capacitances = island.two_pins.iter().filter_map(|pin| electrics.capacitance(&pin.branch));
        // Without any there is nothing to compare with.
        let largest =
            |values: &mut dyn Iterator<Item = f64>| Some(values.fold(0.0, f64::max)).filter(|max| *max > 0.0);
        let given = electrics.given();
        Self {
            voltages: electrics.sources,
            slopes: given - 1 - electrics.slopes.len()..given - 1,
            conductance: largest(&mut { conductances }).unwrap_or(1.0),
            capacitance: largest(&mut capacitances.map(|c| c.capacitance)).unwrap_or(1.0),
        }
    }

    fn clean(&self, row: &[(u32, f64)]) -> Form {
        clean_in(row, |i| match i as usize {
            i if self.slopes.contains(&i) => self.conductance / self.capacitance,
            i if i >= self.voltages && i < self.slopes.start => self.conductance,
            _ => 1.0,
        })
    }
}

/// The part of the circuit that each node belongs to: 0 is what is connected to ground by voltages or conductances;
/// transformers connect nothing.
fn parts(island: &Island, branches: &[Now]) -> Vec<usize> {
    let ground = island.nodes.len();
    let mut joined = UnionFind::new(ground + 1);
    for (pin, branch) in island.two_pins.iter().zip(branches) {
        let apart = matches!(branch, Now::Given(_) | Now::Open | Now::Primary(_) | Now::Secondary);
        if !apart && !matches!(branch, Now::Characteristic(0.0, _)) {
            joined.union(pin.p.unwrap_or(ground), pin.n.unwrap_or(ground));
        }
    }
    let mut roots = vec![joined.find(ground)];
    (0..ground)
        .map(|node| {
            let root = joined.find(node);
            roots.iter().position(|known| *known == root).unwrap_or_else(|| {
                roots.push(root);
                roots.len() - 1
            })
        })
        .collect()
}
