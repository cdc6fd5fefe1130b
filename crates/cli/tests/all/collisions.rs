//! `blocksim collisions` as users call it.

use crate::desk::{Answer, Desk};
use expect_test::expect;

use crate::support::program;

/// A ball on a slide that swings by 0.5 m, 1 m above the ground.
const SLIDE: &str = r#"Diagram(
    parameters: { "surroundings": (floor: "0 m") },
    simulation: (stop_time: "2 s", solver: Ode45(max_step: "20 ms")),
    blocks: {
        "world": World(gravity: [0, 0, 0]),
        "post": Body(mass: "1 kg", moi: [0, 0, 0], shapes: [
            (kind: Text("box"), size: ["0.1 m", "0.1 m", "1 m"], centre: ["0.8 m", 0, "0.5 m"]),
        ]),
        "slide": PrismaticJoint(axis: [1, 0, 0], stiffness: "40 N/m", position: "-0.5 m"),
        "ball": Body(mass: "1 kg", moi: ["1e-3 kg*m^2", "1e-3 kg*m^2", "1e-3 kg*m^2"], shapes: [
            (kind: Text("sphere"), radius: "0.1 m", centre: [0, 0, "1 m"]),
        ]),
        "show": Scope(display: "mm"),
    },
    connections: [
        "world.frame <-> slide.base <-> post.frame",
        "slide.follower <-> ball.frame",
        "slide.x -> show.u",
    ],
)
"#;

/// A wall into which it swings, and a model without any shapes.
const WALL: &str = r#"(things: [(name: Text("wall"), shapes: [(kind: Text("box"), size: ["0.2 m", "1 m", "1 m"], centre: ["0.6 m", 0, "1 m"])])])"#;
const PLAIN: &str = r#"Diagram(blocks: { "a": Sine(amplitude: 1, frequency: "1 Hz"), "s": Scope }, connections: ["a.y -> s.u"])"#;

#[test]
fn the_page_shows_what_the_program_says() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let page = std::fs::read_to_string(root.join("docs/collisions.md")).expect("the page");
    let mut fences = page.split("```").skip(1).step_by(2);
    let (commands, answer) = (fences.next().expect("commands"), fences.next().expect("an answer"));
    let folder = std::env::temp_dir().join(format!("blocksim-picked-{}", std::process::id()));
    let mut said = String::new();
    for line in commands.lines().skip(1) {
        let place = folder.display().to_string();
        let words: Vec<&str> = line
            .split_whitespace()
            .skip(1)
            .map(|word| if word == "picked" { &place } else { word })
            .collect();
        let mut command = program();
        let output = command.current_dir(&root).args(words).output().expect("the program runs");
        said += &String::from_utf8(output.stdout).expect("text").replace(&format!("{place}\n"), "");
    }
    let _ = std::fs::remove_dir_all(folder);
    assert_eq!(said, answer.trim_start_matches("text\n"));
}

fn run(files: &[(&str, &str)], model: &str) -> Desk {
    let desk = Desk::with(files);
    let answer = desk.call(&["run", model, "--out", "r", "--quiet"]);
    assert_eq!(answer.code, Some(0), "{answer:?}");
    desk
}

#[test]
fn a_ball_that_swings_into_a_wall_is_told_with_times_and_depth() {
    let desk = run(&[("slide.ron", SLIDE), ("wall.ron", WALL)], "slide.ron");
    let free: serde_json::Value =
        serde_json::from_str(&desk.call(&["collisions", "r", "--json"]).out).expect("data");
    assert_eq!(free["contacts"], serde_json::json!([]));
    // x = -0.5 cos(w t) with w = sqrt(40): 0.2 m beside the post, which begins at 0.75 m, at t = π / w.
    let w = 40.0_f64.sqrt();
    let Answer { code, out, .. } = desk.call(&["collisions", "r", "--surroundings", "wall.ron", "--json"]);
    let hit: serde_json::Value = serde_json::from_str(&out).expect("data");
    assert_eq!(code, Some(1));
    let contact = &hit["contacts"][0];
    assert_eq!(contact["names"], serde_json::json!(["ball", "wall"]));
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    // The wall begins at 0.5 m, so it is touched from x = 0.4 m on and 0.1 m deep at most.
    let begin = (-0.8_f64).acos() / w;
    assert!((number(&contact["from"]) - begin).abs() < 8e-3, "{contact}");
    assert!((number(&contact["to"]) - (2.0 * std::f64::consts::PI / w - begin)).abs() < 8e-3, "{contact}");
    assert!((number(&contact["depth"]) - 0.1).abs() < 1e-3, "{contact}");
    assert!((number(&contact["time"]) - std::f64::consts::PI / w).abs() < 0.02, "{contact}");
    let later = desk.call(&["collisions", "r", "--surroundings", "wall.ron", "--to", "0.3 s"]);
    assert_eq!(later.code, Some(0), "{later:?}");
}

#[test]
fn what_cannot_be_looked_at_is_told_with_reason_and_remedy() {
    let desk = run(&[("plain.ron", PLAIN), ("egg.ron", "(things: 3)")], "plain.ron");
    std::fs::create_dir(desk.0.join("swing")).expect("a folder");
    std::fs::write(desk.0.join("swing/slide.ron"), SLIDE).expect("a model");
    assert_eq!(desk.call(&["run", "swing/slide.ron", "--out", "s", "--quiet"]).code, Some(0));
    let calls: [&[&str]; 6] = [
        &["collisions", "r"],
        &["collisions", "nothing"],
        &["collisions", "s", "--surroundings", "none.ron"],
        &["collisions", "s", "--surroundings", "egg.ron"],
        &["collisions", "s", "--from", "5 s"],
        &["collisions", "s", "--from", "soon"],
    ];
    let mut said: String = calls.iter().map(|call| desk.said(call)).collect();
    std::fs::write(desk.0.join("s/scene.json"), "{\"bodies\": [").expect("damaged");
    said += &desk.said(&["collisions", "s"]);
    expect![[r#"
        error[unreadable]: `r` has no mechanism to look at
          = help: give bodies `shapes` (see `blocksim blocks Body`) and run the model again
        exit code 4
        error[unreadable]: cannot read `nothing`: no folder, file or run in `runs` has this name
          = help: `blocksim runs` lists what there is; `blocksim run MODEL` makes a new one
        exit code 4
        error[unreadable]: cannot read the surroundings in `none.ron`: cannot read `none.ron`: the file does not exist
          = help: write them as in docs/moves.md, or name a diagram with the parameter `surroundings`
        exit code 4
        error[unreadable]: cannot read the surroundings in `egg.ron`: expected a list, found a number
          = help: write them as in docs/moves.md, or name a diagram with the parameter `surroundings`
        exit code 4
        error[unreadable]: `s` has no values there
          = help: it goes from 0 s to 2 s
        exit code 4
        error: invalid value 'soon' for '--from <TIME>': a time is a number, such as 10s or 250ms

        For more information, try '--help'.
        exit code 2
        error[unreadable]: cannot look for contacts in `s`: scene.json: EOF while parsing a list at line 1 column 12
          = help: run the model again
        exit code 4
    "#]]
    .assert_eq(&said);
}
