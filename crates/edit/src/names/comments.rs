//! Comments that show how to `--set` something: `// Try it: --set gear.direction=Reversed`.

use blocksim_block::problem::Place;
use blocksim_diagram::{Content, Meaning, Mentions, Model, Reader, SourceFile, Sources, model};
use blocksim_syntax::Tokens;

use super::{Meant, Spot};

/// What stands before a target.
const SET: &str = "--set ";

/// Where the comments of the file of a model name what is meant.
pub(super) fn spots(reader: &dyn Reader, file: &SourceFile, meant: &Meant, names: &Mentions) -> Vec<Spot> {
    let text = &*file.text;
    if !text.contains(SET) {
        return Vec::new();
    }
    let sources = Sources::new(reader);
    let Some(top) = model(&sources, &file.path, &[]).0 else { return Vec::new() };
    let comments = Tokens::new(text).filter(|token| token.kind.is_comment());
    let mut found = Vec::new();
    for comment in comments {
        let inside = comment.of(text);
        for (at, _) in inside.match_indices(SET) {
            let behind = &inside[at + SET.len()..];
            let target = behind.trim_start_matches([' ', '"', '\'', '`']);
            let start = comment.start() + at + SET.len() + behind.len() - target.len();
            let target = &target[..target.find(|sign: char| !is_of_target(sign)).unwrap_or(target.len())];
            let named = named(&top, &sources, target, meant, names)
                .map(|(from, to)| (file.path.clone(), start + from, start + to));
            found.extend(named);
        }
    }
    found
}

fn is_of_target(sign: char) -> bool {
    sign.is_ascii_alphanumeric() || "_./[]".contains(sign)
}

/// The part of a target that names what is meant: `arm` of `arm/link3.drive`.
fn named(
    top: &Model,
    sources: &Sources,
    target: &str,
    meant: &Meant,
    names: &Mentions,
) -> Option<(usize, usize)> {
    let is_declared = |place: &Place| {
        let path = sources.file(place.file).path;
        // The place of a name has its quotes.
        let is_at = |(known, start, end): &Spot| {
            *known == path && place.span.start <= *start && *end <= place.span.end
        };
        meant.declared.iter().any(is_at)
    };
    let first = target.split(['/', '.', '[']).next()?;
    let parameter = top.ast.parameters.iter().find(|(name, _)| name.text == first);
    let may_be = !target.contains('/') && names.is_of_parameter(target);
    if let (Some((name, _)), true) = (parameter, may_be) {
        let is_it = meant.meaning == Meaning::Parameter && is_declared(&top.ast.place(&name.span));
        return is_it.then_some((0, first.len()));
    }
    if meant.meaning != Meaning::Block {
        return None;
    }
    let (mut level, mut at) = (top, 0);
    let blocks = &target[..target.find('.').unwrap_or(target.len())];
    for part in blocks.split('/') {
        let block = level.block(part)?;
        if is_declared(&block.place) {
            return Some((at, at + part.len()));
        }
        at += part.len() + 1;
        let Content::Diagram(inside) = &block.content else { return None };
        level = inside;
    }
    None
}
