//! Where what can be turned stands: with the run, whoever has turned it, in units of its own; and which run is one of which model.

use std::fs;
use std::time::{Duration, Instant};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::browser::Page;
use super::{Studio, shown};
use crate::desk::Desk;

const KNOB: &str = r#"Diagram(
    title: "Knob",
    simulation: (stop_time: "600 s", solver: Ode4(step: "10 ms")),
    blocks: {
        "demand": Constant(value: "0.5 m"),
        "lag": LowPass(tau: "1 s"),
        "scope": Scope(inputs: ["set", "actual"], display: "m"),
    },
    connections: ["demand.y -> lag.u, scope.set", "lag.y -> scope.actual"],
    panel: [Slider("demand.value", "0 .. 1 m"), Knob("demand.value", "0 .. 1000 mm"), Gauge("lag.y")],
)
"#;

/// What the slider and the knob stand at, and what is told of the slider.
const PANEL: &str = "R.Panel.elements().slice(0, 2).map((one) => one.text()).join() + '; ' + R.Panel.elements()[0].note.textContent";
/// The command that repeats the run.
const COMMAND: &str = "document.querySelector('.command code').textContent";

/// Types a value on the screen of parameters and runs with it.
fn run_with(page: &mut Page, name: &str, value: &str) {
    page.value("location.hash = '#values'");
    let field = format!("document.querySelector('#values-view input[aria-label=\"{name}\"]')");
    page.until(&field);
    page.value(&format!("{field}.focus()"));
    page.replace(value);
    page.value(&format!("[...{field}.closest('td').querySelectorAll('button')].find((one) => one.textContent === 'Run with it').click()"));
    page.until("document.querySelector('.run-line').textContent.includes(' of 600 s') && R.Live.rows() > 20");
    page.value("document.activeElement.blur()");
}

fn end(page: &mut Page) {
    page.value("R.Live.end()");
    page.until("document.querySelector('.run-line').textContent.includes('ended at')");
}

#[test]
fn a_panel_stands_where_the_run_does_whoever_has_turned_it() {
    let desk = Desk::with(&[("knob.ron", KNOB)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.until("R.Panel.elements().length === 3");
    // What stands in the panel is for the next run, however that is begun.
    page.value("R.Panel.elements()[0].set(1, true)");
    page.until(&format!("{PANEL} === '1 m,500 mm; for the next run'"));
    page.value("R.record('demand.y')");
    run_with(&mut page, "lag.tau", "2 s");
    let command = page.value(COMMAND);
    assert_eq!(
        command,
        "blocksim run knob.ron --set \"demand.value=1 m\" --set \"lag.tau=2 s\" --record demand.y"
    );
    // One value, in the unit of each.
    page.until(&format!("{PANEL} === '1 m,1000 mm; '"));
    end(&mut page);
    // A value in another unit than that of the panel, and one that is computed; back in the run, and in the next one.
    for (typed, slider, knob) in [("200 mm", "0.2 m", "200 mm"), ("2 * 15 cm", "0.3 m", "300 mm")] {
        run_with(&mut page, "demand.value", typed);
        page.until(&format!("{PANEL} === '{slider},{knob}; '"));
        page.value("R.Panel.elements()[0].set(0.7, true)");
        page.until(&format!("/^0.7 m,700 mm; since/.test({PANEL})"));
        page.value("R.Desk.ask('control', { do: 'back', t: 0.02 }).then(() => null)");
        page.until(&format!("{PANEL} === '{slider},{knob}; '"));
        end(&mut page);
    }
    assert_eq!(page.value("R.Panel.settings().join()"), "demand.value=0.3 m,demand.value=300 mm");
    // Turned in one tab, it is so in another one, and behind a reload.
    page.key("F5");
    page.until("document.querySelector('.run-line').textContent.includes(' of 600 s') && R.Live.rows() > 20");
    page.value("R.Panel.elements()[0].set(0.9, true)");
    page.until(&format!("/^0.9 m,900 mm; since/.test({PANEL})"));
    page.open(&studio.address);
    page.until("document.documentElement.dataset.ready === 'true'");
    page.until(&format!("/^0.9 m,900 mm; since/.test({PANEL})"));
    page.until("R.Futures.instants().map((one) => one.text).join() === 'demand.value=0.9 m'");
    page.tab();
    page.open(&studio.address);
    page.until(&format!("/^0.9 m,900 mm; since/.test({PANEL})"));
    page.value("R.Panel.elements()[1].set(400, true)");
    page.turn_to(0);
    page.until(&format!("/^0.4 m,400 mm; since/.test({PANEL})"));
    end(&mut page);
    assert_eq!(desk.read("knob.ron"), KNOB);
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_run_of_one_model_is_none_of_another() {
    let model = |value: &str, range: &str| {
        KNOB.replace("0.5 m", value).replace("0 .. 1 m", range).replace("0 .. 1000 mm", range)
    };
    let (first, second) = (model("7 m", "0 .. 10 m"), model("20 mm", "0 .. 100 mm"));
    let desk = Desk::with(&[]);
    fs::create_dir(desk.0.join("models")).expect("a folder");
    for (name, text) in [("a", &first), ("b", &second)] {
        fs::write(desk.0.join(format!("models/{name}.ron")), text).expect("a file");
    }
    let studio = Studio::of(&desk, &["models"]);
    let Some(mut page) = shown(&studio) else { return };
    let choose = |page: &mut Page, model: &str| {
        page.value(&format!("(() => {{ const choice = document.getElementById('models'); choice.value = '{model}'; choice.dispatchEvent(new Event('change')); }})()"));
        page.until(&format!("R.Project.known().model === '{model}'"));
    };
    let values = "[...document.querySelectorAll('#diagram-view .value')].map((one) => one.textContent)";
    let gauge = "document.querySelector('.gauge b').textContent";
    choose(&mut page, "a.ron");
    page.value("location.hash = '#diagram'");
    page.key("F5");
    page.until("R.Live.rows() > 20");
    page.value("location.hash = '#diagram'");
    page.until(&format!("{values}.includes('7 m') && {gauge} !== '–'"));
    // No values, and what is turned is for the next run of it.
    choose(&mut page, "b.ron");
    page.until(&format!("document.querySelectorAll('#diagram-view [data-node]').length === 3 && {values}.length === 0 && {gauge} === '–'"));
    page.value("R.Panel.elements()[0].set(90, true)");
    page.until("R.Panel.elements()[0].note.textContent === 'for the next run'");
    page.value("R.record('lag.y')");
    page.until("document.getElementById('status').textContent === 'lag.y is recorded by the next run'");
    page.value("R.Desk.ask('control', { do: 'set', set: 'lag.tau=3 s' }).then(() => null)");
    page.until(&format!("{COMMAND}.includes('lag.tau')"));
    let command = page.value(COMMAND);
    let command = command.as_str().expect("a command");
    assert!(command.starts_with("blocksim run models/a.ron --change \"after "), "{command}");
    assert!(!command.contains("demand.value"), "{command}");
    end(&mut page);
    assert_eq!(page.value(&format!("{values}.length + {gauge}")), "0–");
    // Each has what is its own.
    choose(&mut page, "a.ron");
    page.until(&format!("{values}.includes('7 m') && {gauge} !== '–'"));
    assert_eq!(page.value("R.Panel.settings().length"), 0);
    choose(&mut page, "b.ron");
    page.until("R.Panel.settings().join() === 'demand.value=90 mm'");
    page.key("F5");
    page.until(&format!(
        "R.Live.shows('models/b.ron') && R.Live.rows() > 20 && {COMMAND}.includes('demand.value=90 mm')"
    ));
    page.value("location.hash = '#diagram'");
    page.until(&format!("{values}.includes('90 mm')"));
    end(&mut page);
    assert_eq!(page.complaints, Vec::<String>::new());
}

/// An oscillator whose steps are its own.
const OSCILLATOR: &str = r#"Diagram(
    simulation: (stop_time: "20 s", solver: Ode45(rtol: 1e-6)),
    blocks: { "x": Integrator(x0: 1), "v": Integrator, "k": Gain(k: -10), "scope": Scope(inputs: ["x"]) },
    panel: [Slider("k.k", "-50 .. 0")],
    connections: ["v.y -> x.u", "x.y -> k.u, scope.x", "k.y -> v.u"],
)
"#;

/// What a studio answers.
fn answer(studio: &Studio, method: &str, path: &str, body: &Value) -> Value {
    let body = if body.is_null() { String::new() } else { body.to_string() };
    let answer = studio.asked(method, path, &[("Content-Type", "application/json")], &body);
    let (head, text) = answer.split_once("\r\n\r\n").expect("an answer");
    assert!(head.starts_with("HTTP/1.1 200"), "{path} {body}: {answer}");
    serde_json::from_str(text).unwrap_or_default()
}

/// The run, as soon as it is so.
fn run_that(studio: &Studio, what: &str, is_so: impl Fn(&Value) -> bool) -> Value {
    let begin = Instant::now();
    loop {
        let run = answer(studio, "GET", "/api/project", &Value::Null)["run"].take();
        if is_so(&run) {
            return run;
        }
        assert!(begin.elapsed() < Duration::from_secs(60), "{what}: {run}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The time of the last row that is shown, when no more come.
fn last(studio: &Studio) -> f64 {
    let last = || {
        let rows = answer(studio, "GET", "/api/live", &Value::Null)["rows"].take();
        let bytes = rows.as_array()?.last()?["t"].as_str().map(|text| STANDARD.decode(text))?.ok()?;
        bytes.rchunks_exact(8).next().map(|bytes| f64::from_le_bytes(bytes.try_into().expect("eight bytes")))
    };
    let (mut seen, mut since) = (None, Instant::now());
    while since.elapsed() < Duration::from_millis(400) || seen.is_none() {
        let now = last();
        if now != seen {
            (seen, since) = (now, Instant::now());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    seen.expect("rows")
}

#[test]
fn a_run_that_is_repeated_for_another_signal_is_where_it_was_with_all_that_was_set() {
    let desk = Desk::with(&[("osc.ron", OSCILLATOR)]);
    let studio = Studio::of(&desk, &[]);
    let control = |body: Value| answer(&studio, "POST", "/api/control", &body);
    let changes =
        |count: usize| move |run: &Value| run["changes"].as_array().is_some_and(|all| all.len() == count);
    answer(&studio, "POST", "/api/run", &json!({ "speed": 1.0 }));
    run_that(&studio, "it runs", |run| run["state"] == "running");
    std::thread::sleep(Duration::from_millis(200));
    control(json!({ "do": "set", "set": "k.k=-20" }));
    let run = run_that(&studio, "it is set", changes(1));
    let first = run["changes"][0].clone();
    std::thread::sleep(Duration::from_millis(600));
    control(json!({ "do": "pause" }));
    let stood = last(&studio);
    assert!(stood > 0.3, "{stood}");
    // Repeated, and repeated once more before that has come to where it was.
    let mut records = Vec::new();
    for signal in ["v.y", "k.y"] {
        records.push(signal);
        answer(&studio, "POST", "/api/run", &json!({ "again": true, "record": records, "speed": 1.0 }));
        let run = run_that(&studio, "it is known at once", |run| run["state"] != "idle");
        assert_eq!(run["changes"], json!([first]), "{signal}");
    }
    run_that(&studio, "it stands", |run| run["state"] == "paused");
    assert_eq!(last(&studio), stood);
    // What is set now is set there, not on the way.
    control(json!({ "do": "set", "set": "k.k=-40" }));
    let run = run_that(&studio, "it is set", changes(2));
    assert_eq!(run["changes"][0], first);
    let second = run["changes"][1].as_str().expect("a change");
    let t: f64 =
        second.strip_prefix("after ").and_then(|text| text.split('s').next()?.parse().ok()).expect(second);
    assert!(t >= stood && t < stood + 0.5, "{second}, stood at {stood}");
    assert_eq!(run["standing"], json!([{ "name": "k.k", "unit": "", "value": -40.0 }]));
    // Back before that, where nothing is waited for any more.
    let before = stood - 0.1;
    control(json!({ "do": "back", "t": before }));
    let run = run_that(&studio, "it is back", changes(1));
    assert_eq!(run["standing"][0]["value"], -20.0);
    assert!(last(&studio) < stood);
    control(json!({ "do": "speed", "speed": 0.0 }));
    control(json!({ "do": "go" }));
    let run = run_that(&studio, "it ends", |run| run["state"] == "done");
    let folder = format!("runs/{}", run["name"].as_str().expect("a name"));
    let change = first.as_str().expect("a change");
    let again = ["run", "osc.ron", "--record", "v.y,k.y", "--change", change, "--out", "again", "--quiet"];
    assert_eq!(desk.call(&again).code, Some(0));
    for file in ["signals.csv", "events.csv"] {
        assert!(desk.read(&format!("{folder}/{file}")) == desk.read(&format!("again/{file}")), "{file}");
    }
}
