//! Mechanisms as text: a diagram and a file of parameters, as a person would write them.

mod diagram;
mod number;
mod parameters;

pub use diagram::diagram;
pub(crate) use diagram::line;
pub use parameters::{Provenance, parameters};
pub(crate) use parameters::{mass as mass_entries, place as place_entries};

/// Columns of a line.
const WIDTH: usize = 118;

/// `Kind(a, b)` on one line, or a line each where that is too long; `column` is where it starts.
fn call(head: &str, members: &[String], column: usize, indent: usize) -> String {
    let inline = format!("{head}({})", members.join(", "));
    if column + inline.len() <= WIDTH {
        return inline;
    }
    let space = " ".repeat(indent + 4);
    let lines: String = members.iter().map(|member| format!("{space}{member},\n")).collect();
    format!("{head}(\n{lines}{})", " ".repeat(indent))
}
