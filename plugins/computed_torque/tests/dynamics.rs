//! The torques of the plug-in against those of the crate of mechanisms, and what it refuses.

use blocksim_controller::testing::Bench;
use blocksim_multibody::{Inertia, Joint, ModelBuilder, Placement, rnea};
use blocksim_plugin_computed_torque::table;

/// A link: origin, axis, mass, com, moi, poi.
type Link = ([f64; 3], [f64; 3], f64, [f64; 3], [f64; 3], [f64; 3]);

const LINKS: [Link; 6] = [
    ([0.0, 0.0, 0.4], [0.0, 0.0, 1.0], 70.0, [0.04, 0.01, -0.07], [1.2, 1.8, 1.6], [-0.01, -0.14, -0.03]),
    ([0.15, 0.0, 0.0], [0.0, 2.0, 0.0], 43.0, [0.0, -0.17, 0.42], [3.1, 3.1, 0.13], [0.02, 0.0, 0.0]),
    ([0.0, 0.0, 0.9], [0.0, 1.0, 0.0], 65.0, [0.04, 0.01, 0.07], [0.8, 1.1, 0.95], [0.03, -0.05, 0.02]),
    ([0.0, 0.02, 0.1], [1.0, 0.0, 0.0], 17.0, [0.6, 0.0, 0.0], [0.04, 0.48, 0.49], [0.0, 0.0, -0.004]),
    ([0.8, 0.0, 0.0], [0.0, 1.0, 0.3], 1.0, [0.0, 0.0, 0.001], [8e-4, 1.4e-3, 9e-4], [0.0, 0.0, 0.0]),
    ([0.08, 0.0, 0.0], [1.0, 0.0, 0.0], 0.3, [-0.04, 0.0, 0.0], [6e-5, 3.6e-4, 3.6e-4], [0.0, 0.0, 0.0]),
];
const TOOL: Link =
    ([0.01, 0.02, 0.03], [0.1, 1.5, -0.4], 5.0, [0.1, 0.0, 0.1], [2e-3, 0.012, 0.012], [0.0, 4e-4, 3e-3]);
const GRAVITY: [f64; 3] = [0.5, -0.3, -9.7];

type Numbers = Vec<(&'static str, Vec<f64>)>;

fn mechanism(links: usize) -> Numbers {
    let names = ["1", "2", "3", "4", "5", "6"];
    let mut all = Numbers::new();
    for (i, (origin, axis, mass, com, moi, poi)) in LINKS.iter().enumerate().take(links) {
        let name = |of: &str| -> &'static str { format!("{of}{}", names[i]).leak() };
        all.push((name("origin"), origin.to_vec()));
        all.push((name("axis"), axis.to_vec()));
        all.push((name("mass"), vec![*mass]));
        all.push((name("com"), com.to_vec()));
        all.push((name("moi"), moi.to_vec()));
        all.push((name("poi"), poi.to_vec()));
    }
    all.push(("tool_at", TOOL.0.to_vec()));
    all.push(("tool_rpy", TOOL.1.to_vec()));
    all.push(("tool_mass", vec![TOOL.2]));
    all.push(("tool_com", TOOL.3.to_vec()));
    all.push(("tool_moi", TOOL.4.to_vec()));
    all.push(("tool_poi", TOOL.5.to_vec()));
    all.push(("gravity", GRAVITY.to_vec()));
    all
}

fn bench(kind: &str, numbers: &Numbers) -> Result<Bench, String> {
    let places = numbers.iter().flat_map(|(name, numbers)| {
        let place =
            move |i: usize| if numbers.len() == 1 { (*name).to_owned() } else { format!("{name}.{i}") };
        numbers.iter().enumerate().map(move |(i, number)| (place(i), *number))
    });
    let places: Vec<(String, f64)> = places.collect();
    let places: Vec<(&str, f64)> = places.iter().map(|(name, number)| (name.as_str(), *number)).collect();
    Bench::new(table(), kind, &places).map_err(|failure| failure.message)
}

/// The same arm, its torques by the crate of mechanisms.
fn reference(links: usize, q: &[f64], v: &[f64], a: &[f64]) -> Vec<f64> {
    let mut builder = ModelBuilder::new();
    builder.gravity(GRAVITY);
    let mut last = None;
    for (origin, axis, mass, com, moi, poi) in LINKS.iter().take(links) {
        let inertia = Inertia::from_moments(*mass, *com, *moi, *poi).unwrap();
        let at = Placement::from_translation(*origin);
        last = Some(builder.add_body(last, Joint::revolute(*axis), at, inertia).unwrap());
    }
    let tool = Inertia::from_moments(TOOL.2, TOOL.3, TOOL.4, TOOL.5).unwrap();
    builder.add_inertia(last.unwrap(), Placement::from_rpy(TOOL.0, TOOL.1), tool).unwrap();
    let model = builder.build();
    let mut tau = vec![0.0; links];
    rnea(&model, &mut model.data(), q, v, a, &mut tau);
    tau
}

/// Numbers between -1 and 1 that look random.
fn noise(k: usize, i: usize) -> f64 {
    ((12.9898 * k as f64 + 78.233 * i as f64).sin() * 43_758.545).fract()
}

#[test]
fn torques_of_any_motion_are_those_of_the_mechanism() {
    for (kind, n) in [("ComputedTorque", 6), ("ComputedTorque2", 2)] {
        let mut plugin = bench(kind, &mechanism(n)).unwrap();
        for k in 0..200 {
            let u: Vec<f64> = (0..3 * n).map(|i| 3.0 * noise(k, i)).collect();
            let expected = reference(n, &u[..n], &u[n..2 * n], &u[2 * n..]);
            let largest = expected.iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
            for (tau, expected) in plugin.outputs(0.0, &u).unwrap().iter().zip(&expected) {
                assert!((tau - expected).abs() < 1e-12 * largest, "{kind}: {tau} N m, not {expected} N m");
            }
        }
    }
}

#[test]
fn drives_add_rotor_bearing_and_gear() {
    let mut numbers = mechanism(2);
    numbers.extend([
        ("ratio", vec![100.0, 50.0]),
        ("inertia", vec![1e-3, 2e-3]),
        ("damping", vec![1e-4, 2e-4]),
        ("efficiency_forward", vec![0.8, 0.7]),
        ("efficiency_backward", vec![0.75, 0.6]),
        ("breakaway", vec![30.0, 20.0]),
        ("breakaway_velocity", vec![0.01, 0.02]),
        ("coulomb", vec![20.0, 10.0]),
        ("viscous", vec![5.0, 6.0]),
    ]);
    let mut plugin = bench("ComputedTorque2", &numbers).unwrap();
    let (q, v, a) = ([0.3, 0.4], [1.0, -0.8], [2.0, 3.0]);
    let links = reference(2, &q, &v, &a);
    let tau = plugin.outputs(0.0, &[q, v, a].concat()).unwrap();
    // Far above the breakaway velocity: Coulomb and viscous friction alone.
    let first = (links[0] + 20.0 + 5.0) / 100.0;
    let first = if first > 0.0 { first / 0.8 } else { first * 0.75 } + 1e-3 * 200.0 + 1e-4 * 100.0;
    let second = (links[1] - 10.0 - 4.8) / 50.0;
    let second = if second < 0.0 { second / 0.7 } else { second * 0.6 } + 2e-3 * 150.0 - 2e-4 * 40.0;
    for (tau, expected) in tau.iter().zip([first, second]) {
        assert!((tau - expected).abs() < 1e-12, "{tau} N m, not {expected} N m");
    }
}

#[test]
fn a_set_value_that_is_no_number_is_not_hidden() {
    let mut plugin = bench("ComputedTorque2", &mechanism(2)).unwrap();
    assert!(plugin.outputs(0.0, &[f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap()[0].is_nan());
}

#[test]
fn parameters_without_sense_are_refused_by_name() {
    let refused = |name: &'static str, value: &[f64]| {
        let mut numbers = mechanism(2);
        numbers.retain(|(known, _)| *known != name);
        numbers.push((name, value.to_vec()));
        bench("ComputedTorque2", &numbers).unwrap_err()
    };
    assert_eq!(refused("axis2", &[0.0; 3]), "`axis2` is zero, it must have a direction");
    assert_eq!(refused("ratio", &[100.0, 0.0]), "`ratio[1]` is 0, it must be finite and positive");
    assert_eq!(refused("com1", &[0.0, f64::NAN, 0.0]), "`com1[1]` is NaN, it must be finite");
    assert_eq!(refused("mass2", &[-1.0]), "`mass2` is -1, it must be finite and not negative");
    assert_eq!(
        refused("efficiency_forward", &[1.2, 1.0]),
        "`efficiency_forward[0]` is 1.2, an efficiency is above 0 and at most 1"
    );
    assert_eq!(refused("viscous", &[1.0, -2.0]), "`viscous[1]` is -2, it must be finite and not negative");
}
