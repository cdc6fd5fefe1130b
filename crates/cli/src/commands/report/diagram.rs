//! The block diagram of a model, level by level, with what is known of its blocks and wires.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet, VecDeque};
use std::sync::{Arc, Mutex, PoisonError};

use blocksim_block::BlockInfo;
use blocksim_diagram::{Content, Model, ModelBlock, Sources, origins};
use blocksim_drawing::{Facts, Layer, Level as Drawable, Look, all_levels, inline, style_sheet};
use blocksim_layout::{Graph, Layout, PortKind, layout};
use blocksim_picture::pretty_unit;
use blocksim_report::{Drawing, Inspected, Kind, Level, Net, PortPlace, Probe, Report};
use blocksim_signal::Dimension;
use blocksim_syntax::Shape;
use serde_json::{Value, json};

use super::numbers::shortest;
use super::source_text::{line, set_for, written};
use crate::terminal::prose::first_sentence;

/// Longest text of a parameter.
const LONGEST: usize = 120;
/// Most elements of a bus that are told.
const ELEMENTS: usize = 40;

/// Adds all levels. Levels that look alike share a drawing; what is known of a compiled model is laid over it.
pub fn add(
    model: &Model,
    sources: &Sources,
    overrides: &[String],
    facts: Option<&Facts>,
    report: &mut Report,
) {
    let mut models: HashMap<&str, &Model> = HashMap::new();
    gather(model, &mut models);
    let recorded = Recorded::of(model, report);
    let mut known: Vec<Drawable> = Vec::new();
    let mut kinds = BTreeSet::new();
    for level in all_levels(model, sources) {
        let Some(inside) = models.get(level.path.as_str()) else { continue };
        let probes = (0..level.lines.len()).map(|net| recorded.on(&level, net)).collect();
        let blocks = level.figures.iter().map(|figure| {
            let block = inside.block(figure.path.as_ref().map(|_| figure.name.as_str())?)?;
            kinds.insert(block.kind.clone());
            Some(inspected(block, inside, sources, overrides))
        });
        let blocks = blocks.collect();
        let (path, title) = (level.path.clone(), level.title.clone());
        let layers = facts.map_or(Value::Null, |facts| layers(facts, &level));
        let signals = level.lines.iter().map(|line| line.signal.clone()).collect();
        let level = relative(level);
        let same = |other: &Drawable| {
            other.graph == level.graph && other.figures == level.figures && other.lines == level.lines
        };
        let drawing = known.iter().position(same).unwrap_or_else(|| {
            report.diagram.drawings.push(drawing(&level));
            known.push(level);
            known.len() - 1
        });
        report.diagram.levels.push(Level { path, title, drawing, blocks, probes, signals, layers });
    }
    report.diagram.style = style_sheet();
    report.diagram.kinds = kinds.iter().filter_map(|kind| BlockInfo::find(kind)).map(kind).collect();
}

/// Layouts that are kept.
const LAYOUTS: usize = 512;

/// The layout of a level. It follows from the graph alone, and most levels are as they were when a model was read last, or like others.
fn laid_out(graph: &Graph) -> Arc<Layout> {
    static KNOWN: Mutex<VecDeque<(Graph, Arc<Layout>)>> = Mutex::new(VecDeque::new());
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, found)) = known().iter().find(|(known, _)| known == graph) {
        return Arc::clone(found);
    }
    let made = Arc::new(layout(graph));
    let mut all = known();
    if all.len() == LAYOUTS {
        all.pop_front();
    }
    all.push_back((graph.clone(), Arc::clone(&made)));
    made
}

/// Layers over a level, and what they say of its wires and blocks.
fn layers(facts: &Facts, level: &Drawable) -> Value {
    let (known, laid_out) = (facts.on(level), laid_out(&level.graph));
    let drawn = Layer::ALL.map(|layer| (layer.name(), facts.draw(layer, level, &known, &laid_out)));
    let drawn: serde_json::Map<String, Value> =
        drawn.into_iter().map(|(name, svg)| (name.to_owned(), svg.into())).collect();
    let pace = |pace: Option<blocksim_drawing::Pace>| pace.map(|pace| facts.pace(pace));
    let wires = known.wires.iter().map(|wire| {
        json!({ "unit": pretty_unit(&wire.unit), "pace": pace(wire.pace), "back": wire.feedback, "loops": wire.loops })
    });
    let blocks = known
        .blocks
        .iter()
        .map(|block| json!({ "order": block.order, "pace": pace(block.pace), "loops": block.loops }));
    json!({
        "svg": drawn, "legend": facts.legend(&known),
        "wires": wires.collect::<Vec<_>>(), "blocks": blocks.collect::<Vec<_>>(),
    })
}

fn gather<'m>(model: &'m Model, out: &mut HashMap<&'m str, &'m Model>) {
    out.insert(&model.path, model);
    for block in &model.blocks {
        if let Content::Diagram(inside) = &block.content {
            gather(inside, out);
        }
    }
}

/// A level without what tells where it stands, so that equal ones are equal.
fn relative(mut level: Drawable) -> Drawable {
    let prefix = format!("{}/", level.path);
    for figure in &mut level.figures {
        if figure.path.is_some() {
            figure.path = Some(figure.name.clone());
        }
        if let Some(rest) = figure.title.strip_prefix(&prefix) {
            figure.title = rest.to_owned();
        }
    }
    level.lines.iter_mut().for_each(|line| line.signal = None);
    Drawable { title: String::new(), path: String::new(), ..level }
}

fn drawing(level: &Drawable) -> Drawing {
    let laid_out = laid_out(&level.graph);
    let nets = level.graph.nets.iter().zip(&level.lines).map(|(net, line)| Net {
        title: line.title.clone(),
        nodes: net.ends.iter().map(|end| end.node).collect(),
        ends: net.ends.iter().map(|end| end_of(level, end.node, end.port)).collect(),
        directed: net.directed,
    });
    let nets = nets.collect();
    let mut ports = Vec::new();
    for (node, placed) in laid_out.nodes.iter().enumerate() {
        for (port, place) in placed.ports.iter().enumerate() {
            let end = end_of(level, node, port);
            if !end.is_empty() {
                let kind = match level.figures[node].ports[port].kind {
                    PortKind::Input => 'i',
                    PortKind::Output => 'o',
                    PortKind::Free => 'c',
                };
                ports.push(PortPlace { node, end, kind, at: [place.at.x, place.at.y] });
            }
        }
    }
    Drawing { svg: inline(level, &laid_out), nets, ports }
}

/// A port of a figure as connections name it; nothing where the bar at which a bus parts is fed.
fn end_of(level: &Drawable, node: usize, port: usize) -> String {
    let figure = &level.figures[node];
    let (name, kind) = (&figure.ports[port].name, figure.ports[port].kind);
    match (&figure.look, kind) {
        (Look::Pill, PortKind::Output) => format!("in.{name}"),
        (Look::Pill, _) => format!("out.{name}"),
        (Look::Selector, PortKind::Output) => format!("{}.{name}", figure.name),
        (Look::Selector, _) => String::new(),
        _ => format!("{}.{name}", figure.name),
    }
}

fn kind(info: &BlockInfo) -> Kind {
    let means = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    Kind {
        name: info.kind.to_owned(),
        does: first_sentence(info.doc),
        parameters: info.parameters.iter().map(|p| (p.name.to_owned(), means(p.doc))).collect(),
    }
}

fn inspected(block: &ModelBlock, model: &Model, sources: &Sources, overrides: &[String]) -> Inspected {
    let mut parameters: Vec<[String; 3]> = Vec::new();
    let ast = model.ast.blocks.iter().find(|ast| ast.name.text == block.name);
    let info = BlockInfo::find(&block.kind);
    for (name, node) in ast.into_iter().flat_map(|ast| &ast.parameters) {
        // What a subsystem or a plug-in is given stands in a set of its own.
        let members: Vec<_> = match &node.value {
            Shape::Map(members) => members.iter().map(|(name, node)| (&name.text, node)).collect(),
            _ => vec![(&name.text, node)],
        };
        for (name, node) in members {
            let set = set_for(overrides, &format!("{}.{name}", block.path));
            let text = set.map_or_else(
                || written(sources, model, &node.span, LONGEST),
                |set| format!("{set} (set for this run)"),
            );
            parameters.push([name.clone(), text, value(block, info, name)]);
        }
    }
    for parameter in info.into_iter().flat_map(|info| info.parameters) {
        let is_written = parameters.iter().any(|[name, ..]| name == parameter.name);
        if let (false, Some(default)) = (is_written, parameter.default) {
            let set = set_for(overrides, &format!("{}.{}", block.path, parameter.name));
            let text = set.map_or_else(|| "default".to_owned(), |set| format!("{set} (set for this run)"));
            let number = default.parse::<f64>().map(|x| with_unit(&shortest(x), parameter.unit));
            let shown =
                if set.is_some() { value(block, info, parameter.name) } else { number.unwrap_or_default() };
            parameters.push([parameter.name.to_owned(), text, shown]);
        }
    }
    let variant = block.variant.as_ref().map_or_else(String::new, |variant| {
        format!("{} of {} (by {})", variant.chosen, variant.of.join(", "), variant.by)
    });
    Inspected {
        name: block.name.clone(),
        kind: block.kind.clone(),
        place: line(sources, &block.place),
        variant,
        parameters,
    }
}

/// Value of a parameter in SI; empty where it is not a number.
fn value(block: &ModelBlock, info: Option<&BlockInfo>, name: &str) -> String {
    let Content::Block { numbers, units, .. } = &block.content else { return String::new() };
    let Some((_, list)) = numbers.iter().find(|(known, _)| known == name) else { return String::new() };
    let about = info.and_then(|info| info.parameters.iter().find(|p| p.name == name));
    // Numbers of a set have names of their own.
    let is_plain = |p: &&blocksim_block::ParameterInfo| {
        ["f64", "i64", "u32", "u64", "usize", "Value", "Entries"]
            .iter()
            .any(|number| p.rust_type.contains(number))
    };
    let Some(about) = about.filter(is_plain) else { return String::new() };
    let unit = match (about.unit, units.find(name)) {
        ("", Some(dimension)) if dimension != Dimension::NONE => dimension.to_string(),
        (unit, _) => unit.to_owned(),
    };
    match list.as_slice() {
        [one] => with_unit(&shortest(*one), &unit),
        several if several.len() <= 9 => {
            let all: Vec<String> = several.iter().map(|x| shortest(*x)).collect();
            with_unit(&format!("[{}]", all.join(", ")), &unit)
        }
        _ => String::new(),
    }
}

fn with_unit(number: &str, unit: &str) -> String {
    // Units that follow from use are described in words.
    let is_unit = !unit.is_empty() && unit != "1" && !unit.contains("of ");
    if is_unit { format!("{number} {unit}") } else { number.to_owned() }
}

/// Which recorded signals show which outputs.
struct Recorded {
    /// Output behind each name.
    origins: BTreeMap<String, String>,
    /// Paths of recorded signals by output: what follows the name of the output, and the path.
    shown: HashMap<String, Vec<(String, String)>>,
}

impl Recorded {
    fn of(model: &Model, report: &Report) -> Recorded {
        let origins = origins(model);
        let mut shown: HashMap<String, Vec<(String, String)>> = HashMap::new();
        let mut seen = HashSet::new();
        let pictured = report.panels.iter().flat_map(|panel| &panel.series).map(|series| &series.path);
        for path in pictured.chain(report.unseen.iter().map(|signal| &signal.path)) {
            let (name, index) = match path.find('[') {
                Some(at) => path.split_at(at),
                None => (path.as_str(), ""),
            };
            let Some(origin) = origins.get(name) else { continue };
            // Several scopes may show the same.
            if seen.insert((origin.clone(), index.to_owned())) {
                shown.entry(origin.clone()).or_default().push((index.to_owned(), path.clone()));
            }
        }
        Recorded { origins, shown }
    }

    /// What is known of a wire.
    fn on(&self, level: &Drawable, net: usize) -> Vec<Probe> {
        let Some(name) = level.name_of(net) else { return Vec::new() };
        let known = |name: &String, element: &str| {
            let found = self.origins.get(name).and_then(|origin| self.shown.get(origin));
            found
                .into_iter()
                .flatten()
                .map(|(index, path)| Probe { element: format!("{element}{index}"), path: path.clone() })
                .collect::<Vec<_>>()
        };
        let alone = known(&name, "");
        if !alone.is_empty() {
            return alone;
        }
        let prefix = format!("{name}.");
        let elements =
            self.origins.range(prefix.clone()..).take_while(|(other, _)| other.starts_with(&prefix));
        elements.flat_map(|(other, _)| known(other, &other[prefix.len()..])).take(ELEMENTS).collect()
    }
}
