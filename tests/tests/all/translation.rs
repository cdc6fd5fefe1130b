//! Parts that slide and stick: what is held stands still exactly, and slides by its closed form beyond.

use blocksim_tests::{Run, run_text};

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}, allowed are {tolerance}");
}

/// A mass of 2 kg on a guide that holds 10 N and brakes with 8 N, pushed for one second.
fn pushed(force: &str) -> Run {
    run_text(&format!(
        r#"Diagram(
            simulation: (stop_time: "1 s", solver: Ode45(rtol: 1e-9)),
            blocks: {{
                "push": ConstantForce(f: "{force}"),
                "mass": Mass(m: "2 kg"),
                "guide": TranslationalFriction(
                    breakaway: "10 N", breakaway_velocity: "0 m/s", coulomb: "8 N", model: Stiction,
                ),
                "scale": TranslationalMotionSensor,
                "bed": TranslationalReference,
                "x": Scope(inputs: ["x"]),
            }},
            connections: [
                "push.r <-> mass.r <-> guide.r <-> scale.r",
                "push.c <-> guide.c <-> scale.c <-> bed.r",
                "scale.x -> x.x",
            ],
        )"#
    ))
}

#[test]
fn a_guide_holds_a_mass_exactly_up_to_its_breakaway_force() {
    assert!(pushed("9.9 N").column("x.x").iter().all(|x| *x == 0.0));
    assert!(pushed("-9.9 N").column("x.x").iter().all(|x| *x == 0.0));
    close(pushed("12 N").last("x.x"), (12.0 - 8.0) / 2.0 / 2.0, 1e-8);
    close(pushed("-11 N").last("x.x"), -(11.0 - 8.0) / 2.0 / 2.0, 1e-8);
}

/// Position of a table of 20 kg on a screw of 10 mm lead after one second, with a constant torque at the screw.
fn hung(screw: &str, torque: &str) -> Run {
    run_text(&format!(
        r#"Diagram(
            simulation: (stop_time: "1 s", solver: Ode45(rtol: 1e-9)),
            blocks: {{
                "turn": ConstantTorque(tau: "{torque}"),
                "rotor": Inertia(j: "1e-3 kg*m^2"),
                "screw": {screw},
                "table": Mass(m: "20 kg"),
                "weight": ConstantForce(f: "-200 N"),
                "scale": TranslationalMotionSensor,
                "housing": RotationalReference,
                "column": TranslationalReference,
                "x": Scope(inputs: ["x"]),
            }},
            connections: [
                "turn.r <-> rotor.r <-> screw.base",
                "turn.c <-> housing.r",
                "screw.follower <-> table.r <-> weight.r <-> scale.r",
                "weight.c <-> scale.c <-> column.r",
                "scale.x -> x.x",
            ],
        )"#
    ))
}

#[test]
fn a_screw_that_locks_itself_holds_its_load_and_is_driven_both_ways() {
    let screw =
        r#"LeadScrew(lead: "10 mm", efficiency_forward: 0.4, efficiency_backward: -0.5, loss: Stiction)"#;
    let lead = 0.01 / std::f64::consts::TAU;
    // Torque without losses, N*m: lifting takes it over 0.4, lowering half of it.
    let ideal = 200.0 * lead;
    assert!(hung(screw, "0 N*m").column("x.x").iter().all(|x| *x == 0.0), "held without a motor");
    assert!(
        hung(screw, "-0.15 N*m").column("x.x").iter().all(|x| *x == 0.0),
        "lowering takes {} N*m",
        0.5 * ideal
    );
    let lifted = lead * (1.5 - ideal / 0.4) / (1e-3 + 20.0 * lead * lead / 0.4) / 2.0;
    close(hung(screw, "1.5 N*m").last("x.x"), lifted, 1e-8);
    let lowered = lead * (-0.3 + 0.5 * ideal) / (1e-3 - 20.0 * lead * lead * 0.5) / 2.0;
    close(hung(screw, "-0.3 N*m").last("x.x"), lowered, 1e-8);
}

#[test]
fn a_screw_without_self_locking_lets_its_load_drive_it() {
    let screw = r#"LeadScrewByFriction(lead: "10 mm", diameter: "18 mm", friction: 0.08, loss: Stiction)"#;
    let slope = 0.01 / (std::f64::consts::PI * 0.018);
    let backward = (slope - 0.08) / (1.0 + 0.08 * slope) / slope;
    let lead = 0.01 / std::f64::consts::TAU;
    let fallen = -lead * 200.0 * lead * backward / (1e-3 + 20.0 * lead * lead * backward) / 2.0;
    close(hung(screw, "0 N*m").last("x.x"), fallen, 1e-8);
}
