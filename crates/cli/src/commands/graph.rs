use std::collections::BTreeSet;
use std::path::Path;

use blocksim_block::schedule::Schedule;
use blocksim_diagram::{Options, Sources, compile_and_keep};
use blocksim_drawing::{
    Facts, Layer, Level, LevelFacts, Marks, Pace, PathError, all_levels, level_at, svg_with_layers,
    svg_with_marks, text,
};
use blocksim_layout::{Layout, Point, PortKind, layout};
use blocksim_terminal::{Align, Table};
use serde_json::{Value, json};

use super::tell;
use crate::args::graph::GraphArgs;
use crate::disk::{Disk, readable};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::loaded::tell_builds;
use crate::picture_file::write_pictures;
use crate::terminal::console::Console;
use crate::terminal::render;
use crate::trust::{Plugins, Purpose};

/// Draws a level of a model, or all of them.
///
/// # Errors
/// If the model cannot be read, there is no such level, or a drawing cannot be written.
pub fn graph(args: &GraphArgs, console: Console) -> Outcome {
    readable(&args.model.model)?;
    let disk = Disk::with(Plugins::of(args.model.plugins, Purpose::Look));
    tell_builds();
    let sources = Sources::new(&disk);
    let layers: Vec<Layer> = args.layers.iter().map(|layer| Layer::from(*layer)).collect();
    // Only what compiles is known to have units, sample times, an order and loops.
    let needs_schedule = args.r#loop.is_some() || layers.iter().any(|layer| *layer != Layer::Feedback);
    let (model, problems, schedule) = if needs_schedule {
        let options = Options { overrides: &args.model.set, ..Options::default() };
        let (model, compiled) = compile_and_keep(&sources, &args.model.model, &options);
        (model, compiled.problems, compiled.schedule)
    } else {
        let (model, problems) = blocksim_diagram::model(&sources, &args.model.model, &args.model.set);
        (model, problems, None)
    };
    tell(&problems, &sources.all(), console)?;
    let Some(model) = model else { return Ok(Exit::Model) };
    let looped = match args.r#loop {
        Some(number) => {
            // Only what compiles is known to have loops.
            let Some(schedule) = &schedule else { return Ok(Exit::Model) };
            Some(Looped::find(schedule, number as usize)?)
        }
        None => None,
    };
    if schedule.is_none() && needs_schedule {
        return Ok(Exit::Model);
    }
    let facts = (!layers.is_empty()).then(|| Facts::of(&model, schedule.as_ref()));
    let marks = looped.as_ref().map_or(Marks::default(), |found| found.marks.clone());
    let levels = if args.all {
        all_levels(&model, &sources)
    } else {
        let path = if looped.is_some() { &marks.level() } else { &args.path };
        vec![level_at(&model, &sources, path).map_err(|error| no_such_level(&error))?]
    };
    let whole = if render::errors(&problems) == 0 { Exit::Done } else { Exit::Model };
    for level in &levels {
        let laid_out = layout(&level.graph);
        if args.json {
            let known = facts.as_ref().map(|facts| (facts, facts.on(level)));
            console.data(&format!("{}\n", as_json(level, &laid_out, known.as_ref())))?;
        }
        if args.svg.is_none() && args.png.is_none() {
            if !args.json {
                if let Some(found) = &looped {
                    console.data(&format!("{}\n", found.text))?;
                }
                let headed = if args.all && !level.path.is_empty() {
                    format!("{}: ", level.path)
                } else {
                    String::new()
                };
                console.data(&format!("{headed}{}\n", text(level, &laid_out, console.ascii)))?;
                if let Some(facts) = &facts {
                    console.data(&in_words(facts, level, &layers))?;
                }
            }
            continue;
        }
        let drawing = match &facts {
            Some(facts) => svg_with_layers(level, &laid_out, args.theme.into(), facts, &layers),
            None => svg_with_marks(level, &laid_out, args.theme.into(), &marks),
        };
        let file = |given: &Option<std::path::PathBuf>, ending: &str| {
            given
                .as_deref()
                .map(|file| if args.all { in_folder(file, level, ending) } else { file.to_owned() })
        };
        let (as_svg, as_png) = (file(&args.svg, "svg"), file(&args.png, "png"));
        for folder in [&as_svg, &as_png].into_iter().flatten().filter_map(|file| file.parent()) {
            if args.all
                && let Err(error) = std::fs::create_dir_all(folder)
            {
                return Err(Failure::unwritable(format!("cannot create `{}`: {error}", folder.display())));
            }
        }
        for file in write_pictures(&drawing, as_svg.as_deref(), as_png.as_deref(), args.scale, args.yes)? {
            let line = file.display().to_string();
            if args.json { console.say(&line) } else { console.data(&format!("{line}\n"))? }
        }
    }
    Ok(whole)
}

/// Layers as a table: a line for each wire and each block of which something is known.
fn in_words(facts: &Facts, level: &Level, layers: &[Layer]) -> String {
    let has = |layer: Layer| layers.contains(&layer);
    let known = facts.on(level);
    let numbers = |all: &[usize]| all.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    let looped = |loops: &[usize]| match loops {
        [] => String::new(),
        loops => format!("loop {}", numbers(loops)),
    };
    let mut table = Table::new(&[("", Align::Left); 5]);
    let mut count = 0;
    let mut row = |name: &str, cells: [String; 4]| {
        if cells.iter().any(|cell| !cell.is_empty()) {
            let [a, b, c, d] = cells;
            table.row([name.to_owned(), a, b, c, d]);
            count += 1;
        }
    };
    let pace = |pace: Option<Pace>| match pace {
        Some(pace) if has(Layer::Rates) => facts.pace(pace).to_owned(),
        _ => String::new(),
    };
    for (figure, block) in level.figures.iter().zip(&known.blocks) {
        let order = if has(Layer::Order) { numbers(&block.order) } else { String::new() };
        let loops = if has(Layer::Loops) { looped(&block.loops) } else { String::new() };
        row(&figure.name, [order, pace(block.pace), String::new(), loops]);
    }
    for (line, wire) in level.lines.iter().zip(&known.wires) {
        let unit = if has(Layer::Units) { wire.unit.clone() } else { String::new() };
        let back = if has(Layer::Feedback) && wire.feedback { "leads back" } else { "" };
        let loops = if has(Layer::Loops) { looped(&wire.loops) } else { String::new() };
        row(&line.title, [unit, pace(wire.pace), back.to_owned(), loops]);
    }
    if count == 0 { "nothing is known of these layers\n".to_owned() } else { table.render() }
}

/// An algebraic loop of a model.
struct Looped {
    marks: Marks,
    /// Its blocks and unknowns in words.
    text: String,
}

impl Looped {
    /// The loop of this number.
    fn find(schedule: &Schedule, number: usize) -> Result<Self, Failure> {
        let count = schedule.loops.len();
        let Some(found) = schedule.loops.get(number - 1) else {
            let text = match count {
                0 => "the model has no algebraic loop".to_owned(),
                1 => format!("there is no loop {number}: the model has one"),
                _ => format!("there is no loop {number}: the model has {count}"),
            };
            return Err(Failure::usage(text).help("`blocksim check` numbers the loops in its notes"));
        };
        let steps = &schedule.steps[found.first..found.first + found.count];
        let mut paths: Vec<&str> = Vec::new();
        let mut blocks = BTreeSet::new();
        for block in steps.iter().map(|step| &schedule.blocks[step.block as usize]) {
            if !paths.contains(&block.path.as_str()) {
                paths.push(&block.path);
            }
            // A network stands for the blocks that it is made of.
            let parts = block.parts.iter().map(|part| &part.path);
            blocks.extend(parts.chain(block.parts.is_empty().then_some(&block.path)).cloned());
        }
        let cells = found.cells.iter().chain(&found.chosen);
        let unknowns: Vec<String> = cells.filter_map(|cell| signal_at(schedule, *cell)).collect();
        let text = format!("loop {number}: blocks {}; unknown: {}", shortened(&paths), shortened(&unknowns));
        Ok(Self { marks: Marks { blocks }, text })
    }
}

/// The signal in a cell, by its path and element.
pub(super) fn signal_at(schedule: &Schedule, cell: usize) -> Option<String> {
    let signal = schedule.signals.iter().find(|s| (s.offset..s.offset + s.shape.len()).contains(&cell))?;
    let element = cell - signal.offset;
    Some(if signal.shape.len() == 1 { signal.path.clone() } else { format!("{}[{element}]", signal.path) })
}

/// Names in a row; of many the first.
fn shortened(names: &[impl AsRef<str>]) -> String {
    const MOST: usize = 12;
    let first: Vec<&str> = names.iter().take(MOST).map(AsRef::as_ref).collect();
    let more = names.len().saturating_sub(MOST);
    first.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// The file of a level in a folder: `top.svg`, `arm.link1.svg`. Names of blocks are letters, digits and `_`.
fn in_folder(folder: &Path, level: &Level, ending: &str) -> std::path::PathBuf {
    let name = if level.path.is_empty() { "top".to_owned() } else { level.path.replace('/', ".") };
    folder.join(format!("{name}.{ending}"))
}

fn no_such_level(error: &PathError) -> Failure {
    let place = if error.found.is_empty() { "the diagram".to_owned() } else { format!("`{}`", error.found) };
    let said = if error.is_block {
        format!("`{}` in {place} has nothing inside", error.name)
    } else {
        format!("there is no `{}` in {place}", error.name)
    };
    Failure::usage(said).help(
        match blocksim_signal::closest(&error.name, error.subsystems.iter().map(String::as_str)) {
            Some(close) => format!("did you mean `{close}`?"),
            None if error.subsystems.is_empty() => "there are no subsystems in it".to_owned(),
            None => format!("the subsystems there are {}", error.subsystems.join(", ")),
        },
    )
}

/// Places in dots of the drawing without its edge and title.
fn as_json(level: &Level, layout: &Layout, known: Option<&(&Facts, LevelFacts)>) -> Value {
    let at = |point: Point| json!([point.x, point.y]);
    let pace = |facts: &Facts, pace: Option<Pace>| pace.map(|pace| facts.pace(pace).to_owned());
    let blocks = level.figures.iter().zip(&layout.nodes).enumerate().map(|(n, (figure, placed))| {
        let ports = figure.ports.iter().zip(&placed.ports).map(|(look, port)| {
            let kind = match look.kind {
                PortKind::Input => "input",
                PortKind::Output => "output",
                PortKind::Free => "conserving",
            };
            json!({ "name": look.name, "kind": kind, "at": at(port.at) })
        });
        let mut data = json!({
            "name": figure.name, "path": figure.path, "kind": figure.kind,
            "x": placed.x, "y": placed.y, "width": placed.width, "height": placed.height,
            "mirrored": placed.mirrored, "ports": ports.collect::<Vec<_>>(),
        });
        if let Some((facts, known)) = known {
            let block = &known.blocks[n];
            data["order"] = block.order.clone().into();
            data["rate"] = pace(facts, block.pace).into();
            data["loops"] = block.loops.clone().into();
        }
        data
    });
    let wires = level.lines.iter().zip(&layout.wires).enumerate().map(|(n, (line, wire))| {
        let segments = wire.segments.iter().map(|s| json!([at(s.from), at(s.to)]));
        let mut data = json!({
            "title": line.title, "bus": line.thick, "domain": line.domain.map(|domain| domain.to_string()),
            "segments": segments.collect::<Vec<_>>(),
            "junctions": wire.junctions.iter().map(|point| at(*point)).collect::<Vec<_>>(),
        });
        if let Some((facts, known)) = known {
            let wire = &known.wires[n];
            data["unit"] = wire.unit.clone().into();
            data["rate"] = pace(facts, wire.pace).into();
            data["feedback"] = wire.feedback.into();
            data["loops"] = wire.loops.clone().into();
        }
        data
    });
    json!({
        "v": 1, "path": level.path, "title": level.title, "width": layout.width, "height": layout.height,
        "blocks": blocks.collect::<Vec<_>>(), "wires": wires.collect::<Vec<_>>(),
    })
}
