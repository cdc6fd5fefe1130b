//! The page: whole, small, harmless.

use std::io::Write;

use blocksim_report::{
    Animation, BUDGET, Event, Level, Panel, Report, Role, Rows, Series, Surface, VENDORED, html,
};
use serde_json::json;
use sha2::{Digest, Sha256};

/// Pictures of a set value and a noisy actual value.
fn example(panels: usize, rows: usize) -> Report {
    let mut noise = 1_u64;
    let mut random = || {
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (noise >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
    };
    let panels = (1..=panels)
        .map(|n| {
            let time: Vec<f64> = (0..rows).map(|k| k as f64 * 1e-3).collect();
            let set: Vec<f64> = time.iter().map(|t| 60.0 * (t * 0.05 * n as f64).sin()).collect();
            let actual = set.iter().map(|x| x + 0.1 * random()).collect();
            let series = |name: &str, role, values| Series {
                name: name.to_owned(),
                path: format!("axis{n}.{name}"),
                role,
                held: false,
                values,
            };
            Panel {
                group: "joints".to_owned(),
                title: format!("axis{n}"),
                unit: "°".to_owned(),
                time,
                series: vec![series("set", Role::Set, set), series("actual", Role::Actual, actual)],
            }
        })
        .collect();
    Report { title: "arm".to_owned(), panels, ..Report::default() }
}

/// Half a metre along each axis.
fn tetrahedron() -> Surface {
    let most = u16::MAX;
    Surface {
        low: [0.0; 3],
        step: [0.5 / f64::from(most); 3],
        corners: vec![0, most, 0, 0, 0, 0, most, 0, 0, 0, 0, most],
        triangles: vec![0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3],
    }
}

fn mechanism() -> Animation {
    let scene = json!({
        "bodies": [
            { "name": "world", "parent": null, "translation": [0, 0, 0], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "motion": { "kind": "fixed" }, "start": [] },
            { "name": "arm", "parent": 0, "translation": [0, 0, 1], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "motion": { "kind": "turn", "axis": [0, 1, 0], "signal": "arm.q" }, "start": [0] },
        ],
        "shapes": [
            { "body": 0, "owner": "base", "use": "both", "kind": "cylinder", "radius": 0.1, "length": 1.0, "translation": [0, 0, 0.5], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "colour": null },
            { "body": 1, "owner": "arm", "use": "both", "kind": "box", "size": [0.1, 0.1, 0.8], "translation": [0, 0, 0.4], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "colour": null },
            { "body": 1, "owner": "arm", "use": "visual", "kind": "mesh", "file": "horn.stl", "scale": [1, 1, 1], "surface": 0, "translation": [0, 0, 0.4], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "colour": [0.2, 0.5, 0.3, 1] },
        ],
        "masses": [{ "body": 1, "owner": "arm", "mass": 2.0, "com": [0, 0, 0.4] }],
        "frames": [{ "body": 1, "name": "tcp", "translation": [0, 0, 0.8], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }],
    });
    let time: Vec<f64> = (0..200).map(|k| f64::from(k) * 0.05).collect();
    let angle: Vec<f64> = time.iter().map(|t| t.sin()).collect();
    Animation {
        scene,
        set: Some(vec![angle.iter().map(|q| q + 0.1).collect()]),
        time,
        positions: vec![angle],
        surfaces: vec![tetrahedron()],
    }
}

#[test]
fn a_page_with_six_times_a_hundred_thousand_values_and_a_robot_stays_within_its_budget() {
    let report = Report { animation: Some(mechanism()), ..example(6, 100_000) };
    let page = html(&report);
    assert!(page.len() <= BUDGET, "{}", page.len());
    let full = html(&Report { full: true, ..report });
    assert!(full.len() > page.len());
}

#[test]
fn no_text_of_a_model_becomes_markup_or_a_script() {
    let evil = "</script><script>alert(1)</script><img src=x onerror=alert(1)>\"'&";
    let mut report = example(1, 10);
    report.title = evil.to_owned();
    report.facts.push((evil.to_owned(), evil.to_owned()));
    report.warnings.push(evil.to_owned());
    report.panels[0].title = evil.to_owned();
    report.panels[0].group = evil.to_owned();
    report.panels[0].series[0].name = evil.to_owned();
    report.metrics = Rows { head: vec![evil.to_owned()], rows: vec![vec![evil.to_owned()]] };
    report.parameters = report.metrics.clone();
    report.events.push(Event { time: 0.0, path: evil.to_owned(), what: evil.to_owned() });
    report.levels.push(Level { path: evil.to_owned(), title: evil.to_owned(), svg: String::new() });
    let page = html(&report);
    assert!(!page.contains("<script>alert"));
    assert!(!page.contains("<img"));
    let harmless = html(&example(1, 10)).matches("<script").count();
    assert_eq!(page.matches("<script").count(), harmless);
}

#[test]
fn the_policy_names_every_script_and_nothing_comes_from_elsewhere() {
    let page = html(&Report { animation: Some(mechanism()), ..example(1, 10) });
    let policy =
        page.split("Content-Security-Policy\" content=\"").nth(1).unwrap().split('"').next().unwrap();
    assert!(policy.starts_with("default-src 'none'; script-src 'sha256-"), "{policy}");
    assert!(!policy.contains("script-src 'unsafe"), "{policy}");
    assert_eq!(policy.matches("'sha256-").count(), page.matches("<script>").count());
    for foreign in ["src=\"http", "href=\"http", "url(http", "@import"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
}

#[test]
fn a_run_without_signals_is_a_page_that_says_so() {
    let page = html(&Report { title: "nothing".to_owned(), ..Report::default() });
    assert!(page.contains("The run has no signals to show."));
    assert!(page.contains("<h1>nothing</h1>"));
}

#[test]
fn files_of_other_projects_are_listed_with_their_checksums() {
    let list = include_str!("../assets/VENDORED.md");
    for file in VENDORED {
        let sum: String = Sha256::digest(file.text).iter().map(|byte| format!("{byte:02x}")).collect();
        let row = list.lines().find(|line| line.starts_with(&format!("| `{}` |", file.file)));
        assert!(row.is_some_and(|row| row.contains(&sum)), "{}: {sum}", file.file);
    }
}

#[test]
fn own_scripts_say_that_they_can_be_checked() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.ends_with(".js") && !name.contains(".min.") {
            assert!(std::fs::read_to_string(&path).unwrap().starts_with("// @ts-check"), "{name}");
        }
    }
}

/// The program of the browser, if one is installed.
fn browser() -> Option<&'static str> {
    let works = |name: &&str| {
        std::process::Command::new(name).arg("--version").output().is_ok_and(|out| out.status.success())
    };
    ["chromium", "chromium-browser", "google-chrome"].into_iter().find(works)
}

/// The page after its scripts have run, and what the browser said.
fn shown(program: &str, page: &str, name: &str, flags: &[&str]) -> (String, String) {
    let folder = std::env::temp_dir().join(format!("blocksim-report-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("page.html");
    std::fs::write(&file, page).unwrap();
    let out = std::process::Command::new(program)
        .args([
            "--headless",
            "--no-sandbox",
            "--enable-logging=stderr",
            "--virtual-time-budget=20000",
            "--dump-dom",
        ])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .args(flags)
        .arg(format!("file://{}", file.display()))
        .output()
        .unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    (String::from_utf8_lossy(&out.stdout).into_owned(), String::from_utf8_lossy(&out.stderr).into_owned())
}

#[test]
fn a_browser_shows_the_page_from_disk_without_complaint_with_and_without_webgl() {
    let Some(program) = browser() else {
        let required = std::env::var("BLOCKSIM_BROWSER").is_ok_and(|value| value == "required");
        assert!(!required, "no Chromium is installed, and BLOCKSIM_BROWSER=required");
        let notice = "SKIPPED: no Chromium is installed; the page was not looked at in a browser";
        let _ = writeln!(std::io::stderr(), "{notice}");
        return;
    };
    let page = html(&Report { animation: Some(mechanism()), ..example(2, 2_000) });
    let software = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
    for (name, flags, drawn_by) in [
        ("webgl", &software[..], "WebGL"),
        ("flat", &["--disable-gpu", "--disable-3d-apis"][..], "wire frame"),
    ] {
        let (dom, said) = shown(program, &page, name, flags);
        assert!(dom.contains("data-ready=\"true\""), "{name}: {said}");
        assert!(dom.contains(&format!("data-space=\"{drawn_by}\"")), "{name}");
        assert!(dom.contains("<div id=\"trouble\" role=\"alert\"></div>"), "{name}");
        assert_eq!(dom.matches("class=\"uplot").count(), 4, "{name}: two pictures and two strips");
        let complaints: Vec<&str> = said.lines().filter(|line| line.contains(":CONSOLE")).collect();
        assert!(complaints.is_empty(), "{name}: {complaints:?}");
    }
}
