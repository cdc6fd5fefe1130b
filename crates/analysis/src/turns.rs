//! Angles that jump by a whole turn, because they are given between two limits.

use crate::series::{Interpolation, Series};

/// Changes of more than this part of a turn, but not much more than one, may be jumps of the scale.
const JUMP: std::ops::Range<f64> = 0.75..1.25;
/// Changes of less than this part of a turn may be motion; what is larger and no jump of the scale is a step.
const MOTION: f64 = 0.25;
/// How far beyond the ends of a scale rounding may lead, turns.
const EDGE: f64 = 1e-6;
/// Who goes from one end of a scale around zero so near to the other end stays where he is, turns.
const SAME: f64 = 1e-3;
/// How much farther than the motion beside it a value may go while it jumps.
const ROOM: f64 = 1.5;
/// Changes that are looked at on each side of a jump.
const BESIDE: usize = 4;
/// So many times as long as the values beside it a value of stairs may stay; what stays longer rests.
const REST: f64 = 3.0;
/// Times that differ by less than this share of the whole are one.
const SAME_TIME: f64 = 1e-9;

/// Takes the jumps by whole turns out of two angles, where either has any, and brings the second within half a turn of the
/// first at their first common value, so that their difference means something. `turn` is a whole turn in their unit, `times`
/// are the times of both.
///
/// ```
/// let (time, mut set, mut actual) = ([0.0, 1.0, 2.0], vec![170.0, 179.0, -172.0], vec![169.0, 178.0, 187.0]);
/// blocksim_analysis::without_jumps([&time; 2], &mut set, &mut actual, 360.0);
/// assert_eq!((set, actual), (vec![170.0, 179.0, 188.0], vec![169.0, 178.0, 187.0]));
/// ```
pub fn without_jumps(times: [&[f64]; 2], set: &mut [f64], actual: &mut [f64], turn: f64) {
    if [unwrap(times[0], set, turn), unwrap(times[1], actual, turn)] == [false, false] {
        return;
    }
    let finite = set.iter().zip(actual.iter()).map(|(set, actual)| set - actual).find(|off| off.is_finite());
    let whole = (finite.unwrap_or(0.0) / turn).round() * turn;
    actual.iter_mut().for_each(|value| *value += whole);
}

/// Positions of the values that lie behind a jump by a whole turn. `turn` is a whole turn in the unit of the values.
///
/// A scale jumps between half a turn and minus half a turn, or between a turn and zero. What remains of such a jump less the
/// whole turn is motion like that beside it: from sample to sample where values are stairs, none between two rows of one
/// time elsewhere. A step that is requested, such as one from 150 to -150 degrees, leaves more, and one from 0 to 360 degrees
/// has no motion beside it. The scale is the same all the time: the changes between its ends are all jumps, or none is,
/// whichever most of them are.
pub fn jumps(time: &[f64], values: &[f64], turn: f64) -> Vec<usize> {
    let mut finite = values.iter().filter(|value| value.is_finite());
    let mut before = finite.next().copied().unwrap_or_default();
    let mut is_large =
        |value: &f64| JUMP.contains(&((value - std::mem::replace(&mut before, *value)).abs() / turn));
    if !finite.any(&mut is_large) {
        return Vec::new();
    }
    let levels = levels(time, values);
    let changes: Vec<Change> = levels.windows(2).map(|both| Change::between(both, turn)).collect();
    let span = levels.last().map_or(0.0, |last| last.to) - levels.first().map_or(0.0, |first| first.from);
    let mut found = Vec::new();
    for ends in [(-0.5, 0.5), (0.0, 1.0)] {
        let within = |level: &Level| (ends.0 - EDGE..=ends.1 + EDGE).contains(&(level.value / turn));
        let is_between_ends =
            |n: &usize| changes[*n].is_large && within(&levels[*n]) && within(&levels[*n + 1]);
        let all: Vec<usize> = (0..changes.len()).filter(is_between_ends).collect();
        let is_jump = |n: &&usize| {
            let place = Place { levels: &levels, changes: &changes, at: **n, least: SAME_TIME * span };
            if ends.0 < 0.0 { place.moves_on() } else { place.goes_round() }
        };
        if 2 * all.iter().filter(is_jump).count() >= all.len() {
            found.extend(all.iter().map(|n| levels[n + 1].row));
        }
    }
    found.sort_unstable();
    found
}

/// Rows of one value.
#[derive(Debug, Clone, Copy)]
struct Level {
    value: f64,
    /// The first of the rows.
    row: usize,
    /// Times of the first and the last row, s.
    from: f64,
    to: f64,
}

/// The values that are finite.
fn levels(time: &[f64], values: &[f64]) -> Vec<Level> {
    // What is drawn over another signal has no times.
    let has_times = time.len() == values.len() && time.windows(2).all(|w| w[0] <= w[1]);
    let mut levels: Vec<Level> = Vec::new();
    for (row, &value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
        let t = if has_times { time[row] } else { row as f64 };
        match levels.last_mut() {
            Some(last) if last.value == value => last.to = t,
            _ => levels.push(Level { value, row, from: t, to: t }),
        }
    }
    levels
}

/// From one level to the next.
#[derive(Debug, Clone, Copy)]
struct Change {
    /// How far, turns.
    size: f64,
    /// How long from row to row, s.
    gap: f64,
    /// How long from the beginning of one level to the beginning of the next, s.
    hold: f64,
    /// Whether the scale may have jumped.
    is_large: bool,
}

impl Change {
    fn between(both: &[Level], turn: f64) -> Change {
        let (a, b) = (both[0], both[1]);
        let size = (b.value - a.value) / turn;
        Change { size, gap: b.from - a.to, hold: b.from - a.from, is_large: JUMP.contains(&size.abs()) }
    }

    /// Whether the level before was held rather than passed.
    fn is_stair(&self) -> bool {
        self.gap < self.hold / 2.0
    }

    /// How far it would be for as long as another one takes, turns. Times below `least` are rounding.
    fn for_as_long_as(&self, other: &Change, least: f64) -> f64 {
        let share = |own: f64, other: f64| if own > least { other / own } else { 0.0 };
        let row = share(self.gap, other.gap);
        let stair = if self.is_stair() && other.is_stair() { share(self.hold, other.hold) } else { 0.0 };
        self.size * row.max(stair)
    }
}

/// A change between the ends of a scale, and what is beside it.
struct Place<'a> {
    levels: &'a [Level],
    changes: &'a [Change],
    at: usize,
    /// Times below this are rounding, s.
    least: f64,
}

impl Place<'_> {
    /// The changes before and behind that are no jumps themselves, the nearest first; `None` where a step is among them.
    fn beside(&self) -> Option<[Vec<usize>; 2]> {
        let small = |n: &usize| !self.changes[*n].is_large;
        let (before, behind) = ((0..self.at).rev(), self.at + 1..self.changes.len());
        let before: Vec<usize> = before.take(2 * BESIDE).filter(small).take(BESIDE).collect();
        let behind: Vec<usize> = behind.take(2 * BESIDE).filter(small).take(BESIDE).collect();
        let is_motion = |n: &usize| self.changes[*n].size.abs() < MOTION;
        before.iter().chain(&behind).all(is_motion).then_some([before, behind])
    }

    /// What remains of the change less a whole turn, turns.
    fn remainder(&self) -> f64 {
        1.0 - self.changes[self.at].size.abs()
    }

    /// Whether what remains is not more than the motion beside it, which is as wide as it goes up and down.
    fn is_alike(&self, beside: &[Vec<usize>; 2]) -> bool {
        let far = |n: &usize| self.changes[*n].for_as_long_as(&self.changes[self.at], self.least);
        let (down, up) = beside
            .iter()
            .flatten()
            .map(far)
            .fold((0.0, 0.0), |(down, up): (f64, f64), far| (down.min(far), up.max(far)));
        self.remainder().abs() <= ROOM * (up - down) + EDGE
    }

    /// Whether a scale around zero has jumped.
    fn moves_on(&self) -> bool {
        self.remainder().abs() <= SAME || self.beside().is_some_and(|beside| self.is_alike(&beside))
    }

    /// Whether a scale from zero has jumped: there the value goes on in one direction on both sides, without a rest.
    fn goes_round(&self) -> bool {
        let Some(beside) = self.beside() else { return false };
        let nearest = [beside[0].first(), beside[1].first()];
        let against = |n: &&usize| self.changes[**n].size * self.changes[self.at].size < 0.0;
        if nearest == [None, None] || !nearest.iter().flatten().all(against) {
            return false;
        }
        let hold = |n: usize| self.changes.get(n).map(|change| change.hold);
        let before = nearest[0].and_then(|&n| hold(n));
        let behind = nearest[1].and_then(|&n| hold(n + 1).or(hold(n)));
        let longest = REST * before.into_iter().chain(behind).fold(0.0, f64::max) + self.least;
        let rests = |level: &Level| level.to - level.from > longest;
        !self.levels[self.at..=self.at + 1].iter().any(rests) && self.is_alike(&beside)
    }
}

/// The course of an angle with a gap, a value that is not a number, wherever it jumps by a whole turn; `None` where it never
/// does. There a line would only show that the scale has ends.
pub fn with_gaps(time: &[f64], values: &[f64], turn: f64) -> Option<(Vec<f64>, Vec<f64>)> {
    if time.len() != values.len() {
        return None;
    }
    let jumps = jumps(time, values, turn);
    if jumps.is_empty() {
        return None;
    }
    let (mut times, mut broken, mut from) = (Vec::new(), Vec::new(), 0);
    for at in jumps.into_iter().chain([values.len()]) {
        times.extend_from_slice(&time[from..at]);
        broken.extend_from_slice(&values[from..at]);
        if at < values.len() {
            times.push(time[at]);
            broken.push(f64::NAN);
        }
        from = at;
    }
    Some((times, broken))
}

/// Two recordings of one angle that go on where their scale has ends, the second moved by whole turns to lie within half a
/// turn of the first at their first common time; `None` where whole turns between them mean something.
///
/// They mean nothing where either jumps by a turn, or where both stay within half a turn of zero, one of them begins at an
/// end of this scale and they are nearly a turn apart at all times: there rounding has chosen between the ends.
pub fn brought_together(a: Series, b: Series, turn: f64) -> Option<(Vec<f64>, Vec<f64>)> {
    let (mut first, mut second) = (a.values.to_vec(), b.values.to_vec());
    let jumped = [unwrap(a.time, &mut first, turn), unwrap(b.time, &mut second, turn)];
    let start = a.span()?.0.max(b.span()?.0);
    let at = |time: &[f64], values: &[f64]| {
        Series::new(time, values).at(start, Interpolation::Linear, 0.0).map(|sides| sides.1)
    };
    let (x, y) = (at(a.time, &first)?, at(b.time, &second)?);
    let whole = ((x - y) / turn).round();
    if jumped == [false, false] {
        let within = |values: &[f64]| values.iter().all(|x| !x.is_finite() || (x / turn).abs() <= 0.5 + EDGE);
        let is_end = |x: f64| ((x / turn).abs() - 0.5).abs() <= EDGE;
        let apart = |(&t, &y): (&f64, &f64)| {
            let there = Series::new(a.time, a.values).at(t, Interpolation::Linear, 0.0);
            there.is_none_or(|(x, _)| !x.is_finite() || !y.is_finite() || ((x - y) / turn).abs() > JUMP.start)
        };
        let is_edge = whole != 0.0
            && within(a.values)
            && within(b.values)
            && (is_end(x) || is_end(y))
            && b.time.iter().zip(b.values).all(apart);
        if !is_edge {
            return None;
        }
    }
    if whole.is_finite() {
        second.iter_mut().for_each(|value| *value += whole * turn);
    }
    Some((first, second))
}

/// An angle that goes on where its scale has an end, moved by whole turns so that the middle of its range lies within half a
/// turn of zero; `None` where it never jumps. `turn` is a whole turn in the unit of the values.
///
/// ```
/// let (time, shown) = ([0.0, 1.0, 2.0], [-178.0, 179.0, 170.0]);
/// assert_eq!(blocksim_analysis::continued(&time, &shown, 360.0), Some(vec![182.0, 179.0, 170.0]));
/// ```
pub fn continued(time: &[f64], values: &[f64], turn: f64) -> Option<Vec<f64>> {
    let mut values = values.to_vec();
    if !unwrap(time, &mut values, turn) {
        return None;
    }
    let finite = || values.iter().copied().filter(|x| x.is_finite());
    let middle = (finite().fold(f64::INFINITY, f64::min) + finite().fold(f64::NEG_INFINITY, f64::max)) / 2.0;
    let whole = (middle / turn).round() * turn;
    values.iter_mut().for_each(|value| *value -= whole);
    Some(values)
}

/// Makes an angle go on where it jumps; whether it has done so.
fn unwrap(time: &[f64], values: &mut [f64], turn: f64) -> bool {
    let jumps = jumps(time, values, turn);
    let mut offset = 0.0;
    let mut before = 0.0;
    let mut next = jumps.iter().peekable();
    for (at, value) in values.iter_mut().enumerate().filter(|(_, value)| value.is_finite()) {
        if next.next_if(|jump| **jump == at).is_some() {
            offset -= turn.copysign(*value - before);
        }
        before = *value;
        *value += offset;
    }
    !jumps.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows at 0, 1, 2 ... s.
    fn at_seconds(values: &[f64]) -> Vec<usize> {
        let time: Vec<f64> = (0..values.len()).map(|n| n as f64).collect();
        jumps(&time, values, 360.0)
    }

    /// A signal that has its limit from the left and from the right where it jumps, at `at`.
    fn with_jumps(end: f64, step: f64, at: &[f64], y: impl Fn(f64, bool) -> f64) -> (Vec<f64>, Vec<f64>) {
        let mut rows: Vec<(f64, f64)> = Vec::new();
        for n in 0..=(end / step).round() as u32 {
            let t = f64::from(n) * step;
            let jumps = at.iter().any(|x| (x - t).abs() < step / 4.0);
            rows.extend(jumps.then(|| (t, y(t, true))));
            rows.push((t, y(t, false)));
        }
        rows.into_iter().unzip()
    }

    #[test]
    fn angles_that_do_not_jump_stay_as_they_are() {
        // More than half a turn apart, but there is no jump that would say that whole turns do not count.
        let (mut set, mut actual) = (vec![0.0, 200.0, 400.0], vec![-10.0, f64::NAN, -20.0]);
        let before = set.clone();
        without_jumps([&[0.0, 1.0, 2.0]; 2], &mut set, &mut actual, 360.0);
        assert_eq!((set, actual[0], actual[2]), (before, -10.0, -20.0));
    }

    #[test]
    fn jumps_there_and_back_and_a_start_on_the_other_side_are_taken_out() {
        let time = [0.0, 1.0, 2.0, 3.0, 4.0];
        let mut set = vec![-179.0, 179.0, -179.0, f64::NAN, -175.0];
        let mut actual = vec![180.0, 180.0, -180.0, -178.0, -176.0];
        without_jumps([&time; 2], &mut set, &mut actual, 360.0);
        assert_eq!((&set[..3], set[4]), (&[-179.0, -181.0, -179.0][..], -175.0));
        assert_eq!(actual, [-180.0, -180.0, -180.0, -178.0, -176.0]);
        without_jumps([&[]; 2], &mut [], &mut [], 360.0);
    }

    #[test]
    fn a_step_that_is_requested_is_no_jump_of_the_scale() {
        for target in [300.0, 360.0, -300.0, 400.0] {
            assert_eq!(at_seconds(&[0.0, 0.0, target, target]), [0_usize; 0], "{target}");
        }
        for (before, after) in [(150.0, -150.0), (-160.0, 170.0), (170.0, -170.0)] {
            // At one time, from row to row, there and back, in stairs, and on a slow motion.
            let step = |t: f64, left: bool| if t < 1.0 || left { before } else { after };
            let (time, values) = with_jumps(2.0, 0.01, &[1.0], step);
            assert!(jumps(&time, &values, 360.0).is_empty());
            assert!(at_seconds(&[before, before, after, after]).is_empty());
            assert!(at_seconds(&[before, before, after, after, before, before, after]).is_empty());
            let (time, values) = with_jumps(2.0, 0.01, &[1.0], |t, left| step(t, left) + (3.0 * t).sin());
            assert!(jumps(&time, &values, 360.0).is_empty());
            let ramp = |t: f64, left: bool| if t < 0.5 { 2.0 * t * before } else { step(t, left) };
            let (time, values) = with_jumps(2.0, 0.1, &[1.0], ramp);
            assert!(jumps(&time, &values, 360.0).is_empty());
        }
        // Slowly up to the end of the scale, a rest, and back to its beginning.
        let there =
            |t: f64, left: bool| if t < 1.0 { 360.0 * t } else { if t < 2.0 || left { 360.0 } else { 0.0 } };
        let (time, values) = with_jumps(3.0, 0.01, &[2.0], there);
        assert!(jumps(&time, &values, 360.0).is_empty());
    }

    #[test]
    fn a_sawtooth_jumps_by_a_turn_only_between_the_ends_of_the_scale() {
        let sawtooth = |low: f64, high: f64, sample: f64| {
            move |t: f64, left: bool| {
                // Of the sample before from the left; times are exact to less than a tenth of a step.
                let t = if sample > 0.0 {
                    (t / sample + if left { -0.5 } else { 0.05 }).floor() * sample
                } else {
                    t
                };
                let part = ((t + 1e-6) / 2.0).fract();
                low + (high - low) * if left && sample == 0.0 && part < 1e-3 { 1.0 } else { part }
            }
        };
        for (low, high, is_turn) in [
            (0.0, 360.0, true),
            (-180.0, 180.0, true),
            (360.0, 0.0, true),
            (0.0, 300.0, false),
            (-150.0, 150.0, false),
        ] {
            let (time, values) = with_jumps(5.0, 0.01, &[2.0, 4.0], sawtooth(low, high, 0.0));
            assert_eq!(jumps(&time, &values, 360.0).len(), if is_turn { 2 } else { 0 }, "{low} to {high}");
            // Sampled: stairs with both values at each sample, and on a grid of their own.
            let samples: Vec<f64> = (0..=50).map(|n| f64::from(n) * 0.1).collect();
            for at in [&samples[..], &[]] {
                let (time, values) = with_jumps(5.0, 0.01, at, sawtooth(low, high, 0.1));
                assert_eq!(
                    jumps(&time, &values, 360.0).len(),
                    if is_turn { 2 } else { 0 },
                    "{low} to {high}"
                );
            }
        }
    }

    #[test]
    fn an_angle_that_turns_jumps_wherever_its_rows_are() {
        // Given between 0 and 360 degrees, forwards and backwards; the last value has none behind it.
        assert_eq!(at_seconds(&[330.0, 350.0, 10.0, 30.0]), [2]);
        assert_eq!(at_seconds(&[30.0, 10.0, 350.0]), [2]);
        assert_eq!(at_seconds(&[-176.0, -178.0, f64::NAN, 178.0, -179.0]), [3, 4]);
        // Ever faster, in rows that come closer where something else happens.
        let time: Vec<f64> =
            (0..400).map(|n| if n % 7 == 0 { f64::from(n) - 0.99 } else { f64::from(n) } / 100.0).collect();
        for lowest in [0.0, -180.0] {
            let values: Vec<f64> =
                time.iter().map(|t| (100.0 * t * t - lowest).rem_euclid(360.0) + lowest).collect();
            let turns = (100.0 * time[399] * time[399] - lowest) / 360.0;
            assert_eq!(jumps(&time, &values, 360.0).len(), turns.floor() as usize);
        }
        // At rest at an end of the scale, with noise: wherever it changes sides.
        let mut seed = 1_u64;
        let mut noise = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        };
        let true_values: Vec<f64> = (0..1000).map(|_| 180.0 + noise()).collect();
        let values: Vec<f64> = true_values.iter().map(|x| if *x > 180.0 { x - 360.0 } else { *x }).collect();
        let sides = values.windows(2).filter(|w| w[0] * w[1] < 0.0).count();
        assert!(sides > 100);
        assert_eq!(at_seconds(&values).len(), sides);
        // Near where it begins, a resolver jumps from one end of the scale to the other.
        assert_eq!(at_seconds(&[179.9, 179.9, -180.0, -180.0, 179.9]), [2, 4]);
    }

    #[test]
    fn recordings_of_one_angle_are_no_turn_apart() {
        let time = [0.0, 1.0, 2.0, 3.0];
        let together = |a: &[f64], b: &[f64]| {
            brought_together(Series::new(&time[..a.len()], a), Series::new(&time[..b.len()], b), 360.0)
        };
        // They jump at different times, and begin at different ends.
        let found = together(&[180.0, -178.0, -176.0, -174.0], &[-180.0, 179.0, -177.0, -175.0]).unwrap();
        assert_eq!(found, (vec![180.0, 182.0, 184.0, 186.0], vec![180.0, 179.0, 183.0, 185.0]));
        // Neither jumps; rounding has chosen between the ends.
        assert_eq!(together(&[180.0, 179.0], &[-180.0, -179.5]).unwrap().1, [180.0, 180.5]);
        // A drive that stays a turn behind, one that goes from end to end, and one that turns on.
        assert_eq!(together(&[170.0, 170.0], &[-170.0, -170.0]), None);
        assert_eq!(together(&[180.0, 180.0, 180.0], &[-180.0, 0.0, 180.0]), None);
        assert_eq!(together(&[0.0, 200.0, 400.0], &[0.0, 10.0, 20.0]), None);
        assert_eq!(together(&[], &[1.0]), None);
    }

    #[test]
    fn an_angle_that_goes_on_stays_near_its_scale() {
        let time = [0.0, 1.0, 2.0, 3.0];
        assert_eq!(
            continued(&time, &[170.0, -178.0, f64::NAN, -100.0], 360.0).map(|all| (all[0], all[1], all[3])),
            Some((-190.0, -178.0, -100.0))
        );
        assert_eq!(continued(&time[..2], &[0.0, 300.0], 360.0), None);
    }

    #[test]
    fn a_gap_stands_before_the_value_behind_each_jump() {
        let (time, values) = with_gaps(&[0.0, 1.0, 2.0], &[179.0, -179.0, -170.0], 360.0).expect("a jump");
        assert_eq!(time, [0.0, 1.0, 1.0, 2.0]);
        assert_eq!((values[0], values[1].is_nan(), &values[2..]), (179.0, true, &[-179.0, -170.0][..]));
        assert_eq!(with_gaps(&[0.0, 1.0], &[0.0, 300.0], 360.0), None);
    }
}
