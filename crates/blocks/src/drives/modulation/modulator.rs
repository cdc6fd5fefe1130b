//! The legs of a bridge in time: when duties are sampled, when legs switch, and what they remember.

use serde::Deserialize;

use super::carrier::{falling, is_falling};
use super::{Amount, Carrier};

/// When the references are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Sampling {
    /// All the time: a leg switches where its reference crosses the carrier.
    Natural,
    /// At the start of each period of the carrier: pulses are symmetric to the middle of the period.
    #[default]
    Symmetric,
    /// At the start and in the middle of each period: each edge has a sample of its own.
    Asymmetric,
}

/// Pulse-width modulation of any number of legs, as pure functions on memory that the caller keeps in its discrete
/// states.
///
/// The memory has [`cells(legs)`](Self::cells) numbers, at first those of [`initial`](Self::initial). Call
/// [`settle`](Self::settle) at every major step, and stop at [`next_event`](Self::next_event); with natural sampling
/// stop also where one of [`guards`](Self::guards) changes sign. Between two calls of `settle` nothing switches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modulator {
    /// The carrier, which says how often the legs switch.
    pub carrier: Carrier,
    /// When the references are looked at.
    pub sampling: Sampling,
    /// For how long both switches of a leg are off before one is turned on, s; at least 0.
    pub dead_time: f64,
}

/// Half of the carrier at the last call; -1 before the first.
const HALF: usize = 0;
/// When the duties were sampled last, s.
const SAMPLED: usize = 1;
const COMMON: usize = 2;

/// Cells of one leg: the duty that was sampled, whether the leg is high, when its dead time is over (s), and whether it is.
const DUTY: usize = 0;
const HIGH: usize = 1;
const FREE: usize = 2;
const ON: usize = 3;
const EACH: usize = 4;

impl Modulator {
    /// How many numbers the memory of `legs` legs has.
    pub const fn cells(legs: usize) -> usize {
        COMMON + EACH * legs
    }

    /// Values of the memory before the first call.
    pub fn initial(legs: usize) -> Vec<f64> {
        let mut memory = vec![0.0; Self::cells(legs)];
        memory[HALF] = -1.0;
        memory
    }

    /// Brings the memory to `t`, s, from the duties of the legs at this instant; returns whether anything changed. A second
    /// call at the same time changes something only if the duties have changed.
    ///
    /// With natural sampling duties need not be limited to 0 to 1. A leg whose duty is not a number stays as it is.
    pub fn settle(&self, t: f64, duties: &[f64], memory: &mut [f64]) -> bool {
        let mut changed = false;
        let mut put = |cell: &mut f64, value: f64| {
            // NaN equals itself.
            changed |= cell.to_bits() != value.to_bits();
            *cell = value;
        };
        let (common, legs) = memory.split_at_mut(COMMON);
        let last = common[HALF];
        let now = self.common(t, [last, common[SAMPLED]]);
        common.iter_mut().zip(now).for_each(|(cell, value)| put(cell, value));
        for (cells, duty) in legs.chunks_exact_mut(EACH).zip(duties) {
            let held = [cells[DUTY], cells[HIGH], cells[FREE], cells[ON]];
            let leg = self.cells_of_leg(t, last, now, *duty, held);
            cells.iter_mut().zip(leg).for_each(|(cell, value)| put(cell, value));
        }
        changed
    }

    /// What the memory becomes, cell by cell, see [`settle`](Self::settle).
    pub fn settled<N: Amount>(&self, t: N, duties: &[N], memory: &[N]) -> Vec<N> {
        let (common, legs) = memory.split_at(COMMON);
        let now = self.common(t, [common[HALF], common[SAMPLED]]);
        let mut settled = now.to_vec();
        for (cells, duty) in legs.chunks_exact(EACH).zip(duties) {
            let held = [cells[DUTY], cells[HIGH], cells[FREE], cells[ON]];
            settled.extend(self.cells_of_leg(t, common[HALF], now, *duty, held));
        }
        settled
    }

    /// The half of the carrier and when duties were sampled.
    fn common<N: Amount>(&self, t: N, [last, sampled]: [N; COMMON]) -> [N; COMMON] {
        let half = self.carrier.half(t);
        let counted = match self.sampling {
            Sampling::Symmetric => [last, half].map(|half| (half * 0.5).whole()),
            Sampling::Asymmetric | Sampling::Natural => [last, half],
        };
        let kept = counted[0].equal(counted[1], sampled, t);
        [half, t.fixed(0.0).greater(last, t, kept)]
    }

    /// The cells of a leg, of which some are held; `last` is the half before.
    fn cells_of_leg<N: Amount>(
        &self,
        t: N,
        last: N,
        [half, sampled]: [N; COMMON],
        duty: N,
        [held, high, free, _]: [N; EACH],
    ) -> [N; EACH] {
        let (zero, one) = (t.fixed(0.0), t.fixed(1.0));
        let (kept, known, wanted) = if self.sampling == Sampling::Natural {
            // On the carrier itself counts what comes after: in a half in which it falls, the leg rises.
            let above = duty - self.carrier.level(t, half);
            let on_carrier = above.equal(zero, falling(half, one, zero), zero);
            (held, above, above.greater(zero, one, on_carrier))
        } else {
            let kept = sampled.equal(t, duty.within(0.0, 1.0), held);
            (kept, kept, self.carrier.high(t, half, kept))
        };
        // What is not a number switches nothing.
        let now = known.equal(known, wanted, high);
        // Which switch was on before the start, if any, is not known.
        let turned = zero.greater(last, t, t + self.dead_time);
        let free = now.equal(high, free, turned);
        [kept, now, free, free.greater(t, zero, one)]
    }

    /// Whether the duties of the instant `t`, s, are those that [`settle`](Self::settle) would sample.
    pub fn samples(&self, t: f64, memory: &[f64]) -> bool {
        let last = memory[HALF];
        last < 0.0 || memory[SAMPLED] == t || self.samples_between(last, self.carrier.half(t))
    }

    /// Makes the next [`settle`](Self::settle) sample the duties of `t`, s, in the middle of what a sample holds for otherwise.
    pub fn sample_at(t: f64, memory: &mut [f64]) {
        memory[SAMPLED] = t;
    }

    /// Whether samples are taken between the starts of two halves.
    fn samples_between(&self, last: f64, half: f64) -> bool {
        match self.sampling {
            Sampling::Symmetric => (last / 2.0).floor() != (half / 2.0).floor(),
            Sampling::Asymmetric | Sampling::Natural => last != half,
        }
    }

    /// The next time after `t`, s, at which [`settle`](Self::settle) must be called: a sample, an edge, the end of a dead
    /// time or, with natural sampling, a turn of the carrier. `t` is that of the last call or a little later.
    pub fn next_event(&self, t: f64, memory: &[f64]) -> f64 {
        let (common, legs) = memory.split_at(COMMON);
        let half = common[HALF].max(0.0);
        let to_come = match self.sampling {
            Sampling::Symmetric if is_falling(half) => 2,
            _ => 1,
        };
        let mut next = self.carrier.start(half + f64::from(to_come));
        for leg in legs.chunks_exact(EACH) {
            let mut earlier = |time: f64| {
                if time > t && time < next {
                    next = time;
                }
            };
            earlier(leg[FREE]);
            let duty = leg[DUTY];
            if self.sampling != Sampling::Natural && duty > 0.0 && duty < 1.0 {
                (0..to_come).for_each(|later| earlier(self.carrier.edge(half + f64::from(later), duty)));
            }
        }
        next
    }

    /// Functions whose sign changes are edges of natural sampling: duty minus carrier, one for each leg. Not for the other
    /// kinds of sampling, whose edges are known beforehand.
    pub fn guards<'a, N: Amount>(
        &'a self,
        t: N,
        duties: &'a [N],
        memory: &[N],
    ) -> impl Iterator<Item = N> + use<'a, N> {
        let (half, zero) = (memory[HALF], t.fixed(0.0));
        let level = self.carrier.level(t, zero.greater(half, zero, half));
        duties.iter().map(move |duty| *duty - level)
    }

    /// The duty of a leg that was sampled last, 0 to 1. Not with natural sampling.
    pub fn duty<N: Amount>(memory: &[N], leg: usize) -> N {
        memory[COMMON + EACH * leg + DUTY]
    }

    /// Whether a leg is commanded high: the state of an ideal pole, without dead time.
    pub fn is_high(memory: &[f64], leg: usize) -> bool {
        memory[COMMON + EACH * leg + HIGH] == 1.0
    }

    /// What the switches of a leg are told, upper and lower, 0 or 1. Both are off during the dead time.
    pub fn leg<N: Amount>(memory: &[N], leg: usize) -> [N; 2] {
        let cells = &memory[COMMON + EACH * leg..][..EACH];
        let (high, on, zero) = (cells[HIGH], cells[ON], cells[ON].fixed(0.0));
        [high.equal(zero, zero, on), high.equal(zero, on, zero)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: f64 = 1.0 / 8e3;

    fn modulator(sampling: Sampling, dead_time: f64) -> Modulator {
        Modulator { carrier: Carrier { frequency: 8e3 }, sampling, dead_time }
    }

    /// Runs from event to event with duties that are functions of the time of a sample; calls `seen` at each.
    fn walk<const LEGS: usize>(
        modulator: Modulator,
        end: f64,
        duties: impl Fn(f64) -> [f64; LEGS],
        mut seen: impl FnMut(f64, &[f64]),
    ) {
        let mut memory = Modulator::initial(LEGS);
        let mut t = 0.0;
        while t < end {
            modulator.settle(t, &duties(t), &mut memory);
            assert!(!modulator.settle(t, &duties(t), &mut memory), "not settled at {t}");
            seen(t, &memory);
            let next = modulator.next_event(t, &memory);
            assert!(next > t, "{next} is not after {t}");
            t = next;
        }
    }

    /// Times at which the leg turns: up, down, up ...
    fn edges(modulator: Modulator, end: f64, duty: impl Fn(f64) -> f64) -> Vec<f64> {
        let (mut edges, mut was) = (Vec::new(), false);
        walk(
            modulator,
            end,
            |t| [duty(t)],
            |t, memory| {
                if Modulator::is_high(memory, 0) != was {
                    was = !was;
                    edges.push(t);
                }
            },
        );
        edges
    }

    #[test]
    fn edges_of_ten_thousand_symmetric_periods_are_where_the_formula_says() {
        let duty = |t: f64| 0.5 + 0.45 * (300.0 * t).sin();
        let edges = edges(modulator(Sampling::Symmetric, 0.0), 1e4 * PERIOD, duty);
        assert_eq!(edges.len(), 20_000);
        for (k, pair) in edges.chunks_exact(2).enumerate() {
            let start = k as f64 / 8e3;
            let d = duty(start);
            assert!((pair[0] - (start + (1.0 - d) / 2.0 * PERIOD)).abs() < 1e-12, "period {k}");
            assert!((pair[1] - (start + (1.0 + d) / 2.0 * PERIOD)).abs() < 1e-12, "period {k}");
        }
    }

    #[test]
    fn asymmetric_sampling_takes_a_new_duty_for_each_edge() {
        let duty = |t: f64| 0.5 + 0.45 * (300.0 * t).sin();
        let edges = edges(modulator(Sampling::Asymmetric, 0.0), 1e4 * PERIOD, duty);
        assert_eq!(edges.len(), 20_000);
        for (half, edge) in edges.iter().enumerate() {
            let start = half as f64 / 16e3;
            let d = duty(start);
            let share = if half % 2 == 0 { 1.0 - d } else { d };
            assert!((edge - (start + share / 2.0 * PERIOD)).abs() < 1e-12, "half {half}");
        }
    }

    #[test]
    fn full_and_empty_duties_follow_each_other_without_a_glitch() {
        // 0, 1, 1, 0, 1/2, 1, 0 in successive periods.
        let duties = [0.0, 1.0, 1.0, 0.0, 0.5, 1.0, 0.0];
        let of = |t: f64| duties[(t * 8e3).round() as usize % duties.len()];
        let edges = edges(modulator(Sampling::Symmetric, 0.0), 7.0 * PERIOD, of);
        let expected = [1.0, 3.0, 4.25, 4.75, 5.0, 6.0].map(|periods: f64| periods * PERIOD);
        assert_eq!(edges.len(), expected.len(), "{edges:?}");
        assert!(edges.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-15));
    }

    #[test]
    fn both_switches_of_a_leg_are_never_on_and_rest_for_the_dead_time() {
        for sampling in [Sampling::Symmetric, Sampling::Asymmetric] {
            let dead = 2e-6;
            let modulator = modulator(sampling, dead);
            let duty = |t: f64| [0.5 + 0.6 * (300.0 * t).sin(), 0.5 - 0.6 * (300.0 * t).sin(), 0.99];
            let mut off_since = [(0.0, 0.0); 3];
            let mut turns = 0;
            walk(modulator, 0.3, duty, |t, memory| {
                for (i, (upper_off, lower_off)) in off_since.iter_mut().enumerate() {
                    let [upper, lower] = Modulator::leg(memory, i).map(|gate| gate == 1.0);
                    assert!(!(upper && lower), "shoot-through at {t}");
                    if t > dead {
                        assert!(!upper || t - *lower_off >= dead - 1e-15, "leg {i} at {t}");
                        assert!(!lower || t - *upper_off >= dead - 1e-15, "leg {i} at {t}");
                    }
                    if upper {
                        turns += 1;
                    }
                    // The last time at which each was seen on; it is on until the next event.
                    *upper_off = if upper { f64::INFINITY } else { upper_off.min(t) };
                    *lower_off = if lower { f64::INFINITY } else { lower_off.min(t) };
                }
            });
            assert!(turns > 1000);
        }
    }

    #[test]
    fn a_pulse_shorter_than_the_dead_time_turns_nothing_on() {
        let modulator = modulator(Sampling::Symmetric, 5e-6);
        let mut lower_was_off = false;
        walk(
            modulator,
            10.0 * PERIOD,
            |_| [3e-6 / PERIOD],
            |_, memory| {
                let [upper, lower] = Modulator::leg(memory, 0).map(|gate| gate == 1.0);
                assert!(!upper);
                lower_was_off |= !lower;
            },
        );
        assert!(lower_was_off);
    }

    #[test]
    fn dead_time_takes_the_same_time_from_both_switches() {
        let (dead, d) = (2e-6, 0.4);
        let modulator = modulator(Sampling::Symmetric, dead);
        let (mut on, mut before) = ([0.0; 2], None::<(f64, [f64; 2])>);
        walk(
            modulator,
            100.5 * PERIOD,
            |_| [d],
            |t, memory| {
                if let Some((start, leg)) = before {
                    // Whole periods, away from the start.
                    if start >= 0.9999 * PERIOD && t <= 100.0001 * PERIOD {
                        on[0] += leg[0] * (t - start);
                        on[1] += leg[1] * (t - start);
                    }
                }
                before = Some((t, Modulator::leg(memory, 0)));
            },
        );
        assert!((on[0] / 99.0 - (d * PERIOD - dead)).abs() < 1e-12, "{on:?}");
        assert!((on[1] / 99.0 - ((1.0 - d) * PERIOD - dead)).abs() < 1e-12, "{on:?}");
    }

    #[test]
    fn natural_sampling_switches_with_the_sign_of_its_guard() {
        let modulator = modulator(Sampling::Natural, 0.0);
        let mut memory = Modulator::initial(1);
        for k in 0..1000 {
            let t = f64::from(k) * PERIOD / 37.0;
            let duty = [0.5 + 0.7 * (300.0 * t).sin()];
            modulator.settle(t, &duty, &mut memory);
            let guard = modulator.guards(t, &duty, &memory).next().expect("one for each leg");
            assert!(guard == 0.0 || Modulator::is_high(&memory, 0) == (guard > 0.0), "{t}");
            let turn = modulator.next_event(t, &memory);
            assert_eq!(turn, modulator.carrier.start(modulator.carrier.half(t) + 1.0));
        }
    }

    #[test]
    fn what_is_no_number_switches_nothing() {
        for sampling in [Sampling::Natural, Sampling::Symmetric, Sampling::Asymmetric] {
            walk(
                modulator(sampling, 1e-6),
                10.0 * PERIOD,
                |_| [f64::NAN],
                |t, memory| {
                    assert!(!Modulator::is_high(memory, 0), "{t}");
                },
            );
        }
    }
}
