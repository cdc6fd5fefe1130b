//! Changes of the diagram in the browser: by clicks, by keys, and in the text beside the picture.

use std::fs;
use std::time::Duration;

use super::browser::Page;
use super::{SERVO, Studio, shown};
use crate::desk::Desk;

/// A page on the diagram of a model of five blocks.
fn diagram(studio: &Studio) -> Option<Page> {
    let mut page = shown(studio)?;
    page.value("location.hash = '#diagram'");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 5");
    Some(page)
}

const STATUS: &str = "document.getElementById('status').textContent";

fn says(page: &mut Page, text: &str) {
    page.until(&format!("{STATUS}.includes({})", serde_json::json!(text)));
}

#[test]
fn a_block_is_renamed_deleted_and_brought_back_by_keys() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &["--edit"]);
    let Some(mut page) = diagram(&studio) else { return };
    page.value("R.Diagram.show('', 'gain')");
    page.key("r");
    page.until("document.activeElement.getAttribute('aria-label') === 'New name'");
    // A name that is taken stays where it was typed, with the reason.
    page.replace("error");
    page.key("Enter");
    page.until("document.querySelector('.task .answer .bad')?.textContent.includes('`error` is taken')");
    assert_eq!(page.value("document.activeElement.value"), "error");
    page.replace("amplifier");
    page.key("Enter");
    says(&mut page, "`gain` is `amplifier` now");
    page.until("document.querySelector('.inspector h3').textContent === 'amplifier'");
    assert_eq!(desk.read("servo.ron"), SERVO.replace("gain", "amplifier"));
    assert!(
        page.value("document.querySelector('.side-column .difference').textContent")
            .as_str()
            .expect("text")
            .contains("+        \"amplifier\"")
    );
    // Delete, and what has no wire any more is named; the picture shows its open port.
    page.value("document.querySelector('[data-node].chosen').focus()");
    page.key("Delete");
    says(&mut page, "not connected any more: `angle.u`");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 4");
    page.until("document.querySelector('.handle[data-end=\"angle.u\"]')");
    page.until(
        "document.querySelector('#problems .error')?.textContent.includes('`angle.u` is not connected')",
    );
    page.control("z");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 5");
    page.control("z");
    page.until("R.Diagram.now().level.blocks.some((block) => block?.[0] === 'gain')");
    assert_eq!(desk.read("servo.ron"), SERVO, "undo gives the same bytes");
    page.control("y");
    says(&mut page, "changed again");
    assert_eq!(desk.read("servo.ron"), SERVO.replace("gain", "amplifier"));
    // Somebody else writes: nothing is taken back over that.
    fs::write(desk.0.join("servo.ron"), SERVO.replace("6 1/s", "7 1/s")).expect("a file");
    page.control("z");
    says(&mut page, "has been changed by others since");
    assert!(desk.read("servo.ron").contains("7 1/s"));
    // As soon as the lines are there again it can be taken back, and what stands in others stays.
    let amplified = format!("{}// theirs\n", SERVO.replace("gain", "amplifier").replace("2 s", "3 s"));
    fs::write(desk.0.join("servo.ron"), &amplified).expect("a file");
    let mut ask = |what: &str| {
        let asked =
            format!("R.Desk.ask('{what}', {{}}).then((done) => done.message, (error) => error.message)");
        page.value(&asked).as_str().expect("a message").to_owned()
    };
    assert!(ask("undo").contains("has been changed by others since"));
    fs::write(desk.0.join("servo.ron"), amplified.replace("3 s", "2 s")).expect("a file");
    assert!(ask("undo").contains("as it was before the last change"));
    assert_eq!(desk.read("servo.ron"), format!("{SERVO}// theirs\n"));
    assert!(ask("redo").contains("changed again"));
    assert_eq!(desk.read("servo.ron"), amplified.replace("3 s", "2 s"));
}

#[test]
fn two_clicks_connect_two_ports_and_misfits_are_explained() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &["--edit"]);
    let Some(mut page) = diagram(&studio) else { return };
    page.value("R.Diagram.follow(R.Diagram.now().texts.drawings[0].nets.findIndex((net) => net[0].startsWith('error.y')))");
    page.value("[...document.querySelectorAll('.inspector button')].find((b) => b.textContent === 'Delete the wire to gain.u').click()");
    says(&mut page, "`gain.u` disconnected");
    page.until(
        "R.Diagram.now().texts.drawings[0].nets.length === 3 && document.querySelector('#problems .error')",
    );
    page.click(".handle[data-end='error.y']");
    page.until("document.querySelector('.task h3')?.textContent === 'Connect error.y to …'");
    assert_eq!(
        page.value("document.querySelector('.task select').value"),
        "gain.u",
        "the open one comes first"
    );
    page.click(".handle[data-end='gain.u']");
    says(&mut page, "`error.y` connected to `gain.u`");
    page.until(
        "!document.querySelector('#problems .error') && R.Diagram.now().texts.drawings[0].nets.length === 4",
    );
    // By keys alone, and to a port whose unit does not fit.
    page.value("R.Diagram.show('', 'scope')");
    page.value("[...document.querySelectorAll('.ports button')].find((b) => b.getAttribute('aria-label') === 'Delete the wires of scope.set').click()");
    says(&mut page, "`scope.set` disconnected");
    page.until("document.querySelector('#problems .error') && R.Diagram.now().texts.drawings[0].ends.flat().length === 9");
    page.value("R.Diagram.show('', 'gain')");
    page.key("c");
    page.until("document.querySelector('.task select')?.value === 'scope.set'");
    page.value(
        "[...document.querySelectorAll('.task button')].find((b) => b.textContent === 'Connect').click()",
    );
    page.until("document.querySelector('.side-column .change .bad')?.textContent.includes('deg')");
    page.key("Escape");
    page.until("!document.querySelector('.task')");
    assert!(!desk.read("servo.ron").contains("gain.y -> angle.u, scope.set"));
    assert_eq!(page.value("R.Edit.begun()"), serde_json::Value::Null);
}

#[test]
fn a_block_is_found_by_what_it_does_and_put_into_a_wire() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &["--edit"]);
    let Some(mut page) = diagram(&studio) else { return };
    page.value("R.Diagram.follow(R.Diagram.now().texts.drawings[0].nets.findIndex((net) => net[0].startsWith('error.y')), true)");
    page.key("a");
    page.until("document.querySelectorAll('#palette li').length > 100");
    page.replace("PT1");
    page.until("document.querySelector('#palette li b')?.textContent === 'LowPass'");
    page.key("Enter");
    page.until("document.querySelector('.task h3')?.textContent === 'Add LowPass'");
    assert_eq!(
        page.value("document.querySelector('.task select').selectedOptions[0].textContent"),
        "into the wire from error.y to gain.u"
    );
    let field = "document.querySelector('.task input[aria-label=\"tau, s\"]')";
    assert_eq!(page.value(&format!("{field}.value")), "50 ms", "what the page of the kind shows");
    page.value(&format!("{field}.focus()"));
    page.replace("5 kg");
    page.key("Enter");
    page.until("document.querySelector('.task .answer .bad')");
    assert_eq!(desk.read("servo.ron"), SERVO);
    page.replace("5 ms");
    page.key("Enter");
    says(&mut page, "LowPass `low_pass` added into the wire from `error.y`");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 6");
    page.until("document.querySelector('.inspector h3').textContent === 'low_pass'");
    let text = desk.read("servo.ron");
    assert!(
        text.contains("\"low_pass\": LowPass(tau: \"5 ms\"),") && text.contains("\"low_pass.y -> gain.u\""),
        "{text}"
    );
    assert_eq!(page.value("document.querySelectorAll('#problems .error').length"), 0);
}

#[test]
fn chosen_blocks_become_a_subsystem_and_undo_removes_its_file() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &["--edit"]);
    let Some(mut page) = diagram(&studio) else { return };
    for name in ["error", "gain"] {
        page.value(&format!("R.Diagram.show('', '{name}')"));
        page.key("x");
    }
    page.until("document.querySelectorAll('[data-node].also').length === 2");
    page.key("g");
    page.until("document.querySelector('.task input')");
    page.replace("controller");
    page.key("Enter");
    says(&mut page, "2 blocks are in the subsystem `controller` now");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 4");
    assert!(desk.read("controller.ron").contains("\"gain\": Gain"));
    page.value("R.Diagram.go('controller')");
    page.until("document.querySelector('#crumbs').textContent.includes('controller')");
    page.value("document.activeElement.blur()");
    page.control("z");
    page.until("!document.querySelector('#crumbs').textContent.includes('controller')");
    assert!(!desk.0.join("controller.ron").exists());
    assert_eq!(desk.read("servo.ron"), SERVO);
}

const CHOICE: &str = r#"Diagram(
    parameters: { "source": Choice(default: "step", of: ["step", "ramp"]) },
    blocks: {
        "set": Variant(choice: "source", of: {
            "step": Step(time: "1 s", after: 2),
            "ramp": Ramp(slope: "1 1/s"),
        }),
        "show": Scope,
    },
    connections: ["set.y -> show.u"],
)
"#;

#[test]
fn a_variant_is_chosen_by_a_chip() {
    let desk = Desk::with(&[("model.ron", CHOICE)]);
    let studio = Studio::of(&desk, &["--edit"]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#diagram'");
    page.until("document.querySelector('.chips select')?.value === 'step'");
    let choose = |page: &mut Page, within: &str, value: &str| {
        page.value(&format!("(() => {{ const chip = document.querySelector('{within} select'); chip.value = '{value}'; chip.dispatchEvent(new Event('change')); }})()"));
    };
    choose(&mut page, ".chips", "ramp");
    page.until("document.querySelector('.chips select')?.value === 'ramp'");
    assert_eq!(desk.read("model.ron"), CHOICE.replace("default: \"step\"", "default: \"ramp\""));
    page.value("R.Diagram.show('', 'set')");
    page.until("document.querySelector('.inspector .chip select')?.value === 'ramp'");
    choose(&mut page, ".inspector .chip", "step");
    page.until("document.querySelector('.inspector .chip select')?.value === 'step'");
    assert_eq!(desk.read("model.ron"), CHOICE);
}

#[test]
fn the_text_beside_the_picture_is_checked_completed_and_saved() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &["--edit"]);
    let Some(mut page) = diagram(&studio) else { return };
    page.key("t");
    page.until("document.querySelector('.text-pane textarea')?.value.startsWith('// A drive')");
    let caret = |page: &mut Page, before: &str| {
        page.value(&format!("(() => {{ const area = document.querySelector('.text-pane textarea'), at = area.value.indexOf('{before}'); area.focus(); area.setSelectionRange(at, at); }})()"));
    };
    // A slip is shown at its line, and its fix is a press.
    page.value("(() => { const area = document.querySelector('.text-pane textarea'), at = area.value.indexOf('Integrator'); area.focus(); area.setSelectionRange(at, at + 10); })()");
    page.insert("Intergrator");
    page.until("document.querySelector('.text-pane .problems .error')?.textContent.includes('there is no block kind `Intergrator`')");
    page.until("document.querySelector('.gutter .error')?.textContent === '✕ 9'");
    assert_eq!(desk.read("servo.ron"), SERVO, "nothing is written before it is saved");
    page.value("[...document.querySelectorAll('.text-pane .problems button')].find((b) => b.textContent === 'Fix').click()");
    page.until("!document.querySelector('.text-pane .problems .error') && document.querySelector('.text-pane textarea').value.includes('Integrator()')");
    // Completion from what the language server knows: kinds, then ports of a block.
    caret(&mut page, "        \"scope\"");
    page.insert("        \"half\": Ga");
    page.until("!document.querySelector('.completions').hidden && document.querySelector('.completions li b').textContent === 'Gain'");
    page.key("Enter");
    page.until("document.querySelector('.text-pane textarea').value.includes('\"half\": Gain(k: )')");
    page.insert("0.5");
    page.value("(() => { const area = document.querySelector('.text-pane textarea'), at = area.value.indexOf('k: 0.5)') + 7; area.setSelectionRange(at, at); })()");
    page.insert(",\n");
    page.until("document.querySelector('.text-pane .problems .error')?.textContent.includes('`half.u` is not connected')");
    caret(&mut page, "\"error.y -> gain.u\"");
    page.insert("\"error.y -> half.u\", \"half.");
    page.until("document.querySelector('.completions li b')?.textContent === 'y'");
    page.key("Enter");
    page.insert(" -> gain.");
    page.until("document.querySelector('.completions li b')?.textContent === 'u'");
    page.key("Enter");
    // The new text stands before the one that it replaces.
    page.value("(() => { const area = document.querySelector('.text-pane textarea'), at = area.value.indexOf('\"error.y -> gain.u\"'); area.setSelectionRange(at, at + 19); })()");
    page.insert("\"");
    page.until("!document.querySelector('.text-pane .problems .error')");
    page.control("s");
    says(&mut page, "servo.ron is saved");
    page.until("document.querySelectorAll('#diagram-view [data-node]').length === 6");
    let saved = desk.read("servo.ron");
    assert!(saved.contains("\"half\": Gain(k: 0.5),\n") && saved.contains("\"half.y -> gain.u\""), "{saved}");
    assert!(saved.contains("// the target"));
}

#[test]
fn a_text_that_others_change_meanwhile_is_kept_and_both_are_shown() {
    let desk = Desk::with(&[("servo.ron", &SERVO.replace('\n', "\r\n"))]);
    let studio = Studio::of(&desk, &["--edit"]);
    let Some(mut page) = diagram(&studio) else { return };
    page.key("t");
    page.until("document.querySelector('.text-pane textarea')?.value.length > 100");
    // Nobody has typed: what others write is taken over.
    fs::write(desk.0.join("servo.ron"), SERVO.replace("6 1/s", "7 1/s").replace('\n', "\r\n"))
        .expect("a file");
    page.until("document.querySelector('.text-pane textarea').value.includes('7 1/s')");
    page.value("(() => { const area = document.querySelector('.text-pane textarea'); area.focus(); area.setSelectionRange(0, 0); })()");
    page.insert("// mine\n");
    fs::write(desk.0.join("servo.ron"), SERVO.replace("6 1/s", "8 1/s").replace('\n', "\r\n"))
        .expect("a file");
    page.until("!document.querySelector('.conflict').hidden");
    page.control("s");
    says(&mut page, "has been changed by others since");
    assert!(
        page.value("document.querySelector('.text-pane textarea').value")
            .as_str()
            .expect("text")
            .starts_with("// mine\n")
    );
    assert!(desk.read("servo.ron").contains("8 1/s"), "theirs is not written over");
    page.until("document.querySelector('.conflict .difference').textContent.includes('8 1/s')");
    page.value("[...document.querySelectorAll('.conflict button')].find((b) => b.textContent === 'Replace it by mine').click()");
    says(&mut page, "servo.ron is saved");
    let saved = desk.read("servo.ron");
    assert!(
        saved.starts_with("// mine\r\n") && saved.contains("7 1/s\"),\r\n") && !saved.contains("\r\r"),
        "{saved:?}"
    );
    page.until("document.querySelector('.conflict').hidden");
}

#[test]
fn without_leave_nothing_can_be_changed_and_everything_can_be_read() {
    let desk = Desk::with(&[("servo.ron", SERVO), ("secret.txt", "hidden")]);
    let studio = Studio::of(&desk, &[]);
    for (path, body) in [
        ("/api/edit", r#"{"do": "delete", "blocks": ["gain"], "version": 1}"#),
        ("/api/save", r#"{"file": "servo.ron", "base": "", "text": "gone"}"#),
        ("/api/redo", "{}"),
    ] {
        let answer = studio.asked("POST", path, &[], body);
        assert!(answer.starts_with("HTTP/1.1 409") && answer.contains("--edit"), "{answer}");
    }
    for file in ["secret.txt", "../servo.ron", "/etc/passwd", "./servo.ron"] {
        let body = serde_json::json!({ "file": file }).to_string();
        let answer = studio.asked("POST", "/api/text", &[], &body);
        assert!(answer.starts_with("HTTP/1.1 409") && !answer.contains("hidden"), "{answer}");
    }
    let text = studio.asked("POST", "/api/text", &[], r#"{"file": "servo.ron"}"#);
    assert!(text.contains("// A drive that follows a step."), "{text}");
    assert_eq!(desk.read("servo.ron"), SERVO);
    let Some(mut page) = diagram(&studio) else { return };
    assert_eq!(page.value("document.querySelector('.edit-bar').hidden"), true);
    page.value("R.Diagram.show('', 'gain')");
    for key in ["a", "r", "g", "Delete"] {
        page.key(key);
    }
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(page.value("document.querySelector('.task')"), serde_json::Value::Null);
    page.key("t");
    page.until("document.querySelector('.text-pane textarea')?.readOnly === true");
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn what_somebody_has_not_seen_is_not_changed() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &["--edit"]);
    let edit = |version: u32| {
        let body = serde_json::json!({ "do": "delete", "blocks": ["gain"], "version": version });
        studio.asked("POST", "/api/edit", &[], &body.to_string())
    };
    assert!(edit(7).contains("the model has been changed meanwhile"));
    fs::write(desk.0.join("servo.ron"), SERVO.replace("6 1/s", "8 1/s")).expect("a file");
    // The version that was drawn before is an old one, whether the new one has been read yet or not.
    assert!(edit(1).contains("the model has been changed meanwhile"));
    assert!(desk.read("servo.ron").contains("\"gain\": Gain(k: \"8 1/s\")"));
}
