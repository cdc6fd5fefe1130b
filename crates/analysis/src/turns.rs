//! Angles that jump by a whole turn, because they are told between two limits.

/// Steps of more than this part of a turn, but not much more than one, are jumps of the scale, not motion.
const JUMP: std::ops::Range<f64> = 0.75..1.25;

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

/// Makes an angle go on where it jumps; whether it has done so.
fn unwrap(values: &mut [f64], turn: f64) -> bool {
    let (mut last, mut offset, mut has_jumped) = (f64::NAN, 0.0, false);
    for value in values.iter_mut().filter(|value| value.is_finite()) {
        let step = *value - last;
        if JUMP.contains(&(step.abs() / turn)) {
            offset -= turn.copysign(step);
            has_jumped = true;
        }
        last = *value;
        *value += offset;
    }
    has_jumped
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
}
