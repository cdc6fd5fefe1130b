//! Looking is not running: models and runs of strangers with plug-ins that leave a mark wherever they are built or loaded.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::{Value, json};

use crate::support::{program, root};

/// A model that names the library of a stranger.
const WITH_LIBRARY: &str = r#"Diagram(
    title: "Loop of a stranger",
    simulation: (stop_time: "1 s"),
    blocks: {
        "demand": Step(time: "0.1 s", after: 1.0),
        "gain": Plugin(library: "libgain.so", block: "Gain", parameters: { "k": 2.0 }),
        "seen": Scope(inputs: ["set", "y"]),
    },
    connections: ["demand.y -> gain.u, seen.set", "gain.y -> seen.y"],
)
"#;

/// One that names the crate of a stranger, whose build script runs when it is built.
const WITH_CRATE: &str = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "demand": Constant(value: 1.0),
        "law": Plugin(library: "crate", block: "Law"),
        "end": Terminator,
    },
    connections: ["demand.y -> law.u", "law.y -> end.u"],
)
"#;

/// Files of a stranger, and settings of somebody who trusts nobody yet. Both are removed at the end.
struct Stranger {
    files: PathBuf,
    home: PathBuf,
}

impl Drop for Stranger {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.files);
        let _ = fs::remove_dir_all(&self.home);
    }
}

impl Stranger {
    fn new(name: &str) -> Stranger {
        let base = std::env::temp_dir().join(format!("blocksim-stranger-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&base);
        let stranger = Stranger { files: base.join("files"), home: base.join("home") };
        fs::create_dir_all(stranger.files.join("crate/src")).unwrap();
        let write = |name: &str, text: &str| fs::write(stranger.files.join(name), text).unwrap();
        write("library.ron", WITH_LIBRARY);
        write("crate.ron", WITH_CRATE);
        let mark = format!("{:?}", stranger.mark());
        write(
            "crate/Cargo.toml",
            "[package]\nname = \"law\"\nedition = \"2024\"\n[lib]\ncrate-type = [\"cdylib\"]\n[workspace]\n",
        );
        write("crate/build.rs", &format!("fn main() {{ std::fs::write({mark}, \"built\").unwrap(); }}\n"));
        write("crate/src/lib.rs", "");
        // The constructor runs as soon as the library is loaded.
        write(
            "mark.c",
            &format!(
                "#include <stdio.h>\n__attribute__((constructor)) static void mark(void)\n\
                 {{ FILE *file = fopen({mark}, \"w\"); if (file) fclose(file); }}\n"
            ),
        );
        let mut cc = Command::new("cc");
        cc.args(["-std=c99", "-shared", "-fPIC", "-I"]).arg(root().join("crates/abi/include"));
        cc.arg("-o").arg(stranger.files.join("libgain.so")).arg(root().join("crates/abi/tests/c_gain.c"));
        assert!(cc.arg(stranger.files.join("mark.c")).status().unwrap().success());
        stranger
    }

    fn mark(&self) -> PathBuf {
        self.files.join("MARK")
    }

    /// Whether code of the stranger has run since this was asked last.
    fn has_run(&self) -> bool {
        fs::remove_file(self.mark()).is_ok()
    }

    fn command(&self, words: &[&str]) -> Command {
        let mut command = program();
        command.args(words).current_dir(&self.files).env("BLOCKSIM_HOME", &self.home);
        command.env("NO_COLOR", "1").env("CARGO_NET_OFFLINE", "true");
        command
    }

    fn call(&self, words: &[&str]) -> Output {
        self.command(words).output().unwrap()
    }

    /// What a command says, after it has ended with this code.
    fn says(&self, words: &[&str], code: i32) -> String {
        let output = self.call(words);
        assert_eq!(output.status.code(), Some(code), "{words:?}: {}", both(&output));
        both(&output)
    }

    /// What an editor hears about a file that it opens.
    fn editor(&self, file: &str) -> String {
        let mut server = self.command(&["lsp"]);
        let mut server = server.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let path = self.files.join(file);
        let text = fs::read_to_string(&path).unwrap();
        let uri = format!("file://{}", path.display());
        let document = json!({ "uri": uri, "languageId": "ron", "version": 1, "text": text });
        let (mut input, mut output) =
            (server.stdin.take().unwrap(), BufReader::new(server.stdout.take().unwrap()));
        let mut say = |message: Value| {
            let mut message = message;
            message["jsonrpc"] = json!("2.0");
            let message = message.to_string();
            write!(input, "Content-Length: {}\r\n\r\n{message}", message.len()).unwrap();
            input.flush().unwrap();
        };
        say(json!({ "id": 1, "method": "initialize", "params": { "capabilities": {} } }));
        heard(&mut output);
        say(json!({ "method": "initialized", "params": {} }));
        say(json!({ "method": "textDocument/didOpen", "params": { "textDocument": document } }));
        let diagnostics = heard(&mut output);
        assert!(diagnostics.contains("publishDiagnostics"), "{diagnostics}");
        say(json!({ "id": 2, "method": "shutdown" }));
        heard(&mut output);
        say(json!({ "method": "exit" }));
        assert!(server.wait().unwrap().success());
        diagnostics
    }
}

/// The next message of a server.
fn heard(output: &mut impl BufRead) -> String {
    let mut length = 0;
    loop {
        let mut line = String::new();
        output.read_line(&mut line).unwrap();
        match line.trim().split_once(": ") {
            Some(("Content-Length", number)) => length = number.parse().unwrap(),
            Some(_) => {}
            None => break,
        }
    }
    let mut message = vec![0; length];
    output.read_exact(&mut message).unwrap();
    String::from_utf8(message).unwrap()
}

fn both(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

#[test]
fn commands_that_look_at_a_model_run_none_of_its_code() {
    let stranger = Stranger::new("look");
    for model in ["library.ron", "crate.ron"] {
        let mut commands: Vec<Vec<&str>> = vec![
            vec!["check", model],
            vec!["check", model, "--fix"],
            vec!["check", model, "--output-format", "json"],
            vec!["graph", model],
            vec!["graph", model, "--all", "--json"],
            vec!["fmt", model],
            vec!["params", "list", model],
            vec!["params", "list", model, "--all", "--json"],
            vec!["params", "get", model, "demand"],
            vec!["plugin", "show", if model == "crate.ron" { "crate" } else { "libgain.so" }],
            vec!["run", model, "--no-plugins"],
            vec!["check", model, "--no-plugins"],
            vec!["linearise", model, "--no-plugins"],
        ];
        commands.extend(
            ["ast", "model", "flat", "types", "schedule", "scene"].map(|stage| vec!["emit", stage, model]),
        );
        for words in commands {
            let said = both(&stranger.call(&words));
            assert!(!stranger.has_run(), "{words:?} has run the code of a stranger: {said}");
        }
        let heard = stranger.editor(model);
        assert!(heard.contains("plugin_untrusted") && heard.contains("blocksim trust"), "{heard}");
        assert!(!stranger.has_run(), "an editor has run the code of a stranger");
    }
    assert!(!stranger.home.exists(), "looking trusts nobody and remembers nothing");
}

#[test]
fn a_plug_in_that_is_not_trusted_is_an_error_that_names_the_remedy() {
    let stranger = Stranger::new("remedy");
    let said = stranger.says(&["check", "library.ron"], 3);
    for part in [
        "error[plugin_untrusted]: the plug-in `libgain.so` is not trusted, so it was not built or loaded",
        "library.ron:6:33",
        "`blocksim trust libgain.so` lets it be built and loaded",
        "library.ron: 1 error\n",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    // The block is drawn, and values are read and written, all the same.
    assert!(stranger.says(&["graph", "library.ron"], 3).contains("gain"));
    assert!(stranger.says(&["params", "get", "library.ron", "demand.after"], 0).contains('1'));
    stranger.says(&["params", "set", "library.ron", "demand.after", "2.0"], 0);
    assert!(fs::read_to_string(stranger.files.join("library.ron")).unwrap().contains("after: 2.0"));
    let refused = stranger.says(&["run", "library.ron", "--no-plugins"], 3);
    assert!(refused.contains("because of `--no-plugins`"), "{refused}");
    assert!(!stranger.has_run());
}

/// One cause is one error, however many blocks there are of a plug-in.
#[test]
fn a_plug_in_of_many_blocks_is_refused_once() {
    let stranger = Stranger::new("once");
    let block =
        |name: &str, library: &str| format!("\"{name}\": Plugin(library: \"{library}\", block: \"Gain\"),");
    let blocks = ["a", "b", "c"].map(|name| block(name, "libgain.so")).concat();
    let text = format!("Diagram(blocks: {{ {blocks} {} }}, connections: [])", block("d", "crate"));
    fs::write(stranger.files.join("many.ron"), text).unwrap();
    let said = stranger.says(&["check", "many.ron"], 3);
    assert_eq!(said.matches("error[plugin_untrusted]").count(), 2, "{said}");
    assert!(said.contains("the plug-in `libgain.so`") && said.contains("the plug-in `crate`"), "{said}");
    assert!(!stranger.has_run());
}

#[test]
fn who_runs_a_model_trusts_its_plug_ins_until_they_are_removed() {
    let stranger = Stranger::new("trust");
    let first = stranger.says(&["run", "library.ron", "--out", "first"], 0);
    assert!(stranger.has_run());
    assert!(first.contains("trusting `libgain.so` from now on"), "{first}");
    let second = stranger.says(&["run", "library.ron", "--out", "second"], 0);
    assert!(stranger.has_run() && !second.contains("trusting"), "{second}");
    // From now on looking loads it, in editors too.
    stranger.says(&["check", "library.ron"], 0);
    assert!(stranger.has_run());
    assert!(stranger.editor("library.ron").contains("\"diagnostics\":[]"));
    assert!(stranger.has_run());
    // What is beside it is not trusted with it.
    stranger.says(&["check", "crate.ron"], 3);
    assert!(!stranger.has_run());

    let library = stranger.files.join("libgain.so").canonicalize().unwrap();
    let listed = stranger.says(&["trust", "--json"], 0);
    let listed: Value = serde_json::from_str(&listed).unwrap();
    assert_eq!(listed["path"].as_str(), library.to_str());
    stranger.says(&["trust", "--remove", "libgain.so"], 0);
    assert!(stranger.says(&["trust"], 0).contains("nothing is trusted"));
    stranger.says(&["trust", "--remove", "libgain.so"], 2);

    // It is remembered: the model can be looked at without its code.
    let remembered = stranger.says(&["check", "library.ron"], 0);
    assert!(remembered.contains(
        "warning[plugin_untrusted]: the plug-in `libgain.so` is not trusted: it is shown as it was"
    ));
    assert!(remembered.contains("library.ron: 1 warning; 3 blocks"), "{remembered}");
    assert!(stranger.says(&["graph", "library.ron"], 0).contains("gain"));
    assert!(stranger.says(&["plugin", "show", "libgain.so"], 0).contains("block: \"Gain\""));
    // With other parameters only the plug-in itself knows its sample time.
    let other = stranger.says(&["check", "library.ron", "--set", "gain.parameters={\"k\": 3.0}"], 3);
    assert!(other.contains("its sample time with these parameters is not known"), "{other}");
    let none = stranger.says(&["check", "library.ron", "--no-plugins"], 0);
    assert!(!none.contains("warning"), "{none}");
    assert!(!stranger.has_run());
    stranger.says(&["run", "library.ron", "--no-plugins"], 3);
    assert!(!stranger.has_run(), "what is remembered cannot be run");
}

#[test]
fn folders_are_trusted_with_what_is_below_them_and_links_do_not_lead_out() {
    let stranger = Stranger::new("folders");
    assert_eq!(stranger.says(&["trust", "nosuch"], 4).matches("error[unreadable]").count(), 1);
    // A folder whose name only begins like that of the other.
    fs::create_dir_all(stranger.files.join("crat")).unwrap();
    stranger.says(&["trust", "crat"], 0);
    // A link from a trusted folder to a library elsewhere.
    std::os::unix::fs::symlink(stranger.files.join("libgain.so"), stranger.files.join("crat/libgain.so"))
        .unwrap();
    fs::create_dir_all(stranger.files.join("models")).unwrap();
    let linked = WITH_LIBRARY.replace("\"libgain.so\"", "\"../crat/libgain.so\"");
    fs::write(stranger.files.join("models/linked.ron"), linked).unwrap();
    stranger.says(&["check", "crate.ron"], 3);
    stranger.says(&["check", "models/linked.ron"], 3);
    assert!(!stranger.has_run());
    // Diagrams of a trusted folder may name what is elsewhere.
    stranger.says(&["trust", "models"], 0);
    stranger.says(&["check", "models/linked.ron"], 0);
    assert!(stranger.has_run());
    stranger.says(&["check", "library.ron"], 0);
    assert!(!stranger.has_run(), "it was remembered, not loaded");
    stranger.says(&["trust", "."], 0);
    stranger.says(&["check", "library.ron"], 0);
    assert!(stranger.has_run());
    let below = stranger.says(&["trust", "--remove", "models"], 0);
    assert!(below.contains("which is trusted"), "{below}");
}

#[test]
fn one_call_may_trust_what_it_looks_at() {
    let stranger = Stranger::new("flag");
    stranger.says(&["check", "library.ron", "--trust"], 0);
    assert!(stranger.has_run());
    stranger.says(&["check", "library.ron"], 0);
    assert!(stranger.has_run(), "trust stays");
    stranger.says(&["check", "library.ron", "--trust", "--no-plugins"], 2);
    assert!(!stranger.has_run());
}

#[test]
fn a_damaged_list_trusts_nobody() {
    let stranger = Stranger::new("damaged");
    stranger.says(&["trust", "."], 0);
    fs::write(stranger.home.join("trusted.json"), "{\"trusted\": [").unwrap();
    let said = stranger.says(&["check", "library.ron"], 3);
    assert!(said.contains("the list of what is trusted is damaged"), "{said}");
    assert!(!stranger.has_run());
    stranger.says(&["trust", "."], 4);
    // To run a model does not need the list.
    let ran = stranger.says(&["run", "library.ron"], 0);
    assert!(ran.contains("is not noted as trusted"), "{ran}");
}

#[test]
fn the_run_of_a_stranger_is_data() {
    let stranger = Stranger::new("run");
    stranger.says(&["run", "library.ron", "--out", "given"], 0);
    assert!(stranger.has_run());
    // Somebody else gets the folder, on a computer where the library lies in the same place.
    let reader = stranger.home.with_file_name("reader");
    let call = |words: &[&str]| {
        let output = stranger.command(words).env("BLOCKSIM_HOME", &reader).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{words:?}: {}", both(&output));
        assert!(!stranger.has_run(), "{words:?} has run the code of a stranger");
        both(&output)
    };
    call(&["report", "given", "--out", "page.html"]);
    let page = fs::read_to_string(stranger.files.join("page.html")).unwrap();
    assert!(!page.contains("is not trusted") && !page.contains("The diagram is missing"));
    call(&["plot", "given", "--svg", "given.svg"]);
    call(&["compare", "given", "given"]);
    call(&["export", "given", "--csv", "given.csv"]);
    call(&["runs"]);
    // Without what the run has kept of the plug-in the rest is shown, and still nothing is run, even if all of it is trusted.
    let kept = stranger.files.join("given/model.json");
    let mut model: Value = serde_json::from_str(&fs::read_to_string(&kept).unwrap()).unwrap();
    assert_eq!(model["plugins"][0]["library"], "libgain.so");
    model["plugins"] = json!([]);
    fs::write(&kept, model.to_string()).unwrap();
    call(&["trust", "."]);
    call(&["report", "given", "--out", "again.html"]);
    assert!(Path::new(&stranger.files.join("again.html")).is_file());
    // Nor if the run has kept no texts at all.
    fs::remove_file(&kept).unwrap();
    call(&["report", "given", "--out", "third.html"]);
}

#[test]
fn a_new_plug_in_is_its_makers_own() {
    let stranger = Stranger::new("own");
    let made = stranger.says(&["plugin", "new", "mine"], 0);
    assert!(made.contains("trusting `mine` from now on"), "{made}");
    assert!(stranger.says(&["trust"], 0).trim_end().ends_with("/files/mine"));
}

#[test]
fn programs_that_trust_at_the_same_time_lose_nothing() {
    let stranger = Stranger::new("together");
    let names: Vec<String> = (0..8).map(|n| format!("part{n}")).collect();
    names.iter().for_each(|name| fs::create_dir(stranger.files.join(name)).unwrap());
    let running: Vec<_> =
        names.iter().map(|name| stranger.command(&["trust", name]).spawn().unwrap()).collect();
    running.into_iter().for_each(|mut child| assert!(child.wait().unwrap().success()));
    let listed = stranger.says(&["trust"], 0);
    assert_eq!(listed.lines().count(), names.len(), "{listed}");
}
