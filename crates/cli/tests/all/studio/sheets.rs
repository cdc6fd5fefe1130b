//! Parameters in sheets: where their numbers come from, and what a run had.

use std::fs;

use super::{SERVO, Studio, shown};
use crate::desk::Desk;

const SET: &str = r#"(
    motor: (
        k: (value: "6 1/s", source: "data sheet", note: "published", tolerance: "10 %"),
    ),
    other: (delay: "0.5 s"),
)
"#;

#[test]
fn parameters_stand_in_sheets_beside_those_of_a_run() {
    let model = SERVO
        .replace("    simulation:", "    parameters: { \"set\": File(\"set.ron\") },\n    simulation:")
        .replace("\"6 1/s\"", "\"set.motor.k\"");
    let sheets =
        "(sheets: [(name: \"(1) Motor\", holds: [\"motor\"]), (name: \"(2) Other\", holds: [\"*\"])])";
    let desk = Desk::with(&[("servo.ron", &model), ("set.ron", SET), ("set.sheets.ron", sheets)]);
    let ran =
        desk.call(&["run", "servo.ron", "--out", "runs/first", "--set", "demand.after=45 deg", "--quiet"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    let studio = Studio::of(&desk, &["--edit", "servo.ron"]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#values'");
    page.until("document.querySelectorAll('.sheets button').length === 4");
    let sheets = page
        .value("[...document.querySelectorAll('.sheets button')].map((one) => one.dataset.sheet).join('|')");
    assert_eq!(sheets, "|(1) Motor|(2) Other|servo.ron");
    page.value("document.querySelector('[data-sheet=\"(1) Motor\"]').click()");
    page.until("document.querySelectorAll('#values-view tbody tr').length === 1");
    let cell = |page: &mut super::Page, name: &str, column: &str| {
        page.value(&format!(
            "(() => {{ const row = document.querySelector('#values-view input[aria-label=\"{name}\"]').closest('tr'), \
             heads = [...row.closest('table').querySelectorAll('th')].map((head) => head.textContent); \
             return row.cells[heads.indexOf('{column}')].textContent; }})()"
        ))
    };
    assert_eq!(cell(&mut page, "set.motor.k", "unit"), "1/s");
    assert_eq!(cell(&mut page, "set.motor.k", "source"), "data sheet; published; ± 10 %");
    page.value("document.querySelector('[data-sheet=\"servo.ron\"]').click()");
    assert_eq!(cell(&mut page, "gain.k", "value"), "6 1/s", "what an expression is worth");
    page.value("document.querySelector('[data-sheet=\"\"]').click()");
    // The run had another value, which was set for it alone.
    fs::write(desk.0.join("set.ron"), SET.replace("6 1/s", "7 1/s")).expect("a file");
    page.until("document.querySelector('#values-view input[aria-label=\"set.motor.k\"]').value === '7 1/s'");
    page.until("document.querySelectorAll('select[aria-label=\"Run to compare with\"] option').length === 2");
    page.value("(() => { const choice = document.querySelector('select[aria-label=\"Run to compare with\"]'); choice.value = 'first'; choice.dispatchEvent(new Event('change')); })()");
    page.until("document.querySelectorAll('#values-view .differs').length === 3");
    page.value("document.querySelector('.sheet-tools input[type=checkbox]').click()");
    page.until("document.querySelectorAll('#values-view tbody tr').length === 3");
    let told = page.value(
        "[...document.querySelectorAll('#values-view .differs')].map((one) => one.textContent).join('|')",
    );
    assert_eq!(told, "≠ 6 1/s|≠ 45 deg (set for it)|≠ set.motor.k = 6 1/s");
    // Two changes: run with both, and no file is changed; then both are written, the faulty one stays.
    for (name, value) in [("set.motor.k", "9 1/s"), ("demand.after", "30 deg")] {
        page.value(&format!("document.querySelector('#values-view input[aria-label=\"{name}\"]').focus()"));
        page.replace(value);
    }
    page.until("document.querySelector('.pending').textContent.startsWith('2 changes are not written')");
    page.value("[...document.querySelectorAll('.pending button')].find((one) => one.textContent === 'Run with all').click()");
    page.until("document.querySelector('.run-line').textContent.includes('2 s simulated')");
    page.until(
        "[...document.querySelectorAll('#plots .entry b')].map((b) => b.textContent).join() === '30,30'",
    );
    assert_eq!(desk.read("servo.ron"), model);
    page.value("location.hash = '#values'");
    page.value("document.querySelector('#values-view input[aria-label=\"demand.after\"]').focus()");
    page.replace("30 kg");
    page.value("[...document.querySelectorAll('.pending button')].find((one) => one.textContent === 'Write all').click()");
    page.until("document.querySelector('#values-view .answer .bad')");
    assert!(desk.read("set.ron").contains("\"9 1/s\""), "{}", desk.read("set.ron"));
    assert_eq!(
        page.value("document.querySelector('#values-view input[aria-label=\"demand.after\"]').value"),
        "30 kg"
    );
    assert_eq!(desk.read("servo.ron"), model);
    assert_eq!(page.complaints.len(), 1, "one refusal: {:?}", page.complaints);
}

#[test]
fn ranges_of_kinds_stand_in_the_sheets_and_limit_what_is_turned() {
    let model = SERVO
        .replace("\"gain\": Gain", "\"lag\": LowPass(tau: \"20 ms\"), \"pulse\": Pulse(period: \"500 ms\", width: \"30 %\"), \"gain\": Gain")
        .replace("Integrator()", "Integrator(lower: \"-90 deg\", upper: \"200 deg\")")
        .replace("demand.y -> error.u1", "pulse.y -> lag.u\", \"demand.y -> error.u1")
        .replace("blocks: {", "panel: [Slider(\"gain.k\", \"2 .. 8 1/s\")],\n    blocks: {");
    let desk = Desk::with(&[("servo.ron", &model)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#values'");
    page.until("document.querySelector('#values-view input[aria-label=\"pulse.width\"]')");
    let ranges = "(() => { const table = document.querySelector('#values-view table'), at = [...table.querySelectorAll('th')].findIndex((head) => head.textContent === 'range'); \
                  return [...table.querySelectorAll('tbody tr')].map((row) => `${row.cells[0].textContent}: ${row.cells[at].textContent}`).filter((line) => !line.endsWith(': ')).join('; '); })()";
    assert_eq!(
        page.value(ranges),
        "error.signs: not empty; lag.tau: > 0; pulse.period: > 0; pulse.width: 0 … 100; gain.k: 2 … 8; angle.upper: > `lower`; scope.display: a unit"
    );
    for name in ["lag.tau", "pulse.width", "gain.k", "demand.after"] {
        page.value(&format!("[...document.querySelector('#values-view input[aria-label=\"{name}\"]').closest('td').querySelectorAll('button')].find((b) => b.textContent === 'Turn').click()"));
    }
    page.until("document.querySelectorAll('.knob input[type=range]').length === 4");
    let ends = page.value("[...document.querySelectorAll('.knob input[type=range]')].map((one) => `${one.min} ${one.max}`).join('; ')");
    assert_eq!(ends, "0.2 40; 0 100; 2 8; 0 180", "an end that is not allowed itself is left out");
    page.value("(() => { const slider = document.querySelectorAll('.knob input[type=range]')[0]; slider.value = 0; slider.dispatchEvent(new Event('input')); })()");
    page.until("document.querySelector('.knob input[type=text]').value === '0.2 ms'");
}

#[test]
fn what_is_typed_stays_with_its_model() {
    let panel = "    panel: [Slider(\"gain.k\", \"0 .. 20\")],\n    simulation:";
    let first = SERVO.replace("    simulation:", panel);
    let second = SERVO.replace("6 1/s", "2 1/s");
    let desk = Desk::with(&[]);
    fs::create_dir(desk.0.join("eins")).expect("a folder");
    for (name, text) in [("größe", &first), ("zweite", &second)] {
        fs::write(desk.0.join(format!("eins/{name}.ron")), text).expect("a file");
    }
    let studio = Studio::of(&desk, &["--edit"]);
    let Some(mut page) = shown(&studio) else { return };
    let field = "document.querySelector('#values-view input[aria-label=\"gain.k\"]')";
    let answer = "document.querySelector('#values-view .answer[data-target=\"gain.k\"]').textContent";
    let choose = |page: &mut super::Page, model: &str| {
        page.value(&format!("(() => {{ const choice = document.getElementById('models'); choice.value = '{model}'; choice.dispatchEvent(new Event('change')); }})()"));
        page.until(&format!("R.Project.known().model === '{model}'"));
    };
    page.value("location.hash = '#values'");
    choose(&mut page, "eins/größe.ron");
    // The names of files come first, as the end of what is too long is out of sight.
    let names =
        page.value("[...document.querySelectorAll('#models option')].map((one) => one.textContent).join()");
    assert_eq!(names, "größe.ron – eins,zweite.ron – eins");
    // Light or dark stays as it was chosen.
    page.value("document.getElementById('theme').click()");
    let theme = page.value("document.documentElement.dataset.theme");
    // An address that means nothing.
    page.value("location.hash = '#runs/%E0'");
    page.until("!document.getElementById('runs').hidden");
    page.open(&studio.address);
    page.until("document.documentElement.dataset.ready");
    assert_eq!(page.value("document.documentElement.dataset.theme"), theme);
    page.value("location.hash = '#values'");
    page.until(&format!("{field}?.value === '6 1/s'"));
    page.value(&format!("{field}.focus()"));
    page.replace("7,5 1/s");
    page.key("Enter");
    // The fault itself, not that the slider cannot turn what has one.
    page.until(&format!("{answer}.includes('decimal comma? write 7.5')"));
    choose(&mut page, "eins/zweite.ron");
    page.until(&format!("{field}?.value === '2 1/s'"));
    assert_eq!(page.value(answer), "");
    choose(&mut page, "eins/größe.ron");
    page.until(&format!("{field}?.value === '7,5 1/s'"));
    assert!(
        page.value(answer).as_str().is_some_and(|why| why.contains("decimal comma")),
        "it is still explained"
    );
    // Another tab has chosen another model in the meantime.
    let set = r#"{"model": "eins/zweite.ron", "target": "gain.k", "value": "9 1/s"}"#;
    let told = studio.asked("POST", "/api/set", &[], set);
    assert!(told.starts_with("HTTP/1.1 409") && told.contains("is shown now"), "{told}");
    assert_eq!([desk.read("eins/größe.ron"), desk.read("eins/zweite.ron")], [first, second]);
}

#[test]
fn what_is_typed_is_neither_left_out_of_a_run_nor_written_over_others_in_silence() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &["--edit"]);
    let Some(mut page) = shown(&studio) else { return };
    let field = "document.querySelector('#values-view input[aria-label=\"gain.k\"]')";
    let answer = "document.querySelector('#values-view .answer[data-target=\"gain.k\"]').textContent";
    let warning = "document.querySelector('#run-bar .warning')";
    let runs = |page: &mut super::Page, typed: &str| {
        page.key("F5");
        page.until(&format!("[...{warning}.querySelectorAll('li')].map((one) => one.textContent.split(',')[0]).join() === '{typed}'"));
        page.until("document.querySelector('.run-line').textContent.includes('2 s simulated')");
        assert_eq!(page.value(&format!("{warning}.hidden")), typed.is_empty());
    };
    runs(&mut page, "");
    // A text that is not saved, and a value that is not written.
    page.value("location.hash = '#diagram'");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 5");
    page.value("R.Text.toggle()");
    page.until("document.querySelector('.text-pane textarea')?.value.includes('6 1/s')");
    page.value("document.querySelector('.text-pane textarea').focus()");
    page.replace(&SERVO.replace("0.5 s", "0.7 s"));
    page.until("R.Text.dirty().join() === 'servo.ron'");
    page.value("location.hash = '#values'");
    page.until(field);
    page.value(&format!("{field}.focus()"));
    page.replace("20 1/s");
    runs(&mut page, "the text of servo.ron,gain.k = 20 1/s");
    // Repeated for one more signal it is the same run.
    page.value("R.record('gain.y')");
    page.until("[...document.querySelectorAll('#plots .entry')].some((one) => one.title === 'gain.y') && !document.getElementById('start').disabled");
    assert_eq!(page.value(&format!("{warning}.hidden")), false);
    page.value("document.activeElement.blur()");
    page.value("[...document.querySelectorAll('.text-bar button')].find((one) => one.textContent === 'Discard').click()");
    page.value("location.hash = '#values'");
    page.until(field);
    page.value(&format!("[...{field}.closest('td').querySelectorAll('button')].find((one) => one.textContent === 'Run with it').click()"));
    page.until(&format!(
        "{warning}.hidden && document.querySelector('.run-line').textContent.includes('2 s simulated')"
    ));
    // Others write meanwhile: that is shown, and nothing is written over it before it has been refused.
    let theirs = SERVO.replace("6 1/s", "11 1/min");
    fs::write(desk.0.join("servo.ron"), &theirs).expect("a file");
    page.value("location.hash = '#values'");
    page.until(&format!("{answer}.startsWith('the file has 11 1/min by now; it had 6 1/s')"));
    page.value(&format!("{field}.focus()"));
    page.replace("20");
    page.key("Enter");
    page.until(&format!(
        "{answer}.startsWith('`gain.k` has been changed by others meanwhile: it is 11 1/min, and was 6 1/s')"
    ));
    assert_eq!(desk.read("servo.ron"), theirs);
    assert_eq!(page.value(&format!("{field}.value")), "20");
    page.key("Enter");
    page.until("document.querySelector('.difference')?.textContent.includes('20 1/min')");
    assert_eq!(desk.read("servo.ron"), SERVO.replace("6 1/s", "20 1/min"));
    assert_eq!(page.complaints.len(), 1, "one refusal: {:?}", page.complaints);
    let set = r#"{"model": "servo.ron", "target": "gain.k", "value": "9 1/s"}"#;
    assert!(studio.asked("POST", "/api/set", &[], set).contains("the one before"));
}
