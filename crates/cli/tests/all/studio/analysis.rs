//! Sweeps and linear analysis on the page: the same numbers as those of the commands.

use super::{SERVO, Studio, shown};
use crate::desk::Desk;

/// Types into a field as a person does who leaves it afterwards.
fn typed(page: &mut super::browser::Page, field: &str, text: &str) {
    page.value(&format!(
        "(() => {{ const field = {field}; field.value = '{text}'; for (const kind of ['input', 'change']) field.dispatchEvent(new \
         Event(kind, {{ bubbles: true }})); }})()"
    ));
}

#[test]
fn a_sweep_is_shown_as_a_grid_and_one_of_its_runs_is_run() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.key("7");
    page.until("R.Sweep.place.targets");
    typed(&mut page, "document.querySelector('.over input')", "gain.k");
    // Values around the one that is written are proposed.
    page.until("document.querySelectorAll('.over input')[1].value === '3..12 1/s/5'");
    typed(&mut page, "document.querySelectorAll('.over input')[1]", "2..8 1/s/4");
    page.value("[...document.querySelectorAll('#sweep-view button')].find((b) => b.textContent === '+ parameter').click()");
    typed(&mut page, "document.querySelectorAll('.over input')[2]", "demand.after");
    typed(&mut page, "document.querySelectorAll('.over input')[3]", "45 deg, 90 deg");
    page.value("R.Sweep.place.start.click()");
    page.until("R.Sweep.found()");
    let by_command = desk.call(&[
        "sweep",
        "servo.ron",
        "--over",
        "gain.k=2..8 1/s/4",
        "--over",
        "demand.after=45 deg, 90 deg",
        "--json",
    ]);
    let same = format!("JSON.stringify(R.Sweep.found()) === JSON.stringify({})", by_command.out.trim());
    assert_eq!(page.value(&same), true, "the same numbers");
    assert_eq!(page.value("document.querySelectorAll('.heat .cell').length"), 8);
    assert_eq!(page.value("document.querySelectorAll('.parallel .row').length"), 8);
    assert_eq!(page.value("document.querySelectorAll('.multiples figure').length"), 5);
    // A run is chosen in the grid, shown everywhere, and run.
    page.value(
        "document.querySelector('.heat .cell[aria-label^=\"gain.k 4 1/s, demand.after 90 deg\"]').click()",
    );
    page.until("document.querySelectorAll('[aria-pressed=true].cell').length === 1 && document.querySelector('.parallel .chosen')");
    page.value("document.querySelector('.picked button').click()");
    page.until("document.querySelector('.run-line').textContent.includes('2 s simulated')");
    let run = format!("runs/{}", desk.names("runs")[0]);
    let again = desk.call(&[
        "run",
        "servo.ron",
        "--set",
        "gain.k=4 1/s",
        "--set",
        "demand.after=90 deg",
        "--out",
        "again",
        "--quiet",
    ]);
    assert_eq!(again.code, Some(0), "{}", again.err);
    assert_eq!(desk.read(&format!("{run}/signals.csv")), desk.read("again/signals.csv"));
    // What is wrong with the values is told, and what was found stays.
    page.value("location.hash = '#sweep'");
    typed(&mut page, "document.querySelectorAll('.over input')[1]", "1 kg..2 kg/2");
    page.value("R.Sweep.place.start.click()");
    page.until("document.querySelector('#sweep-view .bad')?.textContent.includes('kg')");
    // What cannot be understood never reaches a command as a flag.
    let answer =
        studio.asked("POST", "/api/sweep", &[], r#"{"over": ["--out=stolen.csv"], "metric": ["--yes"]}"#);
    assert!(answer.starts_with("HTTP/1.1 409") && !desk.0.join("stolen.csv").exists(), "{answer}");
    assert_eq!(
        page.complaints.iter().filter(|told| !told.contains("409")).count(),
        0,
        "{:?}",
        page.complaints
    );
}

#[test]
fn poles_move_with_a_slider() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.key("8");
    // The poles of the model: one, at minus the gain.
    page.until("R.Linear.found()?.poles[0]?.pole[0] === -6");
    let field = |name: &str| format!("document.querySelector('#linear-view input[aria-label=\"{name}\"]')");
    typed(&mut page, &field("Open the loop at"), "gain.y");
    page.until("R.Linear.found()?.ways[0]?.margins?.closed_poles[0]?.[0] === -6");
    let by_command =
        desk.call(&["linearise", "servo.ron", "--open", "gain.y", "--at", "0 s", "--json", "--curves"]);
    let same = format!("JSON.stringify(R.Linear.found()) === JSON.stringify({})", by_command.out.trim());
    assert_eq!(page.value(&same), true, "the same numbers");
    assert_eq!(
        page.value("document.querySelectorAll('#linear-view .card').length"),
        5,
        "poles, magnitude, phase, Nyquist, step"
    );
    // A parameter is turned; the range is that around its value, by factors.
    typed(&mut page, &field("Parameter"), "gain.k");
    page.until(&format!("{}.value === '60' && {}.value === '1/s'", field("Highest value"), field("Unit")));
    for (place, pole) in [(0, -0.6), (1000, -60.0)] {
        page.value(&format!(
            "(() => {{ const slider = {}; slider.value = {place}; slider.dispatchEvent(new Event('input')); }})()",
            field("Value of the parameter")
        ));
        page.until(&format!("R.Linear.found()?.ways[0].margins.closed_poles[0][0] === {pole}"));
    }
    page.until("document.querySelector('.figures').textContent.includes('phase margin90°')");
    page.until("document.querySelectorAll('.sign.dot').length >= 2");
    page.value("[...document.querySelectorAll('#linear-view button')].find((b) => b.textContent.startsWith('Follow')).click()");
    page.until("document.querySelectorAll('.sign.dot.path').length === 41");
    // A signal that does not exist: the reason is shown, and what was found stays.
    typed(&mut page, &field("Open the loop at"), "gain.x");
    page.until("document.querySelector('#linear-view .bad')?.textContent.includes('gain.x')");
    // Without the words of the command line.
    let told = studio.asked("POST", "/api/linear", &[], r#"{"at": "1,5 s"}"#);
    assert!(told.contains("decimal comma? write 1.5"), "{told}");
    assert!(!told.contains("--at") && !told.contains("--help"), "{told}");
    assert_eq!(page.value("document.querySelector('.linear-seen').classList.contains('old')"), true);
    assert_eq!(
        page.complaints.iter().filter(|told| !told.contains("409")).count(),
        0,
        "{:?}",
        page.complaints
    );
}
