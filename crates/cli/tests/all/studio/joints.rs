//! Joints of a robot that are moved by mouse, finger and keys.

use super::{Page, Studio, planner, with_scara};

/// Where a point of the first link is on the page, nearer to its own joint.
const ARM: &str = "(() => { const canvas = document.querySelector('#space-view canvas'); canvas.scrollIntoView({ block: 'center' });
    const box = canvas.getBoundingClientRect(),
    [a, b] = [R.Joints.project(0), R.Joints.project(1)]; return [0, 1].map((k) => (k ? box.y : box.x) + 0.7 * a[k] + 0.3 * b[k]); })()";

fn arm(page: &mut Page) -> [f64; 2] {
    let at = page.value(ARM);
    [0, 1].map(|k| at[k].as_f64().expect("a number"))
}

/// The number in the field of an axis.
fn target(page: &mut Page, axis: usize) -> f64 {
    let text = page.value(&format!("document.querySelector('input[aria-label=\"A{axis} target\"]').value"));
    text.as_str().and_then(|text| text.parse().ok()).expect("a number")
}

fn keys(page: &mut Page, axis: usize, keys: &[&str]) {
    page.value(&format!("document.querySelector('input[aria-label=\"A{axis}, joint\"]').focus()"));
    for key in keys {
        page.chord(key, 0);
    }
}

#[test]
fn a_link_is_dragged_about_its_joint_until_its_range_ends() {
    let desk = with_scara();
    let studio = Studio::of(&desk, &["scara.ron"]);
    let Some(mut page) = planner(&studio) else { return };
    page.value("[...document.querySelectorAll('.space-bar button')].find((one) => one.textContent === 'above').click()");
    // Text that is not a number stays in its field.
    page.value("document.querySelector('input[aria-label=\"A4 target\"]').focus()");
    page.replace("abc");
    // Where the link is seen at -10 degrees and at -30, where it was.
    keys(&mut page, 1, &["PageUp", "PageUp"]);
    assert_eq!(target(&mut page, 1), -10.0);
    let there = arm(&mut page);
    keys(&mut page, 1, &["PageDown", "PageDown"]);
    let here = arm(&mut page);
    page.drag(here, there, true);
    let dragged = target(&mut page, 1);
    assert!((dragged + 10.0).abs() < 3.0, "{dragged}");
    assert_eq!(
        page.value("document.querySelectorAll('.axes .told')[3].textContent"),
        "target abc is not a number"
    );
    page.value("document.querySelector('input[aria-label=\"A4 target\"]').focus()");
    page.replace("0");
    page.until(&format!("Math.abs(R.Motion.found()?.axes[0].highest * 180 / Math.PI - {dragged}) < 1e-6"));
    // As far as its range goes, and no further.
    keys(&mut page, 1, &["End"]);
    let end = arm(&mut page);
    keys(&mut page, 1, &["ArrowLeft"]);
    let before = arm(&mut page);
    page.drag(before, [0, 1].map(|k| end[k] + 20.0 * (end[k] - before[k])), true);
    assert_eq!(target(&mut page, 1), 130.0);
    assert_eq!(page.value("document.querySelectorAll('.joint')[0].className"), "joint stop");
    assert_eq!(
        page.value("document.querySelectorAll('.joint output')[0].textContent"),
        "130.00 ° ■ upper limit"
    );
    // Back, step by step: the last drag, the keys, the first drag.
    let mut back = Vec::new();
    for _ in 0..3 {
        page.chord("z", 2);
        back.push(target(&mut page, 1));
    }
    assert_eq!(back, [129.0, dragged, -30.0]);
    // Escape leaves a joint where it was.
    let here = arm(&mut page);
    page.drag(here, there, false);
    assert!(target(&mut page, 1) > -30.0);
    page.key("Escape");
    assert_eq!(target(&mut page, 1), -30.0);
    // The plan of where it is now may still move the page.
    let mut seen = arm(&mut page);
    for _ in 0..40 {
        std::thread::sleep(std::time::Duration::from_millis(200));
        let now = arm(&mut page);
        if std::mem::replace(&mut seen, now) == now {
            break;
        }
    }
    // What has come below or gone may have moved the page since, so both places are seen at once: from above 20 degrees of the joint are
    // 20 degrees of the picture.
    let pivot = page.value(&ARM.replace("0.7 * a[k] + 0.3 * b[k]", "a[k]"));
    let pivot = [0, 1].map(|k| pivot[k].as_f64().expect("a number"));
    let here = arm(&mut page);
    let (sin, cos) = 20.0_f64.to_radians().sin_cos();
    let [x, y] = [0, 1].map(|k| here[k] - pivot[k]);
    page.swipe(here, [pivot[0] + cos * x + sin * y, pivot[1] - sin * x + cos * y]);
    let target = "Number(document.querySelector('input[aria-label=\"A1 target\"]').value)";
    page.until(&format!("Math.abs({target} + 10) < 5"));
}

#[test]
fn joints_are_moved_by_keys() {
    let desk = with_scara();
    let studio = Studio::of(&desk, &["scara.ron"]);
    let Some(mut page) = planner(&studio) else { return };
    page.value("document.querySelector('input[aria-label=\"A3, joint\"]').focus()");
    let mut seen = Vec::new();
    for (key, modifiers) in
        [("PageDown", 0), ("ArrowRight", 0), ("ArrowUp", 8), ("ArrowLeft", 0), ("End", 0), ("ArrowRight", 0)]
    {
        page.chord(key, modifiers);
        seen.push(target(&mut page, 3));
    }
    assert_eq!(seen, [-30.0, -29.0, -28.9, -29.9, 0.0, 0.0]);
    assert_eq!(
        page.value("document.activeElement.getAttribute('aria-valuetext')"),
        "0.00 mm, at its upper limit"
    );
    // Bare numbers of an axis that slides are millimetres.
    page.until("R.Motion.found() && Math.abs(R.Motion.found().axes[2].highest) < 1e-9 && Math.abs(R.Motion.found().axes[2].lowest + 0.02) < 1e-9");
    page.chord("z", 2);
    assert_eq!(target(&mut page, 3), -20.0, "what was done without a break is taken back as one");
    // The start instead of the target.
    page.value("(() => { const choice = document.querySelector('select[aria-label=\"What is moved\"]'); choice.value = 'from'; choice.dispatchEvent(new Event('change')); })()");
    keys(&mut page, 1, &["PageDown"]);
    assert_eq!(page.value("document.querySelector('input[aria-label=\"A1 start\"]').value"), "-40");
    assert_eq!(target(&mut page, 1), -30.0);
}

#[test]
fn the_limit_takes_the_place_of_what_is_beyond_it_and_the_start_is_a_ghost() {
    let desk = with_scara();
    let studio = Studio::of(&desk, &["scara.ron"]);
    let Some(mut page) = planner(&studio) else { return };
    for (field, typed, which, end) in
        [("A1 target", "9999", "to", "upper"), ("A2 start", "-9999,5", "from", "lower")]
    {
        let axis = if field.starts_with("A1") { 0 } else { 1 };
        page.value(&format!("document.querySelector('input[aria-label=\"{field}\"]').focus()"));
        page.replace(typed);
        let button =
            format!("document.querySelectorAll('.axes tbody tr')[{axis}].querySelector('.ends button')");
        page.until(&button);
        page.value(&format!("{button}.focus()"));
        page.key("Enter");
        page.until(&format!("!{button} && R.Motion.found()"));
        // It is the limit, the focus is in the field, and nothing is wrong with it any more.
        let taken =
            page.value("[document.activeElement.getAttribute('aria-label'), document.activeElement.value]");
        assert_eq!(taken[0], *field);
        let limit = page.value(&format!("R.Motion.axes()[{axis}].{end}")).as_f64().expect("a limit");
        let value: f64 = taken[1].as_str().and_then(|text| text.parse().ok()).expect("a number");
        assert!((value - limit).abs() < 1e-4, "{which}: {value}, {limit}");
        page.until(&format!("document.querySelectorAll('.axes .told')[{axis}].textContent === ''"));
    }
    // Start and target stand beside the move, as the fields have them.
    page.until(
        "(() => { const { begin, set } = R.Space.stage().movement, typed = R.Motion.typed(); \
         return R.Motion.axes().every((axis, n) => { const one = axis.unit === 'mm' ? 1e-3 : Math.PI / 180; \
         return Math.abs(begin[n] - one * Number(typed.from[n])) < 1e-6 && Math.abs(set[n][0] - one * Number(typed.to[n])) < 1e-6; }); })()",
    );
    let named = page.value("[...document.querySelectorAll('#space-view .space-bar label')].filter((one) => !one.hidden).map((one) => one.textContent.trim()).slice(0, 2)");
    assert_eq!(named, serde_json::json!(["start", "target"]));
}
