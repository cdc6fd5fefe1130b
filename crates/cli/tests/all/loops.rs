//! What commands show of algebraic loops.

use std::path::Path;

use crate::support::program;

const LOOP: &str = r#"Diagram(
    blocks: {
        "r": Constant(value: 1), "e": Sum(signs: "+-"), "k": Gain(k: 4), "show": Scope(inputs: ["e"]),
    },
    connections: ["r.y -> e.u1", "e.y -> k.u, show.e", "k.y -> e.u2"],
)"#;

/// Exit code, output and messages of a command.
fn call(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = program().args(arguments).current_dir(folder).output().expect("the program");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_loop_is_a_note_and_can_be_drawn_and_listed() {
    let folder = std::env::temp_dir().join(format!("blocksim-loops-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("loop.ron"), LOOP).expect("a model");
    let (code, out, err) = call(&folder, &["check", "loop.ron"]);
    let all = out + &err;
    assert_eq!(code, Some(0), "{all}");
    let note = "note[algebraic_loop]: algebraic loop: e -> k -> e; solved at every instant";
    assert!(all.contains(note) && all.contains("--loop 1"), "{all}");
    // Where nobody asks for it, it is a line.
    let (code, _, err) = call(&folder, &["run", "loop.ron", "--no-plot", "--out", "run"]);
    let line = "note: algebraic loop: e -> k -> e; solved at every instant (`blocksim check` shows where)\n";
    assert!(code == Some(0) && err == line, "{err}");
    let (code, ..) = call(&folder, &["graph", "loop.ron", "--loop", "1", "--svg", "loop.svg"]);
    assert_eq!(code, Some(0));
    let svg = std::fs::read_to_string(folder.join("loop.svg")).expect("a drawing");
    // Two blocks and the two wires between them.
    assert_eq!(svg.matches("class=\"block marked\"").count(), 2, "{svg}");
    assert_eq!(svg.matches("class=\"wire marked\"").count(), 2, "{svg}");
    let (_, out, _) = call(&folder, &["graph", "loop.ron", "--loop", "1"]);
    assert!(out.starts_with("loop 1: blocks k, e; unknown: e.y\n"), "{out}");
    let (_, out, _) = call(&folder, &["emit", "program", "loop.ron"]);
    assert!(out.contains("loop 1, of k, e, solved for e.y by elimination, once for all"), "{out}");
    let (code, _, err) = call(&folder, &["graph", "loop.ron", "--loop", "2"]);
    assert!(code == Some(2) && err.contains("there is no loop 2: the model has one"), "{err}");
    std::fs::remove_dir_all(folder).expect("the folder goes");
}
