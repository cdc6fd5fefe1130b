//! What the lines of a picture look like.

use std::ops::RangeInclusive;

use blocksim_numbers::format::{count, significant};
use blocksim_picture::{Figure, Line, Panel, PlaneAxis, Strip, Style, thinned};
use blocksim_recording::Column;

use super::curves::{Drawn, agree, error, with_breaks};
use crate::signals::traces::Book;

/// Columns of a screen to which courses are thinned.
const SCREEN: usize = 1600;

/// The panel of a group; `names` are those of the books.
pub fn panel(drawn: &Drawn, books: &[Book], range: &RangeInclusive<f64>) -> Panel {
    let Drawn { group, columns, steps, others, over } = drawn;
    let in_plane = group.over.is_some();
    let colours = &group.colours;
    let is_set = |n: usize| group.pairs.iter().any(|pair| pair.0 == n);
    let courses = |column: &Column, step: bool| {
        if in_plane {
            return plane_courses(column);
        }
        let column = with_breaks(column, &group.unit);
        thinned(&column.time, &column.values, range, SCREEN, step)
    };
    let mut lines: Vec<Line> = (0..columns.len())
        .map(|n| Line {
            name: group.names[n].clone(),
            colour: colours[n],
            style: if is_set(n) { Style::Dashed } else { Style::Solid },
            thin: false,
            courses: courses(&columns[n], steps[n]),
        })
        .collect();
    let several = books.len() > 1;
    if several {
        // A set value that all have is drawn once, without the name of any.
        let is_own = |n: usize| {
            !is_set(n) || others.iter().any(|(_, m, column)| *m == n && !agree(&columns[n], column))
        };
        let lines = lines.iter_mut().enumerate().filter(|(n, _)| is_own(*n)).map(|(_, line)| line);
        for line in lines.filter(|line| !line.name.is_empty() || columns.len() == 1) {
            line.name = format!("{} {}", line.name, books[0].label).trim().to_owned();
        }
    }
    let lone = columns.len() - group.pairs.len() == 1;
    for (book, n, column) in others {
        // Both runs were told to do the same.
        if is_set(*n) && agree(&columns[*n], column) {
            continue;
        }
        lines.push(Line {
            name: format!("{} {}", group.names[*n], books[*book].label).trim().to_owned(),
            // Where there is one line only, a second run may have a colour of its own.
            colour: if lone { colours[*n] + book } else { colours[*n] },
            style: match (is_set(*n), books[*book].is_run) {
                (true, _) => Style::Dashed,
                (_, true) => Style::Solid,
                (_, false) => Style::Dotted,
            },
            thin: books[*book].is_run,
            courses: courses(column, steps[*n]),
        });
    }
    let strip = (!group.pairs.is_empty()).then(|| {
        let mut strip: Vec<Line> = group
            .pairs
            .iter()
            .map(|&(set, actual)| {
                let error = error(&columns[set], &columns[actual], &group.unit);
                Line { colour: colours[actual], courses: courses(&error, false), ..Line::default() }
            })
            .collect();
        for (book, n, column) in others {
            let Some((set, _)) = group.pairs.iter().find(|pair| pair.1 == *n) else { continue };
            let own = others.iter().find(|(other, m, _)| other == book && m == set).map(|other| &other.2);
            let error = error(own.unwrap_or(&columns[*set]), column, &group.unit);
            let colour = if lone { colours[*n] + book } else { colours[*n] };
            strip.push(Line { colour, thin: true, courses: courses(&error, false), ..Line::default() });
        }
        Strip { name: "error".to_owned(), lines: strip }
    });
    let mut notes: Vec<String> = columns
        .iter()
        .enumerate()
        .filter_map(|(n, column)| note(&group.names[n], column, in_plane))
        .collect();
    if columns.iter().all(|column| column.time.is_empty()) {
        notes = vec!["no values in this range".to_owned()];
    }
    let plane = group.over.as_ref().map(|axis| PlaneAxis {
        name: axis.heading(),
        equal: axis.unit == group.unit && is_round(over, columns),
    });
    Panel { title: group.title.clone(), unit: group.unit.clone(), lines, strip, plane, notes }
}

/// Widths of the values in both directions may differ by this factor, and lengths are still drawn the same in both.
const ROUND: f64 = 4.0;

/// Whether the values over which columns are drawn reach about as far as these do.
fn is_round(over: &[Vec<f64>], columns: &[Column]) -> bool {
    let width = |values: &mut dyn Iterator<Item = f64>| {
        let finite = values.filter(|value| value.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        high - low
    };
    let across = width(&mut over.iter().flatten().copied());
    let upwards = width(&mut columns.iter().flat_map(|column| &column.values).copied());
    across > 0.0 && (1.0 / ROUND..=ROUND).contains(&(upwards / across))
}

/// The curve of one signal over another, which stands where the times do, with gaps where either is not finite.
fn plane_courses(column: &Column) -> Vec<Vec<(f64, f64)>> {
    let points: Vec<(f64, f64)> = column.time.iter().copied().zip(column.values.iter().copied()).collect();
    let pieces = points.split(|(x, y)| !(x.is_finite() && y.is_finite()));
    pieces.filter(|piece| !piece.is_empty()).map(<[_]>::to_vec).collect()
}

/// How many values are not finite and since when.
fn note(name: &str, column: &Column, in_plane: bool) -> Option<String> {
    let first = column.values.iter().position(|value| !value.is_finite())?;
    let odd = column.values.iter().filter(|value| !value.is_finite()).count();
    let what = if column.values[first].is_nan() { "NaN" } else { "infinite" };
    let of = if name.is_empty() { String::new() } else { format!("{name}: ") };
    let first =
        if in_plane { String::new() } else { format!(" first at {} s", significant(column.time[first], 5)) };
    Some(format!(
        "{of}{what}{first}; {} of {} values are not finite",
        count(odd as u64),
        count(column.values.len() as u64)
    ))
}

/// All panels in a grid.
pub fn figure(
    panels: Vec<Panel>,
    title: String,
    time: (f64, f64),
    columns: Option<u8>,
    width: u32,
) -> Figure {
    let columns = columns.map_or(if panels.len() > 2 { 2 } else { 1 }, usize::from);
    Figure { title, panels, columns, time, width: f64::from(width), ..Figure::default() }
}
