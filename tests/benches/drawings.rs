//! How long the layout of a level takes: the slowest ones of all that ship. The budget is 50 ms for each.
//!
//! `cargo bench -p blocksim-tests --bench drawings`.

use std::hint::black_box;
use std::time::{Duration, Instant};

use blocksim_diagram::Sources;
use blocksim_drawing::all_levels;
use blocksim_layout::layout;
use blocksim_tests::{Desk, root};

#[expect(clippy::print_stdout, reason = "a benchmark shows its figures")]
fn main() {
    let desk = Desk::new();
    let folder = root().join("diagrams");
    let entries =
        std::fs::read_dir(&folder).expect("the diagrams").filter_map(|entry| Some(entry.ok()?.path()));
    let mut files: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|ending| ending == "ron")).collect();
    files.push(folder.join("irb2600/irb2600.ron"));
    let mut times: Vec<(Duration, String)> = Vec::new();
    for file in files {
        let sources = Sources::new(&desk);
        let (model, _) = blocksim_diagram::model(&sources, &file, &[]);
        for level in model.iter().flat_map(|model| all_levels(model, &sources)) {
            let fastest = (0..5).map(|_| {
                let start = Instant::now();
                black_box(layout(black_box(&level.graph)));
                start.elapsed()
            });
            let name = file.file_stem().unwrap_or_default().to_string_lossy();
            times.push((fastest.min().unwrap_or_default(), format!("{name} {}", level.path)));
        }
    }
    times.sort();
    println!("{} levels", times.len());
    let all: f64 = times.iter().map(|(time, _)| time.as_secs_f64()).sum();
    println!("time drawings/all {all:.4e} s");
    for (time, name) in times.iter().rev().take(10) {
        println!("{:8.2} ms  {name}", time.as_secs_f64() * 1e3);
    }
}
