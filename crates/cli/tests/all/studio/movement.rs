//! The mechanism in 3D while a run goes on.

use super::browser::Page;
use super::{SERVO, Studio, shown, with_scara};
use crate::desk::Desk;

/// Where the tool is at an instant: what stands in a view, in mm.
fn tool(page: &mut Page, view: &str, place: &str, t: f64) -> [f64; 3] {
    let text = page.value(&format!(
        "R.setTime({t}); {view}.paint(); document.querySelector('{place} .pose').textContent"
    ));
    let text = text.as_str().expect("text");
    let of = |axis: &str| {
        let line = text.lines().find(|line| line.starts_with(axis)).expect("a line for each axis");
        line[1..].trim().trim_end_matches(" mm").parse().expect("a number")
    };
    ["x", "y", "z"].map(of)
}

/// What the page complains about, but for what the browser has to say of graphics without a card.
pub fn complaints(page: &Page) -> Vec<&String> {
    page.complaints.iter().filter(|one| !one.contains("\"source\":\"rendering\"")).collect()
}

/// Signals of a run over time: the row at or behind an instant.
pub fn row(table: &str, t: f64, names: &[&str]) -> Vec<f64> {
    let mut lines = table.lines();
    let heads: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let places =
        names.iter().map(|name| heads.iter().position(|head| head.starts_with(name)).expect("a signal"));
    let line = lines.find(|line| {
        let time: f64 = line.split(',').next().and_then(|time| time.parse().ok()).expect("a time");
        time >= t
    });
    let cells: Vec<&str> = line.expect("a row").split(',').collect();
    places.map(|place| cells[place].parse().expect("a number")).collect()
}

#[test]
fn a_mechanism_is_seen_while_it_moves_and_at_any_instant_before() {
    let desk = with_scara();
    let studio = Studio::of(&desk, &["scara.ron"]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#run'");
    assert_eq!(page.value("document.getElementById('movement').hidden"), true, "nothing has run");
    page.value("R.Desk.ask('run', { speed: 0.5 }).then(() => null)");
    // It moves while the run goes on.
    page.until("R.Live.rows() > 100 && window.__m.movement_frames > 3");
    let pose = "document.querySelector('#movement .pose').textContent";
    let before = page.value(pose);
    page.until(&format!("{pose} !== {before}"));
    page.key(" ");
    page.until("document.querySelector('.run-line').textContent.includes('paused')");
    // What was on its way when the run paused has come.
    let legends = "[...document.querySelectorAll('#plots .entry b')].map((one) => one.textContent).join()";
    page.value("new Promise((done) => { let rows = -1; const look = () => { if (rows === R.Live.rows()) return done(null); rows = R.Live.rows(); setTimeout(look, 400); }; look(); })");
    // At an instant of the past, by the slider; legends follow.
    let (here, told) = (page.value(pose), page.value(legends));
    page.value("(() => { const slider = document.querySelector('.instant input'); slider.value = 0.02; slider.dispatchEvent(new Event('input')); })()");
    page.until(&format!("R.now === 0.02 && {pose} !== {here} && {legends} !== {told}"));
    page.value("[...document.querySelectorAll('.instant button')].find((one) => one.textContent === 'To the last row').click()");
    page.until(&format!("{pose} === {here} && {legends} === {told}"));
    // To the end: then the whole movement is there.
    page.value("R.Desk.ask('control', { do: 'speed', speed: 0 }).then(() => R.Desk.ask('control', { do: 'go' })).then(() => null)");
    page.until("/ s simulated/.test(document.querySelector('.run-line').textContent)");
    let run = format!("runs/{}", desk.names("runs")[0]);
    let table = desk.read(&format!("{run}/signals.csv"));
    let end = page.value("R.span[1]").as_f64().expect("a time");
    let mut seen = Vec::new();
    for share in [0.0, 0.05, 0.3, 0.5, 0.8] {
        // At a row of the run, where nothing lies between.
        let t = (share * end * 1000.0).round() / 1000.0;
        let at = tool(&mut page, "R.Movement.view", "#movement", t);
        let recorded = row(&table, t, &["place.actual[0]", "place.actual[1]", "place.actual[2]"]);
        for (one, other) in at.iter().zip(recorded) {
            assert!((one - 1e3 * other).abs() < 0.11, "{at:?} at {t} s, {other} m recorded");
        }
        seen.push((t, at));
    }
    assert!(seen[0].1 != seen[4].1, "{seen:?}");
    // It can be put away, and comes back.
    page.value(
        "[...document.querySelectorAll('.run-tools button')].find((one) => one.textContent === '3D').click()",
    );
    assert_eq!(page.value("document.getElementById('movement').hidden"), true);
    page.value(
        "[...document.querySelectorAll('.run-tools button')].find((one) => one.textContent === '3D').click()",
    );
    assert_eq!(page.value("document.getElementById('movement').hidden"), false);
    // The results on disk are what they always were, and their page has the same movement.
    let again = desk.call(&["run", "scara.ron", "--out", "again", "--quiet"]);
    assert_eq!(again.code, Some(0), "{}", again.err);
    for file in ["signals.csv", "events.csv", "scene.json"] {
        assert!(desk.read(&format!("{run}/{file}")) == desk.read(&format!("again/{file}")), "{file}");
    }
    assert_eq!(complaints(&page), Vec::<&String>::new());
    let report = desk.call(&["report", &run]);
    assert_eq!(report.code, Some(0), "{}", report.err);
    page.open(&format!("file://{}", desk.0.join(&run).join("report.html").display()));
    page.until("document.documentElement.dataset.space === 'WebGL'");
    for (t, at) in seen {
        let there = tool(&mut page, "R.Space", "#space-view", t);
        for (one, other) in at.iter().zip(there) {
            assert!((one - other).abs() < 0.11, "{at:?} while it ran, {there:?} in its results at {t} s");
        }
    }
}

#[test]
fn a_run_that_goes_back_takes_its_mechanism_along() {
    let desk = with_scara();
    let studio = Studio::of(&desk, &["scara.ron"]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#run'");
    page.value("R.Desk.ask('run', { speed: 0.5 }).then(() => null)");
    page.until("R.Live.rows() > 200 && window.__m.movement_frames > 3");
    page.key(" ");
    page.until("document.querySelector('.run-line').textContent.includes('paused')");
    page.value("(() => { const slider = document.querySelector('.instant input'); slider.value = 0.1; slider.dispatchEvent(new Event('input')); })()");
    let there = tool(&mut page, "R.Movement.view", "#movement", 0.1);
    page.key("b");
    page.until(
        "R.Futures.left().length === 1 && document.querySelector('.run-line').textContent.includes('paused')",
    );
    // At the first step that reaches the instant.
    page.until("R.now >= 0.1 && R.now < R.Futures.left()[0].to");
    let here = tool(&mut page, "R.Movement.view", "#movement", 0.1);
    assert!(here.iter().zip(there).all(|(one, other)| (one - other).abs() < 0.2), "{here:?}, {there:?}");
    // Whoever comes later sees the same.
    let address = studio.address.clone();
    page.tab();
    page.open(&address);
    page.until("document.documentElement.dataset.ready === 'true'");
    page.value("location.hash = '#run'");
    page.until("window.__m.movement_frames > 0 && R.Live.rows() > 0");
    assert_eq!(tool(&mut page, "R.Movement.view", "#movement", 0.1), here);
    assert_eq!(complaints(&page), Vec::<&String>::new());
}

#[test]
fn without_webgl_a_run_is_seen_all_the_same() {
    let desk = with_scara();
    let studio = Studio::of(&desk, &["scara.ron"]);
    let Some(mut page) = shown(&studio) else { return };
    page.before(
        "const get = HTMLCanvasElement.prototype.getContext; HTMLCanvasElement.prototype.getContext = function (kind, ...rest) { \
         return /webgl/.test(kind) ? null : get.call(this, kind, ...rest); };",
    );
    page.open(&studio.address);
    page.until("document.documentElement.dataset.ready === 'true'");
    page.value("location.hash = '#run'");
    page.value("R.Desk.ask('run', { speed: 0 }).then(() => null)");
    page.until("document.querySelector('#movement .space-bar .note')?.textContent.includes('No WebGL here')");
    page.until("/ s simulated/.test(document.querySelector('.run-line').textContent)");
    let [x, ..] = tool(&mut page, "R.Movement.view", "#movement", 0.0);
    assert!(x.is_finite());
    assert_eq!(complaints(&page), Vec::<&String>::new());
}

#[test]
fn a_model_without_a_mechanism_has_no_3d_view() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#run'");
    page.value("R.Desk.ask('run', { speed: 0 }).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('2 s simulated')");
    assert_eq!(page.value("document.getElementById('movement').hidden"), true);
    assert_eq!(page.value("[...document.querySelectorAll('.run-tools button')].at(-1).hidden"), true);
    assert_eq!(page.value("document.querySelector('.with-movement')"), serde_json::Value::Null);
}
