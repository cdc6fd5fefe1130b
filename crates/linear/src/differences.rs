//! Derivatives of a function by central differences.
//!
//! No step suits all entries: a long one errs by the curvature of the function, a short one by rounding. So each entry is
//! computed with steps that shorten by a factor, and the one is kept that differs least from its neighbour, once
//! extrapolated after Richardson. The same comparison tells the accuracy (C. Ridders, Accurate computation of F'(x) and
//! F'(x) F''(x), Advances in Engineering Software 4 (1982) 75; here without the higher columns of his tableau, which
//! noise would spoil). Steps that agree with each other and lead to where another law holds are told from these by shorter ones,
//! which agree with each other on something else: an integral that is frozen beyond a limit does not move on either side of it.

use nalgebra::DMatrix;

/// Longest step, relative to the size of the argument or to 1, whichever is larger.
const LONGEST: f64 = 0.1;
/// Factor between a step and the next shorter one.
const FACTOR: f64 = 8.0;
/// Number of steps; the shortest is about 1e-10.
const STEPS: usize = 11;
/// How many more there are, each by how much shorter, where the shortest one shows something else than the others: down to 1e-16, as
/// charges, volumes and fluxes are small in SI units, and limits may be near.
const MORE: usize = 12;
const CLOSER: f64 = 3.0;
/// Successive steps whose slopes are the same within this part of how far a slope of longer steps is from them know better.
const KNOW: usize = 4;
const BETTER: f64 = 1.0 / 30.0;
/// Slopes to both sides that differ by more than this part are of a kink.
const KINK: f64 = 1e-2;

/// Derivatives of several functions by several arguments.
#[derive(Debug, Clone, PartialEq)]
pub struct Jacobian {
    /// Row by row the derivatives of one function, one for each argument.
    pub value: DMatrix<f64>,
    /// How far each may be off; as rounding and the functions allow, not a bound.
    pub error: DMatrix<f64>,
    /// Where the slopes to both sides of the point differ. The derivative is then the mean of both.
    pub kinks: Vec<Kink>,
}

/// A function that is not smooth at the point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kink {
    /// Which function.
    pub row: usize,
    /// By which argument.
    pub column: usize,
    /// Slope towards smaller arguments.
    pub left: f64,
    /// Slope towards larger arguments.
    pub right: f64,
}

impl Jacobian {
    /// The maximum error relative to the largest entry of the same row; 0 where there are no entries.
    pub fn accuracy(&self) -> f64 {
        let rows = self.value.row_iter().zip(self.error.row_iter());
        rows.map(|(value, error)| match value.amax() {
            largest if largest > 0.0 => error.amax() / largest,
            _ => 0.0,
        })
        .fold(0.0, f64::max)
    }
}

/// The derivatives at `point` of `f`, which writes `rows` values for an argument. Where a function fails or is not
/// finite for a long step, shorter ones are used. Entries that cannot be told from zero are zero.
///
/// # Errors
/// That of `f` at the point, or for the shortest step.
pub fn jacobian<E>(
    point: &[f64],
    rows: usize,
    f: impl FnMut(&[f64], &mut [f64]) -> Result<(), E>,
) -> Result<Jacobian, E> {
    jacobian_over(point, 0..point.len(), rows, f)
}

/// As [`jacobian`], by these arguments alone; the columns of the others are zero.
///
/// # Errors
/// That of `f` at the point, or for the shortest step.
pub fn jacobian_over<E>(
    point: &[f64],
    columns: impl IntoIterator<Item = usize>,
    rows: usize,
    mut f: impl FnMut(&[f64], &mut [f64]) -> Result<(), E>,
) -> Result<Jacobian, E> {
    let mut x = point.to_vec();
    let mut middle = vec![0.0; rows];
    f(&x, &mut middle)?;
    let mut jacobian = Jacobian {
        value: DMatrix::zeros(rows, point.len()),
        error: DMatrix::zeros(rows, point.len()),
        kinks: Vec::new(),
    };
    let mut sides = vec![Side::new(rows); STEPS + MORE];
    for column in columns {
        let mut taken = STEPS;
        for level in 0..STEPS + MORE {
            if level == STEPS && !(0..rows).any(|row| is_unclear(&sides[..STEPS], row, middle[row])) {
                break;
            }
            let side = &mut sides[level];
            let (above, below) = side.go(point[column], level);
            let mut side_at = |at: f64, values: &mut [f64]| {
                x[column] = at;
                f(&x, values)
            };
            let done = side_at(above, &mut side.above).and_then(|()| side_at(below, &mut side.below));
            match done {
                Ok(()) => taken = taken.max(level + 1),
                Err(error) if level + 1 == STEPS => return Err(error),
                Err(_) if level < STEPS => side.above.fill(f64::NAN),
                Err(_) => break,
            }
        }
        x[column] = point[column];
        let sides = &sides[..taken];
        for (row, &middle) in middle.iter().enumerate() {
            let (value, error) = best(sides, row, middle);
            let entry = (row, column);
            jacobian.error[entry] = error;
            jacobian.value[entry] = if value.abs() <= error { 0.0 } else { value };
            if let Some((left, right)) = kink(sides, row, middle) {
                jacobian.kinks.push(Kink { row, column, left, right });
            }
        }
    }
    Ok(jacobian)
}

/// As [`jacobian`], for many functions each of which depends on few arguments: arguments that no function has in common are
/// varied together (A. R. Curtis, M. J. D. Powell, J. K. Reid: On the estimation of sparse Jacobian matrices, IMA J. Appl. Math.
/// 13 (1974) 117). Which those are is seen where one argument after the other is moved by a large step upwards and by a small one downwards.
///
/// # Errors
/// That of `f` at the point, or for the shortest step.
pub fn sparse_jacobian<E>(
    point: &[f64],
    rows: usize,
    mut f: impl FnMut(&[f64], &mut [f64]) -> Result<(), E>,
) -> Result<Jacobian, E> {
    let mut x = point.to_vec();
    let mut middle = vec![0.0; rows];
    f(&x, &mut middle)?;
    let size = |column: usize| point[column].abs().max(1.0);
    let acts = (0..point.len()).map(|column| {
        let mut acts = vec![false; rows];
        let mut there = vec![0.0; rows];
        for share in PROBES {
            x[column] = point[column] + share * size(column);
            // Where there is no value, nothing is known of any function.
            let done = f(&x, &mut there).is_ok();
            let moved = there.iter().zip(&middle).map(|(there, middle)| !done || there != middle);
            acts.iter_mut().zip(moved).for_each(|(acts, moved)| *acts |= moved);
        }
        x[column] = point[column];
        (0..rows).filter(|&row| acts[row]).collect()
    });
    let acts: Vec<Vec<usize>> = acts.collect();
    let mut jacobian = Jacobian {
        value: DMatrix::zeros(rows, point.len()),
        error: DMatrix::zeros(rows, point.len()),
        kinks: Vec::new(),
    };
    let mut sides = vec![Side::new(rows); STEPS + MORE];
    for group in apart(&acts, rows) {
        let mut taken = STEPS;
        for level in 0..STEPS + MORE {
            let unclear = |column: &usize| {
                let mut sides = sides[..STEPS].to_vec();
                sides.iter_mut().enumerate().for_each(|(level, side)| _ = side.go(point[*column], level));
                acts[*column].iter().any(|&row| is_unclear(&sides, row, middle[row]))
            };
            if level == STEPS && !group.iter().any(unclear) {
                break;
            }
            let side = &mut sides[level];
            group.iter().for_each(|&column| x[column] = step(point[column], level).0);
            let done = f(&x, &mut side.above).and_then(|()| {
                group.iter().for_each(|&column| x[column] = step(point[column], level).1);
                f(&x, &mut side.below)
            });
            match done {
                Ok(()) => taken = taken.max(level + 1),
                Err(error) if level + 1 == STEPS => return Err(error),
                Err(_) if level < STEPS => side.above.fill(f64::NAN),
                Err(_) => break,
            }
        }
        let sides = &mut sides[..taken];
        for &column in &group {
            x[column] = point[column];
            sides.iter_mut().enumerate().for_each(|(level, side)| _ = side.go(point[column], level));
            for &row in &acts[column] {
                let (value, error) = best(sides, row, middle[row]);
                let entry = (row, column);
                jacobian.error[entry] = error;
                jacobian.value[entry] = if value.abs() <= error { 0.0 } else { value };
                if let Some((left, right)) = kink(sides, row, middle[row]) {
                    jacobian.kinks.push(Kink { row, column, left, right });
                }
            }
        }
    }
    Ok(jacobian)
}

/// Steps, as parts of the size of an argument, by which it is moved to see on what it acts: to both sides, as some act on one alone.
const PROBES: [f64; 2] = [LONGEST, -1e-6];

/// Sets of columns no two of which act on the same row.
fn apart(acts: &[Vec<usize>], rows: usize) -> Vec<Vec<usize>> {
    let mut groups: Vec<(Vec<usize>, Vec<bool>)> = Vec::new();
    for (column, own) in acts.iter().enumerate().filter(|(_, own)| !own.is_empty()) {
        let free = groups.iter().position(|(_, taken)| own.iter().all(|&row| !taken[row]));
        let at = free.unwrap_or_else(|| {
            groups.push((Vec::new(), vec![false; rows]));
            groups.len() - 1
        });
        groups[at].0.push(column);
        own.iter().for_each(|&row| groups[at].1[row] = true);
    }
    groups.into_iter().map(|(columns, _)| columns).collect()
}

/// The values of all functions a step beside the point.
#[derive(Clone)]
struct Side {
    /// Steps upwards and downwards.
    h: (f64, f64),
    above: Vec<f64>,
    below: Vec<f64>,
}

impl Side {
    fn new(rows: usize) -> Side {
        Side { h: (0.0, 0.0), above: vec![0.0; rows], below: vec![0.0; rows] }
    }

    /// Takes note of a step and gives both places to which it leads.
    fn go(&mut self, at: f64, level: usize) -> (f64, f64) {
        let (above, below) = step(at, level);
        // The step as it is after rounding.
        self.h = (above - at, at - below);
        (above, below)
    }

    fn slope(&self, row: usize) -> f64 {
        (self.above[row] - self.below[row]) / (self.h.0 + self.h.1)
    }

    /// What rounding of the values may do to the slope.
    fn rounding(&self, row: usize, middle: f64) -> f64 {
        let size = self.above[row].abs().max(self.below[row].abs()).max(middle.abs());
        8.0 * f64::EPSILON * size / (self.h.0 + self.h.1)
    }
}

/// Both places to which a step from an argument leads.
fn step(at: f64, level: usize) -> (f64, f64) {
    let more = (level + 1).saturating_sub(STEPS) as i32;
    let step = LONGEST * at.abs().max(1.0) / FACTOR.powi(level.min(STEPS - 1) as i32) / CLOSER.powi(more);
    (at + step, at - step)
}

/// Whether the shortest step shows something else than what is taken for the derivative, which is not its rounding.
fn is_unclear(sides: &[Side], row: usize, middle: f64) -> bool {
    let (value, _) = best(sides, row, middle);
    let Some(last) = sides.last() else { return false };
    let slope = last.slope(row);
    let apart = (slope - value).abs();
    !apart.is_finite()
        || apart > KINK * slope.abs().max(value.abs()) && BETTER * apart > last.rounding(row, middle)
}

/// The derivative of a row and its error.
fn best(sides: &[Side], row: usize, middle: f64) -> (f64, f64) {
    // What never changes does not depend on the argument, and there is no rounding of it.
    if sides.iter().all(|side| side.above[row] == middle && side.below[row] == middle) {
        return (0.0, 0.0);
    }
    let square = FACTOR * FACTOR;
    let pairs = sides.windows(2).enumerate().map(|(level, pair)| {
        let (long, short) = (pair[0].slope(row), pair[1].slope(row));
        let error = (long - short).abs().max(pair[1].rounding(row, middle));
        ((square * short - long) / (square - 1.0), error, level)
    });
    let usable = pairs.filter(|(value, error, _)| value.is_finite() && error.is_finite());
    // Noise grows as steps shorten, so that it does not look like agreement.
    let is_elsewhere = |value: f64, error: f64, level: usize| {
        sides[level + 1..].windows(KNOW).any(|near| {
            let slopes = || near.iter().map(|side| side.slope(row));
            let (least, most) = slopes().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), slope| {
                (least.min(slope), most.max(slope))
            });
            let rounding = near[KNOW - 1].rounding(row, middle);
            let apart = (least - value).max(value - most);
            slopes().all(f64::is_finite) && BETTER * apart > (most - least).max(rounding).max(error)
        })
    };
    let here = usable.filter(|(value, error, level)| !is_elsewhere(*value, *error, *level));
    let (value, error, _) = here.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((f64::NAN, f64::NAN, 0));
    (value, error)
}

/// The slopes to both sides, if they do not approach each other as the step shortens.
fn kink(sides: &[Side], row: usize, middle: f64) -> Option<(f64, f64)> {
    let slopes = |side: &Side| ((middle - side.below[row]) / side.h.1, (side.above[row] - middle) / side.h.0);
    let size = |(left, right): (f64, f64)| left.abs().max(right.abs());
    let steepest = sides.iter().map(|side| size(slopes(side))).filter(|x| x.is_finite()).fold(0.0, f64::max);
    // The shortest step whose slopes are not lost in rounding.
    let side = sides.iter().rev().find(|side| side.rounding(row, middle) < 0.1 * KINK * steepest)?;
    // What bends has slopes that come together with the step; a step eight times as long tells it from a kink.
    let longer = sides.iter().rev().find(|other| other.h.0 > 4.0 * side.h.0)?;
    let gap = |(left, right): (f64, f64)| (left - right).abs();
    let here = slopes(side);
    let differ = gap(here) > KINK * size(here) && gap(here) > 10.0 * side.rounding(row, middle);
    // Noise that is more than the rounding of the values changes with the step; the slopes of a kink stay.
    let there = slopes(longer);
    let stay = (here.0 - there.0).abs().max((here.1 - there.1).abs()) < 0.25 * gap(here);
    (differ && stay && gap(there) < 2.0 * gap(here)).then_some(here)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn of(point: &[f64], f: impl Fn(&[f64], &mut [f64])) -> Jacobian {
        let result: Result<Jacobian, Infallible> = jacobian(point, 2, |x, y| {
            f(x, y);
            Ok(())
        });
        result.unwrap()
    }

    #[test]
    fn smooth_functions_have_derivatives_to_ten_digits_and_the_error_is_told() {
        let at = [0.7_f64, -2.0];
        let found = of(&at, |x, y| {
            y[0] = x[0].sin() * x[1].exp();
            y[1] = 1e5 + x[0] * x[0] * x[1];
        });
        let (s, c, e) = (at[0].sin(), at[0].cos(), at[1].exp());
        let exact = DMatrix::from_row_slice(2, 2, &[c * e, s * e, 2.0 * at[0] * at[1], at[0] * at[0]]);
        for (entry, expected) in exact.iter().enumerate() {
            let (value, error) = (found.value[entry], found.error[entry]);
            assert!((value - expected).abs() <= 10.0 * error, "{value} +- {error} is not {expected}");
            assert!((value / expected - 1.0).abs() < 1e-7, "{value} is not {expected}");
        }
        assert!(found.kinks.is_empty() && found.accuracy() < 1e-6);
    }

    #[test]
    fn steep_and_flat_places_of_one_function_are_found_at_their_own_steps() {
        // As the smoothed friction of bearings: slope 1e4 within 1e-4, flat beyond it.
        let steep = of(&[0.0, 1.0], |x, y| {
            y[0] = (1e4 * x[0]).tanh();
            y[1] = (1e4 * x[1]).tanh();
        });
        assert!((steep.value[(0, 0)] / 1e4 - 1.0).abs() < 1e-6, "{}", steep.value);
        assert_eq!(steep.value[(1, 1)], 0.0);
    }

    #[test]
    fn what_is_frozen_beyond_a_limit_has_the_slope_within_it() {
        for limit in [1e-2, 1e-4, 1e-6] {
            let frozen = of(&[0.3, -2.0], |x, y| {
                let error = x[0] - 0.3 + limit / 3.0;
                y[0] = x[1] + if error.abs() < limit { -1.8 * error } else { 0.0 };
                // Far away another slope holds.
                y[1] = if error.abs() < limit { 5.0 * x[0] } else { 7.0 * (x[0] - 0.3) + 1.5 };
            });
            let expected = [-1.8, 5.0, 1.0, 0.0];
            for (found, expected) in frozen.value.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-6, "{limit}: {}", frozen.value);
            }
            assert!(frozen.error.iter().all(|error| *error < 1e-5), "{limit}: {}", frozen.error);
        }
    }

    #[test]
    fn small_states_and_near_limits_have_their_own_slopes() {
        for scale in [1e-6_f64, 1e-9, 1e-11] {
            // Near one, rounding is in the way of what is nearer than that.
            let near = scale.max(1e-10);
            let found = of(&[scale, 1.0 - 0.3 * near], |x, y| {
                // A saturating coil, a junction, and limits.
                y[0] = (x[0] / scale).tanh() + 1e-3 * x[0] / scale + 2.0 * x[1].min(1.0);
                y[1] = (x[0] / scale).ln().max(-1e3) + 5.0 * x[1].clamp(1.0 - near, 1.0);
            });
            let slope = (1.0 - 1.0_f64.tanh().powi(2) + 1e-3) / scale;
            for (found, expected) in found.value.iter().zip([slope, 1.0 / scale, 2.0, 5.0]) {
                assert!((found / expected - 1.0).abs() < 0.03, "{scale}: {found}, not {expected}");
            }
            assert!(found.kinks.is_empty(), "{scale}: {:?}", found.kinks);
        }
    }

    #[test]
    fn a_kink_is_told_with_both_slopes_and_none_where_it_is_a_step_away() {
        let abs = |x: &[f64], y: &mut [f64]| {
            y[0] = 3.0 * x[0].abs() + x[0];
            y[1] = x[1].max(0.0);
        };
        let at = of(&[0.0, 0.0], abs);
        assert_eq!(at.kinks.len(), 2);
        let Kink { row, column, left, right } = at.kinks[0];
        assert!((row, column) == (0, 0) && (left + 2.0).abs() < 1e-6 && (right - 4.0).abs() < 1e-6);
        assert!((at.value[(0, 0)] - 1.0).abs() < 1e-9, "the mean of both");
        let beside = of(&[1e-3, -1e-6], abs);
        assert!(beside.kinks.is_empty(), "{:?}", beside.kinks);
        assert!((beside.value[(0, 0)] - 4.0).abs() < 1e-8 && beside.value[(1, 1)] == 0.0);
    }

    #[test]
    fn what_cancels_but_for_rounding_is_no_kink() {
        for k in 0..300 {
            let at = 0.37 + f64::from(k) / 300.0;
            let found = of(&[at, 1.0], |x, y| {
                y[0] = ((x[0] + 1e3) - 1e3) - x[0];
                y[1] = ((7.0 * x[0] + 1e5) - 1e5) - 7.0 * x[0] + x[1].max(1.0);
            });
            let kinks: Vec<(usize, usize)> = found.kinks.iter().map(|kink| (kink.row, kink.column)).collect();
            assert_eq!(kinks, [(1, 1)], "{at}");
        }
    }

    #[test]
    fn functions_of_few_arguments_have_the_same_derivatives_when_these_are_varied_together() {
        let n = 30;
        let mut evaluations = 0;
        let chain = |x: &[f64], y: &mut [f64]| {
            for i in 0..n {
                let (left, right) = (x[i.max(1) - 1], x[(i + 1).min(n - 1)]);
                y[i] = (left - x[i]).sin() + x[i] * right;
                y[i] += match i {
                    7 => x[20].abs(),
                    9 => x[20].min(0.0),
                    12 => x[20].max(0.0),
                    _ => 0.0,
                };
            }
        };
        let point: Vec<f64> = (0..n).map(|i| if i == 20 { 0.0 } else { (i as f64).cos() }).collect();
        let sparse: Result<Jacobian, Infallible> = sparse_jacobian(&point, n, |x, y| {
            evaluations += 1;
            chain(x, y);
            Ok(())
        });
        let dense: Result<Jacobian, Infallible> = jacobian(&point, n, |x, y| {
            chain(x, y);
            Ok(())
        });
        let (sparse, dense) = (sparse.unwrap(), dense.unwrap());
        assert_eq!((sparse.value, &sparse.kinks), (dense.value, &dense.kinks));
        assert_eq!(sparse.kinks.len(), 3);
        assert!(evaluations < 1 + 2 * n + 22 * 6, "{evaluations}");
    }

    #[test]
    fn long_steps_that_fail_are_done_without() {
        let root = |x: &[f64], y: &mut [f64]| match x[0] >= 0.0 {
            true => {
                y[0] = x[0].sqrt();
                Ok(())
            }
            false => Err("a negative number"),
        };
        let found = jacobian(&[1e-4], 1, root).unwrap();
        assert!((found.value[0] - 50.0).abs() < 1e-5, "{}", found.value);
        assert_eq!(jacobian(&[0.0], 1, root), Err("a negative number"));
    }
}
