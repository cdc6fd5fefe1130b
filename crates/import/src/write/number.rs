//! Numbers with units.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

/// `"1.5 kg"`.
pub(super) fn with_unit(value: f64, unit: &str) -> String {
    format!("\"{} {unit}\"", short(value))
}

/// `["1 m", "0 m", "2 m"]`.
pub(super) fn vector(values: &[f64], unit: &str) -> String {
    let items: Vec<String> = values.iter().map(|value| with_unit(*value, unit)).collect();
    format!("[{}]", items.join(", "))
}

/// `[0, 0, 1]`.
pub(super) fn plain(values: &[f64]) -> String {
    let items: Vec<String> = values.iter().map(|value| short(*value)).collect();
    format!("[{}]", items.join(", "))
}

/// A position or a limit: in degrees where that is a short number, in radians otherwise.
pub(super) fn angle(radians: f64) -> String {
    // Data sheets round to eleven digits, 2e-11 rad.
    in_degrees(radians, 1e-9)
}

/// A speed: in deg/s where that is a short number, in rad/s otherwise.
pub(super) fn angular(speed: f64) -> String {
    let degrees = speed.to_degrees();
    let round = (degrees * 1e3).round() / 1e3;
    match (degrees - round).abs() < 1e-8 {
        true => with_unit(round, "deg/s"),
        false => with_unit(speed, "rad/s"),
    }
}

/// Roll, pitch and yaw, `["0 deg", "90 deg", "0.3 rad"]`: exact but for the last digits, for masses hang on them.
pub(super) fn angles(radians: [f64; 3]) -> String {
    format!("[{}]", radians.map(|angle| in_degrees(angle, 1e-12)).join(", "))
}

/// In degrees if those have at most three decimals and are off by no more than `off`.
fn in_degrees(radians: f64, off: f64) -> String {
    let degrees = radians.to_degrees();
    let round = (degrees * 1e3).round() / 1e3;
    match (degrees - round).abs() < off {
        true => with_unit(round, "deg"),
        false => with_unit(radians, "rad"),
    }
}

/// The shortest digits that give back the same number, with a power of ten where that is shorter. What is off by the last
/// bits from a number of twelve digits was that number before its unit was converted.
pub(crate) fn short(value: f64) -> String {
    let round: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    let value = if (value - round).abs() <= 2.0 * f64::EPSILON * value.abs() { round } else { value };
    // Neither -0 nor -0.0.
    let value = if value == 0.0 { 0.0 } else { value };
    let (plain, power) = (format!("{value}"), format!("{value:e}"));
    match value.abs() {
        x if x == 0.0 || (1e-3..1e6).contains(&x) => plain,
        _ if power.len() < plain.len() => power,
        _ => plain,
    }
}

/// Roll, pitch and yaw of a rotation, `R = Rz(yaw) Ry(pitch) Rx(roll)`, exact also where the pitch is a right angle:
/// the roll is taken from what is left when yaw and pitch are undone.
pub(super) fn rpy(r: &Matrix3<f64>) -> [f64; 3] {
    let yaw = match r[(0, 0)].hypot(r[(1, 0)]) {
        // Only yaw plus or minus roll is defined here.
        x if x < 1e-12 => 0.0,
        _ => r[(1, 0)].atan2(r[(0, 0)]),
    };
    let (sin, cos) = yaw.sin_cos();
    let pitch = (-r[(2, 0)]).atan2(cos * r[(0, 0)] + sin * r[(1, 0)]);
    // y and z axes of the frame that the yaw is undone of
    let y = Vector3::new(-sin, cos, 0.0);
    let roll = (-y.dot(&r.column(2))).atan2(y.dot(&r.column(1)));
    // Half turns on both sides of a pitch are a pitch on the other side.
    let half = |angle: f64| (angle.abs() - PI).abs() < 1e-14;
    let angles = if half(roll) && half(yaw) { [0.0, PI - pitch, 0.0] } else { [roll, pitch, yaw] };
    angles.map(|angle| {
        // What was written with a few digits comes back so.
        let round = (angle * 1e12).round() / 1e12;
        if (angle - round).abs() < 2e-15 { round } else { angle }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_multibody::Placement;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn numbers_are_short_and_exact() {
        for (value, text) in [
            (0.445, "0.445"),
            (5.8863e-5, "5.8863e-5"),
            (-0.0, "0"),
            (1000.0, "1000"),
            (1e12, "1e12"),
            (-0.0003098, "-3.098e-4"),
            (1.0 / 3.0, "0.3333333333333333"),
            (3.005, "3.005"),
        ] {
            assert_eq!(short(value), text);
            assert_eq!(short(value).parse::<f64>(), Ok(value));
        }
        // 0.7 in other units.
        for (value, text) in [(0.1 + 0.2, "0.3"), (7e5 * 1e-9, "7e-4"), (21.0 * 0.01, "0.21")] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn angles_of_data_sheets_are_degrees_again() {
        assert_eq!(angle(-1.65806278939), "\"-95 deg\"");
        assert_eq!(angle(FRAC_PI_2), "\"90 deg\"");
        assert_eq!(angle(2.70526034059), "\"155 deg\"");
        assert_eq!(angle(0.3), "\"0.3 rad\"");
        assert_eq!(angular(3.05432619099), "\"175 deg/s\"");
        assert_eq!(angular(1.5), "\"1.5 rad/s\"");
        assert_eq!(angles([0.0, FRAC_PI_2, 0.3]), "[\"0 deg\", \"90 deg\", \"0.3 rad\"]");
    }

    #[test]
    fn a_pitch_beyond_the_right_angle_needs_no_half_turns() {
        let [roll, pitch, yaw] = rpy(&Placement::from_rpy([0.0; 3], [0.0, 2.5, 0.0]).rotation);
        assert!(roll == 0.0 && yaw == 0.0 && (pitch - 2.5).abs() < 1e-14, "{roll} {pitch} {yaw}");
    }

    #[test]
    fn angles_of_a_rotation_give_it_back_also_beside_the_right_angle() {
        let pitches = [0.0, 0.3, FRAC_PI_2, -FRAC_PI_2, FRAC_PI_2 - 1e-7, 1.0 - FRAC_PI_2, FRAC_PI_2 - 1e-13];
        for pitch in pitches {
            for (roll, yaw) in [(0.0, 0.0), (0.4, -2.1), (PI, 0.5), (-1.2, PI), (3.0, 3.0)] {
                let r = Placement::from_rpy([0.0; 3], [roll, pitch, yaw]).rotation;
                let back = Placement::from_rpy([0.0; 3], rpy(&r)).rotation;
                assert!((r - back).abs().max() < 4e-12, "{roll} {pitch} {yaw}: {}", (r - back).abs().max());
            }
        }
    }
}
