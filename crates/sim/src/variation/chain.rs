//! Slopes of what a pass computes, by the chain rule over its calls: laws that are data give exact ones, other blocks theirs by
//! differences over their own inputs and states.
//!
//! All is about one point, at which the diagram has been evaluated. A direction says how states, discrete states and some signals
//! change; it is followed through the calls in their order. In an algebraic loop the rates of its unknowns solve the linear
//! equations that follow from going around once for each of them.

use std::ops::Range;

use blocksim_block::{Context, Scratch};
use blocksim_law::{Along, Id, Sources};
use blocksim_linear::{DMatrix, jacobian, sparse_jacobian};

use crate::evaluation::evaluate::Diagram;
use crate::program::plan::Unit;
use crate::program::spread::written;
use crate::variation::frozen::Tap;

/// Values of a block above which its differences are taken of many inputs at a time.
const LARGE: usize = 60;

/// How states, discrete states and signals change.
#[derive(Debug, Clone, Default)]
pub(crate) struct Direction {
    pub x: Vec<f64>,
    /// Of all discrete states.
    pub d: Vec<f64>,
    /// What is added to the signals at the taps.
    pub changes: Vec<f64>,
    /// Rates of cells that no call writes.
    pub cells: Vec<(usize, f64)>,
}

impl Direction {
    /// Nothing changes.
    pub fn none(diagram: &Diagram, taps: usize) -> Self {
        let (x, d) = (vec![0.0; diagram.schedule.states], vec![0.0; diagram.schedule.discrete]);
        Self { x, d, changes: vec![0.0; taps], cells: Vec::new() }
    }
}

/// Where the rates along a direction come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin {
    /// They follow from laws alone.
    Laws,
    /// Differences of blocks that record no law have a part in them.
    Differences,
    /// There is a kink at the point in this direction, or a slope is not known.
    Unknown,
}

/// The calls of a pass and the derivatives, with their slopes.
#[derive(Debug)]
pub(crate) struct Chain {
    links: Vec<Link>,
    rings: Vec<Ring>,
    derivatives: Vec<Link>,
    updates: Vec<Link>,
    /// Discrete states that laws set at major steps.
    settled: Vec<Link>,
    rests: Vec<Link>,
    opaque: Vec<Opaque>,
    taps: Vec<(Tap, Option<usize>)>,
    work: Work,
}

/// What a direction becomes on its way.
#[derive(Debug, Default)]
struct Work {
    /// Rates of all signals.
    rates: Vec<f64>,
    /// What the blocks give at the taps.
    given: Vec<f64>,
    /// What one link makes.
    made: Vec<f64>,
    /// Values that a law reads, with a direction behind.
    sources: Vec<f64>,
    registers: Vec<f64>,
    /// Opaque blocks that have had a part in rates.
    used: Vec<bool>,
    origin: Option<Origin>,
    /// The first block whose slopes are not known along the direction.
    unknown: Option<usize>,
    /// Differences are taken with their errors added.
    doubts: bool,
}

/// What one call, or the derivatives of one block, make of a direction.
#[derive(Debug)]
struct Link {
    block: usize,
    /// Number among the calls of a major pass; none for derivatives and updates.
    call: Option<usize>,
    /// Cells, states or discrete states that it writes.
    to: Vec<usize>,
    how: How,
}

#[derive(Debug)]
enum How {
    Law(Box<OfLaw>),
    /// Rows of the differences of an opaque block, from this one on.
    Differences {
        opaque: usize,
        first: usize,
    },
}

#[derive(Debug)]
struct OfLaw {
    along: Along,
    /// The values that meet at edges at the present point: which of those of `edge_rates` belong together.
    edges: Vec<(usize, Option<usize>)>,
    edge_rates: Option<Along>,
}

/// What an opaque block is asked for, apart from its calls.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Extra {
    Nothing,
    /// What discrete states become at a sample hit.
    Update,
    /// It has rested before its calls.
    Rest,
}

/// A block that records no law. Its columns are its inputs, states, discrete states where these may change, and outputs that the
/// engine finds; its rows what each of its calls writes, one call behind the other, then derivatives and what discrete states become.
#[derive(Debug)]
struct Opaque {
    block: usize,
    extra: Extra,
    /// Calls among those of a major pass and the cells that each writes, counted from the first output.
    calls: Vec<(usize, Vec<usize>)>,
    derives: bool,
    /// Outputs that the engine finds.
    sought: Vec<usize>,
    /// Columns that may change.
    live: Vec<usize>,
    slopes: DMatrix<f64>,
    errors: DMatrix<f64>,
    /// Columns whose slopes are known, by number among the live ones.
    known: Vec<bool>,
}

/// An algebraic loop.
#[derive(Debug)]
struct Ring {
    links: Range<usize>,
    cells: Vec<usize>,
    sought: usize,
    /// Links whose outputs are given once more in the end.
    owners: Vec<usize>,
    /// From what is left over after going around once to the rates of the unknowns; none where that is not known.
    inverse: Option<DMatrix<f64>>,
    origin: Origin,
}

impl Chain {
    /// The calls that are `asked` for among those of a major pass, and those of the loops that they belong to.
    pub fn new(diagram: &Diagram, asked: &[bool], taps: &[(Tap, Option<usize>)]) -> Self {
        let mut chain = Self {
            links: Vec::new(),
            rings: Vec::new(),
            derivatives: Vec::new(),
            updates: Vec::new(),
            settled: Vec::new(),
            rests: Vec::new(),
            opaque: Vec::new(),
            taps: taps.to_vec(),
            work: Work {
                rates: vec![0.0; diagram.signals.len()],
                given: vec![0.0; taps.len()],
                ..Work::default()
            },
        };
        let schedule = &diagram.schedule;
        let mut call = 0;
        while call < asked.len() {
            let ring = schedule.loops.iter().find(|ring| ring.first == call);
            let count = ring.map_or(1, |ring| ring.count);
            if asked[call] {
                let first = chain.links.len();
                (call..call + count).for_each(|call| chain.add_call(diagram, call));
                if let Some(ring) = ring {
                    let owns = |k: &usize| is_owner(diagram, call + k);
                    chain.rings.push(Ring {
                        links: first..chain.links.len(),
                        cells: ring.cells.clone(),
                        sought: ring.sought,
                        owners: (0..count).filter(owns).map(|k| first + k).collect(),
                        inverse: None,
                        origin: Origin::Unknown,
                    });
                }
            }
            call += count;
        }
        for &block in &diagram.plan.with_states {
            chain.add_derivatives(diagram, block);
        }
        chain
    }

    fn add_call(&mut self, diagram: &Diagram, call: usize) {
        let schedule = &diagram.schedule;
        let step = &schedule.steps[call];
        let (block, group) = (step.block as usize, step.group as usize);
        let instance = &schedule.blocks[block];
        let constraint = instance.interface.constraint.as_ref();
        if let Some(law) = instance.law.as_ref().filter(|_| constraint.is_none()) {
            let own = law.outputs.iter().zip(&law.group_of).enumerate().filter(|(_, (_, of))| **of == group);
            let (cells, wanted): (Vec<usize>, Vec<Id>) =
                own.map(|(cell, (id, _))| (instance.y + cell, *id)).unzip();
            let how = of_law(diagram, block, &wanted);
            return self.links.push(Link { block, call: Some(call), to: cells, how });
        }
        let unknowns = constraint.iter().flat_map(|constraint| &constraint.unknowns);
        let unknowns: Vec<usize> = unknowns.map(|(cell, _)| *cell).collect();
        let cells: Vec<usize> = match constraint {
            Some(constraint) if constraint.rest == group => unknowns.clone(),
            _ => written(schedule, step)
                .map(|cell| cell - instance.y)
                .filter(|cell| !unknowns.contains(cell))
                .collect(),
        };
        let opaque = self.opaque_of(block, Extra::Nothing, unknowns);
        let first = self.opaque[opaque].calls.iter().map(|(_, cells)| cells.len()).sum();
        let to = cells.iter().map(|cell| instance.y + cell).collect();
        self.opaque[opaque].calls.push((call, cells));
        self.links.push(Link { block, call: Some(call), to, how: How::Differences { opaque, first } });
    }

    fn add_derivatives(&mut self, diagram: &Diagram, block: usize) {
        let to = diagram.plan.units[block].x.range().collect();
        let how = match &diagram.schedule.blocks[block].law {
            Some(law) => of_law(diagram, block, &law.derivatives),
            None => {
                let opaque = self.opaque_of(block, Extra::Nothing, Vec::new());
                self.opaque[opaque].derives = true;
                let first = self.opaque[opaque].calls.iter().map(|(_, cells)| cells.len()).sum();
                How::Differences { opaque, first }
            }
        };
        self.derivatives.push(Link { block, call: None, to, how });
    }

    /// Adds what the discrete states of a block become at a sample hit.
    pub fn add_update(&mut self, diagram: &Diagram, block: usize) {
        let d = diagram.plan.units[block].d.range();
        let law = diagram.schedule.blocks[block].law.as_ref().filter(|law| !law.updated.is_empty());
        let link = match law {
            Some(law) => {
                let wanted: Vec<Id> = law.updated.iter().map(|(_, id)| *id).collect();
                let to = law.updated.iter().map(|(i, _)| d.start + i).collect();
                Link { block, call: None, to, how: of_law(diagram, block, &wanted) }
            }
            None => {
                let opaque = self.opaque_of(block, Extra::Update, Vec::new());
                Link { block, call: None, to: d.collect(), how: How::Differences { opaque, first: 0 } }
            }
        };
        self.updates.push(link);
    }

    /// Adds the discrete states that the law of a block sets at major steps.
    pub fn add_settled(&mut self, diagram: &Diagram, block: usize) {
        let Some(law) = &diagram.schedule.blocks[block].law else { return };
        let wanted: Vec<Id> = law.settled.iter().map(|(_, id)| *id).collect();
        let first = diagram.plan.units[block].d.range().start;
        let to = law.settled.iter().map(|(i, _)| first + i).collect();
        let how = of_law(diagram, block, &wanted);
        self.settled.push(Link { block, call: None, to, how });
    }

    /// Adds what the outputs of a block become once it has rested, for which it is called so.
    pub fn add_rest(&mut self, diagram: &Diagram, block: usize, calls: &[usize]) {
        let schedule = &diagram.schedule;
        let y = schedule.blocks[block].y;
        let opaque = self.opaque_of(block, Extra::Rest, Vec::new());
        for &call in calls {
            let cells: Vec<usize> = written(schedule, &schedule.steps[call]).collect();
            let first = self.opaque[opaque].calls.iter().map(|(_, cells)| cells.len()).sum();
            self.opaque[opaque].calls.push((call, cells.iter().map(|cell| cell - y).collect()));
            self.rests.push(Link { block, call: None, to: cells, how: How::Differences { opaque, first } });
        }
    }

    fn opaque_of(&mut self, block: usize, extra: Extra, sought: Vec<usize>) -> usize {
        let found = self.opaque.iter().position(|opaque| (opaque.block, opaque.extra) == (block, extra));
        found.unwrap_or_else(|| {
            self.opaque.push(Opaque {
                block,
                extra,
                calls: Vec::new(),
                derives: false,
                sought,
                live: Vec::new(),
                slopes: DMatrix::zeros(0, 0),
                errors: DMatrix::zeros(0, 0),
                known: Vec::new(),
            });
            self.work.used.push(false);
            self.opaque.len() - 1
        })
    }

    /// Takes the slopes at the point at which the diagram has just been evaluated; `moving` are cells that no call writes and whose
    /// rates may be asked for, `varies` discrete states that may change. The diagram must be evaluated anew behind it.
    pub fn fix(&mut self, diagram: &mut Diagram, moving: &[usize], varies: &[Range<usize>]) {
        let live = self.live(diagram, moving, varies);
        for opaque in &mut self.opaque {
            opaque.fix(diagram, &live, varies);
        }
        let all = [&mut self.links, &mut self.derivatives, &mut self.updates, &mut self.settled];
        let all = all.into_iter().flatten();
        for link in all {
            if let How::Law(law) = &mut link.how {
                law.fix(diagram, link.block, &link.to, &mut self.work);
            }
        }
        let still = Direction::none(diagram, self.taps.len());
        for ring in 0..self.rings.len() {
            self.fix_ring(diagram, ring, &still);
        }
        self.work.used.fill(false);
    }

    /// Cells that may change.
    fn live(&self, diagram: &Diagram, moving: &[usize], varies: &[Range<usize>]) -> Vec<bool> {
        let mut live = vec![false; diagram.signals.len()];
        moving.iter().for_each(|&cell| live[cell] = true);
        self.taps.iter().for_each(|(tap, _)| live[tap.cell] = true);
        self.rings.iter().flat_map(|ring| &ring.cells).for_each(|&cell| live[cell] = true);
        for link in &self.links {
            let unit = &diagram.plan.units[link.block];
            let d = unit.d.range();
            let own = unit.x.len() > 0 || varies.iter().any(|range| *range == d && !d.is_empty());
            if own || gathered(diagram, unit).any(|cell| live[cell]) {
                link.to.iter().for_each(|&cell| live[cell] = true);
            }
        }
        live
    }

    fn fix_ring(&mut self, diagram: &Diagram, ring: usize, still: &Direction) {
        let Ring { links, cells, sought, .. } = &self.rings[ring];
        let (n, links, guessed) = (cells.len(), links.clone(), cells.len() - sought);
        let cells = cells.clone();
        let mut matrix = DMatrix::zeros(n, n);
        self.work.origin = None;
        for (j, &cell) in cells.iter().enumerate() {
            self.work.rates.fill(0.0);
            self.work.rates[cell] = 1.0;
            links.clone().for_each(|link| self.pass(diagram, link, still));
            for (i, &cell) in cells.iter().enumerate() {
                let around = self.work.rates[cell];
                matrix[(i, j)] = if i < guessed { f64::from(i == j) - around } else { -around };
            }
        }
        let is_finite = matrix.iter().all(|entry: &f64| entry.is_finite());
        let inverse = if is_finite { matrix.try_inverse() } else { None };
        let ring = &mut self.rings[ring];
        ring.origin = self.work.origin.unwrap_or(Origin::Laws);
        ring.inverse = inverse.filter(|inverse| inverse.iter().all(|entry| entry.is_finite()));
    }

    /// Follows a direction. Returns what is known of the rates that are found then: of signals, and of derivatives, in `dx`.
    pub fn along(&mut self, diagram: &Diagram, direction: &Direction, dx: &mut [f64]) -> Origin {
        (self.work.origin, self.work.unknown) = (Some(Origin::Laws), None);
        self.work.rates.fill(0.0);
        direction.cells.iter().for_each(|(cell, rate)| self.work.rates[*cell] = *rate);
        self.work.touch(&self.taps, None, direction);
        let mut at = 0;
        while at < self.links.len() {
            match self.rings.iter().position(|ring| ring.links.start == at) {
                Some(ring) => {
                    self.around(diagram, ring, direction);
                    at = self.rings[ring].links.end;
                }
                None => {
                    self.pass(diagram, at, direction);
                    at += 1;
                }
            }
        }
        dx.fill(0.0);
        for link in &self.derivatives {
            link.follow(&self.opaque, diagram, direction, &mut self.work);
            link.to.iter().zip(&self.work.made).for_each(|(&to, made)| dx[to] = *made);
        }
        self.work.origin.unwrap_or(Origin::Unknown)
    }

    /// The rates of what discrete states become, behind [`along`](Self::along).
    pub fn updates(
        &mut self,
        diagram: &Diagram,
        direction: &Direction,
        mut write: impl FnMut(usize, f64),
    ) -> Origin {
        for link in &self.updates {
            link.follow(&self.opaque, diagram, direction, &mut self.work);
            link.to.iter().zip(&self.work.made).for_each(|(&to, made)| write(to, *made));
        }
        self.work.origin.unwrap_or(Origin::Unknown)
    }

    /// The block whose law would have to set a discrete state to something else along the direction, behind
    /// [`along`](Self::along): none where all that is set are modes, away from where they change.
    pub fn moves_settled(&mut self, diagram: &Diagram, direction: &Direction) -> Option<usize> {
        let before = self.work.origin;
        self.work.origin = Some(Origin::Laws);
        let found = self.settled.iter().find(|link| {
            link.follow(&self.opaque, diagram, direction, &mut self.work);
            self.work.made.iter().any(|rate| *rate != 0.0) || self.work.origin != Some(Origin::Laws)
        });
        let found = found.map(|link| link.block);
        self.work.origin = before;
        found
    }

    /// The rates of what the outputs of those become that have rested, behind [`along`](Self::along).
    pub fn rests(
        &mut self,
        diagram: &Diagram,
        direction: &Direction,
        mut write: impl FnMut(usize, f64),
    ) -> Origin {
        for link in &self.rests {
            link.follow(&self.opaque, diagram, direction, &mut self.work);
            link.to.iter().zip(&self.work.made).for_each(|(&to, made)| write(to, *made));
        }
        self.work.origin.unwrap_or(Origin::Unknown)
    }

    /// Lets differences be taken with their errors added, or no longer.
    pub fn doubt(&mut self, doubts: bool) {
        self.work.doubts = doubts;
    }

    /// The first block whose slopes are not known along the last direction, or that is in an algebraic loop where they are not.
    pub fn unknown(&self) -> Option<usize> {
        self.work.unknown
    }

    /// Rate of a cell along the last direction, as those who read it see it.
    pub fn rate(&self, cell: usize) -> f64 {
        self.work.rates[cell]
    }

    /// Rates of what the blocks gave at the taps.
    pub fn given(&self) -> &[f64] {
        &self.work.given
    }

    /// Blocks whose differences have had a part in rates since the slopes were taken.
    pub fn used(&self) -> impl Iterator<Item = usize> {
        self.opaque.iter().zip(&self.work.used).filter(|(_, used)| **used).map(|(opaque, _)| opaque.block)
    }

    /// The unknowns of a loop, and all signals within.
    fn around(&mut self, diagram: &Diagram, ring: usize, direction: &Direction) {
        let links = self.rings[ring].links.clone();
        let cells = &self.rings[ring].cells;
        cells.iter().for_each(|&cell| self.work.rates[cell] = 0.0);
        links.clone().for_each(|link| self.pass(diagram, link, direction));
        let Ring { cells, inverse, origin, owners, .. } = &self.rings[ring];
        let rest = DMatrix::from_fn(cells.len(), 1, |i, _| self.work.rates[cells[i]]);
        if rest.iter().all(|rest| *rest == 0.0) {
            return;
        }
        self.work.take_part(*origin);
        let Some(inverse) = inverse else { return self.work.take_part(Origin::Unknown) };
        let z = inverse * rest;
        let set = |rates: &mut [f64]| cells.iter().zip(z.iter()).for_each(|(&cell, z)| rates[cell] = *z);
        set(&mut self.work.rates);
        let (cells, owners) = (cells.clone(), owners.clone());
        links.for_each(|link| self.pass(diagram, link, direction));
        cells.iter().zip(z.iter()).for_each(|(&cell, z)| self.work.rates[cell] = *z);
        owners.into_iter().for_each(|link| self.pass(diagram, link, direction));
    }

    fn pass(&mut self, diagram: &Diagram, link: usize, direction: &Direction) {
        let link = &self.links[link];
        link.follow(&self.opaque, diagram, direction, &mut self.work);
        let Work { rates, made, .. } = &mut self.work;
        link.to.iter().zip(made).for_each(|(&to, made)| rates[to] = *made);
        self.work.touch(&self.taps, link.call, direction);
    }
}

impl Work {
    fn take_part(&mut self, origin: Origin) {
        self.origin = self.origin.max(Some(origin));
    }

    fn touch(&mut self, taps: &[(Tap, Option<usize>)], call: Option<usize>, direction: &Direction) {
        for (n, (tap, _)) in taps.iter().enumerate().filter(|(_, (_, written))| *written == call) {
            self.given[n] = self.rates[tap.cell];
            self.rates[tap.cell] = direction.changes[n] + if tap.open { 0.0 } else { self.given[n] };
        }
    }
}

impl Link {
    /// Leaves in `made` the rates of what it writes.
    fn follow(&self, opaque: &[Opaque], diagram: &Diagram, direction: &Direction, work: &mut Work) {
        self.make(opaque, diagram, direction, work);
        if work.origin == Some(Origin::Unknown) {
            work.unknown.get_or_insert(self.block);
        }
    }

    fn make(&self, opaque: &[Opaque], diagram: &Diagram, direction: &Direction, work: &mut Work) {
        let unit = &diagram.plan.units[self.block];
        let (x, d) = (&direction.x[unit.x.range()], &direction.d[unit.d.range()]);
        work.made.clear();
        work.made.resize(self.to.len(), 0.0);
        let changes = gathered(diagram, unit).any(|cell| work.rates[cell] != 0.0);
        let moves = |own: &[f64]| own.iter().any(|rate| *rate != 0.0);
        match &self.how {
            How::Law(law) if changes || moves(x) || moves(d) => law.follow(diagram, unit, (x, d), work),
            How::Law(_) => {}
            How::Differences { opaque: index, first } => {
                let opaque = &opaque[*index];
                let sought = opaque.sought.iter().map(|cell| work.rates[unit.y.start as usize + cell]);
                let inputs = gathered(diagram, unit).map(|cell| work.rates[cell]);
                let all: Vec<f64> =
                    inputs.chain(x.iter().copied()).chain(d.iter().copied()).chain(sought).collect();
                for (j, &column) in opaque.live.iter().enumerate() {
                    let rate = all[column];
                    if rate == 0.0 {
                        continue;
                    }
                    work.used[*index] = true;
                    work.take_part(if opaque.known[j] { Origin::Differences } else { Origin::Unknown });
                    for (row, made) in work.made.iter_mut().enumerate() {
                        let entry = (first + row, j);
                        let doubt = if work.doubts { opaque.errors[entry] } else { 0.0 };
                        *made += (opaque.slopes[entry] + doubt) * rate;
                    }
                }
            }
        }
    }
}

impl OfLaw {
    /// Looks for edges at the point.
    fn fix(&mut self, diagram: &Diagram, block: usize, to: &[usize], work: &mut Work) {
        (self.edges, self.edge_rates) = (Vec::new(), None);
        let (Some(law), false) = (&diagram.schedule.blocks[block].law, to.is_empty()) else { return };
        let unit = &diagram.plan.units[block];
        work.bring(diagram, unit, self.along.registers());
        let mut registers = std::mem::take(&mut work.registers);
        let found = self.along.edges_at(&work.law_sources(diagram, unit), &mut registers);
        work.registers = registers;
        let mut wanted = Vec::new();
        let mut number = |id: Id| {
            wanted.push(id);
            wanted.len() - 1
        };
        self.edges = found.into_iter().map(|(a, b)| (number(a), b.map(&mut number))).collect();
        if !self.edges.is_empty() {
            self.edge_rates = Some(Along::new(&law.program, &wanted, widths(unit)));
        }
    }

    fn follow(&self, diagram: &Diagram, unit: &Unit, (x, d): (&[f64], &[f64]), work: &mut Work) {
        let registers = self.edge_rates.as_ref().map_or(0, Along::registers).max(self.along.registers());
        work.bring(diagram, unit, registers);
        for cell in gathered(diagram, unit) {
            let rate = work.rates[cell];
            work.sources.push(rate);
        }
        work.sources.extend_from_slice(x);
        work.sources.extend_from_slice(d);
        let mut made = std::mem::take(&mut work.made);
        let mut registers = std::mem::take(&mut work.registers);
        let sources = work.law_sources(diagram, unit);
        let mut is_smooth = true;
        if let Some(edge_rates) = &self.edge_rates {
            let mut rates = vec![0.0; 2 * self.edges.len()];
            edge_rates.run(&sources, &mut registers, |i, rate| rates[i] = rate);
            is_smooth = self.edges.iter().all(|(a, b)| rates[*a] == b.map_or(0.0, |b| rates[b]));
        }
        self.along.run(&sources, &mut registers, |i, rate| made[i] = rate);
        is_smooth &= made.iter().all(|rate| rate.is_finite());
        (work.made, work.registers) = (made, registers);
        if !is_smooth {
            work.take_part(Origin::Unknown);
        }
    }
}

impl Work {
    /// Brings the inputs of a law together.
    fn bring(&mut self, diagram: &Diagram, unit: &Unit, registers: usize) {
        self.sources.clear();
        self.sources.extend(gathered(diagram, unit).map(|cell| diagram.signals[cell]));
        if self.registers.len() < registers {
            self.registers.resize(registers, 0.0);
        }
    }

    fn law_sources<'a>(&'a self, diagram: &'a Diagram, unit: &Unit) -> Sources<'a> {
        Sources {
            time: diagram.now.t,
            inputs: &self.sources,
            states: &diagram.now.x[unit.x.range()],
            memories: &diagram.d[unit.d.range()],
            ..Sources::default()
        }
    }
}

impl Opaque {
    /// Slopes by differences over the columns that may change.
    fn fix(&mut self, diagram: &mut Diagram, live: &[bool], varies: &[Range<usize>]) {
        let unit = &diagram.plan.units[self.block];
        let (x, d) = (unit.x.range(), unit.d.range());
        let inputs: Vec<usize> = gathered(diagram, unit).collect();
        let own = if varies.contains(&d) { d.len() } else { 0 };
        let columns = inputs.iter().map(|&cell| live[cell]).chain(vec![true; x.len()]);
        let columns = columns.chain((0..d.len()).map(|i| i < own)).chain(self.sought.iter().map(|_| true));
        let columns: Vec<bool> = columns.collect();
        self.live = (0..columns.len()).filter(|&column| columns[column]).collect();
        let y = unit.y.start as usize;
        let values = inputs.iter().map(|&cell| diagram.signals[cell]);
        let values = values
            .chain(diagram.now.x[x.clone()].iter().copied())
            .chain(diagram.d[d.clone()].iter().copied());
        let all: Vec<f64> = values.chain(self.sought.iter().map(|cell| diagram.signals[y + cell])).collect();
        let point: Vec<f64> = self.live.iter().map(|&column| all[column]).collect();
        let rows = self.calls.iter().map(|(_, cells)| cells.len()).sum::<usize>();
        let rows = rows
            + if self.derives { x.len() } else { 0 }
            + if self.extra == Extra::Update { d.len() } else { 0 };
        let mut there = all;
        let f = |z: &[f64], out: &mut [f64]| {
            self.live.iter().zip(z).for_each(|(&column, z)| there[column] = *z);
            if self.evaluate(diagram, &there, out).is_none() {
                out.fill(f64::NAN);
            }
            Ok::<(), std::convert::Infallible>(())
        };
        let found = if rows > LARGE { sparse_jacobian(&point, rows, f) } else { jacobian(&point, rows, f) };
        let found = found.unwrap_or_else(|never| match never {});
        let is_finite = |column: usize| found.value.column(column).iter().all(|slope| slope.is_finite());
        self.known = (0..self.live.len()).map(is_finite).collect();
        found.kinks.iter().for_each(|kink| self.known[kink.column] = false);
        (self.slopes, self.errors) = (found.value, found.error);
    }

    /// What the block makes of other values of all its columns; nothing where it cannot go on.
    fn evaluate(&self, diagram: &mut Diagram, z: &[f64], out: &mut [f64]) -> Option<()> {
        let Diagram { plan, now, signals, d, scratch, .. } = diagram;
        let unit = &plan.units[self.block];
        let (u, z) = z.split_at(unit.width as usize);
        let (x, z) = z.split_at(unit.x.len());
        let (own, sought) = z.split_at(unit.d.len());
        now.evaluation += 1;
        let c = Context {
            t: now.t,
            x,
            d: own,
            u,
            inputs: &unit.inputs,
            outputs: &unit.outputs,
            evaluation: now.evaluation,
            fault: &now.fault,
            resolution: now.resolution,
            seed: now.seed,
        };
        let w: &mut Scratch = &mut scratch[self.block];
        let mut discrete = own.to_vec();
        if self.extra == Extra::Rest {
            discrete.copy_from_slice(&d[unit.d.range()]);
            unit.block.rest(&Context { d: &[], ..c }, &mut discrete);
        }
        let held = discrete.clone();
        let c = Context { d: &held, ..c };
        let mut y = signals[unit.y.range()].to_vec();
        let mut rest = out.iter_mut();
        let mut write =
            |values: &mut dyn Iterator<Item = f64>| values.zip(rest.by_ref()).for_each(|(y, out)| *out = y);
        for (call, cells) in &self.calls {
            self.sought.iter().zip(sought).for_each(|(&cell, z)| y[cell] = *z);
            unit.block.outputs(plan.major[*call].group as usize, &c, w, &mut y);
            write(&mut cells.iter().map(|&cell| y[cell]));
        }
        if self.derives {
            let mut dx = vec![0.0; unit.x.len()];
            unit.block.derivatives(&c, w, &mut dx);
            write(&mut dx.into_iter());
        }
        if self.extra == Extra::Update {
            unit.block.update(&Context { d: &[], ..c }, w, &mut discrete);
            write(&mut discrete.into_iter());
        }
        match now.fault.take() {
            Some(_) => None,
            None => Some(()),
        }
    }
}

/// Numbers of inputs, states and discrete states.
fn widths(unit: &Unit) -> [usize; 3] {
    [unit.width as usize, unit.x.len(), unit.d.len()]
}

fn of_law(diagram: &Diagram, block: usize, wanted: &[Id]) -> How {
    let Some(law) = &diagram.schedule.blocks[block].law else { unreachable!("only laws are followed so") };
    let along = Along::new(&law.program, wanted, widths(&diagram.plan.units[block]));
    How::Law(Box::new(OfLaw { along, edges: Vec::new(), edge_rates: None }))
}

/// Whether a call makes outputs of what a constraint has found.
fn is_owner(diagram: &Diagram, call: usize) -> bool {
    let step = &diagram.schedule.steps[call];
    let constraint = &diagram.schedule.blocks[step.block as usize].interface.constraint;
    constraint.as_ref().is_some_and(|constraint| constraint.group == step.group as usize)
}

/// The cells that a block reads, in their order.
fn gathered<'a>(diagram: &'a Diagram, unit: &Unit) -> impl Iterator<Item = usize> + 'a {
    let copies = &diagram.plan.copies[unit.copies.range()];
    copies.iter().flat_map(|&(from, len)| from as usize..(from + len) as usize)
}
