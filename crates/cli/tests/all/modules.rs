//! Controllers as WebAssembly, as users and strangers name them.

use std::fs;

use serde_json::Value;

use crate::desk::Desk;

/// A gain with a fixed factor, in the text format: y = 2 u, sampled each 0.1 s. `LAW` is the body of `outputs`.
const MODULE: &str = r#"(module
    (memory (export "memory") 1)
    (table (export "__indirect_function_table") 3 funcref)
    (elem (i32.const 1) $sample_time $outputs)
    (func (export "blocksim_plugin_v1") (result i32) i32.const 1024)
    (func $sample_time (param i32 i32 i32) (result i32) local.get 1 f64.const 0.1 f64.store i32.const 0)
    (func $outputs (param i32 f64 i32 i32 i32 i32 i32) (result i32) LAW)
    (data (i32.const 1024) (i32 44) (i16 1 0) "BLKSIMP1" (i32 1400 5 0 0 1072 1 0))
    (data (i32.const 1072) (i32 84 0 1 1 0 0 1408 4 1416 11 0 1208 1256 0 0 0 1 0 2 0 0))
    (data (i32.const 1208) (i32 48 1 1432 1 0 0 0 0 0 0 0 0))
    (data (i32.const 1256) (i32 48 1 1433 1 0 0 0 0 0 0 1 0))
    (data (i32.const 1400) "boxed")
    (data (i32.const 1408) "Gain")
    (data (i32.const 1416) "y = 2 times")
    (data (i32.const 1432) "uy"))"#;

const TWICE: &str = "local.get 5 local.get 4 f64.load f64.const 2 f64.mul f64.store i32.const 0";

const MODEL: &str = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "demand": Step(time: "0.3 s", after: 1.0),
        "law": Plugin(library: "law.wasm", block: "Gain"),
        "seen": Scope(inputs: ["y"]),
    },
    connections: ["demand.y -> law.u", "law.y -> seen.y"],
)
"#;

fn module(law: &str) -> Vec<u8> {
    wat::parse_str(MODULE.replace("LAW", law)).expect("a module")
}

/// A folder with the model and a module with this law, and settings of somebody who trusts nobody.
fn desk(law: &str) -> Desk {
    let desk = Desk::with(&[("model.ron", MODEL)]);
    fs::write(desk.0.join("law.wasm"), module(law)).expect("written");
    desk
}

/// Calls the program as somebody who trusts nobody; gives what it says, and holds its exit code against `code`.
fn says(desk: &Desk, words: &[&str], code: i32) -> String {
    let output = desk.command(words).env("BLOCKSIM_HOME", desk.0.join("home")).output().expect("the program");
    let text =
        [&output.stdout, &output.stderr].map(|part| String::from_utf8_lossy(part).into_owned()).concat();
    assert_eq!(output.status.code(), Some(code), "{words:?}: {text}");
    text
}

#[test]
fn a_module_is_looked_at_and_run_without_trust() {
    let desk = desk(TWICE);
    let checked = says(&desk, &["check", "model.ron"], 0);
    assert!(checked.contains("model.ron: no problems; 3 blocks"), "{checked}");
    let shown = says(&desk, &["plugin", "show", "law.wasm"], 0);
    assert!(shown.contains("y = 2 times") && shown.contains("Plugin(library: \"law.wasm\""), "{shown}");
    says(&desk, &["run", "model.ron", "--out", "run"], 0);
    let rows = fs::read_to_string(desk.0.join("run/signals.csv")).expect("signals");
    assert!(rows.trim_end().ends_with(",2"), "{rows}");
    assert!(!desk.0.join("home/trusted.json").exists(), "nothing has become trusted");
    let refused = says(&desk, &["run", "model.ron", "--no-plugins"], 3);
    assert!(
        refused.contains("the plug-in `law.wasm` was not built or loaded, because of `--no-plugins`"),
        "{refused}"
    );
}

#[cfg(unix)]
#[test]
fn a_module_runs_in_a_process_of_its_own_and_is_examined_there() {
    let good = desk(TWICE);
    says(&good, &["run", "model.ron", "--out", "here"], 0);
    says(&good, &["run", "model.ron", "--out", "apart", "--isolate"], 0);
    let rows = |run: &str| fs::read(good.0.join(run).join("signals.rec")).expect("signals");
    assert!(rows("here") == rows("apart"), "the same bits");
    let line = says(&good, &["plugin", "check", "law.wasm", "--json"], 0);
    let examined: Value = serde_json::from_str(&line).expect("JSON");
    assert_eq!(examined["good"], true, "{line}");

    let broken = |law: &str| -> Vec<String> {
        let line = says(&desk(law), &["plugin", "check", "law.wasm", "--json"], 1);
        let examined: Value = serde_json::from_str(&line).expect("JSON");
        let findings = examined["findings"].as_array().expect("findings").iter();
        findings
            .filter(|one| one["verdict"] == "failed")
            .map(|one| one["rule"].as_str().expect("a rule").to_owned())
            .collect()
    };
    let memory = "i32.const 512 i32.const 512 f64.load f64.const 1 f64.add f64.store
                  local.get 5 i32.const 512 f64.load f64.store i32.const 0";
    assert_eq!(broken(memory), ["stateless"]);
    // The input of the call before, by a pointer that it has kept.
    let pointer = "i32.const 512 i32.load i32.eqz (if (then i32.const 512 local.get 4 i32.store))
                   local.get 5 i32.const 512 i32.load f64.load f64.store i32.const 0";
    assert_eq!(broken(pointer), ["pointers"]);
    assert_eq!(broken("unreachable"), ["runs"]);
    assert_eq!(broken("local.get 5 f64.const inf f64.store i32.const 0"), ["finite"]);
}

#[test]
fn a_module_that_does_not_end_is_named_and_what_was_recorded_is_kept() {
    // It loops as soon as the step comes.
    let law = format!("local.get 4 f64.load f64.const 0.5 f64.gt (if (then (loop br 0))) {TWICE}");
    let desk = desk(&law);
    let said = says(&desk, &["run", "model.ron", "--out", "run", "--call-limit", "100 s"], 1);
    let deed = "the plug-in `law.wasm` stopped: `outputs` did not return within 1000 million instructions";
    assert!(said.contains(deed) && said.contains("`law`") && said.contains("t = 0.3 s"), "{said}");
    let rows = fs::read_to_string(desk.0.join("run/signals.csv")).expect("signals");
    assert!(rows.lines().count() > 3, "{rows}");
}

/// A name that ends in `.wasm` is never loaded in any other way, and a module of another name is no module.
#[cfg(unix)]
#[test]
fn a_library_under_the_name_of_a_module_is_not_loaded() {
    let desk = desk(TWICE);
    let mark = desk.0.join("mark");
    let source = format!(
        "#include <stdio.h>\n__attribute__((constructor)) static void mark(void) {{ fclose(fopen({mark:?}, \"w\")); }}\n"
    );
    fs::write(desk.0.join("mark.c"), source).expect("written");
    let mut cc = desk.script(
        "cc -shared -fPIC -o libmark.so mark.c && ln -sf libmark.so law.wasm && ln -s /dev/zero zero.wasm",
    );
    assert!(cc.status().expect("cc").success());
    let said = says(&desk, &["check", "model.ron"], 3);
    assert!(
        said.contains("error[plugin_symbol]") && said.contains("begins in another way than WebAssembly"),
        "{said}"
    );
    let said = says(&desk, &["run", "model.ron"], 3);
    assert!(said.contains("error[plugin_symbol]"), "{said}");
    let said = says(&desk, &["plugin", "show", "zero.wasm"], 4);
    assert!(said.contains("the plug-in `zero.wasm` is not a regular file"), "{said}");
    assert!(!mark.exists(), "the library was loaded");

    fs::write(desk.0.join("law.so"), module(TWICE)).expect("written");
    fs::write(desk.0.join("model.ron"), MODEL.replace("law.wasm", "law.so")).expect("written");
    assert!(says(&desk, &["check", "model.ron"], 3).contains("plugin_untrusted"));
}

/// Building a crate runs its build script, so that a module of it needs trust like a library.
#[test]
fn a_crate_that_would_be_built_as_a_module_needs_trust() {
    let model = MODEL.replace("library: \"law.wasm\"", "library: \"law\", target: Wasm");
    let desk = Desk::with(&[("model.ron", &model)]);
    fs::create_dir_all(desk.0.join("law/src")).expect("a folder");
    fs::write(desk.0.join("law/Cargo.toml"), "[package]\nname = \"law\"\nedition = \"2024\"\n[workspace]\n")
        .expect("written");
    fs::write(desk.0.join("law/src/lib.rs"), "").expect("written");
    fs::write(desk.0.join("law/build.rs"), "fn main() { std::fs::write(\"ran.txt\", \"\").unwrap(); }")
        .expect("written");
    let refused = says(&desk, &["check", "model.ron"], 3);
    assert!(refused.contains("error[plugin_untrusted]: the plug-in `law` is not trusted"), "{refused}");
    assert!(!desk.0.join("law/ran.txt").exists() && !desk.0.join("law/target").exists());
    let unknown = model.replace("target: Wasm", "target: Wsm");
    fs::write(desk.0.join("model.ron"), unknown).expect("written");
    let refused = says(&desk, &["check", "model.ron"], 3);
    assert!(refused.contains("`Wasm`"), "{refused}");
}
