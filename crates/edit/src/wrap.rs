//! Blocks that become a subsystem of their own, in a file of its own.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use blocksim_diagram::{Sources, compile};

use crate::add::{free, quoted_name};
use crate::change::{Change, Draft};
use crate::delete::{names, other_spots, wires};
use crate::ends::written;
use crate::names::check_name;
use crate::project::{Level, Project, With, below, split};
use crate::refusal::Refusal;
use crate::rename::other_numbers;
use crate::text::{Entries, Splice, Wire, Wires, line_feed, spliced};

/// Names that a port of a subsystem cannot have, as its conditions have them.
const RESERVED: [&str; 5] = ["in", "out", "enable", "trigger", "reset"];

/// Puts blocks of one diagram into a new file beside it, and a subsystem that is made of it in their place. Its ports follow from
/// the wires that lead from them to others; paths that name the blocks get the new name before them. `name` is that of the
/// subsystem and of the file; nothing for a proposed one.
///
/// # Errors
/// A name is taken, or the model would be another one.
pub fn wrap(project: &Project, paths: &[String], name: &str) -> Result<Change, Refusal> {
    let Some(first) = paths.first() else { return Err(Refusal::new("no block is named")) };
    let opened = project.open()?;
    let level = opened.level(split(first).0)?;
    project.may_change(&level)?;
    let names = names(&level, paths)?;
    let (name, file) = named(project, &level, &names, name.trim())?;
    let mut border = Border::new(&names, &name);
    let mut wires = wires(&level)?;
    let inside = border.cross(&level, &mut wires);
    let blocks = Moved::of(&level, &names, &name, &file)?;
    let (mut splices, _) = wires.finish();
    splices.extend(blocks.splices);
    splices.extend(border.outward(&level));
    let mut draft = Draft::default();
    let others = other_spots(project, &level, &names, true);
    for (path, (text, spots)) in &others {
        let prefixed = spots.iter().map(|spot| Splice::new(spot.start..spot.start, format!("{name}/")));
        if *path == level.file.path {
            splices.extend(prefixed);
        } else if let Some(new) = spliced(text, prefixed.collect()) {
            draft.put(path.clone(), text, new);
        }
    }
    let new = spliced(&level.file.text, splices)
        .ok_or_else(|| Refusal::new("the entries of this text meet in a strange way"))?;
    draft.put(level.file.path.clone(), &level.file.text, new);
    let folder = level.file.path.parent().map(PathBuf::from).unwrap_or_default();
    let path = folder.join(&file);
    draft.create(path, border.text(&blocks.entries, &inside, line_feed(&level.file.text)));
    same_model(project, &draft, &level, &names, &name)?;
    let count =
        if names.len() == 1 { "1 block is".to_owned() } else { format!("{} blocks are", names.len()) };
    let mut change = draft.finish(format!("{count} in the subsystem `{name}` now, of `{file}`"));
    change.notes.extend(names.iter().filter_map(|name| other_numbers(level.model.block(name)?)));
    change.block = Some(level.path_of(&name));
    Ok(change)
}

/// Names of the subsystem and of its file that nothing else has.
fn named(
    project: &Project,
    level: &Level,
    names: &BTreeSet<String>,
    name: &str,
) -> Result<(String, String), Refusal> {
    // A block that moves frees its name.
    let is_block = |name: &str| level.model.block(name).is_some() && !names.contains(name);
    let folder = level.file.path.parent().map(PathBuf::from).unwrap_or_default();
    let is_file = |name: &str| project.reader.read(&folder.join(format!("{name}.ron"))).is_ok();
    let name = if name.is_empty() {
        free("subsystem", |name| is_block(name) || is_file(name))
    } else {
        check_name(name)?;
        if is_block(name) {
            return Err(Refusal::new(format!("there is a block `{name}` already")));
        }
        name.to_owned()
    };
    if is_file(&name) {
        return Err(Refusal::new(format!("there is a file `{name}.ron` beside this one already"))
            .help("choose another name, which becomes that of the file"));
    }
    let file = format!("{name}.ron");
    Ok((name, file))
}

/// What leads across the border of the new subsystem.
struct Border<'n> {
    names: &'n BTreeSet<String>,
    subsystem: &'n str,
    /// Names that ports have.
    taken: BTreeSet<String>,
    /// Sources outside and the inputs that they lead to.
    inputs: Vec<(String, String)>,
    /// Outputs of blocks inside, without elements, and the outputs that show them.
    outputs: Vec<(String, String)>,
    /// Conserving ports of blocks inside and the ports that hand them outward.
    ports: Vec<(String, String)>,
}

/// `arm.signals` of `arm.signals.Angle`, and `.Angle`.
fn without_elements(end: &str) -> (&str, &str) {
    match end.match_indices('.').nth(1) {
        Some((at, _)) => end.split_at(at),
        None => (end, ""),
    }
}

impl<'n> Border<'n> {
    fn new(names: &'n BTreeSet<String>, subsystem: &'n str) -> Border<'n> {
        Border {
            names,
            subsystem,
            taken: RESERVED.iter().map(|name| (*name).to_owned()).collect(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            ports: Vec::new(),
        }
    }

    fn is_inside(&self, end: &str) -> bool {
        self.names.contains(end.split('.').next().unwrap_or_default())
    }

    /// A name for a port that an end outside or inside leads to: `error` of `error.y`, `phi` of `encoder.phi`.
    fn port(&mut self, end: &str) -> String {
        let mut parts = end.split('.');
        let (block, port) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
        let last = parts.next_back().unwrap_or(port);
        let short = if ["y", "u"].contains(&last) && block != "in" { block } else { last };
        let taken = &self.taken;
        let name = match taken.contains(short) {
            false => short.to_owned(),
            true => free(&format!("{block}_{last}"), |name| taken.contains(name)),
        };
        self.taken.insert(name.clone());
        name
    }

    /// The input that a source outside leads to.
    fn input(&mut self, source: &str) -> String {
        if let Some((_, name)) = self.inputs.iter().find(|(known, _)| known == source) {
            return name.clone();
        }
        let name = self.port(source);
        self.inputs.push((source.to_owned(), name.clone()));
        name
    }

    /// The output that shows an output inside.
    fn output(&mut self, source: &str) -> String {
        let (source, _) = without_elements(source);
        if let Some((_, name)) = self.outputs.iter().find(|(known, _)| known == source) {
            return name.clone();
        }
        let name = self.port(source);
        self.outputs.push((source.to_owned(), name.clone()));
        name
    }

    /// The port that hands a conserving port inside outward.
    fn conserving(&mut self, end: &str) -> String {
        if let Some((_, name)) = self.ports.iter().find(|(known, _)| known == end) {
            return name.clone();
        }
        let name = self.port(end);
        self.ports.push((end.to_owned(), name.clone()));
        name
    }

    /// Leads the wires across the border; the connections that are inside then.
    fn cross(&mut self, level: &Level, wires: &mut Wires) -> Vec<String> {
        let mut inside: Vec<String> = Vec::new();
        let nets = nets(level, wires);
        for at in 0..wires.len() {
            let ends: Vec<String> = wires.ends(at).into_iter().map(str::to_owned).collect();
            match wires.wire(at) {
                Wire::Signal => self.signal(wires, at, &ends, &mut inside),
                Wire::Conserving => self.net(wires, at, &ends, &nets, &mut inside),
            }
        }
        // What is handed outward leads across as well, one that nothing else is joined to above all.
        for (_, reference) in &level.model.ast.ports {
            let end = written(reference);
            if self.is_inside(&end) {
                let port = representative(&nets, &end, |end| self.is_inside(end));
                self.conserving(&port);
            }
        }
        for (_, reference) in &level.model.ast.outputs {
            let end = written(reference);
            if self.is_inside(&end) {
                self.output(&end);
            }
        }
        inside
    }

    fn signal(&mut self, wires: &mut Wires, at: usize, ends: &[String], inside: &mut Vec<String>) {
        let Some((source, targets)) = ends.split_first() else { return };
        let within: Vec<&str> =
            targets.iter().map(String::as_str).filter(|target| self.is_inside(target)).collect();
        let subsystem = self.subsystem;
        match (self.is_inside(source), within.len()) {
            (false, 0) => {}
            (false, _) => {
                let known = self.inputs.iter().any(|(known, _)| known == source);
                let input = self.input(source);
                inside.push(format!("in.{input} -> {}", within.join(", ")));
                // A source leads to an input once, however many connections it has.
                let first = if known { usize::MAX } else { position(ends, |end| self.is_inside(end)) };
                if first < ends.len() {
                    wires.replace(at, first, &format!("{subsystem}.{input}"));
                }
                let gone: Vec<bool> = ends.iter().map(|end| self.is_inside(end)).collect();
                wires.remove(at, |n, _| gone.get(n) == Some(&true) && n != first);
            }
            (true, count) => {
                if count > 0 {
                    inside.push(format!("{source} -> {}", within.join(", ")));
                }
                if count == targets.len() {
                    wires.take(at);
                    return;
                }
                let output = self.output(source);
                let (_, elements) = without_elements(source);
                wires.replace(at, 0, &format!("{subsystem}.{output}{elements}"));
                let gone: Vec<bool> = ends.iter().map(|end| self.is_inside(end)).collect();
                wires.remove(at, |n, _| n > 0 && gone.get(n) == Some(&true));
            }
        }
    }

    fn net(&mut self, wires: &mut Wires, at: usize, ends: &[String], nets: &[Net], inside: &mut Vec<String>) {
        let within: Vec<&String> = ends.iter().filter(|end| self.is_inside(end)).collect();
        if within.is_empty() {
            return;
        }
        let Some(net) = nets.iter().find(|net| net.ends.contains(within[0])) else { return };
        let all_inside: Vec<&String> = net.ends.iter().filter(|end| self.is_inside(end)).collect();
        let crosses = all_inside.len() < net.ends.len() || net.is_outward;
        if within.len() == ends.len() {
            wires.take(at);
        } else {
            // Each connection that goes on outside ends at the port.
            let port = self.conserving(all_inside[0]);
            let first = position(ends, |end| self.is_inside(end));
            wires.replace(at, first, &format!("{}.{port}", self.subsystem));
            let gone: Vec<bool> = ends.iter().map(|end| self.is_inside(end)).collect();
            wires.remove(at, |n, _| n != first && gone.get(n) == Some(&true));
        }
        // Inside they are joined once, however they were joined by way of others.
        let is_first = net.first == at
            || !(0..at).any(|before| net.items.contains(&before) && net.has_inside(before, self));
        if crosses {
            if is_first && all_inside.len() > 1 {
                let all: Vec<&str> = all_inside.iter().map(|end| end.as_str()).collect();
                inside.push(all.join(" <-> "));
            }
        } else {
            inside.push(ends.join(" <-> "));
        }
    }

    /// The changes of what the diagram hands outward.
    fn outward(&self, level: &Level) -> Vec<Splice> {
        let ast = &level.model.ast;
        let nets = nets_of(level);
        let mut splices = Vec::new();
        for (_, reference) in &ast.outputs {
            let end = written(reference);
            let (source, elements) = without_elements(&end);
            if let Some((_, name)) = self.outputs.iter().find(|(known, _)| known == source)
                && self.is_inside(&end)
            {
                let new = format!("{}.{name}{elements}", self.subsystem);
                splices.push(Splice::new(reference.span.clone(), new));
            }
        }
        for (_, reference) in &ast.ports {
            let end = written(reference);
            let port = representative(&nets, &end, |end| self.is_inside(end));
            if let Some((_, name)) = self.ports.iter().find(|(known, _)| *known == port)
                && self.is_inside(&end)
            {
                splices.push(Splice::new(reference.span.clone(), format!("{}.{name}", self.subsystem)));
            }
        }
        splices
    }

    /// The text of the new file.
    fn text(&self, blocks: &str, connections: &[String], feed: &str) -> String {
        let mut text = format!("Diagram({feed}");
        let mut section = |name: &str, entries: Vec<String>| {
            if !entries.is_empty() {
                text.push_str(&format!("    {name}: {{ {} }},{feed}", entries.join(", ")));
            }
        };
        section("inputs", self.inputs.iter().map(|(_, name)| format!("\"{name}\": ()")).collect());
        let handed = |(end, name): &(String, String)| format!("\"{name}\": \"{end}\"");
        section("outputs", self.outputs.iter().map(handed).collect());
        section("ports", self.ports.iter().map(handed).collect());
        text.push_str(&format!("    blocks: {{{feed}{blocks}    }},{feed}"));
        let lines: String = connections.iter().map(|line| format!("        \"{line}\",{feed}")).collect();
        text.push_str(&match lines.is_empty() {
            true => format!("    connections: [],{feed}"),
            false => format!("    connections: [{feed}{lines}    ],{feed}"),
        });
        text.push_str(&format!("){feed}"));
        text
    }
}

fn position(ends: &[String], is: impl Fn(&str) -> bool) -> usize {
    ends.iter().position(|end| is(end)).unwrap_or(usize::MAX)
}

/// Conserving ports that are joined, perhaps by several connections.
struct Net {
    ends: Vec<String>,
    /// The connections that join them.
    items: Vec<usize>,
    first: usize,
    /// The ends of each of these.
    written: BTreeMap<usize, Vec<String>>,
    /// Whether the diagram hands one of them outward.
    is_outward: bool,
}

impl Net {
    fn has_inside(&self, item: usize, border: &Border) -> bool {
        self.written.get(&item).is_some_and(|ends| ends.iter().any(|end| border.is_inside(end)))
    }
}

fn nets(level: &Level, wires: &Wires) -> Vec<Net> {
    let outward: BTreeSet<String> =
        level.model.ast.ports.iter().map(|(_, reference)| written(reference)).collect();
    let mut nets: Vec<Net> = Vec::new();
    for at in (0..wires.len()).filter(|at| wires.wire(*at) == Wire::Conserving) {
        let ends: Vec<String> = wires.ends(at).into_iter().map(str::to_owned).collect();
        let (touched, rest): (Vec<Net>, Vec<Net>) =
            nets.into_iter().partition(|net| net.ends.iter().any(|end| ends.contains(end)));
        nets = rest;
        let mut whole = Net {
            ends: Vec::new(),
            items: Vec::new(),
            first: at,
            written: BTreeMap::from([(at, ends.clone())]),
            is_outward: false,
        };
        for net in touched {
            whole.first = whole.first.min(net.first);
            whole.items.extend(net.items);
            whole.written.extend(net.written);
            whole.ends.extend(net.ends);
        }
        whole.items.push(at);
        whole.ends.extend(ends);
        let mut seen = BTreeSet::new();
        whole.ends.retain(|end| seen.insert(end.clone()));
        whole.is_outward = whole.ends.iter().any(|end| outward.contains(end));
        nets.push(whole);
    }
    nets
}

fn nets_of(level: &Level) -> Vec<Net> {
    wires(level).map(|wires| nets(level, &wires)).unwrap_or_default()
}

/// The port inside that stands for all that are joined to it there.
fn representative(nets: &[Net], end: &str, is_inside: impl Fn(&str) -> bool) -> String {
    let net = nets.iter().find(|net| net.ends.iter().any(|known| known == end));
    let first = net.and_then(|net| net.ends.iter().find(|known| is_inside(known)));
    first.cloned().unwrap_or_else(|| end.to_owned())
}

/// The blocks that move, with their comments.
struct Moved {
    /// Their entries, a line or more each.
    entries: String,
    /// The changes of the text that they leave.
    splices: Vec<Splice>,
}

impl Moved {
    fn of(level: &Level, names: &BTreeSet<String>, name: &str, file: &str) -> Result<Moved, Refusal> {
        let text = &*level.file.text;
        let strange = || Refusal::new("the blocks of this text cannot be found");
        let all = Entries::of(text, level.section("blocks").ok_or_else(strange)?).ok_or_else(strange)?;
        let blocks = &level.model.ast.blocks;
        let moves: Vec<bool> = blocks.iter().map(|block| names.contains(&block.name.text)).collect();
        if moves.len() != all.len() {
            return Err(strange());
        }
        let feed = line_feed(text);
        let (mut entries, mut splices) = (String::new(), Vec::new());
        for at in 0..all.len() {
            let above = all.comments_above(at);
            if !above.is_empty() && all.group(at).all(|at| moves[at]) {
                entries.push_str(&text[above.clone()]);
                splices.push(Splice::new(above, ""));
            }
            if moves[at] {
                let (entry, note, _) = all.written(at);
                let note = note.map(|note| format!(" {note}")).unwrap_or_default();
                // Names stand in quotes between braces.
                let entry = match entry.starts_with('"') {
                    true => entry.to_owned(),
                    false => {
                        let own = &blocks[at].name.text;
                        entry.replacen(own.as_str(), &format!("\"{own}\""), 1)
                    }
                };
                entries.push_str(&format!("        {entry},{note}{feed}"));
            }
        }
        let first = moves.iter().position(|moves| *moves).ok_or_else(strange)?;
        let new = format!("{}: Subsystem(file: \"{file}\")", quoted_name(level, name));
        splices.extend(all.without(|at| moves[at] && at != first));
        splices.push(Splice::new(all.span(first), new));
        splices.extend(all.note(first).map(|note| Splice::new(note, "")));
        Ok(Moved { entries, splices })
    }
}

/// Whether the model is what it was, but for the paths of what has moved: no new errors, and the same signals are recorded.
fn same_model(
    project: &Project,
    draft: &Draft,
    level: &Level,
    names: &BTreeSet<String>,
    name: &str,
) -> Result<(), Refusal> {
    let texts = draft.texts();
    let compiled = |texts: &BTreeMap<PathBuf, String>| {
        let reader = With { reader: project.reader, texts };
        let sources = Sources::new(&reader);
        compile(&sources, project.model, &[])
    };
    let (errors, _) = project.new_errors(&texts);
    if let Some(problem) = errors.first() {
        let help = problem.help.as_ref().map(|help| format!("; {help}")).unwrap_or_default();
        return Err(Refusal::new("the model would have errors with this subsystem")
            .help(format!("{}{help}", problem.message)));
    }
    let (before, after) = (compiled(&BTreeMap::new()), compiled(&texts));
    let (Some(before), Some(after)) = (before.schedule, after.schedule) else { return Ok(()) };
    let moved = |recorded: &str| {
        let rest = match level.model.path.as_str() {
            "" => Some(recorded),
            path => recorded.strip_prefix(path).and_then(|rest| rest.strip_prefix('/')),
        };
        let block = rest.map(|rest| rest.split(['.', '/']).next().unwrap_or_default());
        match (rest, block) {
            (Some(rest), Some(block)) if names.contains(block) => {
                below(&below(&level.model.path, name), rest)
            }
            _ => recorded.to_owned(),
        }
    };
    let was: BTreeSet<String> = before.recorded.iter().map(|signal| moved(&signal.path)).collect();
    let is: BTreeSet<String> = after.recorded.iter().map(|signal| signal.path.clone()).collect();
    // A pattern such as `**` means the outputs of the subsystem as well, which show what is recorded already.
    let own = format!("{}.", below(&level.model.path, name));
    match was.symmetric_difference(&is).find(|signal| was.contains(*signal) || !signal.starts_with(&own)) {
        None => Ok(()),
        Some(signal) => {
            Err(Refusal::new(format!("a pattern of `record` means `{signal}` in one of both cases only"))
                .help("write a pattern that reaches across levels, such as \"**.y\", first"))
        }
    }
}
