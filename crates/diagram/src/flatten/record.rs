//! Signals that `record` asks for, by patterns of names.

use std::collections::{BTreeMap, BTreeSet};

use blocksim_block::problem::{Place, Problem};
use blocksim_signal::closest;

use super::view::{Asked, Tree, View};
use super::{Flat, Source};
use crate::ast::{PanelAst, PanelWord};
use crate::model::{Content, Model, ModelBlock};
use crate::problems::{Problems, mended};
use crate::settings::start::split_element;

/// Signals that `record` asks for at the top: outputs of blocks and elements of buses.
pub(super) fn record(
    model: &Model,
    also: &[(String, Place)],
    view: &View,
    found: &[(usize, &ModelBlock)],
    flat: &mut Flat,
    problems: &mut Problems,
) {
    let is_shown = |element: &&PanelAst| matches!(element.kind, PanelWord::Gauge | PanelWord::Lamp);
    let panel: Vec<&PanelAst> = model.ast.panel.iter().filter(is_shown).collect();
    if model.ast.record.is_empty() && also.is_empty() && panel.is_empty() {
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
    // What scopes show is recorded anyway; a pattern may still say its rate.
    let shown: Vec<String> = flat
        .blocks
        .iter()
        .filter(|block| block.interface.recorded.is_some())
        .flat_map(|block| block.interface.inputs.iter().map(|input| format!("{}.{}", block.path, input.name)))
        .collect();
    // Of a block that is no good nobody knows the signals.
    let all_known = !found.iter().any(|(_, block)| matches!(block.content, Content::Unknown));
    let mut seen: BTreeSet<&String> = BTreeSet::new();
    let of_text = model.ast.record.iter().flat_map(|entry| &entry.signals);
    let of_text = of_text.map(|pattern| (pattern.text.as_str(), model.ast.place(&pattern.span)));
    let of_others = also.iter().map(|(pattern, place)| (pattern.as_str(), place.clone()));
    for (pattern, place) in of_text.chain(of_others) {
        let matching: Vec<_> = candidates.iter().filter(|(name, _)| matches(pattern, name)).collect();
        let path = pattern.split('.').next().unwrap_or_default();
        let told = problems.names(path.rsplit('/').next().unwrap_or_default());
        if all_known && !told && matching.is_empty() && !shown.iter().any(|name| matches(pattern, name)) {
            let names: Vec<&str> = candidates.keys().chain(&shown).map(String::as_str).collect();
            problems.push(
                Problem::error("unknown_signal", format!("no signal matches `{pattern}`"))
                    .at(&place, "matches nothing")
                    .help(advice(pattern, &names)),
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
    // What the panel shows is recorded as well.
    for (name, span) in panel.iter().filter_map(|element| element.about()) {
        let place = model.ast.place(span);
        let (signal, _) = split_element(name);
        if shown.iter().any(|known| known == signal) {
            continue;
        }
        match candidates.get_key_value(signal) {
            Some((known, _)) if !seen.insert(known) => {}
            Some((known, (block, output))) => {
                let source = Source { block: *block, output: *output, target: place.clone(), place };
                flat.recorded.push((known.clone(), source));
            }
            // Several of them are explained where the elements are known.
            None if candidates
                .keys()
                .any(|known| known.strip_prefix(signal).is_some_and(|rest| rest.starts_with('.'))) => {}
            None if !all_known || problems.names(signal.split(['.', '/']).next().unwrap_or_default()) => {}
            None => {
                let names: Vec<&str> = candidates.keys().chain(&shown).map(String::as_str).collect();
                let problem = Problem::error("unknown_signal", format!("there is no signal `{name}`"));
                let problem = mended(problem, place.clone(), name, names.iter().copied());
                problems.push(problem.at(&place, "names no signal").help(match closest(name, names) {
                    Some(meant) => format!("did you mean `{meant}`?"),
                    None => "name an output, block and port, such as `motor.w`".to_owned(),
                }));
            }
        }
    }
}

/// What may have been meant by a pattern that matches nothing: a wider one, or a name that is spelt much like it.
fn advice(pattern: &str, names: &[&str]) -> String {
    let fits = |pattern: &str| names.iter().any(|name| matches(pattern, name));
    let across = pattern.replace("**", "*").replace('*', "**");
    let below = format!("{}/**", pattern.trim_end_matches('/'));
    let ports = format!("{pattern}.*");
    let within = format!("**{}**", pattern.trim_matches('*'));
    let wider = [across, ports, below, within].into_iter().find(|wider| wider != "****" && fits(wider));
    match wider.or_else(|| closest(pattern, names.iter().copied()).map(str::to_owned)) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => {
            "`*` stands for any part of a name, `**` for any number of subsystems: `arm/**.Angle`".to_owned()
        }
    }
}

/// Gives a name to each signal of a bus.
pub(super) fn name_leaves(name: &str, tree: &Tree, out: &mut BTreeMap<String, (usize, usize)>) {
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
pub(crate) fn matches(pattern: &str, name: &str) -> bool {
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
    use super::{advice, matches};

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
    fn a_pattern_that_is_too_narrow_is_widened() {
        let names = ["arm/base/joint.q", "control.y", "arm/out.y.Angle"];
        let meant = |pattern: &str| advice(pattern, &names).replace("did you mean `", "").replace("`?", "");
        assert_eq!(meant("arm/*.q"), "arm/**.q");
        assert_eq!(meant("control"), "control.*");
        assert_eq!(meant("arm"), "arm/**");
        assert_eq!(meant("joint"), "**joint**");
        assert_eq!(meant("contrl.y"), "control.y");
        assert!(advice("leg/*", &names).starts_with("`*` stands for") && advice("", &[]).starts_with("`*`"));
    }

    #[test]
    fn a_pattern_of_many_stars_takes_no_time() {
        assert!(!matches(&format!("{}b", "**a".repeat(100)), &"a".repeat(200)));
    }
}
