//! Pictures bear the titles and legends that the diagram gives them.

use blocksim_results::titles;

use super::panels::{Drawn, Group, is_same};
use crate::signals::naming::short_names;
use crate::signals::traces::Book;

/// Puts the labels of scopes in place of titles made of paths, and legends in place of the names of ports. Where two scopes
/// have the same labels, what tells their paths apart stands behind them.
pub fn label(groups: &mut [Group], book: &Book) {
    let first = |group: &Group| &book.traces[group.traces[0]];
    let labels: Vec<&[String]> = groups.iter().map(|group| first(group).title.as_slice()).collect();
    let headings = titles(&labels);
    let blocks: Vec<&str> = groups.iter().map(|group| first(group).block()).collect();
    for n in 0..groups.len() {
        let legend = |&at: &usize| book.traces[at].legend.clone();
        for (name, legend) in groups[n].names.iter_mut().zip(groups[n].traces.iter().map(legend)) {
            *name = legend.unwrap_or(std::mem::take(name));
        }
        if headings[n].is_empty() {
            continue;
        }
        let mut alike: Vec<&str> =
            (0..groups.len()).filter(|&m| headings[m] == headings[n]).map(|m| blocks[m]).collect();
        alike.dedup();
        let own = alike.iter().position(|&block| block == blocks[n]);
        groups[n].title = match own {
            Some(own) if alike.len() > 1 => format!("{} ({})", headings[n], short_names(&alike)[own]),
            _ => headings[n].clone(),
        };
        groups[n].is_labelled = true;
    }
}

/// Adds what was read of a group, unless it is there: two scopes may show the same. Of these the one with labels stays.
pub fn add(all: &mut Vec<Drawn>, drawn: Drawn) {
    match all.iter_mut().find(|other| is_same(other, &drawn)) {
        Some(other) if drawn.group.is_labelled && !other.group.is_labelled => *other = drawn,
        Some(_) => {}
        None => all.push(drawn),
    }
}
