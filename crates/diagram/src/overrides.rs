//! `--set target=value`: parameters that the command line replaces.

use std::cell::{Cell, RefCell};
use std::path::Path;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_signal::{Value, closest};

use crate::source::Sources;
use blocksim_syntax::{Node, Shape, read};

/// What stands in the place of a file for values from the command line.
/// They come from `--set` and from what stands for it, such as `--over` of a sweep.
pub(crate) const COMMAND_LINE: &str = "command line";

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
    /// Who had this name.
    pub used: RefCell<Used>,
    /// Whether a parameter of the top diagram had it.
    pub of_parameter: Cell<bool>,
    /// What the value was taken for: `45 deg`.
    pub meant: RefCell<Option<String>>,
    /// What it is worth, where that is one value.
    pub worth: RefCell<Option<Value>>,
}

/// Who had the name of an override, so far.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) enum Used {
    #[default]
    Never,
    /// Alternatives alone that are not built, such as this one: "`dc` of `motor`".
    Apart(String),
    Here,
}

/// A value of `--set`, as it was understood.
#[derive(Debug, Clone, PartialEq)]
pub struct Replaced {
    /// What was replaced: `demand.after`.
    pub target: String,
    /// The value as written: `45`.
    pub written: String,
    /// With the unit that it was taken in: `45 deg`.
    pub value: String,
    /// What it is worth, where it is a number or a truth value.
    pub worth: Option<Value>,
}

impl Override {
    /// Where the value stands.
    pub(crate) fn place(&self) -> Place {
        Place { file: self.file, span: 0..self.text.len() }
    }

    /// What is replaced: `arm/link3.drive`.
    pub(crate) fn target(&self) -> &str {
        self.text.split('=').next().unwrap_or_default().trim()
    }

    /// The value as it was understood.
    pub(crate) fn replaced(&self) -> Replaced {
        let written = self.text.split_once('=').map_or("", |(_, value)| value).trim().to_owned();
        let value = self.meant.borrow().clone().unwrap_or_else(|| written.clone());
        Replaced { target: self.target().to_owned(), written, value, worth: self.worth.borrow().clone() }
    }
}

/// A name and those of the members below it: `target[0]` is the member `[0]` of `target`.
pub(crate) fn members(names: &str) -> Vec<String> {
    let of_part = |name: &str| {
        let end = name.find('[').filter(|at| *at > 0).unwrap_or(name.len());
        let (head, items) = name.split_at(end);
        let items: Vec<String> = items.split_inclusive(']').map(str::to_owned).collect();
        std::iter::once(head.to_owned()).chain(items)
    };
    names.split('.').flat_map(of_part).collect()
}

/// Whether a parameter is meant although a block of the diagram bears its name: what the parameter does not have is meant for the
/// block. `member` is what is named of it.
pub(crate) fn before_block(value: &Value, member: Option<&String>) -> bool {
    member.is_none_or(|member| value.get(member).is_some())
}

/// Takes `target=value` apart.
pub(crate) fn parse(sources: &Sources, text: &str) -> Result<Override, Problem> {
    let file = sources.hold(Path::new(COMMAND_LINE), text);
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
    let names = members(names);
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
        used: RefCell::default(),
        of_parameter: Cell::new(false),
        meant: RefCell::default(),
        worth: RefCell::default(),
    })
}

/// Replaces a member of nested sets and lists.
pub(crate) fn replace(value: &mut Value, names: &[String], new: Value) -> Result<(), String> {
    let Some((name, rest)) = names.split_first() else {
        if let (Value::Number(old), Value::Number(quantity)) = (&*value, &new)
            && quantity.dimension.is_none()
            && !old.dimension.is_none()
        {
            // The unit was settled before; what is left is a value of which no text says anything.
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
        Value::List(items) => {
            let index = name.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
            let count = items.len();
            match index.and_then(|index| index.parse::<usize>().ok()).and_then(|index| items.get_mut(index)) {
                Some(item) => replace(item, rest, new),
                None => Err(format!(
                    "there is no `{name}` in a list of {count}; items are counted from 0, as in `[0]`"
                )),
            }
        }
        _ => Err(format!("`{name}` is taken of {}, which has no members", value.describe())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toys::NoFiles;
    use blocksim_signal::{Dimension, Quantity, Unit};

    fn target(text: &str) -> (String, Vec<String>) {
        let over = parse(&Sources::new(&NoFiles), text).expect("an override");
        (over.path, over.names)
    }

    fn number(value: f64, dimension: Dimension) -> Value {
        Value::Number(Quantity { value, dimension })
    }

    #[test]
    fn items_of_lists_are_members_in_brackets() {
        assert_eq!(target("move.target[2]=1").1, ["move", "target", "[2]"]);
        let mut list = Value::List(vec![Value::from(1.0), Value::from(2.0)]);
        replace(&mut list, &["[1]".to_owned()], Value::from(5.0)).expect("an item");
        assert_eq!(list, Value::List(vec![Value::from(1.0), Value::from(5.0)]));
        assert!(replace(&mut list, &["[2]".to_owned()], Value::from(5.0)).is_err());
        assert!(replace(&mut list, &["first".to_owned()], Value::from(5.0)).is_err());
    }

    #[test]
    fn the_last_slash_divides_folders_from_names() {
        let names = |names: &[&str]| names.iter().map(ToString::to_string).collect::<Vec<_>>();
        assert_eq!(target("kp=2"), (String::new(), names(&["kp"])));
        assert_eq!(target(" pid.kp = 2"), (String::new(), names(&["pid", "kp"])));
        assert_eq!(target("arm/pid.gains.kp=2"), ("arm/pid".to_owned(), names(&["gains", "kp"])));
    }

    #[test]
    fn the_value_stands_where_it_is_written() {
        let over = parse(&Sources::new(&NoFiles), "a =  [1, 2] ").expect("an override");
        assert_eq!(&over.text[over.node.span.clone()], "[1, 2]");
        assert!(matches!(over.node.value, Shape::List(_)));
        let over = parse(&Sources::new(&NoFiles), "a=2 m/s").expect("an override");
        assert_eq!(over.node.value, Shape::Text("2 m/s".to_owned()));
    }

    #[test]
    fn an_incomplete_override_is_refused() {
        for (text, message) in [
            ("kp", "`--set` needs a name and a value"),
            ("kp= ", "the value is missing"),
            ("arm/pid=2", "which parameter of the block?"),
            ("arm/pid.=2", "a name is missing"),
            ("=2", "a name is missing"),
        ] {
            assert_eq!(parse(&Sources::new(&NoFiles), text).expect_err("a problem").message, message);
        }
    }

    #[test]
    fn a_member_is_replaced_and_a_bare_number_keeps_the_unit() {
        let metre = Unit::parse("m").expect("a unit").dimension;
        let mut value = Value::Set(vec![("length".to_owned(), number(1.0, metre))]);
        let path = ["length".to_owned()];
        replace(&mut value, &path, number(3.0, Dimension::NONE)).expect("a member");
        assert_eq!(value, Value::Set(vec![("length".to_owned(), number(3.0, metre))]));
        let error = replace(&mut value, &["lenght".to_owned()], Value::Bool(true)).expect_err("no member");
        assert_eq!(error, "there is no `lenght`; did you mean `length`?");
        let below = ["length".to_owned(), "x".to_owned()];
        assert!(
            replace(&mut value, &below, Value::Bool(true)).expect_err("no set").contains("has no members")
        );
    }
}
