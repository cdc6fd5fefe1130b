//! Pages of runs and tables that are not as they should be: what is wrong is told, and nothing is lost.

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

/// What no text of a page may do: end a script, open an element, end an attribute, turn what follows around.
const EVIL: &str = "</script><img src=x onerror=alert(1)>\"'&\u{202e}back\u{7}<!--";

fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("blocksim-report-faults-{}-{name}", std::process::id()));
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

fn call(folder: &Path, arguments: &[&str]) -> Output {
    program().args(arguments).current_dir(folder).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The page of a run or table that can be shown, and what was said about it.
fn page(folder: &Path, source: &str) -> (String, String) {
    let report = call(folder, &["report", source, "-o", "page.html", "--yes"]);
    assert!(report.status.success(), "{source}: {}", said(&report));
    (fs::read_to_string(folder.join("page.html")).unwrap(), said(&report))
}

/// A run of a model, in the folder `r`.
fn run(folder: &Path, model: &str) {
    fs::write(folder.join("model.ron"), model).unwrap();
    let run = call(folder, &["run", "model.ron", "--out", "r", "--quiet"]);
    assert!(run.status.success(), "{}", said(&run));
}

#[test]
fn a_run_that_recorded_nothing_and_a_table_without_rows_become_pages_that_say_so() {
    let folder = folder("empty");
    let scope = "\"angle\": Scope(inputs: [\"set\", \"actual\"], display: \"deg\"),";
    let wires = "\"demand.y -> plant.u, angle.set\", \"plant.y -> angle.actual\"";
    run(&folder, &MODEL.replace(scope, "").replace(wires, "\"demand.y -> plant.u\""));
    let (shown, _) = page(&folder, "r");
    assert!(shown.contains("The run has no signals to show.") && shown.contains("id=\"diagram-view\""));
    fs::write(folder.join("head.csv"), "time [s],a [V]\n").unwrap();
    let (_, warned) = page(&folder, "head.csv");
    assert!(warned.contains("This run has no values"), "{warned}");
    fs::write(folder.join("nothing.csv"), "").unwrap();
    let refused = call(&folder, &["report", "nothing.csv"]);
    assert_eq!(refused.status.code(), Some(4));
    assert!(
        said(&refused).contains("the file is empty") && said(&refused).contains("= help"),
        "{}",
        said(&refused)
    );
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn signals_without_a_single_number_are_told_and_do_not_hide_the_others() {
    let folder = folder("nan");
    fs::write(folder.join("t.csv"), "time [s],a [V],b [V],c [V]\n0,NaN,1,0\n1,NaN,2,inf\n2,NaN,3,0\n")
        .unwrap();
    let (shown, warned) = page(&folder, "t.csv");
    assert!(warned.contains("a has values that are no finite numbers, first at 0 s."), "{warned}");
    assert!(warned.contains("c has values that are no finite numbers, first at 1 s."), "{warned}");
    assert!(!warned.contains("b has"), "{warned}");
    assert!(shown.contains("\"path\":\"b\""));
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn names_titles_and_values_that_look_like_scripts_stay_texts() {
    let folder = folder("evil");
    let text = EVIL.replace('"', "\\\"").replace('\u{7}', "\\u{7}");
    let model = MODEL.replace("title: \"servo\"", &format!("title: \"{text}\""));
    let labels = format!("display: \"deg\", label: \"{text}\", legend: [\"{text}\", \"b\"])");
    run(&folder, &model.replace("display: \"deg\")", &labels));
    let harmless = {
        fs::write(folder.join("plain.ron"), MODEL).unwrap();
        assert!(call(&folder, &["run", "plain.ron", "--out", "plain", "--quiet"]).status.success());
        page(&folder, "plain").0
    };
    let (shown, _) = page(&folder, "r");
    let quoted = EVIL.replace('"', "\"\"");
    fs::write(folder.join("t.csv"), format!("time [s],\"{quoted}\"\n0,1\n1,2\n")).unwrap();
    let (table, _) = page(&folder, "t.csv");
    let (compared, _) = {
        assert!(call(&folder, &["run", "model.ron", "--out", "r2", "--quiet"]).status.success());
        let compared = call(&folder, &["compare", "r", "r2", "--html", "both.html"]);
        assert!(compared.status.success(), "{}", said(&compared));
        (fs::read_to_string(folder.join("both.html")).unwrap(), ())
    };
    for shown in [&shown, &table, &compared] {
        assert!(!shown.contains("<img"), "an element came in");
        assert!(!shown.contains('\u{7}'), "a control character came in");
    }
    for shown in [&shown, &compared] {
        assert_eq!(shown.matches("</script").count(), harmless.matches("</script").count());
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn runs_that_were_cut_short_are_shown_as_far_as_they_came() {
    let folder = folder("short");
    run(&folder, &MODEL.replace("stop_time: \"1 s\"", "stop_time: \"20 s\""));
    let file = folder.join("r/signals.rec");
    let whole = fs::read(&file).unwrap();
    fs::remove_file(folder.join("r/signals.csv")).unwrap();
    fs::write(&file, &whole[..whole.len() * 3 / 5]).unwrap();
    let (shown, warned) = page(&folder, "r");
    assert!(warned.contains("This run is not whole"), "{warned}");
    assert!(shown.contains("This run is not whole") && shown.contains("\"title\":\"angle\""));
    fs::write(&file, &whole[..20]).unwrap();
    for gone in [false, true] {
        if gone {
            fs::remove_file(&file).unwrap();
        }
        let refused = call(&folder, &["report", "r", "-o", "new.html"]);
        assert_eq!(refused.status.code(), Some(4));
        assert!(said(&refused).contains("= help"), "{}", said(&refused));
        assert!(!folder.join("new.html").exists());
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn damaged_scenes_and_events_cost_only_what_they_hold() {
    let folder = folder("parts");
    run(&folder, MODEL);
    for (file, text, told) in [
        ("scene.json", "{\"bodies\": [", "The 3D view is missing"),
        (
            "scene.json",
            "{\"bodies\": [], \"shapes\": 3, \"masses\": [], \"frames\": []}",
            "scene.json is not a scene",
        ),
        ("model.json", "[1, 2", "The diagram is missing"),
        ("events.csv", "a,b\n1", "The events cannot be read"),
    ] {
        let place = folder.join("r").join(file);
        let before = fs::read(&place).ok();
        fs::write(&place, text).unwrap();
        let (shown, warned) = page(&folder, "r");
        assert!(warned.contains(told), "{file}: {warned}");
        assert!(shown.contains("\"title\":\"angle\""), "{file}: the pictures are there");
        match before {
            Some(bytes) => fs::write(&place, bytes).unwrap(),
            None => fs::remove_file(&place).unwrap(),
        }
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn two_million_values_make_a_small_page() {
    let folder = folder("large");
    // Two signals at a million times.
    let model = r#"Diagram(
        simulation: (stop_time: "1 s", solver: Ode4(step: "1 us")),
        blocks: {
            "demand": Sine(amplitude: 1.0, frequency: "5 Hz"),
            "plant": LowPass(tau: "50 ms"),
            "s": Scope(inputs: ["a", "b"]),
        },
        connections: ["demand.y -> plant.u, s.a", "plant.y -> s.b"],
    )"#;
    fs::write(folder.join("model.ron"), model).unwrap();
    let run = call(&folder, &["run", "model.ron", "--out", "r", "--quiet", "--no-csv"]);
    assert!(run.status.success(), "{}", said(&run));
    let (shown, _) = page(&folder, "r");
    assert!(shown.len() < 300_000, "{}", shown.len());
    assert!(shown.contains("Thinned to what a screen shows"));
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_page_that_cannot_be_written_is_told_with_its_place_and_leaves_nothing_behind() {
    let folder = folder("place");
    run(&folder, MODEL);
    fs::write(folder.join("file"), "mine").unwrap();
    let mut places = vec!["file/page.html", "no/page.html", ".", "r"];
    // A place where nobody may write, whoever calls.
    if Path::new("/proc/version").is_file() {
        places.push("/proc/page.html");
    }
    for place in places {
        let refused = call(&folder, &["report", "r", "-o", place, "--yes"]);
        let text = said(&refused);
        assert_eq!(refused.status.code(), Some(4), "{place}: {text}");
        assert!(
            text.contains("error[unwritable]: cannot write")
                && text.contains(place)
                && text.contains("= help"),
            "{text}"
        );
    }
    assert_eq!(fs::read_to_string(folder.join("file")).unwrap(), "mine");
    let mut left: Vec<String> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    left.sort();
    assert_eq!(left, ["file", "model.ron", "r"]);
    fs::remove_dir_all(folder).unwrap();
}
