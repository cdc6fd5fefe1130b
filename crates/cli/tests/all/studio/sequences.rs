//! Sequences of moves: typed, planned as the command plans them, kept and read again.

use std::fs;

use super::{Page, Studio, planner, shown, with_robot, with_scara};

/// What `plan sequence` finds of a file of moves, as JSON.
fn by_command(desk: &crate::desk::Desk, file: &str, model: &str) -> String {
    let done = desk.call(&["plan", "sequence", file, "--robot", model, "--json"]);
    assert!(done.err.is_empty(), "{}", done.err);
    done.out.trim().to_owned()
}

/// Whether the page has found the same as the command, to the bit.
fn same(json: &str) -> String {
    format!(
        "(() => {{ const here = R.Motion.found(), there = {json}; return Object.keys(there).every((key) => key === 'collisions' && !there[key] \
         || JSON.stringify(here[key]) === JSON.stringify(there[key])) && here.duration > 0; }})()"
    )
}

/// Types into a field of the form.
fn fill(page: &mut Page, name: &str, text: &str) {
    page.value(&format!("document.querySelector('.move-form [aria-label=\"{name}\"]').focus()"));
    page.replace(text);
}

fn choose(page: &mut Page, group: &str, word: &str) {
    page.value(&format!("document.querySelector('input[name=\"{group}\"][value=\"{word}\"]').click()"));
}

fn press(page: &mut Page, text: &str) {
    page.value(&format!(
        "[...document.querySelectorAll('#motion-view button')].find((one) => one.textContent === {text:?}).click()"
    ));
}

/// What is seen of each move in the list.
fn listed(page: &mut Page) -> Vec<String> {
    let all = page.value("[...document.querySelectorAll('.moves li .goes')].map((one) => one.textContent)");
    all.as_array().expect("rows").iter().map(|row| row.as_str().expect("text").to_owned()).collect()
}

const PLANNED: &str = "R.Motion.found()?.passes && !document.querySelector('.move-result .bad')";

#[test]
fn a_sequence_that_is_typed_is_the_one_that_the_command_plans() {
    let desk = with_robot();
    let model = "diagrams/irb2600/irb2600.ron";
    let studio = Studio::of(&desk, &["--edit", model]);
    let Some(mut page) = shown(&studio) else { return };
    page.value("location.hash = '#motion'");
    page.until("document.querySelectorAll('.axes tbody tr').length === 6");
    choose(&mut page, "kind", "sequence");
    for (n, text) in ["25", "20", "5", "0", "40", "0"].into_iter().enumerate() {
        fill(&mut page, &format!("A{} start", n + 1), text);
    }
    // A line with a rounded corner behind it.
    choose(&mut page, "move-kind", "linear");
    for (name, text) in [
        ("target x", "1300"),
        ("target y", "-100"),
        ("target z", "900,0"),
        ("speed", "400"),
        ("acceleration", "10"),
        ("rounding", "20"),
    ] {
        fill(&mut page, name, text);
    }
    page.value("(() => { const one = document.querySelector('select[aria-label=orientation]'); one.value = 'fixed'; one.dispatchEvent(new Event('change')); })()");
    page.until(PLANNED);
    // Another one like it, up and with a wait.
    press(&mut page, "Duplicate");
    for (name, text) in
        [("target y", "200"), ("rounding", ""), ("wait", "0,5"), ("comment", "Over the part.")]
    {
        fill(&mut page, name, text);
    }
    // An arc on which the tool turns, in a work object.
    press(&mut page, "Add");
    choose(&mut page, "move-kind", "circular");
    page.value("document.querySelector('.fields details.more').open = true");
    page.value("(() => { const one = document.querySelector('select[aria-label=orientation]'); one.value = 'interpolated'; one.dispatchEvent(new Event('change')); })()");
    for (name, text) in [
        ("target x", "300"),
        ("target y", "0"),
        ("target z", "0"),
        ("through x", "300"),
        ("through y", "100"),
        ("through z", "150"),
        ("rotation α (about z)", "-165"),
        ("rotation β (about y)", "-20"),
        ("rotation γ (about x)", "170"),
        ("work object x", "1"),
        ("work object z", "900"),
        ("speed", "0.2 m/s"),
        ("turning speed", "60"),
    ] {
        fill(&mut page, name, text);
    }
    fill(&mut page, "work object x", "1000");
    // And home.
    press(&mut page, "Add");
    choose(&mut page, "move-kind", "joint");
    for n in 1..=6 {
        fill(&mut page, &format!("A{n} target"), "0");
    }
    fill(&mut page, "velocity", "30");
    page.until("R.Motion.found()?.steps.length === 4");
    page.until(PLANNED);
    page.value("document.querySelector('input[aria-label=\"Name of the move\"]').focus()");
    page.replace("round");
    press(&mut page, "Keep");
    page.until("document.getElementById('status').textContent.includes('moves/round.ron is kept')");
    let file = "diagrams/irb2600/moves/round.ron";
    let text = desk.read(file);
    for part in [
        "\"900.0 mm\"",
        "// Over the part.",
        "\"0.5 s\"",
        "\"0.2 m/s\"",
        "work_object",
        "\"60 deg/s\"",
        "zone: \"20 mm\"",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let command = by_command(&desk, file, model);
    assert_eq!(
        page.value(&same(&command)),
        true,
        "{command}\n{}",
        page.value("JSON.stringify(R.Motion.found())")
    );
    // Its moves run one after the other: where the time stands is marked in the list and on the line of the times.
    page.value("R.setTime(R.Motion.found().steps[2].begin + 0.01)");
    assert_eq!(page.value("document.querySelector('.moves [aria-current=step] .number').textContent"), "3");
    assert_eq!(page.value("document.querySelector('.strip .present').textContent"), "3");
    page.value("document.querySelectorAll('.strip button')[1].click()");
    assert_eq!(
        page.value(
            "R.now === R.Motion.found().steps[1].begin && document.querySelector('.of-move').textContent"
        ),
        "Move 2 of 4"
    );
    // One that is read again is the same, and leads to the same file.
    let before = page.value("JSON.stringify(R.Motion.found())");
    page.open(&studio.address);
    page.until("document.documentElement.dataset.ready === 'true' && R.Motion.found() === null");
    page.value("location.hash = '#motion'");
    page.until("document.querySelectorAll('.axes tbody tr').length === 6");
    page.value("R.Motion.load('moves/round.ron')");
    page.until("R.Motion.found()?.steps.length === 4");
    assert_eq!(page.value("JSON.stringify(R.Motion.found())"), before);
    page.value("document.querySelector('.keep input[type=checkbox]').checked = true");
    press(&mut page, "Use in the model");
    page.until("document.getElementById('status').textContent.includes('File(')");
    assert_eq!(desk.read(file), text, "kept anew it is as it was");
    assert!(desk.read(model).contains("\"move\": File(\"moves/round.ron\")"));
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_faulty_move_in_the_middle_is_named_and_kept() {
    let desk = with_scara();
    fs::create_dir(desk.0.join("moves")).expect("a folder");
    fs::copy(desk.0.join("pick.ron"), desk.0.join("moves/pick.ron")).expect("a file");
    let studio = Studio::of(&desk, &["--edit", "scara.ron"]);
    let Some(mut page) = planner(&studio) else { return };
    // A sequence that is shipped, as it is.
    let file = desk.read("pick.ron");
    page.value("R.Motion.load('moves/pick.ron')");
    page.until("R.Motion.found()?.steps.length === 3");
    let command = by_command(&desk, "pick.ron", "scara.ron");
    assert_eq!(page.value(&same(&command)), true, "{command}");
    page.value("document.querySelector('input[aria-label=\"Name of the move\"]').focus()");
    page.replace("again");
    press(&mut page, "Keep");
    page.until("document.getElementById('status').textContent.includes('moves/again.ron is kept')");
    assert_eq!(by_command(&desk, "moves/again.ron", "scara.ron"), command);
    let comment = file.lines().next().expect("a line");
    assert!(comment.starts_with("//") && desk.read("moves/again.ron").starts_with(comment));
    // A text for a number in the second of three moves.
    page.value("document.querySelectorAll('.moves li')[1].click()");
    fill(&mut page, "target x", "abc");
    page.until(
        "document.querySelectorAll('.moves li')[1].querySelector('.why') && R.Motion.found() === null",
    );
    assert_eq!(page.value("document.querySelector('input[aria-label=\"target x\"]').value"), "abc");
    assert_eq!(
        page.value("document.querySelector('input[aria-label=\"target x\"]').getAttribute('aria-invalid')"),
        "true"
    );
    let told = page.value("document.querySelector('.move-result .bad').textContent");
    assert!(told.as_str().is_some_and(|told| told.starts_with("Move 2, target x: ")), "{told}");
    assert_eq!(page.value("document.querySelector('.keep button').disabled"), true);
    // Another move stays what it is, and leads back.
    page.value("document.querySelectorAll('.moves li')[2].click()");
    assert_eq!(page.value("document.querySelectorAll('.move-form [aria-invalid]').length"), 0);
    fill(&mut page, "speed", "");
    page.until("document.querySelectorAll('.move-result .bad').length === 2");
    fill(&mut page, "speed", "500 mm/s");
    page.until("document.querySelectorAll('.move-result .bad').length === 1");
    page.value("document.querySelector('.move-result .bad button').click()");
    assert_eq!(
        page.value("document.activeElement.getAttribute('aria-label') + document.activeElement.value"),
        "target xabc"
    );
    // Out of reach: the time of the move before is known all the same.
    page.replace("2000");
    page.until("document.querySelector('.move-result .bad')?.textContent.includes('reach')");
    assert_eq!(page.value("document.querySelectorAll('.moves li')[1].querySelector('.why') !== null"), true);
    assert!(
        page.value("document.querySelectorAll('.moves .takes')[0].textContent")
            .as_str()
            .is_some_and(|text| text.ends_with(" s"))
    );
    // Beyond a limit of the robot: it has a plan, and the move is marked.
    page.replace("380.986871");
    page.until(PLANNED);
    fill(&mut page, "speed", "3000");
    fill(&mut page, "acceleration", "100");
    page.until("R.Motion.found()?.passes === false");
    page.until("document.querySelectorAll('.moves li')[1].querySelector('.why')?.textContent.length > 0");
    fill(&mut page, "wait", "1");
    fill(&mut page, "rounding", "5");
    page.until("document.querySelectorAll('.moves li')[1].querySelector('.why')?.textContent.includes('zone and a wait')");
}

#[test]
fn moves_are_listed_and_moved_by_keys_alone() {
    let desk = with_scara();
    fs::create_dir(desk.0.join("moves")).expect("a folder");
    fs::copy(desk.0.join("pick.ron"), desk.0.join("moves/pick.ron")).expect("a file");
    let studio = Studio::of(&desk, &["scara.ron"]);
    let Some(mut page) = planner(&studio) else { return };
    page.value("R.Motion.load('moves/pick.ron')");
    page.until("R.Motion.found()?.steps.length === 3");
    let first = listed(&mut page);
    page.value("document.querySelector('.moves').focus()");
    page.chord("ArrowDown", 0);
    assert_eq!(page.value("document.querySelector('.of-move').textContent"), "Move 2 of 3");
    page.chord("ArrowDown", 1);
    let moved = listed(&mut page);
    assert_eq!([&moved[1], &moved[2]], [&first[2], &first[1]]);
    assert_eq!(page.value("document.querySelector('.of-move').textContent"), "Move 3 of 3");
    page.chord("d", 2);
    assert_eq!(listed(&mut page).len(), 4);
    page.chord("Home", 0);
    page.chord("Insert", 0);
    assert_eq!(page.value("document.querySelector('.of-move').textContent"), "Move 2 of 5");
    page.chord("Delete", 0);
    page.chord("Delete", 0);
    assert_eq!(listed(&mut page).len(), 3);
    for _ in 0..5 {
        page.chord("z", 2);
    }
    assert_eq!(listed(&mut page), first, "all of it is taken back");
    // From the list to the fields and with Tab to the next one.
    page.chord("End", 0);
    page.key("Enter");
    assert_eq!(
        page.value("document.activeElement.getAttribute('aria-label') ?? document.activeElement.value"),
        "target x"
    );
    page.until("R.Motion.found()?.steps.length === 3");
    // Those who do not see it hear a list with its moves, of which one is selected.
    let tree = page.tree();
    let is = |node: &serde_json::Value, role: &str| node["role"]["value"] == role;
    assert!(tree.iter().any(|node| is(node, "listbox") && node["name"]["value"] == "Moves of the sequence"));
    let options: Vec<_> = tree
        .iter()
        .filter(|node| {
            is(node, "option") && node["name"]["value"].as_str().is_some_and(|name| name.contains("line to"))
        })
        .collect();
    assert_eq!(options.len(), 2, "{options:?}");
}

#[test]
fn what_the_form_cannot_hold_is_not_read() {
    let desk = with_scara();
    fs::create_dir(desk.0.join("moves")).expect("a folder");
    let odd = desk.read("pick.ron").replacen(
        "velocity: \"80 %\"",
        "velocity: \"80 %\", tool: (target: [1, 1, 1], velocity: 1, acceleration: 1)",
        1,
    );
    fs::write(desk.0.join("moves/odd.ron"), odd).expect("a file");
    let studio = Studio::of(&desk, &["scara.ron"]);
    let Some(mut page) = planner(&studio) else { return };
    page.value("R.Motion.load('moves/odd.ron')");
    page.until(
        "document.getElementById('status').textContent.includes('`moves/odd.ron` cannot be edited here')",
    );
    assert_eq!(page.value("R.Motion.typed().kind"), "joint");
}
