//! What is meant by what stands at the cursor.

use blocksim_diagram::{PanelWord, SIMULATION, Step};

use blocksim_syntax::{Open, is_word, scan};

/// What may stand at a place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Context<'a> {
    /// A section of a diagram: `blocks`.
    Section {
        /// Those that are there before.
        given: Vec<&'a str>,
    },
    /// A kind of block.
    Kind,
    /// A parameter of a block of this kind.
    Parameter {
        /// The kind.
        kind: &'a str,
        /// Those that are there before.
        given: Vec<&'a str>,
    },
    /// A setting of the simulation.
    Setting {
        /// Those that are there before.
        given: Vec<&'a str>,
    },
    /// Where a run begins.
    Start,
    /// What a steady start is to fulfil.
    Steady {
        /// What is there before.
        given: Vec<&'a str>,
    },
    /// A member of a named set inside of a block or of the settings.
    Member {
        /// The kind of the block, or [`SIMULATION`].
        kind: &'a str,
        /// Brackets from that of the block inwards.
        brackets: Vec<Step>,
        /// Members that are there before.
        given: Vec<&'a str>,
    },
    /// A value inside of a block or of the settings that is not a text, of which it may be that only some words are possible.
    Word {
        /// The kind of the block, or [`SIMULATION`].
        kind: &'a str,
        /// Brackets from that of the block inwards.
        brackets: Vec<Step>,
        /// The name before the value.
        key: &'a str,
    },
    /// The name of an alternative of a variant.
    Alternative {
        /// Those that are there before.
        given: Vec<&'a str>,
        /// Where the variant begins: the byte behind its bracket.
        before: &'a str,
    },
    /// A port of a block, within a connection; `before` is what stands between its quote and the place.
    Connection {
        /// From the quote to the place.
        before: &'a str,
    },
    /// An element of a panel.
    Panel,
    /// A member of an element of a panel.
    PanelMember {
        /// The element.
        word: PanelWord,
        /// Those that are there before.
        given: Vec<&'a str>,
    },
    /// The parameter or the signal that an element of a panel is about.
    PanelName {
        /// The element.
        word: PanelWord,
    },
    /// The name of a file, relative to that of the text.
    File,
    /// An expression, in which parameters of the diagram may occur.
    Expression,
    /// Nothing that is known of.
    Other,
}

/// What may stand at a place of a text.
pub fn context(text: &str, at: usize) -> Context<'_> {
    let before = &text[..at];
    let around = scan(text, at, |_, _| ());
    let Some(inner) = around.open.last() else { return Context::Other };
    if around.is_comment {
        return Context::Other;
    }
    let element = element(&around.open);
    if let Some(from) = around.quoted {
        if let Some(word) = element {
            let is_name = is_about(word, inner, around.key);
            return if is_name { Context::PanelName { word } } else { Context::Expression };
        }
        return match (inner.sign, inner.key, inner.word, around.key) {
            ('[', "connections", ..) => Context::Connection { before: &before[from..] },
            ('(', _, "File", _) | (.., "file" | "library") => Context::File,
            ('{', "of", ..) if around.key.is_empty() && is_of_blocks(&around.open) => {
                Context::Alternative { given: inner.keys.clone(), before }
            }
            ('(' | '[', ..) => Context::Expression,
            ('{', ..) if !around.key.is_empty() => Context::Expression,
            _ => Context::Other,
        };
    }
    match (inner.sign, inner.word, inner.key) {
        ('{', ..) if is_of_blocks(&around.open) && !around.key.is_empty() => Context::Kind,
        ('(', "Diagram", _) if around.key.is_empty() => Context::Section { given: inner.keys.clone() },
        ('(', "", "simulation") if around.key.is_empty() => Context::Setting { given: inner.keys.clone() },
        ('(', "", "simulation") if around.key == "start" => Context::Start,
        ('(', "Steady", "start") if around.key.is_empty() => Context::Steady { given: inner.keys.clone() },
        ('[', _, "panel") if around.open.len() == 2 => Context::Panel,
        _ => match element.filter(|_| around.key.is_empty()) {
            Some(word) => Context::PanelMember { word, given: inner.keys.clone() },
            None => within(&around.open, around.key),
        },
    }
}

/// The element of a panel that the innermost bracket belongs to.
fn element(open: &[Open]) -> Option<PanelWord> {
    let [.., outer, inner] = open else { return None };
    let is_panel = open.len() == 3 && outer.sign == '[' && outer.key == "panel";
    PanelWord::ALL.into_iter().find(|word| is_panel && word.name() == inner.word)
}

/// Whether a value names what an element is about, by its key or its position.
fn is_about(word: PanelWord, inner: &Open, key: &str) -> bool {
    if key.is_empty() { inner.commas == 0 } else { key == word.members()[0] }
}

/// What may stand in the innermost bracket, if it is one of a block or of the settings.
fn within<'a>(open: &[Open<'a>], key: &'a str) -> Context<'a> {
    let of_block = (1..open.len()).rev().find(|&n| is_of_blocks(&open[..n]) && !open[n].word.is_empty());
    let of_settings =
        || (open.len() > 1 && open[0].word == "Diagram" && open[1].key == "simulation").then_some(1);
    let Some(first) = of_block.or_else(of_settings) else { return Context::Other };
    let kind = if of_block.is_some() { open[first].word } else { SIMULATION };
    let inner = &open[open.len() - 1];
    if inner.sign == '(' && key.is_empty() && first + 1 == open.len() {
        return Context::Parameter { kind, given: inner.keys.clone() };
    }
    let step = |open: &Open| Step { key: open.key.to_owned(), word: open.word.to_owned(), sign: open.sign };
    let brackets = open[first..].iter().map(step).collect();
    match (inner.sign, key) {
        ('(', "") => Context::Member { kind, brackets, given: inner.keys.clone() },
        ('[', _) => Context::Word { kind, brackets, key: "" },
        (_, "") => Context::Other,
        (_, key) => Context::Word { kind, brackets, key },
    }
}

/// Whether the values of the innermost bracket are blocks: those of a diagram, or the alternatives of a variant.
fn is_of_blocks(open: &[Open]) -> bool {
    match open {
        [.., outer, inner] => {
            outer.word == "Diagram" && inner.key == "blocks" || outer.word == "Variant" && inner.key == "of"
        }
        _ => false,
    }
}

/// Whether a sign belongs to a reference: `arm/base.r[0]`.
pub fn is_of_reference(sign: char) -> bool {
    is_word(sign) || "./[]".contains(sign)
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_syntax::run_at;

    /// The context at the sign `|`.
    fn at(text: &str) -> Context<'static> {
        let place = text.find('|').unwrap();
        let text: &'static str = Box::leak(text.replacen('|', "", 1).into_boxed_str());
        context(text, place)
    }

    #[test]
    fn what_may_stand_somewhere_follows_from_the_brackets_around() {
        assert_eq!(at("Diagram(title: \"a\", |"), Context::Section { given: vec!["title"] });
        assert_eq!(at("Diagram(blocks: {\"a\": |"), Context::Kind);
        assert_eq!(at("Diagram(blocks: {\"a\": Ga|in}"), Context::Kind);
        assert_eq!(at("Diagram(blocks: {\"m\": Variant(by: \"d\", of: {\"a\": |"), Context::Kind);
        assert_eq!(at("Diagram(blocks: {|"), Context::Other);
        let given = vec!["kp"];
        assert_eq!(at("Diagram(blocks: {\"a\": Pid(kp: 1, k|"), Context::Parameter { kind: "Pid", given });
        let step = |key: &str, word: &str| Step { key: key.to_owned(), word: word.to_owned(), sign: '(' };
        let brackets = vec![step("a", "Pid")];
        assert_eq!(
            at("Diagram(blocks: {\"a\": Pid(kp: |"),
            Context::Word { kind: "Pid", brackets, key: "kp" }
        );
        let brackets = vec![step("a", "Pid"), step("form", "Own")];
        let given = vec!["x"];
        let member = Context::Member { kind: "Pid", brackets, given };
        assert_eq!(at("Diagram(blocks: {\"a\": Pid(form: Own(x: 1, |"), member);
        let brackets = vec![step("simulation", "")];
        let word = Context::Word { kind: SIMULATION, brackets, key: "solver" };
        assert_eq!(at("Diagram(simulation: (solver: |"), word);
        let alternative = at("Diagram(blocks: {\"m\": Variant(choice: \"d\", of: {\"a\": Gain, \"|");
        assert!(matches!(alternative, Context::Alternative { given, .. } if given == ["a"]));
        assert_eq!(at("Diagram(blocks: {\"a\": Pid(kp: \"2*|"), Context::Expression);
        assert_eq!(at("Diagram(parameters: {\"k\": \"2*|"), Context::Expression);
        assert_eq!(at("Diagram(parameters: {\"k|"), Context::Other);
        assert_eq!(at("Diagram(connections: [\"a.y -> b.|"), Context::Connection { before: "a.y -> b." });
        assert_eq!(at("Diagram(parameters: {\"m\": File(\"../|"), Context::File);
        assert_eq!(at("Diagram(blocks: {\"a\": Subsystem(file: \"|"), Context::File);
        let given = vec!["stop_time"];
        assert_eq!(at("Diagram(simulation: (stop_time: 1, |"), Context::Setting { given });
        assert_eq!(at("Diagram(simulation: (start: |"), Context::Start);
        assert_eq!(at("Diagram(simulation: (start: Steady(ho|"), Context::Steady { given: Vec::new() });
        assert_eq!(at("Diagram(panel: [|"), Context::Panel);
        assert_eq!(at("Diagram(panel: [Sl|"), Context::Panel);
        let name = |word| Context::PanelName { word };
        assert_eq!(at("Diagram(panel: [Slider(\"pid.|"), name(PanelWord::Slider));
        assert_eq!(at("Diagram(panel: [Lamp(signal: \"a|"), name(PanelWord::Lamp));
        assert_eq!(at("Diagram(panel: [Knob(\"a.k\", \"0 .. 2*|"), Context::Expression);
        let given = vec!["target"];
        let member = Context::PanelMember { word: PanelWord::Switch, given };
        assert_eq!(at("Diagram(panel: [Switch(target: \"a.k\", |"), member);
        assert_eq!(at("Diagram( // |"), Context::Other);
        assert_eq!(at("|"), Context::Other);
    }

    #[test]
    fn a_reference_is_taken_whole() {
        let text = "\"a.y -> arm/base.r[0]\"";
        assert_eq!(&text[run_at(text, 12, is_of_reference)], "arm/base.r[0]");
        assert_eq!(&text[run_at(text, 1, is_of_reference)], "a.y");
        assert_eq!(run_at("", 0, is_of_reference), 0..0);
    }
}
