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
    let mut tick = 0.0;
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
        tick = common(common(tick, *period), *offset);
    }
    if times.is_empty() {
        return Clock::default();
    }
    if times.iter().any(|(period, offset, _)| period / tick > 1e9 || offset / tick > 1e12) {
        problems.push(located(
            &flat.blocks[times[0].2],
            Problem::error("sample_time", "the sample times have no common clock")
                .help("choose sample times that are multiples of a common time, such as 1 ms and 5 ms"),
        ));
        return Clock::default();
    }
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

/// Greatest common divisor of two times, up to rounding.
fn common(a: f64, b: f64) -> f64 {
    let (mut a, mut b) = (a.max(b), a.min(b));
    let zero = a * 1e-10;
    while b > zero {
        let rest = a - (a / b).round() * b;
        (a, b) = (b, rest.abs());
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
