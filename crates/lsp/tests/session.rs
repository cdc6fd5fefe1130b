//! An editor that opens files, types, asks.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;

// Diagrams need a library.
use blocksim_blocks as _;
use blocksim_lsp::Server;
use lsp_server::{Connection, Message, Notification, Request};
use serde_json::{Value, json};

const SERVO: &str = r#"Diagram(
    parameters: { "gain": "2" },
    blocks: {
        "demand": Step(time: "0.1 s", after: 1.0),
        "amplifier": Gain(k: "gain"),
        "part": Subsystem(file: "part.ron", with: { "tau": "0.2 s" }),
        "scope": Scope(inputs: ["set", "actual"]),
    },
    connections: [
        "demand.y -> amplifier.u, scope.set",
        "amplifier.y -> part.u",
        "part.y -> scope.actual",
    ],
)
"#;

const PART: &str = r#"Diagram(
    parameters: { "tau": "0.1 s" },
    inputs: { "u": () },
    outputs: { "y": "lag.y" },
    blocks: { "lag": LowPass(tau: "tau") },
    connections: ["in.u -> lag.u"],
)
"#;

/// An editor with a folder of its own.
struct Editor {
    folder: PathBuf,
    connection: Connection,
    server: Option<JoinHandle<()>>,
    requests: i32,
    /// Number of the last text of each file.
    versions: RefCell<BTreeMap<String, i32>>,
}

impl Editor {
    fn new(name: &str) -> Editor {
        let folder = std::env::temp_dir().join(format!("blocksim-lsp-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let folder = folder.canonicalize().unwrap();
        std::fs::write(folder.join("servo.ron"), SERVO).unwrap();
        std::fs::write(folder.join("part.ron"), PART).unwrap();
        let (connection, other) = Connection::memory();
        let server = std::thread::spawn(move || {
            Server::new(str::to_owned, Box::new(blocksim_block::NoCode)).run(&other).unwrap()
        });
        let mut editor =
            Editor { folder, connection, server: Some(server), requests: 0, versions: RefCell::default() };
        let takes = json!({
            "textDocument": {
                "completion": { "completionItem": { "snippetSupport": true } },
                "codeAction": { "resolveSupport": { "properties": ["edit"] } },
            },
            "workspace": { "workspaceEdit": { "documentChanges": true, "resourceOperations": ["create"] } },
        });
        let answer = editor.ask("initialize", json!({ "capabilities": takes }));
        assert_eq!(answer["capabilities"]["hoverProvider"], true, "{answer}");
        editor.say("initialized", json!({}));
        editor
    }

    fn uri(&self, name: &str) -> String {
        format!("file://{}", self.folder.join(name).display())
    }

    fn say(&self, method: &str, params: Value) {
        self.connection.sender.send(Notification::new(method.to_owned(), params).into()).unwrap();
    }

    /// The number of a text of a file that is about to be sent.
    fn next_version(&self, name: &str) -> i32 {
        let mut versions = self.versions.borrow_mut();
        let version = versions.entry(name.to_owned()).or_default();
        *version += 1;
        *version
    }

    fn open(&self, name: &str, text: &str) {
        let version = self.next_version(name);
        let item = json!({ "uri": self.uri(name), "languageId": "ron", "version": version, "text": text });
        self.say("textDocument/didOpen", json!({ "textDocument": item }));
    }

    /// Types `new` in the place of what stands between two places, as line and character.
    fn type_at(&self, name: &str, from: (usize, usize), to: (usize, usize), new: &str) {
        let place = |(line, character): (usize, usize)| json!({ "line": line, "character": character });
        let range = json!({ "start": place(from), "end": place(to) });
        let item = json!({ "uri": self.uri(name), "version": self.next_version(name) });
        let changes = json!([{ "range": range, "text": new }]);
        self.say("textDocument/didChange", json!({ "textDocument": item, "contentChanges": changes }));
    }

    fn change(&self, name: &str, text: &str) {
        let item = json!({ "uri": self.uri(name), "version": self.next_version(name) });
        self.say(
            "textDocument/didChange",
            json!({ "textDocument": item, "contentChanges": [{ "text": text }] }),
        );
    }

    /// The next problems of the last text of a file; those of earlier ones may still come before them.
    fn problems(&self, name: &str) -> Vec<Value> {
        loop {
            let Message::Notification(message) = self.connection.receiver.recv().unwrap() else { continue };
            let is_of_last = || {
                let last = self.versions.borrow().get(name).copied();
                message.params["version"].is_null() || message.params["version"] == json!(last)
            };
            if message.method == "textDocument/publishDiagnostics"
                && message.params["uri"] == self.uri(name)
                && is_of_last()
            {
                return message.params["diagnostics"].as_array().unwrap().clone();
            }
        }
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.requests += 1;
        let request = Request::new(self.requests.into(), method.to_owned(), params);
        self.connection.sender.send(request.into()).unwrap();
        loop {
            if let Message::Response(answer) = self.connection.receiver.recv().unwrap() {
                let answer = serde_json::to_value(answer).unwrap();
                return if answer["error"].is_null() {
                    answer["result"].clone()
                } else {
                    answer["error"].clone()
                };
            }
        }
    }

    /// The texts after what stands at the sign `|` has got another name, or why it cannot.
    fn rename(&mut self, name: &str, marked: &str, new: &str) -> Result<Vec<(String, String)>, String> {
        let before = &marked[..marked.find('|').unwrap()];
        let place = json!({ "line": before.matches('\n').count(), "character": before.lines().last().unwrap().len() });
        let file = json!({ "uri": self.uri(name) });
        let params = json!({ "textDocument": file, "position": place, "newName": new });
        let answer = self.ask("textDocument/rename", params);
        if let Some(reason) = answer["message"].as_str() {
            return Err(reason.to_owned());
        }
        let changed = answer["changes"].as_object().unwrap().iter().map(|(uri, edits)| {
            let file = uri.rsplit('/').next().unwrap();
            let mut lines: Vec<String> =
                std::fs::read_to_string(self.folder.join(file)).unwrap().lines().map(str::to_owned).collect();
            let number = |at: &Value, of: &str| at[of].as_u64().unwrap() as usize;
            for edit in edits.as_array().unwrap().iter().rev() {
                let (start, end) = (&edit["range"]["start"], &edit["range"]["end"]);
                assert_eq!(start["line"], end["line"], "{edit}");
                let at = number(start, "character")..number(end, "character");
                lines[number(start, "line")].replace_range(at, edit["newText"].as_str().unwrap());
            }
            (file.to_owned(), lines.join("\n") + "\n")
        });
        Ok(changed.collect())
    }

    /// Asks about the place of the sign `|` in a text that is open as `name`.
    fn ask_at(&mut self, method: &str, name: &str, marked: &str) -> Value {
        let before = &marked[..marked.find('|').unwrap()];
        let line = before.matches('\n').count();
        let character =
            before.lines().last().filter(|_| !before.ends_with('\n')).map_or(0, |l| l.chars().count());
        let place = json!({ "line": line, "character": character });
        self.ask(method, json!({ "textDocument": { "uri": self.uri(name) }, "position": place }))
    }

    /// What may stand at the sign `|`, after the text has been typed.
    fn complete(&mut self, name: &str, marked: &str) -> Vec<String> {
        self.change(name, &marked.replacen('|', "", 1));
        let items = self.ask_at("textDocument/completion", name, marked);
        items.as_array().unwrap().iter().map(|item| item["label"].as_str().unwrap().to_owned()).collect()
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            self.ask("shutdown", Value::Null);
            self.say("exit", Value::Null);
            self.server.take().into_iter().for_each(|server| server.join().unwrap());
        }
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

#[test]
fn problems_come_while_a_text_is_typed_and_go_when_it_is_right() {
    let editor = Editor::new("typed");
    editor.open("servo.ron", &SERVO.replace("amplifier.u", "amplifier.u, amplifier.v"));
    let problems = editor.problems("servo.ron");
    assert_eq!(problems.len(), 1, "{problems:?}");
    let problem = &problems[0];
    assert_eq!(
        (&problem["code"], &problem["severity"], &problem["source"]),
        (&json!("unknown_port"), &json!(1), &json!("blocksim"))
    );
    assert_eq!(problem["range"]["start"]["line"], 9, "{problem}");
    assert!(problem["message"].as_str().unwrap().contains("help: "), "{problem}");

    editor.change("servo.ron", "Diagram(blocks: {\n\"a\": Gain(k: ");
    assert_eq!(editor.problems("servo.ron")[0]["code"], "syntax");
    editor.change("servo.ron", SERVO);
    assert!(editor.problems("servo.ron").is_empty());
}

#[test]
fn letters_beyond_ascii_do_no_harm_in_half_written_texts() {
    let mut editor = Editor::new("letters");
    editor.open("servo.ron", SERVO);
    editor.problems("servo.ron");
    for text in
        ["Diagram(title: \"größe", "Diagram(blocks: { \"a\": Gän(k: 1", "Diagram(titlé: \"ä\", blocks: {\"ü"]
    {
        for end in text.char_indices().map(|(at, _)| at).skip(8).chain([text.len()]) {
            let marked = format!("{}|", &text[..end]);
            editor.complete("servo.ron", &marked);
            editor.ask_at("textDocument/hover", "servo.ron", &marked);
        }
    }
    editor.change("servo.ron", SERVO);
    let last = std::iter::repeat_with(|| editor.problems("servo.ron")).find(Vec::is_empty);
    assert!(last.is_some());
}

#[test]
fn a_part_is_judged_within_the_model_that_it_belongs_to() {
    let editor = Editor::new("part");
    // Alone the output would lead nowhere; in the model the input without a source shows.
    editor.open("part.ron", &PART.replace("\"u\": ()", "\"u\": (), \"v\": ()"));
    let in_model = editor.problems("servo.ron");
    assert_eq!(in_model.len(), 1, "{in_model:?}");
    assert_eq!(in_model[0]["code"], "unconnected_input", "{in_model:?}");
    editor.change("part.ron", &PART.replace("LowPass", "LowPas"));
    let problems = editor.problems("part.ron");
    assert!(problems[0]["message"].as_str().unwrap().contains("did you mean `LowPass`"), "{problems:?}");
    // On the disk the part is right, so without the text of the editor nothing is wrong.
    editor.say("textDocument/didClose", json!({ "textDocument": { "uri": editor.uri("part.ron") } }));
    assert!(editor.problems("part.ron").is_empty());
}

#[test]
fn what_may_follow_is_known_also_in_half_written_texts() {
    let mut editor = Editor::new("complete");
    editor.open("servo.ron", SERVO);
    editor.problems("servo.ron");
    let typed = |from: &str, to: &str| SERVO.replacen(from, to, 1);
    let kinds = editor.complete("servo.ron", &typed("Gain(k: \"gain\"),", "Ga|"));
    assert!(kinds.contains(&"Gain".to_owned()) && kinds.contains(&"Variant".to_owned()) && kinds.len() > 100);
    assert_eq!(editor.complete("servo.ron", &typed("Gain(k: \"gain\")", "LowPass(tau: 1, |")), ["y0"]);
    assert_eq!(editor.complete("servo.ron", &typed("k: \"gain\"", "k: \"2*|\"")), ["gain"]);
    // Ports of blocks and subsystems as they were when the text was whole, before an arrow those that drive first.
    assert_eq!(editor.complete("servo.ron", &typed("part.y ->", "part.|")), ["y", "u"]);
    let blocks = editor.complete("servo.ron", &typed("part.y ->", "par|"));
    assert_eq!(blocks, ["demand", "amplifier", "part", "scope"]);
    assert_eq!(editor.complete("servo.ron", &typed("part.ron", "|")), ["part.ron", "servo.ron"]);
    let sections = editor.complete("servo.ron", &typed("    connections", "    |connections"));
    assert!(
        sections.contains(&"simulation".to_owned()) && !sections.contains(&"blocks".to_owned()),
        "{sections:?}"
    );

    editor.change("servo.ron", &typed("Gain(k: \"gain\"),", "Ga"));
    let items = editor.ask_at("textDocument/completion", "servo.ron", &typed("Gain(k: \"gain\"),", "Ga|"));
    let transfer = items.as_array().unwrap().iter().find(|item| item["label"] == "TransferFunction").unwrap();
    assert_eq!(
        (&transfer["insertText"], &transfer["insertTextFormat"]),
        (&json!("TransferFunction(den: ${1})"), &json!(2))
    );
}

#[test]
fn words_and_members_of_named_sets_are_completed_where_they_may_stand() {
    let mut editor = Editor::new("words");
    editor.open("servo.ron", SERVO);
    editor.problems("servo.ron");
    let block = |text: &str| SERVO.replacen("Gain(k: \"gain\")", text, 1);
    assert_eq!(
        editor.complete("servo.ron", &block("Pid(kp: 1, anti_windup: |)")),
        ["None", "Clamping", "BackCalculation"]
    );
    assert_eq!(editor.complete("servo.ron", &block("Integrator(wrap: |)")), Vec::<String>::new());
    let settings =
        |text: &str| SERVO.replacen("    blocks", &format!("    simulation: ({text}),\n    blocks"), 1);
    let solvers = editor.complete("servo.ron", &settings("solver: |"));
    assert!(solvers.contains(&"Ode15s".to_owned()) && solvers.contains(&"Auto".to_owned()), "{solvers:?}");
    assert_eq!(editor.complete("servo.ron", &settings("solver: Ode45(rtol: 1e-6, |)")), ["atol", "max_step"]);
    assert_eq!(editor.complete("servo.ron", &settings("output: |")), ["Steps", "Every"]);
    // The alternatives of a variant are those of the choice that it is chosen by.
    let choice = SERVO.replacen(
        "\"gain\": \"2\"",
        "\"gain\": \"2\", \"kind\": Choice(default: \"a\", of: [\"a\", \"b\"])",
        1,
    );
    let variant =
        choice.replacen("Gain(k: \"gain\")", "Variant(choice: \"kind\", of: { \"a\": Gain(k: 1) })", 1);
    editor.change("servo.ron", &variant);
    editor.problems("servo.ron");
    let half = variant.replacen("Gain(k: 1) }", "Gain(k: 1), \"|\" }", 1);
    assert_eq!(editor.complete("servo.ron", &half), ["b"]);
}

#[test]
fn a_block_is_shown_with_its_parameters_and_ports() {
    let mut editor = Editor::new("block");
    editor.open("servo.ron", SERVO);
    editor.problems("servo.ron");
    let typed = |from: &str, to: &str| SERVO.replacen(from, to, 1);
    let mut hover = |marked: &str| {
        let answer = editor.ask_at("textDocument/hover", "servo.ron", marked);
        answer["contents"]["value"].as_str().unwrap_or_default().to_owned()
    };
    let message = hover(&typed("\"amplifier\"", "\"ampl|ifier\""));
    assert!(message.starts_with("**amplifier**: Gain (Math)\n\n"), "{message}");
    assert!(message.contains("| `k` | `\"gain\"` | 2 |") && message.contains("| `u` | input |"), "{message}");
    let message = hover(&typed("\"demand\"", "\"|demand\""));
    assert!(message.contains("| `time` | `\"0.1 s\"` | 0.1 s |"), "{message}");
    assert_eq!(
        message,
        hover(&typed("\"demand.y", "\"dem|and.y")),
        "where it is named and where it is declared"
    );
    let message = hover(&typed("part.y", "pa|rt.y"));
    assert!(message.starts_with("**part**: Subsystem") && message.contains("| `y` | output |"), "{message}");
    assert!(hover(&typed("\"part.ron\"", "\"pa|rt.ron\"")).is_empty());
}

/// A part whose parameter is one of the diagram around it.
const LOOSE: &str = r#"// The gain of the servo.
Diagram(
    inputs: { "u": () },
    outputs: { "y": "k.y" },
    blocks: { "k": Gain(k: "gain") }, // as given
    connections: ["in.u -> k.u"],
)
"#;

/// The servo with that part instead of a gain.
fn with_loose() -> String {
    SERVO.replacen("Gain(k: \"gain\")", "Subsystem(file: \"loose.ron\")", 1)
}

#[test]
fn names_are_changed_in_all_files_and_comments_stay() {
    let mut editor = Editor::new("rename");
    let servo = with_loose();
    std::fs::write(editor.folder.join("loose.ron"), LOOSE).unwrap();
    std::fs::write(editor.folder.join("servo.ron"), &servo).unwrap();
    // Another model that uses the part, and is not open.
    let other = servo.replace("\"part\"", "\"rest\"").replace("part.u", "rest.u").replace("part.y", "rest.y");
    std::fs::write(editor.folder.join("other.ron"), &other).unwrap();
    editor.open("servo.ron", &servo);
    assert!(editor.problems("servo.ron").is_empty());
    editor.open("loose.ron", LOOSE);
    editor.problems("loose.ron");

    // A block: its declaration and its connections, in one file.
    let changed =
        editor.rename("servo.ron", &servo.replacen("\"amplifier\"", "\"am|plifier\"", 1), "booster").unwrap();
    assert_eq!(changed, [("servo.ron".to_owned(), servo.replace("amplifier", "booster"))]);
    // A parameter, asked for in the part: both models declare it, the part names it.
    let marked = LOOSE.replacen("k: \"gain\"", "k: \"ga|in\"", 1);
    let mut changed = editor.rename("loose.ron", &marked, "factor").unwrap();
    changed.sort();
    let new = |text: &str| text.replace("\"gain\"", "\"factor\"");
    let expected = [("loose.ron", new(LOOSE)), ("other.ron", new(&other)), ("servo.ron", new(&servo))];
    assert_eq!(changed, expected.map(|(file, text)| (file.to_owned(), text)));
    // A port of the part, asked for where it is connected.
    let mut changed =
        editor.rename("servo.ron", &servo.replacen("amplifier.u", "amplifier.|u", 1), "input").unwrap();
    changed.sort();
    let connected = |text: &str| text.replace("amplifier.u", "amplifier.input");
    let part = LOOSE.replace("{ \"u\": () }", "{ \"input\": () }").replace("in.u ", "in.input ");
    let expected = [("loose.ron", part), ("other.ron", connected(&other)), ("servo.ron", connected(&servo))];
    assert_eq!(changed, expected.map(|(file, text)| (file.to_owned(), text)));
}

#[test]
fn a_name_that_would_do_harm_is_refused_with_a_reason() {
    let mut editor = Editor::new("refused");
    let servo = with_loose().replacen("\"gain\": \"2\"", "\"gain\": \"2\", \"twice\": \"2 * gain\"", 1);
    std::fs::write(editor.folder.join("loose.ron"), LOOSE).unwrap();
    std::fs::write(editor.folder.join("servo.ron"), &servo).unwrap();
    editor.open("servo.ron", &servo);
    editor.problems("servo.ron");
    let block = servo.replacen("\"amplifier\"", "\"am|plifier\"", 1);
    let gain = servo.replacen("\"gain\"", "\"ga|in\"", 1);
    for (marked, new, reason) in [
        (&block, "2nd", "`2nd` is not a valid name: names start with a letter"),
        (&block, "in", "`in` is not a valid name"),
        (&block, "demand", "`demand` is taken: it is a block at servo.ron:4"),
        (&gain, "twice", "`twice` is taken: it is a parameter at servo.ron:2"),
        // `pi` is a constant of expressions.
        (&gain, "pi", "`pi` would change what names mean"),
        (&servo.replacen("Step(", "St|ep(", 1), "ramp", "there is no such name here"),
        (&servo.replacen("scope.set", "scope.|set", 1), "demand", "there is no such name here"),
    ] {
        let answer = editor.rename("servo.ron", marked, new).unwrap_err();
        assert!(answer.starts_with(reason), "{new}: {answer}");
    }
    // The part has a parameter of that name of its own now, which would be meant instead.
    let part = PART.replacen("\"tau\": \"0.1 s\"", "\"tau\": \"0.1 s\", \"own\": 3", 1).replacen(
        "LowPass(tau: \"tau\")",
        "LowPass(tau: \"tau * own / gain\")",
        1,
    );
    std::fs::write(editor.folder.join("part.ron"), &part).unwrap();
    editor.open("part.ron", &part);
    editor.problems("part.ron");
    let answer = editor.rename("servo.ron", &gain, "own").unwrap_err();
    assert_eq!(
        answer,
        "`own` would change what names mean: `own` at part.ron:5 would stand for something else"
    );
    // Errors may hide names.
    editor.change("part.ron", &part.replace("LowPass(", "LowPas("));
    editor.problems("part.ron");
    let answer = editor.rename("servo.ron", &gain, "factor").unwrap_err();
    assert!(
        answer.starts_with("first correct the errors of servo.ron, which may hide names: part.ron:5: "),
        "{answer}"
    );
}

#[test]
fn references_and_declarations_are_found_across_files() {
    let mut editor = Editor::new("references");
    let servo = with_loose();
    std::fs::write(editor.folder.join("loose.ron"), LOOSE).unwrap();
    std::fs::write(editor.folder.join("servo.ron"), &servo).unwrap();
    editor.open("servo.ron", &servo);
    editor.open("loose.ron", LOOSE);
    editor.problems("loose.ron");
    let places = |answer: &Value| -> Vec<(String, u64)> {
        let one = |place: &Value| {
            let uri = place["uri"].as_str().unwrap().rsplit('/').next().unwrap().to_owned();
            (uri, place["range"]["start"]["line"].as_u64().unwrap())
        };
        answer.as_array().unwrap().iter().map(one).collect()
    };
    let marked = LOOSE.replacen("k: \"gain\"", "k: \"ga|in\"", 1);
    let found = editor.ask_at("textDocument/definition", "loose.ron", &marked);
    assert_eq!(places(&found), [("servo.ron".to_owned(), 1)], "{found}");
    let message = editor.ask_at("textDocument/hover", "loose.ron", &marked);
    assert!(
        message["contents"]["value"].as_str().unwrap().contains("parameters: { \"gain\": \"2\" }"),
        "{message}"
    );
    let port = servo.replacen("amplifier.u", "amplifier.|u", 1);
    let found = editor.ask_at("textDocument/definition", "servo.ron", &port);
    assert_eq!(places(&found), [("loose.ron".to_owned(), 2)], "{found}");
    let before = &port[..port.find('|').unwrap()];
    let place =
        json!({ "line": before.matches('\n').count(), "character": before.lines().last().unwrap().len() });
    for (with, lines) in [
        (true, vec![("loose.ron", 2), ("loose.ron", 5), ("servo.ron", 9)]),
        (false, vec![("loose.ron", 5), ("servo.ron", 9)]),
    ] {
        let context = json!({ "includeDeclaration": with });
        let file = json!({ "uri": editor.uri("servo.ron") });
        let found = editor.ask(
            "textDocument/references",
            json!({ "textDocument": file, "position": place, "context": context }),
        );
        let lines: Vec<_> = lines.into_iter().map(|(file, line)| (file.to_owned(), line)).collect();
        assert_eq!(places(&found), lines, "{found}");
    }
}

#[test]
fn single_keys_are_taken_over_where_they_were_pressed() {
    let editor = Editor::new("incremental");
    editor.open("servo.ron", SERVO);
    assert!(editor.problems("servo.ron").is_empty());
    let line = SERVO.lines().position(|line| line.contains("amplifier.u")).unwrap();
    let at = SERVO.lines().nth(line).unwrap().find("amplifier.u").unwrap() + "amplifier.u".len();
    editor.type_at("servo.ron", (line, at - 1), (line, at), "v");
    assert_eq!(editor.problems("servo.ron")[0]["code"], "unknown_port");
    editor.type_at("servo.ron", (line, at - 1), (line, at), "u");
    assert!(editor.problems("servo.ron").is_empty());
}

#[test]
fn what_stands_under_the_cursor_is_told_and_found() {
    let mut editor = Editor::new("hover");
    editor.open("servo.ron", SERVO);
    editor.problems("servo.ron");
    let typed = |from: &str, to: &str| SERVO.replacen(from, to, 1);
    let hover = |editor: &mut Editor, marked: &str| {
        editor.ask_at("textDocument/hover", "servo.ron", marked)["contents"]["value"]
            .as_str()
            .unwrap_or_default()
            .to_owned()
    };
    assert!(hover(&mut editor, &typed("Gain(", "Ga|in(")).starts_with("**Gain** (Math)"));
    let message = hover(&mut editor, &typed("k: \"gain\"", "|k: \"gain\""));
    assert!(message.starts_with("`Gain.k` ("), "{message}");
    assert!(
        hover(&mut editor, &typed("amplifier.u,", "amplifier.u|,"))
            .contains("`amplifier`: Gain\n\n`u` (input)")
    );
    assert!(hover(&mut editor, &typed("\"gain\")", "\"ga|in\")")).contains("\"gain\": \"2\""));
    assert_eq!(hover(&mut editor, &typed("Diagram(", "Dia|gram(")), "");

    let mut goes = |marked: String| {
        let target = editor.ask_at("textDocument/definition", "servo.ron", &marked);
        let file = target["uri"]
            .as_str()
            .map(|uri| Path::new(uri).file_name().unwrap().to_str().unwrap().to_owned());
        (file.unwrap_or_default(), target["range"]["start"]["line"].as_u64().unwrap_or(99))
    };
    assert_eq!(goes(typed("-> amplifier.u", "-> ampl|ifier.u")), ("servo.ron".to_owned(), 4));
    assert_eq!(goes(typed("k: \"gain\"", "k: \"ga|in\"")), ("servo.ron".to_owned(), 1));
    assert_eq!(goes(typed("\"part.ron\"", "\"pa|rt.ron\"")), ("part.ron".to_owned(), 0));
    assert_eq!(goes(typed("Gain(", "Ga|in(")), (String::new(), 99));

    let names = editor
        .ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": editor.uri("servo.ron") } }));
    let names: Vec<&str> =
        names.as_array().unwrap().iter().map(|symbol| symbol["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["gain", "demand", "amplifier", "part", "scope"]);
}

#[test]
fn a_text_is_laid_out_and_mended_on_request() {
    let mut editor = Editor::new("mended");
    let loose = SERVO.replace("Gain(k: \"gain\")", "Gian(k:\"gain\")");
    editor.open("servo.ron", &loose);
    assert_eq!(editor.problems("servo.ron")[0]["code"], "unknown_block");
    let file = json!({ "uri": editor.uri("servo.ron") });
    let options = json!({ "tabSize": 4, "insertSpaces": true });
    let edits = editor.ask("textDocument/formatting", json!({ "textDocument": file, "options": options }));
    assert_eq!(edits.as_array().unwrap().len(), 1, "{edits}");
    assert_eq!(edits[0]["newText"], "        \"amplifier\": Gian(k: \"gain\"),\n");
    let at = |line: u32| json!({ "start": { "line": line, "character": 24 }, "end": { "line": line, "character": 24 } });
    let context = json!({ "diagnostics": [] });
    let params = |line| json!({ "textDocument": file, "range": at(line), "context": context });
    let actions = editor.ask("textDocument/codeAction", params(4));
    assert_eq!((&actions[0]["title"], &actions[0]["kind"]), (&json!("Write `Gain`"), &json!("quickfix")));
    let edit = &actions[0]["edit"]["changes"][editor.uri("servo.ron")][0];
    assert_eq!((&edit["newText"], &edit["range"]["start"]["line"]), (&json!("Gain"), &json!(4)), "{actions}");
    let others = editor.ask("textDocument/codeAction", params(5));
    assert!(others.as_array().unwrap().iter().all(|action| action["kind"] != "quickfix"), "{others}");
}

#[test]
fn no_key_that_is_pressed_ends_the_server() {
    let mut editor = Editor::new("keys");
    editor.open("servo.ron", SERVO);
    editor.problems("servo.ron");
    for at in (0..SERVO.len()).step_by(7) {
        let mut marked = SERVO[..at].to_owned();
        marked.push('|');
        editor.complete("servo.ron", &marked);
        editor.ask_at("textDocument/hover", "servo.ron", &marked);
        editor.ask_at("textDocument/definition", "servo.ron", &marked);
    }
    editor.say("textDocument/didChange", json!({ "nonsense": 1 }));
    editor.change("servo.ron", SERVO);
    let last = std::iter::repeat_with(|| editor.problems("servo.ron")).find(Vec::is_empty);
    assert!(last.is_some());
}

#[test]
fn blocks_are_deleted_and_grouped_by_actions_that_are_worked_out_when_they_are_chosen() {
    let mut editor = Editor::new("refactor");
    editor.open("servo.ron", SERVO);
    let actions = |editor: &mut Editor, from: u32, to: u32| {
        let place = |line: u32| json!({ "line": line, "character": 0 });
        let params = json!({
            "textDocument": { "uri": editor.uri("servo.ron") },
            "range": { "start": place(from), "end": place(to) },
            "context": { "diagnostics": [] },
        });
        editor.ask("textDocument/codeAction", params)
    };
    assert_eq!(actions(&mut editor, 0, 1), json!([]), "no block is declared there");
    let one = actions(&mut editor, 4, 4);
    assert_eq!(one[0]["title"], "Delete `amplifier` with its wires");
    assert_eq!((one[0]["edit"].clone(), one[1].clone()), (json!(null), json!(null)));
    let chosen = editor.ask("codeAction/resolve", one[0].clone());
    let edits = &chosen["edit"]["documentChanges"][0]["edits"][0];
    assert_eq!(edits["range"]["start"], json!({ "line": 4, "character": 0 }));
    let new = edits["newText"].as_str().expect("a text");
    assert!(new.contains("\"demand.y -> scope.set\"") && !new.contains("amplifier"), "{new}");
    let two = actions(&mut editor, 3, 4);
    assert_eq!(two[1]["title"], "Group 2 blocks in a subsystem");
    let chosen = editor.ask("codeAction/resolve", two[1].clone());
    let all = chosen["edit"]["documentChanges"].as_array().expect("changes").clone();
    let made = all.iter().find(|change| change["kind"] == "create").expect("a file");
    assert!(made["uri"].as_str().expect("a name").ends_with("/subsystem.ron"), "{made}");
    let texts: Vec<&str> = all.iter().filter_map(|change| change["edits"][0]["newText"].as_str()).collect();
    assert!(texts.iter().any(|text| text.contains("Subsystem(file: \"subsystem.ron\")")), "{texts:?}");
    assert!(texts.iter().any(|text| text.contains("outputs: {")), "{texts:?}");
}
