//! Mechanisms as text: a diagram and a file of parameters, as a person would write them.

mod diagram;
mod number;
mod parameters;
mod robot;

pub(crate) use diagram::line;
pub use diagram::{Files, diagram};
pub(crate) use number::short;
pub use parameters::{Provenance, parameters};
pub(crate) use parameters::{coordinates as start_entries, mass as mass_entries, place as place_entries};
pub use robot::robot;

/// Columns of a line.
const WIDTH: usize = 118;

/// `Kind(a, b)` on one line, or a line each where that is too long; `column` is where it starts.
fn call(head: &str, members: &[String], column: usize, indent: usize) -> String {
    between([&format!("{head}("), ")"], members, column, indent)
}

/// The same between other brackets.
fn between([open, close]: [&str; 2], members: &[String], column: usize, indent: usize) -> String {
    let inline = format!("{open}{}{close}", members.join(", "));
    if column + inline.len() <= WIDTH {
        return inline;
    }
    let space = " ".repeat(indent + 4);
    let lines: String = members.iter().map(|member| format!("{space}{member},\n")).collect();
    format!("{open}\n{lines}{}{close}", " ".repeat(indent))
}
