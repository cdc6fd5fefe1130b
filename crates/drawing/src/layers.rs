//! What is known of a compiled model and can be laid over the drawing of a level: units, sample times, the order of evaluation, feedback
//! and algebraic loops. Nothing is told by colour alone: each layer has its texts or its kind of line.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use blocksim_block::schedule::{Instance, Schedule, When};
use blocksim_diagram::{Model, origins};
use blocksim_layout::{Layout, Segment, feedback};
use blocksim_picture::{Palette, Theme, pretty_unit};
use blocksim_signal::{Kind, Shape};

use crate::canvas::{escaped, number};
use crate::figure::Look;
use crate::fonts::PORT;
use crate::level::Level;
use crate::marks::Marks;

/// Sample times that have colours of their own; those behind them begin anew.
const COLOURS: usize = 6;
/// Numbers of a block that are written beside it.
const NUMBERS: usize = 3;

/// What can be laid over a drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// Units, and what else than one real number a signal is, on the wires.
    Units,
    /// Sample times of blocks and wires, by colour and beside the blocks.
    Rates,
    /// Numbers beside the blocks in the order in which their outputs are evaluated.
    Order,
    /// Wires that lead back.
    Feedback,
    /// Blocks and wires of algebraic loops.
    Loops,
}

impl Layer {
    /// All layers.
    pub const ALL: [Layer; 5] = [Layer::Units, Layer::Rates, Layer::Order, Layer::Feedback, Layer::Loops];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Layer::Units => "units",
            Layer::Rates => "rates",
            Layer::Order => "order",
            Layer::Feedback => "feedback",
            Layer::Loops => "loops",
        }
    }
}

/// How often something changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pace {
    /// Never.
    Constant,
    /// At any time.
    Continuous,
    /// At events and at the end of steps.
    Major,
    /// At the hits of a rate.
    Sampled(usize),
}

impl Pace {
    fn of(when: When) -> Pace {
        match when {
            When::Constant => Pace::Constant,
            When::Continuous => Pace::Continuous,
            When::Major => Pace::Major,
            When::Sampled(rate) => Pace::Sampled(rate as usize),
        }
    }

    fn class(self) -> String {
        match self {
            Pace::Constant => "pace-constant".to_owned(),
            Pace::Continuous => "pace-continuous".to_owned(),
            Pace::Major => "pace-major".to_owned(),
            Pace::Sampled(rate) => format!("pace-{}", rate % COLOURS),
        }
    }
}

/// What is known of a wire.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OfWire {
    /// Unit and shape: `V`, `rad/s [3]`, `bool`; empty where nothing is known.
    pub unit: String,
    /// How often it changes.
    pub pace: Option<Pace>,
    /// Whether it leads back.
    pub feedback: bool,
    /// Algebraic loops that it belongs to, counted from 1.
    pub loops: Vec<usize>,
}

/// What is known of a block.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OfBlock {
    /// Places of its outputs in the order of evaluation, counted from 1.
    pub order: Vec<usize>,
    /// How often it changes.
    pub pace: Option<Pace>,
    /// Algebraic loops that it belongs to, counted from 1.
    pub loops: Vec<usize>,
}

/// What is known of the wires and blocks of a level, in the order of its nets and figures.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LevelFacts {
    /// Of the wires.
    pub wires: Vec<OfWire>,
    /// Of the blocks.
    pub blocks: Vec<OfBlock>,
}

/// What is known of a compiled model.
#[derive(Debug, Clone, Default)]
pub struct Facts {
    /// Unit and pace of each output.
    signals: BTreeMap<String, (String, Option<Pace>)>,
    blocks: BTreeMap<String, OfBlock>,
    loops: Vec<Marks>,
    /// Output behind each name of a signal.
    origins: BTreeMap<String, String>,
    /// Sample times in words.
    rates: Vec<String>,
}

impl Facts {
    /// What the schedule knows of a model; without one feedback alone is known.
    pub fn of(model: &Model, schedule: Option<&Schedule>) -> Facts {
        let mut facts = Facts { origins: origins(model), ..Facts::default() };
        let Some(schedule) = schedule else { return facts };
        facts.rates = rates(schedule);
        let mut paces: BTreeMap<usize, Pace> = BTreeMap::new();
        let mut order: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (at, step) in schedule.steps.iter().enumerate() {
            let block = &schedule.blocks[step.block as usize];
            paces.extend(block.written(step.group as usize).map(|cell| (cell, Pace::of(step.when))));
            order.entry(step.block).or_default().push(at + 1);
        }
        for signal in &schedule.signals {
            let pace = paces.get(&signal.offset).copied();
            facts.signals.insert(signal.path.clone(), (unit(signal), pace));
        }
        for (at, block) in schedule.blocks.iter().enumerate() {
            let cells = block.outputs.iter().map(|(start, _)| block.y + *start as usize);
            let pace = match block.rate {
                Some(rate) => Some(Pace::Sampled(rate)),
                // What moves most often counts.
                None => cells.filter_map(|cell| paces.get(&cell).copied()).max_by_key(|pace| rank(*pace)),
            };
            let order = order.remove(&(at as u32)).unwrap_or_default();
            for path in paths(block) {
                facts.blocks.insert(path, OfBlock { order: order.clone(), pace, loops: Vec::new() });
            }
        }
        for (at, found) in schedule.loops.iter().enumerate() {
            let steps = &schedule.steps[found.first..found.first + found.count];
            let blocks: BTreeSet<String> =
                steps.iter().flat_map(|step| paths(&schedule.blocks[step.block as usize])).collect();
            for path in &blocks {
                if let Some(block) = facts.blocks.get_mut(path) {
                    block.loops.push(at + 1);
                }
            }
            facts.loops.push(Marks { blocks });
        }
        facts
    }

    /// What is known of a level.
    pub fn on(&self, level: &Level) -> LevelFacts {
        let back = feedback(&level.graph);
        let wires = level.lines.iter().enumerate().map(|(net, _)| {
            let known = level.name_of(net).and_then(|name| {
                let output = self.origins.get(&name).unwrap_or(&name);
                self.signals.get(output)
            });
            let (unit, pace) = known.cloned().unwrap_or_default();
            let in_loop = |marks: &Marks| marks.has_net(level, net);
            OfWire { unit, pace, feedback: back[net], loops: self.places(in_loop) }
        });
        let blocks = level.figures.iter().map(|figure| match (&figure.look, &figure.path) {
            // Of what is inside a subsystem the loops are seen from outside.
            (Look::Subsystem(_), _) => {
                OfBlock { loops: self.places(|marks| marks.has(figure)), ..OfBlock::default() }
            }
            (_, Some(path)) => self.blocks.get(path).cloned().unwrap_or_default(),
            _ => OfBlock::default(),
        });
        LevelFacts { wires: wires.collect(), blocks: blocks.collect() }
    }

    fn places(&self, is_in: impl Fn(&Marks) -> bool) -> Vec<usize> {
        let marks = self.loops.iter().enumerate();
        marks.filter(|(_, marks)| is_in(marks)).map(|(at, _)| at + 1).collect()
    }

    /// A pace in words: `10 ms`, `continuous`.
    pub fn pace(&self, pace: Pace) -> &str {
        match pace {
            Pace::Constant => "constant",
            Pace::Continuous => "continuous",
            Pace::Major => "at events",
            Pace::Sampled(rate) => self.rates.get(rate).map_or("sampled", String::as_str),
        }
    }

    /// Paces that a level has, with the class of their colour and in words.
    pub fn legend(&self, facts: &LevelFacts) -> Vec<(String, String)> {
        let wires = facts.wires.iter().filter_map(|wire| wire.pace);
        let all: BTreeSet<Pace> = wires.chain(facts.blocks.iter().filter_map(|block| block.pace)).collect();
        all.into_iter().map(|pace| (pace.class(), self.pace(pace).to_owned())).collect()
    }

    /// A layer as a part of the drawing of a level, to be put behind its blocks.
    pub fn draw(&self, layer: Layer, level: &Level, facts: &LevelFacts, layout: &Layout) -> String {
        let mut out = format!("<g class=\"layer layer-{}\">", layer.name());
        for (wire, known) in layout.wires.iter().zip(&facts.wires) {
            match layer {
                Layer::Units if !known.unit.is_empty() => {
                    if let Some((x, y)) = beside(&wire.segments) {
                        text(&mut out, x, y, "middle", &pretty(&known.unit));
                    }
                }
                Layer::Rates => {
                    if let Some(pace) = known.pace {
                        halo(&mut out, &pace.class(), &way(&wire.segments));
                    }
                }
                Layer::Feedback if known.feedback => halo(&mut out, "back", &way(&wire.segments)),
                Layer::Loops if !known.loops.is_empty() => halo(&mut out, "looped", &way(&wire.segments)),
                _ => {}
            }
        }
        for ((figure, placed), known) in level.figures.iter().zip(&layout.nodes).zip(&facts.blocks) {
            let (x, y, right) = (placed.x, placed.y, placed.x + placed.width);
            let frame = format!(
                "M{} {}h{}v{}h-{}Z",
                number(x - 2.0),
                number(y - 2.0),
                number(placed.width + 4.0),
                number(placed.height + 4.0),
                number(placed.width + 4.0)
            );
            // A name above the box leaves no room there.
            let above = if placed.label_above { y + placed.height + PORT + 1.0 } else { y - 4.0 };
            match layer {
                Layer::Rates if figure.path.is_some() => {
                    if let Some(pace) = known.pace {
                        halo(&mut out, &pace.class(), &frame);
                        // The others are told by the kinds of their lines; above the numbers of the order.
                        if let Pace::Sampled(_) = pace {
                            let by = if placed.label_above { PORT + 1.0 } else { -PORT - 1.0 };
                            text(&mut out, right + 2.0, above + by, "end", self.pace(pace));
                        }
                    }
                }
                Layer::Order if !known.order.is_empty() => {
                    let mut all: Vec<String> =
                        known.order.iter().take(NUMBERS).map(ToString::to_string).collect();
                    if known.order.len() > NUMBERS {
                        all.push("…".to_owned());
                    }
                    text(&mut out, x - 2.0, above, "start", &all.join(" "));
                }
                Layer::Loops if !known.loops.is_empty() => {
                    halo(&mut out, "looped", &frame);
                    let all: Vec<String> = known.loops.iter().map(ToString::to_string).collect();
                    text(&mut out, x - 2.0, above, "start", &format!("loop {}", all.join(", ")));
                }
                _ => {}
            }
        }
        out.push_str("</g>");
        out
    }
}

/// The rules of layers in a drawing of its own.
pub(crate) fn rules(theme: Theme) -> String {
    let Palette { text, quiet, series, .. } = Palette::of(theme);
    let (back, looped) = match theme {
        Theme::Light => ("#8A5A00", "#B00020"),
        Theme::Dark => ("#FFC54D", "#FF8A80"),
    };
    let mut out = format!(
        ".diagram .halo{{fill:none;stroke-width:6;stroke-opacity:.4;stroke-linecap:round}}\
         .diagram .pace-constant{{stroke:{quiet};stroke-dasharray:2 6}}\
         .diagram .pace-continuous{{stroke:{text}}}\
         .diagram .pace-major{{stroke:{quiet};stroke-dasharray:14 7}}\
         .diagram .back{{stroke:{back};stroke-dasharray:9 5}}\
         .diagram .looped{{stroke:{looped};stroke-width:7}}"
    );
    for (at, colour) in series.iter().enumerate().take(COLOURS) {
        let _ = write!(out, ".diagram .pace-{at}{{stroke:{colour}}}");
    }
    out
}

fn halo(out: &mut String, class: &str, data: &str) {
    if !data.is_empty() {
        let _ = write!(out, "<path class=\"halo {class}\" d=\"{data}\"/>");
    }
}

fn text(out: &mut String, x: f64, y: f64, anchor: &str, text: &str) {
    let _ = write!(
        out,
        "<text class=\"text\" x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{anchor}\">{}</text>",
        number(x),
        number(y),
        number(PORT),
        escaped(text)
    );
}

fn way(segments: &[Segment]) -> String {
    let mut data = String::new();
    for Segment { from, to } in segments {
        let _ = write!(data, "M{} {}L{} {}", number(from.x), number(from.y), number(to.x), number(to.y));
    }
    data
}

/// Where a text stands below a wire: at the middle of its longest part, which lies rather than stands.
fn beside(segments: &[Segment]) -> Option<(f64, f64)> {
    let length = |part: &&Segment| {
        let lies = part.from.y == part.to.y;
        (part.to.x - part.from.x).abs() + (part.to.y - part.from.y).abs() * if lies { 1.0 } else { 0.5 }
    };
    let Segment { from, to } = segments.iter().max_by(|a, b| length(a).total_cmp(&length(b)))?;
    Some(((from.x + to.x) / 2.0, (from.y + to.y) / 2.0 + PORT + 1.0))
}

/// A unit as it is set in print, with the shape behind it.
fn pretty(text: &str) -> String {
    let (unit, shape) = text.split_once(" [").map_or((text, None), |(unit, shape)| (unit, Some(shape)));
    let unit = if unit == "1" { "1".to_owned() } else { pretty_unit(unit) };
    shape.map_or(unit.clone(), |shape| format!("{unit} [{shape}"))
}

/// `V`, `rad/s [3]`, `bool`; empty for a number of which nothing says its unit.
fn unit(signal: &blocksim_block::schedule::Signal) -> String {
    let unit = match (signal.kind, signal.dimension) {
        (Kind::Bool, _) => "bool".to_owned(),
        (Kind::Int, _) => "int".to_owned(),
        (_, Some(dimension)) => dimension.to_string(),
        (_, None) => String::new(),
    };
    let shape = match signal.shape {
        Shape::Scalar => String::new(),
        Shape::Vector(count) => format!("[{count}]"),
        Shape::Matrix(rows, columns) => format!("[{rows}×{columns}]"),
    };
    format!("{unit} {shape}").trim().to_owned()
}

/// What changes more often counts more.
fn rank(pace: Pace) -> u8 {
    match pace {
        Pace::Constant => 0,
        Pace::Sampled(_) => 1,
        Pace::Major => 2,
        Pace::Continuous => 3,
    }
}

/// A block, or the blocks that it is made of.
fn paths(block: &Instance) -> Vec<String> {
    match block.parts.as_slice() {
        [] => vec![block.path.clone()],
        parts => parts.iter().map(|part| part.path.clone()).collect(),
    }
}

/// Sample times in words: `10 ms`, `10 ms + 2 ms`.
fn rates(schedule: &Schedule) -> Vec<String> {
    let told = |seconds: f64| {
        let (value, unit) = match seconds {
            s if s < 1e-3 => (s * 1e6, "µs"),
            s if s < 1.0 => (s * 1e3, "ms"),
            s => (s, "s"),
        };
        format!("{} {unit}", (value * 1e6).round() / 1e6)
    };
    let one = |rate: &blocksim_block::schedule::Rate| {
        let period = told(schedule.clock.time(rate.period));
        match rate.offset {
            0 => period,
            offset => format!("{period} + {}", told(schedule.clock.time(offset))),
        }
    };
    schedule.clock.rates.iter().map(one).collect()
}
