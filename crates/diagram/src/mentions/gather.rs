//! From notes and texts to symbols and the places that name them.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::rc::Rc;

use blocksim_block::problem::{FileId, Place};
use foldhash::{HashMap, HashMapExt};

use super::{Event, Meaning, Mention, Mentions, Symbol};
use crate::ast::{Ast, ConnectionAst, Reference};
use crate::model::Model;
use crate::source::Sources;
use blocksim_syntax::Name;

/// A place as a key: file, start, end.
type At = (FileId, usize, usize);

fn at(place: &Place) -> At {
    (place.file, place.span.start, place.span.end)
}

pub(super) struct Gathered<'a> {
    sources: &'a Sources<'a>,
    asts: Vec<Rc<Ast>>,
    /// Diagrams and alternatives by the block that is one of them.
    insides: HashMap<At, Vec<Rc<Ast>>>,
    variants: HashMap<At, Vec<(Place, String)>>,
    symbols: Vec<Symbol>,
    /// Symbols by the place that declares them.
    declared: HashMap<At, usize>,
    /// Which symbol another one is the same as.
    same: Vec<usize>,
    mentions: BTreeMap<At, (BTreeSet<usize>, Option<String>)>,
    named: Vec<(Place, Place)>,
}

/// What a block is made of.
#[derive(Default)]
pub(super) struct Inside {
    /// Diagrams, one of each file.
    asts: Vec<Rc<Ast>>,
    /// Kinds of the library.
    kinds: Vec<String>,
}

impl<'a> Gathered<'a> {
    pub(super) fn new(sources: &'a Sources<'a>, events: Vec<Event>, top: &Model) -> Self {
        let mut gathered = Self {
            sources,
            asts: vec![top.ast.clone()],
            insides: HashMap::new(),
            variants: HashMap::new(),
            symbols: Vec::new(),
            declared: HashMap::new(),
            same: Vec::new(),
            mentions: BTreeMap::new(),
            named: Vec::new(),
        };
        for event in events {
            match event {
                Event::Named { place, declared } => gathered.named.push((place, declared)),
                Event::Inside { block, ast } => {
                    if !gathered.asts.iter().any(|known| known.file == ast.file) {
                        gathered.asts.push(ast.clone());
                    }
                    let inside = gathered.insides.entry(at(&block)).or_default();
                    if !inside.iter().any(|known| known.file == ast.file) {
                        inside.push(ast);
                    }
                }
                Event::Variant { block, alternatives } => {
                    gathered.variants.insert(at(&block), alternatives);
                }
            }
        }
        gathered
    }

    /// Declarations and names of all diagrams.
    pub(super) fn diagrams(&mut self) {
        for ast in self.asts.clone() {
            self.declarations(&ast);
        }
        for ast in self.asts.clone() {
            self.alternatives(&ast);
            let outside = ast.outputs.iter().chain(&ast.ports).map(|(_, reference)| reference);
            let inside = ast.connections.iter().flat_map(ConnectionAst::references);
            outside.chain(inside).for_each(|reference| self.reference(&ast, reference));
        }
        for (place, declared) in std::mem::take(&mut self.named) {
            let (Some(place), Some(declared)) = (self.bare(&place), self.bare(&declared)) else { continue };
            let Some(&symbol) = self.declared.get(&at(&declared)) else { continue };
            let name = self.symbols[symbol].name.clone();
            self.mention(&place, &name, symbol);
        }
    }

    /// A place without the quotes that may be around it.
    fn bare(&self, place: &Place) -> Option<Place> {
        let text = self.sources.file(place.file).text;
        let Range { start, end } = place.span;
        let quoted = text.get(start..end)?.strip_prefix('"').is_some_and(|rest| rest.ends_with('"'));
        let span = if quoted { start + 1..end - 1 } else { start..end };
        Some(Place { file: place.file, span })
    }

    fn declarations(&mut self, ast: &Ast) {
        let parameters = ast.parameters.iter().map(|(name, _)| (Meaning::Parameter, name));
        let blocks = ast.blocks.iter().map(|block| (Meaning::Block, &block.name));
        let inputs = ast.inputs.iter().map(|(name, _)| name);
        let outputs = ast.outputs.iter().chain(&ast.ports).map(|(name, _)| name);
        let ports = inputs.chain(outputs).map(|name| (Meaning::Port, name));
        for (meaning, Name { text, span }) in parameters.chain(blocks).chain(ports) {
            let Some(place) = self.bare(&ast.place(span)) else { continue };
            let symbol = self.symbols.len();
            // A name with signs that are written otherwise, `"\u{61}"`, is not for this.
            let fixed = (self.text(&place) != *text).then(|| format!("`{text}` is written with escapes"));
            self.symbols.push(Symbol { meaning, name: text.clone(), declared: vec![place.clone()], fixed });
            self.same.push(symbol);
            self.declared.insert(at(&place), symbol);
            self.mention(&place, text, symbol);
        }
    }

    fn text(&self, place: &Place) -> String {
        self.sources.file(place.file).text.get(place.span.clone()).unwrap_or_default().to_owned()
    }

    /// The alternatives of a variant have the same ports, so these are one thing in several files.
    fn alternatives(&mut self, ast: &Ast) {
        for block in &ast.blocks {
            let content = self.content(&ast.place(&block.name.span));
            let is_variant = block.kind.text == "Variant";
            let mut first: HashMap<String, usize> = HashMap::new();
            for inside in &content.asts {
                for (name, port) in self.ports(inside) {
                    if let (Some(kind), true) = (content.kinds.first(), is_variant) {
                        self.symbols[port].fixed = Some(format!(
                            "it is a port of {kind}, too, an alternative of `{}`, and the ports of that kind have their names",
                            block.name.text
                        ));
                    }
                    match first.get(&name) {
                        Some(&other) => self.merge(other, port),
                        None => drop(first.insert(name, port)),
                    }
                }
            }
        }
    }

    /// What a block is made of, given the place of its name.
    pub(super) fn content(&self, block: &Place) -> Inside {
        let mut content = Inside::default();
        let mut open = vec![block.clone()];
        while let Some(block) = open.pop() {
            for ast in self.insides.get(&at(&block)).into_iter().flatten() {
                if !content.asts.iter().any(|known| known.file == ast.file) {
                    content.asts.push(ast.clone());
                }
            }
            for (place, kind) in self.variants.get(&at(&block)).into_iter().flatten() {
                match kind.as_str() {
                    "Subsystem" | "Variant" => open.push(place.clone()),
                    kind => content.kinds.push(kind.to_owned()),
                }
            }
        }
        content
    }

    /// Names and symbols of the ports of a diagram.
    fn ports(&self, ast: &Ast) -> Vec<(String, usize)> {
        let names = ast.inputs.iter().map(|(name, _)| name);
        let names = names.chain(ast.outputs.iter().chain(&ast.ports).map(|(name, _)| name));
        let symbol = |name: &Name| {
            let place = self.bare(&ast.place(&name.span))?;
            Some((name.text.clone(), *self.declared.get(&at(&place))?))
        };
        names.filter_map(symbol).collect()
    }

    fn root(&self, mut symbol: usize) -> usize {
        while self.same[symbol] != symbol {
            symbol = self.same[symbol];
        }
        symbol
    }

    fn merge(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            let (keep, drop) = (a.min(b), a.max(b));
            self.same[drop] = keep;
            let Symbol { declared, fixed, .. } = self.symbols[drop].clone();
            self.symbols[keep].declared.extend(declared);
            self.symbols[keep].fixed = self.symbols[keep].fixed.take().or(fixed);
        }
    }

    /// A name of a text, if it stands there as it is.
    pub(super) fn mention(&mut self, place: &Place, name: &str, symbol: usize) {
        if self.text(place) == name {
            self.mentions.entry(at(place)).or_default().0.insert(symbol);
        }
    }

    /// A pattern that matches the name of a symbol.
    pub(super) fn pattern(&mut self, place: &Place, pattern: &str, symbol: usize) {
        if self.text(place) == pattern {
            let (symbols, kept) = self.mentions.entry(at(place)).or_default();
            symbols.insert(symbol);
            *kept = Some(pattern.to_owned());
        }
    }

    fn reference(&mut self, ast: &Ast, reference: &Reference) {
        let Reference { block, port, span, .. } = reference;
        let here =
            |start: usize, name: &str| ast.place(&(span.start + start..span.start + start + name.len()));
        let (at_block, at_port) = (here(0, block), here(block.len() + 1, port));
        if block == "in" {
            let Some((name, _)) = ast.inputs.iter().find(|(name, _)| name.text == *port) else { return };
            if let Some(symbol) = self.symbol(&ast.place(&name.span)) {
                self.mention(&at_port, port, symbol);
            }
            return;
        }
        let Some(meant) = ast.blocks.iter().find(|known| known.name.text == *block) else { return };
        let declared = ast.place(&meant.name.span);
        self.block(&at_block, &declared);
        self.port(&at_port, port, &declared);
    }

    /// The symbol that is declared at a place.
    pub(super) fn symbol(&self, declared: &Place) -> Option<usize> {
        self.declared.get(&at(&self.bare(declared)?)).copied()
    }

    /// A block is named; `declared` is the place of its name.
    pub(super) fn block(&mut self, place: &Place, declared: &Place) {
        if let Some(symbol) = self.symbol(declared) {
            let name = self.symbols[symbol].name.clone();
            self.mention(place, &name, symbol);
        }
    }

    /// A port of a block is named, which matters where the block is a diagram.
    pub(super) fn port(&mut self, place: &Place, port: &str, block: &Place) {
        for inside in self.content(block).asts {
            let known = self.ports(&inside).into_iter().find(|(name, _)| name == port);
            if let Some((_, symbol)) = known {
                self.mention(place, port, symbol);
            }
        }
    }

    /// A parameter of a block is named, which matters where the block is a diagram.
    pub(super) fn given(&mut self, place: &Place, parameter: &str, block: &Place) {
        for inside in self.content(block).asts {
            let known = inside.parameters.iter().find(|(name, _)| name.text == parameter);
            if let Some(symbol) = known.and_then(|(name, _)| self.symbol(&inside.place(&name.span))) {
                self.mention(place, parameter, symbol);
            }
        }
    }

    /// Symbols that are the same become one.
    pub(super) fn finish(self) -> Mentions {
        let mut number = HashMap::new();
        let mut symbols: Vec<Symbol> = Vec::new();
        for symbol in (0..self.symbols.len()).filter(|&symbol| self.root(symbol) == symbol) {
            number.insert(symbol, symbols.len());
            symbols.push(self.symbols[symbol].clone());
        }
        let one = |(&(file, start, end), (named, pattern)): (&At, &(BTreeSet<usize>, Option<String>))| {
            let named: BTreeSet<usize> = named.iter().map(|&symbol| number[&self.root(symbol)]).collect();
            Mention {
                place: Place { file, span: start..end },
                symbols: named.into_iter().collect(),
                pattern: pattern.clone(),
            }
        };
        let all = self.mentions.iter().map(one).collect();
        Mentions { symbols, all, ..Mentions::default() }
    }
}
