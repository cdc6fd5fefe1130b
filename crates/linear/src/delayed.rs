//! Linear systems with dead times, exactly: not by polynomials that stand for them.
//!
//! Each dead time is taken out of the system: what comes out of it is an input, what goes into it an output of a
//! rational system, and at each frequency they are joined by `exp(-j w T)` (a linear fractional transformation).

use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix};

use crate::parts::parts;
use crate::poles::{balanced, poles};
use crate::{Gain, LinearError, StateSpace, frequencies};

/// Change of the phase of a dead time between two frequencies that are looked at, rad.
const TURN: f64 = 0.15;
/// Most frequencies.
const MOST: usize = 20_000;
/// Change of an argument in a step along the axis that is believed, rad, and halvings of a step that turns by more.
const SURE: f64 = 0.4;
const HALVINGS: u32 = 40;
/// Real part of a pole, relative to its size, that is rounding.
const BORDER: f64 = 1e-12;
/// Most steps along the axis.
const MOST_STEPS: usize = 400_000;
/// How far below 1 what comes back through dead times must be, as a part of how far it ever gets.
const QUIET: f64 = 0.05;
/// Frequencies in a decade at which that is looked at.
const EVEN: f64 = 60.0;

/// One input and one output of a system with dead times in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Delayed {
    /// From the input and what comes out of each dead time, to the output and what goes into each.
    system: StateSpace,
    /// s, one for each.
    times: Vec<f64>,
}

impl Delayed {
    /// The way from the first input to an output of a system whose last inputs and outputs are the ends and the beginnings of dead times
    /// `times`, s. States and dead times that have no part in it are left away, by the places of zeros.
    ///
    /// # Panics
    /// If the system has fewer inputs or outputs than that.
    pub fn new(system: &StateSpace, output: usize, times: &[f64]) -> Delayed {
        let (m, outputs) = (times.len(), system.c.nrows() - times.len());
        let rows: Vec<usize> = std::iter::once(output).chain(outputs..outputs + m).collect();
        let columns: Vec<usize> = (0..=m).collect();
        let system = StateSpace {
            a: system.a.clone(),
            b: system.b.select_columns(&columns),
            c: system.c.select_rows(&rows),
            d: system.d.select_rows(&rows).select_columns(&columns),
            period: None,
        };
        Delayed { system, times: times.to_vec() }.connected()
    }

    /// All of a system whose last inputs and outputs are the ends and the beginnings of dead times `times`, s; what else goes in and comes
    /// out is nothing.
    ///
    /// # Panics
    /// If the system has fewer inputs or outputs than that.
    pub fn whole(system: &StateSpace, times: &[f64]) -> Delayed {
        let m = times.len();
        let (inputs, outputs) = (system.b.ncols() - m, system.c.nrows() - m);
        let mut d = DMatrix::zeros(m + 1, m + 1);
        d.view_mut((1, 1), (m, m)).copy_from(&system.d.view((outputs, inputs), (m, m)));
        let system = StateSpace {
            a: system.a.clone(),
            b: system.b.columns(inputs, m).into_owned().insert_column(0, 0.0),
            c: system.c.rows(outputs, m).into_owned().insert_row(0, 0.0),
            d,
            period: None,
        };
        Delayed { system, times: times.to_vec() }
    }

    /// Keeps states and dead times between the input and the output.
    fn connected(self) -> Delayed {
        let Delayed { system, times } = self;
        let (n, m) = (system.a.nrows(), times.len());
        // Nodes: states, then the input or output, then dead times.
        let leads = |from: usize, to: usize| match (from < n, to < n) {
            (true, true) => system.a[(to, from)] != 0.0,
            (true, false) => system.c[(to - n, from)] != 0.0,
            (false, true) => system.b[(to, from - n)] != 0.0,
            (false, false) => system.d[(to - n, from - n)] != 0.0,
        };
        let spread = |leads: &dyn Fn(usize, usize) -> bool| {
            let mut known = vec![false; n + 1 + m];
            let mut open = vec![n];
            while let Some(from) = open.pop() {
                for (to, known) in known.iter_mut().enumerate().filter(|(to, _)| leads(from, *to)) {
                    // The input is not the output.
                    if !std::mem::replace(known, true) && to != n {
                        open.push(to);
                    }
                }
            }
            known
        };
        let (reached, seen) = (spread(&leads), spread(&|from, to| leads(to, from)));
        let is_between = |node: &usize| reached[*node] && seen[*node];
        let states: Vec<usize> = (0..n).filter(is_between).collect();
        let dead: Vec<usize> = (n + 1..n + 1 + m).filter(is_between).map(|node| node - n - 1).collect();
        Delayed { system, times }.part(&states, &dead)
    }

    /// Whether no dead time is between the input and the output.
    pub fn is_rational(&self) -> bool {
        self.times.is_empty()
    }

    /// Number of states besides what is in the dead times.
    pub fn order(&self) -> usize {
        self.system.a.nrows()
    }

    /// The dead times on the way, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Whether what goes into a dead time depends on what comes out of one that it feeds: there are then infinitely many poles.
    pub fn is_circular(&self) -> bool {
        let StateSpace { a, b, c, d, .. } = &self.system;
        let (n, m) = (a.nrows(), self.times.len());
        let leads = |from: usize, to: usize| match (from < n, to < n) {
            (true, true) => a[(to, from)] != 0.0,
            (true, false) => c[(to - n + 1, from)] != 0.0,
            (false, true) => b[(to, from - n + 1)] != 0.0,
            (false, false) => d[(to - n + 1, from - n + 1)] != 0.0,
        };
        let comes_back = |start: usize| {
            let mut known = vec![false; n + m];
            let mut open = vec![start];
            while let Some(from) = open.pop() {
                for (to, known) in known.iter_mut().enumerate().filter(|(to, _)| leads(from, *to)) {
                    if !std::mem::replace(known, true) {
                        open.push(to);
                    }
                }
            }
            known[start]
        };
        (n..n + m).any(comes_back)
    }

    /// The poles, where they are finitely many: no dead time feeds itself.
    ///
    /// # Errors
    /// [`LinearError`] of the eigenvalues.
    pub fn poles(&self) -> Result<Option<Vec<Complex<f64>>>, LinearError> {
        if self.is_circular() { Ok(None) } else { poles(&self.system.a).map(Some) }
    }

    /// Output over input at a frequency, rad/s. Infinite at a pole.
    pub fn at(&self, frequency: f64) -> Complex<f64> {
        let s = Complex::new(0.0, frequency);
        let infinite = Complex::new(f64::INFINITY, 0.0);
        let complex = |m: &DMatrix<f64>| m.map(|x| Complex::new(x, 0.0));
        let StateSpace { a, b, c, d, .. } = &self.system;
        let n = a.nrows();
        let (a, scale) = balanced(a.clone());
        let b = DMatrix::from_fn(n, b.ncols(), |i, j| b[(i, j)] / scale[i]);
        let c = DMatrix::from_fn(c.nrows(), n, |i, j| c[(i, j)] * scale[j]);
        let mut m = complex(&-a);
        (0..n).for_each(|i| m[(i, i)] += s);
        let Some(x) = solved(m, complex(&b)) else { return infinite };
        let g = complex(&c) * x + complex(d);
        let count = self.times.len();
        // w = e v, v = g21 u + g22 w.
        let e = |i: usize| (-s * self.times[i]).exp();
        let joined = DMatrix::from_fn(count, count, |i, j| {
            Complex::new(f64::from(u8::from(i == j)), 0.0) - e(i) * g[(i + 1, j + 1)]
        });
        let from = DMatrix::from_fn(count, 1, |i, _| e(i) * g[(i + 1, 0)]);
        let Some(w) = solved(joined, from) else { return infinite };
        let out = g[(0, 0)] + (0..count).map(|i| g[(0, i + 1)] * w[(i, 0)]).sum::<Complex<f64>>();
        if out.re.is_finite() && out.im.is_finite() { out } else { infinite }
    }

    /// The same without its dead times: what goes in comes out at once. `None` where that is an equation without a solution.
    fn without(&self) -> Option<StateSpace> {
        let StateSpace { a, b, c, d, .. } = &self.system;
        let m = self.times.len();
        let (d21, d22) = (d.view((1, 0), (m, 1)), d.view((1, 1), (m, m)));
        let inverse = (DMatrix::identity(m, m) - d22).try_inverse()?;
        let (b1, b2) = (b.columns(0, 1), b.columns(1, m));
        let (c1, c2) = (c.rows(0, 1), c.rows(1, m));
        let (through, around) = (&inverse * d21, &inverse * c2);
        let d12 = d.view((0, 1), (1, m));
        Some(StateSpace {
            a: a + b2 * &around,
            b: b1 + b2 * &through,
            c: c1 + d12 * &around,
            d: d.view((0, 0), (1, 1)) + d12 * &through,
            period: None,
        })
    }

    /// The loop that is closed around this one by a negative feedback of 1; `None` where `1 + D` is zero.
    pub fn closed(&self) -> Option<Delayed> {
        let StateSpace { a, b, c, d, .. } = &self.system;
        let through = 1.0 + d[(0, 0)];
        if through.abs() < f64::EPSILON * (1.0 + d[(0, 0)].abs()) {
            return None;
        }
        // Of y = c1 x + d1 (u - y, w).
        let (b1, c1) = (b.columns(0, 1).into_owned(), c.rows(0, 1).into_owned());
        let (d1, d2) = (d.rows(0, 1).into_owned(), d.columns(0, 1).into_owned());
        Some(Delayed {
            system: StateSpace {
                a: a - &b1 * &c1 / through,
                b: b - &b1 * &d1 / through,
                c: c - &d2 * &c1 / through,
                d: d - &d2 * &d1 / through,
                period: None,
            },
            times: self.times.clone(),
        })
    }

    /// What a constant input leads to.
    ///
    /// # Errors
    /// [`LinearError`] of the eigenvalues.
    pub fn static_gain(&self) -> Result<Gain, LinearError> {
        let Some(without) = self.without() else { return Ok(Gain::Infinite) };
        let poles = poles(&without.a)?;
        Ok(crate::static_gain(&without.channel(0, 0), &poles))
    }

    /// What `|1 / (1 + L)|` goes to at high frequencies, or comes back to again and again where one dead time passes at once what goes in.
    /// `None` where more of them do.
    pub(crate) fn fast_sensitivity(&self) -> Option<f64> {
        let d = &self.system.d;
        let m = self.times.len();
        if d.view((1, 1), (m, m)).iter().any(|d| *d != 0.0) {
            return None;
        }
        let mut through = (1..=m).map(|i| (d[(0, i)] * d[(i, 0)]).abs()).filter(|d| *d != 0.0);
        let first = through.next().unwrap_or(0.0);
        let nearest = (1.0 + d[(0, 0)]).abs() - first;
        (through.next().is_none() && nearest > 0.0).then(|| 1.0 / nearest)
    }

    /// Frequencies, rad/s, that show everything that the system does, rising; so close that the phase of the longest dead time can be
    /// followed, up to where these would be too many.
    ///
    /// # Errors
    /// [`LinearError`] of the eigenvalues.
    pub fn frequencies(&self) -> Result<Vec<f64>, LinearError> {
        let mut all = poles(&self.system.a)?;
        if let Some(without) = self.without() {
            all.extend(poles(&without.a)?);
        }
        if let Some(closed) = self.closed().and_then(|closed| closed.without()) {
            all.extend(poles(&closed.a)?);
        }
        all.extend(self.times.iter().map(|time| Complex::new(-1.0 / time, 0.0)));
        let longest = self.times.iter().copied().fold(0.0, f64::max);
        let mut grid = Vec::new();
        for pair in frequencies(&all, &[], None).windows(2) {
            let parts = ((pair[1] - pair[0]) * longest / TURN).ceil().max(1.0);
            if grid.len() as f64 + parts > MOST as f64 {
                break;
            }
            let between = |k: usize| pair[0] + (pair[1] - pair[0]) * k as f64 / parts;
            grid.extend((0..parts as usize).map(between));
        }
        Ok(grid)
    }

    /// How many poles grow, where none may stand still; as [`growing`](Self::growing).
    ///
    /// # Errors
    /// [`LinearError::Shape`] if a pole lies on the border of stability.
    pub fn unstable(&self) -> Result<Option<usize>, LinearError> {
        self.count(false)
    }

    /// How many poles grow. States and dead times that depend on each other in a circle are counted by themselves: an integrator behind
    /// a loop does not grow, whatever the loop does. `None` if infinitely many grow, or that cannot be decided.
    ///
    /// # Errors
    /// [`LinearError::Shape`] if a pole of a circle with dead times in it lies on the border of stability.
    pub fn growing(&self) -> Result<Option<usize>, LinearError> {
        self.count(true)
    }

    fn count(&self, may_stand: bool) -> Result<Option<usize>, LinearError> {
        let StateSpace { a, b, c, d, .. } = &self.system;
        let (n, m) = (a.nrows(), self.times.len());
        let joined = DMatrix::from_fn(n + m, n + m, |to, from| match (to < n, from < n) {
            (true, true) => a[(to, from)],
            (true, false) => b[(to, from - n + 1)],
            (false, true) => c[(to - n + 1, from)],
            (false, false) => d[(to - n + 1, from - n + 1)],
        });
        let mut growing = 0;
        for part in parts(&joined) {
            let (states, dead): (Vec<usize>, Vec<usize>) = part.into_iter().partition(|node| *node < n);
            let own = match dead.is_empty() {
                true => {
                    let own = poles(&a.select_rows(&states).select_columns(&states))?;
                    // On which side of the axis rounding has put a pole says nothing.
                    let stands = |pole: &&Complex<f64>| pole.re.abs() <= BORDER * pole.norm();
                    if !may_stand && own.iter().any(|pole| stands(&pole)) {
                        return Err(at_border());
                    }
                    Some(own.iter().filter(|pole| !stands(pole) && pole.re > 0.0).count())
                }
                false => {
                    let dead: Vec<usize> = dead.into_iter().map(|node| node - n).collect();
                    self.part(&states, &dead).turns()?
                }
            };
            let Some(own) = own else { return Ok(None) };
            growing += own;
        }
        Ok(Some(growing))
    }

    /// These states and dead times.
    fn part(&self, states: &[usize], dead: &[usize]) -> Delayed {
        let StateSpace { a, b, c, d, .. } = &self.system;
        let ports: Vec<usize> = std::iter::once(0).chain(dead.iter().map(|port| port + 1)).collect();
        Delayed {
            times: dead.iter().map(|&port| self.times[port]).collect(),
            system: StateSpace {
                a: a.select_rows(states).select_columns(states),
                b: b.select_rows(states).select_columns(&ports),
                c: c.select_rows(&ports).select_columns(states),
                d: d.select_rows(&ports).select_columns(&ports),
                period: None,
            },
        }
    }

    /// How many poles grow, by the argument of the characteristic function along the imaginary axis (A. V. Mikhailov's criterion): over all
    /// of it the function turns by pi for each of its n powers, less 2 pi for each root to the right. Where less comes back through the dead
    /// times than goes into them, the rest is that of the poles between them. `None` if infinitely many
    /// do, or that cannot be decided: signals pass dead times in a circle at once and hardly smaller, or the dead time lasts for
    /// too many periods of what they pass.
    ///
    /// # Errors
    /// [`LinearError::Shape`] if a root lies on the axis, so that the loop is at its border of stability.
    fn turns(&self) -> Result<Option<usize>, LinearError> {
        let StateSpace { a, b, c, d, .. } = &self.system;
        let (n, m) = (a.nrows(), self.times.len());
        let around = d.view((1, 1), (m, m)).into_owned();
        // A bound of what passes dead times in a circle, whatever their phases are.
        let neutral = poles(&around.abs())?.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
        if neutral >= 1.0 {
            return Ok(None);
        }
        if n == 0 {
            return Ok(Some(0));
        }
        let (a, scale) = balanced(a.clone());
        let b = DMatrix::from_fn(n, m, |i, j| b[(i, j + 1)] / scale[i]);
        let c = DMatrix::from_fn(m, n, |i, j| c[(i + 1, j)] * scale[j]);
        let d = around;
        let passing = |e: &[Complex<f64>]| {
            DMatrix::from_fn(m, m, |i, j| {
                Complex::new(f64::from(u8::from(i == j)), 0.0) - Complex::new(d[(i, j)], 0.0) * e[j]
            })
        };
        let ends = |w: f64| -> Vec<Complex<f64>> {
            self.times.iter().map(|time| (Complex::new(0.0, -w * time)).exp()).collect()
        };
        let size = a
            .norm()
            .max(b.norm() * c.norm() * (1.0 + d.norm()).powi(m as i32) / (1.0 - neutral))
            .max(f64::MIN_POSITIVE);
        // Of det(s I - A - B e (I - D e)^-1 C) det(I - D e) / (s + size)^n.
        let argument = |w: f64| -> Option<f64> {
            let s = Complex::new(0.0, w);
            let e = ends(w);
            let zero = Complex::new(0.0, 0.0);
            let passing = passing(&e);
            let lead = determinant(&passing);
            let back = solved(passing, c.map(|x| Complex::new(x, 0.0)))?;
            let joined = DMatrix::from_fn(n, n, |i, j| {
                let around = (0..m).map(|k| e[k] * back[(k, j)] * b[(i, k)]).sum::<Complex<f64>>();
                let own = Complex::new(-a[(i, j)], 0.0) - around;
                own + if i == j { s } else { zero }
            });
            let joined = joined.lu();
            let mut sum = lead.arg();
            let upper = joined.u();
            for i in 0..n {
                let factor = upper[(i, i)] / (s + size);
                if factor.norm() <= 1e-14 {
                    return None;
                }
                sum += factor.arg();
            }
            let sign: Complex<f64> = joined.p().determinant();
            Some(sum + sign.arg())
        };
        // What comes back through the dead times from what goes in.
        let around = |w: f64| -> Option<DMatrix<Complex<f64>>> {
            let s = Complex::new(0.0, w);
            let own = DMatrix::from_fn(n, n, |i, j| {
                Complex::new(-a[(i, j)], 0.0) + if i == j { s } else { Complex::new(0.0, 0.0) }
            });
            let complex = |m: &DMatrix<f64>| m.map(|x| Complex::new(x, 0.0));
            Some(complex(&c) * solved(own, complex(&b))? + complex(&d))
        };
        let own = poles(&a)?;
        let Some(end) = quiet(&own, size, neutral, &around)? else { return Ok(None) };
        let longest = self.times.iter().copied().fold(0.0, f64::max);
        let mut turned = 0.0;
        let (mut w, mut last) = (0.0, argument(0.0).ok_or_else(at_border)?);
        let mut step = 1e-6 * size;
        let mut count = 0;
        while w < end {
            count += 1;
            if count > MOST_STEPS {
                return Ok(None);
            }
            let mut next = (w + step.min(SURE / longest.max(f64::MIN_POSITIVE) * (1.0 + w / size))).min(end);
            let mut halvings = 0;
            let (change, there) = loop {
                let there = argument(next).ok_or_else(at_border)?;
                let change = wrapped(there - last);
                if change.abs() <= SURE {
                    break (change, there);
                }
                halvings += 1;
                if halvings > HALVINGS {
                    return Err(at_border());
                }
                next = w + (next - w) / 2.0;
            };
            turned += change;
            step = 1.5 * (next - w);
            (w, last) = (next, there);
        }
        // From far to the right to here what comes back is smaller than what goes in, so that 1 less each of its eigenvalues stays to
        // the right of zero; and each pole of its own is seen at an angle that is told by where it lies.
        let e = ends(w);
        let mut rest = -(n as f64) * w.atan2(size);
        rest += own.iter().map(|pole| PI / 2.0 + pole.re.atan2(w - pole.im)).sum::<f64>();
        if let Some(around) = around(w).filter(|_| w > 0.0) {
            let back = DMatrix::from_fn(m, m, |i, j| e[i] * around[(i, j)]);
            let (_, triangle) = nalgebra::Schur::new(back).unpack();
            rest +=
                triangle.diagonal().iter().map(|share| (Complex::new(1.0, 0.0) - share).arg()).sum::<f64>();
        }
        rest += wrapped(last - rest);
        let count = (rest - turned) / PI;
        Ok(Some(count.round().max(0.0) as usize))
    }
}

/// A frequency, rad/s, from which on less comes back through dead times than goes into them, whatever their phases are: above it they move
/// no pole to the other side (small gain). `None` where they are never so quiet.
///
/// `own` are the poles between them, `size` a bound of the frequencies at which anything happens, `neutral` what comes back at once,
/// `around` all that does.
fn quiet(
    own: &[Complex<f64>],
    size: f64,
    neutral: f64,
    around: &dyn Fn(f64) -> Option<DMatrix<Complex<f64>>>,
) -> Result<Option<f64>, LinearError> {
    let most = 1.0 - QUIET * (1.0 - neutral);
    let (top, decades) = (1e4 * size, 20.0);
    let even = (0..=(decades * EVEN) as usize).map(|k| top * 10_f64.powf(-(k as f64) / EVEN));
    let mut grid: Vec<f64> =
        even.chain(frequencies(own, &[], None).into_iter().filter(|w| *w < top)).collect();
    grid.sort_by(|one, other| other.total_cmp(one));
    let mut end = None;
    for w in grid {
        let is_quiet = match around(w) {
            Some(around) => {
                let shares = poles(&around.map(|x| x.norm()))?;
                shares.iter().all(|share| share.norm() < most)
            }
            None => false,
        };
        if !is_quiet {
            break;
        }
        end = Some(w);
    }
    Ok(end)
}

fn at_border() -> LinearError {
    LinearError::Shape("a pole lies on the border of stability".to_owned())
}

/// An angle within -pi and pi.
fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(2.0 * PI) - PI
}

fn determinant(m: &DMatrix<Complex<f64>>) -> Complex<f64> {
    if m.is_empty() { Complex::new(1.0, 0.0) } else { m.clone().lu().determinant() }
}

/// The solution of linear equations, if there is one; of no equations nothing.
fn solved(m: DMatrix<Complex<f64>>, right: DMatrix<Complex<f64>>) -> Option<DMatrix<Complex<f64>>> {
    if m.is_empty() { Some(right) } else { m.lu().solve(&right) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{bandwidth_delayed, margins_delayed};

    /// States, then from (u, w...) to (y, v...).
    fn system(a: &[f64], b: &[f64], c: &[f64], d: &[f64]) -> StateSpace {
        let n = a.len().isqrt();
        let m = d.len().isqrt();
        let matrix = DMatrix::from_row_slice;
        StateSpace::new(matrix(n, n, a), matrix(n, m, b), matrix(m, n, c), matrix(m, m, d), None).unwrap()
    }

    /// y = k exp(-s T) / (tau s + 1) u.
    fn lag(k: f64, tau: f64, time: f64) -> Delayed {
        let around = system(&[-1.0 / tau], &[k / tau, 0.0], &[0.0, 1.0], &[0.0, 1.0, 0.0, 0.0]);
        Delayed::new(&around, 0, &[time])
    }

    /// x' = u - k x(t - T), y = x.
    fn circle(k: f64, time: f64) -> Delayed {
        Delayed::new(&system(&[0.0], &[1.0, -k], &[1.0, 1.0], &[0.0; 4]), 0, &[time])
    }

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-9 * b.abs().max(1e-3), "{a} is not {b}");
    }

    #[test]
    fn a_dead_time_behind_a_lag_has_the_response_and_the_margins_of_the_formula() {
        let (k, tau, time) = (3.0, 2.0, 0.7);
        let way = lag(k, tau, time);
        assert!(!way.is_circular() && way.order() == 1 && way.times() == [time]);
        near(way.poles().unwrap().unwrap()[0].re, -1.0 / tau);
        for w in [0.01, 0.3, 2.0, 50.0, 1e4] {
            let exact = k * Complex::from_polar(1.0, -w * time) / Complex::new(1.0, w * tau);
            assert!((way.at(w) - exact).norm() < 1e-12 * exact.norm(), "at {w}");
        }
        let found = margins_delayed(&way).unwrap();
        // atan(w tau) + w T = pi.
        let (mut low, mut high) = (0.5, 10.0);
        for _ in 0..100 {
            let middle = (low + high) / 2.0;
            if f64::atan(middle * tau) + middle * time < PI { low = middle } else { high = middle }
        }
        let gain = found.least_gain().unwrap();
        near(gain.frequency, low);
        near(gain.value, (low * tau).hypot(1.0) / k);
        let crossover = (k * k - 1.0).sqrt() / tau;
        let phase = found.least_phase().unwrap();
        near(phase.frequency, crossover);
        near(phase.value, PI - (crossover * tau).atan() - crossover * time);
        near(found.delay.unwrap().value, phase.value / crossover);
        assert!(found.stable && found.growing == Some(0) && found.closed.is_empty());
        // Beyond the margin, by a hair.
        let more = margins_delayed(&lag(k * gain.value * 1.0001, tau, time)).unwrap();
        assert_eq!((more.growing, more.stable, more.delay), (Some(2), false, None));
        assert!(margins_delayed(&lag(k * gain.value * 0.9999, tau, time)).unwrap().stable);
        near(bandwidth_delayed(&way).unwrap().unwrap(), 1.0 / tau);
        assert_eq!(way.static_gain().unwrap(), Gain::Finite(k));
    }

    #[test]
    fn an_integrator_around_a_dead_time_is_stable_up_to_half_of_pi_and_loses_two_poles_with_each_turn() {
        for (product, growing) in [(0.1, 0), (1.57, 0), (1.572, 2), (7.8, 2), (7.9, 4), (14.2, 6)] {
            for time in [1e-3, 1.0, 40.0] {
                let way = circle(product / time, time);
                assert!(way.is_circular() && way.poles().unwrap().is_none());
                assert_eq!(way.unstable().unwrap(), Some(growing), "{product} {time}");
            }
        }
        let way = circle(0.5, 1.0);
        let s = Complex::new(0.0, 0.8);
        let exact: Complex<f64> = (s + (-s).exp() * 0.5).inv();
        assert!((way.at(0.8) - exact).norm() < 1e-14);
        assert_eq!(way.static_gain().unwrap(), Gain::Finite(2.0));
        let integrates =
            Delayed::new(&system(&[0.0], &[1.0, 0.0], &[0.0, 1.0], &[0.0, 1.0, 0.0, 0.0]), 0, &[1.0]);
        assert_eq!(integrates.static_gain().unwrap(), Gain::Infinite);
    }

    #[test]
    fn what_passes_dead_times_at_once_is_stable_below_a_gain_of_one_and_undecided_beyond() {
        let pure = |k: f64| {
            let around = StateSpace {
                a: DMatrix::zeros(0, 0),
                b: DMatrix::zeros(0, 2),
                c: DMatrix::zeros(2, 0),
                d: DMatrix::from_row_slice(2, 2, &[0.0, 1.0, k, 0.0]),
                period: None,
            };
            Delayed::new(&around, 0, &[0.3])
        };
        for (k, growing) in [(0.9, Some(0)), (-0.9, Some(0)), (1.1, None)] {
            let found = margins_delayed(&pure(k)).unwrap();
            assert_eq!((found.growing, found.stable), (growing, growing.is_some()), "{k}");
        }
        // A lag beside it: y = 0.5 exp(-s T) y + ..., with a pole of its own that grows.
        let grows = system(&[2.0], &[1.0, 0.0], &[1.0, 1.0], &[0.0, 1.0, 0.0, 0.5]);
        assert_eq!(Delayed::new(&grows, 0, &[0.3]).unstable().unwrap(), Some(1));
    }

    #[test]
    fn a_dead_time_may_be_as_much_longer_than_a_lag_as_it_likes() {
        // x' = u - k v(t - T), lag v' = x - v: the limits are those of the integrator alone, but for the lag.
        for (tau, time) in [(1e-3, 20.0), (1e-9, 1.0), (1e-6, 1e5)] {
            for (product, growing) in [(0.1, 0), (1.55, 0), (1.59, 2), (7.9, 4)] {
                let k = product / time;
                let a = [0.0, 0.0, 1.0 / tau, -1.0 / tau];
                let all = system(&a, &[1.0, -k, 0.0, 0.0], &[0.0, 1.0, 0.0, 1.0], &[0.0; 4]);
                let way = Delayed::new(&all, 0, &[time]);
                assert_eq!(way.unstable().unwrap(), Some(growing), "{tau} {time} {product}");
            }
        }
        // k (s + 3) / (s + 1) exp(-0.7 s) in a loop: at a phase of an odd multiple of pi, atan(w/3) - atan(w) - 0.7 w, the gain is
        // k sqrt(w^2 + 9) / sqrt(w^2 + 1).
        let phase = |w: f64| (w / 3.0).atan() - w.atan() - 0.7 * w;
        let limit = |turns: f64| {
            let (mut low, mut high) = (0.0, 100.0);
            for _ in 0..100 {
                let middle = (low + high) / 2.0;
                if phase(middle) > -turns * PI { low = middle } else { high = middle }
            }
            (low.mul_add(low, 1.0) / low.mul_add(low, 9.0)).sqrt()
        };
        for (turns, growing) in [(1.0, 0), (3.0, 2), (5.0, 4)] {
            for (share, more) in [(0.999, 0), (1.001, 2)] {
                let k = share * limit(turns);
                let around = system(&[-1.0], &[2.0 * k, -2.0 * k], &[1.0, 1.0], &[k, -k, k, -k]);
                let found = Delayed::new(&around, 0, &[0.7]).unstable().unwrap();
                assert_eq!(found, Some(growing + more), "{turns} {share}");
            }
        }
    }

    #[test]
    fn two_dead_times_in_a_row_are_their_sum_and_those_that_lead_nowhere_are_left_away() {
        // u -> 0.2 s -> lag -> 0.5 s -> y; a third one looks at the lag alone.
        let a = [-1.0];
        let b = [0.0, 1.0, 0.0, 0.0];
        let c = [0.0, 0.0, 1.0, 1.0];
        let mut d = [0.0; 16];
        (d[2], d[4]) = (1.0, 1.0);
        let all = system(&a, &b, &c, &d);
        let way = Delayed::new(&all, 0, &[0.2, 0.5, 9.0]);
        assert_eq!(way.times(), [0.2, 0.5]);
        for w in [0.1, 3.0, 40.0] {
            let exact = Complex::from_polar(1.0, -0.7 * w) / Complex::new(1.0, w);
            assert!((way.at(w) - exact).norm() < 1e-13, "at {w}");
        }
        assert_eq!(Delayed::whole(&all, &[0.2, 0.5, 9.0]).unstable().unwrap(), Some(0));
        assert_eq!(lag(1.0, 1.0, 1.0).unstable().unwrap(), Some(0));
    }

    #[test]
    fn a_pole_on_the_border_is_no_number_of_growing_ones() {
        let border = system(&[0.0], &[1.0, 0.0], &[0.0, 1.0], &[0.0, 1.0, 0.0, 0.0]);
        // An integrator behind it changes nothing, and one that is unstable by itself counts.
        for (own, growing) in [(0.0, 0), (-2.0, 0), (3.0, 1)] {
            let all =
                system(&[-2.0, 0.0, 1.0, own], &[0.0, -2.0, 0.0, 0.0], &[0.0, 0.0, 1.0, 0.0], &[0.0; 4]);
            let all = Delayed::whole(&all, &[0.1]);
            assert_eq!(all.growing().unwrap(), Some(growing), "{own}");
            assert_eq!(all.unstable().is_err(), own == 0.0, "{own}");
        }
        // An oscillator without damping that reads the loop, in coordinates in which rounding gives it some: neither grows.
        for turn in [0.3_f64, 1.1, 2.7] {
            let (s, c) = turn.sin_cos();
            let own = [3.0 * s * c, -(2.0 * c * c + 5.0 * s * s), 2.0 * s * s + 5.0 * c * c, -3.0 * s * c];
            let a = [-2.0, 0.0, 0.0, 1.0, own[0], own[1], 0.0, own[2], own[3]];
            let all =
                system(&a, &[0.0, -2.0, 0.0, 0.0, 0.0, 0.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0], &[0.0; 4]);
            let all = Delayed::whole(&all, &[0.1]);
            assert_eq!(all.growing().unwrap(), Some(0), "{turn}");
            assert!(all.unstable().is_err(), "{turn}");
        }
        let told = Delayed::new(&border, 0, &[1.0]).unstable().unwrap_err();
        assert_eq!(told.to_string(), "a pole lies on the border of stability");
    }

    #[test]
    fn frequencies_follow_the_phase_of_the_longest_dead_time() {
        let grid = lag(1.0, 1e-2, 5.0).frequencies().unwrap();
        assert!(grid.len() <= MOST && grid.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(grid.windows(2).all(|pair| (pair[1] - pair[0]) * 5.0 <= TURN * 1.0001));
    }
}
