//! What results are looked at with: the mechanism in 3D with speeds, torques and poses, measurements over a run, the written page.

use std::fs;

use blocksim_multibody::EulerZyx;
use serde_json::{Value, json};

use super::browser::Page;
use super::movement::{complaints, row};
use super::{SERVO, Studio, shown};
use crate::desk::Desk;

const THREE: &str = r#"// Two joints that turn and one that slides, driven by torques and a force; where the tool is and how it is turned is measured.
Diagram(
    title: "Three joints",
    simulation: (stop_time: "0.5 s", solver: Ode4(step: "1 ms")),
    blocks: {
        "world": World(gravity: ["0 m/s^2", "0 m/s^2", "0 m/s^2"]),
        "push": Sine(amplitude: "3 N*m", frequency: "2 Hz"),
        "pull": Constant(value: "-1.5 N*m"),
        "press": Constant(value: "4 N"),
        "turn": RevoluteJoint(axis: [0.0, 0.0, 1.0], position: "20 deg"),
        "post": Body(mass: "2 kg", moi: ["0.02 kg*m^2", "0.02 kg*m^2", "0.02 kg*m^2"], shapes: [(kind: Text("box"), size: ["0.1 m", "0.1 m", "0.5 m"], centre: [0, 0, "0.25 m"])]),
        "up": Transform(translation: [0, 0, "0.5 m"]),
        "lift": RevoluteJoint(axis: [0.0, 1.0, 0.0], position: "-30 deg"),
        "arm": Body(mass: "1 kg", com: ["0.2 m", 0, 0], moi: ["0.02 kg*m^2", "0.02 kg*m^2", "0.02 kg*m^2"], shapes: [(kind: Text("box"), size: ["0.4 m", "0.06 m", "0.06 m"], centre: ["0.2 m", 0, 0])]),
        "out": Transform(translation: ["0.4 m", 0, 0]),
        "slide": PrismaticJoint(axis: [1.0, 0.0, 0.0], position: "50 mm"),
        "hand": Body(mass: "0.5 kg", moi: ["0.01 kg*m^2", "0.01 kg*m^2", "0.01 kg*m^2"], shapes: [(kind: Text("sphere"), radius: "40 mm")]),
        "tcp": Transform(translation: ["0.1 m", 0, "20 mm"], rpy: ["40 deg", 0, 0]),
        "place": TransformSensor(),
        "seen": Scope(inputs: ["at", "turned", "speed"]),
        "torques": Scope(inputs: ["first", "second"]),
        "force": Scope(inputs: ["third"]),
        "angle": Scope(inputs: ["set", "actual"], display: "deg"),
        "wanted": Ramp(slope: "1 rad/s"),
    },
    connections: [
        "world.frame <-> turn.base",
        "turn.follower <-> post.frame <-> up.base",
        "up.follower <-> lift.base",
        "lift.follower <-> arm.frame <-> out.base",
        "out.follower <-> slide.base",
        "slide.follower <-> hand.frame <-> tcp.base",
        "tcp.follower <-> place.follower",
        "push.y -> turn.torque",
        "pull.y -> lift.torque",
        "press.y -> slide.force",
        "place.x -> seen.at",
        "place.rpy -> seen.turned",
        "place.v -> seen.speed",
        "turn.tau -> torques.first",
        "lift.tau -> torques.second",
        "slide.f -> force.third",
        "wanted.y -> angle.set",
        "turn.q -> angle.actual",
    ],
)
"#;

/// The page of a run as a file, in a browser.
fn opened(desk: &Desk, file: &str) -> Option<Page> {
    let mut page = Page::new()?;
    page.open(&format!("file://{}", desk.0.join(file).display()));
    page.until("document.documentElement.dataset.ready === 'true'");
    Some(page)
}

/// Texts of a row of the tables of a pose, whose numbers are those of an instant.
fn cells(page: &mut Page, name: &str) -> Vec<String> {
    let row = format!(
        "[...document.querySelectorAll('.poses tr')].find((row) => row.firstElementChild.textContent === {})",
        json!(name)
    );
    let texts = page.value(&format!("[...{row}.children].slice(1).map((cell) => cell.textContent)"));
    texts
        .as_array()
        .expect("cells")
        .iter()
        .map(|text| text.as_str().expect("a text").replace('−', "-"))
        .collect()
}

fn number(text: &str) -> f64 {
    text.split(' ').next().and_then(|text| text.parse().ok()).unwrap_or_else(|| panic!("{text} is a number"))
}

#[test]
fn poses_torques_and_speeds_of_a_run_are_seen() {
    let desk = Desk::with(&[("three.ron", THREE)]);
    for words in [&["run", "three.ron", "--out", "one", "--quiet"][..], &["report", "one"]] {
        let done = desk.call(words);
        assert_eq!(done.code, Some(0), "{}", done.err);
    }
    // The torques are found by what is recorded, whatever the scope is called.
    let scene: Value = serde_json::from_str(&desk.read("one/scene.json")).expect("a scene");
    let actuators = json!([
        { "body": 1, "signal": "torques.first" }, { "body": 2, "signal": "torques.second" }, { "body": 3, "signal": "force.third" }
    ]);
    assert_eq!(scene["actuators"], actuators);
    let table = desk.read("one/signals.csv");
    let Some(mut page) = opened(&desk, "one/report.html") else { return };
    assert_eq!(page.value("document.querySelector('.poses').hidden"), true);
    page.key("j");
    assert_eq!(page.value("document.querySelector('.poses').hidden"), false);
    for t in [0.0, 0.042, 0.2, 0.291, 0.5] {
        let clock = page.value(&format!("R.setTime({t}); R.time({t})"));
        page.until(&format!(
            "document.querySelector('.poses .note span').textContent === '{} s'",
            clock.as_str().expect("a time")
        ));
        let seen = row(
            &table,
            t,
            &["seen.at[0]", "seen.at[1]", "seen.at[2]", "seen.turned[0]", "seen.turned[1]", "seen.turned[2]"],
        );
        for (n, name) in ["x", "y", "z"].into_iter().enumerate() {
            assert!((number(&cells(&mut page, name)[0]) - 1e3 * seen[n]).abs() < 0.06, "{name} at {t} s");
        }
        for (n, name) in [(5, "α about z"), (4, "β about the new y"), (3, "γ about the new x")] {
            assert!(
                (number(&cells(&mut page, name)[0]) - seen[n].to_degrees()).abs() < 0.011,
                "{name} at {t} s"
            );
        }
        let joints =
            row(&table, t, &["angle.set", "angle.actual", "torques.first", "torques.second", "force.third"]);
        let turn = cells(&mut page, "turn");
        let [set, actual] = [joints[0], joints[1]].map(f64::to_degrees);
        assert!(
            (number(&turn[0]) - actual).abs() < 0.011 && (number(&turn[1]) - set).abs() < 0.011,
            "{turn:?}"
        );
        assert!((number(&turn[2]) - (set - actual)).abs() < 0.011 && turn[3] == "°", "{turn:?}");
        assert!(
            (number(&turn[4]) - joints[2]).abs() < 2e-3 && turn[4].ends_with(" N·m"),
            "{turn:?} at {t} s"
        );
        assert!((number(&turn[5]) - 100.0 * joints[2].abs() / 3.0).abs() < 0.6, "{turn:?} at {t} s");
        assert_eq!(cells(&mut page, "lift")[4..], ["-1.5 N·m", "100 %"]);
        assert_eq!(cells(&mut page, "slide")[3..], ["mm", "4 N", "100 %"]);
    }
    // Real tables, for those who do not see them.
    let tree = page.tree();
    let of = |role: &str, name: &str| {
        tree.iter().any(|node| node["role"]["value"] == role && node["name"]["value"] == name)
    };
    assert!(
        of("table", "Joints")
            && of("table", "Tool: tcp")
            && of("rowheader", "lift")
            && of("columnheader", "set value")
    );
    // What colours and arcs mean: the largest speed of the tool, and of each joint the largest torque.
    let legend = page
        .value("document.querySelector('.space-legend').textContent")
        .as_str()
        .expect("a text")
        .to_owned();
    assert!(
        legend.contains("largest of each joint in this run: turn 3 N·m, lift 1.5 N·m, slide 4 N."),
        "{legend}"
    );
    let most =
        legend.split("0  ").nth(1).and_then(|rest| rest.split(" mm/s").next()).map(number).expect("a speed");
    let recorded = (0..=500).map(|n| {
        let v = row(&table, f64::from(n) * 1e-3, &["seen.speed[0]", "seen.speed[1]", "seen.speed[2]"]);
        1e3 * v.iter().map(|x| x * x).sum::<f64>().sqrt()
    });
    let fastest = recorded.fold(0.0, f64::max);
    assert!((most / fastest - 1.0).abs() < 0.01, "{most} mm/s, {fastest} mm/s recorded");
    // An arc goes from its begin about the axis as the torque does, three quarters of a turn where it is largest.
    let arcs = page.value(
        "(() => { const { scene } = R.Space.stage(), all = R.efforts(scene, R.data.space.efforts), S = R.Shapes, found = []; \
         for (const t of [1 / 24, 0.25 + 1 / 24]) { R.setTime(t); const pen = { solid: (mesh, place) => { const corner = (n) => S.point(place, mesh.triangles.slice(n, n + 3)), centre = S.point(place, [0, 0, 0]); \
         found.push([corner(6), corner(mesh.triangles.length - 6)].map((p) => p.map((x, k) => x - centre[k]))); } }; all.draw(pen, R.Space.poses(false, t), R.data.space.time, () => [0, 0, 0]); } return found; })()",
    );
    for (n, share) in [(0, 0.5), (3, -0.5)] {
        let [[a, b, _], [c, d, _]] =
            [0, 1].map(|k| [0, 1, 2].map(|axis| arcs[n][k][axis].as_f64().expect("a number")));
        let turned = (a * d - b * c).atan2(a * c + b * d);
        assert!((turned - share * 1.5 * std::f64::consts::PI).abs() < 0.05, "{turned} rad at {share}");
    }
    // They are put away by keys.
    page.key("e");
    page.key("s");
    page.until("document.querySelector('.space-legend').hidden");
    assert_eq!(complaints(&page), Vec::<&String>::new());
}

#[test]
fn orientations_are_those_of_the_program() {
    let desk = Desk::with(&[("three.ron", THREE)]);
    for words in [&["run", "three.ron", "--out", "one", "--quiet"][..], &["report", "one"]] {
        assert_eq!(desk.call(words).code, Some(0));
    }
    let Some(mut page) = opened(&desk, "one/report.html") else { return };
    for [alpha, beta, gamma] in [
        [0.3, -0.4, 2.0],
        [-3.0, 1.2, -3.0],
        [0.7, std::f64::consts::FRAC_PI_2, 0.4],
        [1.0, -std::f64::consts::FRAC_PI_2, 2.5],
        [0.0; 3],
    ] {
        let rotation = EulerZyx { alpha, beta, gamma }.rotation();
        let expected = EulerZyx::from_rotation(&rotation);
        let mut matrix = [0.0; 16];
        for (row, column) in (0..9).map(|n| (n % 3, n / 3)) {
            matrix[4 * column + row] = rotation[(row, column)];
        }
        let found = page.value(&format!(
            "R.poseTable(R.Space.stage().scene, 'tool', {{ set: false, efforts: null }}).euler({})",
            json!(matrix)
        ));
        for (n, angle) in [expected.alpha, expected.beta, expected.gamma].into_iter().enumerate() {
            assert!(
                (found[n].as_f64().expect("an angle") - angle.to_degrees()).abs() < 1e-6,
                "{found}, {expected:?}"
            );
        }
    }
}

/// A measurement of the angle of the servo: in rad and ms, with decimal commas, 0.12 s early and half as large.
fn measured(signals: &str) -> String {
    let heads: Vec<&str> = signals.lines().next().expect("a head").split(',').collect();
    let at = heads.iter().position(|head| head.starts_with("scope.actual")).expect("a signal");
    let mut text = String::from("# bench 3\nZeit;Winkel;Strom [A]\n");
    for line in signals.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let line = format!("{};{};{}\n", 1e3 * (cells[0] - 0.12), 0.5 * cells[at], 0.25);
        text.push_str(&line.replace('.', ","));
    }
    text
}

#[test]
fn a_measured_table_is_laid_over_a_run() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let run = desk.call(&["run", "servo.ron", "--out", "runs/first", "--quiet"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let signals = desk.read("runs/first/signals.csv");
    fs::create_dir(desk.0.join("data")).expect("a folder");
    fs::write(desk.0.join("data/bench.csv"), measured(&signals)).expect("a file");
    fs::write(desk.0.join("data/words.csv"), "time,q\n0,1\nsoon,2\n").expect("a file");
    let studio = Studio::of(&desk, &["--edit"]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#runs'");
    page.until(
        "[...document.querySelectorAll('.measured button')].some((one) => one.textContent === '+ CSV')",
    );
    page.value("[...document.querySelectorAll('.measured button')].find((one) => one.textContent === '+ CSV').click()");
    let field = |name: &str| format!("document.querySelector('.measured [aria-label=\"{name}\"]')");
    let told =
        |name: &str| format!("({}.closest('tr') ?? {}.closest('label')).innerText", field(name), field(name));
    // Separators and decimals are found, and shown with the begin of the table.
    page.until("document.querySelector('.measured [role=status]')?.textContent.startsWith('Columns are separated by semicolons, decimals by a comma')");
    page.until("document.querySelector('.measured table[aria-label=\"Beginning of the table\"] td').textContent === '-120'");
    assert_eq!(page.value(&format!("{}.value", field("Time column"))), "Zeit");
    page.until(
        "document.querySelector('.measured-seen > .told').textContent.includes('no column is a signal')",
    );
    // Each mistake stands at its field, and what was typed stays.
    let type_in = |page: &mut Page, name: &str, text: &str| {
        page.value(&format!("{}.focus()", field(name)));
        page.replace(text);
    };
    type_in(&mut page, "Signal of Winkel", "scope.actul");
    page.until(&format!("{}.includes('did you mean `scope.actual`?')", told("Signal of Winkel")));
    type_in(&mut page, "Signal of Winkel", "scope.actual");
    for (name, wrong, says, right) in [
        ("Unit of Winkel", "kg", "the column is in kg, and `scope.actual` in deg", "rad"),
        ("Unit of Winkel", "furlong", "the unit is not known", "rad"),
        ("Scale of Winkel", "0", "0 is not a scale", "2"),
        ("Scale of Winkel", "twice", "twice is not a number", "2,0"),
        ("Unit of the time", "kg", "kg is not a unit of time", "ms"),
        ("Shift", "3 kg", "a time has a unit such as s or ms", "0 s"),
    ] {
        type_in(&mut page, name, wrong);
        page.until(&format!("{}.includes({})", told(name), json!(says)));
        assert_eq!(page.value(&format!("{}.getAttribute('aria-invalid')", field(name))), "true");
        assert_eq!(page.value(&format!("{}.value", field(name))), wrong);
        type_in(&mut page, name, right);
        page.until(&format!("!{}.includes({})", told(name), json!(says)));
    }
    page.until("document.querySelector('.measured [role=status]').textContent.includes('-0.12 s to') || document.querySelector('.measured [role=status]').textContent.includes('−0.12 s to')");
    page.value("[...document.querySelectorAll('.measured button')].find((one) => one.textContent === 'Align').click()");
    page.until(&format!("{}.value !== '0 s'", field("Shift")));
    let shift = page.value(&format!("{}.value", field("Shift")));
    let shift = shift.as_str().map(number).expect("a shift");
    assert!((shift - 0.12).abs() < 5e-3, "{shift} s");
    type_in(&mut page, "Shift", "120 ms");
    // A name that leads elsewhere is refused.
    type_in(&mut page, "Name of the measurement", "../bench");
    page.value("[...document.querySelectorAll('.measured button')].find((one) => one.textContent === 'Keep').click()");
    page.until(
        "document.getElementById('status').textContent.includes('the name of a measurement is a word')",
    );
    type_in(&mut page, "Name of the measurement", "bench");
    page.value("[...document.querySelectorAll('.measured button')].find((one) => one.textContent.includes('show over')).click()");
    page.until("document.querySelector('iframe.run-page')?.src.endsWith('/runs/first*bench')");
    page.until("document.querySelector('.measured-switches input')?.checked");
    let kept = desk.read("measured/bench.ron");
    assert!(
        kept.contains("file: Text(\"../data/bench.csv\")") && kept.contains("shift: \"0.12 s\""),
        "{kept}"
    );
    assert_eq!(
        complaints(&page).iter().filter(|one| !one.contains("409")).count(),
        0,
        "{:?}",
        page.complaints
    );
    // The same on the command line: it lies on the curve of the run, in its picture.
    let report = desk.call(&["report", "runs/first", "--overlay", "measured/bench.ron", "-o", "bench.html"]);
    assert_eq!((report.code, report.err.as_str()), (Some(0), ""));
    let Some(mut page) = opened(&desk, "bench.html") else { return };
    let off = page.value(
        "(() => { const [course] = R.Overlay.courses, panel = R.data.panels[course.panel], s = panel.series.find((one) => one.path === 'scope.actual'); \
         let most = 0; course.time.forEach((t, n) => { const there = R.at(panel.time, s.values, t + course.shift); if (Number.isFinite(there)) most = Math.max(most, Math.abs(course.values[n] * course.factor - there)); }); \
         return [R.Overlay.courses.length, course.unit, most, Math.max(...course.values)]; })()",
    );
    assert_eq!((&off[0], &off[1]), (&json!(1), &json!("°")));
    assert!(
        off[2].as_f64().is_some_and(|most| most < 0.2) && off[3].as_f64().is_some_and(|most| most > 89.0),
        "{off}"
    );
    // What does not fit a run is a warning of its page.
    let other = kept.replace("scope.actual", "scope.acutal");
    fs::write(desk.0.join("measured/other.ron"), other).expect("a file");
    let report = desk.call(&["report", "runs/first", "--overlay", "measured/other.ron", "-o", "other.html"]);
    assert!(report.err.contains("`first` has no signal `scope.acutal`"), "{}", report.err);
    // Strangers to the project are not read, and without --edit nothing is written.
    let look = |file: &str| studio.asked("POST", "/api/measured", &[], &json!({ "file": file }).to_string());
    assert!(look("../secret.csv").contains("409") && look("/etc/passwd").contains("409"));
    assert!(look("data/words.csv").contains("`soon` is not a number"), "{}", look("data/words.csv"));
    assert_eq!(studio.status("GET", "/runs/first*..%2Fbench", &[], ""), 409);
    assert_eq!(studio.interrupt(), Some(0));
    let plain = Studio::of(&desk, &[]);
    for path in ["/api/measure", "/api/table"] {
        assert_eq!(plain.status("POST", path, &[], r#"{"name": "x", "text": "time,q\n0,1\n"}"#), 409);
    }
    assert_eq!(desk.names("measured"), ["bench.ron", "other.ron"]);
}

#[test]
fn a_table_from_elsewhere_is_taken_into_the_project_once() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &["--edit"]);
    let take = |name: &str, text: &str| {
        studio.asked("POST", "/api/table", &[], &json!({ "name": name, "text": text }).to_string())
    };
    assert!(take("../../bench 3.csv", "time,q\n0,1\n").contains("measured/bench_3.csv"));
    assert_eq!(desk.read("measured/bench_3.csv"), "time,q\n0,1\n");
    // The same again changes nothing, and another one of this name replaces nothing.
    assert!(take("bench 3.csv", "time,q\n0,1\n").contains("measured/bench_3.csv"));
    assert!(take("bench 3.csv", "time,q\n0,2\n").contains("already exists"));
    assert_eq!(desk.read("measured/bench_3.csv"), "time,q\n0,1\n");
}

#[test]
fn the_written_page_has_what_is_asked_for() {
    let desk = Desk::with(&[("three.ron", THREE), ("servo.ron", SERVO)]);
    for words in [
        &["run", "three.ron", "--out", "runs/one", "--quiet"][..],
        &["report", "runs/one", "-o", "part.html", "--sections", "3d,events", "--author", "Ada <Lovelace>"],
    ] {
        let done = desk.call(words);
        assert_eq!(done.code, Some(0), "{}", done.err);
    }
    let part = desk.read("part.html");
    assert!(part.contains("<dt>Author</dt><dd>Ada &lt;Lovelace&gt;</dd>"));
    assert!(
        part.contains("id=\"space\"")
            && !part.contains("<section id=\"scopes\"")
            && !part.contains("<section id=\"diagram\"")
    );
    for (words, says) in [
        (&["--sections", "3d", "--no-3d"][..], "--sections asks for 3d, and --no-3d leaves it out"),
        (&["--author", " "], "the name of the author is empty"),
        (&["--sections", "films"], "invalid value 'films'"),
    ] {
        let refused = desk.call(&[&["report", "runs/one", "-o", "never.html"][..], words].concat());
        assert!(refused.code == Some(2) && refused.err.contains(says), "{}", refused.err);
    }
    assert!(!desk.0.join("never.html").exists());
    // Without scopes the time is that of the movement.
    let Some(mut page) = opened(&desk, "part.html") else { return };
    assert_eq!(page.value("R.span[0] === 0 && R.span[1] === 0.5"), true);
    page.key("End");
    page.until("R.now === 0.5");
    assert_eq!(complaints(&page), Vec::<&String>::new());
    // The studio writes what the command does.
    let studio = Studio::of(&desk, &["three.ron"]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#runs/one'");
    page.until("document.querySelector('.written summary')");
    page.value("document.querySelector('.written summary').click(); [...document.querySelectorAll('.written label')].filter((one) => / (scopes|planes|diagram|tracking|parameters)$/.test(one.textContent)).forEach((one) => one.click())");
    page.value("document.querySelector('.written input[type=text]').focus()");
    page.insert("Ada <Lovelace>");
    page.until("document.querySelector('.written code').textContent === \"blocksim report one --sections 3d,events --author 'Ada <Lovelace>'\"");
    page.value("[...document.querySelectorAll('#runs-view button')].find((one) => one.textContent === 'Write report.html').click()");
    page.until("document.querySelector('#runs-view .note').textContent.includes('report.html is written')");
    assert!(desk.read("runs/one/report.html") == part);
}

#[test]
fn set_values_of_joints_are_a_ghost_while_a_run_goes_on() {
    let desk = Desk::with(&[("three.ron", THREE)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#run'");
    page.value("R.Desk.ask('run', { speed: 0.5 }).then(() => null)");
    page.until("R.Live.rows() > 10 && window.__m.movement_frames > 0");
    page.until("/ s simulated/.test(document.querySelector('.run-line').textContent) && R.Live.rows() > 300");
    let table = desk.read(&format!("runs/{}/signals.csv", desk.names("runs")[0]));
    page.until("R.Movement.view.stage().movement.time.at(-1) === 0.5");
    let ghost = "[...document.querySelectorAll('#movement .space-bar label')].find((one) => one.textContent.includes('set value'))";
    assert_eq!(page.value(&format!("{ghost}.hidden")), false);
    for t in [0.1, 0.25, 0.5] {
        let at = page.value(&format!(
            "(() => {{ const {{ time, positions, set }} = R.Movement.view.stage().movement; return [set, positions].map((all) => all.map((one) => R.at(time, one, {t}))); }})()"
        ));
        let [set, actual] = row(&table, t, &["angle.set", "angle.actual"])[..] else { panic!("two signals") };
        let near = |value: &Value, expected: f64| (value.as_f64().expect("a number") - expected).abs() < 1e-5;
        assert!(
            near(&at[0][0], set) && near(&at[1][0], actual),
            "{at} at {t} s, recorded {set} and {actual}"
        );
        // What has no set value is where it should be.
        assert!(at[0][1] == at[1][1] && at[0][2] == at[1][2], "{at}");
    }
    assert_eq!(complaints(&page), Vec::<&String>::new());
}

#[test]
fn scopes_that_fill_piece_by_piece_look_as_if_they_were_drawn_at_once() {
    let text = SERVO.replace("\"2 s\"", "\"4 s\", solver: Ode4(step: \"2 ms\")");
    let desk = Desk::with(&[("servo.ron", &text)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#run'");
    page.value("R.Desk.ask('run', { speed: 1 }).then(() => null)");
    page.until("R.Live.rows() > 10");
    // How often the picture is given rows, and how often it is drawn as a whole.
    page.value(
        "(() => { const u = R.data.panels[0].main; for (const look of u.series) look.dash = []; R.data.panels[0].stale = true; window.given = window.whole = 0; for (const [name, count] of [['setData', 'given'], ['setScale', 'whole']]) { const does = u[name]; u[name] = (...all) => { window[count]++; return does(...all); }; } })()",
    );
    page.until("R.now > 2.6");
    page.key(" ");
    page.until("document.querySelector('.run-line').textContent.includes('paused')");
    let counts = page.value("[window.given, window.whole]");
    let [given, whole] = [0, 1].map(|n| counts[n].as_u64().expect("a count"));
    assert!(given > 10 && whole < given / 2, "{counts}");
    page.drawn();
    let off = page.value(
        "(async () => { const u = R.data.panels[0].main, { width, height } = u.ctx.canvas, look = () => u.ctx.getImageData(0, 0, width, height).data; \
         const before = look(), { min, max } = u.scales.y; R.data.panels[0].reach = () => [min, max]; u.redraw(true, false); await new Promise((done) => setTimeout(done, 100)); const after = look(); let off = 0, ink = 0; \
         for (let n = 0; n < before.length; n += 4) { if (after[n + 3] > 40) ink++; if ([0, 1, 2, 3].some((k) => Math.abs(before[n + k] - after[n + k]) > 60)) off++; } return [off, ink]; })()",
    );
    let [off, ink] = [0, 1].map(|n| off[n].as_u64().expect("a count"));
    // But for where pieces meet; lines are not dashed here, whose dashes begin elsewhere.
    assert!(ink > 1000 && off < ink / 20, "{off} of {ink} dots differ");
    page.value("R.Desk.ask('control', { do: 'speed', speed: 0 }).then(() => R.Desk.ask('control', { do: 'go' })).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('4 s simulated')");
    page.until(
        "R.data.panels[0].drawn === R.Live.rows() && R.data.panels[0].main.data[0].length === R.Live.rows()",
    );
    assert_eq!(complaints(&page), Vec::<&String>::new());
}
