//! Blocks that come: beside another, or into a wire.

use std::collections::BTreeMap;
use std::path::PathBuf;

use blocksim_block::BlockInfo;
use blocksim_block::physical::Domain;
use blocksim_block::problem::{Problem, Severity};
use blocksim_diagram::{
    Content, Model, ModelBlock, PortKind, Reference, SIMULATION, SourceFile, Sources, Step, model, words,
};
use blocksim_syntax::{Name, Shape, read};

use crate::change::{Change, Draft};
use crate::complete::kind;
use crate::connect::section;
use crate::delete::wires;
use crate::ends::{End, written};
use crate::names::check_name;
use crate::project::{Level, Project, With, split};
use crate::refusal::Refusal;
use crate::text::{Entries, Splice, Wire, Wires, spliced};

/// A block that is to be added.
#[derive(Debug, Clone, Default)]
pub struct NewBlock<'n> {
    /// The diagram, by its path; empty for the top.
    pub level: &'n str,
    /// Its kind.
    pub kind: &'n str,
    /// Its name; nothing for the one that is proposed.
    pub name: &'n str,
    /// Parameters as they were typed. Those that are required and missing get the values that the page of the kind shows.
    pub parameters: &'n [(String, String)],
    /// The name of the block that it stands behind in the text; nothing for the last, or for the source of the wire.
    pub beside: &'n str,
    /// Ends of the wire that it is put into: the source, and the targets that it drives then; all of them if none are named. Of
    /// conserving ports the first stays on the one side with all that is joined to it, but for the others, which go to the other
    /// side. Nothing if it stands alone.
    pub into: &'n [String],
}

/// A required parameter of a kind, to be filled in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// Its unit; empty where that follows from use.
    pub unit: &'static str,
    /// What it is, Markdown.
    pub doc: &'static str,
    /// What the page of the kind shows for it, without quotes; empty where that means nothing in another diagram.
    pub example: String,
}

/// The required parameters of a kind; nothing if there is no such kind.
pub fn required(name: &str) -> Option<Vec<Field>> {
    let info = kind(name)?;
    let example = example(info);
    let needed = info.parameters.iter().filter(|parameter| parameter.default.is_none());
    let field = |parameter: &blocksim_block::ParameterInfo| Field {
        name: parameter.name,
        unit: parameter.unit,
        doc: parameter.doc,
        example: example.get(parameter.name).map(|text| typed(text)).unwrap_or_default(),
    };
    Some(needed.map(field).collect())
}

/// The values of the first example of a kind, as written.
fn example(info: &BlockInfo) -> BTreeMap<String, String> {
    // A file of the example is in no other folder.
    if info.category == "Hierarchy" {
        return BTreeMap::new();
    }
    let mut examples = info.examples().into_iter();
    let known = examples.find_map(|text| {
        let node = read(text).ok().filter(|node| node.word() == Some(info.kind))?;
        let members = node.members()?;
        Some(
            members
                .iter()
                .map(|(name, value)| (name.text.clone(), text[value.span.clone()].to_owned()))
                .collect(),
        )
    });
    known.unwrap_or_default()
}

/// A value without the quotes around it.
fn typed(text: &str) -> String {
    match read(text).map(|node| node.value) {
        Ok(Shape::Text(content)) if !content.contains(['"', '\\']) => content,
        _ => text.split_whitespace().collect::<Vec<_>>().join(" "),
    }
}

/// A value that was typed for a parameter, as it is written in a diagram.
fn as_written(kind: &str, parameter: &str, typed: &str) -> String {
    let typed = typed.trim();
    let quoted = || format!("\"{}\"", typed.replace('\\', "\\\\").replace('"', "\\\""));
    match read(typed).map(|node| node.value) {
        Ok(Shape::Word(word)) => {
            let step = Step { key: String::new(), word: kind.to_owned(), sign: '(' };
            if words(kind, &[step], parameter).contains(&word.as_str()) { typed.to_owned() } else { quoted() }
        }
        // `Auto(margin: 2)`, `[1, 2]`, `"2 m"`; `(a + b) / 2` and `2 m` are expressions.
        Ok(_) if kind != SIMULATION => typed.to_owned(),
        _ => quoted(),
    }
}

/// A name for a block of a kind that no block of a diagram has: `low_pass`, `low_pass2`.
pub(crate) fn proposed(kind: &str, model: &Model) -> String {
    let mut name = String::new();
    let signs: Vec<char> = kind.chars().collect();
    for (n, sign) in signs.iter().enumerate() {
        let begins = sign.is_uppercase() && n > 0 && !signs[n - 1].is_uppercase();
        if begins {
            name.push('_');
        }
        name.extend(sign.to_lowercase());
    }
    free(&name, |name| {
        model.block(name).is_some() || model.ast.inputs.iter().any(|(known, _)| known.text == name)
    })
}

/// The name, or the name with the first number behind it that is not taken.
pub(crate) fn free(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    if !is_taken(name) {
        return name.to_owned();
    }
    (2..).map(|n| format!("{name}{n}")).find(|name| !is_taken(name)).unwrap_or_default()
}

/// The name that a block of a kind would get in a diagram.
///
/// # Errors
/// There is no such diagram.
pub fn proposed_name(project: &Project, level: &str, kind: &str) -> Result<String, Refusal> {
    let opened = project.open()?;
    Ok(proposed(kind, opened.level(level)?.model))
}

/// Adds a block, with wires if it is put into one.
///
/// # Errors
/// There is no such kind, the name is taken, a parameter is missing or wrong, or the block does not fit into the wire.
pub fn add(project: &Project, new: &NewBlock) -> Result<Change, Refusal> {
    let info = kind(new.kind).ok_or_else(|| {
        Refusal::new(format!("there is no block kind `{}`", new.kind))
            .help("`blocksim blocks` lists all kinds")
    })?;
    let opened = project.open()?;
    let level = opened.level(new.level)?;
    project.may_change(&level)?;
    let name =
        if new.name.trim().is_empty() { proposed(new.kind, level.model) } else { new.name.trim().to_owned() };
    check_name(&name)?;
    if level.model.block(&name).is_some() {
        let free = free(&name, |name| level.model.block(name).is_some());
        return Err(
            Refusal::new(format!("there is a block `{name}` already")).help(format!("`{free}` is free"))
        );
    }
    let ends: Vec<End> = new.into.iter().map(|end| End::read(&level, end)).collect::<Result<_, _>>()?;
    let entry = format!("{}: {}", quoted_name(&level, &name), block(info, new)?);
    let placed = placed(&level, new, &ends, &entry)?;
    let path = level.file.path.clone();
    let alone = spliced(&level.file.text, placed.clone()).ok_or_else(strange)?;
    let texts = BTreeMap::from([(path.clone(), alone.clone())]);
    let added = look(project, &texts, &level, &name, &entry)?;
    let mut draft = Draft::default();
    let mut notes = Vec::new();
    match ends.split_first() {
        None => draft.put(path, &level.file.text, alone),
        Some((from, to)) => {
            let ports = Ports::of(&added);
            let mut splices = placed;
            splices.extend(into_wire(&level, &name, &ports, from, to)?);
            draft.put(path, &level.file.text, spliced(&level.file.text, splices).ok_or_else(strange)?);
        }
    }
    let open = open_ports(project, &draft, &level, &name);
    if !open.is_empty() {
        notes.push(format!("not connected yet: {}", open.join(", ")));
    }
    let place =
        if ends.is_empty() { String::new() } else { format!(" into the wire from `{}`", ends[0].shown()) };
    let mut change = draft.finish(format!("{} `{name}` added{place}", info.kind));
    change.notes = notes;
    change.block = Some(level.path_of(&name));
    Ok(change)
}

fn strange() -> Refusal {
    Refusal::new("the entries of this text meet in a strange way")
}

/// A name as the entries beside it have theirs: in quotes between braces.
pub(crate) fn quoted_name(level: &Level, name: &str) -> String {
    let blocks = level.section("blocks");
    let is_struct = blocks.is_some_and(|node| matches!(&node.value, Shape::Struct(..)));
    if is_struct { name.to_owned() } else { format!("\"{name}\"") }
}

/// The text of the block: `Gain(k: 2)`.
fn block(info: &BlockInfo, new: &NewBlock) -> Result<String, Refusal> {
    let example = example(info);
    let mut given: Vec<(String, String)> = Vec::new();
    for (name, value) in new.parameters.iter().filter(|(_, value)| !value.trim().is_empty()) {
        if !info.parameters.iter().any(|known| known.name == name) {
            let names: Vec<&str> = info.parameters.iter().map(|known| known.name).collect();
            return Err(Refusal::new(format!("`{}` has no parameter `{name}`", info.kind))
                .help(format!("its parameters are {}", names.join(", "))));
        }
        given.push((name.clone(), as_written(info.kind, name, value)));
    }
    for parameter in info.parameters.iter().filter(|parameter| parameter.default.is_none()) {
        if given.iter().any(|(name, _)| name == parameter.name) {
            continue;
        }
        let value = example.get(parameter.name).ok_or_else(|| {
            Refusal::new(format!("`{}` needs `{}`", info.kind, parameter.name)).help(parameter.doc.trim())
        })?;
        given.push((parameter.name.to_owned(), value.clone()));
    }
    // In the order in which the kind lists them.
    given.sort_by_key(|(name, _)| info.parameters.iter().position(|known| known.name == name));
    if given.is_empty() {
        return Ok(info.kind.to_owned());
    }
    let all: Vec<String> = given.iter().map(|(name, value)| format!("{name}: {value}")).collect();
    Ok(format!("{}({})", info.kind, all.join(", ")))
}

/// The changes that put the entry behind the block that it belongs to.
fn placed(level: &Level, new: &NewBlock, ends: &[End], entry: &str) -> Result<Vec<Splice>, Refusal> {
    let source = match ends.first() {
        Some(End::Block { block, .. }) => Some(block.as_str()),
        _ => None,
    };
    let beside = if new.beside.is_empty() { source } else { Some(split(new.beside).1) };
    if let Some(beside) = beside {
        level.block(beside)?;
    }
    let Some(node) = level.section("blocks") else {
        return section(level, "blocks", '{', &[entry.to_owned()]);
    };
    let entries = Entries::of(&level.file.text, node).ok_or_else(strange)?;
    let blocks = &level.model.ast.blocks;
    let at = beside.and_then(|name| blocks.iter().position(|block| block.name.text == name));
    Ok(entries.with(at.or_else(|| entries.len().checked_sub(1)), &[entry.to_owned()]))
}

/// The new block as the compiler sees it alone.
fn look(
    project: &Project,
    texts: &BTreeMap<PathBuf, String>,
    level: &Level,
    name: &str,
    entry: &str,
) -> Result<ModelBlock, Refusal> {
    let reader = With { reader: project.reader, texts };
    let sources = Sources::new(&reader);
    let (top, problems) = model(&sources, project.model, &[]);
    let found = top.as_ref().and_then(|top| at(top, &level.model.path)?.block(name)).cloned();
    let files = sources.all();
    match found {
        Some(block) if !matches!(block.content, Content::Unknown) => Ok(block),
        _ => Err(wrong(&problems, &files, texts, entry)),
    }
}

/// The diagram at a path.
fn at<'m>(top: &'m Model, path: &str) -> Option<&'m Model> {
    let mut model = top;
    for name in path.split('/').filter(|name| !name.is_empty()) {
        let Content::Diagram(inside) = &model.block(name)?.content else { return None };
        model = inside;
    }
    Some(model)
}

/// Why a block cannot be built: the first error at its entry.
fn wrong(
    problems: &[Problem],
    files: &[SourceFile],
    texts: &BTreeMap<PathBuf, String>,
    entry: &str,
) -> Refusal {
    let is_at_entry = |problem: &&Problem| {
        problem.severity == Severity::Error
            && problem.labels.iter().any(|label| {
                let file = files.get(label.place.file.0 as usize);
                let text = file.and_then(|file| texts.get(&file.path));
                let start = text.and_then(|text| text.find(entry));
                start.is_some_and(|start| (start..start + entry.len()).contains(&label.place.span.start))
            })
    };
    match problems.iter().find(is_at_entry).or_else(|| problems.first()) {
        Some(problem) => Refusal::of(problem),
        None => Refusal::new("the block cannot be built"),
    }
}

/// Ports of a new block by what they are.
struct Ports {
    input: Option<String>,
    output: Option<String>,
    conserving: Vec<(String, Domain)>,
}

impl Ports {
    fn of(block: &ModelBlock) -> Ports {
        let with_default = |name: &String| match &block.content {
            Content::Block { interface, .. } => {
                interface.inputs.iter().any(|input| input.name == *name && input.default.is_some())
            }
            _ => false,
        };
        let inputs = block.inputs();
        let input = inputs.iter().find(|name| !with_default(name)).or(inputs.first()).cloned();
        let conserving = block.ports().into_iter().filter_map(|name| match block.port(&name) {
            Some(PortKind::Conserving(domain)) => Some((name, domain)),
            _ => None,
        });
        Ports { input, output: block.outputs().first().cloned(), conserving: conserving.collect() }
    }
}

/// The changes of the wires around a new block.
fn into_wire(
    level: &Level,
    name: &str,
    ports: &Ports,
    from: &End,
    to: &[End],
) -> Result<Vec<Splice>, Refusal> {
    let mut wires = wires(level)?;
    let mut splices = Vec::new();
    match from.kind(level)? {
        PortKind::Output => splices.extend(into_signal(level, &mut wires, name, ports, from, to)?),
        PortKind::Conserving(domain) => {
            splices.extend(into_node(level, &mut wires, name, ports, domain, from, to)?);
        }
        PortKind::Input | PortKind::Anything => {
            return Err(Refusal::new(format!("`{}` drives nothing", from.shown()))
                .help("a wire is named by the output that it comes from"));
        }
    }
    let (changes, new) = wires.finish();
    splices.extend(changes);
    if !new.is_empty() {
        splices.extend(section(level, "connections", '[', &new)?);
    }
    Ok(splices)
}

fn into_signal(
    level: &Level,
    wires: &mut Wires,
    name: &str,
    ports: &Ports,
    from: &End,
    to: &[End],
) -> Result<Vec<Splice>, Refusal> {
    let Some(source) = from.written() else { return Err(Refusal::new("there is no such wire")) };
    let Some(input) = &ports.input else {
        return Err(Refusal::new(format!("`{name}` has no input, so no wire can lead into it"))
            .help("add it beside a block"));
    };
    let input = format!("{name}.{input}");
    let all: Vec<usize> = (0..wires.len())
        .filter(|at| wires.wire(*at) == Wire::Signal && wires.ends(*at).first() == Some(&source.as_str()))
        .collect();
    let handed: Vec<_> =
        level.model.ast.outputs.iter().filter(|(_, reference)| written(reference) == source).collect();
    let is_driven = |end: &End| match end {
        End::Output(name) => handed.iter().any(|(known, _)| known.text == *name),
        end => end.written().is_some_and(|end| all.iter().any(|at| wires.ends(*at)[1..].contains(&&*end))),
    };
    if let Some(missing) = to.iter().find(|end| !is_driven(end)) {
        return Err(Refusal::new(format!("`{source}` does not drive `{}`", missing.shown())));
    }
    let Some(output) = &ports.output else {
        // It only looks.
        match all.last() {
            Some(at) => wires.append(*at, &input),
            None => wires.add(None, Wire::Signal, &[&source, &input]),
        }
        return Ok(Vec::new());
    };
    let output = format!("{name}.{output}");
    let is_chosen =
        |end: &str| to.is_empty() || to.iter().any(|known| known.written().as_deref() == Some(end));
    let mut moved: Vec<String> = Vec::new();
    let mut first = None;
    for at in all {
        let chosen: Vec<usize> =
            (1..).zip(&wires.ends(at)[1..]).filter(|(_, end)| is_chosen(end)).map(|(n, _)| n).collect();
        let Some((&place, others)) = chosen.split_first() else { continue };
        // A connection that goes on with the signal of the new block alone stays where it is, with its comment.
        if first.is_some() && chosen.len() + 1 == wires.ends(at).len() {
            wires.replace(at, 0, &output);
            continue;
        }
        moved.extend(chosen.iter().map(|n| wires.ends(at)[*n].to_owned()));
        if first.is_none() {
            wires.replace(at, place, &input);
            first = Some(at);
            wires.remove(at, |n, _| others.contains(&n));
        } else {
            wires.remove(at, |n, _| chosen.contains(&n));
        }
    }
    let is_named = |name: &str| to.iter().any(|end| *end == End::Output(name.to_owned()));
    let splices: Vec<Splice> = handed
        .iter()
        .filter(|(known, _)| to.is_empty() || is_named(&known.text))
        .map(|(_, reference)| Splice::new(reference.span.clone(), output.clone()))
        .collect();
    if moved.is_empty() && splices.is_empty() {
        return Err(Refusal::new(format!("`{source}` drives nothing"))
            .help("add the block beside another, then connect it"));
    }
    if first.is_none() {
        wires.add(None, Wire::Signal, &[&source, &input]);
    }
    if !moved.is_empty() {
        let mut ends = vec![output.as_str()];
        ends.extend(moved.iter().map(String::as_str));
        wires.add(first, Wire::Signal, &ends);
    }
    Ok(splices)
}

/// What a conserving end belongs to: all ends that connections join to it, and the ports that hand one of them outward.
struct Node<'l> {
    ends: Vec<String>,
    outward: Vec<&'l (Name, Reference)>,
}

impl<'l> Node<'l> {
    fn of(level: &Level<'l>, wires: &Wires, end: &End) -> Node<'l> {
        let ports = &level.model.ast.ports;
        let first = match end {
            End::Port(name) => ports.iter().find(|(known, _)| known.text == *name).map(|(_, at)| written(at)),
            end => end.written(),
        };
        let ends = first.map_or(Vec::new(), |first| wires.joined(&first));
        let outward = ports.iter().filter(|(_, reference)| ends.contains(&written(reference))).collect();
        Node { ends, outward }
    }

    fn has(&self, end: &End) -> bool {
        match end {
            End::Port(name) => self.outward.iter().any(|(known, _)| known.text == *name),
            end => end.written().is_some_and(|end| self.ends.contains(&end)),
        }
    }

    /// Splits it in two: some ends go to a new one on the far side, all others stay with one on the near side. The changes of what
    /// the diagram hands outward.
    fn split(&self, wires: &mut Wires, near: &str, far: &str, to: &[End]) -> Vec<Splice> {
        let moved: Vec<String> = to.iter().filter_map(End::written).collect();
        let stays = self.ends.iter().find(|end| !moved.contains(end)).map(String::as_str);
        let behind = wires.stand_in(&moved, near);
        // Where only what is handed outward goes, or stays, no connection is cut.
        if let (None, Some(stays)) = (behind, stays) {
            wires.hang(stays, near);
        }
        // Those that stay joined to each other need one of them only.
        let mut joined = vec![far];
        for end in &moved {
            if !joined[1..].iter().any(|known| wires.joined(known).contains(end)) {
                joined.push(end);
            }
        }
        if joined.len() > 1 {
            wires.add(behind, Wire::Conserving, &joined);
        }
        let outward = self.outward.iter().filter_map(|(port, reference)| {
            let goes = to.contains(&End::Port(port.text.clone()));
            let new = match (goes, moved.contains(&written(reference))) {
                (true, false) => far,
                (false, true) => stays.unwrap_or(near),
                _ => return None,
            };
            Some(Splice::new(reference.span.clone(), new))
        });
        outward.collect()
    }
}

/// Puts a new block between two parts of a node: what is named stands on its far side then, everything else on its near one.
fn into_node(
    level: &Level,
    wires: &mut Wires,
    name: &str,
    ports: &Ports,
    domain: Domain,
    from: &End,
    to: &[End],
) -> Result<Vec<Splice>, Refusal> {
    let fitting: Vec<String> = ports
        .conserving
        .iter()
        .filter(|(_, known)| *known == domain)
        .map(|(port, _)| format!("{name}.{port}"))
        .collect();
    let Some(near) = fitting.first() else {
        return Err(Refusal::new(format!("`{name}` has no {domain} port"))
            .help("a connection joins ports of one kind"));
    };
    let node = Node::of(level, wires, from);
    if to.contains(from) {
        return Err(Refusal::new(format!("`{}` cannot be on both sides of `{name}`", from.shown()))
            .help("name a port that stays, then those that go to the other side"));
    }
    if let Some(missing) = to.iter().find(|end| !node.has(end)) {
        return Err(Refusal::new(format!("`{}` is not joined to `{}`", missing.shown(), from.shown()))
            .help("name ports of one connection, or add the block beside another, then connect it"));
    }
    match (fitting.get(1), to) {
        (Some(far), [_, ..]) => Ok(node.split(wires, near, far, to)),
        // It hangs on the connection.
        _ => {
            node.ends.first().into_iter().for_each(|end| wires.hang(end, near));
            Ok(Vec::new())
        }
    }
}

/// Ports of the new block that need a wire and have none.
fn open_ports(project: &Project, draft: &Draft, level: &Level, name: &str) -> Vec<String> {
    let texts = draft.texts();
    let reader = With { reader: project.reader, texts: &texts };
    let sources = Sources::new(&reader);
    let (top, _) = model(&sources, project.model, &[]);
    let Some(inside) = top.as_ref().and_then(|top| at(top, &level.model.path)) else { return Vec::new() };
    let Some(block) = inside.block(name) else { return Vec::new() };
    let used: Vec<String> = inside
        .ast
        .connections
        .iter()
        .flat_map(blocksim_diagram::ConnectionAst::references)
        .filter(|reference| reference.block == name)
        .map(|reference| reference.port.clone())
        .collect();
    let has_default = |port: &str| match &block.content {
        Content::Block { interface, .. } => {
            interface.inputs.iter().any(|input| input.name == port && input.default.is_some())
        }
        _ => false,
    };
    let inputs = block.inputs().into_iter().filter(|port| !has_default(port));
    let all = inputs.chain(block.ports()).filter(|port| !used.contains(port));
    all.map(|port| format!("`{name}.{port}`")).collect()
}
