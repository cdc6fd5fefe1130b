//! The page: whole, small, harmless.

use crate::browser::{complaints, program, shown};
use blocksim_report::{
    Animation, BUDGET, Contact, Diagram, Drawing, Event, Inspected, Kind, Level, Net, Overlay, Panel, Probe,
    Report, Role, Rows, Series, Surface, VENDORED, html,
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
                other: None,
            };
            Panel {
                group: "joints".to_owned(),
                title: format!("axis{n}"),
                unit: "°".to_owned(),
                turn: None,
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
        efforts: Vec::new(),
        surfaces: vec![tetrahedron()],
        contacts: vec![Contact {
            from: 1.0,
            to: 1.5,
            names: ["arm", "bench"].map(str::to_owned),
            depth: 0.012,
        }],
        unlooked: vec!["arm".to_owned()],
    }
}

#[test]
fn the_licences_of_its_scripts_go_with_the_page() {
    let page = html(&example(1, 10));
    let texts: Vec<_> = VENDORED.iter().filter(|vendored| vendored.file.ends_with(".LICENSE")).collect();
    assert!(!texts.is_empty());
    for licence in texts {
        // Quotes are written otherwise in HTML; the lines between them are not.
        let plain = |line: &&str| !line.contains(['"', '\'', '<', '>', '&']);
        for line in licence.text.lines().filter(plain) {
            assert!(page.contains(line.trim()), "{}: {line}", licence.file);
        }
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

/// Two levels; the wire of the top carries the set value of the first picture.
fn diagram() -> Diagram {
    let svg = |label: &str| {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200\" height=\"60\" viewBox=\"0 0 200 60\">\
             <g class=\"wire\" data-net=\"0\"><path d=\"M60 30H140\"/></g>\
             <g class=\"block\" data-node=\"0\"><title>{label}</title><path d=\"M10 10h50v40h-50Z\"/></g>\
             <g class=\"block\" data-node=\"1\"><path d=\"M140 10h50v40h-50Z\"/></g></svg>"
        )
    };
    let block = |name: &str, kind: &str| {
        Some(Inspected {
            name: name.to_owned(),
            kind: kind.to_owned(),
            place: "arm.ron:7".to_owned(),
            variant: String::new(),
            parameters: vec![["k".to_owned(), "2 * kp".to_owned(), "3 rad/s".to_owned()]],
        })
    };
    let level = |path: &str, drawing, probes| Level {
        path: path.to_owned(),
        title: "a level".to_owned(),
        drawing,
        blocks: vec![block("joint1", "Subsystem"), block("law", "Gain")],
        probes,
        signals: vec![Some("joint1.q".to_owned())],
        layers: serde_json::Value::Null,
    };
    let net =
        Net { title: "joint1.q -> law.u".to_owned(), nodes: vec![0, 1], ends: Vec::new(), directed: true };
    let probe = Probe { element: String::new(), path: "axis1.set".to_owned() };
    Diagram {
        note: "as it was".to_owned(),
        style: ".wire { stroke: var(--diagram-ink); }".to_owned(),
        drawings: ["outer", "inner"]
            .map(|name| Drawing { svg: svg(name), nets: vec![net.clone()], ..Drawing::default() })
            .to_vec(),
        levels: vec![level("", 0, vec![vec![probe]]), level("joint1", 1, vec![Vec::new()])],
        kinds: vec![Kind {
            name: "Gain".to_owned(),
            does: "Multiplies.".to_owned(),
            parameters: vec![("k".to_owned(), "Factor.".to_owned())],
        }],
    }
}

/// A report in which every text is `text`.
fn all_texts(text: &str) -> Report {
    let own = || text.to_owned();
    let rows = Rows { head: vec![own()], rows: vec![vec![own()]] };
    let mut report = Report { animation: Some(mechanism()), ..example(1, 10) };
    report.title = own();
    report.facts.push((own(), own()));
    report.warnings.push(own());
    let panel = &mut report.panels[0];
    (panel.title, panel.group, panel.unit) = (own(), own(), own());
    panel.series.iter_mut().for_each(|series| (series.name, series.path) = (own(), own()));
    report.metrics = rows.clone();
    report.parameters = rows.clone();
    report.tables.push((own(), rows));
    report.events.push(Event { time: 0.0, path: own(), what: own() });
    report.overlays.push(Overlay {
        name: own(),
        time: vec![0.0, 1.0],
        columns: vec![(own(), own(), vec![0.0, 1.0])],
    });
    let escaped = blocksim_report::escape(text);
    let mut diagram = diagram();
    diagram.note = own();
    diagram.drawings[0].svg = diagram.drawings[0].svg.replace("outer", &escaped);
    diagram.drawings[0].nets[0].title = own();
    diagram.levels[0].title = own();
    diagram.levels[0].probes[0][0] = Probe { element: own(), path: own() };
    diagram.levels[1].path = own();
    for block in diagram.levels[0].blocks.iter_mut().flatten() {
        *block = Inspected {
            name: own(),
            kind: own(),
            place: own(),
            variant: own(),
            parameters: vec![[own(), own(), own()]],
        };
    }
    diagram.kinds[0] = Kind { name: own(), does: own(), parameters: vec![(own(), own())] };
    report.diagram = diagram;
    let animation = report.animation.as_mut().unwrap();
    animation.contacts[0].names = [own(), own()];
    for list in ["bodies", "shapes", "masses", "frames"] {
        for item in animation.scene[list].as_array_mut().unwrap() {
            for name in ["name", "owner"] {
                if item.get(name).is_some() {
                    item[name] = own().into();
                }
            }
        }
    }
    report
}

const EVIL: &str =
    "</script><script>document.title='evil'</script><img src=x onerror=\"document.title='evil'\">\"'&]]><!--";

#[test]
fn no_text_of_a_model_becomes_markup_or_a_script() {
    let page = html(&all_texts(EVIL));
    assert!(!page.contains("<script>document"));
    assert!(!page.contains("<img"));
    let harmless = html(&all_texts("harmless"));
    assert_eq!(page.matches("<script").count(), harmless.matches("<script").count());
}

#[test]
fn the_policy_names_every_script_and_nothing_comes_from_elsewhere() {
    let page = html(&Report { animation: Some(mechanism()), diagram: diagram(), ..example(1, 10) });
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
    let list = include_str!("../../assets/VENDORED.md");
    for file in VENDORED {
        let sum: String = Sha256::digest(file.text).iter().map(|byte| format!("{byte:02x}")).collect();
        let row = list.lines().find(|line| line.starts_with(&format!("| `{}` |", file.file)));
        assert!(row.is_some_and(|row| row.contains(&sum)), "{}: {sum}", file.file);
    }
}

#[test]
fn all_scripts_of_our_own_are_checked() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let checked = std::fs::read_to_string(folder.join("tsconfig.json")).unwrap();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.ends_with(".js") && !name.contains(".min.") {
            assert!(std::fs::read_to_string(&path).unwrap().starts_with("// @ts-check"), "{name}");
            assert!(checked.contains(&format!("\"{name}\"")), "{name} is not in tsconfig.json");
        }
    }
}

#[test]
fn a_browser_shows_the_page_from_disk_without_complaint_with_and_without_webgl() {
    let Some(program) = program() else { return };
    let tables =
        vec![("robot".to_owned(), Rows { head: vec!["name".to_owned()], rows: vec![vec!["m".to_owned()]] })];
    let page =
        html(&Report { animation: Some(mechanism()), diagram: diagram(), tables, ..example(2, 2_000) });
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
        assert!(dom.contains("joint1, Subsystem, Enter goes inside"), "{name}: blocks can be gone into");
        assert!(dom.contains("class=\"value\""), "{name}: values on wires");
        assert!(dom.contains("robot (1)"), "{name}: tables of parameters");
        assert!(dom.contains("1.000 s: arm – bench"), "{name}: contacts are told");
        assert!(
            dom.contains("Contacts of the mesh are not looked for."),
            "{name}: what is not looked at is told"
        );
        assert!(
            dom.contains("<i title=\"arm touches bench\""),
            "{name}: contacts are marked on the time line"
        );
        assert!(complaints(&said).is_empty(), "{name}: {:?}", complaints(&said));
    }
}

#[test]
fn a_browser_takes_no_name_for_markup() {
    let Some(program) = program() else { return };
    let (dom, said) =
        shown(program, &html(&all_texts(EVIL)), "evil", &["--disable-gpu", "--disable-3d-apis"]);
    assert!(dom.contains("data-ready=\"true\""), "{said}");
    assert!(dom.contains("<div id=\"trouble\" role=\"alert\"></div>"), "{dom}");
    assert!(!dom.contains("<img"), "a name became an image");
    assert!(!dom.contains("<title>evil"), "a name became a script");
    assert!(complaints(&said).is_empty(), "{:?}", complaints(&said));
}
