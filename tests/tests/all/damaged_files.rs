//! Diagrams, moves and tables that somebody or something has damaged: a result or problems with places, whatever they are.

use std::path::Path;

use blocksim_recording::{ReadLimits, read_csv, read_events, read_foreign};
use blocksim_tests::{Desk, compile_with, root};

/// Numbers that look random, the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n.max(1)
    }
}

/// One to four changes: cut off, a piece twice, a piece gone, two pieces swapped, something put in.
fn damaged(valid: &str, pieces: &[&str], random: &mut Random) -> String {
    let mut bytes = valid.as_bytes().to_vec();
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len());
        let to = (at + random.below(40)).min(bytes.len());
        match random.below(6) {
            0 if random.below(4) == 0 => bytes.truncate(at),
            0 | 1 => {
                let piece = bytes[at..to].to_vec();
                let elsewhere = random.below(bytes.len() + 1);
                bytes.splice(elsewhere..elsewhere, piece);
            }
            2 => drop(bytes.drain(at..to)),
            3 => {
                let text = String::from_utf8_lossy(&bytes).into_owned();
                let mut lines: Vec<&str> = text.lines().collect();
                if !lines.is_empty() {
                    let [from, to] = [random.below(lines.len()), random.below(lines.len())];
                    lines.swap(from, to);
                    bytes = lines.join("\n").into_bytes();
                }
            }
            _ => {
                let piece = pieces[random.below(pieces.len())].bytes();
                bytes.splice(at..(at + random.below(6)).min(bytes.len()), piece);
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Pieces that hurt diagrams where they land.
const RON: [&str; 30] = [
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "\"",
    ",",
    ":",
    "//",
    "/*",
    "\\",
    "nan",
    "1e999",
    "-1",
    "0",
    "1e-300",
    "in.",
    " <-> ",
    " -> ",
    "File(\"pendulum.ron\")",
    "Subsystem(file: \"pendulum.ron\")",
    "()",
    "None",
    "Some(",
    "\u{ffff}",
    "\0",
    "^9^9^9",
    "[0]",
    "\"a\" * \"b\"",
];

/// Compiles; a diagram that cannot be run has problems, and all of them have a text.
fn compiles(name: &str, text: &str) -> bool {
    let path = root().join("diagrams").join(name);
    let desk = Desk::new().with(&path.to_string_lossy(), text);
    let (compiled, problems) = compile_with(&desk, &path, &[]);
    assert!(compiled.schedule.is_some() || !problems.is_empty(), "refused without a reason:\n{text}");
    compiled.schedule.is_some()
}

#[test]
fn damaged_diagrams_are_compiled_or_refused_with_a_reason() {
    let names = ["pendulum.ron", "servo.ron", "rectifier_bridge.ron", "stick_slip.ron", "bouncing_mass.ron"];
    let mut random = Random(6);
    let (mut whole, mut refused) = (0, 0);
    for name in names {
        let valid =
            std::fs::read_to_string(root().join("diagrams").join(name)).expect("a diagram that ships");
        assert!(compiles(name, &valid));
        for _ in 0..600 {
            match compiles(name, &damaged(&valid, &RON, &mut random)) {
                true => whole += 1,
                false => refused += 1,
            }
        }
    }
    assert!(whole > 100 && refused > 1000, "{whole} compiled, {refused} refused");
}

#[test]
fn damaged_descriptions_and_moves_are_read_or_refused_with_a_reason() {
    use blocksim_blocks::motion::JointPath;
    use blocksim_blocks::robotics::RobotDescription;
    let read = |name: &str| std::fs::read_to_string(root().join(name)).expect("a file that ships");
    let description = r#"(name: Text("arm"), base: (translation: [0, 0, "0.3 m"]), links: [(name: Text("upper"),
        origin: (translation: [0, 0, "0.4 m"], rpy: [0, "10 deg", 0]), axis: [0, 1, 0],
        limits: (lower: "-90 deg", upper: "90 deg", speed: "90 deg/s", acceleration: "200 deg/s^2"), start: "10 deg",
        bodies: [(mass: "3 kg", com: [0, 0, "0.25 m"], moi: ["0.06 kg*m^2", "0.06 kg*m^2", "0.003 kg*m^2"])],
        drive: (motor: (inertia: "1e-4 kg*m^2"), gear: (ratio: 100)))], flange: (translation: [0, 0, "0.5 m"]))"#;
    let mut random = Random(7);
    let file = Path::new("a.ron");
    let (mut whole, mut refused) = (0, 0);
    for _ in 0..1500 {
        let desk = Desk::new().with("a.ron", &damaged(description, &RON, &mut random));
        let sources = blocksim_diagram::Sources::new(&desk);
        match blocksim_diagram::parameter::<RobotDescription>(&sources, file, &[], "manipulator") {
            Ok(read) => {
                whole += 1;
                let _ = read.robot("manipulator");
            }
            Err(problems) => {
                refused += 1;
                assert!(!problems.is_empty());
            }
        }
    }
    let valid = read("diagrams/irb2600/moves/demo_joint.ron");
    for _ in 0..1500 {
        let desk = Desk::new().with("a.ron", &damaged(&valid, &RON, &mut random));
        let sources = blocksim_diagram::Sources::new(&desk);
        let read = blocksim_diagram::parameter::<JointPath>(&sources, file, &[], "move");
        assert!(!read.is_err_and(|problems| problems.is_empty()));
    }
    assert!(whole > 20 && refused > 500, "{whole} read, {refused} refused");
}

#[test]
fn nesting_and_size_of_a_diagram_are_bounded() {
    for (open, close) in [("(", ")"), ("[", "]"), ("{", "}"), ("Some(", ")"), ("\"a\": Gain(k: ", ")")] {
        let deep = format!(
            "Diagram(blocks: {{ \"a\": Gain(k: {}1{}) }})",
            open.repeat(100_000),
            close.repeat(100_000)
        );
        assert!(!compiles("pendulum.ron", &deep), "{open}");
        assert!(!compiles("pendulum.ron", &open.repeat(300_000)), "{open}");
    }
    // An expression that nests as deep, and one that grows by itself.
    for expression in [
        format!("{}1{}", "(".repeat(50_000), ")".repeat(50_000)),
        format!("{}1", "-".repeat(200_000)),
        format!("1{}", "^2".repeat(50_000)),
        format!("1{}", " + 1".repeat(200_000)),
        format!("a{}", "[0]".repeat(100_000)),
        format!("a{}", ".b".repeat(100_000)),
        "sqrt(".repeat(50_000),
    ] {
        let text = format!("Diagram(blocks: {{ \"a\": Constant(value: \"{expression}\") }})");
        let _ = compiles("pendulum.ron", &text);
    }
}

#[test]
fn damaged_tables_are_read_or_refused_with_their_line() {
    let signals = "time [s],arm.q [rad],arm.on\n0,0.5,1\n0.1,0.25,0\n0.2,nan,1\n0.3,\"1e-3\",1\n";
    let foreign = "\u{feff}Zeit;\"Winkel [deg]\";Moment [N*m]\r\n0;0,5;-1,25\r\n0,1;0,25;3\r\n0,2;;4\r\n";
    let events = "time [s],block,event\n0.5,arm,\"reaches, its stop\"\n1,\"a \"\"b\"\"\",slips\n";
    const PIECES: [&str; 18] = [
        ",", ";", "\"", "\"\"", "\n", "\r", "\r\n", "\t", "nan", "inf", "-", "1e999", "1,5,3", "\0",
        "\u{feff}", "[", "]", ",,,,,,,,",
    ];
    let mut random = Random(8);
    let limits = ReadLimits::default;
    let (mut whole, mut refused) = (0, 0);
    for _ in 0..3000 {
        for (valid, kind) in [(signals, 0), (foreign, 1), (events, 2)] {
            let text = damaged(valid, &PIECES, &mut random);
            let refusal = match kind {
                0 => read_csv(text.as_bytes(), limits()).err(),
                1 => read_foreign(text.as_bytes(), &["Zeit", "time"], limits()).err(),
                _ => read_events(text.as_bytes(), limits()).err(),
            };
            match refusal {
                None => whole += 1,
                Some(error) => {
                    assert!(!error.to_string().is_empty());
                    refused += 1;
                }
            }
        }
    }
    assert!(whole > 300 && refused > 1000, "{whole} read, {refused} refused");
}
