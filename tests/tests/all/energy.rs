//! Every diagram of the project keeps its account of energy: with an account in each of its physical networks and a
//! tight tolerance, no error is larger than 1e-6 of the energy turned over.

use std::path::{Path, PathBuf};

use blocksim_block::schedule::{Schedule, VariableMethod};
use blocksim_tests::accounts::{imbalance, solved_by, with_accounts};
use blocksim_tests::{compile_text, root, run, run_text};

/// A diagram with an account in each of its networks; `inside` names their ports.
fn diagram(path: &Path, inside: &Path, overrides: &[&str]) -> Option<Schedule> {
    let text = std::fs::read_to_string(inside).expect("a diagram");
    with_accounts(path, inside, &text, overrides)
}

fn diagrams() -> Vec<PathBuf> {
    let files = std::fs::read_dir(root().join("diagrams")).expect("the diagrams");
    let mut paths: Vec<PathBuf> = files.map(|file| file.expect("a file").path()).collect();
    paths.retain(|path| {
        let is_diagram = || std::fs::read_to_string(path).is_ok_and(|text| text.contains("Diagram("));
        path.extension().is_some_and(|e| e == "ron") && is_diagram()
    });
    paths.sort();
    paths
}

#[test]
fn the_energy_of_every_diagram_balances() {
    let (mut found, mut physical) = (Vec::new(), 0);
    for path in diagrams() {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let Some(mut shipped) = diagram(&path, &path, &[]) else { continue };
        physical += 1;
        // Thousands of switchings, and hundreds of the same duty cycles of a motor, take as long as all other diagrams.
        let longest = match name.as_str() {
            "inverter_fed_machine.ron" => 0.5,
            "motor_heat.ron" => 300.0,
            _ => f64::INFINITY,
        };
        shipped.settings.stop_time = shipped.settings.stop_time.min(longest);
        let tight = imbalance(&run(solved_by(shipped.clone(), VariableMethod::Ode45, 1e-9)));
        // As the diagrams are, the tolerances of their solvers tell: from 1e-5 to 1e-10.
        let shipped = imbalance(&run(shipped));
        if tight > 1e-6 || shipped > 2e-5 {
            found.push(format!("{name}: {tight:e}, as shipped {shipped:e}"));
        }
    }
    assert!(physical > 15, "only {physical} diagrams have a physical network");
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The robot with its drives, over the part of its move in which all axes accelerate.
#[test]
fn the_energy_of_the_robot_balances_with_all_its_drives() {
    let folder = root().join("diagrams/irb2600");
    let mut found = Vec::new();
    for drive in ["asm", "asm_switched", "dc", "torque"] {
        let set = format!("drive={drive}");
        let accounts = diagram(&folder.join("irb2600.ron"), &folder.join("robot.ron"), &[&set]);
        let mut schedule = accounts.expect("a network");
        // Thousands of switchings take as long as the rest, and a third of them is enough.
        schedule.settings.stop_time = if drive == "asm_switched" { 0.4 } else { 1.0 };
        let shipped = imbalance(&run(schedule.clone()));
        let tight = imbalance(&run(solved_by(schedule, VariableMethod::RosW3, 1e-7)));
        if tight > 1e-6 || shipped > 1e-4 {
            found.push(format!("{drive}: {tight:e}, as shipped {shipped:e}"));
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Charge flows from one capacitor to another: whatever the contact resists, `1/2 C1 C2/(C1 + C2) v^2` becomes heat.
#[test]
fn what_is_lost_between_two_capacitors_does_not_depend_on_the_contact() {
    for resistance in ["1 Ohm", "10 mOhm"] {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "50 ms", solver: Ode45(rtol: 1e-10, atol: 1e-10)),
                blocks: {{
                    "g": ElectricalReference, "a": Capacitor(c: "3 mF", v0: "12 V"), "b": Capacitor(c: "1 mF"),
                    "k": IdealSwitch(r_on: "{resistance}"), "step": Step(time: "5 ms"),
                    "on": Compare(operator: Greater, constant: 0.5),
                    "account": EnergyAccount(at: Electrical, tolerance: 1e-9),
                    "s": Scope(inputs: ["stored", "dissipated"]),
                }},
                connections: [
                    "a.n <-> b.n <-> g.p", "a.p <-> k.p <-> account.node", "k.n <-> b.p",
                    "step.y -> on.u", "on.y -> k.gate", "account.stored -> s.stored",
                    "account.dissipated_energy -> s.dissipated",
                ],
            )"#
        ));
        let lost = 0.5 * 3e-3 * 1e-3 / 4e-3 * 144.0;
        assert!((run.last("s.dissipated") - lost).abs() < 1e-9, "{}", run.last("s.dissipated"));
        assert!((run.last("s.stored") - 0.5 * 3e-3 * 144.0 + lost).abs() < 1e-9);
    }
}

/// A load that a pendulum lets go of takes its energy along; one that it takes up brings it.
#[test]
fn payloads_bring_and_take_energy_where_they_are_taken_up_and_let_go() {
    let run = run_text(
        r#"Diagram(
            simulation: (stop_time: "2 s", solver: Ode45(rtol: 1e-10, atol: 1e-10)),
            blocks: {
                "world": World, "pivot": RevoluteJoint(axis: [0.0, 1.0, 0.0], damping: 0.1),
                "rod": Body(mass: "1 kg", com: [0.5, 0.0, 0.0], moi: [0.0, 0.1, 0.1]),
                "arm": Transform(translation: [1.0, 0.0, 0.0]), "load": Payload(mass: "2 kg"),
                "held": Pulse(period: "0.5 s", width: 0.5), "is": Compare(operator: Greater, constant: 0.5),
                "account": EnergyAccount(at: Frame, tolerance: 1e-7),
                "s": Scope(inputs: ["supplied", "power", "q", "w", "error"]),
            },
            connections: [
                "world.frame <-> pivot.base <-> account.node", "pivot.follower <-> rod.frame <-> arm.base",
                "arm.follower <-> load.frame", "held.y -> is.u", "is.y -> load.attached",
                "account.supplied_energy -> s.supplied", "account.supplied -> s.power", "pivot.q -> s.q",
                "pivot.w -> s.w", "account.error -> s.error",
            ],
        )"#,
    );
    let column = |name: &str| run.column(&format!("s.{name}"));
    assert!(column("power").iter().all(|power| *power == 0.0));
    let mut changes = 0;
    for k in 1..run.time.len() {
        let booked = column("supplied")[k] - column("supplied")[k - 1];
        if booked != 0.0 {
            changes += 1;
            // 2 kg at 1 m, which the axis y turns downward.
            let energy = 0.5 * 2.0 * column("w")[k].powi(2) - 2.0 * 9.80665 * column("q")[k].sin();
            let sign = if changes % 2 == 1 { -1.0 } else { 1.0 };
            assert!((booked - sign * energy).abs() < 1e-9 * energy.abs().max(1.0), "{booked} != {energy}");
        }
    }
    assert!(changes >= 6, "{changes} changes");
    assert!(column("error").iter().all(|error| error.abs() < 1e-6));
}

fn spring_with(account: &str) -> String {
    format!(
        r#"Diagram(
            simulation: (stop_time: "5 s", solver: Ode45(rtol: 1e-3)),
            blocks: {{
                "disc": Inertia(j: "1 kg*m^2", w0: "1 rad/s"), "spring": RotationalSpring(k: 100.0),
                "wall": RotationalReference, "account": {account},
            }},
            connections: ["disc.r <-> spring.r", "spring.c <-> wall.r", "disc.r <-> account.node"],
        )"#
    )
}

#[test]
fn a_balance_that_is_off_ends_the_run_and_tells_by_how_much() {
    let (compiled, problems) = compile_text(&spring_with("EnergyAccount(tolerance: 1e-9)"));
    let failed = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}"))).error.expect("a failure");
    assert_eq!(failed.code, "block_failed");
    let expected = ["the account `account` does not balance", "1.0e-9 are allowed", "make `rtol`"];
    for part in expected {
        assert!(failed.message.contains(part), "{}", failed.message);
    }
    let (compiled, _) = compile_text(&spring_with("EnergyAccount(tolerance: None)"));
    assert!(run(compiled.schedule.expect("a diagram")).error.is_none());
}

#[test]
fn an_account_that_is_connected_to_nothing_is_refused() {
    let text = spring_with("EnergyAccount").replace(r#", "disc.r <-> account.node""#, "");
    let (_, problems) = compile_text(&text);
    assert!(problems.contains("the rotational port `account.node` is not connected"), "{problems}");
}

/// The diagram of the guide: two equal discs, one turns with 100 rad/s.
#[test]
fn the_diagram_of_the_guide_loses_half_of_its_energy() {
    let guide = std::fs::read_to_string(root().join("docs/energy.md")).expect("the guide");
    let text = guide.split("```ron\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a diagram");
    let run = run_text(text);
    assert!((run.last("show.stored") - 2500.0).abs() < 1e-6, "{}", run.last("show.stored"));
    assert!((run.last("show.heat") - 2500.0).abs() < 1e-6, "{}", run.last("show.heat"));
}
