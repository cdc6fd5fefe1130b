//! The way through the studio without a mouse, and for those who do not see it.

use std::fs;

use serde_json::Value;

use super::{Page, SERVO, Studio, planner, shown, with_scara};
use crate::desk::Desk;

/// Presses Tab until an element has the focus.
fn tab_to(page: &mut Page, selector: &str) {
    for _ in 0..100 {
        if page.value(&format!("document.activeElement.matches({selector:?})")) == true {
            return;
        }
        page.chord("Tab", 0);
    }
    panic!(
        "Tab does not lead to {selector}: {}",
        page.value("document.activeElement.outerHTML.slice(0, 200)")
    );
}

#[test]
fn a_move_is_planned_run_and_looked_at_with_keys_alone() {
    let desk = with_scara();
    let studio = Studio::of(&desk, &["--edit", "scara.ron"]);
    let Some(mut page) = shown(&studio) else { return };
    page.key("4");
    page.until("location.hash === '#motion' && document.querySelectorAll('.joint').length === 4 && window.__m.frames > 0");
    tab_to(&mut page, "input[aria-label='A1 target']");
    page.replace("-10");
    page.until("R.Motion.found()?.passes");
    tab_to(&mut page, "input[aria-label='A2, joint']");
    page.chord("PageDown", 0);
    page.until("R.Motion.typed().to[1] === '70' && R.Motion.found()?.passes && Math.abs(R.Motion.found().axes[1].lowest * 180 / Math.PI - 70) < 1e-6");
    // Back to the name of the move, kept and run.
    page.value("document.activeElement.blur()");
    page.key("1");
    page.key("4");
    page.until("location.hash === '#motion'");
    tab_to(&mut page, "input[aria-label='Name of the move']");
    page.replace("reach");
    tab_to(&mut page, ".keep button:last-of-type");
    page.key("Enter");
    page.until("location.hash === '#run' && document.querySelector('.run-line').textContent.includes('simulated in')");
    assert!(desk.read("moves/reach.ron").contains("-10 deg"), "{}", desk.read("moves/reach.ron"));
    assert!(desk.read("scara.ron").contains("File(\"moves/reach.ron\")"));
    // To its results.
    tab_to(&mut page, ".run-line a");
    page.key("Enter");
    page.until("location.hash.startsWith('#runs/') && document.querySelector('iframe.run-page')");
    tab_to(&mut page, "iframe.run-page");
    // The list of all keys, and away from it.
    // The page of the run may still be loading, and take the focus and the key.
    for _ in 0..50 {
        page.value("document.activeElement.blur()");
        page.key("?");
        if page.value("document.getElementById('keys').open") == true {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    page.until("document.getElementById('keys').open");
    page.key("Escape");
    page.until("!document.getElementById('keys').open");
}

/// Roles whose elements have a name for those who hear them.
const NAMED: [&str; 18] = [
    "button",
    "textbox",
    "searchbox",
    "combobox",
    "checkbox",
    "radio",
    "slider",
    "link",
    "image",
    "heading",
    "switch",
    "spinbutton",
    "table",
    "dialog",
    "progressbar",
    "Canvas",
    "Iframe",
    "figure",
];

/// Elements without a name, and what else is found of them.
fn unnamed(page: &mut Page) -> Vec<String> {
    let text = |node: &Value, what: &str| node[what]["value"].as_str().unwrap_or_default().trim().to_owned();
    let tree = page.tree();
    let shown = tree.iter().filter(|node| node["ignored"] != true);
    shown
        .filter(|node| NAMED.contains(&text(node, "role").as_str()) && text(node, "name").is_empty())
        .map(|node| format!("{} {}", text(node, "role"), node["properties"]))
        .collect()
}

/// Elements that take the focus, and do not show it.
const UNSEEN: &str = "[...document.querySelectorAll('a[href], button, input, select, textarea, [tabindex=\"0\"], summary')]
    .filter((one) => one.checkVisibility() && !one.disabled && !one.closest('dialog'))
    .filter((one) => { one.focus({ focusVisible: true }); const look = getComputedStyle(one);
        return document.activeElement === one && !(look.outlineStyle !== 'none' && parseFloat(look.outlineWidth) >= 2) && look.boxShadow === 'none'; })
    .map((one) => one.outerHTML.slice(0, 120))";

/// What is wider than the page, unless it scrolls by itself.
const WIDE: &str = "(() => { const page = document.documentElement;
    const scrolls = (one) => { for (let up = one.parentElement; up; up = up.parentElement) if (['auto', 'scroll', 'hidden'].includes(getComputedStyle(up).overflowX)) return true; return false; };
    return [...document.querySelectorAll('body *')].filter((one) => one.checkVisibility() && one.getBoundingClientRect().width > 0 && one.getBoundingClientRect().right > innerWidth + 1 && !scrolls(one))
        .map((one) => one.outerHTML.slice(0, 120)).concat(page.scrollWidth > page.clientWidth ? [`${page.scrollWidth} of ${page.clientWidth}`] : []); })()";

/// Looks at a screen as it is for eyes, ears and fingers.
fn look(page: &mut Page, screen: &str) {
    assert_eq!(unnamed(page), Vec::<String>::new(), "{screen}: without a name");
    assert_eq!(page.value(UNSEEN), serde_json::json!([]), "{screen}: the focus cannot be seen");
    // 1300 dots at 200 %, and a telephone.
    for (width, height) in [(650, 450), (390, 844)] {
        page.size(width, height, 2);
        page.until(&format!("innerWidth === {width}"));
        page.value(
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(null))))",
        );
        assert_eq!(page.value(WIDE), serde_json::json!([]), "{screen} at {width}: wider than the page");
    }
    page.size(1300, 900, 1);
}

#[test]
fn every_screen_has_names_shows_the_focus_and_fits() {
    let panel = SERVO.replace("    blocks:", "    panel: [Slider(\"gain.k\", \"0 .. 20 1/s\"), Gauge(\"angle.y\", \"0 .. 120 deg\")],\n    blocks:");
    let desk = Desk::with(&[("servo.ron", &panel)]);
    let studio = Studio::of(&desk, &["--edit", "servo.ron"]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#run'; R.Live.run([])");
    page.until(
        "document.querySelector('.run-line').textContent.includes('simulated in') && R.Live.rows() > 20",
    );
    look(&mut page, "run");
    for (screen, ready) in [
        ("project", "document.querySelector('#project-view table')"),
        ("diagram", "document.querySelector('#diagram-view [data-node]')"),
        ("values", "document.querySelector('#values-view tbody tr')"),
        ("motion", "document.querySelector('#motion-view .note')"),
        ("runs", "document.querySelector('#runs-view tbody tr')"),
        ("sweep", "document.querySelector('#sweep-view input')"),
        ("linear", "document.querySelector('#linear-view input')"),
        ("plugins", "document.querySelector('#plugins-view input')"),
    ] {
        page.value(&format!("location.hash = '#{screen}'"));
        page.until(ready);
        if screen == "diagram" {
            page.value("R.Diagram.show('', 'gain')");
            page.until("document.querySelector('.inspector table')");
        }
        look(&mut page, screen);
    }
    // A model that cannot be run.
    fs::write(desk.0.join("servo.ron"), SERVO.replace("gain.u", "gain.v")).expect("a file");
    page.value("location.hash = '#project'");
    page.until("document.querySelector('#project-view .problems')");
    look(&mut page, "problems");
}

#[test]
fn the_planner_has_names_shows_the_focus_and_fits() {
    let desk = with_scara();
    let studio = Studio::of(&desk, &["scara.ron"]);
    let Some(mut page) = planner(&studio) else { return };
    page.value("document.querySelector('input[aria-label=\"A1 target\"]').focus()");
    page.replace("-10");
    page.until("R.Motion.found()?.passes && document.querySelector('.move-seen .card canvas')");
    page.value("[...document.querySelectorAll('.space-bar button')].find((one) => one.textContent === 'Film').click()");
    look(&mut page, "motion");
}
