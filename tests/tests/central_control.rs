//! Torques computed for the whole arm, fed forward to the controllers of its joints.

use blocksim_tests::{Run, run_file};

const ROBOT: &str = "diagrams/irb2600/irb2600.ron";
const TWO_LINKS: &str = "diagrams/two_link_arm/two_link_arm.ron";

/// Largest distance between two columns, in degrees.
fn apart(run: &Run, set: &str, actual: &str) -> f64 {
    let rows = run.column(set).iter().zip(run.column(actual));
    rows.map(|(set, actual)| (set - actual).abs()).fold(0.0, f64::max).to_degrees()
}

/// Largest tracking errors of the six joints in degrees.
fn errors(overrides: &[&str]) -> [f64; 6] {
    let run = run_file(ROBOT, overrides);
    assert!(run.error.is_none(), "{:?}", run.error);
    [1, 2, 3, 4, 5, 6].map(|axis| {
        let scope = format!("control/joint{axis}/scope");
        apart(&run, &format!("{scope}.set"), &format!("{scope}.actual"))
    })
}

fn largest(errors: &[f64]) -> f64 {
    errors.iter().copied().fold(0.0, f64::max)
}

/// The robot with this drive, each joint on its own and with central feedforward; the integrators may be off.
fn compared(drive: &str, integrators: bool, others: &[&str]) -> [[f64; 6]; 2] {
    let off: Vec<String> = (1..=6).map(|axis| format!("robot.axis{axis}.control.ki=0")).collect();
    ["control=decentral", "control=central"].map(|control| {
        let mut overrides = vec![drive, control];
        overrides.extend(others);
        if !integrators {
            overrides.extend(off.iter().map(String::as_str));
        }
        errors(&overrides)
    })
}

/// Measured are 0.48 and 0.0068 degrees.
#[test]
fn with_ideal_torques_the_feedforward_leaves_a_fiftieth_of_the_error() {
    let [without, with] = compared("drive=torque", false, &[]);
    assert!(largest(&without) > 50.0 * largest(&with), "{without:?} and {with:?} degrees");
    for (axis, (without, with)) in (1..=6).zip(without.iter().zip(&with)) {
        assert!(*without > 5.0 * with, "axis {axis}: {without} and {with} degrees");
    }
}

/// What the description misses is left to the loops: here a torch that is half as heavy again as was said.
#[test]
fn a_torch_that_is_heavier_than_described_still_leaves_a_quarter_of_the_error() {
    let [without, with] = compared("drive=torque", false, &["arm/end_effector/torch.mass=7.875"]);
    assert!(largest(&without) > 4.0 * largest(&with), "{without:?} and {with:?} degrees");
}

#[test]
fn motors_with_currents_follow_better_with_the_torque_that_they_will_need() {
    let [without, with] = compared("drive=dc", true, &[]);
    assert!(largest(&without) > 10.0 * largest(&with), "{without:?} and {with:?} degrees");
}

/// The torque of an asynchronous machine follows its slip with the flux and the resonances of the machine in between:
/// less is won, on the axes that need the least slip nothing.
#[test]
fn asynchronous_machines_follow_no_worse_and_where_friction_rules_better() {
    let [without, with] = compared("drive=asm", true, &[]);
    for (axis, (without, with)) in (1..=6).zip(without.iter().zip(&with)) {
        assert!(*with < 1.05 * without, "axis {axis}: {without} and {with} degrees");
    }
    assert!(without[5] > 1.5 * with[5], "{without:?} and {with:?} degrees");
}

#[test]
fn machines_with_a_speed_control_of_their_own_find_their_slip_themselves() {
    let [without, with] = compared("drive=asm", true, &["speed_control=slip"]);
    assert_eq!(without, with);
}

/// The structures of control of one arm: what each further value that a controller sees is worth.
#[test]
fn four_structures_of_control_follow_in_their_order() {
    let [siso, miso, simo, mimo] = ["siso", "miso", "simo", "mimo"].map(|structure| {
        let run = run_file(TWO_LINKS, &[&format!("structure={structure}")]);
        assert!(run.error.is_none(), "{:?}", run.error);
        [1, 2].map(|joint| apart(&run, &format!("angle{joint}.set"), &format!("angle{joint}.actual")))
    });
    for joint in 0..2 {
        let errors = [simo[joint], siso[joint], miso[joint], mimo[joint]];
        assert!(errors.is_sorted_by(|a, b| a > b), "joint {}: {errors:?} degrees", joint + 1);
    }
    assert!(largest(&mimo) < 0.02 && largest(&siso) > 1.0, "{mimo:?}, {siso:?} degrees");
}
