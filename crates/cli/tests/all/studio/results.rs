//! What results are looked at with: the mechanism in 3D with speeds, torques and poses, measurements over a run, the written page.

use blocksim_multibody::EulerZyx;
use serde_json::{Value, json};

use super::browser::Page;
use super::movement::{complaints, row};
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
