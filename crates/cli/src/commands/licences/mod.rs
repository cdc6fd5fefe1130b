//! `blocksim licences`: under which terms the program and its parts may be used and passed on.

use crate::exit::Exit;
use crate::failure::Outcome;
use crate::terminal::console::Console;

/// The project itself.
const OWN: [(&str, &str); 2] = [
    ("MIT", include_str!("../../../../../LICENSE-MIT")),
    ("Apache-2.0", include_str!("../../../../../LICENSE-APACHE")),
];

/// Files of other projects that are part of the program as they are.
const FILES: [(&str, &str); 2] = [
    ("uPlot, in pages of runs", include_str!("../../../../report/assets/uPlot.LICENSE")),
    ("DejaVu Sans, in pictures", include_str!("../../../../picture/assets/LICENSE.txt")),
];

/// Crates of other projects with their terms; a test of the program writes it from what `cargo` knows.
const CRATES: &str = include_str!("third_party.txt");

/// Prints the terms of the program, of the files and of the crates of others in it.
///
/// # Errors
/// If the standard output cannot be written.
pub fn licences(console: Console) -> Outcome {
    let part = |(name, text): &(&str, &str)| format!("{}\n\n{}\n\n", headline(name), text.trim_end());
    let mut all = "blocksim may be used under MIT or Apache-2.0, at your choice. It contains files and crates of others under the \
                   terms below.\n\n"
        .to_owned();
    all.extend(OWN.iter().map(|(name, text)| part(&(&format!("blocksim: {name}"), text))));
    all.extend(FILES.iter().map(part));
    all.push_str(CRATES);
    console.data(&all)?;
    Ok(Exit::Done)
}

fn headline(name: &str) -> String {
    format!("{name}\n{}", "-".repeat(name.chars().count()))
}
