//! Plug-ins with every defect that students have: each is named, with block, library and time, and what was recorded stays.
#![cfg(all(target_os = "linux", target_arch = "x86_64"))]

use std::fs;
use std::path::Path;

use expect_test::expect;
use serde_json::Value;

use crate::desk::Desk;

/// A controller of one input, one output and a state, with places for a mistake. The function that has one makes it from 0.5 s
/// on, or when it is called at all.
const SOURCE: &str = r#"
#define _GNU_SOURCE
#include <assert.h>
#include <fenv.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xmmintrin.h>
#include "blocksim_plugin.h"

#define Q(name, value, reads) \
    {sizeof(blocksim_quantity), 1, BLOCKSIM_TEXT(name), BLOCKSIM_TEXT("1"), BLOCKSIM_TEXT(""), value, reads}
#define UNUSED (void)p, (void)t, (void)x, (void)xd, (void)u, (void)m
#define ARGUMENTS const double *p, double t, const double *x, const double *xd, const double *u, double *y, \
    const blocksim_message *m

static const double one = 1.0, tenth = 0.1;
static volatile int zero = 0;
static int *volatile null = 0;
static const blocksim_quantity params[] = {Q("k", &one, 0), Q("ts", &tenth, 0)};
static const blocksim_quantity inputs[] = {Q("u", 0, 0)};
static const blocksim_quantity outputs[] = {Q("y", 0, BLOCKSIM_READS(0))};
static const blocksim_quantity states[] = {Q("s", 0, 0)};

static int say(const char *text, const blocksim_message *m)
{
    snprintf(m->text, m->capacity, "%s", text);
    return 1;
}
static int deep(int n)
{
    volatile char room[1000];
    room[0] = (char)n;
    return deep(n + 1) + room[0];
}
static blocksim_status check(const double *p, const blocksim_message *m)
{
    (void)p, (void)m;
    /*check*/
    return BLOCKSIM_OK;
}
static blocksim_status sample_time(const double *p, double *period, const blocksim_message *m)
{
    (void)m;
    *period = p[1];
    /*time*/
    return BLOCKSIM_OK;
}
static blocksim_status reset(const double *p, double *x, double *xd, const blocksim_message *m)
{
    (void)p, (void)x, (void)xd, (void)m;
    /*reset*/
    return BLOCKSIM_OK;
}
static blocksim_status law(ARGUMENTS)
{
    UNUSED;
    y[0] = p[0] * u[0] + xd[0];
    if (t > 0.45) {
        /*outputs*/
    }
    return BLOCKSIM_OK;
}
static blocksim_status update(ARGUMENTS)
{
    UNUSED;
    y[0] = xd[0] + 1.0;
    if (t > 0.45) {
        /*update*/
    }
    return BLOCKSIM_OK;
}
static const blocksim_block_table blocks[] = {{
    .size = sizeof(blocksim_block_table), .kind = BLOCKSIM_TEXT("Law"),
    .parameter_count = 2, .parameters = params, .input_count = 1, .input_ports = inputs,
    .output_count = 1, .output_ports = outputs, .discrete_count = 1, .discrete_states = states,
    .check = check, .sample_time = sample_time, .reset = reset, .outputs = law, .update = update,
}};
static const blocksim_plugin_table table = {
    .size = sizeof(blocksim_plugin_table), .abi_major = BLOCKSIM_ABI_MAJOR, .abi_minor = BLOCKSIM_ABI_MINOR,
    .magic = BLOCKSIM_MAGIC, .name = BLOCKSIM_TEXT("law"), .version = BLOCKSIM_TEXT("1"), .blocks = blocks,
    .block_count = 1,
};
__attribute__((constructor)) static void loaded(void)
{
    /*load*/
}
const blocksim_plugin_table *blocksim_plugin_v1(void)
{
    (void)say, (void)deep, (void)zero, (void)null;
    /*entry*/
    return &table;
}
"#;

const MODEL: &str = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "demand": Constant(value: 1.0),
        "control": Plugin(library: "law", block: "Law", parameters: { "k": 1.0 }),
        "seen": Scope(inputs: ["y"]),
    },
    connections: ["demand.y -> control.u", "control.y -> seen.y"],
)
"#;

/// Name, place, code. Those that no process survives, whatever it does, are only run isolated.
const DEFECTS: [(&str, &str, &str); 53] = [
    ("writes behind outputs", "outputs", "y[1] = 1.0;"),
    ("writes far behind outputs", "outputs", "y[15] = 1.0;"),
    ("writes before outputs", "outputs", "y[-1] = 1.0;"),
    ("writes a whole row", "outputs", "for (int i = 0; i < 6; i++) y[i] = i;"),
    ("changes an input", "outputs", "((double *)u)[0] = 5.0;"),
    ("changes a parameter", "outputs", "((double *)p)[1] = 0.2;"),
    ("changes a state in outputs", "outputs", "((double *)xd)[0] = 9.0;"),
    ("writes behind inputs", "outputs", "((double *)u)[1] = 9.0;"),
    ("writes into empty states", "outputs", "((double *)x)[0] = 9.0;"),
    ("gives NaN", "outputs", "y[0] = NAN;"),
    ("gives infinity", "outputs", "y[0] = 1.0 / zero;"),
    ("root of a negative number", "outputs", "y[0] = sqrt(-u[0]);"),
    ("rounds upwards", "outputs", "fesetround(FE_UPWARD);"),
    ("flushes denormals", "outputs", "_mm_setcsr(_mm_getcsr() | 0x8040);"),
    ("unmasks traps", "outputs", "feenableexcept(FE_DIVBYZERO);"),
    ("changes the locale", "outputs", "setlocale(LC_ALL, \"C.UTF-8\");"),
    ("exits", "outputs", "exit(3);"),
    ("exits well", "outputs", "exit(0);"),
    ("exits at once", "outputs", "_exit(3);"),
    ("aborts", "outputs", "abort();"),
    ("asserts", "outputs", "assert(zero);"),
    ("reads NULL", "outputs", "y[0] = *null;"),
    ("writes NULL", "outputs", "*null = 1;"),
    ("calls NULL", "outputs", "((void (*)(void))(uintptr_t)zero)();"),
    ("writes anywhere", "outputs", "*(volatile int *)(uintptr_t)0x123456789000 = 1;"),
    ("writes a constant", "outputs", "*(volatile double *)(uintptr_t)&one = 2.0;"),
    ("recurses for ever", "outputs", "y[0] = deep(0);"),
    ("loops for ever", "outputs", "while (!zero) { }"),
    ("sleeps", "outputs", "sleep(100);"),
    (
        "waits for itself",
        "outputs",
        "static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; \
      pthread_mutex_lock(&lock); pthread_mutex_lock(&lock);",
    ),
    ("divides an integer by zero", "outputs", "y[0] = (int)(100.0 * t) / zero;"),
    ("traps", "outputs", "__builtin_trap();"),
    ("raises SIGSEGV", "outputs", "raise(SIGSEGV);"),
    ("raises SIGKILL", "outputs", "raise(SIGKILL);"),
    ("frees twice", "outputs", "void *volatile room = malloc(40); free(room); free(room);"),
    ("frees what is not its own", "outputs", "free(y);"),
    ("reports an odd status", "outputs", "return 77;"),
    ("fails with a reason", "outputs", "return say(\"the winding is too hot\", m);"),
    ("fails without a reason", "outputs", "return BLOCKSIM_ERROR;"),
    ("says too much", "outputs", "memset(m->text, 'x', m->capacity + 8); return BLOCKSIM_ERROR;"),
    ("writes behind the next states", "update", "y[1] = 1.0;"),
    ("gives a state that is not finite", "update", "y[0] = HUGE_VAL * zero;"),
    ("changes the present state", "update", "((double *)xd)[0] += 1.0;"),
    ("crashes in update", "update", "*null = 1;"),
    ("starts with NaN", "reset", "xd[0] = NAN;"),
    ("crashes at the start", "reset", "*null = 1;"),
    ("exits when it is checked", "check", "exit(1);"),
    ("loops when it is checked", "check", "while (!zero) { }"),
    ("has a negative sample time", "time", "*period = -1.0;"),
    ("crashes when it is loaded", "load", "*null = 1;"),
    ("rounds upwards when it is loaded", "load", "fesetround(FE_UPWARD);"),
    ("exits instead of a table", "entry", "exit(2);"),
    (
        "has a default at no address",
        "entry",
        "static blocksim_quantity wrong[2]; static blocksim_block_table b[1]; static blocksim_plugin_table all; \
      memcpy(wrong, params, sizeof params); wrong[0].default_value = (const double *)16; \
      b[0] = blocks[0]; b[0].parameters = wrong; all = table; all.blocks = b; return &all;",
    ),
];
/// Those that end the process without a word, or leave its memory in disorder.
const ABRUPT: [&str; 3] = ["exits at once", "raises SIGKILL", "frees what is not its own"];

/// What a run says of its failure: code, message, place in the model, and what is kept.
fn run(desk: &Desk, folder: &str, isolated: bool) -> String {
    let out = format!("{folder}/{}", if isolated { "apart" } else { "within" });
    let model = format!("{folder}/model.ron");
    let mut words = vec!["run", &model, "--json", "--call-limit", "400ms", "--out", &out];
    words.extend(isolated.then_some("--isolate"));
    let answer = desk.call(&words);
    let lines: Vec<Value> = answer.out.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let problem = lines.iter().find(|line| line["type"] == "diagnostic");
    let Some(problem) = problem else {
        // What a handler of a signal writes.
        let line = answer.err.lines().find(|line| line.starts_with("error["));
        return format!("{} {}", answer.code.unwrap_or(-1), line.unwrap_or("NOTHING WAS SAID"));
    };
    let text = |key: &str| problem[key].as_str().unwrap_or_default().to_owned();
    let message = text("message").replace(&desk.0.canonicalize().unwrap().display().to_string(), "[desk]");
    let place = desk.0.join(&out);
    let kept = if place.exists() { kept(&place, lines.last()) } else { "nothing was run".to_owned() };
    let named = message.contains("law") || text("code") != "block_failed";
    format!(
        "{} {}: {message}; {kept}{}",
        answer.code.unwrap_or(-1),
        text("code"),
        if named { "" } else { "; NOT NAMED" }
    )
}

/// What is in the folder of a run, which must be whole.
fn kept(place: &Path, last: Option<&Value>) -> String {
    let read = |name: &str| fs::read_to_string(place.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    let manifest: Value = serde_json::from_str(&read("manifest.json")).expect("a manifest");
    let ended = manifest["ended"].to_string();
    assert!(ended.contains("failed"), "{ended}");
    for name in ["events.csv", "log.txt", "model.json"] {
        read(name);
    }
    assert!(place.join("signals.rec").exists());
    assert_eq!(last.map(|last| &last["type"]), Some(&Value::from("done")), "{last:?}");
    // Numbers of a line are those of a good run.
    let table = read("signals.csv");
    let rows: Vec<&str> =
        table.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).collect();
    format!("{} rows", rows.len())
}

#[test]
fn every_bad_plug_in_is_named_and_the_rows_so_far_are_kept() {
    let desk = Desk::with(&[]);
    let tell = |(at, (name, place, code)): (usize, &(&str, &str, &str))| {
        let folder = format!("bad{at}");
        fs::create_dir_all(desk.0.join(&folder).join("law")).unwrap();
        let mark = format!("/*{place}*/");
        assert!(SOURCE.contains(&mark), "{name}");
        fs::write(desk.0.join(&folder).join("law/law.c"), SOURCE.replace(&mark, code)).unwrap();
        // Some mistakes are seen by the compiler as well.
        fs::write(desk.0.join(&folder).join("law/plugin.toml"), "flags = [\"-w\"]\n").unwrap();
        fs::write(desk.0.join(&folder).join("model.ron"), MODEL).unwrap();
        let apart = run(&desk, &folder, true);
        if ABRUPT.contains(name) {
            return format!("{name}\n  apart:  {apart}\n");
        }
        let within = run(&desk, &folder, false);
        match within == apart {
            true => format!("{name}\n  {within}\n"),
            false => format!("{name}\n  within: {within}\n  apart:  {apart}\n"),
        }
    };
    let work: Vec<_> = DEFECTS.iter().enumerate().collect();
    let halves: Vec<String> = std::thread::scope(|scope| {
        let (first, second) = work.split_at(work.len() / 2);
        let run = |part: &[(usize, &(&str, &str, &str))]| part.iter().copied().map(tell).collect::<String>();
        let other = scope.spawn(move || run(second));
        vec![run(first), other.join().unwrap()]
    });
    expect_test::expect_file!["bad_plugins.txt"].assert_eq(&halves.concat());
}

/// The same law, here or in another process: the same bits.
#[test]
fn isolated_plug_ins_give_the_same_bits() {
    let desk = Desk::with(&[("model.ron", MODEL)]);
    fs::create_dir(desk.0.join("law")).unwrap();
    fs::write(
        desk.0.join("law/law.c"),
        SOURCE.replace("p[0] * u[0] + xd[0];", "sin(p[0] * t) / 3.0 + xd[0];"),
    )
    .unwrap();
    let table = |words: &[&str], out: &str| {
        let answer = desk.call(&[&["run", "model.ron", "--quiet", "--out", out], words].concat());
        assert_eq!(answer.code, Some(0), "{}", answer.text());
        desk.read(&format!("{out}/signals.csv"))
    };
    let here = table(&[], "here");
    assert!(here.lines().count() > 10);
    assert_eq!(here, table(&["--isolate"], "there"));
    let swept = desk.call(&[
        "sweep",
        "model.ron",
        "--isolate",
        "--over",
        "control.k=1,2,3",
        "--metric",
        "peak:seen.y",
    ]);
    assert_eq!(swept.code, Some(0), "{}", swept.text());
}

/// Ctrl-C ends a loop without end, in this process and in another one.
#[test]
fn an_endless_loop_can_be_interrupted() {
    use std::time::{Duration, Instant};
    let desk = Desk::with(&[("model.ron", MODEL)]);
    fs::create_dir(desk.0.join("law")).unwrap();
    let source = SOURCE.replace("/*outputs*/", "fputs(\"looping\\n\", stderr); while (!zero) { }");
    fs::write(desk.0.join("law/law.c"), source).unwrap();
    for (words, out) in [(&[][..], "within"), (&["--isolate"], "apart")] {
        use std::io::{BufRead, BufReader};
        let mut command = desk.command(&[&["run", "model.ron", "--quiet", "--out", out], words].concat());
        let mut run = command
            .stderr(std::process::Stdio::piped())
            .stdout(std::process::Stdio::null())
            .spawn()
            .expect("the program runs");
        let mut lines = BufReader::new(run.stderr.take().expect("a pipe")).lines();
        assert!(lines.any(|line| line.is_ok_and(|line| line == "looping")));
        let asked = Instant::now();
        let killed = std::process::Command::new("kill").args(["-INT", &run.id().to_string()]).status();
        assert!(killed.expect("kill runs").success());
        assert_eq!(run.wait().expect("it ends").code(), Some(130), "{out}");
        assert!(asked.elapsed() < Duration::from_secs(5), "{:?}", asked.elapsed());
        let manifest = desk.read(&format!("{out}/manifest.json"));
        assert!(manifest.contains("interrupted"), "{manifest}");
        assert!(desk.read(&format!("{out}/signals.csv")).lines().count() > 4);
    }
}

/// Whoever serves nobody says so.
#[test]
fn the_command_that_serves_is_for_the_program_alone() {
    let answer = Desk::with(&[]).call(&["plugin", "serve"]);
    assert_eq!(answer.code, Some(2), "{}", answer.text());
    expect!["true"].assert_eq(&answer.err.contains("`--isolate`").to_string());
}

/// What a library does at the end of the program: its name, the code of its destructor, and what is said of it.
const ENDS: [(&str, &str, &str); 10] = [
    ("crashes", "*null = 1;", "crashed"),
    ("aborts", "abort();", "crashed"),
    ("recurses", "zero = deep(0);", "crashed"),
    ("loops", "while (!zero) { }", "does not return"),
    // What C has not written to its file yet must not be lost.
    ("writes", "fputs(\"the end\\n\", fopen(\"end.txt\", \"w\"));", ""),
    // A destructor that waits for a thread of its own.
    ("waits", "zero = 1; pthread_join(thread, 0); fputs(\"the end\\n\", fopen(\"end.txt\", \"w\"));", ""),
    ("leaves", "_exit(7);", "called `_exit`"),
    ("leaves quickly", "quick_exit(0);", "called `_exit`"),
    ("is killed", "kill(getpid(), SIGKILL);", "was ended by a signal"),
    ("signals itself", "raise(SIGUSR1);", "was ended by a signal"),
];

/// Every command that loads a plug-in has its own exit code, whatever the plug-in does when the program ends.
#[test]
fn a_plug_in_cannot_change_the_exit_code_when_the_program_ends() {
    let commands: [(&[&str], i32); 8] = [
        (&["run", "model.ron", "--quiet", "--call-limit", "400ms", "--out"], 0),
        (&["run", "failing.ron", "--quiet", "--call-limit", "400ms", "--out"], 1),
        (&["check", "model.ron"], 0),
        (&["check", "wrong.ron"], 3),
        (&["plugin", "show", "law"], 0),
        (&["plugin", "show", "other.so"], 4),
        (&["sweep", "model.ron", "--over", "control.k=1,2", "--metric", "peak:seen.y"], 0),
        (&["plugin", "check", "law"], 0),
    ];
    for (at, (name, code, deed)) in ENDS.into_iter().enumerate() {
        let failing =
            MODEL.replace("stop_time: \"1 s\"", "stop_time: \"1 s\", solver: Ode45(max_step: \"1 s\")");
        let wrong = MODEL.replace("\"y\"])", "\"z\"])");
        let failing = failing.replace("value: 1.0", "value: 7.0");
        let desk = Desk::with(&[("model.ron", MODEL), ("failing.ron", &failing), ("wrong.ron", &wrong)]);
        fs::create_dir(desk.0.join("law")).unwrap();
        let source = SOURCE.replace("/*outputs*/", "if (u[0] > 5.0) return say(\"too much\", m);");
        // Half of them in a destructor, half in a function of `atexit`; a log that C has not written yet must not be lost either.
        let (last, registered) = match at % 2 {
            0 => ("__attribute__((destructor)) static", ""),
            _ => ("static", "atexit(unloaded);"),
        };
        let begun = if name == "waits" { "pthread_create(&thread, 0, until_told, 0);" } else { "" };
        let source = format!(
            "{source}static pthread_t thread;
static void *until_told(void *none)
{{
    while (!zero) usleep(1000);
    return none;
}}
{last} void unloaded(void)
{{
    {code}
}}
__attribute__((constructor)) static void begins(void)
{{
    fputs(\"begun\\n\", fopen(\"log.txt\", \"w\"));
    {registered}
    {begun}
}}
"
        );
        fs::write(desk.0.join("law/law.c"), &source).unwrap();
        fs::write(desk.0.join("law/plugin.toml"), "flags = [\"-w\"]\n").unwrap();
        // A library that is not a plug-in, but does the same.
        let other = source.replace("blocksim_plugin_v1", "something_else");
        fs::write(desk.0.join("other.c"), other).unwrap();
        let include = crate::support::root().join("crates/abi/include");
        let compiled = std::process::Command::new("cc")
            .args(["-shared", "-fPIC", "-w", "-o", "other.so", "other.c", "-I"])
            .arg(include)
            .current_dir(&desk.0)
            .status();
        assert!(compiled.expect("a compiler").success());
        let trusted = desk.call(&["trust", "."]);
        assert_eq!(trusted.code, Some(0), "{}", trusted.text());
        for (at, (words, exit)) in commands.iter().enumerate() {
            // Nobody waits 10 s for a loop in a test.
            if name == "loops" && words[0] != "run" {
                continue;
            }
            let out = format!("out{at}");
            let mut words = words.to_vec();
            if words.last() == Some(&"--out") {
                words.push(&out);
            }
            for file in ["end.txt", "log.txt"] {
                let _ = fs::remove_file(desk.0.join(file));
            }
            let answer = desk.call(&words);
            assert_eq!(answer.code, Some(*exit), "{name}: {words:?}: {}", answer.text());
            // A process of its own is ended by the one that has started it.
            if words[..2] == ["plugin", "check"] {
                continue;
            }
            assert_eq!(desk.read("log.txt"), "begun\n", "{name}: {words:?}");
            let warned = answer.err.lines().filter(|line| line.starts_with("warning: the plug-in `"));
            let warned: Vec<&str> = warned.collect();
            if deed.is_empty() {
                assert!(warned.is_empty(), "{words:?}: {warned:?}");
                assert_eq!(desk.read("end.txt"), "the end\n", "{words:?}");
                continue;
            }
            let library = if words.contains(&"other.so") { "other.so" } else { "law" };
            let expected = format!(
                "warning: the plug-in `{library}` {deed} when the program ended; all results were written before"
            );
            assert_eq!(warned, [expected], "{name}: {words:?}: {}", answer.text());
            if words.contains(&"--out") {
                assert!(desk.read(&format!("{out}/signals.csv")).lines().count() > 4);
            }
        }
    }
}
