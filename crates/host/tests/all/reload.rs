//! A rebuilt library is another library; the one that runs stays as it is.

use std::time::{Duration, Instant};

use crate::common::{compile, fresh, load, set};
use blocksim_block::testing::Bench;

#[test]
fn a_rebuilt_library_gives_the_new_code_while_the_old_one_runs_on() {
    let folder = fresh("reload");
    compile(&folder, "lib.so", "table.c", &["FACTOR=2.0"]);
    let mut old = Bench::new(load(&folder, "lib.so", "Factor", set([])).unwrap());
    assert_eq!(old.respond(3.0), 6.0);

    // Overwritten in place, as `cp` does: the file that runs must not be this one.
    compile(&folder, "new.so", "table.c", &["FACTOR=5.0"]);
    std::thread::sleep(Duration::from_millis(20));
    std::fs::copy(folder.0.join("new.so"), folder.0.join("lib.so")).unwrap();
    let mut new = Bench::new(load(&folder, "lib.so", "Factor", set([])).unwrap());
    assert_eq!((old.respond(3.0), new.respond(3.0)), (6.0, 15.0));

    if cfg!(unix) {
        let prefix = format!("blocksim-{}-", std::process::id());
        let copies = || {
            let entries = std::fs::read_dir(std::env::temp_dir()).unwrap().flatten();
            entries.filter(|e| e.file_name().to_string_lossy().starts_with(&prefix)).collect::<Vec<_>>()
        };
        // Other tests of this process may be opening a library at this moment.
        let patience = Instant::now();
        while !copies().is_empty() && patience.elapsed() < Duration::from_secs(10) {
            std::thread::sleep(Duration::from_millis(5));
        }
        let left = copies();
        assert!(left.is_empty(), "{left:?}");
    }
}
