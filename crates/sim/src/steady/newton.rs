//! The search for a steady state.

use blocksim_linear::{DMatrix, jacobian, sparse_jacobian};

use super::Rest;
use super::algebra::{LARGE, RANK, least, undetermined};
use super::conditions::{Conditions, Kept};
use crate::SimError;

/// Steps of Newton's method.
const STEPS: usize = 60;
/// Of these, steps that are not spent on making exact what holds: at a kink of a law each step may leave over a part of the one before.
const RESERVED: usize = 15;
/// Changes by which nothing that is at rest is held there, 1/s.
const AT_ONCE: f64 = 10.0;
/// An equation holds when a change of an unknown by this part of its size, or of 1, would make it so.
const HOLDS: f64 = 1e-9;
/// A step that leaves over less than this part is not held back: the equations are linear on the way.
const LINEAR: f64 = 1e-6;
/// Steps of what counts as being at rest by its size in SI units, and is not by its own.
const PATIENCE: usize = 40;
/// A step of this part of an unknown is one, if it is more than rounding of the smallest that is looked at.
const FARTHER: f64 = 1e-6;
const SMALLEST: f64 = 1e-9;
/// How the model is let go.
#[derive(Clone, Copy)]
struct Pace {
    /// Part of its size by which what moves fastest moves in the first step.
    first: f64,
    /// Factor between the lengths of two steps.
    growth: f64,
    /// Times after which no rest is sought.
    unseen: usize,
}

/// To any rest.
const SOON: Pace = Pace { first: 0.1, growth: 2.0, unseen: 0 };
/// Where the search has ended at a state that no motion leads to. Long implicit steps go to such a state, which is not stable, as to
/// any other.
const SLOWLY: Pace = Pace { first: 1e-3, growth: 1.2, unseen: 2 };
/// Times that the model is let go, and steps of each.
const RELEASES: usize = 24;
const RELEASE: usize = 12;
/// Rates of what nothing depends on are those of other states together, and always so, within this part.
const LED: f64 = 1e-6;
/// Unknowns above which that is not looked at, as it takes the cube of their number.
const MANY: usize = 500;
/// Part of the size of an equation that is rounding, as a multiple of what holds.
const ROUNDED: f64 = 1e-6;
/// Where it is looked whether something depends on an unknown, in parts of its size.
const PROBES: [f64; 10] = [1e3, -1e3, 30.0, -30.0, 1.0, -1.0, 0.1, -0.1, 1e-3, -1e-3];
/// Share of a direction that the equations leave open from which an unknown is named as a part of it, and from which it is one at all.
const SHARE: f64 = 1e-3;
const FAINT: f64 = 1e-8;
/// Longest step of the time that is let pass, s.
const ETERNITY: f64 = 1e9;

/// Why nothing was found.
pub(super) enum Failure {
    Simulation(SimError),
    Interrupted,
    Restless(Lost),
}

impl From<SimError> for Failure {
    fn from(error: SimError) -> Self {
        Self::Simulation(error)
    }
}

/// Where the search has ended in vain.
pub(super) struct Lost {
    /// Names of the equations' unknowns; held signals have none.
    pub names: Vec<String>,
    /// What each equation that is needed leaves over, in a second (for a held signal: by how much it is off), how large that
    /// is in comparison, and the number of the equation.
    pub moving: Vec<(usize, f64, f64)>,
    /// Number of equations that belong to an unknown each.
    pub paired: usize,
}

/// Slopes of the equations and which of them are needed.
#[derive(Clone)]
struct Slopes {
    matrix: DMatrix<f64>,
    needed: Vec<bool>,
    sizes: Vec<f64>,
    /// What a change of an unknown by its size makes of each equation.
    scale: Vec<f64>,
    /// Slopes of the equations that are not needed, of unknowns on which nothing depends.
    idle: Vec<(usize, Vec<f64>)>,
}

pub(super) struct Search<'s, 'g> {
    conditions: Conditions<'s>,
    go: &'g mut dyn FnMut() -> bool,
    /// What the equations leave over.
    rest: Vec<f64>,
    /// Sizes of the unknowns where the search began.
    origin: Vec<f64>,
    /// Where the first of several searches began.
    begin: &'g mut Option<Begin>,
}

/// Where a search began.
pub(super) struct Begin {
    z: Vec<f64>,
    /// How the rates of what nothing depends on were those of other states there.
    led: Vec<Led>,
    /// The slopes there, where anything could be led.
    slopes: Option<Slopes>,
    /// Unknowns that never move, and are left where they are.
    unmoved: Vec<bool>,
}

/// The rate of an unknown on which nothing depends, as a sum of those of others: numbers and factors.
type Led = (usize, Vec<(usize, f64)>);

impl<'s, 'g> Search<'s, 'g> {
    pub fn new(
        conditions: Conditions<'s>,
        go: &'g mut dyn FnMut() -> bool,
        begin: &'g mut Option<Begin>,
    ) -> Self {
        let rest = vec![0.0; conditions.equations()];
        let origin = conditions.sizes(&conditions.present());
        Self { conditions, go, rest, origin, begin }
    }

    /// Searches from the present states; where `lets_go`, not before the model has been let go from there.
    pub fn run(mut self, lets_go: bool) -> Result<Rest, Failure> {
        let mut z = self.conditions.present();
        let mut kept = self.conditions.keep();
        let mut lost = None;
        if !lets_go {
            match self.newton(z.clone())? {
                Ok(rest) => return Ok(rest),
                Err(found) => lost = Some(found),
            }
        }
        // The model is let go from where it was, and looked at now and then.
        let mut step = None;
        let pace = if lets_go { SLOWLY } else { SOON };
        for k in 0..RELEASES {
            self.conditions.recall(&kept);
            if !self.release(&mut z, &mut step, pace)? {
                break;
            }
            kept = self.conditions.keep();
            if k < pace.unseen {
                continue;
            }
            match self.newton(z.clone())? {
                Ok(rest) => return Ok(rest),
                Err(found) => lost = lost.or(Some(found)),
            }
        }
        match lost {
            Some(lost) => Err(Failure::Restless(lost)),
            None => self.newton(z)?.map_err(Failure::Restless),
        }
    }

    /// What moves at the present states all the same, measured by itself; nothing where all equations hold.
    pub fn judge(mut self) -> Result<Option<Failure>, Failure> {
        let z = self.conditions.present();
        let mut slopes = self.slopes(&z)?;
        self.conditions.evaluate(&z, &mut self.rest)?;
        let paired = self.conditions.paired();
        for (scale, size) in slopes.scale.iter_mut().zip(&slopes.sizes).take(paired) {
            *scale = scale.min(AT_ONCE * size);
        }
        let lost = self.lost(&slopes);
        Ok((!lost.moving.is_empty()).then_some(Failure::Restless(lost)))
    }

    /// Newton's method with damping.
    fn newton(&mut self, mut z: Vec<f64>) -> Result<Result<Rest, Lost>, Failure> {
        self.conditions.settle(&mut z)?;
        let mut slopes = self.slopes(&z)?;
        if self.begin.is_none() {
            let led = slopes.led(self.conditions.states());
            let is_small = !slopes.idle.is_empty() && slopes.sizes.len() <= MANY;
            let first = is_small.then(|| slopes.clone());
            let unmoved = self.unmoved(&z, &slopes)?;
            let is_any = unmoved.contains(&true);
            *self.begin = Some(Begin { z: z.clone(), led, slopes: first, unmoved });
            if is_any {
                slopes = self.slopes(&z)?;
            }
        }
        let mut patience = PATIENCE;
        for k in 0..STEPS {
            let now = slopes.norm(&self.rest);
            let worst = slopes.worst(&self.rest);
            let step = slopes.step(&self.rest, |_| 0.0);
            if worst <= HOLDS {
                // As exactly as numbers allow.
                let rest = self.rest.clone();
                let next = step.as_ref().map(|step| moved(&z, step, 1.0));
                let left = match &next {
                    Some(next) => self.try_at(next).map_or(f64::INFINITY, |()| slopes.norm(&self.rest)),
                    None => f64::INFINITY,
                };
                let is_worth_it = left < 0.5 * now
                    || left < now
                        && step.as_ref().is_some_and(|step| self.falls_short(&z, step, &slopes, &rest));
                let goes_on = is_worth_it && k < STEPS - RESERVED;
                // What is small, as volumes and leakage currents are, may still have a long way to go.
                let far = step.filter(|step| !goes_on && patience > 0 && is_far(&z, step));
                if let Some(next) = next.filter(|_| goes_on) {
                    z = next;
                } else if let Some(next) = far.and_then(|step| self.along(&z, &step, &slopes, now)) {
                    patience -= 1;
                    z = next;
                    self.conditions.settle(&mut z)?;
                } else if !self.conditions.settle(&mut z)? {
                    if self.binds(&z, &slopes, &rest)? {
                        slopes = self.slopes(&z)?;
                        continue;
                    }
                    if self.lead(&mut z, &slopes, &rest) {
                        self.conditions.settle(&mut z)?;
                    }
                    self.conditions.evaluate(&z, &mut self.rest)?;
                    return Ok(Ok(self.found(&z, &slopes)));
                }
            } else {
                let Some(next) = step.and_then(|step| self.along(&z, &step, &slopes, now)) else { break };
                z = next;
                self.conditions.settle(&mut z)?;
            }
            slopes = self.slopes(&z)?;
        }
        self.conditions.evaluate(&z, &mut self.rest)?;
        Ok(Err(self.lost(&slopes)))
    }

    /// Which unknowns never move, whatever the others are, and could have any value: an integrator of a constant zero, a pressure
    /// that is shut in, the integral part of a controller without integral gain. Whatever the run, they stay as they are written, so
    /// they are no part of the least change that leads to a rest. `z` is where the search begins.
    fn unmoved(&mut self, z: &[f64], slopes: &Slopes) -> Result<Vec<bool>, Failure> {
        let paired = self.conditions.paired();
        let is_still = |i: usize| i < paired && slopes.is_held(i) && self.is_still(i, slopes);
        let mut unmoved: Vec<bool> = (0..z.len()).map(is_still).collect();
        if !unmoved.contains(&true) {
            return Ok(unmoved);
        }
        let free = undetermined(slopes.matrix.clone(), &slopes.sizes, FAINT);
        unmoved.iter_mut().zip(free).for_each(|(unmoved, is_free)| *unmoved &= is_free);
        let (kept, candidates) = (self.conditions.keep(), unmoved.clone());
        // Slopes are those at one place: behind a dead zone, or where a valve opens, it may be another matter.
        for (part, all) in PROBES.iter().flat_map(|part| [(part, false), (part, true)]) {
            self.conditions.recall(&kept);
            let mut beside = z.to_vec();
            for (k, z) in beside.iter_mut().enumerate().filter(|(k, _)| all || !candidates[*k]) {
                *z += part * slopes.sizes[k] * uneven(k);
            }
            if self.conditions.settle(&mut beside).is_ok() && self.try_at(&beside).is_some() {
                unmoved.iter_mut().enumerate().for_each(|(i, unmoved)| *unmoved &= self.is_still(i, slopes));
            }
        }
        self.back(z, &kept)?;
        Ok(unmoved)
    }

    /// Whether an unknown of those that have an equation each stays where it is, by what the equations leave over.
    fn is_still(&self, i: usize, slopes: &Slopes) -> bool {
        let moves = |rest: &f64| rest.abs() * self.conditions.rates[i] > HOLDS * slopes.sizes[i];
        self.rest.get(i).is_some_and(|rest| !moves(rest))
    }

    /// Comes back to `z` from a look around.
    fn back(&mut self, z: &[f64], kept: &Kept) -> Result<(), Failure> {
        self.conditions.recall(kept);
        self.conditions.settle(&mut z.to_vec())?;
        self.conditions.evaluate(z, &mut self.rest)?;
        Ok(())
    }

    /// Whether something depends on what moves all the same, though not in the first order: a load that grows with the square of a speed does
    /// not depend on it at rest, and a stop not on the place of what is above it. What does must rest as well, from here on.
    /// `rest` is what the equations leave over at `z`.
    fn binds(&mut self, z: &[f64], slopes: &Slopes, rest: &[f64]) -> Result<bool, Failure> {
        let paired = self.conditions.paired();
        let moves = |i: &usize| rest[*i].abs() * self.conditions.rates[*i] > HOLDS * slopes.sizes[*i];
        let idle: Vec<usize> = slopes.idle.iter().map(|(i, _)| *i).collect();
        if !idle.iter().any(|i| moves(i) && !self.conditions.drifts[*i]) {
            return Ok(false);
        }
        let kept = self.conditions.keep();
        // Which equations change with which of them, anywhere near.
        let mut acts = vec![vec![false; paired]; idle.len()];
        for (acts, &i) in acts.iter_mut().zip(&idle) {
            for part in PROBES {
                self.conditions.recall(&kept);
                let mut beside = z.to_vec();
                beside[i] += part * slopes.sizes[i];
                if self.conditions.settle(&mut beside).is_err() || self.try_at(&beside).is_none() {
                    continue;
                }
                let pairs = rest.iter().zip(&self.rest).zip(&slopes.scale);
                for (acts, ((here, there), scale)) in acts.iter_mut().zip(pairs) {
                    // What holds is rounding, which may be another one there.
                    *acts |= (here - there).abs() > HOLDS * here.abs().max(there.abs()).max(ROUNDED * scale);
                }
            }
        }
        self.back(z, &kept)?;
        let mut needed = slopes.needed.clone();
        idle.iter().for_each(|&i| needed[i] = true);
        while let Some(free) = idle
            .iter()
            .zip(&acts)
            .find(|(i, acts)| needed[**i] && acts.iter().enumerate().all(|(row, acts)| !needed[row] || !acts))
        {
            needed[*free.0] = false;
        }
        let bound: Vec<usize> =
            idle.into_iter().filter(|&i| needed[i] && !self.conditions.drifts[i]).collect();
        bound.iter().for_each(|&i| self.conditions.may_drift[i] = false);
        Ok(!bound.is_empty())
    }

    /// Brings what nothing depends on to where the others have led it: a place that is measured beside a spring has gone with the
    /// spring. Only where their rates are bound at both ends of the way in the same manner, as those of one place are. Whether anything
    /// has moved.
    fn lead(&self, z: &mut [f64], slopes: &Slopes, rest: &[f64]) -> bool {
        let Some(Begin { z: begin, led, slopes: first, .. }) = &*self.begin else { return false };
        let before = z.to_vec();
        let now = slopes.led(self.conditions.states());
        let idle = slopes.idle.iter().map(|(own, _)| *own);
        for own in idle {
            // What goes on moving has no place of its own: the angle of a shaft that turns stays as it is written.
            if rest[own].abs() > HOLDS * slopes.sizes[own] {
                continue;
            }
            let of = |all: &'_ [Led]| {
                all.iter().find(|(other, _)| *other == own).map(|(_, factors)| factors.clone())
            };
            let is_kept = |factors: &Vec<(usize, f64)>, by: &Slopes| by.follows(own, factors);
            let factors =
                of(&now).filter(|factors| first.as_ref().is_some_and(|first| is_kept(factors, first)));
            let factors = factors.or_else(|| of(led).filter(|factors| is_kept(factors, slopes)));
            // Where all is held at the end, nothing else tells what has been one place.
            let beside = || {
                let first = first.as_ref()?;
                let moved = (0..self.conditions.states()).filter(|&k| k != own && before[k] != begin[k]);
                let mut beside = moved.filter_map(|k| Some(vec![(k, first.proportion(own, k)?)]));
                beside.find(|factors| is_kept(factors, slopes) || slopes.is_held(factors[0].0))
            };
            if let Some(factors) = factors.or_else(beside) {
                z[own] = begin[own] + factors.iter().map(|(k, f)| f * (z[*k] - begin[*k])).sum::<f64>();
            }
        }
        before != z
    }

    /// Whether slopes promise too much at `z`, where the equations leave over `rest`: a step that is said to make them hold, taken
    /// as far as a change still counts as nothing, leaves most of it. So it is beside a pole of a slope, as of a root near zero.
    fn falls_short(&mut self, z: &[f64], step: &[f64], slopes: &Slopes, rest: &[f64]) -> bool {
        let sizes = step.iter().zip(&slopes.sizes);
        let longest = sizes.map(|(step, size)| step.abs() / size).fold(0.0, f64::max);
        if longest == 0.0 {
            return false;
        }
        let said = &slopes.matrix * DMatrix::from_column_slice(step.len(), 1, step);
        let left: Vec<f64> = rest.iter().zip(said.iter()).map(|(rest, said)| rest + said).collect();
        let far = moved(z, step, (HOLDS / longest).max(1.0));
        if slopes.norm(&left) > 0.1 * slopes.norm(rest) || self.try_at(&far).is_none() {
            return false;
        }
        let parts = rest.iter().zip(&self.rest).zip(&slopes.scale).zip(&slopes.needed);
        let parts =
            parts.filter(|(_, needed)| **needed).map(|(((here, far), scale), _)| (here / scale, far / scale));
        let (still, all) =
            parts.fold((0.0, 0.0), |(still, all), (here, far)| (still + here * far, all + here * here));
        still > 0.5 * all
    }

    /// The longest part of a step that helps. No unknown moves by more than its size, or 1, at once where the equations are
    /// not linear: beyond there may be another rest than the near one.
    fn along(&mut self, z: &[f64], step: &[f64], slopes: &Slopes, now: f64) -> Option<Vec<f64>> {
        let longest = slopes.longest(step);
        let whole = moved(z, step, 1.0);
        if self.try_at(&whole).is_some_and(|()| slopes.norm(&self.rest) <= LINEAR * now) {
            return Some(whole);
        }
        (0..30).map(|k| 0.5_f64.powi(k) / longest).find_map(|part| {
            let next = moved(z, step, part);
            self.try_at(&next)?;
            (slopes.norm(&self.rest) < (1.0 - 0.01 * part) * now).then_some(next)
        })
    }

    /// Implicit steps in time from `z`, the first one of length `step`, s; returns whether it went on.
    fn release(&mut self, z: &mut Vec<f64>, step: &mut Option<f64>, pace: Pace) -> Result<bool, Failure> {
        for _ in 0..RELEASE {
            let slopes = self.slopes(z)?;
            let rates = self.conditions.rates.clone();
            let of = |i: usize| rates[i] * self.rest[i].abs() / slopes.sizes[i];
            let fastest =
                (0..self.conditions.paired()).filter(|i| slopes.needed[*i]).map(of).fold(0.0, f64::max);
            let mut h = step.unwrap_or((pace.first / fastest).clamp(1e-9, 1.0));
            let next = loop {
                if h < 1e-15 {
                    return Ok(false);
                }
                let there =
                    slopes.step(&self.rest, |i| if rates[i] > 0.0 { 1.0 / (h * rates[i]) } else { 0.0 });
                let kept = self.rest.clone();
                match there.map(|step| (slopes.longest(&step), moved(z, &step, 1.0))) {
                    Some((longest, next)) if longest <= 1.0 && self.try_at(&next).is_some() => break next,
                    _ => {
                        self.rest = kept;
                        h /= 4.0;
                    }
                }
            };
            *z = next;
            self.conditions.settle(z)?;
            if h > ETERNITY {
                return Ok(false);
            }
            *step = Some(pace.growth * h);
        }
        Ok(true)
    }

    /// Evaluates the equations at a place where they may have no value.
    fn try_at(&mut self, z: &[f64]) -> Option<()> {
        self.conditions.evaluate(z, &mut self.rest).ok()?;
        self.rest.iter().all(|rest| rest.is_finite()).then_some(())
    }

    /// Slopes of all equations; `self.rest` is left as at `z`.
    fn slopes(&mut self, z: &[f64]) -> Result<Slopes, Failure> {
        if !(self.go)() {
            return Err(Failure::Interrupted);
        }
        let conditions = &mut self.conditions;
        let rows = conditions.equations();
        conditions.evaluate(z, &mut self.rest)?;
        let mut matrix = DMatrix::zeros(rows, z.len());
        let unknown = conditions.slopes(&mut matrix);
        if !unknown.is_empty() {
            let mut all = z.to_vec();
            let equations = |some: &[f64], rest: &mut [f64]| -> Result<(), std::convert::Infallible> {
                unknown.iter().zip(some).for_each(|(&column, z)| all[column] = *z);
                if conditions.evaluate(&all, rest).is_err() {
                    rest.fill(f64::NAN);
                }
                Ok(())
            };
            let some: Vec<f64> = unknown.iter().map(|&column| z[column]).collect();
            let sought = if rows > LARGE { sparse_jacobian } else { jacobian };
            let found = sought(&some, rows, equations).unwrap_or_else(|never| match never {});
            for (own, &column) in unknown.iter().enumerate() {
                matrix.set_column(column, &found.value.column(own));
            }
            conditions.evaluate(z, &mut self.rest)?;
        }
        let sizes = conditions.sizes(z);
        for (column, size) in sizes.iter().enumerate() {
            if matrix.column(column).iter().any(|slope| !slope.is_finite()) {
                one_sided(conditions, z, column, *size, &self.rest, &mut matrix);
            }
            if conditions.fixed[column] {
                matrix.column_mut(column).fill(0.0);
            }
        }
        let mut needed = vec![true; rows];
        let paired = needed.iter_mut().zip(&conditions.fixed).take(conditions.paired());
        paired.for_each(|(needed, fixed)| *needed = !fixed);
        // On what nothing depends that is needed is not needed itself.
        while let Some(idle) = (0..conditions.paired()).find(|&unknown| {
            let is_idle = |row: usize| !needed[row] || matrix[(row, unknown)] == 0.0;
            needed[unknown] && conditions.may_drift[unknown] && (0..rows).all(is_idle)
        }) {
            needed[idle] = false;
        }
        let unmoved = self.begin.iter_mut().flat_map(|begin| &mut begin.unmoved).enumerate();
        for (i, unmoved) in unmoved.filter(|(_, unmoved)| **unmoved) {
            // What moves here after all, as what a limit held has come off it, is free from here on.
            let moves = self.rest[i].abs() * conditions.rates[i] > HOLDS * sizes[i];
            *unmoved = !moves && matrix.row(i).iter().all(|slope| *slope == 0.0);
            if *unmoved {
                matrix.column_mut(i).fill(0.0);
            }
        }
        let is_idle = |i: &usize| !needed[*i] && !conditions.fixed[*i];
        let idle = (0..conditions.paired()).filter(is_idle);
        let idle = idle.map(|i| (i, matrix.row(i).iter().copied().collect())).collect();
        let mut scale = vec![0.0; rows];
        for (row, scale) in scale.iter_mut().enumerate() {
            let effects = sizes.iter().enumerate().map(|(column, size)| matrix[(row, column)].abs() * size);
            *scale = effects.fold(0.0, f64::max);
            if *scale == 0.0 {
                // What nothing can change does not become right by going on for long.
                *scale = self.origin.get(row).filter(|_| row < conditions.paired()).copied().unwrap_or(1.0);
            }
            if !needed[row] {
                matrix.row_mut(row).fill(0.0);
            }
        }
        Ok(Slopes { matrix, needed, sizes, scale, idle })
    }

    fn found(&self, z: &[f64], slopes: &Slopes) -> Rest {
        let Conditions { names, fixed, may_drift, rates, .. } = &self.conditions;
        let paired = self.conditions.paired();
        let moves =
            |i: &usize| !slopes.needed[*i] && (self.rest[*i] * rates[*i]).abs() > HOLDS * slopes.sizes[*i];
        let free = undetermined(slopes.matrix.clone(), &slopes.sizes, SHARE);
        // Places on which nothing depends are free as a matter of course.
        let is_free =
            |i: &usize| free[*i] && !fixed[*i] && (*i >= paired || slopes.needed[*i] || !may_drift[*i]);
        Rest {
            adrift: (0..paired).filter(moves).map(|i| (names[i].clone(), self.rest[i] * rates[i])).collect(),
            undetermined: (0..names.len()).filter(is_free).map(|i| names[i].clone()).collect(),
            found: self.conditions.found(z),
            evaluations: self.conditions.evaluations,
        }
    }

    fn lost(&self, slopes: &Slopes) -> Lost {
        let paired = self.conditions.paired();
        let rates = &self.conditions.rates;
        let entry = |i: usize| {
            let by = if i < paired { self.rest[i] * rates[i] } else { self.rest[i] };
            let size = slopes.sizes.get(i).filter(|_| i < paired).copied().unwrap_or(1.0);
            (i, by, by.abs() / size)
        };
        let moves = |i: &usize| slopes.needed[*i] && self.rest[*i].abs() > HOLDS * slopes.scale[*i];
        let mut moving: Vec<_> = (0..self.rest.len()).filter(moves).map(entry).collect();
        moving.sort_by(|a, b| b.2.total_cmp(&a.2));
        Lost { names: self.conditions.names.clone(), moving, paired }
    }
}

impl Slopes {
    /// The shortest step to where the equations hold, `slowness` subtracted from the slope of each by its own unknown.
    fn step(&self, rest: &[f64], slowness: impl Fn(usize) -> f64) -> Option<Vec<f64>> {
        let mut matrix = self.matrix.clone();
        for i in 0..matrix.nrows().min(matrix.ncols()) {
            if self.needed[i] {
                matrix[(i, i)] -= slowness(i);
            }
        }
        let right: Vec<f64> =
            rest.iter().zip(&self.needed).map(|(rest, needed)| if *needed { -rest } else { 0.0 }).collect();
        least(matrix, &right, &self.sizes)
    }

    /// Of unknowns on which nothing depends those of continuous time whose rates are sums of the rates of others, and how.
    fn led(&self, states: usize) -> Vec<Led> {
        let rows: Vec<usize> = (0..states).filter(|row| self.needed[*row]).collect();
        let idle: Vec<&(usize, Vec<f64>)> = self.idle.iter().filter(|(i, _)| *i < states).collect();
        if idle.is_empty() || rows.is_empty() || self.sizes.len() > MANY {
            return Vec::new();
        }
        // Rates of a size of one for changes of the unknowns by their sizes.
        let unit = |values: &mut dyn Iterator<Item = f64>| {
            let scaled: Vec<f64> = values.zip(&self.sizes).map(|(slope, size)| slope * size).collect();
            let largest = scaled.iter().fold(0.0, |most: f64, slope| most.max(slope.abs()));
            let by = if largest > 0.0 { 1.0 / largest } else { 0.0 };
            (scaled.iter().map(|slope| slope * by).collect::<Vec<f64>>(), by)
        };
        let basis: Vec<(Vec<f64>, f64)> =
            rows.iter().map(|row| unit(&mut self.matrix.row(*row).iter().copied())).collect();
        let wanted: Vec<(Vec<f64>, f64)> =
            idle.iter().map(|(_, slopes)| unit(&mut slopes.iter().copied())).collect();
        let of = |all: &[(Vec<f64>, f64)]| DMatrix::from_fn(self.sizes.len(), all.len(), |i, k| all[k].0[i]);
        let (basis_matrix, right) = (of(&basis), of(&wanted));
        let Some(parts) = basis_matrix.clone().try_svd(true, true, f64::EPSILON, 10_000) else {
            return Vec::new();
        };
        let border = RANK * parts.singular_values.max();
        let Ok(factors) = parts.solve(&right, border) else { return Vec::new() };
        let left = &basis_matrix * &factors - &right;
        let largest = factors.amax();
        let is_led = |k: &usize| wanted[*k].1 > 0.0 && left.column(*k).amax() <= LED;
        let led = (0..idle.len()).filter(is_led).map(|k| {
            let others =
                rows.iter().enumerate().filter(|(row, _)| factors[(*row, k)].abs() > LED * 1e-3 * largest);
            let others = others.map(|(row, i)| (*i, factors[(row, k)] * basis[row].1 / wanted[k].1));
            (idle[k].0, others.collect())
        });
        led.collect()
    }

    /// What a change of an unknown by its size makes of an equation, needed or not.
    fn row(&self, i: usize, j: usize) -> f64 {
        let idle = self.idle.iter().find(|(k, _)| *k == i);
        idle.map_or_else(|| self.matrix[(i, j)], |(_, slopes)| slopes[j]) * self.sizes[j]
    }

    /// Whether no unknown moves another one.
    fn is_held(&self, i: usize) -> bool {
        (0..self.sizes.len()).all(|j| self.row(i, j) == 0.0)
    }

    /// The factor by which the rate of an unknown is that of another one, if both move.
    fn proportion(&self, own: usize, other: usize) -> Option<f64> {
        let columns = 0..self.sizes.len();
        let most = columns.max_by(|a, b| self.row(own, *a).abs().total_cmp(&self.row(own, *b).abs()))?;
        let factor = self.row(own, most) / self.row(other, most);
        let moves = factor != 0.0 && factor.is_finite();
        (moves && self.follows(own, &[(other, factor)])).then_some(factor)
    }

    /// Whether the rate of an unknown is this sum of those of others.
    fn follows(&self, own: usize, factors: &[(usize, f64)]) -> bool {
        let row = |i: usize, j: usize| self.row(i, j);
        let columns = 0..self.sizes.len();
        let largest = columns.clone().fold(0.0, |most: f64, j| most.max(row(own, j).abs()));
        let left = |j: usize| row(own, j) - factors.iter().map(|(k, f)| f * row(*k, j)).sum::<f64>();
        columns.into_iter().all(|j| left(j).abs() <= LED * largest)
    }

    fn longest(&self, step: &[f64]) -> f64 {
        step.iter().zip(&self.sizes).map(|(step, size)| step.abs() / size).fold(1.0, f64::max)
    }

    fn parts<'a>(&'a self, rest: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let needed = rest.iter().zip(&self.scale).zip(&self.needed).filter(|(_, needed)| **needed);
        needed.map(|((rest, scale), _)| rest.abs() / scale)
    }

    fn worst(&self, rest: &[f64]) -> f64 {
        self.parts(rest).fold(0.0, f64::max)
    }

    fn norm(&self, rest: &[f64]) -> f64 {
        self.parts(rest).map(|part| part * part).sum::<f64>().sqrt()
    }
}

/// Parts of 1 to 2 with either sign, of which no few cancel each other.
fn uneven(k: usize) -> f64 {
    let part = 1.0 + (k as f64 * std::f64::consts::SQRT_2).fract();
    if k.is_multiple_of(2) { part } else { -part }
}

/// Whether a step changes some unknown by more than its last digits.
fn is_far(z: &[f64], step: &[f64]) -> bool {
    z.iter().zip(step).any(|(z, step)| step.abs() > FARTHER * z.abs().max(SMALLEST))
}

fn moved(z: &[f64], step: &[f64], part: f64) -> Vec<f64> {
    z.iter().zip(step).map(|(z, step)| z + part * step).collect()
}

/// Slopes by one unknown at the border of what the equations are defined for, by a step to the side where they are.
fn one_sided(
    conditions: &mut Conditions,
    z: &[f64],
    column: usize,
    size: f64,
    rest: &[f64],
    matrix: &mut DMatrix<f64>,
) {
    let mut there = vec![0.0; rest.len()];
    let mut beside = z.to_vec();
    for h in [1e-4 * size, -1e-4 * size] {
        beside[column] = z[column] + h;
        let done = conditions.evaluate(&beside, &mut there).is_ok();
        if done && there.iter().all(|value| value.is_finite()) {
            for (row, (there, rest)) in there.iter().zip(rest).enumerate() {
                matrix[(row, column)] = (there - rest) / h;
            }
            return;
        }
    }
    matrix.column_mut(column).fill(0.0);
}
