//! `blocksim plugin show`: what a plug-in says of itself.

use std::path::Path;

use blocksim_block::{CodePolicy, Decision, LoadError};
use blocksim_host::{Kind, Library, Quantity, offer, open, recalled};
use blocksim_numbers::format::significant;
use blocksim_terminal::{Align, Table};
use serde_json::{Value, json};

use crate::args::plugin::{PluginShowArgs, TargetName};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::loaded::tell_builds;
use crate::terminal::console::Console;
use crate::terminal::prose::prose;
use crate::trust::{Plugins, Purpose};

/// Tells which controllers a plug-in has: it is built and loaded if it is trusted, else shown as it was loaded last.
///
/// # Errors
/// Why it cannot be built or loaded.
pub fn show(args: &PluginShowArgs, console: Console) -> Outcome {
    tell_builds();
    let library = library(args, console)
        .map_err(|error| Failure::new(Exit::Files, error.code, error.message).perhaps_help(error.help))?;
    console.data(&match args.json {
        true => library.blocks.iter().map(|kind| format!("{}\n", data(library, kind))).collect(),
        false => text(library, args),
    })?;
    Ok(Exit::Done)
}

fn library(args: &PluginShowArgs, console: Console) -> Result<&'static Library, LoadError> {
    let (plugins, here) = (Plugins::of(args.plugins, Purpose::Look), Path::new("."));
    match plugins.decide(here, &args.library) {
        Decision::Load => {
            let library = open(here, &args.library, args.target.into())?;
            plugins.remember(here, &args.library, &offer(library));
            Ok(library)
        }
        Decision::Recall { offer, warning, refusal } => {
            let library = recalled(&args.library, &offer).map_err(|_| refusal)?;
            if let Some(warning) = warning {
                let help = warning.help.map_or(String::new(), |help| format!("\n  = help: {help}"));
                console.say(&format!("warning: {}{help}", warning.message));
            }
            Ok(library)
        }
        Decision::Refuse(error) => Err(error),
    }
}

fn text(library: &Library, args: &PluginShowArgs) -> String {
    let mut text = format!("{} {}, from {}\n", library.name, library.version, library.path.display());
    for kind in &library.blocks {
        text.push_str(&format!("\n{}\n\n{}\n", kind.name, prose(kind.doc.trim()).trim_end()));
        let ports = [(&kind.inputs, "input"), (&kind.outputs, "output")];
        let rows = ports.iter().flat_map(|(list, side)| list.iter().map(|quantity| (quantity, *side)));
        text.push_str(&table("Ports", rows));
        text.push_str(&table("Parameters", kind.parameters.iter().map(|quantity| (quantity, ""))));
        let states = [(&kind.continuous, "continuous"), (&kind.discrete, "sampled")];
        let rows = states.iter().flat_map(|(list, side)| list.iter().map(|quantity| (quantity, *side)));
        text.push_str(&table("States", rows));
        text.push_str(&format!("\nIn a diagram\n  {}\n", call(kind, args)));
    }
    text
}

/// A row for each quantity below a title; nothing where there is none.
fn table<'a>(title: &str, rows: impl Iterator<Item = (&'a Quantity, &'a str)>) -> String {
    let columns = [
        ("  name", Align::Left),
        ("", Align::Left),
        ("unit", Align::Left),
        ("default", Align::Left),
        ("", Align::Left),
    ];
    let mut table = Table::new(&columns);
    let mut is_empty = true;
    for (quantity, side) in rows {
        is_empty = false;
        let length = if quantity.length == 1 { String::new() } else { format!("[{}]", quantity.length) };
        let unit = if quantity.unit.is_empty() { "any" } else { quantity.unit };
        let default = quantity.default.map_or_else(|| "-".to_owned(), numbers);
        table.row([
            format!("  {}{length}", quantity.name),
            side.to_owned(),
            unit.to_owned(),
            default,
            quantity.doc.to_owned(),
        ]);
    }
    if is_empty { String::new() } else { format!("\n{title}\n{}", table.render()) }
}

fn numbers(values: &[f64]) -> String {
    let each: Vec<String> = values.iter().map(|x| short(*x)).collect();
    if let [one] = &each[..] { one.clone() } else { format!("[{}]", each.join(", ")) }
}

/// As it stands in a program where that is short.
fn short(x: f64) -> String {
    let plain = x.to_string();
    if plain.len() <= 8 { plain } else { significant(x, 4) }
}

/// The line of a diagram that makes this block; parameters without a default must be filled in.
fn call(kind: &Kind, args: &PluginShowArgs) -> String {
    let needed = kind.parameters.iter().filter(|parameter| parameter.default.is_none());
    let needed: Vec<String> = needed.map(|parameter| format!("{:?}: ...", parameter.name)).collect();
    let parameters = match needed.is_empty() {
        true => String::new(),
        false => format!(", parameters: {{ {} }}", needed.join(", ")),
    };
    let target = if args.target == TargetName::Wasm { ", target: Wasm" } else { "" };
    format!("Plugin(library: {:?}, block: {:?}{parameters}{target})", args.library, kind.name)
}

/// A controller for programs.
pub fn data(library: &Library, kind: &Kind) -> Value {
    let list = |quantities: &[Quantity]| -> Vec<Value> {
        let one = |q: &Quantity| {
            let reads: Vec<&str> = q.reads.iter().filter_map(|at| Some(kind.inputs.get(*at)?.name)).collect();
            // Infinity has no place in JSON.
            let default =
                q.default.map(|values| values.iter().map(|x| json!(x.to_string())).collect::<Vec<_>>());
            json!({
                "name": q.name, "unit": q.unit, "length": q.length, "default": default, "reads": reads, "doc": q.doc,
            })
        };
        quantities.iter().map(one).collect()
    };
    json!({
        "v": 1,
        "type": "controller",
        "plugin": library.name,
        "version": library.version,
        "library": library.path.display().to_string(),
        "kind": kind.name,
        "doc": kind.doc,
        "parameters": list(&kind.parameters),
        "inputs": list(&kind.inputs),
        "outputs": list(&kind.outputs),
        "continuous_states": list(&kind.continuous),
        "discrete_states": list(&kind.discrete),
    })
}
