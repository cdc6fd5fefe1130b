//! `blocksim new`, `completions` and `doctor` as users call them.

use crate::desk::Desk;
use crate::support::{arguments, commands_of};

#[test]
fn every_template_is_a_project_that_is_right_and_laid_out() {
    let desk = Desk::with(&[]);
    let listed = desk.call(&["new", "--list"]).out;
    let names: Vec<&str> = listed.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(names, ["servo", "robot", "plugin", "c", "cpp", "empty"]);
    for name in names {
        let answer = desk.call(&["new", name, "--template", name]);
        assert_eq!(answer.code, Some(0), "{}", answer.text());
        let run = answer.out.lines().find(|line| line.contains("blocksim run ")).expect("a command");
        let words: Vec<&str> = run.split('#').next().expect("a command").split_whitespace().skip(1).collect();
        let readme = desk.read(&format!("{name}/README.md"));
        assert_eq!(readme.matches("\nblocksim ").count(), 3, "{readme}");
        assert!(readme.starts_with(&format!("# {name}\n")), "{readme}");
        assert_eq!(desk.call(&["fmt", name, "--check"]).code, Some(0), "{name}");
        let outcome = desk.call(&[&words[..], &["--no-plot", "--until", "0.5 s"]].concat());
        assert_eq!(outcome.code, Some(0), "{words:?}: {}", outcome.text());
    }
    let lib = desk.read("plugin/controller/src/lib.rs");
    assert!(lib.contains("Controller") && !lib.contains("MyController"), "{lib}");
    let model = desk.read("plugin/loop.ron");
    assert!(model.contains("library: \"controller\"") && !model.contains("my_controller"), "{model}");
    assert!(desk.read("c/loop.ron").contains("controller/controller.c`"));
    assert!(desk.read("cpp/loop.ron").contains("controller/controller.cpp`"));
}

/// Commands that a file recommends: lines of their own in comments and scripts, and what stands between backticks.
fn advice(text: &str) -> Vec<String> {
    let lines = text.lines().map(|line| line.trim_start_matches("//").trim());
    let own = lines.filter(|line| line.starts_with("blocksim ")).map(str::to_owned);
    let quoted = text.split('`').skip(1).step_by(2).filter(|words| words.starts_with("blocksim "));
    own.chain(quoted.map(str::to_owned)).collect()
}

#[test]
fn every_advice_in_the_files_of_a_project_works() {
    let desk = Desk::with(&[]);
    let mut count = 0;
    for name in ["servo", "robot", "plugin", "c", "cpp", "empty"] {
        assert_eq!(desk.call(&["new", name, "--template", name]).code, Some(0));
        let mut folders = vec![desk.0.join(name)];
        while let Some(folder) = folders.pop() {
            for entry in
                std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path())
            {
                if entry.is_dir() {
                    if !["target", "runs"].iter().any(|made| entry.ends_with(made)) {
                        folders.push(entry);
                    }
                    continue;
                }
                for command in advice(&std::fs::read_to_string(&entry).expect("a text")) {
                    // What follows a file never ends by itself; it has its own tests.
                    let line = command
                        .split('#')
                        .next()
                        .unwrap_or_default()
                        .replace(" --watch", "")
                        .replace("KIND", "Gain");
                    let words = arguments(&line);
                    let words: Vec<&str> = words[1..].iter().map(String::as_str).collect();
                    // As the README of a controller's folder is written for that folder, so is every other text.
                    let output =
                        desk.command(&words).current_dir(&folder).output().expect("the program runs");
                    let said = String::from_utf8_lossy(&output.stderr);
                    assert_eq!(output.status.code(), Some(0), "{}: {command}: {said}", entry.display());
                    count += 1;
                }
            }
        }
    }
    assert!(count > 20, "only {count} commands were found");
}

#[test]
fn nothing_that_is_there_is_replaced_by_a_project() {
    let desk = Desk::with(&[("lab", "a file")]);
    let answer = desk.call(&["new", "lab"]);
    assert_eq!((answer.code, desk.read("lab").as_str()), (Some(4), "a file"));
    assert!(answer.err.contains("`lab` already exists"), "{}", answer.err);
    let spaced = Desk::with(&[]).call(&["new", "my lab"]);
    assert!(spaced.out.contains("blocksim run 'my lab/servo.ron'"), "{}", spaced.out);
    std::fs::create_dir(desk.0.join("empty")).expect("a folder");
    assert_eq!(desk.call(&["new", "empty"]).code, Some(0), "an empty folder is as good as none");
    assert_eq!(desk.call(&["new", "empty"]).code, Some(4));
    assert_eq!(desk.call(&["new"]).code, Some(2));
    assert_eq!(desk.call(&["new", "lost", "--template", "plugin", "--blocksim", "nowhere"]).code, Some(2));
    assert!(!desk.0.join("lost").exists() && std::fs::read_dir(&desk.0).expect("a folder").count() == 2);
}

#[test]
fn shells_get_what_they_can_read() {
    let desk = Desk::with(&[]);
    for (shell, part) in [
        ("bash", "complete -F"),
        ("zsh", "#compdef blocksim"),
        ("fish", "complete -c blocksim"),
        ("powershell", "Register-ArgumentCompleter"),
    ] {
        let answer = desk.call(&["completions", shell]);
        assert_eq!(answer.code, Some(0), "{}", answer.text());
        for part in [part, "sweep", "output-format"] {
            assert!(answer.out.contains(part), "{shell}: {part}");
        }
    }
    assert_eq!(desk.call(&["completions", "cmd"]).code, Some(2));
}

#[test]
fn the_doctor_tells_each_thing_with_a_remedy() {
    let desk = Desk::with(&[("runs", "a file in the way")]);
    let answer = desk.call(&["doctor"]);
    assert_eq!(answer.code, Some(1), "{}", answer.text());
    assert!(
        answer.out.contains("missing  runs folder  `runs` is a file\n  = help: rename it"),
        "{}",
        answer.out
    );
    let well = Desk::with(&[]).call(&["doctor", "--json"]);
    let lines: Vec<serde_json::Value> =
        well.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let whats: Vec<&str> = lines.iter().filter_map(|line| line["what"].as_str()).collect();
    assert_eq!(
        whats,
        ["blocksim", "parts", "cargo", "C compiler", "sources", "runs folder", "disk", "browser"]
    );
    for line in &lines {
        assert_eq!(line["state"] == "ok", line["help"].is_null(), "{line}");
    }
    let alone = Desk::with(&[]);
    let output = alone.command(&["doctor"]).env("PATH", "/nowhere").env("CARGO", "/nowhere/cargo").output();
    let output = output.expect("the program runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.code() == Some(1) && text.contains("https://rustup.rs"), "{text}");
    let folder = Desk::with(&[]);
    folder.call(&["new", "lab", "--template", "plugin"]);
    let mut doctor = folder.command(&["doctor"]);
    // A library of that name may be there, if all of the tests share one folder for what they build.
    doctor.env_remove("CARGO_TARGET_DIR").current_dir(folder.0.join("lab"));
    let within = doctor.output().expect("the program runs");
    assert!(String::from_utf8_lossy(&within.stdout).contains("controller is not built yet"), "{within:?}");
    folder.call(&["plugin", "new", "law", "--language", "c"]);
    let answer = folder.call(&["doctor"]);
    assert!(answer.out.contains("note     plug-in      law is not built yet\n"), "{}", answer.out);
    folder.call(&["plugin", "show", "law"]);
    let answer = folder.call(&["doctor"]);
    assert!(answer.out.contains("ok       plug-in      law is built\n"), "{}", answer.out);
}

#[test]
fn the_program_alone_names_a_model_of_the_folder() {
    let desk = Desk::with(&[("part.ron", "Diagram(inputs: {})")]);
    assert!(desk.call(&[]).out.contains("  blocksim new lab "), "no whole model is here");
    desk.call(&["new", "lab"]);
    let output = desk.command(&[]).current_dir(desk.0.join("lab")).output().expect("the program runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("  blocksim run servo.ron ") && !text.contains("blocksim new"), "{text}");
}

#[test]
fn the_page_shows_what_the_program_does() {
    let desk = Desk::with(&[]);
    let shown = commands_of("start.md");
    assert_eq!(shown.len(), 2);
    for (line, answer) in shown {
        let words = arguments(&line);
        let told = desk.call(&words[1..].iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(told.out + &told.err, answer, "{line}");
    }
}
