//! All sample times on one integer clock.

use blocksim_block::Interface;
use blocksim_block::problem::Problem;
use blocksim_block::schedule::{Clock, Rate};
use blocksim_signal::SampleTime;

use crate::flatten::{Flat, FlatBlock};
use crate::infer::Typed;
use crate::problems::Problems;

/// Puts all sample times on one integer clock.
pub(super) fn clock(flat: &Flat, typed: &Typed, problems: &mut Problems) -> Clock {
    let mut times: Vec<(f64, f64, usize)> = Vec::new();
    for (index, interface) in typed.interfaces.iter().enumerate() {
        if let Some(SampleTime::Discrete { period, offset }) = interface.sample_time {
            times.push((period, offset, index));
        }
    }
    for (period, offset, index) in &times {
        let ok = period.is_finite() && *period > 0.0 && offset.is_finite() && *offset >= 0.0;
        if !ok {
            problems.push(located(
                &flat.blocks[*index],
                Problem::error("sample_time", format!("a sample time of {period} s cannot be kept"))
                    .help("sample times are positive"),
            ));
            return Clock::default();
        }
    }
    if times.is_empty() {
        return Clock::default();
    }
    let all = || times.iter().flat_map(|(period, offset, _)| [*period, *offset]).filter(|time| *time > 0.0);
    let longest = all().fold(0.0, f64::max);
    let can_count = |tick: &f64| longest / tick <= MOST_TICKS;
    // What is written with many digits, 0.333333333333 s, may be meant to be a simple fraction.
    let tick = [WRITTEN, MEANT].into_iter().find_map(|rounding| common(all(), rounding).filter(can_count));
    let Some(tick) = tick else {
        problems.push(located(
            &flat.blocks[times[0].2],
            Problem::error("sample_time", "the sample times have no common clock")
                .help("choose sample times that are multiples of a common time, such as 1 ms and 5 ms"),
        ));
        return Clock::default();
    };
    let mut rates: Vec<Rate> = times
        .iter()
        .map(|(period, offset, _)| Rate {
            period: (period / tick).round() as u64,
            offset: (offset / tick).round() as u64,
        })
        .collect();
    rates.sort_by_key(|rate| (rate.period, rate.offset));
    rates.dedup();
    Clock { tick, rates }
}

/// Most ticks in a sample time.
const MOST_TICKS: f64 = 1e9;
/// By what part of it a time that is written may differ from the fraction that it is: by rounding; and where it is a fraction that is meant.
const WRITTEN: f64 = 4.0 * f64::EPSILON;
const MEANT: f64 = 1e-11;
/// Digits of a decimal number, as a power of ten, and the largest numbers in another fraction, and in one that is meant.
const DIGITS: f64 = 1e9;
const LARGEST: f64 = 1e15;
const SIMPLE: f64 = 1e5;

/// A positive fraction in lowest terms.
type Fraction = (u128, u128);

/// The greatest time of which all these are multiples, `gcd(p) / lcm(q)` of the fractions `p / q` that they are; nothing where one is no fraction
/// of numbers that can be handled. Differences of the times themselves would leave rounding of long ones in a short tick.
fn common(times: impl Iterator<Item = f64>, rounding: f64) -> Option<f64> {
    let mut common: Option<Fraction> = None;
    for time in times {
        let (p, q) = fraction(time, rounding)?;
        common = Some(match common {
            None => (p, q),
            Some((known_p, known_q)) => {
                let lcm = (known_q / gcd(known_q, q)).checked_mul(q)?;
                (gcd(known_p, p), lcm)
            }
        });
    }
    common.map(|(p, q)| p as f64 / q as f64)
}

/// The fraction that a positive number is but for rounding: a decimal number of few digits, else the first of its continued fraction.
fn fraction(x: f64, rounding: f64) -> Option<Fraction> {
    let is_x = |p: f64, q: f64| (p / q - x).abs() <= rounding * x;
    for digits in 0..=15 {
        let q = 10_f64.powi(digits);
        let p = (x * q).round();
        if (1.0..DIGITS).contains(&p) && (p / q - x).abs() <= WRITTEN * x && rounding == WRITTEN {
            return Some(lowest(p as u128, q as u128));
        }
    }
    let largest = if rounding == WRITTEN { LARGEST } else { SIMPLE };
    let (mut rest, mut p, mut q) = (x, [1.0, 0.0], [0.0, 1.0]);
    loop {
        let whole = rest.floor();
        p = [whole * p[0] + p[1], p[0]];
        q = [whole * q[0] + q[1], q[0]];
        if !(p[0] < largest && q[0] < largest) {
            return None;
        }
        if q[0] > 0.0 && p[0] > 0.0 && is_x(p[0], q[0]) {
            return Some(lowest(p[0] as u128, q[0] as u128));
        }
        rest = 1.0 / (rest - whole);
        if !rest.is_finite() {
            return None;
        }
    }
}

fn lowest(p: u128, q: u128) -> Fraction {
    let by = gcd(p, q);
    (p / by, q / by)
}

fn gcd(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

fn located(block: &FlatBlock, problem: Problem) -> Problem {
    match &block.place {
        Some(place) => problem.at(place, format!("in `{}`", block.path)),
        None => problem,
    }
}

pub(super) fn rate_of(interface: &Interface, clock: &Clock) -> Option<usize> {
    let SampleTime::Discrete { period, offset } = interface.sample_time? else { return None };
    let rate =
        Rate { period: (period / clock.tick).round() as u64, offset: (offset / clock.tick).round() as u64 };
    clock.rates.iter().position(|known| *known == rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tick(times: &[f64]) -> Option<f64> {
        let common = |rounding| common(times.iter().copied(), rounding);
        common(WRITTEN).or_else(|| common(MEANT))
    }

    #[test]
    fn times_are_multiples_of_their_tick_to_the_last_digit() {
        let cases: [(&[f64], f64); 9] = [
            (&[1e-3, 5e-3], 1e-3),
            (&[0.8e-3, 0.4919e-3], 1e-7),
            (&[0.8e-3, 0.4919e-3, 0.8e-3], 1e-7),
            (&[17.5e-3, 0.991e-3, 17.5e-3], 1e-6),
            (&[71.5e-3, 0.266e-3], 2e-6),
            (&[1.0 / 8000.0, 1e-3], 1.0 / 8000.0),
            (&[5.0 / 5000.0, 6.378e-3, 4.074e-3, 3.096e-3], 2e-6),
            (&[1.0 / 3.0, 0.5], 1.0 / 6.0),
            (&[1.0 / 7000.0, 1.0 / 3000.0], 1.0 / 21000.0),
        ];
        for (times, right) in cases {
            assert_eq!(tick(times), Some(right), "{times:?}");
        }
    }

    #[test]
    fn a_fraction_may_be_meant_by_many_digits() {
        assert_eq!(common([0.333_333_333_333, 1.0].into_iter(), MEANT), Some(1.0 / 3.0));
    }

    #[test]
    fn times_without_a_common_one_have_a_tick_that_cannot_be_counted_in_if_any() {
        let times = [std::f64::consts::PI * 1e-3, 1e-3];
        assert!(common(times.into_iter(), WRITTEN).is_none_or(|tick| 3.2e-3 / tick > MOST_TICKS));
        assert!(common(times.into_iter(), MEANT).is_none_or(|tick| 3.2e-3 / tick > MOST_TICKS));
    }
}
