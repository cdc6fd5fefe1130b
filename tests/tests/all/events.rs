//! Events name the part and what it does: `relay switches on`.

use std::collections::BTreeSet;

use blocksim_block::event::{Changes, Event};
use blocksim_block::physical::Element;
use blocksim_block::{Block, Discrete, Given, Guard, Interface, kinds};
use blocksim_diagram::example_block;
use blocksim_tests::{run_file, run_text};
use expect_test::{Expect, expect};

/// Texts beside the examples: parameters that add guards.
const MORE: [&str; 23] = [
    "Integrator(lower: -1, upper: 1)",
    "Integrator(wrap: (lower: -1, upper: 1))",
    "Integrator(reset: Rising)",
    "Pid(kp: 1, lower: -1, upper: 1, anti_windup: Clamping)",
    "Compare(operator: Less)",
    "Switch(threshold: 1)",
    "Function(function: SignedSqrt)",
    "LookupTable1D(breakpoints: [0, 1, 2], table: [0, 1, 4])",
    "LookupTable1D(breakpoints: [0, 1, 2], table: [0, 1, 4], interpolation: Flat)",
    "LookupTable2D(rows: [0, 1, 2], columns: [0, 1, 2], table: [[0, 1, 4], [0, 2, 3], [5, 6, 9]])",
    r#"StepperDriver(command: Angle(teeth: 50), amplitude: "2 A")"#,
    r#"PwmGenerator(switching_frequency: "5 kHz", sampling: Natural)"#,
    r#"PwmGenerator(switching_frequency: "5 kHz", modulation: Discontinuous60, sampling: Natural)"#,
    r#"HBridgePwm(switching_frequency: "5 kHz", scheme: Unipolar, sampling: Natural)"#,
    "RotationalSpringDamper(k: 300.0, d: 2.0, backlash: 0.6, transition: 0.5)",
    "TranslationalSpringDamper(k: 300.0, d: 2.0, backlash: 0.6, transition: 0.5)",
    "ElasticGear(ratio: 50.0, k: 1e4, d: 10.0, backlash: 0.3, transition: 0.4)",
    "RotationalHardStop(lower: -0.3, upper: 0.2, stiffness: 500.0, damping: 30.0, transition: 0.3)",
    "TranslationalHardStop(lower: -0.3, upper: 0.2, stiffness: 500.0, damping: 30.0, transition: 0.3)",
    "RevoluteJoint(lower: -0.2, upper: 0.3, limit_transition: 0.4)",
    "PrismaticJoint(lower: -0.2, upper: 0.3, limit_transition: 0.4)",
    "PointPlaneContact(stiffness: 1e3, damping: 30.0, transition: 0.5)",
    r#"MinMax(function: Max, inputs: 3)"#,
];

/// Kinds that have guards or modes: who adds one adds it here, and none may get lost.
const WATCHED: [&str; 55] = [
    "Abs",
    "Accumulator",
    "Atan2",
    "Backlash",
    "Brake",
    "CheckValve",
    "ChopperControl",
    "Clutch",
    "Compare",
    "Counter",
    "DeadZone",
    "DirectionReverser",
    "DirectionalValve",
    "DutyCycles",
    "ElasticGear",
    "ExponentialDiode",
    "Function",
    "HBridgePwm",
    "HitCrossing",
    "HydraulicCylinder",
    "IfElse",
    "Integrator",
    "LinearSolve",
    "LookupTable1D",
    "LookupTable2D",
    "MinMax",
    "MultiportSwitch",
    "OneWayClutch",
    "Pid",
    "PointPlaneContact",
    "PrismaticJoint",
    "PwmGenerator",
    "Quantizer",
    "RateLimiter",
    "Relay",
    "ReliefValve",
    "RevoluteJoint",
    "Robot",
    "RotationalFriction",
    "RotationalHardStop",
    "RotationalRigidStop",
    "RotationalSpringDamper",
    "Saturation",
    "Sign",
    "SlipControlledVf",
    "StepperDriver",
    "Switch",
    "SwitchCase",
    "TranslationalFriction",
    "TranslationalHardStop",
    "TranslationalRigidStop",
    "TranslationalSpringDamper",
    "VariableOrifice",
    "VariableTransportDelay",
    "Varistor",
];

/// The guards and discrete states of a block, and the words for its friction.
fn conditions(block: &dyn Block) -> Option<(Interface, bool)> {
    match block.component() {
        Some(component) => {
            let part = component.part(&Given::nothing());
            let sticks = part.elements.iter().any(|element| matches!(element, Element::Friction { .. }));
            let mut interface = part.clone().interface();
            if sticks {
                let changes = Changes { table: part.friction.0, ..Changes::default() };
                let mut mode = Discrete::new("mode", 0.0);
                mode.changes = Some(Box::new(changes));
                interface.discrete.push(mode);
            }
            Some((interface, sticks))
        }
        None => Some((block.interface(&Given::nothing()).ok()?, false)),
    }
}

/// Whether words read behind the name of a part: a verb in the third person first, and no more than a few.
fn reads(words: &str) -> bool {
    let verb = words.split(' ').next().unwrap_or_default();
    let is_verb = verb.len() > 1 && verb.ends_with('s') && verb.chars().all(|c| c.is_ascii_lowercase());
    is_verb && words.len() <= 50 && !words.contains('_') && !words.ends_with('.')
}

fn phrases(interface: &Interface) -> Vec<&'static str> {
    let of_guard = |guard: &Guard| match guard.event {
        Event::Crossing { upwards, downwards } => vec![upwards, downwards],
        Event::Name | Event::Mode | Event::Bend => Vec::new(),
    };
    let changes = interface.discrete.iter().filter_map(|state| state.changes.as_ref());
    let of_modes = changes.flat_map(|changes| changes.table.iter().map(|change| change.phrase));
    interface.guards.iter().flat_map(of_guard).chain(of_modes).collect()
}

#[test]
fn every_guard_of_every_kind_has_words() {
    let mut watched = BTreeSet::new();
    let more = MORE.iter().map(|text| (text.split('(').next().unwrap_or_default(), (*text).to_owned()));
    let examples = kinds().into_iter().flat_map(|info| {
        info.examples().into_iter().map(move |example| {
            let at = example.find(&format!("{}(", info.kind)).or(example.find(info.kind)).unwrap_or_default();
            (info.kind, example[at..].trim_end_matches(',').to_owned())
        })
    });
    for (kind, text) in more.chain(examples) {
        let Some(block) = example_block(&text) else {
            assert!(!MORE.contains(&text.as_str()), "{text} is not a block");
            continue;
        };
        let Some((interface, sticks)) = conditions(&*block) else {
            assert!(!MORE.contains(&text.as_str()), "{text} has no interface by itself");
            continue;
        };
        if interface.guards.is_empty() && !sticks {
            continue;
        }
        watched.insert(kind);
        let has_modes = interface.discrete.iter().any(|state| state.changes.is_some());
        for guard in &interface.guards {
            let name = &guard.name;
            assert_ne!(guard.event, Event::Name, "{kind}: the guard `{name}` has no words for its events");
            let told = has_modes || interface.jumps && !interface.jump_phrase.0.is_empty();
            assert!(guard.event != Event::Mode || told, "{kind}: nothing has words for the guard `{name}`");
        }
        for phrase in phrases(&interface) {
            assert!(phrase.is_empty() || reads(phrase), "{kind}: `part {phrase}` is not a sentence");
        }
    }
    let lost: Vec<&&str> = WATCHED.iter().filter(|kind| !watched.contains(*kind)).collect();
    assert!(lost.is_empty(), "nobody has looked at the guards of {lost:?}; seen are {watched:?}");
    let new: Vec<&&str> = watched.iter().filter(|kind| !WATCHED.contains(kind)).collect();
    assert!(new.is_empty(), "not in the list of kinds with guards: {new:?}");
}

#[test]
fn names_of_guards_are_not_sentences() {
    assert!(["switches on", "is carried upwards", "conducts"].iter().all(|words| reads(words)));
    assert!(["upper", "zero", "switch", "row above", "d1.conducts", ""].iter().all(|words| !reads(words)));
}

/// The first events of a run, one a line.
fn listed(events: &[(f64, String, String)], count: usize, expected: &Expect) {
    let lines = events.iter().take(count).map(|(t, path, what)| format!("{t:.4} {path} {what}\n"));
    expected.assert_eq(&lines.collect::<String>());
}

#[test]
fn events_of_shipped_diagrams_read_as_sentences() {
    let expected = [
        (
            "diagrams/rectifier_bridge.ron",
            expect![[r#"
                0.0000 bridge blocks (valve 4)
                0.0033 bridge conducts (valve 3)
                0.0038 bridge blocks (valve 1)
                0.0067 bridge conducts (valve 2)
                0.0073 bridge blocks (valve 6)
                0.0100 bridge conducts (valve 5)
            "#]],
        ),
        (
            "diagrams/bouncing_mass.ron",
            expect![[r#"
            1.4281 velocity is reset
            3.7130 velocity is reset
            5.5410 velocity is reset
            7.0033 velocity is reset
            8.1732 velocity is reset
            9.1091 velocity is reset
        "#]],
        ),
        (
            "diagrams/stick_slip.ron",
            expect![[r#"
            0.1500 bearing slips forward
            0.2257 bearing sticks
            0.3457 bearing slips forward
            0.4214 bearing sticks
            0.5414 bearing slips forward
            0.6171 bearing sticks
        "#]],
        ),
        (
            "diagrams/coupled_clutches.ron",
            expect![[r#"
            0.5000 first locks
            1.0000 second slips forward
            2.0000 second locks
            2.5000 first opens
        "#]],
        ),
    ];
    for (path, expected) in expected {
        let events = run_file(path, &[]).events;
        assert!(events.iter().all(|(_, _, what)| reads(what)), "{path}: {events:?}");
        listed(&events, 6, &expected);
    }
}

#[test]
fn events_of_vectors_and_stops_say_which() {
    let run = run_text(
        r#"Diagram(
            simulation: (stop_time: "2 s"),
            blocks: {
                "wave": Sine(amplitude: 2, frequency: "1 Hz"),
                "pair": Mux(inputs: 2),
                "half": Gain(k: 0.6),
                "limiter": Saturation(lower: -1, upper: 1),
                "relay": Relay(on_at: 1, off_at: -1),
                "show": Scope(inputs: ["u1", "u2"]),
            },
            connections: [
                "wave.y -> half.u, pair.u1, relay.u",
                "half.y -> pair.u2",
                "pair.y -> limiter.u",
                "limiter.y -> show.u1",
                "relay.y -> show.u2",
            ],
        )"#,
    );
    listed(
        &run.events,
        12,
        &expect![[r#"
        0.0833 limiter reaches the upper limit (element 0)
        0.0833 relay switches on
        0.1568 limiter reaches the upper limit (element 1)
        0.3432 limiter leaves the upper limit (element 1)
        0.4167 limiter leaves the upper limit (element 0)
        0.5833 limiter reaches the lower limit (element 0)
        0.5833 relay switches off
        0.6568 limiter reaches the lower limit (element 1)
        0.8432 limiter leaves the lower limit (element 1)
        0.9167 limiter leaves the lower limit (element 0)
        1.0833 limiter reaches the upper limit (element 0)
        1.0833 relay switches on
    "#]],
    );
}
