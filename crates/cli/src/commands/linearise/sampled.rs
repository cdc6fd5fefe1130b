//! Matrices in discrete time: from one sample hit to that a period later.

use blocksim_block::Invariant;
use blocksim_block::schedule::Schedule;
use blocksim_linear::{DMatrix, StateSpace};
use blocksim_sim::{Origin, Period, PeriodMap, PeriodSlopes, Tap};

use super::matrices::{
    Function, Labels, Linearised, Method, NoMatrices, Question, Slopes, between, divided, modes, slopes, taps,
};
use super::point::Patient;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::running::interrupt;
use crate::terminal::format::short_time;

/// Part of what a coefficient of the closed loop is made of by which it may differ from that of the model itself.
const SAME: f64 = 1e-5;

/// When, and over which period, s; none for the shortest one of the rates that take part.
#[derive(Debug, Clone, Copy)]
pub struct When {
    /// Not before this instant, s.
    pub at: f64,
    /// The period.
    pub period: Option<f64>,
    /// Whether states are sought at which nothing moves.
    pub steady: bool,
}

/// The linear system from hit to hit around an operating point; the instant, s, and the states that move all the same there.
///
/// # Errors
/// [`NoMatrices`].
pub fn linearise(
    schedule: &Schedule,
    question: &Question,
    when: When,
) -> Result<(Linearised, f64, Vec<String>), NoMatrices> {
    let involved = between(schedule, question);
    let period = Period::of(schedule, &involved, when.at, when.period)?;
    let taps = taps(question, std::iter::empty());
    let cut: Vec<bool> = taps.iter().map(|tap| tap.open).collect();
    let made = PeriodMap::new(schedule, (&involved, period), taps.clone(), when.steady, &mut Patient);
    let Some((map, adrift)) = made.map_err(|error| stopped(error.into()))? else {
        return Err(NoMatrices::Interrupted);
    };
    let modes = modes(schedule, &involved, map.discrete());
    let value = question.from.as_ref().map(|from| map.signal(from.cell));
    let x = map.states().to_vec();
    let (n, inputs, outputs) = (x.len(), usize::from(question.from.is_some()), question.to.len());
    let point: Vec<f64> = x.iter().copied().chain(vec![0.0; inputs]).collect();
    let mut there = vec![0.0; n + outputs];
    let names = map.names().to_vec();
    let mut model = Model { map, question, change: vec![0.0; taps.len()], taps, slopes: None };
    model.evaluate(&point, &mut there)?;
    let next = names.iter().map(|state| format!("the next `{state}`"));
    let input = question.from.iter().map(|from| format!("`{}`", from.name));
    let labels = Labels {
        rows: next.chain(question.to.iter().map(|to| format!("`{}`", to.name))).collect(),
        columns: names.iter().map(|state| format!("`{state}`")).chain(input).collect(),
    };
    let because = model.follow(inputs)?;
    let found = slopes((&point, &there, n), Some(period.length), &labels, &mut model);
    let Slopes { system, accuracy, kinks, method, kept } = found.map_err(stopped)?;
    if question.is_loop {
        // With the loop closed, and without a change.
        let first = question.open[0].cell;
        let closed: Vec<bool> =
            model.taps.iter().zip(&cut).map(|(tap, cut)| *cut && tap.cell != first).collect();
        model.map.open(&closed);
        model.follow(0)?;
        let none = Labels { columns: labels.columns[..n].to_vec(), rows: labels.rows[..n].to_vec() };
        let own = slopes((&point[..n], &there[..n], n), Some(period.length), &none, &mut model);
        is_once_around(&system, &own.map_err(stopped)?.system.a, question, period.length)?;
    }
    let (names, x, following) = divided(names, &x, &kept);
    let sign = if question.is_loop { -1.0 } else { 1.0 };
    let linearised = Linearised {
        accuracy,
        kinks,
        method: Method { because, ..method },
        value,
        values: there[n..].iter().map(|y| sign * y).collect(),
        held: Vec::new(),
        dead: Vec::new(),
        modes,
        names,
        x,
        following,
        system,
    };
    Ok((linearised, period.begin, adrift))
}

/// What is linearised: a model over a period, as a function of its states and of the change of a signal.
struct Model<'q> {
    map: PeriodMap,
    question: &'q Question,
    taps: Vec<Tap>,
    /// What is added at the taps.
    change: Vec<f64>,
    /// The slopes, and those with the errors of differences added.
    slopes: Option<[PeriodSlopes; 2]>,
}

impl Model<'_> {
    /// Takes the slopes where they are known, with so many inputs. Returns why they are not.
    fn follow(&mut self, inputs: usize) -> Result<Option<String>, NoMatrices> {
        let outputs: Vec<usize> = self.question.to.iter().map(|to| to.cell).collect();
        let mut go = || !interrupt::is_requested();
        let mut take = |doubts: bool| self.map.slopes(inputs, &outputs, doubts, &mut go);
        let found = take(false).and_then(|exact| {
            let doubtful = if exact.by_differences.is_empty() { exact.clone() } else { take(true)? };
            Ok([exact, doubtful])
        });
        if interrupt::is_requested() {
            return Err(NoMatrices::Interrupted);
        }
        match found {
            Ok(slopes) => self.slopes = Some(slopes),
            Err(reason) => {
                self.slopes = None;
                return Ok(Some(reason));
            }
        }
        Ok(None)
    }

    /// The outputs, or their slopes, with what is at cells and what was given at taps.
    fn outputs(&self, at: &dyn Fn(usize) -> f64, given: &dyn Fn(usize) -> f64, y: &mut [f64]) {
        for (y, to) in y.iter_mut().zip(&self.question.to) {
            *y = match self.taps.iter().position(|tap| tap.open && tap.cell == to.cell) {
                Some(place) if self.question.is_loop => -given(place),
                Some(place) => given(place),
                None => at(to.cell),
            };
        }
    }
}

impl Function for Model<'_> {
    fn evaluate(&mut self, z: &[f64], out: &mut [f64]) -> Result<(), NoMatrices> {
        if interrupt::is_requested() {
            return Err(NoMatrices::Interrupted);
        }
        let n = self.map.states().len();
        let (next, y) = out.split_at_mut(n);
        // The signal that is changed is the first one.
        self.change.fill(0.0);
        self.change.iter_mut().zip(&z[n..]).for_each(|(change, input)| *change = *input);
        self.map.evaluate(&z[..n], &self.change, next)?;
        self.outputs(&|cell| self.map.signal(cell), &|tap| self.map.given(tap), y);
        Ok(())
    }

    fn along(&mut self, direction: &[f64], doubts: bool, out: &mut [f64]) -> Origin {
        let Some(slopes) = &self.slopes else { return Origin::Unknown };
        let slopes = &slopes[usize::from(doubts)];
        let n = self.map.states().len();
        out.fill(0.0);
        let mut y = vec![0.0; out.len() - n];
        for (column, part) in direction.iter().enumerate().filter(|(_, part)| **part != 0.0) {
            let next = slopes.next.column(column);
            out.iter_mut().zip(next.iter()).for_each(|(out, slope)| *out += slope * part);
            self.outputs(&|cell| slopes.signal(cell, column), &|tap| slopes.given(tap, column), &mut y);
            out[n..].iter_mut().zip(&y).for_each(|(out, slope)| *out += slope * part);
        }
        if slopes.by_differences.is_empty() { Origin::Laws } else { Origin::Differences }
    }

    fn invariants(&mut self, z: &[f64]) -> Result<Vec<Invariant>, NoMatrices> {
        let n = self.map.states().len();
        Ok(self.map.invariants(&z[..n])?)
    }

    fn by_differences(&self) -> Vec<String> {
        self.slopes.as_ref().map_or_else(Vec::new, |slopes| slopes[0].by_differences.clone())
    }
}

/// Whoever has asked for an end gets no error of what was broken off.
fn stopped(error: NoMatrices) -> NoMatrices {
    if interrupt::is_requested() { NoMatrices::Interrupted } else { error }
}

/// Checks that the loop passes its cut once a period, with a value that holds in between: closed around the linear system it has
/// the dynamics of the model. A loop that is cut at a signal of a faster rate, or at one that moves between hits, has not.
fn is_once_around(
    system: &StateSpace,
    own: &DMatrix<f64>,
    question: &Question,
    period: f64,
) -> Result<(), NoMatrices> {
    let StateSpace { a, b, c, d, .. } = system;
    let through = 1.0 + d[(0, 0)];
    let back = if through == 0.0 { 0.0 } else { 1.0 / through };
    let n = a.nrows();
    // Sizes of states do not matter to what follows: entries are compared in those of the states that they connect.
    let size = a.amax().max(own.amax()).max(f64::MIN_POSITIVE);
    let differs = |i: usize, j: usize| {
        let around = b[(i, 0)] * c[(0, j)] * back;
        let closed = a[(i, j)] - around;
        let parts = a[(i, j)].abs() + around.abs() + own[(i, j)].abs();
        (closed - own[(i, j)]).abs() > SAME * parts && parts > 1e-9 * size
    };
    if !(0..n).any(|i| (0..n).any(|j| differs(i, j))) {
        return Ok(());
    }
    let said = format!(
        "the loop through `{}` is not passed once in the period of {} s: closed, it is another one than that of the model",
        question.open[0].name,
        short_time(period)
    );
    let help = "cut it where a block of this sample time gives the signal, or a signal that is read at these hits alone; the \
                poles of the closed loop are printed without --open";
    Err(NoMatrices::Said(Failure::new(Exit::Failed, "linearise", said).help(help)))
}
