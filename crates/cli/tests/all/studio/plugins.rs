//! Plug-ins of the model on the page: made, built by a run, out of date, broken and corrected.

use std::fs;
use std::time::Duration;

use super::{SERVO, Studio, shown};
use crate::desk::Desk;

#[test]
fn a_plug_in_is_made_built_out_of_date_broken_and_corrected() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    fs::create_dir(desk.0.join("plugins")).expect("a folder");
    let studio = Studio::of(&desk, &["--edit", "servo.ron"]);
    let Some(mut page) = shown(&studio) else { return };
    page.key("9");
    page.until("document.querySelector('#plugins-view').textContent.includes('The model has no plug-ins.')");
    let field = "document.querySelector('#plugins-view input').focus()";
    let told = "document.querySelector('.new-plugin [role=status]').textContent";
    page.value("document.querySelector('#plugins-view select').value = 'c'");
    // A path, a name that is not allowed, a valid name, and one that is taken.
    for (name, answer) in [
        ("../away", "the name of a plug-in is a word"),
        ("My Law", "is not a valid name"),
        ("law", "The controller Law is there"),
        ("law", "already exists"),
    ] {
        page.value(field);
        page.replace(name);
        page.key("Enter");
        page.until(&format!("{told}.includes({answer:?})"));
        if answer.contains("there") {
            assert_eq!(
                page.value(&format!("{told}.includes('Plugin(library: \"plugins/law\", block: \"Law\")')")),
                true,
                "{}",
                page.value(told)
            );
        }
    }
    assert!(!desk.0.join("away").exists() && desk.0.join("plugins/law/controller.c").is_file());
    // The diagram that came with it is run, which builds it.
    page.until("R.Project.known().models.includes('plugins/law/demo.ron')");
    page.value("R.Desk.ask('model', { model: 'plugins/law/demo.ron' }).then(() => null)");
    page.until("R.Project.known().model === 'plugins/law/demo.ron'");
    page.key("F5");
    page.until("document.querySelector('.run-line').textContent.includes('s simulated in')");
    page.key("9");
    let state = "document.querySelector('#plugins-view .state')?.textContent";
    page.until(&format!("{state}?.includes('ready')"));
    page.until("document.querySelector('#plugins-view h3')?.textContent === 'Law' && document.querySelectorAll('#plugins-view tbody tr').length >= 3");
    let row = "[...document.querySelectorAll('#project-view tbody tr')].find((row) => row.textContent.startsWith('Plug-ins'))?.textContent";
    page.until(&format!("{row}?.includes('ready')"));
    // Its source changes: out of date, until a run builds it.
    let source = desk.0.join("plugins/law/controller.c");
    let law = fs::read_to_string(&source).expect("the law");
    fs::write(&source, format!("{law}\n/* later */\n")).expect("a file");
    page.until(&format!("{state}?.includes('stale') && {row}.includes('stale')"));
    page.value("R.Desk.ask('run', {}).then(() => null)");
    page.until(&format!("{state}?.includes('ready') && {row}.includes('ready')"));
    // It does not compile, which is one error with the words of the compiler; and then it does.
    fs::write(&source, format!("{law}\nthis is no C\n")).expect("a file");
    page.until(&format!("{state}?.includes('stale')"));
    page.value("R.Desk.ask('run', {}).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('does not build')");
    // What was built a moment ago is not looked at again.
    std::thread::sleep(Duration::from_millis(2100));
    fs::write(desk.0.join("plugins/law/demo.ron"), desk.read("plugins/law/demo.ron") + "\n// seen anew\n")
        .expect("a file");
    page.until(&format!("{state}?.includes('error') && document.querySelector('#plugins-view pre.bad').textContent.includes('controller.c')"));
    fs::write(&source, &law).expect("a file");
    page.until(&format!("{state}?.includes('ready')"));
    let refusals = page.complaints.iter().filter(|told| !told.contains("409")).count();
    assert_eq!(refusals, 0, "{:?}", page.complaints);
}

#[test]
fn a_plug_in_that_was_built_long_before_another_one_is_not_out_of_date() {
    let desk = Desk::with(&[(
        "both.ron",
        r#"Diagram(
    simulation: (stop_time: "0.1 s"),
    blocks: {
        "step": Step(time: "10 ms", after: 1.0),
        "one": Plugin(library: "plugins/one", block: "One"),
        "two": Plugin(library: "plugins/two", block: "Two"),
        "scope": Scope(inputs: ["one", "two"]),
    },
    connections: ["step.y -> one.e, two.e", "one.u -> scope.one", "two.u -> scope.two"],
)"#,
    )]);
    for folder in ["plugins/one", "plugins/two"] {
        let made = desk.call(&["plugin", "new", folder, "--language", "c"]);
        assert_eq!(made.code, Some(0), "{}", made.err);
    }
    let studio = Studio::of(&desk, &["both.ron"]);
    let until = |state: &str| {
        let wanted = format!("\"state\":\"{state}\"");
        let mut answer = String::new();
        for _ in 0..400 {
            answer = studio.asked("GET", "/api/plugins", &[], "");
            if answer.contains(&wanted) {
                return answer;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        panic!("never {state}: {answer}")
    };
    let run = || assert_eq!(studio.status("POST", "/api/run", &[], "{}"), 200);
    run();
    until("ready");
    let source = desk.0.join("plugins/one/controller.c");
    fs::write(&source, fs::read_to_string(&source).expect("the law") + "/* later */\n").expect("a file");
    let stale = until("stale");
    assert!(stale.contains("changed in plugins/one,") && !stale.contains("plugins/two,"), "{stale}");
    run();
    until("ready");
}

#[test]
fn plug_ins_of_strangers_are_not_made_or_built() {
    let desk = Desk::with(&[("servo.ron", SERVO)]);
    let studio = Studio::of(&desk, &[]);
    let answer = studio.asked("POST", "/api/plugin", &[], r#"{"name": "law", "language": "c"}"#);
    assert!(answer.starts_with("HTTP/1.1 409") && answer.contains("may not change files"), "{answer}");
    assert!(!desk.0.join("plugins").exists());
    let model = SERVO.replace("Gain(k: \"6 1/s\")", "Plugin(library: \"law\", block: \"Law\")");
    fs::create_dir(desk.0.join("law")).expect("a folder");
    fs::write(desk.0.join("law/law.c"), "#include \"blocksim_plugin.h\"\n").expect("a file");
    fs::write(desk.0.join("servo.ron"), model).expect("a file");
    let found = |answer: &str| answer.contains("\"state\":\"missing\"") && answer.contains("is not trusted");
    let mut answer = String::new();
    for _ in 0..200 {
        answer = studio.asked("GET", "/api/plugins", &[], "");
        if found(&answer) {
            break;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    assert!(found(&answer), "{answer}");
    assert_eq!(fs::read_dir(desk.0.join("law")).expect("a folder").count(), 1, "nothing was built");
}
