//! `--set target=value`: parameters that the command line replaces.

use std::cell::Cell;
use std::path::Path;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_signal::{Value, closest};

use crate::source::Sources;
use crate::tree::{Node, Shape, read};

/// A parameter that is replaced.
#[derive(Debug)]
pub(crate) struct Override {
    /// As written, `arm/link3.drive=dc`.
    pub text: String,
    /// Path of the block; empty for a name of the top diagram.
    pub path: String,
    /// Name of the parameter and of members of sets below it.
    pub names: Vec<String>,
    /// File that holds the value, for messages.
    pub file: FileId,
    /// The value as RON, if it is.
    pub node: Node,
    /// Whether something had this name.
    pub used: Cell<bool>,
}

impl Override {
    /// Where the value stands.
    pub(crate) fn place(&self) -> Place {
        Place { file: self.file, span: 0..self.text.len() }
    }
}

/// Takes `target=value` apart.
pub(crate) fn parse(sources: &Sources, text: &str) -> Result<Override, Problem> {
    let file = sources.hold(Path::new("--set"), text);
    let fail = |message: &str| {
        Problem::error("unknown_override", message.to_owned())
            .at(&Place { file, span: 0..text.len() }, "")
            .help(
                "write --set name=value, --set block.parameter=value or --set path/to/block.parameter=value",
            )
    };
    let Some((target, value)) = text.split_once('=') else {
        return Err(fail("`--set` needs a name and a value"));
    };
    let (target, trimmed) = (target.trim(), value.trim());
    if trimmed.is_empty() {
        return Err(fail("the value is missing"));
    }
    let start = text.len() - value.len() + (value.len() - value.trim_start().len());
    let folder = target.rfind('/').map_or(0, |slash| slash + 1);
    let (path, names) = match target[folder..].split_once('.') {
        Some((block, names)) if folder > 0 => (format!("{}{block}", &target[..folder]), names),
        _ if folder > 0 => return Err(fail("which parameter of the block?")),
        _ => (String::new(), target),
    };
    let names: Vec<String> = names.split('.').map(str::to_owned).collect();
    if names.iter().any(String::is_empty) {
        return Err(fail("a name is missing"));
    }
    let span = start..start + trimmed.len();
    let value = match read(trimmed) {
        Ok(node) => node.value,
        Err(_) => Shape::Text(trimmed.to_owned()),
    };
    // A text is an expression; its place is one byte before its first letter, where the quote would be.
    let span = match value {
        Shape::Text(_) | Shape::Word(_) => span.start.saturating_sub(1)..span.end,
        _ => span,
    };
    Ok(Override {
        text: text.to_owned(),
        path,
        names,
        file,
        node: Node { span, value },
        used: Cell::new(false),
    })
}

/// Replaces a member of nested sets and lists.
pub(crate) fn replace(value: &mut Value, names: &[String], new: Value) -> Result<(), String> {
    let Some((name, rest)) = names.split_first() else {
        if let (Value::Number(old), Value::Number(quantity)) = (&*value, &new)
            && quantity.dimension.is_none()
            && !old.dimension.is_none()
        {
            // A bare number takes the unit of what it replaces, in SI.
            *value =
                Value::Number(blocksim_signal::Quantity { value: quantity.value, dimension: old.dimension });
            return Ok(());
        }
        *value = new;
        return Ok(());
    };
    match value {
        Value::Set(members) => {
            let known: Vec<String> = members.iter().map(|(name, _)| name.clone()).collect();
            match members.iter_mut().find(|(known, _)| known == name) {
                Some((_, member)) => replace(member, rest, new),
                None => Err(match closest(name, known.iter().map(String::as_str)) {
                    Some(close) => format!("there is no `{name}`; did you mean `{close}`?"),
                    None => format!("there is no `{name}`; known are {}", crate::problems::list(&known)),
                }),
            }
        }
        _ => Err(format!("`{name}` is asked of {}, which has no members", value.describe())),
    }
}
