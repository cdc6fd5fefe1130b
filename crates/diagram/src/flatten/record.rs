//! Signals that `record` asks for, by patterns of names.

use std::collections::BTreeMap;

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
            let mut asked = Asked { place, text: &output, variant: None, hops: 0 };
            if let Ok(tree) = view.tree(*level, &block.name, &output, &[], &mut asked) {
                name_leaves(&format!("{}.{output}", block.path), &tree, &mut candidates);
            }
        }
    }
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
            if flat.recorded.iter().all(|(known, _)| known != name) {
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

/// `*` stands for any text without `/` and `.`, `**` for any text.
fn matches(pattern: &str, name: &str) -> bool {
    fn go(pattern: &[u8], name: &[u8]) -> bool {
        match pattern {
            [] => name.is_empty(),
            [b'*', b'*', rest @ ..] => (0..=name.len()).any(|skip| go(rest, &name[skip..])),
            [b'*', rest @ ..] => (0..=name.len())
                .take_while(|skip| name[..*skip].iter().all(|c| *c != b'/' && *c != b'.'))
                .any(|skip| go(rest, &name[skip..])),
            [c, rest @ ..] => name.first() == Some(c) && go(rest, &name[1..]),
        }
    }
    pattern.len() < 256 && pattern.matches('*').count() < 12 && go(pattern.as_bytes(), name.as_bytes())
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
    }
}
