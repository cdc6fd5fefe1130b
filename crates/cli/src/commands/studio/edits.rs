//! What somebody does to the picture, done to the texts; and what is needed to do it: ports, kinds, choices.

use std::collections::BTreeMap;
use std::path::Path;

use blocksim_block::BlockInfo;
use blocksim_diagram::{Content, Model, ModelBlock, PortKind, SourceFile, Sources, targets};
use blocksim_edit::{
    Change, NewBlock, Project, Refusal, add, connect, delete, disconnect_end, kind, proposed_name, rename,
    required, wrap,
};
use blocksim_report::Report;
use blocksim_studio::Reply;
use blocksim_syntax::{Node, Shape};
use serde_json::{Value, json};

use super::values::Changes;
use crate::commands::blocks::{everything, found, interface};
use crate::editing::with_project;
use crate::terminal::console::Console;
use crate::terminal::prose::{first_sentence, prose};

/// Most kinds that a search lists.
const MOST: usize = 60;

/// What the page needs beside the drawings: ports of all blocks, where they are drawn, and what can be chosen.
pub fn wiring(model: &Model, sources: &Sources, report: &Report, drawn: &mut Value) {
    for (drawing, data) in
        report.diagram.drawings.iter().zip(drawn["drawings"].as_array_mut().into_iter().flatten())
    {
        let ports = drawing.ports.iter().map(|port| {
            json!([port.node, port.end, port.kind.to_string(), port.at[0].round(), port.at[1].round()])
        });
        data["ports"] = ports.collect();
        data["ends"] = drawing.nets.iter().map(|net| json!(net.ends)).collect();
    }
    let mut levels: BTreeMap<&str, &Model> = BTreeMap::new();
    gather(model, &mut levels);
    let uses = |file| levels.values().filter(|level| level.ast.file == file).count();
    for data in drawn["levels"].as_array_mut().into_iter().flatten() {
        let Some(level) = data["path"].as_str().and_then(|path| levels.get(path)) else { continue };
        let file: SourceFile = sources.file(level.ast.file);
        data["file"] = file.path.display().to_string().into();
        data["sharers"] = uses(level.ast.file).into();
        data["ports"] = level
            .blocks
            .iter()
            .map(|block| (block.name.clone(), ports(block)))
            .collect::<serde_json::Map<_, _>>()
            .into();
        data["lines"] = level
            .blocks
            .iter()
            .map(|block| (block.name.clone(), json!(line(&file, block))))
            .collect::<serde_json::Map<_, _>>()
            .into();
        data["choices"] = level
            .blocks
            .iter()
            .filter_map(|block| {
                let variant = block.variant.as_ref()?;
                Some((
                    block.name.clone(),
                    json!({ "chosen": variant.chosen, "of": variant.of, "by": variant.by }),
                ))
            })
            .collect::<serde_json::Map<_, _>>()
            .into();
    }
    drawn["choices"] =
        model.ast.parameters.iter().filter_map(|(name, node)| choice(&name.text, node)).collect();
}

fn gather<'m>(model: &'m Model, all: &mut BTreeMap<&'m str, &'m Model>) {
    all.insert(&model.path, model);
    for block in &model.blocks {
        if let Content::Diagram(inside) = &block.content {
            gather(inside, all);
        }
    }
}

/// Ports of a block: name, `i`, `o` or `c`, what they carry, and whether they may stay without a wire.
fn ports(block: &ModelBlock) -> Value {
    let optional = |name: &str| match &block.content {
        Content::Block { interface, .. } => {
            interface.inputs.iter().any(|input| input.name == name && input.default.is_some())
        }
        _ => false,
    };
    let inputs = block.inputs().into_iter().map(|name| json!([name, "i", "", optional(&name)]));
    let outputs = block.outputs().into_iter().map(|name| json!([name, "o", "", true]));
    let conserving = block.ports().into_iter().map(|name| {
        let domain = match block.port(&name) {
            Some(PortKind::Conserving(domain)) => domain.to_string(),
            _ => String::new(),
        };
        json!([name, "c", domain, false])
    });
    inputs.chain(outputs).chain(conserving).collect()
}

/// The line on which a block is declared.
fn line(file: &SourceFile, block: &ModelBlock) -> usize {
    file.text.get(..block.place.span.start).map_or(0, |before| before.matches('\n').count()) + 1
}

/// A parameter that is one of several words.
fn choice(name: &str, node: &Node) -> Option<Value> {
    let Shape::Struct(Some(word), members) = &node.value else { return None };
    let member =
        |name: &str| members.iter().find(|(known, _)| known.text == name).map(|(_, node)| &node.value);
    let (Some(Shape::Text(default)), Some(Shape::List(of))) = (member("default"), member("of")) else {
        return None;
    };
    let word_of = |item: &Node| if let Shape::Text(text) = &item.value { Some(text.clone()) } else { None };
    let of: Vec<String> = of.iter().filter_map(word_of).collect();
    (word.text == "Choice").then(|| json!({ "name": name, "chosen": default, "of": of }))
}

fn refused(refusal: Refusal) -> Reply {
    let mut reason = json!({ "message": refusal.message, "help": refusal.help.unwrap_or_default() });
    if refusal.is_shared {
        reason["shared"] = true.into();
    }
    Reply::Refused(reason)
}

/// Texts of a request.
fn text<'b>(body: &'b Value, name: &str) -> &'b str {
    body[name].as_str().unwrap_or_default()
}

fn texts(body: &Value, name: &str) -> Vec<String> {
    body[name].as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
}

/// Changes the model.
pub fn edit(root: &Path, model: &Path, body: &Value, changes: &mut Changes, console: Console) -> Reply {
    let shared = body["all"] == true;
    let what = |project: &Project| -> Option<Result<Change, Refusal>> {
        let change = match text(body, "do") {
            "rename" => rename(project, text(body, "block"), text(body, "name").trim()),
            "delete" => delete(project, &texts(body, "blocks")),
            "connect" => connect(project, text(body, "from"), text(body, "to")),
            "disconnect" => disconnect_end(project, text(body, "end")),
            "wrap" => wrap(project, &texts(body, "blocks"), text(body, "name")),
            "add" => {
                let given = body["parameters"].as_object().into_iter().flatten();
                let parameters: Vec<(String, String)> = given
                    .filter_map(|(name, value)| Some((name.clone(), value.as_str()?.to_owned())))
                    .collect();
                let into = texts(body, "into");
                add(
                    project,
                    &NewBlock {
                        level: text(body, "level"),
                        kind: text(body, "kind"),
                        name: text(body, "name"),
                        parameters: &parameters,
                        beside: text(body, "beside"),
                        into: &into,
                    },
                )
            }
            _ => return None,
        };
        Some(change)
    };
    if text(body, "do") == "choose" {
        return choose(model, body, changes, console);
    }
    match with_project(model, Some(root), shared, what) {
        None => Reply::refused("a diagram cannot be changed in this way", ""),
        Some(Err(refusal)) => refused(refusal),
        Some(Ok(change)) => written(change, changes),
    }
}

fn written(change: Change, changes: &mut Changes) -> Reply {
    let Change { texts, summary, notes, block } = change;
    let mut reply = if texts.is_empty() {
        Reply::Data(json!({ "message": summary, "difference": "" }))
    } else {
        changes.write_all(texts, &summary)
    };
    if let Reply::Data(data) = &mut reply {
        data["notes"] = notes.into();
        data["block"] = block.into();
    }
    reply
}

/// Has a variant, or a parameter that is one of several words, be another one.
fn choose(model: &Path, body: &Value, changes: &mut Changes, console: Console) -> Reply {
    let (level, by, value) = (text(body, "level"), text(body, "by"), text(body, "value"));
    let disk = crate::disk::Disk::default();
    let sources = Sources::new(&disk);
    let (known, _) = targets(&sources, model);
    // The name is looked up as the diagram does it: here, then in the diagrams around.
    let mut around: Vec<&str> = vec![level];
    while let Some(slash) = around.last().and_then(|path| path.rfind('/')) {
        around.push(&level[..slash]);
    }
    around.push("");
    let mut name = by.to_owned();
    let mut found = None;
    for path in around {
        let target = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        let Some(one) = known.iter().find(|known| known.name == target) else { continue };
        found = Some(target);
        // What is handed on under another name is chosen where it comes from.
        let written = one.written.trim_matches('"');
        let is_name = !path.is_empty()
            && one.written.starts_with('"')
            && written.chars().all(|sign| sign.is_ascii_alphanumeric() || sign == '_');
        if !is_name {
            break;
        }
        written.clone_into(&mut name);
    }
    let Some(target) = found else {
        return Reply::refused(
            format!("`{by}` is not a parameter of this model"),
            "an expression chooses here: change it in the text",
        );
    };
    // That the model is still the one that was seen is known by its version.
    changes.replace(model, (&target, value), None, console)
}

/// Kinds that some words are about; all of them, by category, without any.
pub fn kinds(body: &Value) -> Reply {
    let words = text(body, "words").trim();
    let all: Vec<&BlockInfo> =
        if words.is_empty() { everything() } else { found(words).into_iter().take(MOST).collect() };
    let data = |info: &&BlockInfo| json!({ "kind": info.kind, "category": info.category, "does": first_sentence(info.doc) });
    Reply::Data(all.iter().map(data).collect())
}

/// What is asked of somebody who adds a block of a kind.
pub fn kind_of(root: &Path, model: &Path, body: &Value) -> Reply {
    let name = text(body, "kind");
    let (Some(info), Some(fields)) = (kind(name), required(name)) else {
        return Reply::refused(format!("there is no block kind `{name}`"), "");
    };
    let level = text(body, "level");
    let proposed = with_project(model, Some(root), true, |project| proposed_name(project, level, name));
    let field = |field: &blocksim_edit::Field| json!({ "name": field.name, "unit": field.unit, "doc": prose(field.doc.trim()), "example": field.example });
    let others = info.parameters.iter().filter(|parameter| parameter.default.is_some());
    let others = others.map(|parameter| {
        let default = parameter.default.and_then(blocksim_block::in_diagram).unwrap_or_default();
        json!({ "name": parameter.name, "unit": parameter.unit, "doc": prose(parameter.doc.trim()), "default": default })
    });
    let ports = interface(info).map(|interface| {
        let inputs = interface.inputs.iter().map(|input| json!([input.name, "i", ""]));
        let outputs = interface.outputs.iter().map(|output| json!([output.name, "o", ""]));
        let conserving = interface.ports.iter().map(|port| json!([port.name, "c", port.domain.to_string()]));
        inputs.chain(outputs).chain(conserving).collect::<Vec<_>>()
    });
    Reply::Data(json!({
        "kind": info.kind, "category": info.category,
        "doc": prose(info.doc.split("```").next().unwrap_or_default().trim()),
        "name": proposed.unwrap_or_default(),
        "fields": fields.iter().map(field).collect::<Vec<_>>(), "others": others.collect::<Vec<_>>(),
        "ports": ports,
    }))
}
