use std::time::{Duration, UNIX_EPOCH};

use super::*;
use crate::csv::read_csv_file;
use crate::place::tests::Scratch;
use crate::recording::{Kind, Signal};

fn start() -> SystemTime {
    UNIX_EPOCH + Duration::from_secs(1_795_269_802)
}

fn recording() -> Recording {
    let mut recording = Recording::new(vec![Signal::new("arm.q1", "rad", Kind::Real)]);
    recording.push_row(0.0, &[0.1]).unwrap();
    recording
}

#[test]
fn a_run_appears_whole_under_its_name() {
    let scratch = Scratch::new();
    let run = RunFolder::create_at_time(&scratch.0, "pick", start()).unwrap();
    run.write_signals(&recording()).unwrap();
    run.write_events(&[EventRow { time: 0.0, path: "arm".into(), what: "start".into() }]).unwrap();
    run.write_log(&["one".into(), "two".into()]).unwrap();
    run.write_manifest(&crate::manifest::tests::example()).unwrap();
    assert_eq!(scratch.names(), ["2026-11-21T14-03-22_pick.partial"]);
    let path = run.finish().unwrap();
    assert_eq!(scratch.names(), ["2026-11-21T14-03-22_pick"]);
    assert_eq!(read_csv_file(&path.join("signals.csv")).unwrap(), recording());
    assert_eq!(fs::read_to_string(path.join("log.txt")).unwrap(), "one\ntwo\n");
    let events = fs::read_to_string(path.join("events.csv")).unwrap();
    assert_eq!(events, "time [s],path,what\n0,arm,start\n");
    let manifest = fs::read_to_string(path.join("manifest.json")).unwrap();
    assert_eq!(Manifest::from_json(&manifest).unwrap(), crate::manifest::tests::example());
}

#[test]
fn runs_of_the_same_second_are_numbered_and_none_is_overwritten() {
    let scratch = Scratch::new();
    let begin = || RunFolder::create_at_time(&scratch.0, "pick", start()).unwrap();
    begin().finish().unwrap();
    // Two at the same time, and a folder that appears while they run.
    let (second, third) = (begin(), begin());
    fs::create_dir(third.path()).unwrap();
    fs::write(third.path().join("mine"), "").unwrap();
    second.finish().unwrap();
    let renamed = third.finish().unwrap();
    assert_eq!(
        scratch.names(),
        [
            "2026-11-21T14-03-22_pick",
            "2026-11-21T14-03-22_pick-2",
            "2026-11-21T14-03-22_pick-3",
            "2026-11-21T14-03-22_pick-3-2",
        ]
    );
    assert!(renamed.ends_with("2026-11-21T14-03-22_pick-3-2"));
}

#[test]
fn a_folder_asked_for_by_name_must_be_empty() {
    let scratch = Scratch::new();
    let folder = scratch.0.join("out");
    RunFolder::create_exactly(&folder).unwrap().finish().unwrap();
    // Empty: taken as it is.
    let run = RunFolder::create_exactly(&folder).unwrap();
    run.write_log(&["kept".into()]).unwrap();
    assert_eq!(run.finish().unwrap(), fs::canonicalize(&folder).unwrap());
    // No longer empty: refused, untouched.
    let error = RunFolder::create_exactly(&folder).unwrap_err();
    assert_eq!(
        error.to_string(),
        format!(
            "cannot write a run into `{}`: it already holds files; choose another folder with --out, or move \
             the old run away; nothing is ever overwritten",
            folder.display()
        )
    );
    assert_eq!(fs::read_to_string(folder.join("log.txt")).unwrap(), "kept\n");
    assert_eq!(scratch.names(), ["out"]);
}

#[test]
fn a_folder_filled_during_the_run_is_not_overwritten_either() {
    let scratch = Scratch::new();
    let folder = scratch.0.join("out");
    let run = RunFolder::create_exactly(&folder).unwrap();
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("mine"), "mine").unwrap();
    assert!(matches!(run.finish(), Err(ResultsError::FolderInUse { .. })));
    assert_eq!(fs::read_to_string(folder.join("mine")).unwrap(), "mine");
    assert_eq!(scratch.names(), ["out"]);
}

#[test]
fn a_file_in_the_way_is_no_folder() {
    let scratch = Scratch::new();
    let file = scratch.0.join("file");
    fs::write(&file, "").unwrap();
    let error = RunFolder::create_exactly(&file).unwrap_err();
    assert_eq!(error.reason(), "part of the path is a file, not a folder");
    let error = RunFolder::create_exactly(&file.join("out")).unwrap_err();
    assert_eq!(error.reason(), "a file of this name is in the way");
    let error = RunFolder::create(&file, "x").unwrap_err();
    assert_eq!(error.place(), file);
    assert!(matches!(RunFolder::create_exactly(Path::new("/")), Err(ResultsError::FolderInUse { .. })));
    assert_eq!(fs::read(&file).unwrap(), b"");
}

#[test]
fn a_run_that_cannot_be_written_leaves_nothing() {
    let scratch = Scratch::new();
    let run = RunFolder::create_at_time(&scratch.0, "pick", start()).unwrap();
    run.write_log(&[]).unwrap();
    let error = run.write("signals.csv", |_| Err(io::ErrorKind::StorageFull.into())).unwrap_err();
    assert_eq!(error.reason(), "the disk is full");
    drop(run);
    assert_eq!(scratch.names(), [""; 0]);
}

#[test]
fn a_folder_that_is_gone_is_told_as_such() {
    let scratch = Scratch::new();
    let run = RunFolder::create_at_time(&scratch.0, "pick", start()).unwrap();
    fs::remove_dir(scratch.0.join("2026-11-21T14-03-22_pick.partial")).unwrap();
    let error = run.write_log(&[]).unwrap_err();
    assert_eq!(error.reason(), "its folder was removed or renamed during the run");
    assert!(error.remedy().contains("--out"));
}

#[test]
fn names_are_plain() {
    for (name, expected) in [
        ("pick", "pick"),
        ("../../etc/passwd", "etc-passwd"),
        ("Mein Modell ä", "Mein-Modell"),
        ("", "run"),
        ("...", "run"),
        ("a_b-c.ron", "a_b-c-ron"),
    ] {
        assert_eq!(sanitised(name), expected);
    }
    assert_eq!(sanitised(&"x".repeat(500)).len(), NAME_LENGTH);
}
