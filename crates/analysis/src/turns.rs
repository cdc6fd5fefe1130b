//! Angles that jump by a whole turn, because they are told between two limits.

use crate::series::{Interpolation, Series};

/// Steps of more than this part of a turn, but not much more than one, are jumps of the scale, not motion.
const JUMP: std::ops::Range<f64> = 0.75..1.25;
/// How far beyond the ends of a scale rounding may lead, turns.
const EDGE: f64 = 1e-6;

/// Takes the jumps by whole turns out of two angles, where either has any, and brings the second within half a turn of the
/// first at their first common value, so that their difference means something. `turn` is a whole turn in their unit.
///
/// ```
/// let (mut set, mut actual) = (vec![170.0, 179.0, -172.0], vec![169.0, 178.0, 187.0]);
/// blocksim_analysis::without_jumps(&mut set, &mut actual, 360.0);
/// assert_eq!((set, actual), (vec![170.0, 179.0, 188.0], vec![169.0, 178.0, 187.0]));
/// ```
pub fn without_jumps(set: &mut [f64], actual: &mut [f64], turn: f64) {
    let has_jumped = [&mut *set, &mut *actual].map(|values| unwrap(values, turn));
    if has_jumped == [false, false] {
        return;
    }
    let finite = set.iter().zip(actual.iter()).map(|(set, actual)| set - actual).find(|off| off.is_finite());
    let whole = (finite.unwrap_or(0.0) / turn).round() * turn;
    actual.iter_mut().for_each(|value| *value += whole);
}

/// Positions of the values that lie behind a jump by a whole turn. `turn` is a whole turn in the unit of the values.
///
/// A scale jumps between half a turn and minus half a turn, or between a turn and zero; there, a value that does not move on
/// both sides is taken for a step that somebody asked for, such as one from 0 to 300 degrees.
pub fn jumps(values: &[f64], turn: f64) -> Vec<usize> {
    let known: Vec<usize> = (0..values.len()).filter(|&at| values[at].is_finite()).collect();
    let step = |n: usize| Some(values[*known.get(n)?] - values[*known.get(n.checked_sub(1)?)?]);
    let within = |n: usize, from: f64, to: f64| {
        [n - 1, n].iter().all(|&n| (from - EDGE..=to + EDGE).contains(&(values[known[n]] / turn)))
    };
    let is_jump = |&n: &usize| {
        let Some(jump) = step(n).filter(|jump| JUMP.contains(&(jump.abs() / turn))) else { return false };
        let mut beside = [step(n - 1), step(n + 1)].into_iter().flatten().peekable();
        let goes_on = beside.peek().is_some() && beside.all(|step| step * jump < 0.0);
        within(n, -0.5, 0.5) || (within(n, 0.0, 1.0) && goes_on)
    };
    (1..known.len()).filter(is_jump).map(|n| known[n]).collect()
}

/// The course of an angle with a gap, a value that is not a number, wherever it jumps by a whole turn; `None` where it never
/// does. There a line would only show that the scale has ends.
pub fn with_gaps(time: &[f64], values: &[f64], turn: f64) -> Option<(Vec<f64>, Vec<f64>)> {
    let jumps = jumps(values, turn);
    if jumps.is_empty() || time.len() != values.len() {
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
    let jumped = [unwrap(&mut first, turn), unwrap(&mut second, turn)];
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
/// let shown = [-178.0, 179.0, 170.0];
/// assert_eq!(blocksim_analysis::continued(&shown, 360.0), Some(vec![182.0, 179.0, 170.0]));
/// ```
pub fn continued(values: &[f64], turn: f64) -> Option<Vec<f64>> {
    let mut values = values.to_vec();
    if !unwrap(&mut values, turn) {
        return None;
    }
    let finite = || values.iter().copied().filter(|x| x.is_finite());
    let middle = (finite().fold(f64::INFINITY, f64::min) + finite().fold(f64::NEG_INFINITY, f64::max)) / 2.0;
    let whole = (middle / turn).round() * turn;
    values.iter_mut().for_each(|value| *value -= whole);
    Some(values)
}

/// Makes an angle go on where it jumps; whether it has done so.
fn unwrap(values: &mut [f64], turn: f64) -> bool {
    let jumps = jumps(values, turn);
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

    #[test]
    fn angles_that_do_not_jump_stay_as_they_are() {
        // More than half a turn apart, but there is no jump that would say that whole turns do not count.
        let (mut set, mut actual) = (vec![0.0, 200.0, 400.0], vec![-10.0, f64::NAN, -20.0]);
        let before = set.clone();
        without_jumps(&mut set, &mut actual, 360.0);
        assert_eq!((set, actual[0], actual[2]), (before, -10.0, -20.0));
    }

    #[test]
    fn jumps_there_and_back_and_a_start_on_the_other_side_are_taken_out() {
        let mut set = vec![-179.0, 179.0, -179.0, f64::NAN, -175.0];
        let mut actual = vec![180.0, 180.0, -180.0, -178.0, -176.0];
        without_jumps(&mut set, &mut actual, 360.0);
        assert_eq!((&set[..3], set[4]), (&[-179.0, -181.0, -179.0][..], -175.0));
        assert_eq!(actual, [-180.0, -180.0, -180.0, -178.0, -176.0]);
        without_jumps(&mut [], &mut [], 360.0);
    }

    #[test]
    fn a_step_that_somebody_asks_for_is_no_jump_of_the_scale() {
        for target in [300.0, 360.0, -300.0, 400.0] {
            assert_eq!(jumps(&[0.0, 0.0, target, target], 360.0), [0_usize; 0], "{target}");
        }
        // A shaft that turns on, told between 0 and 360 degrees, forwards and backwards; its last value has none behind it.
        assert_eq!(jumps(&[330.0, 350.0, 10.0, 30.0], 360.0), [2]);
        assert_eq!(jumps(&[30.0, 10.0, 350.0], 360.0), [2]);
        assert_eq!(jumps(&[-170.0, f64::NAN, 178.0, -179.0], 360.0), [2, 3]);
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
        assert_eq!(
            continued(&[170.0, -178.0, f64::NAN, -100.0], 360.0).map(|all| (all[0], all[1], all[3])),
            Some((-190.0, -178.0, -100.0))
        );
        assert_eq!(continued(&[0.0, 300.0], 360.0), None);
    }

    #[test]
    fn a_gap_stands_before_the_value_behind_each_jump() {
        let (time, values) = with_gaps(&[0.0, 1.0, 2.0], &[179.0, -179.0, -170.0], 360.0).expect("a jump");
        assert_eq!(time, [0.0, 1.0, 1.0, 2.0]);
        assert_eq!((values[0], values[1].is_nan(), &values[2..]), (179.0, true, &[-179.0, -170.0][..]));
        assert_eq!(with_gaps(&[0.0, 1.0], &[0.0, 300.0], 360.0), None);
    }
}
