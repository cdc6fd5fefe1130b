//! Torques computed for the whole arm, fed forward to the controllers of its joints.

use blocksim_block::schedule::{Keep, Recorded};
use blocksim_blocks::robotics::RobotDescription;
use blocksim_diagram::{Sources, parameter};
use blocksim_signal::Kind;
use blocksim_tests::{Desk, Run, compile_file, root, run, run_file};

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

/// Mass, centre, moments and products of a body.
type Solid = (f64, [f64; 3], [f64; 3], [f64; 3]);

/// Two bodies as one, by the theorem of parallel axes.
fn joined(bodies: [Solid; 2]) -> Solid {
    let mass = bodies[0].0 + bodies[1].0;
    let com = [0, 1, 2].map(|k| (bodies[0].0 * bodies[0].1[k] + bodies[1].0 * bodies[1].1[k]) / mass);
    let (mut moi, mut poi) = ([0.0; 3], [0.0; 3]);
    for (m, at, own, products) in bodies {
        let [x, y, z] = [0, 1, 2].map(|k| at[k] - com[k]);
        let shift = [y * y + z * z, z * z + x * x, x * x + y * y];
        let crossed = [-y * z, -z * x, -x * y];
        (0..3).for_each(|k| {
            moi[k] += own[k] + m * shift[k];
            poi[k] += products[k] + m * crossed[k];
        });
    }
    (mass, com, moi, poi)
}

/// A payload acts on the arm, on the torques that are computed for it and on the description, as a heavier torch would.
#[test]
fn a_payload_acts_as_if_it_were_a_part_of_the_torch() {
    let torch = (
        5.25,
        [0.0892, 0.0066, 0.11276],
        [0.001_989_3, 0.011_592, 0.012_38],
        [-9.379e-5, 0.000_434_9, 0.002_703],
    );
    let payload = (5.0, [0.02, -0.01, 0.25], [0.02, 0.03, 0.02], [0.001, -0.002, 0.0005]);
    let set = |body: &str, (mass, com, moi, poi): Solid| {
        let list =
            |name: &str, v: [f64; 3]| format!("robot.{body}.{name}=[{:e}, {:e}, {:e}]", v[0], v[1], v[2]);
        [format!("robot.{body}.mass={mass}"), list("com", com), list("moi", moi), list("poi", poi)]
    };
    let run = |body: &[String]| {
        let words = ["drive=torque", "control=central"].into_iter().chain(body.iter().map(String::as_str));
        let run = run_file(ROBOT, &words.collect::<Vec<_>>());
        assert!(run.error.is_none(), "{:?}", run.error);
        run
    };
    let (empty, carrying, heavier) =
        (run(&[]), run(&set("payload", payload)), run(&set("torch", joined([torch, payload]))));
    for axis in 1..=6 {
        let group = if axis <= 3 { "principal" } else { "minor" };
        let name = format!("measurements/torques/{group}.axis{axis}");
        let column = |run: &Run| (0..200).map(|n| run.at(&name, 0.01 * f64::from(n))).collect::<Vec<f64>>();
        let (none, own, other) = (column(&empty), column(&carrying), column(&heavier));
        let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let size = own.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        // Both runs take their own steps at a tolerance of 5e-4.
        assert!(apart(&own, &other) < 2e-3 * size, "axis {axis}: {} of {size}", apart(&own, &other));
        assert!(axis == 6 || apart(&own, &none) > 2e-2 * size, "axis {axis} does not feel it");
    }
    let knows = largest(&errors(&["drive=torque", "control=central", "robot.payload.mass=5"]));
    let guesses = largest(&errors(&["drive=torque", "control=central", "arm/end_effector/payload.mass=5"]));
    assert!(guesses > 5.0 * knows, "{guesses} and {knows} degrees");
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

/// The plug-in gets its numbers one by one, commands and blocks get the description: both ask the same of the motors.
#[test]
fn the_plug_in_and_the_description_ask_the_same_torques_of_the_motors() {
    let (compiled, problems) = compile_file(ROBOT, &["drive=torque", "control=central"]);
    let mut schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    let cell = |path: &str, element: usize| {
        let signal = schedule.signals.iter().find(|signal| signal.path == path);
        let cell = signal.unwrap_or_else(|| panic!("there is a signal {path}")).offset + element;
        Recorded {
            path: format!("{path}[{element}]"),
            cell,
            kind: Kind::Real,
            dimension: None,
            display: None,
            title: Vec::new(),
            legend: None,
            over: None,
            keep: Keep::All,
            held: false,
        }
    };
    let set =
        |port: &str| (1..=6).map(|axis| cell(&format!("control/joint{axis}/reference.{port}"), 0)).collect();
    let groups: [Vec<Recorded>; 4] = [
        set("q"),
        set("qd"),
        set("qdd"),
        (0..6).map(|axis| cell("control/feedforward/arm.tau", axis)).collect(),
    ];
    schedule.recorded = groups.concat();
    let run = run(schedule);
    assert!(run.error.is_none(), "{:?}", run.error);

    let desk = Desk::new();
    let read: Result<RobotDescription, _> =
        parameter(&Sources::new(&desk), &root().join(ROBOT), &[], "manipulator");
    let description = read.expect("a description");
    let robot = description.robot("manipulator").expect("a robot");
    let ratios: Vec<f64> =
        description.links.iter().map(|link| link.transmission("manipulator").expect("a gear")).collect();
    let (mut data, mut tau, mut rows, mut largest) = (robot.model().data(), [0.0; 6], 0, 0.0_f64);
    for (row, t) in run.time.iter().enumerate() {
        // What the plug-in gives is held between its samples.
        if (t / 1e-3 - (t / 1e-3).round()).abs() > 1e-6 {
            continue;
        }
        let of =
            |group: usize| -> Vec<f64> { (0..6).map(|axis| run.columns[6 * group + axis][row]).collect() };
        robot.motor_torques(&mut data, &of(0), &of(1), &of(2), &mut tau);
        for (axis, given) in of(3).iter().enumerate() {
            let wanted = tau[axis] / ratios[axis];
            largest = largest.max(wanted.abs());
            assert!((wanted - given).abs() < 1e-9, "axis {} at {t} s: {given} and {wanted} N*m", axis + 1);
        }
        rows += 1;
    }
    assert!(rows > 2000 && largest > 1.0, "{rows} rows, {largest} N*m");
}
