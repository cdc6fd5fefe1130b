//! Plug-ins as a user of diagrams sees them: the bits of their results, and what is said when something is wrong.
//!
//! They are written in C here, so that the tests need nothing but a C compiler.

use std::path::{Path, PathBuf};
use std::process::Command;

use blocksim_tests::{Run, compile_text, root, run};
use expect_test::{Expect, expect};

/// `Lag`: the law of `LowPass`, as a continuous state. `Count`: how often it was sampled. `Faulty`: fails from 0.5 s on.
const SOURCE: &str = r#"
#include <math.h>
#include <string.h>
#include "blocksim_plugin.h"
#define Q(length, name, unit, def, reads)                                                                   \
    {sizeof(blocksim_quantity), length, BLOCKSIM_TEXT(name), BLOCKSIM_TEXT(unit), BLOCKSIM_TEXT(""), def, reads}
#define LAW(name) static blocksim_status name(const double *params, double t, const double *x, const double *xd,  \
                                              const double *u, double *y, const blocksim_message *message)
#define UNUSED (void)params, (void)t, (void)x, (void)xd, (void)u, (void)message

static const double four[] = {4.0};
static const blocksim_quantity lag_params[] = {Q(1, "tau", "s", 0, 0), Q(1, "scale", "1", four, 0)};
static const blocksim_quantity lag_in[] = {Q(1, "u", "1", 0, 0)};
static const blocksim_quantity lag_out[] = {Q(1, "y", "1", 0, 0)};
static const blocksim_quantity lag_state[] = {Q(1, "x", "1", 0, 0)};
LAW(lag_outputs) { UNUSED; y[0] = x[0]; return BLOCKSIM_OK; }
LAW(lag_derivatives) { UNUSED; y[0] = (u[0] - x[0]) / params[0]; return BLOCKSIM_OK; }

static const blocksim_quantity faulty_params[] = {Q(1, "how", "1", 0, 0)};
static const blocksim_quantity faulty_in[] = {Q(1, "u", "1", 0, 0)};
static const blocksim_quantity faulty_out[] = {Q(1, "y", "1", 0, BLOCKSIM_READS(0))};
LAW(faulty_outputs)
{
    UNUSED;
    y[0] = 2.0 * u[0];
    if (t < 0.5)
        return BLOCKSIM_OK;
    if (params[0] == 1.0) {
        y[0] = NAN;
        return BLOCKSIM_OK;
    }
    const char *text = params[0] == 2.0 ? "index 3 of 2" : "the winding is too hot";
    if (message && message->text && message->capacity > strlen(text))
        memcpy(message->text, text, strlen(text) + 1);
    return params[0] == 2.0 ? BLOCKSIM_PANICKED : BLOCKSIM_ERROR;
}

static const blocksim_block_table blocks[] = {
    {
        .size = sizeof(blocksim_block_table), .kind = BLOCKSIM_TEXT("Lag"),
        .parameter_count = 2, .parameters = lag_params, .input_count = 1, .input_ports = lag_in,
        .output_count = 1, .output_ports = lag_out, .continuous_count = 1, .continuous_states = lag_state,
        .outputs = lag_outputs, .derivatives = lag_derivatives,
    },
    {
        .size = sizeof(blocksim_block_table), .kind = BLOCKSIM_TEXT("Faulty"),
        .parameter_count = 1, .parameters = faulty_params, .input_count = 1, .input_ports = faulty_in,
        .output_count = 1, .output_ports = faulty_out, .outputs = faulty_outputs,
    },
};
static const blocksim_plugin_table table = {
    .size = sizeof(blocksim_plugin_table), .abi_major = BLOCKSIM_ABI_MAJOR, .abi_minor = BLOCKSIM_ABI_MINOR,
    .magic = BLOCKSIM_MAGIC, .name = BLOCKSIM_TEXT("trial"), .version = BLOCKSIM_TEXT("1"),
    .block_count = 2, .blocks = blocks,
};
BLOCKSIM_EXPORT const blocksim_plugin_table *blocksim_plugin_v1(void) { return &table; }
"#;

/// A folder with the built plug-in, removed at the end of the test.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("diagram-test-{test}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join("trial.c"), SOURCE).expect("a file");
        let mut cc = Command::new("cc");
        cc.args(["-std=c99", "-O1", "-ffp-contract=off", "-shared", "-fPIC", "-I"])
            .arg(root().join("crates/abi/include"));
        cc.arg("-o").arg(folder.join("trial.so")).arg(folder.join("trial.c")).arg("-lm");
        assert!(cc.status().expect("a C compiler").success(), "{cc:?}");
        Self(folder)
    }

    fn library(&self) -> String {
        self.0.join("trial.so").display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A loop of a controller and a lag, with this block as the lag.
fn looped(lag: &str, solver: &str) -> Run {
    let text = format!(
        r#"Diagram(simulation: (stop_time: "3 s", solver: {solver}),
            blocks: {{ "set": Sine(amplitude: 2, frequency: "1 Hz"), "e": Sum(signs: "+-"), "pid": Pid(kp: 3, ki: "2 1/s"),
                "lag": {lag}, "show": Scope(inputs: ["y", "u"]) }},
            connections: ["set.y -> e.u1", "e.y -> pid.e", "pid.u -> lag.u, show.u", "lag.y -> e.u2, show.y"])"#
    );
    let (compiled, problems) = compile_text(&text);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    assert_eq!(run.error, None);
    run
}

fn bits(run: &Run) -> Vec<u64> {
    run.time.iter().chain(run.columns.iter().flatten()).map(|value| value.to_bits()).collect()
}

#[test]
fn a_law_gives_the_same_bits_in_the_library_and_in_a_plugin() {
    let folder = Folder::new("bits");
    for solver in ["Ode45(rtol: 1e-8)", r#"Ode4(step: "1 ms")"#, "Dop853(rtol: 1e-8)", "Rodas4(rtol: 1e-9)"] {
        let loaded = looped(
            &format!(
                r#"Plugin(library: "{}", block: "Lag", parameters: {{ "tau": "300 ms" }})"#,
                folder.library()
            ),
            solver,
        );
        let built_in = looped(r#"LowPass(tau: "300 ms")"#, solver);
        assert!(loaded.time.len() > 50, "{} rows", loaded.time.len());
        if solver.starts_with("Rodas4") {
            // The library knows its slopes exactly, of the plug-in they are differences.
            for signal in ["show.y", "show.u"] {
                assert!((loaded.last(signal) - built_in.last(signal)).abs() < 1e-8, "{solver}, {signal}");
            }
        } else {
            assert!(bits(&loaded) == bits(&built_in), "{solver}: the runs differ");
        }
    }
}

/// What is said of a diagram with this block; the place of the library is taken out.
fn refused(folder: &Folder, plugin: &str, expected: &Expect) {
    // Columns must not depend on how long the name of the folder is.
    let plugin = plugin.replace(", block", ",\n      block").replace("LIBRARY", &folder.library());
    let text = format!(
        "Diagram(\n  blocks: {{\n    \"one\": Constant(value: 1),\n    \"c\": {plugin},\n    \"show\": Scope,\n  }},\n  connections: [\"one.y -> c.u\", \"c.y -> show.u\"],\n)"
    );
    let place = folder.0.canonicalize().unwrap_or_default();
    let shown = compile_text(&text).1;
    let shown = shown
        .replace(&place.display().to_string(), "[folder]")
        .replace(&folder.0.display().to_string(), "[folder]");
    expected.assert_eq(&shown);
}

#[test]
fn what_is_wrong_with_a_plugin_is_said_at_its_place() {
    let folder = Folder::new("refused");
    let check = |plugin: &str, expected: Expect| refused(&folder, plugin, &expected);
    check(
        r#"Plugin(library: "nowhere/trial.so", block: "Lag")"#,
        expect![[r#"
        error[plugin_missing]: there is no plug-in `nowhere/trial.so`
          model.ron:4:26 `"nowhere/trial.so"` 
          help: looked for `nowhere/trial.so`
    "#]],
    );
    check(
        r#"Plugin(library: "LIBRARY", block: "Lagg", parameters: { "tau": 1 })"#,
        expect![[r#"
            error[plugin_parameter]: the plug-in `trial` has no block `Lagg`
              model.ron:5:14 `"Lagg"` 
              help: did you mean `Lag`? Its blocks are: `Lag`, `Faulty`
        "#]],
    );
    check(
        r#"Plugin(library: "LIBRARY", block: "Lag", parameters: { "tau": 1, "tua": 2 })"#,
        expect![[r#"
            error[plugin_parameter]: `Lag` has no parameter `tua`
              model.ron:5:33 `{ "tau": 1, "tua": 2 }` 
              help: did you mean `tau`? Its parameters are: `tau`, `scale`
        "#]],
    );
    check(
        r#"Plugin(library: "LIBRARY", block: "Lag", parameters: { "tau": "3 V" })"#,
        expect![[r#"
            error[plugin_parameter]: `tau` is 3 V, but must be in s
              model.ron:5:33 `{ "tau": "3 V" }` 
              help: a number without a unit is taken to be in s
        "#]],
    );
    check(
        r#"Plugin(library: "LIBRARY", block: "Lag")"#,
        expect![[r#"
            error[plugin_parameter]: `Lag` needs the parameter `tau`
              model.ron:4:10 `Plugin(library: "[folder]/trial.so",       block: "Lag")` 
              help: give a number in s
        "#]],
    );
    check(
        r#"Plugin(library: "LIBRARY", block: "Lag", parameters: { "tau": [1, 2] })"#,
        expect![[r#"
            error[plugin_parameter]: `tau` is a list of 2, but must be a number
              model.ron:5:33 `{ "tau": [1, 2] }` 
        "#]],
    );
    check(
        r#"Plugin(library: "LIBRARY")"#,
        expect![[r#"
        error[missing_parameter]: `Plugin` needs `block`
          model.ron:4:10 `Plugin` not given
          help: `blocksim blocks Plugin` describes its parameters
    "#]],
    );
    check(r#"Plugin(library: "LIBRARY", block: "Lag", parameters: { "tau": 0.5 })"#, expect![""]);
}

/// A run that the plug-in stops.
fn stopped(folder: &Folder, how: f64, expected: &Expect) {
    let inner = format!(
        r#"Diagram(parameters: {{ "how": {how:?} }}, inputs: {{ "u": () }}, outputs: {{ "y": "c.y" }},
            blocks: {{ "c": Plugin(library: "{}", block: "Faulty", parameters: {{ "how": "how" }}) }}, connections: ["in.u -> c.u"])"#,
        folder.library()
    );
    let model = r#"Diagram(simulation: (stop_time: "1 s", solver: Ode4(step: "125 ms")),
        blocks: { "t": Ramp(slope: "1 1/s"), "part": Subsystem(file: "inner.ron"), "x": Integrator, "show": Scope },
        connections: ["t.y -> part.u", "part.y -> x.u", "x.y -> show.u"])"#;
    let desk = blocksim_tests::Desk::new().with("inner.ron", &inner).with("model.ron", model);
    let (compiled, problems) = blocksim_tests::compile_with(&desk, Path::new("model.ron"), &[]);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    let error = run.error.as_ref().expect("a failure");
    let text = format!("{}: {error}\n", error.path.as_deref().unwrap_or("no block"));
    expected.assert_eq(&text.replace(&folder.library(), "LIBRARY"));
    assert_eq!(run.time, [0.0, 0.125, 0.25, 0.375], "what was recorded until then is kept");
    // The integral of 2 t, which the method gives without error but for rounding.
    assert!((run.last("show.u") - 0.375 * 0.375).abs() < 1e-15, "{}", run.last("show.u"));
}

#[test]
fn a_plugin_that_fails_in_the_middle_stops_the_run_with_path_and_time() {
    let folder = Folder::new("stopped");
    stopped(
        &folder,
        1.0,
        &expect![[r#"
            part/c: error[block_failed] at t = 0.5 s: `part/c` cannot go on: the plug-in `LIBRARY`: output `y` is NaN; inputs: u = 0.5
        "#]],
    );
    stopped(
        &folder,
        2.0,
        &expect![[r#"
            part/c: error[block_failed] at t = 0.5 s: `part/c` cannot go on: the plug-in `LIBRARY` panicked: index 3 of 2
        "#]],
    );
    stopped(
        &folder,
        3.0,
        &expect![[r#"
            part/c: error[block_failed] at t = 0.5 s: `part/c` cannot go on: the plug-in `LIBRARY`: the winding is too hot
        "#]],
    );
}
