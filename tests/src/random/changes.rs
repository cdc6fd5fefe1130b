//! How often a value changes its sign, as a number of events that a reference without events knows as well.

/// Of a number that is certain it does not matter by which of these both bounds are multiplied.
const DOUBTS: [f64; 3] = [1.0 / 3.0, 1.0, 3.0];

/// How often `values` at `times` change their sign, when what is within `band` of zero has the sign of before and what lasts no
/// longer than `moment` does not count; `least` is both. Between two times values go straight.
pub fn changes(times: &[f64], values: &[f64], least: (f64, f64)) -> u32 {
    let (band, moment) = least;
    // When a value that is beyond the band at the `k`th time got there.
    let begun = |k: usize| {
        let edge = band * values[k].signum();
        match k.checked_sub(1).map(|before| (times[before], values[before])) {
            Some((t, value)) if (value - edge) * (values[k] - edge) < 0.0 => {
                t + (times[k] - t) * (edge - value) / (values[k] - value)
            }
            _ => times[k],
        }
    };
    let (mut sign, mut number) = (0.0, 0);
    // Ends a span of a sign that has begun at `since`.
    let mut end = |now: f64, since: f64, t: f64| {
        if now != sign && t - since > moment {
            number += u32::from(sign != 0.0);
            sign = now;
        }
    };
    let mut span = (0.0, f64::INFINITY);
    for (k, value) in values.iter().enumerate().filter(|(_, value)| value.abs() > band) {
        if value.signum() != span.0 {
            let t = begun(k);
            end(span.0, span.1, t);
            span = (value.signum(), t);
        }
    }
    if let Some(t) = times.last() {
        end(span.0, span.1, *t);
    }
    number
}

/// Magnitudes of values that go straight between their times, with the times: a zero between two of them is one more.
pub fn sizes(times: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut points: (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    for (k, (&t, &value)) in times.iter().zip(values).enumerate() {
        if let Some((since, before)) = k.checked_sub(1).map(|last| (times[last], values[last]))
            && value * before < 0.0
        {
            points.0.push(since + (t - since) * before / (before - value));
            points.1.push(0.0);
        }
        points.0.push(t);
        points.1.push(value.abs());
    }
    points
}

/// The same number where it does not depend on the bounds.
pub fn certain(times: &[f64], values: &[f64], least: (f64, f64)) -> Option<u32> {
    let [number, others @ ..] = DOUBTS.map(|part| changes(times, values, (part * least.0, part * least.1)));
    others.iter().all(|other| *other == number).then_some(number)
}

/// Forgets the numbers that are not those of another run.
pub fn doubt(known: &mut [Option<u32>], others: &[Option<u32>]) {
    known.iter_mut().zip(others).for_each(|(known, other)| *known = known.filter(|_| known == other));
}

#[cfg(test)]
mod tests {
    use super::{changes, sizes};

    #[test]
    fn a_magnitude_is_zero_where_the_value_changes_its_sign() {
        let points = sizes(&[0.0, 1.0, 3.0, 4.0], &[2.0, -1.0, -1.0, 0.0]);
        assert_eq!(points, (vec![0.0, 2.0 / 3.0, 1.0, 3.0, 4.0], vec![2.0, 0.0, 1.0, 1.0, 0.0]));
    }

    #[test]
    fn little_and_short_changes_do_not_count() {
        let times = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
        let values = [0.0, 1.0, -0.1, 1.0, -1.0, -0.1, -1.0, 2.0, 1.0];
        assert_eq!(changes(&times, &values, (0.2, 0.5)), 2);
        assert_eq!(changes(&times, &values, (0.2, 4.0)), 0);
        assert_eq!(changes(&times, &values, (0.0, 0.1)), 4);
        assert_eq!(changes(&times, &values, (0.0, 0.5)), 2);
        assert_eq!(changes(&times, &values, (0.0, 1.5)), 1);
        assert_eq!(changes(&times, &values, (0.0, 3.5)), 0);
        assert_eq!(changes(&times, &values, (2.5, 0.5)), 0);
        assert_eq!(changes(&times, &values[..2], (0.2, 0.0)), 0);
        // Straight from 1 to -9 and back: below zero for 1.8.
        let values = [1.0, 1.0, 1.0, 1.0, -9.0, 1.0, 1.0, 1.0, 1.0];
        assert_eq!(changes(&times, &values, (0.0, 1.7)), 2);
        assert_eq!(changes(&times, &values, (0.0, 1.9)), 0);
        // A sign of the beginning must last as any other.
        let values = [0.0, 1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0];
        assert_eq!(changes(&times, &values, (0.2, 0.5)), 2);
        assert_eq!(changes(&times, &values, (0.2, 1.5)), 1);
    }
}
