//! A few mutants of files of every kind, the same in every run; the program `mutants` of the tests tries thousands.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use blocksim_tests::mutants::{Desk, SLOW, subjects};

use crate::support::root;

#[test]
fn mutants_of_files_are_answered_without_a_panic() {
    let program = Path::new(env!("CARGO_BIN_EXE_blocksim"));
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("mutants-{}", std::process::id()));
    let mut all = subjects(&root().canonicalize().expect("the project"));
    all.retain(|subject| !SLOW.contains(&subject.kind));
    let desk = Desk::new(program, folder.clone(), &all).expect("a folder like that of the project");
    let (mut faults, mut kinds, mut refused) = (Vec::new(), BTreeSet::new(), 0);
    let (models, others): (Vec<_>, Vec<_>) =
        all.into_iter().partition(|subject| ["diagram", "move"].contains(&subject.kind));
    // A command that refuses the valid file reaches nothing with a damaged one.
    desk.try_valid(&others, |words, answer| {
        assert!(matches!(answer.code, Some(0 | 1)), "{words:?}: {}", answer.text)
    })
    .expect("the commands");
    for (seeds, subjects) in [(1_u64..61, models), (61..121, others)] {
        for seed in seeds {
            let subject = desk.try_seed(seed, &subjects, 3, |subject, words, answer, _| {
                refused += u32::from(answer.code != Some(0));
                if let Some(fault) = answer.fault() {
                    faults.push(format!(
                        "{fault}: seed {seed}, {}: {words:?}\n{}",
                        subject.file.display(),
                        answer.text
                    ));
                }
                Ok(())
            });
            kinds.insert(subject.expect("a mutant").kind);
        }
    }
    std::fs::remove_dir_all(folder).expect("to tidy up");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(kinds.len() > 10 && refused > 60, "{refused} commands refused mutants of {kinds:?}");
}
