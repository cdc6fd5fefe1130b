//! Every intermediate form as stable text: the debugger, the tutorial and the snapshots of the tests.

use std::fmt::Write;

use blocksim_block::PortType;
use blocksim_block::schedule::{Keep, Schedule, Solver, Start, Steady, When};

use crate::ast::{Ast, ConnectionAst, Reference};
use crate::flatten::Flat;
use crate::infer::Typed;
use crate::model::{Content, Model};
use blocksim_syntax::{Node, Shape};

/// A step of the way from text to schedule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// As written: names, raw parameters.
    Ast,
    /// Blocks with their parameters, hierarchy, variants chosen.
    Model,
    /// One list, networks as blocks.
    Flat,
    /// Kind, shape and unit of every signal.
    Types,
    /// The order of evaluation.
    Schedule,
}

/// Intermediate forms, as far as the compiler came.
#[derive(Debug, Clone, Default)]
pub struct Stages {
    pub(crate) ast: Option<String>,
    pub(crate) model: Option<String>,
    pub(crate) flat: Option<String>,
    pub(crate) types: Option<String>,
    pub(crate) schedule: Option<String>,
}

impl Stages {
    /// Text of a stage; `None` when the compiler did not come that far.
    pub fn emit(&self, stage: Stage) -> Option<String> {
        match stage {
            Stage::Ast => self.ast.clone(),
            Stage::Model => self.model.clone(),
            Stage::Flat => self.flat.clone(),
            Stage::Types => self.types.clone(),
            Stage::Schedule => self.schedule.clone(),
        }
    }
}

pub(crate) fn ast(ast: &Ast) -> String {
    let mut out = String::new();
    if let Some(title) = &ast.title {
        let _ = writeln!(out, "title {title:?}");
    }
    for (name, node) in &ast.parameters {
        let _ = writeln!(out, "parameter {} = {}", name.text, written(node));
    }
    if let Some(node) = &ast.simulation {
        let _ = writeln!(out, "simulation {}", written(node));
    }
    for (name, node) in &ast.inputs {
        let _ = writeln!(out, "input {} {}", name.text, written(node));
    }
    for (name, reference) in &ast.outputs {
        let _ = writeln!(out, "output {} <- {}", name.text, refer(reference));
    }
    for (name, reference) in &ast.ports {
        let _ = writeln!(out, "port {} <-> {}", name.text, refer(reference));
    }
    for block in &ast.blocks {
        let parameters: Vec<String> =
            block.parameters.iter().map(|(name, node)| format!("{}: {}", name.text, written(node))).collect();
        let _ = writeln!(out, "block {} = {}({})", block.name.text, block.kind.text, parameters.join(", "));
    }
    for connection in &ast.connections {
        let _ = match connection {
            ConnectionAst::Signal(source, targets) => {
                let targets: Vec<String> = targets.iter().map(refer).collect();
                writeln!(out, "connect {} -> {}", refer(source), targets.join(", "))
            }
            ConnectionAst::Conserving(joined) => {
                let joined: Vec<String> = joined.iter().map(refer).collect();
                writeln!(out, "join {}", joined.join(" <-> "))
            }
        };
    }
    for entry in &ast.record {
        let rate = entry
            .rate
            .as_ref()
            .map_or(String::new(), |(word, value)| format!(" {} {}", word.text, written(value)));
        for pattern in &entry.signals {
            let _ = writeln!(out, "record {}{rate}", pattern.text);
        }
    }
    for element in &ast.panel {
        let members: Vec<String> = element.members.iter().map(|(_, node)| written(node)).collect();
        let _ = writeln!(out, "panel {}({})", element.kind.name(), members.join(", "));
    }
    out
}

fn refer(reference: &Reference) -> String {
    let mut text = format!("{}.{}", reference.block, reference.port);
    for element in &reference.elements {
        text.push('.');
        text.push_str(element);
    }
    text
}

fn written(node: &Node) -> String {
    let members = |members: &[(blocksim_syntax::Name, Node)]| {
        members
            .iter()
            .map(|(name, node)| format!("{}: {}", name.text, written(node)))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let items = |items: &[Node]| items.iter().map(written).collect::<Vec<_>>().join(", ");
    match &node.value {
        Shape::Number(value) => value.to_string(),
        Shape::Bool(value) => value.to_string(),
        Shape::Text(text) => format!("{text:?}"),
        Shape::List(list) => format!("[{}]", items(list)),
        Shape::Map(set) => format!("{{{}}}", members(set)),
        Shape::Struct(name, set) => {
            format!("{}({})", name.as_ref().map_or("", |name| &name.text), members(set))
        }
        Shape::Tuple(name, list) => {
            format!("{}({})", name.as_ref().map_or("", |name| &name.text), items(list))
        }
        Shape::Word(word) => word.clone(),
    }
}

pub(crate) fn model(model: &Model) -> String {
    fn go(model: &Model, depth: usize, out: &mut String) {
        for block in &model.blocks {
            let indent = "  ".repeat(depth);
            let variant =
                block.variant.as_ref().map(|v| format!(" [{} = {}]", v.by, v.chosen)).unwrap_or_default();
            match &block.content {
                Content::Block { block: built, .. } => {
                    let _ = writeln!(out, "{indent}{}{variant} = {built:?}", block.name);
                }
                Content::Diagram(inside) => {
                    let title = inside.ast.title.as_deref().unwrap_or("Diagram");
                    let _ = writeln!(out, "{indent}{}{variant}: {title}", block.name);
                    go(inside, depth + 1, out);
                }
                Content::Unknown => {
                    let _ = writeln!(out, "{indent}{} = ? ({})", block.name, block.kind);
                }
            }
        }
    }
    let mut out = String::new();
    go(model, 0, &mut out);
    out
}

pub(crate) fn flat(flat: &Flat) -> String {
    let mut out = String::new();
    for block in &flat.blocks {
        let _ = writeln!(out, "{} : {}", block.path, block.kind);
        for (input, source) in block.interface.inputs.iter().zip(&block.inputs) {
            let from = match source {
                Some(source) => flat.blocks[source.block].output_names[source.output].clone(),
                None => input.default.map_or("?".to_owned(), |value| format!("{value} (default)")),
            };
            let _ = writeln!(out, "  {} <- {from}", input.name);
        }
    }
    for (name, source) in &flat.recorded {
        let _ = writeln!(out, "record {name} <- {}", flat.blocks[source.block].output_names[source.output]);
    }
    out
}

pub(crate) fn types(flat: &Flat, typed: &Typed) -> String {
    let mut out = String::new();
    for (block, interface) in flat.blocks.iter().zip(&typed.interfaces) {
        for (name, output) in block.output_names.iter().zip(&interface.outputs) {
            let _ = writeln!(out, "{name} : {}", port_type(&output.port_type));
        }
    }
    out
}

fn port_type(port: &PortType) -> String {
    let unit = port.dimension.map_or("unit unknown".to_owned(), |dimension| format!("[{dimension}]"));
    format!("{} {} {unit}", port.kind, port.shape)
}

pub(crate) fn schedule(schedule: &Schedule) -> String {
    let mut out = String::new();
    let settings = &schedule.settings;
    let solver = match settings.solver {
        Solver::Fixed { method, step } => format!("{method:?}, step {step} s"),
        Solver::Variable { method, rtol, atol, .. } => match atol {
            Some(atol) => format!("{method:?}, rtol {rtol}, atol {atol}"),
            None => format!("{method:?}, rtol {rtol}"),
        },
    };
    let _ = writeln!(out, "stop at {} s, {solver}", settings.stop_time);
    for tolerance in &settings.atol {
        let _ = writeln!(out, "atol {} of `{}`", tolerance.value, tolerance.name);
    }
    if let Start::Steady(Steady { hold, free, drift }) = &settings.start {
        let held = hold.iter().map(|held| format!(", `{}` held at {}", held.name, held.value));
        let free = free.iter().map(|free| format!(", `{}` free", free.name));
        let drift = drift.iter().map(|state| format!(", `{state}` may drift"));
        let _ = writeln!(out, "steady start{}", held.chain(free).chain(drift).collect::<String>());
    }
    let _ = writeln!(
        out,
        "{} blocks, {} signals, {} states, {} discrete, {} guards",
        schedule.blocks.len(),
        schedule.signals.len(),
        schedule.states,
        schedule.discrete,
        schedule.guards
    );
    for rate in &schedule.clock.rates {
        let _ = writeln!(out, "rate {} s", rate.period as f64 * schedule.clock.tick);
    }
    for (number, step) in schedule.steps.iter().enumerate() {
        if let Some(found) = schedule.loops.iter().find(|found| found.first == number) {
            let _ = writeln!(out, "solved: the next {}, for {} unknown", found.count, found.cells.len());
        }
        let block = &schedule.blocks[step.block as usize];
        let when = match step.when {
            When::Constant => "once".to_owned(),
            When::Major => "major".to_owned(),
            When::Continuous if step.minor => "always".to_owned(),
            When::Continuous => "when shown".to_owned(),
            When::Sampled(rate) => {
                format!("every {} s", schedule.clock.rates[rate as usize].period as f64 * schedule.clock.tick)
            }
        };
        let outputs = given_by(block, step.group as usize);
        let _ = writeln!(out, "{:<12} {} ({}): {}", when, block.path, block.kind, outputs.join(", "));
    }
    for recorded in &schedule.recorded {
        let kept = match recorded.keep {
            Keep::All => String::new(),
            Keep::Every(time) => format!(" every {time} s"),
            Keep::Rows(n) => format!(" every {n} rows"),
            Keep::Extremes(time) => format!(" extremes of {time} s"),
        };
        let _ = writeln!(out, "record {}{kept}", recorded.path);
    }
    out
}

/// Names of the outputs that a group writes; of those that it writes in part, the elements.
fn given_by(block: &blocksim_block::schedule::Instance, group: usize) -> Vec<String> {
    let cells: Vec<usize> = block.written(group).map(|cell| cell - block.y).collect();
    let outputs = block.interface.outputs.iter().zip(&block.outputs);
    outputs
        .flat_map(|(output, (start, end))| {
            let own = cells.iter().filter(|cell| (*start as usize..*end as usize).contains(*cell));
            let elements: Vec<usize> = own.map(|cell| cell - *start as usize).collect();
            if elements.len() == (end - start) as usize {
                vec![output.name.clone()]
            } else {
                elements.iter().map(|element| format!("{}[{element}]", output.name)).collect()
            }
        })
        .collect()
}
