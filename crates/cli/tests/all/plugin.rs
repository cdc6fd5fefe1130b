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
    assert!(said(&again).contains("already exists"), "{}", said(&again));
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

/// One law in three languages gives one run, bit for bit.
#[test]
fn controllers_in_c_and_cpp_run_as_the_one_in_rust() {
    let folder = Folder::new("languages");
    let mut runs = Vec::new();
    for language in ["rust", "c", "cpp"] {
        let made =
            blocksim(&folder.0, &["plugin", "new", &format!("{language}/law"), "--language", language]);
        assert_eq!(made.status.code(), Some(0), "{}", said(&made));
        let out = format!("{language}/out");
        let run =
            blocksim(&folder.0, &["run", &format!("{language}/law/demo.ron"), "--quiet", "--out", &out]);
        assert_eq!(run.status.code(), Some(0), "{language}: {}", said(&run));
        assert!(!said(&run).contains("warning"), "{language}: {}", said(&run));
        runs.push(std::fs::read_to_string(folder.0.join(out).join("signals.csv")).expect("a table"));
    }
    assert!(runs[0].lines().count() > 1000 && runs[0] == runs[1] && runs[1] == runs[2]);
    for (words, expected) in [
        (&["plugin", "show", "c/law"][..], "Integral part."),
        (&["check", "cpp/law/demo.ron", "--set", "controller.ts=-1"], "`ts` must be above zero"),
        (&["check", "c/law/demo.ron", "--set", "controller.limit=-1"], "must not be below zero"),
    ] {
        let output = blocksim(&folder.0, words);
        let text = format!("{}{}", String::from_utf8_lossy(&output.stdout), said(&output));
        assert!(text.contains(expected), "{words:?}: {text}");
    }
}

/// What was compiled is used until a source, a header, a file of the folder or the compiler changes.
#[test]
fn sources_in_c_are_compiled_when_anything_has_changed() {
    let folder = Folder::new("stale");
    assert_eq!(blocksim(&folder.0, &["plugin", "new", "law", "--language", "c"]).status.code(), Some(0));
    let write =
        |name: &str, text: &str| std::fs::write(folder.0.join("law").join(name), text).expect("written");
    let source = std::fs::read_to_string(folder.0.join("law/controller.c")).expect("the source");
    write(
        "controller.c",
        &source
            .replace("#include \"blocksim", "#include \"gain.h\"\n#include \"blocksim")
            .replace("static const double one = 1.0", "static const double one = GAIN"),
    );
    write("gain.h", "#define GAIN 1.0\n");
    let shown = |with: Option<&str>| {
        let mut command = program();
        command.current_dir(&folder.0).args(["plugin", "show", "law"]);
        with.map(|compiler| command.env("CC", compiler));
        let output = command.output().expect("the program runs");
        (String::from_utf8_lossy(&output.stdout).into_owned(), said(&output))
    };
    let compiled = |said: &str| said.contains("building the plug-in `law` with");
    let gain = |text: &str| {
        let row = text.lines().find(|line| line.trim_start().starts_with("kp")).expect("a row").to_owned();
        row.split_whitespace().nth(2).expect("a default").to_owned()
    };
    // What was written while the compiler was started has no stamp yet.
    std::thread::sleep(std::time::Duration::from_millis(50));
    let (first, notice) = shown(None);
    assert!(compiled(&notice) && gain(&first) == "1", "{first}{notice}");
    let (again, notice) = shown(None);
    assert!(!compiled(&notice) && again == first, "{notice}");
    for (name, text, expected) in [
        ("gain.h", "#define GAIN 2.0\n", "2"),
        ("plugin.toml", "flags = [\"-DUNUSED\"]\n", "2"),
        ("more.c", "int blocksim_test_more = 1;\n", "2"),
        ("gain.h", "#define GAIN 3.0\n", "3"),
    ] {
        write(name, text);
        std::thread::sleep(std::time::Duration::from_millis(50));
        let (text, notice) = shown(None);
        assert!(compiled(&notice) && gain(&text) == expected, "{name}: {text}{notice}");
        assert!(!compiled(&shown(None).1), "{name}");
    }
    // Another compiler gives another library; one that is missing is a reason, as sources are never ignored.
    let (text, notice) = shown(Some("cc -DOTHER"));
    assert!(compiled(&notice) && gain(&text) == "3", "{text}{notice}");
    let (text, notice) = shown(Some("/nowhere/cc"));
    assert!(
        text.is_empty()
            && notice.contains(
                "error[plugin_missing]: the plug-in `law` needs a C compiler, and `/nowhere/cc` cannot"
            )
            && notice.contains("in the variable CC"),
        "{text}{notice}"
    );
}

#[test]
fn what_is_wrong_in_c_is_shown_with_its_place() {
    let folder = Folder::new("wrong");
    assert_eq!(blocksim(&folder.0, &["plugin", "new", "law", "--language", "c"]).status.code(), Some(0));
    let good = std::fs::read_to_string(folder.0.join("law/controller.c")).expect("the source");
    let line =
        |text: &str, part: &str| text.lines().position(|line| line.contains(part)).expect("a line") + 1;
    let semicolon =
        good.replace("y[U] = limited(p, wanted(p, xd, u));", "y[U] = limited(p, wanted(p, xd, u))");
    let unknown = good.replace("return fmin(", "return fmni(");
    let unlinked = good
        .replace("static double wanted(", "double elsewhere(double);\nstatic double wanted(")
        .replace("y[U] = limited(", "y[U] = elsewhere(")
        .replace("elsewhere(p, wanted(p, xd, u))", "elsewhere(limited(p, wanted(p, xd, u)))");
    let entry = good.replace("blocksim_plugin_v1(void)\n{", "another(void)\n{");
    for (source, expected) in [
        (&semicolon, format!("controller.c:{}:", line(&semicolon, "y[U] ="))),
        (&unknown, format!("controller.c:{}:", line(&unknown, "fmni"))),
        (&unlinked, "elsewhere".to_owned()),
        (&unlinked, "it cannot be linked".to_owned()),
        (&entry, "in C, define".to_owned()),
    ] {
        std::fs::write(folder.0.join("law/controller.c"), source).expect("written");
        let output = blocksim(&folder.0, &["plugin", "show", "law"]);
        assert_eq!(output.status.code(), Some(4), "{}", said(&output));
        assert!(said(&output).contains(&expected), "{expected}: {}", said(&output));
    }
    std::fs::write(folder.0.join("law/plugin.toml"), "\nsource = [\"a.c\"]\n").expect("written");
    let output = blocksim(&folder.0, &["plugin", "show", "law"]);
    assert!(said(&output).contains("plugin.toml:2: `source` is not a setting"), "{}", said(&output));
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
        (&["plugin", "new", "My-Controller"][..], 2, "is not a valid name for a plug-in"),
        (&["plugin", "new", "ok", "--kind", "pid"], 2, "is not a valid name for a controller"),
        (&["plugin", "new", "full"], 4, "already exists"),
        (&["plugin", "new", "ok", "--blocksim", "full"], 2, "not a clone of blocksim"),
        (&["plugin", "show", "ful"], 4, "did you mean `full`"),
        (&["plugin", "show", "full"], 4, "holds no `Cargo.toml`"),
        (&["plugin", "show", "full/notes.txt", "--trust"], 4, "not a library that can be loaded"),
    ] {
        let output = blocksim(&folder.0, words);
        assert_eq!(output.status.code(), Some(code), "{words:?}: {}", said(&output));
        assert!(said(&output).contains(expected), "{words:?}: {}", said(&output));
    }
    let left: Vec<_> =
        std::fs::read_dir(&folder.0).expect("a folder").flatten().map(|entry| entry.file_name()).collect();
    assert_eq!(left, ["full"]);
}
