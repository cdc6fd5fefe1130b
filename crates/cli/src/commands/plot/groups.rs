//! Which signals share a picture, and what it is called.

use std::collections::{HashMap, HashSet};

use blocksim_picture::{pairs, pretty_unit};

use crate::args::plot::Layout;
use crate::signals::headings::headings;
use crate::signals::naming::{distinct_names, fits, name_number, short_names};
use crate::signals::traces::{Book, Trace};

/// Most lines in one picture.
const LINES: usize = 6;

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
    /// What the signals are drawn over, if that is not time.
    pub over: Option<Over>,
}

/// Signals over which others are drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Over {
    /// Their name.
    pub name: String,
    /// Their unit.
    pub unit: String,
    /// Position of the signal for each of the group.
    pub traces: Vec<usize>,
}

impl Over {
    /// The name of the axis.
    pub fn heading(&self) -> String {
        if self.unit == "1" {
            self.name.clone()
        } else {
            format!("{} [{}]", self.name, pretty_unit(&self.unit))
        }
    }
}

/// The signal over which a scope shows another one.
fn over(book: &Book, at: usize) -> Option<usize> {
    book.find(book.traces[at].over.as_ref()?)
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
    let mut groups: Vec<Group> =
        keyed(book, chosen, layout).iter().map(|(key, traces)| group(book, key, traces, layout)).collect();
    match layout {
        Layout::Scopes => {
            by_number(&mut groups);
            label(&mut groups, book);
        }
        Layout::Signals => {
            let paths: Vec<&str> =
                groups.iter().map(|group| book.traces[group.traces[0]].path.as_str()).collect();
            let titles = distinct_names(&paths);
            groups.iter_mut().zip(titles).for_each(|(group, title)| group.title = title.to_owned());
        }
        Layout::Units => {}
    }
    groups
}

/// Signals of one scope (or whatever the layout says) and one unit, at most [`LINES`] of them, with the scope.
fn keyed<'a>(book: &'a Book, chosen: &[usize], layout: Layout) -> Vec<(&'a str, Vec<usize>)> {
    let key = |trace: &'a Trace| match layout {
        Layout::Scopes => trace.block(),
        Layout::Signals => &trace.path,
        Layout::Units => "",
    };
    let mut keyed: Vec<(&str, Vec<usize>)> = Vec::new();
    let mut place = HashMap::new();
    // What a picture is drawn over is seen in it.
    let axes: HashSet<usize> = match layout {
        Layout::Scopes => chosen.iter().filter_map(|&at| over(book, at)).collect(),
        _ => HashSet::new(),
    };
    for &at in chosen.iter().filter(|at| !axes.contains(at)) {
        let trace = &book.traces[at];
        let n = *place.entry((key(trace), trace.unit.to_string())).or_insert(keyed.len());
        if n == keyed.len() {
            keyed.push((key(trace), Vec::new()));
        }
        keyed[n].1.push(at);
    }
    let of_key = |(key, traces): (&'a str, Vec<usize>)| -> Vec<(&'a str, Vec<usize>)> {
        let ports: Vec<&str> = traces.iter().map(|&at| book.traces[at].port()).collect();
        let part = |places: Vec<usize>| (key, places.into_iter().map(|n| traces[n]).collect());
        parts(&ports).into_iter().map(part).collect()
    };
    keyed.into_iter().flat_map(of_key).collect()
}

/// Signals of these names in parts of at most [`LINES`], as positions in their order; a set value and what follows it stay
/// together.
fn parts(names: &[&str]) -> Vec<Vec<usize>> {
    let pairs = pairs(names);
    let of_pair = |n: usize| pairs.iter().find(|pair| pair.0 == n || pair.1 == n);
    let mut parts: Vec<Vec<usize>> = Vec::new();
    for n in 0..names.len() {
        let family = match of_pair(n) {
            // It came with the first of both.
            Some(&(set, actual)) if set.min(actual) < n => continue,
            Some(&(set, actual)) => vec![set, actual],
            None => vec![n],
        };
        match parts.last_mut() {
            Some(part) if part.len() + family.len() <= LINES => part.extend(family),
            _ => parts.push(family),
        }
    }
    parts.iter_mut().for_each(|part| part.sort_unstable());
    parts
}

fn group(book: &Book, key: &str, traces: &[usize], layout: Layout) -> Group {
    let paths: Vec<&str> = traces.iter().map(|&at| book.traces[at].path.as_str()).collect();
    let names: Vec<String> = match layout {
        Layout::Scopes if !key.is_empty() => {
            traces.iter().map(|&at| book.traces[at].port().to_owned()).collect()
        }
        Layout::Signals => vec![String::new(); paths.len()],
        _ => short_names(&paths).into_iter().map(str::to_owned).collect(),
    };
    let over: Option<Vec<usize>> = traces.iter().map(|&at| over(book, at)).collect();
    let over = over.filter(|_| layout == Layout::Scopes).map(|traces| {
        let axis = &book.traces[traces[0]];
        Over { name: axis.port().to_owned(), unit: axis.unit.to_string(), traces }
    });
    let pairs = match over {
        Some(_) => Vec::new(),
        None => pairs(&names.iter().map(String::as_str).collect::<Vec<_>>()),
    };
    Group {
        title: key.to_owned(),
        unit: book.traces[traces[0]].unit.to_string(),
        traces: traces.to_vec(),
        colours: colours(key, &names, &pairs),
        ports: names.clone(),
        names,
        pairs,
        is_labelled: false,
        over,
    }
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

/// Puts the labels of scopes, or the ends of their paths, in place of paths, and legends in place of the names of ports.
fn label(groups: &mut [Group], book: &Book) {
    let first = |group: &Group| &book.traces[group.traces[0]];
    let scopes: Vec<(&str, &[String])> =
        groups.iter().map(|group| (first(group).block(), first(group).title.as_slice())).collect();
    let titles = headings(&scopes);
    for (group, title) in groups.iter_mut().zip(titles) {
        group.is_labelled = !book.traces[group.traces[0]].title.is_empty();
        group.title = title;
        for (name, &at) in group.names.iter_mut().zip(&group.traces) {
            *name = book.traces[at].legend.clone().unwrap_or(std::mem::take(name));
        }
    }
}

/// Colours of the signals of a scope. Joint 1 has the first one everywhere, so numbered signals take the colours of
/// their numbers, as do set and actual values in a scope with a number.
fn colours(path: &str, names: &[String], pairs: &[(usize, usize)]) -> Vec<usize> {
    let numbers: Option<Vec<usize>> = names.iter().map(|name| colour_of(name)).collect();
    if let Some(numbers) = numbers
        && numbers.iter().collect::<HashSet<_>>().len() == numbers.len()
    {
        return numbers;
    }
    if names.len() - pairs.len() == 1 {
        let colour = path.rsplit('/').find_map(colour_of).unwrap_or(0);
        return vec![colour; names.len()];
    }
    let mut colours: Vec<usize> = (0..names.len()).collect();
    for &(set, actual) in pairs {
        colours[set] = colours[actual];
    }
    colours
}

fn colour_of(name: &str) -> Option<usize> {
    name_number(name).filter(|number| (1..=6).contains(number)).map(|number| number as usize - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_of_long_vectors_keep_set_and_actual_values_together() {
        for length in [1, 3, 4, 7, 13] {
            let names = |port: &str| (0..length).map(|k| format!("{port}[{k}]")).collect::<Vec<_>>();
            let names = [names("set"), names("actual"), vec!["other".to_owned()]].concat();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let parts = parts(&names);
            let found: usize = parts
                .iter()
                .map(|part| pairs(&part.iter().map(|&n| names[n]).collect::<Vec<_>>()).len())
                .sum();
            assert_eq!(found, length, "{parts:?}");
            let mut all: Vec<usize> = parts.concat();
            all.sort_unstable();
            assert_eq!(all, (0..names.len()).collect::<Vec<_>>());
            assert!(parts.iter().all(|part| part.len() <= LINES), "{parts:?}");
        }
    }

    #[test]
    fn signals_without_pairs_come_six_by_six() {
        let names: Vec<String> = (0..14).map(|k| format!("axis{k}")).collect();
        let sizes: Vec<usize> =
            parts(&names.iter().map(String::as_str).collect::<Vec<_>>()).iter().map(Vec::len).collect();
        assert_eq!(sizes, [6, 6, 2]);
    }
}
