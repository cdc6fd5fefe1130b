//! Pictures for the terminal.

use blocksim_terminal::{PlotOptions, Series};

use std::borrow::Cow;

use super::curves::{Drawn, error, going_on};
use super::groups::Over;
use crate::signals::traces::Book;
use crate::terminal::console::Console;

/// Most pictures.
const PLOTS: usize = 8;
/// Rows of a picture and of the error below it.
const ROWS: usize = 12;
const ERROR_ROWS: usize = 4;
/// Rows of a picture of one signal over another.
const PLANE_ROWS: usize = 20;

/// The pictures, and how many are left out.
pub fn plots(all: &[Drawn], books: &[Book], console: Console) -> String {
    let drawn = all.iter().take(PLOTS).map(|drawn| plot(drawn, books, console));
    let mut text = drawn.collect::<Vec<_>>().join("\n");
    if all.len() > PLOTS {
        let titles: Vec<&str> = all[PLOTS..].iter().map(|drawn| drawn.group.title.as_str()).collect();
        text.push_str(&format!("\nnot drawn, name them to see them: {}\n", titles.join(", ")));
    }
    text
}

fn plot(drawn: &Drawn, books: &[Book], console: Console) -> String {
    let Drawn { group, columns, steps, others, .. } = drawn;
    let mut names = group.names.clone();
    names.extend(others.iter().map(|(book, n, _)| format!("{} {}", group.names[*n], books[*book].label)));
    let all = columns.iter().zip(steps).chain(others.iter().map(|(_, n, column)| (column, &steps[*n])));
    let shown = |column| match group.over {
        Some(_) => Cow::Borrowed(column),
        None => going_on(column, &group.unit),
    };
    let lines: Vec<_> = all.map(|(column, step)| (shown(column), *step)).collect();
    let series: Vec<Series> = lines
        .iter()
        .zip(&names)
        .map(|((line, step), name)| Series { name: name.trim(), x: &line.time, y: &line.values, step: *step })
        .collect();
    let title = match (group.title.as_str(), group.unit.as_str()) {
        (title, "1") => title.to_owned(),
        ("", unit) => format!("[{unit}]"),
        (title, unit) => format!("{title} [{unit}]"),
    };
    let (width, ascii) = (console.width, console.ascii);
    let across = group.over.as_ref().map_or_else(|| "time [s]".to_owned(), Over::heading);
    let height = if group.over.is_some() { PLANE_ROWS } else { ROWS };
    let options =
        PlotOptions { title: &title, x_label: &across, width, height, ascii, ..PlotOptions::default() };
    let mut text = blocksim_terminal::plot(&series, &options);
    let errors: Vec<_> = group
        .pairs
        .iter()
        .map(|&(set, actual)| error(&columns[set], &columns[actual], &group.unit))
        .collect();
    let series: Vec<Series> = errors
        .iter()
        .map(|error| Series { name: "error", x: &error.time, y: &error.values, step: false })
        .collect();
    // What is not finite has been told above.
    if series.iter().any(|s| s.y.iter().any(|y| y.is_finite())) {
        let finite = PlotOptions { title: "", height: ERROR_ROWS, ..options };
        text.push_str(&blocksim_terminal::plot(&series, &finite));
    }
    text
}
