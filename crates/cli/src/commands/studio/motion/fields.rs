//! Files with moves as the fields of the form, with nothing of them lost.

use blocksim_block::in_unit::AxisValue;
use blocksim_blocks::motion::JointPath;
use blocksim_robotics::motion::{AxisKind, AxisLimits};
use blocksim_syntax::{Name, Node, Shape, Tokens, read};
use serde_json::{Map, Value, json};

use super::draft::{Draft, TOOL_NUMBERS};

/// The words in which the fields are asked for: `typed` has them all, so that nothing of an earlier move stays.
const SINGLE: [&str; 11] = [
    "velocity",
    "acceleration",
    "speed",
    "share",
    "turning",
    "turning_acceleration",
    "jerk",
    "resolution",
    "zone",
    "wait",
    "comment",
];

/// The text of a file with moves as fields. `path` is what the language has read of it.
///
/// # Errors
/// What of the file the form cannot hold.
pub fn of_file(text: &str, path: &JointPath, limits: &[AxisLimits]) -> Result<Value, String> {
    let tree = read(text).map_err(|error| error.message)?;
    let mut reader = Fields { text, limits, odd: Vec::new() };
    let members = tree.members().unwrap_or_default();
    let list = member(members, "moves");
    let nexts = items(list);
    let mut steps: Vec<Value> = vec![reader.step(members)];
    for next in nexts {
        steps.push(reader.step(next.members().unwrap_or_default()));
    }
    let mut form = json!({
        "from": reader.axes(member(members, "start"), "start"),
        "singular": reader.number(member(members, "singular_limit"), "singular_limit", ""),
        "table": reader.number(member(members, "resolution"), "resolution", "deg"),
    });
    let (head, comments) = comments(text, &tree, list);
    form["head"] = head.into();
    for (step, comment) in steps.iter_mut().zip(comments) {
        step["comment"] = comment.into();
    }
    if nexts.is_empty() {
        merge(&mut form, steps.remove(0));
    } else {
        form["kind"] = "sequence".into();
        form["moves"] = steps.into();
    }
    // The form has to lead to the same moves, to the bit.
    let again = Draft::of(&form, limits).read().map(|asked| plain(asked.path(), limits));
    match again {
        Ok(again) if again == plain(path, limits) && reader.odd.is_empty() => Ok(form),
        _ if reader.odd.is_empty() => {
            Err("it has a value that is not used, or that no field can hold".to_owned())
        }
        _ => Err(format!("there is no field for {}", reader.odd.join(", "))),
    }
}

fn merge(form: &mut Value, step: Value) {
    if let (Value::Object(form), Value::Object(step)) = (form, step) {
        form.extend(step);
    }
}

/// Moves with positions in SI, whatever they were written in.
fn plain(path: &JointPath, limits: &[AxisLimits]) -> String {
    let mut path = path.clone();
    let bare = |all: &mut Vec<AxisValue>| {
        for (value, limits) in all.iter_mut().zip(limits) {
            // A unit of the wrong kind stays, as that is refused.
            if value.slides == Some(limits.kind == AxisKind::Sliding) {
                value.slides = None;
            }
        }
    };
    bare(&mut path.start);
    bare(&mut path.target);
    path.moves.iter_mut().for_each(|next| bare(&mut next.target));
    // With all digits, and the sign of a zero.
    format!("{path:?}")
}

fn member<'n>(members: &'n [(Name, Node)], name: &str) -> Option<&'n Node> {
    members.iter().find(|(known, _)| known.text == name).map(|(_, node)| node)
}

struct Fields<'t> {
    text: &'t str,
    limits: &'t [AxisLimits],
    /// Members that no field can hold.
    odd: Vec<String>,
}

impl Fields<'_> {
    /// A move with all its fields; those that are not given are empty.
    fn step(&mut self, members: &[(Name, Node)]) -> Value {
        let mut step: Map<String, Value> =
            SINGLE.into_iter().map(|name| (name.to_owned(), "".into())).collect();
        let mut set = |name: &str, value: Value| drop(step.insert(name.to_owned(), value));
        set("orientation", "free".into());
        set("profile", "sin2".into());
        for (name, unit) in [("zone", "mm"), ("wait", "s")] {
            set(name, self.number(member(members, name), name, unit));
        }
        let three = || json!(["", "", ""]);
        for name in ["via", "rotation", "object_point", "object_turn"] {
            set(name, three());
        }
        let Some(tool) = member(members, "tool").map(|tool| tool.members().unwrap_or_default()) else {
            set("kind", "joint".into());
            set("to", self.axes(member(members, "target"), "target"));
            for name in ["velocity", "acceleration"] {
                set(name, self.number(member(members, name), name, "%"));
            }
            return Value::Object(step);
        };
        set("kind", if member(tool, "via").is_some() { "circular" } else { "linear" }.into());
        for (name, field, unit) in
            [("target", "point", "mm"), ("via", "via", "mm"), ("rotation", "rotation", "deg")]
        {
            if let Some(node) = member(tool, name) {
                set(field, self.list(node, name, |_| unit));
            }
        }
        for name in ["orientation", "profile"] {
            if let Some(node) = member(tool, name) {
                set(name, self.word(node, name));
            }
        }
        for (name, field, unit, _) in TOOL_NUMBERS {
            set(field, self.number(member(tool, name), name, unit));
        }
        let object = member(tool, "work_object")
            .map(|object| object.members().unwrap_or_default())
            .unwrap_or_default();
        for (name, field, unit) in [("translation", "object_point", "mm"), ("rpy", "object_turn", "deg")] {
            if let Some(node) = member(object, name) {
                set(field, self.list(node, name, |_| unit));
            }
        }
        Value::Object(step)
    }

    fn axes(&mut self, node: Option<&Node>, name: &str) -> Value {
        let limits = self.limits;
        let unit = |n: usize| match limits.get(n).map(|limits| limits.kind) {
            Some(AxisKind::Sliding) => "mm",
            _ => "deg",
        };
        node.map_or_else(|| json!([]), |node| self.list(node, name, unit))
    }

    fn list<'u>(&mut self, node: &Node, name: &str, unit: impl Fn(usize) -> &'u str) -> Value {
        let Shape::List(items) = &node.value else { return self.not_shown(node, name, json!([])) };
        items.iter().enumerate().map(|(n, item)| self.number(Some(item), name, unit(n))).collect()
    }

    /// A number as it stands in the field: as it is written, without the unit that stands beside the field.
    fn number(&mut self, node: Option<&Node>, name: &str, unit: &str) -> Value {
        let Some(node) = node else { return "".into() };
        let text = match &node.value {
            Shape::Text(text) => text.trim().to_owned(),
            Shape::Number(_) => self.text[node.span.clone()].to_owned(),
            _ => return self.not_shown(node, name, "".into()),
        };
        if let Some(front) = text.strip_suffix(unit).map(str::trim_end).filter(|_| is_of_field(unit))
            && front.parse::<f64>().is_ok_and(f64::is_finite)
        {
            return front.into();
        }
        match text.parse::<f64>() {
            // A bare number of a file is one in SI.
            Ok(number) if number.is_finite() => match unit {
                "deg" => format!("{text} rad"),
                "mm" => format!("{text} m"),
                "mm/s" => format!("{text} m/s"),
                "deg/s" => format!("{text} rad/s"),
                "deg/s^2" => format!("{text} rad/s^2"),
                "%" => format!("{} %", (1e11 * number).round() / 1e9),
                _ => text,
            }
            .into(),
            _ => text.into(),
        }
    }

    /// `Text("free")`, or the text alone.
    fn word(&mut self, node: &Node, name: &str) -> Value {
        match &node.value {
            Shape::Text(word) => word.as_str().into(),
            Shape::Tuple(Some(kind), items) if kind.text == "Text" => match items.as_slice() {
                [Node { value: Shape::Text(word), .. }] => word.as_str().into(),
                _ => self.not_shown(node, name, "".into()),
            },
            _ => self.not_shown(node, name, "".into()),
        }
    }

    fn not_shown(&mut self, node: &Node, name: &str, instead: Value) -> Value {
        self.odd.push(format!("`{name}` as {}", node.describe()));
        instead
    }
}

/// Whether the unit stands beside the fields that have it, so that it need not stand in them.
fn is_of_field(unit: &str) -> bool {
    matches!(unit, "deg" | "mm" | "s")
}

/// The comments of a file: those above it, and those of each move, line by line. `list` are the moves behind the first one.
fn comments(text: &str, tree: &Node, list: Option<&Node>) -> (String, Vec<String>) {
    let nexts = items(list);
    let mut head = Vec::new();
    let mut steps: Vec<Vec<&str>> = vec![Vec::new(); nexts.len() + 1];
    for token in Tokens::new(text).filter(|token| token.kind.is_comment()) {
        let (at, written) = (token.start(), token.of(text));
        let lines = match written.strip_prefix("/*") {
            Some(block) => block.strip_suffix("*/").unwrap_or(block),
            None => written.trim_start_matches('/'),
        };
        let lines = lines.lines().map(|line| line.strip_prefix(' ').unwrap_or(line).trim_end());
        // Behind a move on its last line, within it, or above it.
        let is_behind = |node: &Node| at >= node.span.end && !text[node.span.end..at].contains('\n');
        let step = match list.filter(|list| list.span.contains(&at)) {
            None => 0,
            Some(_) => nexts
                .iter()
                .position(|next| at < next.span.end || is_behind(next))
                .map_or(nexts.len(), |n| n + 1),
        };
        if at < tree.span.start { head.extend(lines) } else { steps[step].extend(lines) }
    }
    (head.join("\n"), steps.into_iter().map(|lines| lines.join("\n")).collect())
}

fn items(list: Option<&Node>) -> &[Node] {
    match list.map(|list| &list.value) {
        Some(Shape::List(items)) => items,
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::plan::Asked;

    fn limits() -> Vec<AxisLimits> {
        let of = |kind| AxisLimits { kind, lower: -3.0, upper: 3.0, speed: 1.0, acceleration: 1.0 };
        vec![of(AxisKind::Turning), of(AxisKind::Sliding)]
    }

    fn form(text: &str) -> Result<Value, String> {
        let asked = Asked::in_words(text.to_owned()).unwrap_or_else(|failure| panic!("{}", failure.text()));
        of_file(text, asked.path(), &limits())
    }

    #[test]
    fn everything_of_a_file_is_in_the_fields() {
        let text = r#"// Above.
/* And
 more. */
JointMove(
    start: ["0.1 rad", 0.25],
    // First.
    tool: (
        target: [1.3, "-100 mm", "9e2 mm"], // there
        via: ["1 m", "0 mm", "900 mm"], work_object: (rpy: [0, "90 deg", 0]),
        orientation: Text("interpolated"), rotation: ["10 deg", "0.2 rad", "0 deg"],
        velocity: 0.4, acceleration: 0.07, rotation_velocity: "20 deg/s", jerk: "3 m/s^3", profile: Text("s-curve"),
    ),
    zone: "20 mm",
    moves: [
        // Down.
        (target: ["10 deg", "5 cm"], velocity: "30 %", acceleration: 0.3, wait: 0.5), // slowly
        (target: ["0 deg", "5 mm"], velocity: "30 %", acceleration: "30 %"),
        // The end.
    ],
    singular_limit: 0.02, resolution: "1 deg", result: (duration: "3 s"),
)
"#;
        let form = form(text).unwrap();
        assert_eq!(form["from"], json!(["0.1 rad", "0.25 m"]));
        assert_eq!(form["head"], "Above.\nAnd\nmore.");
        let [first, second, third] = [0, 1, 2].map(|n| &form["moves"][n]);
        assert_eq!(first["point"], json!(["1.3 m", "-100", "9e2"]));
        assert_eq!([&first["share"], &first["speed"], &first["zone"]], ["7 %", "0.4 m/s", "20"]);
        assert_eq!(
            [&first["comment"], &second["comment"], &third["comment"]],
            ["First.\nthere", "Down.\nslowly", "The end."]
        );
        assert_eq!(second["to"], json!(["10", "5 cm"]));
        assert_eq!([&form["singular"], &form["table"]], ["0.02", "1"]);
        // And it comes out of them again, as often as one likes.
        let again = Draft::of(&form, &limits()).text;
        assert_eq!(
            super::of_file(&again, Asked::in_words(again.clone()).unwrap().path(), &limits()).unwrap(),
            form
        );
    }

    #[test]
    fn what_no_field_can_hold_is_refused() {
        let unused = r#"JointMove(start: [0, 0], target: [1, 1], velocity: 0.4, acceleration: 0.3,
            tool: (target: [1, 1, 1], velocity: 0.1, acceleration: 0.1))"#;
        assert!(form(unused).unwrap_err().contains("not used"));
    }

    #[test]
    fn a_single_move_has_its_fields_alone() {
        let form = form(
            r#"JointMove(start: [0, 0], target: ["-0 deg", "1 mm"], velocity: "40 %", acceleration: "30 %")"#,
        )
        .unwrap();
        assert_eq!([&form["kind"], &form["velocity"]], ["joint", "40 %"]);
        assert_eq!(form["to"], json!(["-0", "1"]));
    }
}
