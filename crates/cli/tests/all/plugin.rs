//! `blocksim plugin` as users call it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

use crate::support::program;

/// A folder that is removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("blocksim-plugin-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Folder(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn blocksim(folder: &Path, words: &[&str]) -> Output {
    let mut command = program();
    // What the crate needs must be on the disk: students build in rooms without a network.
    command.current_dir(folder).env("NO_COLOR", "1").env("CARGO_NET_OFFLINE", "true").args(words);
    // Each crate is built in its own folder, wherever the tests themselves are built.
    command.env_remove("CARGO_TARGET_DIR");
    command.output().expect("the program runs")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_new_controller_is_built_run_tested_and_shown() {
    let folder = Folder::new("new");
    let made = blocksim(&folder.0, &["plugin", "new", "cruise_control"]);
    assert_eq!(made.status.code(), Some(0), "{}", said(&made));

    let run = blocksim(&folder.0, &["run", "cruise_control/demo.ron", "--json", "--no-csv"]);
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    let last = String::from_utf8_lossy(&run.stdout).lines().last().map(str::to_owned).expect("a result");
    let result: Value = serde_json::from_str(&last).expect("data");
    // The integral part takes the error away.
    let left = result["tracking"][0]["final_error"].as_f64().unwrap_or_else(|| panic!("{result}"));
    assert!(left.abs() < 0.01, "{result}");

    let tested = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["test", "--quiet", "--release", "--offline", "--lib"])
        .current_dir(folder.0.join("cruise_control"))
        .output()
        .expect("cargo runs");
    assert!(tested.status.success(), "{}", String::from_utf8_lossy(&tested.stderr));

    let shown = blocksim(&folder.0, &["plugin", "show", "cruise_control"]);
    let text = String::from_utf8_lossy(&shown.stdout).into_owned();
    for part in
        ["cruise_control 0.1.0", "\nCruiseControl\n", "kp", "Sample time.", "block: \"CruiseControl\""]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!text.contains("MyController") && !text.contains("my_controller"), "{text}");

    let again = blocksim(&folder.0, &["plugin", "new", "cruise_control"]);
    assert_eq!(again.status.code(), Some(4));
    assert!(said(&again).contains("is there already"), "{}", said(&again));
}

/// Names that the code of a controller uses itself: those of the prelude, of its constants, of Rust.
#[test]
fn a_controller_may_have_any_name() {
    let folder = Folder::new("names");
    for name in
        ["controller", "context", "parameter", "outcome", "outputs", "e", "err", "loop", "core", "self"]
    {
        let made = blocksim(&folder.0, &["plugin", "new", name]);
        assert_eq!(made.status.code(), Some(0), "{}", said(&made));
        // All of them in one folder, so that what they depend on is built once.
        let run = program()
            .args(["check", &format!("{name}/demo.ron")])
            .current_dir(&folder.0)
            .env("CARGO_TARGET_DIR", folder.0.join("target"))
            .output()
            .expect("the program runs");
        assert_eq!(run.status.code(), Some(0), "{name}: {}", said(&run));
    }
    let taken = blocksim(&folder.0, &["plugin", "new", "blocksim_controller"]);
    assert_eq!(taken.status.code(), Some(2), "{}", said(&taken));
}

/// Cargo is asked for what changed, and nothing is said where nothing is built.
#[test]
fn building_is_said_where_something_is_built() {
    let folder = Folder::new("notice");
    assert_eq!(blocksim(&folder.0, &["plugin", "new", "law"]).status.code(), Some(0));
    let check = || said(&blocksim(&folder.0, &["check", "law/demo.ron"]));
    let notice = "building the plug-in `.` with cargo";
    assert!(check().contains(notice));
    // The lock file was written while cargo ran: it is asked once more, and has nothing to build.
    assert!(!check().contains(notice));
    let built = std::fs::read_dir(folder.0.join("law/target/release")).expect("what cargo built");
    let mut names = built.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned());
    assert!(names.any(|name| name.ends_with("law.blocksim")), "no stamp, so cargo is asked each time");
    let without_cargo = program()
        .args(["check", "law/demo.ron"])
        .current_dir(&folder.0)
        .env("CARGO", "/nowhere/cargo")
        .env_remove("CARGO_TARGET_DIR")
        .output()
        .expect("the program runs");
    assert_eq!(without_cargo.status.code(), Some(0), "{}", said(&without_cargo));
    let source = folder.0.join("law/src/lib.rs");
    let text = std::fs::read_to_string(&source).expect("the source");
    std::fs::write(&source, text.replace("clamp(-c[LIMIT], c[LIMIT])", "clamp(0.0, c[LIMIT])"))
        .expect("written");
    assert!(check().contains(notice));
    assert!(!check().contains(notice));
}

#[test]
fn what_a_plug_in_offers_is_data_too() {
    let plugins = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../plugins");
    let output = blocksim(&plugins, &["plugin", "show", "pid", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let pid: Value = serde_json::from_slice(&output.stdout).expect("data");
    assert_eq!(pid["kind"], "Pid");
    assert_eq!(pid["inputs"][0]["name"], "e");
    assert_eq!(pid["outputs"][0]["reads"][0], "e");
    assert_eq!(pid["parameters"][6]["default"][0], "inf");
}

#[test]
fn mistakes_are_answered_with_the_remedy_and_nothing_is_written() {
    let folder = Folder::new("mistakes");
    std::fs::create_dir(folder.0.join("full")).expect("a folder");
    std::fs::write(folder.0.join("full/notes.txt"), "mine").expect("a file");
    for (words, code, expected) in [
        (&["plugin", "new", "My-Controller"][..], 2, "no name for a crate"),
        (&["plugin", "new", "ok", "--kind", "pid"], 2, "no name for a controller"),
        (&["plugin", "new", "full"], 4, "is there already"),
        (&["plugin", "new", "ok", "--blocksim", "full"], 2, "no clone of blocksim"),
        (&["plugin", "show", "ful"], 4, "did you mean `full`"),
        (&["plugin", "show", "full"], 4, "holds no `Cargo.toml`"),
        (&["plugin", "show", "full/notes.txt", "--trust"], 4, "no library that can be loaded"),
    ] {
        let output = blocksim(&folder.0, words);
        assert_eq!(output.status.code(), Some(code), "{words:?}: {}", said(&output));
        assert!(said(&output).contains(expected), "{words:?}: {}", said(&output));
    }
    let left: Vec<_> =
        std::fs::read_dir(&folder.0).expect("a folder").flatten().map(|entry| entry.file_name()).collect();
    assert_eq!(left, ["full"]);
}
