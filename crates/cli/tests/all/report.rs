//! `blocksim report` as a user calls it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use crate::support::program;

const MODEL: &str = r#"Diagram(
    title: "servo",
    simulation: (stop_time: "1 s", solver: Ode4(step: "1 ms")),
    blocks: {
        "demand": Step(time: "0.1 s", after: "90 deg"),
        "plant": LowPass(tau: "50 ms"),
        "angle": Scope(inputs: ["set", "actual"], display: "deg"),
    },
    connections: ["demand.y -> plant.u, angle.set", "plant.y -> angle.actual"],
)
"#;

fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("blocksim-report-cli-{}-{name}", std::process::id()));
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    fs::write(path.join("servo.ron"), MODEL).unwrap();
    path
}

fn call(folder: &Path, arguments: &[&str]) -> Output {
    program().current_dir(folder).args(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_run_becomes_a_page_in_its_folder_with_its_scopes_and_numbers() {
    let folder = folder("page");
    let run = call(&folder, &["run", "servo.ron", "--out", "r", "--quiet"]);
    assert!(run.status.success(), "{}", said(&run));
    fs::write(folder.join("m.csv"), "time [s];angle [deg]\n0;0\n0,5;88,5\n").unwrap();
    let report = call(&folder, &["report", "r", "--overlay", "m.csv"]);
    assert!(report.status.success(), "{}", said(&report));
    let page = fs::read_to_string(folder.join("r/report.html")).unwrap();
    for part in ["<h1>servo</h1>", "\"title\":\"angle\"", "\"unit\":\"°\"", "Tracking", "m.csv", "servo.ron"]
    {
        assert!(page.contains(part), "{part}");
    }
    assert!(page.len() < 200_000, "{}", page.len());
    assert!(!page.contains("space-view\""), "no shapes, no 3D view");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_is_wrong_is_said_and_nothing_is_overwritten() {
    let folder = folder("wrong");
    assert!(call(&folder, &["run", "servo.ron", "--out", "r", "--quiet"]).status.success());
    fs::write(folder.join("mine.html"), "mine").unwrap();
    let there = call(&folder, &["report", "r", "-o", "mine.html"]);
    assert_eq!(there.status.code(), Some(4));
    assert!(said(&there).contains("it already exists"), "{}", said(&there));
    assert_eq!(fs::read_to_string(folder.join("mine.html")).unwrap(), "mine");
    for (arguments, part) in [
        (&["report", "nothing"][..], "nothing"),
        (&["report", "r", "-o", "no/where.html"], "the folder does not exist"),
        (&["report", "r", "--overlay", "servo.ron"], "servo.ron"),
    ] {
        let output = call(&folder, arguments);
        assert_eq!(output.status.code(), Some(4), "{arguments:?}");
        assert!(said(&output).contains(part) && said(&output).contains("= help"), "{}", said(&output));
    }
    assert!(!folder.join("r/report.html").exists());
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_diagram_of_a_page_is_that_of_the_run_whatever_became_of_the_files() {
    let folder = folder("kept");
    let model = MODEL.replace("display: \"deg\")", "display: \"deg\", label: \"Angle of the servo\")");
    fs::write(folder.join("servo.ron"), model).unwrap();
    assert!(
        call(&folder, &["run", "servo.ron", "--out", "r", "--quiet", "--set", "plant.tau=20 ms"])
            .status
            .success()
    );
    let page = |name: &str| {
        let report = call(&folder, &["report", "r", "--out", name]);
        assert!(report.status.success(), "{}", said(&report));
        (fs::read_to_string(folder.join(name)).unwrap(), said(&report))
    };
    let has_diagram =
        |page: &str| page.contains("id=\"diagram-view\"") && page.contains("id=\"report-texts\"");

    fs::remove_file(folder.join("servo.ron")).unwrap();
    let (kept, _) = page("kept.html");
    assert!(has_diagram(&kept) && !kept.contains("as they are now"));
    assert!(kept.contains("\"title\":\"Angle of the servo\""), "scopes bear their labels");
    assert!(kept.contains("set for this run") && kept.contains("plant.tau"));

    // A run of an earlier version: the files tell as well, and the page says so.
    fs::remove_file(folder.join("r/model.json")).unwrap();
    assert!(!has_diagram(&page("without.html").0), "neither a copy nor a file");
    fs::write(folder.join("servo.ron"), MODEL.replace("50 ms", "70 ms")).unwrap();
    let (now, warned) = page("now.html");
    assert!(has_diagram(&now) && now.contains("as they are now"));
    assert!(warned.contains("Changed since the run: servo.ron"), "{warned}");

    fs::write(folder.join("r/model.json"), "{\"files\": [").unwrap();
    let (broken, warned) = page("broken.html");
    assert!(!has_diagram(&broken) && warned.contains("model.json cannot be read"), "{warned}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn two_runs_stand_in_one_page_with_a_verdict_on_each_signal() {
    let folder = folder("both");
    assert!(call(&folder, &["run", "servo.ron", "--out", "a", "--quiet"]).status.success());
    assert!(
        call(&folder, &["run", "servo.ron", "--out", "b", "--quiet", "--set", "plant.tau=80 ms"])
            .status
            .success()
    );
    let compared = call(&folder, &["compare", "a", "b", "--abs", "1 deg", "--html", "both.html"]);
    assert_eq!(compared.status.code(), Some(1), "{}", said(&compared));
    assert!(String::from_utf8_lossy(&compared.stdout).ends_with("both.html\n"));
    let page = fs::read_to_string(folder.join("both.html")).unwrap();
    for part in [
        "Compared with plant.tau = 80 ms",
        "DIFFERS",
        "1 of 2 signals",
        "\"other\":[",
        "\"marks\":[[0,\"angle.actual\"",
    ] {
        assert!(page.contains(part), "{part}");
    }
    let again = call(&folder, &["compare", "a", "b", "--html", "both.html"]);
    assert_eq!(again.status.code(), Some(4));
    assert!(said(&again).contains("it already exists"), "{}", said(&again));
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn signals_without_a_scope_are_in_the_page_and_make_no_pictures_where_they_are_many() {
    let folder = folder("unseen");
    let filters: String =
        (1..=14).map(|n| format!("\"filter{n}\": LowPass(tau: \"{n} ms\"),\n        ")).collect();
    let wires: String = (1..=14).map(|n| format!("\"demand.y -> filter{n}.u\", ")).collect();
    let model =
        MODEL.replace("    blocks: {", &format!("    record: [\"**\"],\n    blocks: {{\n        {filters}"));
    fs::write(folder.join("servo.ron"), model.replace("connections: [", &format!("connections: [{wires}")))
        .unwrap();
    assert!(call(&folder, &["run", "servo.ron", "--out", "r", "--quiet"]).status.success());
    let report = call(&folder, &["report", "r"]);
    assert!(report.status.success(), "{}", said(&report));
    let page = fs::read_to_string(folder.join("r/report.html")).unwrap();
    assert_eq!(page.matches("\"title\":").count(), 1, "the picture of the scope alone");
    let counts = page.split("\"counts\":[").nth(1).unwrap().split(']').next().unwrap();
    assert!(counts.split(',').count() >= 14, "{counts}");
    assert!(counts.split(',').all(|count| count.parse::<usize>().unwrap() <= 300), "{counts}");
    fs::remove_dir_all(folder).unwrap();
}

/// A rod with a mesh, which swings through a wall.
const SWING: &str = r#"Diagram(
    title: "swing",
    parameters: { "surroundings": File("around.ron") },
    simulation: (stop_time: "1 s", solver: Ode4(step: "1 ms"), output: Every("10 ms")),
    blocks: {
        "world": World(gravity: ["0 m/s^2", "0 m/s^2", "-9.80665 m/s^2"]),
        "pivot": RevoluteJoint(axis: [0, 1, 0], position: "90 deg"),
        "rod": Body(mass: "1 kg", com: [0, 0, "-0.5 m"], moi: ["0.1 kg*m^2", "0.1 kg*m^2", "0 kg*m^2"], shapes: [
            (kind: Text("mesh"), file: Text("rod.stl"), use: Text("visual")),
            (kind: Text("capsule"), radius: "20 mm", from: [0, 0, 0], to: [0, 0, "-1 m"], use: Text("collision")),
        ]),
    },
    connections: ["world.frame <-> pivot.base", "pivot.follower <-> rod.frame"],
)
"#;
const ROD: &str =
    "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 0 0 -1\nvertex 0 0.1 0\nendloop\nendfacet\nendsolid\n";
const AROUND: &str = r#"(floor: "-2 m", things: [(name: Text("wall"), shapes: [
    (kind: Text("box"), size: ["0.2 m", "1 m", "0.2 m"], centre: [0, 0, "-0.9 m"]),
])])"#;

#[test]
fn a_run_that_was_moved_still_shows_its_meshes_and_surroundings_and_what_touched() {
    let folder = folder("moved");
    for (name, text) in [("swing.ron", SWING), ("rod.stl", ROD), ("around.ron", AROUND)] {
        fs::write(folder.join(name), text).unwrap();
    }
    let run = call(&folder, &["run", "swing.ron", "--out", "r", "--quiet"]);
    assert!(run.status.success(), "{}", said(&run));
    let elsewhere = folder.join("elsewhere");
    fs::create_dir(&elsewhere).unwrap();
    fs::rename(folder.join("r"), elsewhere.join("r")).unwrap();
    for name in ["swing.ron", "rod.stl", "around.ron"] {
        fs::remove_file(folder.join(name)).unwrap();
    }
    let report = call(&elsewhere, &["report", "r"]);
    assert!(report.status.success() && !said(&report).contains("not shown"), "{}", said(&report));
    assert!(said(&report).contains(" at 0.") && said(&report).contains("touches"), "{}", said(&report));
    let page = fs::read_to_string(elsewhere.join("r/report.html")).unwrap();
    for part in ["\"surface\":0", "\"around\":true", "\"floor\":-2.0", "\"owner\":\"wall\""] {
        assert!(page.contains(part), "{part}");
    }
    let contacts = page.split("\"contacts\":[[").nth(1).unwrap().split(']').next().unwrap();
    let begin: f64 = contacts.split(',').next().unwrap().parse().unwrap();
    assert!(
        contacts.contains("rod") && contacts.contains("wall") && begin > 0.1 && begin < 0.8,
        "{contacts}"
    );

    // Without its copy the mesh is told, and all else is shown.
    let kept = fs::read_dir(elsewhere.join("r")).unwrap().map(|entry| entry.unwrap().path());
    let kept: Vec<PathBuf> =
        kept.filter(|path| path.extension().is_some_and(|ending| ending == "stl")).collect();
    assert_eq!(kept.len(), 1);
    fs::remove_file(&kept[0]).unwrap();
    let report = call(&elsewhere, &["report", "r"]);
    assert!(
        report.status.success() && said(&report).contains("rod.stl` of `rod` is not shown"),
        "{}",
        said(&report)
    );

    // Others than those of the model, and some that cannot be read.
    fs::write(elsewhere.join("empty.ron"), "(things: [])").unwrap();
    let other = call(&elsewhere, &["report", "r", "-o", "other.html", "--surroundings", "empty.ron"]);
    assert!(other.status.success(), "{}", said(&other));
    assert!(!fs::read_to_string(elsewhere.join("other.html")).unwrap().contains("\"around\":true"));
    fs::write(elsewhere.join("broken.ron"), "(things: [(name: Text(\"wall\"))])").unwrap();
    for file in ["broken.ron", "nothing.ron"] {
        let refused = call(&elsewhere, &["report", "r", "-o", "refused.html", "--surroundings", file]);
        let text = said(&refused);
        assert_eq!(refused.status.code(), Some(4), "{text}");
        assert!(text.contains(file) && text.contains("= help"), "{text}");
        assert!(!elsewhere.join("refused.html").exists());
    }
    fs::remove_dir_all(folder).unwrap();
}
