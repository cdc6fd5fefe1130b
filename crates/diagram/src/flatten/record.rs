//! Signals that `record` asks for, by patterns of names.

use std::collections::{BTreeMap, BTreeSet};

use blocksim_block::problem::Problem;

use super::view::{Asked, Tree, View};
use super::{Flat, Source};
use crate::model::{Model, ModelBlock};
use crate::problems::Problems;

/// Signals that `record` asks for at the top: outputs of blocks and elements of buses.
pub(super) fn record(
    model: &Model,
    view: &View,
    found: &[(usize, &ModelBlock)],
    flat: &mut Flat,
    problems: &mut Problems,
) {
    if model.ast.record.is_empty() {
        return;
    }
    let mut candidates: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for (level, block) in found {
        for output in block.outputs() {
            let place = block.place.clone();
            let mut asked = Asked::new(place, &output);
            if let Ok(tree) = view.tree(*level, &block.name, &output, &[], &mut asked) {
                name_leaves(&format!("{}.{output}", block.path), &tree, &mut candidates);
            }
        }
    }
    let mut seen: BTreeSet<&String> = BTreeSet::new();
    for pattern in &model.ast.record {
        let place = model.ast.place(&pattern.span);
        let matching: Vec<_> = candidates.iter().filter(|(name, _)| matches(&pattern.text, name)).collect();
        if matching.is_empty() {
            problems.push(
                Problem::error("unknown_signal", format!("no signal matches `{}`", pattern.text))
                    .at(&place, "matches nothing")
                    .help("`*` stands for any part of a name, `**` for any number of subsystems: `arm/**.Angle`"),
            );
        }
        for (name, (block, output)) in matching {
            if seen.insert(name) {
                let source =
                    Source { block: *block, output: *output, target: place.clone(), place: place.clone() };
                flat.recorded.push((name.clone(), source));
            }
        }
    }
}

fn name_leaves(name: &str, tree: &Tree, out: &mut BTreeMap<String, (usize, usize)>) {
    match tree {
        Tree::Leaf { block, output } => {
            out.insert(name.to_owned(), (*block, *output));
        }
        Tree::Bus(elements) => {
            for (element, tree) in elements {
                name_leaves(&format!("{name}.{element}"), tree, out);
            }
        }
        Tree::Unknown => {}
    }
}

/// `*` stands for any text without `/` and `.`, `**` for any text. Takes time in proportion to the product of the lengths,
/// whatever the pattern is.
fn matches(pattern: &str, name: &str) -> bool {
    let name = name.as_bytes();
    // Whether the pattern so far matches the first bytes of the name.
    let mut reached = vec![false; name.len() + 1];
    reached[0] = true;
    let mut rest = pattern.as_bytes();
    while let [first, after @ ..] = rest {
        let across = rest.starts_with(b"**");
        rest = if across { &after[1..] } else { after };
        if *first == b'*' {
            for (i, byte) in name.iter().enumerate() {
                reached[i + 1] |= reached[i] && (across || (*byte != b'/' && *byte != b'.'));
            }
        } else {
            for (i, byte) in name.iter().enumerate().rev() {
                reached[i + 1] = reached[i] && byte == first;
            }
            reached[0] = false;
        }
    }
    reached[name.len()]
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn patterns_match_within_and_across_levels() {
        assert!(matches("arm/**.Angle", "arm/base/out.y.Angle"));
        assert!(matches("arm/*/joint.q", "arm/base/joint.q"));
        assert!(!matches("arm/*.q", "arm/base/joint.q"));
        assert!(matches("**", "anything.y"));
        assert!(!matches("arm", "arm.y"));
        assert!(matches("*.y", "g.y") && matches("", "") && matches("g.y*", "g.y"));
        assert!(!matches("", "g") && !matches("g.y", "") && !matches("ag.y", "g.y"));
    }

    #[test]
    fn a_pattern_of_many_stars_takes_no_time() {
        assert!(!matches(&format!("{}b", "**a".repeat(100)), &"a".repeat(200)));
    }
}
