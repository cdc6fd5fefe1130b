//! What the world does to a run while it is recorded: disks that are full, folders that go, orders to stop. What was recorded
//! until then is kept, marked and readable, and nothing is overwritten.
// What is skipped is said.
#![allow(clippy::print_stderr)]

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::desk::{Answer, Desk, names};

/// Long enough to be interrupted.
const LONG: &str = r#"Diagram(
    simulation: (stop_time: "1e7 s", solver: Ode4(step: "1 ms"), output: Every("1000 s")),
    blocks: { "wave": Sine(amplitude: 1.0, frequency: "1 Hz"), "x": Integrator, "scope": Scope(inputs: ["x"]) },
    connections: ["wave.y -> x.u", "x.y -> scope.x"],
)
"#;

/// Many rows in a short time: 8 MB as a recording, in chunks of 2 MB, and 28 MB as text.
const LARGE: &str = r#"Diagram(
    simulation: (stop_time: "600 s", solver: Ode4(step: "1 ms")),
    blocks: { "wave": Sine(amplitude: 1.0, frequency: "1 Hz"), "x": Integrator, "scope": Scope(inputs: ["x", "wave"]) },
    connections: ["wave.y -> x.u, scope.wave", "x.y -> scope.x"],
)
"#;

fn wait_for(path: &Path) {
    while !path.exists() {
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Waits until some rows are on the disk.
fn wait_for_rows(recording: &Path) {
    let has_rows = || fs::read(recording).is_ok_and(|bytes| bytes.windows(4).any(|four| four == b"CHNK"));
    while !has_rows() {
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn send(signal: &str, child: &Child) {
    Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
}

/// A run of [`LONG`] to `folder`.
fn begun(desk: &Desk, folder: &str) -> Child {
    let mut command = desk.command(&["run", "long.ron", "--out", folder]);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn says(answer: &Answer, parts: &[&str]) {
    for part in parts {
        assert!(answer.text().contains(part), "{part} is missing in\n{}", answer.text());
    }
}

#[test]
fn a_recording_that_may_not_grow_further_is_kept_and_marked() {
    let desk = Desk::with(&[("large.ron", LARGE)]);
    // In units of 512 bytes.
    let answer = Answer::from(
        desk.script(r#"ulimit -f 10000; "$blocksim" run large.ron --out kept"#).output().unwrap(),
    );
    assert_eq!(answer.code, Some(4), "{}", answer.text());
    says(
        &answer,
        &[
            "kept.partial/signals.rec`: no file may become so large here\n  = help: raise the limit of the system (`ulimit -f`)",
            "  = note: what was recorded from 0 s to ",
            "failed     the recording could not be written: no file may become so large here",
        ],
    );
    assert_eq!(answer.err.matches("error[").count(), 1, "told once: {}", answer.err);
    assert!(desk.read("kept/manifest.json").contains("\"how\": \"failed\""));
    let runs = desk.call(&["runs", "."]);
    assert!(runs.out.contains("kept") && runs.out.contains("failed"), "{runs:?}");
    let export = desk.call(&["export", "kept", "--csv", "saved.csv"]);
    assert_eq!(export.code, Some(0), "{export:?}");
    says(&export, &["note: the run is not complete: it failed: the recording could not be written"]);
    assert!(desk.read("saved.csv").lines().count() > 300_000);
}

#[test]
fn a_table_that_may_not_grow_further_is_left_out_and_the_run_is_whole() {
    let desk = Desk::with(&[("large.ron", LARGE)]);
    let limit = r#"ulimit -f 24000; "$blocksim" run large.ron --out kept --quiet; code=$?
        "$blocksim" export kept --csv large.csv; echo "export: $?" >&2; exit $code"#;
    let answer = Answer::from(desk.script(limit).output().unwrap());
    assert_eq!((answer.code, answer.out.as_str()), (Some(4), "kept\n"), "{}", answer.text());
    says(
        &answer,
        &[
            "kept.partial/signals.csv`: no file may become so large here",
            "  = note: all signals are in kept/signals.rec; `blocksim export kept --csv FILE` writes them as text",
            "error[unwritable]: cannot write `large.csv`: no file may become so large here\n  = help: raise the limit of the system",
            "export: 4",
        ],
    );
    let kept = ["events.csv", "log.txt", "manifest.json", "model.json", "signals.rec"];
    assert_eq!(
        (desk.names("kept"), desk.names(".")),
        (kept.map(String::from).to_vec(), vec!["kept".to_owned(), "large.ron".to_owned()])
    );
    assert!(desk.read("kept/manifest.json").contains("\"how\": \"complete\""));
    let export = desk.call(&["export", "kept", "--csv", "saved.csv"]);
    assert_eq!((export.code, desk.read("saved.csv").lines().count()), (Some(0), 600_002), "{export:?}");
}

/// Runs a script in which small disks can be mounted at `disk`; `None`, with a word about it, where the system does not
/// let one do that.
fn with_mounts(desk: &Desk, options: &str, script: &str) -> Option<Answer> {
    fs::create_dir(desk.0.join("disk")).unwrap();
    let inner = format!("mount -t tmpfs -o {options} none disk || exit 77\n{script}");
    let mut command = desk.script(r#"unshare -rm sh -c "$inner" || exit $?"#);
    let answer = Answer::from(command.env("inner", inner).output().unwrap());
    if answer.code.is_none_or(|code| code == 77 || code == 127 || answer.err.contains("unshare: ")) {
        eprintln!("skipped: this system lets nobody mount a small disk: {}", answer.err);
        return None;
    }
    Some(answer)
}

#[test]
fn a_disk_that_gets_full_during_a_run_is_told_and_what_fits_is_kept() {
    let desk = Desk::with(&[("large.ron", LARGE)]);
    let script = r#""$blocksim" run large.ron --out disk/kept --quiet; echo "run: $?"
        ls disk; "$blocksim" export disk/kept* --csv saved.csv; echo "export: $?""#;
    let Some(answer) = with_mounts(&desk, "size=5m", script) else { return };
    says(
        &answer,
        &[
            "disk/kept.partial/signals.rec`: the disk is full\n  = help: free some space, ",
            "  = note: what was recorded from 0 s to ",
            "run: 4\n",
            "export: 0\n",
            "note: the run is not complete: ",
        ],
    );
    assert_eq!(answer.err.matches("error[").count(), 1, "told once: {}", answer.err);
    assert!(desk.read("saved.csv").lines().count() > 300_000);
}

#[test]
fn a_disk_that_is_full_or_read_only_from_the_start_is_told_before_the_run() {
    let full = r#"head -c 70000 /dev/zero > disk/filler; "$blocksim" run long.ron --out disk/kept; echo "run: $?"; ls disk"#;
    let read_only =
        r#"mount -o remount,ro disk; "$blocksim" run long.ron --out disk/kept; echo "run: $?"; ls disk"#;
    for (script, reason, left) in
        [(full, "the disk is full", "filler\n"), (read_only, "the disk is read-only", "")]
    {
        let desk = Desk::with(&[("long.ron", LONG)]);
        let Some(answer) = with_mounts(&desk, "size=64k", script) else { return };
        says(
            &answer,
            &[
                "error[unwritable]: cannot write the results to `",
                reason,
                "  = help: ",
                &format!("run: 4\n{left}"),
            ],
        );
    }
}

#[test]
fn a_folder_in_which_one_may_not_write_is_told_before_the_run() {
    let desk = Desk::with(&[("long.ron", LONG)]);
    // The rights of files do not bind root, who therefore becomes somebody else.
    let script = r#"chmod a+rx . && mkdir -m 555 closed && cp "$blocksim" program && chmod 755 program || exit 77
        if [ "$(id -u)" = 0 ]; then
            as="setpriv --reuid=65534 --regid=65534 --clear-groups"
            $as ./program --version > /dev/null || exit 77
        fi
        $as ./program run long.ron --out closed/kept"#;
    let answer = Answer::from(desk.script(script).output().unwrap());
    if answer.code == Some(77) {
        eprintln!("skipped: nobody here whom rights of files bind: {}", answer.err);
        return;
    }
    assert_eq!((answer.code, answer.out.as_str()), (Some(4), ""), "{}", answer.text());
    says(&answer, &["closed", "you may not write or read there\n  = help: choose another place with --out"]);
    assert!(desk.names("closed").is_empty());
}

#[test]
fn results_whose_folder_goes_are_told_and_leave_nothing_half_named() {
    let desk = Desk::with(&[("long.ron", LONG)]);
    let child = begun(&desk, "kept/here");
    wait_for(&desk.0.join("kept/here.partial/signals.rec"));
    // Somebody clears away while the run goes on.
    fs::remove_dir_all(desk.0.join("kept")).unwrap();
    send("-INT", &child);
    let answer = Answer::from(child.wait_with_output().unwrap());
    assert_eq!(answer.code, Some(4), "{answer:?}");
    says(
        &answer,
        &[
            "error[unwritable]: cannot write the results to `",
            "kept/here",
            "removed or renamed during the run",
            "= help: ",
        ],
    );
    // What was simulated is at least told.
    assert!(
        answer.out.contains("interrupted before its end") && !answer.out.contains("results "),
        "{answer:?}"
    );
    assert_eq!(names(&desk.0), ["long.ron"]);
}

#[test]
fn orders_to_stop_keep_what_was_recorded() {
    for signal in ["-INT", "-TERM"] {
        let desk = Desk::with(&[("long.ron", LONG)]);
        let child = begun(&desk, "kept");
        // Orders are taken before the folder is begun.
        wait_for(&desk.0.join("kept.partial"));
        send(signal, &child);
        let answer = Answer::from(child.wait_with_output().unwrap());
        assert_eq!(answer.code, Some(130), "{answer:?}");
        assert!(answer.out.contains("interrupted before its end"), "{answer:?}");
        assert!(desk.read("kept/manifest.json").contains("\"how\": \"interrupted\""));
        assert_eq!(names(&desk.0), ["kept", "long.ron"]);
    }
}

#[test]
fn what_a_run_that_was_killed_has_written_is_read_and_listed_and_not_overwritten() {
    let desk = Desk::with(&[("long.ron", LONG)]);
    let mut child = begun(&desk, "runs/a");
    let recording = desk.0.join("runs/a.partial/signals.rec");
    wait_for_rows(&recording);
    child.kill().unwrap();
    child.wait().unwrap();
    let written = fs::read(&recording).unwrap();
    let listed = desk.call(&["runs"]);
    assert!(listed.out.contains("unfinished") && listed.out.contains("long.ron"), "{listed:?}");
    let export = desk.call(&["export", "runs/a.partial", "--csv", "part.csv"]);
    assert_eq!(export.code, Some(0), "{export:?}");
    says(&export, &["its recording was not closed"]);
    assert!(desk.read("part.csv").lines().count() > 1);
    // It is no finished run.
    assert_eq!(desk.call(&["export", "latest", "--csv", "other.csv"]).code, Some(4));
    // The next run of this name leaves it as it is.
    let again = desk.call(&["run", "long.ron", "--until", "1000 s", "--out", "runs/a", "--quiet"]);
    assert_eq!(again.code, Some(0), "{again:?}");
    assert_eq!(
        (desk.names("runs"), fs::read(&recording).unwrap()),
        (vec!["a".to_owned(), "a.partial".to_owned()], written)
    );
}

#[cfg(target_os = "linux")]
#[test]
fn an_output_that_nobody_takes_does_not_cost_the_results() {
    let desk = Desk::with(&[("long.ron", LONG)]);
    let script = r#""$blocksim" run long.ron --until 1000s --out kept > /dev/full"#;
    let answer = Answer::from(desk.script(script).output().unwrap());
    assert_eq!(answer.code, Some(4), "{answer:?}");
    says(&answer, &["error: cannot write to the standard output: "]);
    assert!(desk.read("kept/manifest.json").contains("\"how\": \"complete\""));
}
