//! Which signals share a picture, and what their lines look like.

use std::collections::HashSet;
use std::ops::RangeInclusive;

use blocksim_analysis::{Interpolation, Series};
use blocksim_plot::{Figure, Line, Panel, Strip, Style, pairs, thinned};
use blocksim_results::format::{count, significant};
use blocksim_results::{Column, Kind};

use super::labels::label;
use crate::args::plot::Layout;
use crate::signals::naming::{fits, name_number, short_names};
use crate::signals::traces::Book;

/// Most lines in one picture.
const LINES: usize = 6;
/// Columns of a screen to which courses are thinned.
const SCREEN: usize = 1600;

/// Signals of one picture, as positions in the first book.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Its title.
    pub title: String,
    /// Unit that all share.
    pub unit: String,
    /// Positions of the signals.
    pub traces: Vec<usize>,
    /// Names of the signals in the legend.
    pub names: Vec<String>,
    /// Their names without what the diagram says for legends.
    pub ports: Vec<String>,
    /// The colour of each.
    pub colours: Vec<usize>,
    /// Whether the diagram says the title.
    pub is_labelled: bool,
    /// Set value and actual value, as positions in `traces`.
    pub pairs: Vec<(usize, usize)>,
}

/// The signals that fit one of the patterns; what scopes show without any.
///
/// # Errors
/// The first pattern that fits nothing.
pub fn chosen<'a>(book: &Book, patterns: &'a [String]) -> Result<Vec<usize>, &'a str> {
    let fitting = |pattern: &str| {
        let found: Vec<usize> =
            (0..book.traces.len()).filter(|&at| fits(&book.traces[at].path, pattern)).collect();
        found
    };
    if let Some(lost) = patterns.iter().find(|pattern| fitting(pattern).is_empty()) {
        return Err(lost);
    }
    if !patterns.is_empty() {
        let mut seen = HashSet::new();
        return Ok(patterns.iter().flat_map(|p| fitting(p)).filter(|&at| seen.insert(at)).collect());
    }
    // `record:` takes whole buses, `arm.signals.Joint1OutBus.Angle`; a scope has nothing behind its inputs.
    let of_scopes = |at: &usize| !book.traces[*at].port().contains('.');
    let shown: Vec<usize> = (0..book.traces.len()).filter(of_scopes).collect();
    Ok(if shown.is_empty() { (0..book.traces.len()).collect() } else { shown })
}

/// Groups signals for pictures, in the order of the first signal of each.
pub fn groups(book: &Book, chosen: &[usize], layout: Layout) -> Vec<Group> {
    let key = |at: usize| {
        let trace = &book.traces[at];
        let unit = trace.unit.to_string();
        match layout {
            Layout::Scopes => (trace.block().to_owned(), unit),
            Layout::Signals => (trace.path.clone(), unit),
            Layout::Units => (String::new(), unit),
        }
    };
    let mut keyed: Vec<((String, String), Vec<usize>)> = Vec::new();
    let mut place = std::collections::HashMap::new();
    for &at in chosen {
        let key = key(at);
        let n = *place.entry(key.clone()).or_insert_with(|| {
            keyed.push((key, Vec::new()));
            keyed.len() - 1
        });
        keyed[n].1.push(at);
    }
    let mut groups: Vec<Group> = Vec::new();
    for ((title, unit), traces) in keyed {
        for traces in traces.chunks(LINES) {
            let paths: Vec<&str> = traces.iter().map(|&at| book.traces[at].path.as_str()).collect();
            let names: Vec<String> = match layout {
                Layout::Scopes if !title.is_empty() => {
                    traces.iter().map(|&at| book.traces[at].port().to_owned()).collect()
                }
                Layout::Signals => vec![String::new(); paths.len()],
                _ => short_names(&paths).into_iter().map(str::to_owned).collect(),
            };
            let pairs = pairs(&names.iter().map(String::as_str).collect::<Vec<_>>());
            let traces = traces.to_vec();
            groups.push(Group {
                title: title.clone(),
                unit: unit.clone(),
                traces,
                ports: names.clone(),
                names,
                pairs,
                colours: Vec::new(),
                is_labelled: false,
            });
        }
    }
    if layout == Layout::Scopes {
        by_number(&mut groups);
    }
    entitle(&mut groups);
    for group in &mut groups {
        group.colours = colours(group);
    }
    if layout == Layout::Scopes {
        label(&mut groups, book);
    }
    groups
}

/// Puts neighbouring scopes of one subsystem that show numbered signals in the order of these numbers: axes 1 to 3
/// before axes 4 to 6.
fn by_number(groups: &mut [Group]) {
    let parent = |group: &Group| group.title.rsplit_once('/').map(|(parent, _)| parent.to_owned());
    let number = |group: &Group| group.names.first().and_then(|name| name_number(name));
    let mut from = 0;
    while from < groups.len() {
        let family = parent(&groups[from]);
        let length = groups[from..].iter().take_while(|group| parent(group) == family).count();
        let family = &mut groups[from..from + length];
        if family.iter().all(|group| number(group).is_some()) {
            family.sort_by_key(number);
        }
        from += length;
    }
}

/// Shortens titles to what distinguishes them; that a scope is called `scope` tells nothing.
fn entitle(groups: &mut [Group]) {
    let short: Vec<String> = {
        let titles: Vec<&str> =
            groups.iter().map(|group| group.title.strip_suffix("/scope").unwrap_or(&group.title)).collect();
        short_names(&titles).into_iter().map(str::to_owned).collect()
    };
    let is_distinct = short.iter().collect::<HashSet<_>>().len() == short.len();
    for (group, short) in groups.iter_mut().zip(short) {
        group.title = if is_distinct { short } else { std::mem::take(&mut group.title) };
    }
}

/// The values of a group.
pub struct Drawn {
    /// What it shows.
    pub group: Group,
    /// Values in the unit of the group, one column for each signal.
    pub columns: Vec<Column>,
    /// Whether the values of a signal hold until the next one.
    pub steps: Vec<bool>,
    /// The same signals of the other books, where they have them: book, position in the group, values.
    pub others: Vec<(usize, usize, Column)>,
}

/// Reads the values of a group from all books.
///
/// # Errors
/// What to tell the person at the keyboard.
pub fn read(group: Group, books: &[Book], range: &RangeInclusive<f64>) -> Result<Drawn, String> {
    let first = &books[0];
    let mut drawn = Drawn { columns: Vec::new(), steps: Vec::new(), others: Vec::new(), group };
    for (n, &at) in drawn.group.traces.iter().enumerate() {
        let trace = &first.traces[at];
        let mut column = first.picture(at, range)?;
        column.values.iter_mut().for_each(|value| *value = trace.unit.from_si(*value));
        drawn.columns.push(column);
        drawn.steps.push(trace.kind != Kind::Real);
        for (number, book) in books.iter().enumerate().skip(1) {
            let Some(there) = book.find(&trace.path) else { continue };
            let other = &book.traces[there];
            if other.has_unit && trace.has_unit && !other.unit.dimension.compatible(trace.unit.dimension) {
                return Err(format!(
                    "error: `{}` is in {} in `{}`, but in {} in `{}`\n  = help: say the unit, such as --map \
                     'COLUMN={}[unit]'",
                    trace.path, trace.unit, first.name, other.unit, book.name, trace.path
                ));
            }
            let mut column = book.picture(there, range)?;
            // Without a unit of its own a column is taken to be in the unit shown.
            if other.has_unit {
                column.values.iter_mut().for_each(|value| *value = trace.unit.from_si(*value));
            }
            drawn.others.push((number, n, column));
        }
    }
    Ok(drawn)
}

/// Whether two groups show the same values at ports of the same names.
pub fn is_same(a: &Drawn, b: &Drawn) -> bool {
    let same = |x: &Column, y: &Column| x.time == y.time && x.values == y.values;
    a.group.unit == b.group.unit
        && a.group.ports == b.group.ports
        && a.columns.iter().zip(&b.columns).all(|(x, y)| same(x, y))
}

/// The panel of a group; `names` are those of the books.
pub fn panel(drawn: &Drawn, books: &[Book], range: &RangeInclusive<f64>) -> Panel {
    let Drawn { group, columns, steps, others } = drawn;
    let colours = &group.colours;
    let is_set = |n: usize| group.pairs.iter().any(|pair| pair.0 == n);
    let courses = |column: &Column, step: bool| thinned(&column.time, &column.values, range, SCREEN, step);
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
        for line in lines.iter_mut().filter(|line| !line.name.is_empty() || columns.len() == 1) {
            line.name = format!("{} {}", line.name, books[0].name).trim().to_owned();
        }
    }
    let lone = columns.len() - group.pairs.len() == 1;
    for (book, n, column) in others {
        // Both runs were told to do the same.
        if is_set(*n) && agree(&columns[*n], column) {
            continue;
        }
        lines.push(Line {
            name: format!("{} {}", group.names[*n], books[*book].name).trim().to_owned(),
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
                let error = error(&columns[set], &columns[actual]);
                Line { colour: colours[actual], courses: courses(&error, false), ..Line::default() }
            })
            .collect();
        for (book, n, column) in others {
            let Some((set, _)) = group.pairs.iter().find(|pair| pair.1 == *n) else { continue };
            let own = others.iter().find(|(other, m, _)| other == book && m == set).map(|other| &other.2);
            let error = error(own.unwrap_or(&columns[*set]), column);
            let colour = if lone { colours[*n] + book } else { colours[*n] };
            strip.push(Line { colour, thin: true, courses: courses(&error, false), ..Line::default() });
        }
        Strip { name: "error".to_owned(), lines: strip }
    });
    let mut notes: Vec<String> =
        columns.iter().enumerate().filter_map(|(n, column)| note(&group.names[n], column)).collect();
    if columns.iter().all(|column| column.time.is_empty()) {
        notes = vec!["no values in this range".to_owned()];
    }
    Panel { title: group.title.clone(), unit: group.unit.clone(), lines, strip, notes }
}

/// Colours of the signals of a group. Joint 1 has the first one everywhere, so numbered signals take the colours of
/// their numbers, as do set and actual values in a scope with a number.
fn colours(group: &Group) -> Vec<usize> {
    let numbers: Option<Vec<usize>> = group.names.iter().map(|name| colour_of(name)).collect();
    if let Some(numbers) = numbers
        && numbers.iter().collect::<HashSet<_>>().len() == numbers.len()
    {
        return numbers;
    }
    if group.names.len() - group.pairs.len() == 1 {
        let colour = group.title.rsplit('/').find_map(colour_of).unwrap_or(0);
        return vec![colour; group.names.len()];
    }
    let mut colours: Vec<usize> = (0..group.names.len()).collect();
    for &(set, actual) in &group.pairs {
        colours[set] = colours[actual];
    }
    colours
}

fn colour_of(name: &str) -> Option<usize> {
    name_number(name).filter(|number| (1..=6).contains(number)).map(|number| number as usize - 1)
}

/// Set value less actual value, at the times of the actual one.
pub fn error(set: &Column, actual: &Column) -> Column {
    let values =
        at_times(set, &actual.time).into_iter().zip(&actual.values).map(|(set, actual)| set - actual);
    Column { values: values.collect(), time: actual.time.clone() }
}

/// The values of a signal at other times.
pub fn at_times(column: &Column, time: &[f64]) -> Vec<f64> {
    if column.time == time {
        return column.values.clone();
    }
    let series = Series::new(&column.time, &column.values);
    let covers = series.span().unwrap_or((f64::INFINITY, f64::NEG_INFINITY));
    let at = |&t: &f64| match series.at(t, Interpolation::Linear, 0.0) {
        Some((_, value)) if t >= covers.0 && t <= covers.1 => value,
        _ => f64::NAN,
    };
    time.iter().map(at).collect()
}

/// Whether two signals are the same to the eye, over the time that both have.
fn agree(a: &Column, b: &Column) -> bool {
    let size = a.values.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    let there = at_times(a, &b.time);
    there.iter().zip(&b.values).all(|(x, y)| x.is_nan() || (x - y).abs() <= 1e-3 * size)
}

/// How many values are not finite and since when.
fn note(name: &str, column: &Column) -> Option<String> {
    let first = column.values.iter().position(|value| !value.is_finite())?;
    let odd = column.values.iter().filter(|value| !value.is_finite()).count();
    let what = if column.values[first].is_nan() { "NaN" } else { "infinite" };
    let of = if name.is_empty() { String::new() } else { format!("{name}: ") };
    let at = significant(column.time[first], 5);
    Some(format!(
        "{of}{what} first at {at} s; {} of {} values are not finite",
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
    Figure { title, panels, columns, time, width: f64::from(width) }
}
