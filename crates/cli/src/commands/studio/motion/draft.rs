//! Moves as somebody types them, as the text of a file with moves: the text knows of which field each piece is.

use std::ops::Range;

use blocksim_block::ParamError;
use blocksim_blocks::motion::{JointPath, NextMove};
use blocksim_robotics::motion::{AxisKind, AxisLimits};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::commands::plan::request::{quoted, united};
use crate::commands::plan::{Asked, on_command_line};
use crate::failure::Failure;

/// A field of the form: of which move (counted from 0), its name, and which of several.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field {
    step: usize,
    name: &'static str,
    n: Option<usize>,
}

/// What is wrong with a move, and at which of its fields.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Trouble {
    step: Option<usize>,
    name: Option<&'static str>,
    n: Option<usize>,
    message: String,
    help: String,
}

/// Moves as text.
#[derive(Debug, Default)]
pub struct Draft {
    /// As it would stand in a file.
    pub text: String,
    marks: Vec<(Range<usize>, Field)>,
    /// Where whole lists of fields stand.
    lists: Vec<(Range<usize>, Field)>,
    /// Where the positions at the start stand.
    start: Range<usize>,
    /// Where the members of each move stand.
    moves: Vec<Range<usize>>,
    missing: Vec<Trouble>,
}

/// The members of a path of the tool that are one number each: the name in the file, the field, the unit of a bare number, and
/// whether it has to be there.
pub const TOOL_NUMBERS: [(&str, &str, &str, bool); 6] = [
    ("velocity", "speed", "mm/s", true),
    ("acceleration", "share", "%", true),
    ("rotation_velocity", "turning", "deg/s", false),
    ("rotation_acceleration", "turning_acceleration", "deg/s^2", false),
    ("jerk", "jerk", "m/s^3", false),
    ("resolution", "resolution", "mm", false),
];

impl Trouble {
    fn at(field: Field, message: impl Into<String>, help: impl Into<String>) -> Trouble {
        let (message, help) = (message.into(), help.into());
        Trouble { step: Some(field.step), name: Some(field.name), n: field.n, message, help }
    }

    /// What the planner refuses.
    pub fn of(error: &ParamError) -> Trouble {
        let (step, name, n) = origin(&error.param);
        let help = error.help.clone().unwrap_or_default();
        Trouble { step, name, n, message: error.message.clone(), help }
    }

    /// Which move, counted from 0.
    pub fn step(&self) -> Option<usize> {
        self.step
    }

    /// For the page.
    pub fn data(&self) -> Value {
        json!({ "move": self.step, "field": self.name, "n": self.n, "message": self.message, "help": self.help })
    }
}

/// The field that a parameter such as `move.moves[1].tool.target` stands in.
fn origin(param: &str) -> (Option<usize>, Option<&'static str>, Option<usize>) {
    let Some(rest) = param.strip_prefix("move") else { return (None, None, None) };
    let (step, rest) = match rest.strip_prefix(".moves[").and_then(|rest| rest.split_once(']')) {
        Some((n, rest)) => (n.parse::<usize>().map_or(0, |n| n + 1), rest),
        None => (0, rest),
    };
    let rest = rest.trim_start_matches('.');
    let (path, n) = match rest.strip_suffix(']').and_then(|rest| rest.rsplit_once('[')) {
        Some((path, n)) => (path, n.parse().ok()),
        None => (rest, None),
    };
    let number =
        |member: &str| TOOL_NUMBERS.iter().find(|(name, ..)| *name == member).map(|(_, field, ..)| *field);
    let name = match path {
        // Where a later move begins nobody has typed.
        "start" if step > 0 => None,
        "start" => Some("from"),
        "target" => Some("to"),
        "tool.target" => Some("point"),
        "tool.via" => Some("via"),
        "tool.rotation" => Some("rotation"),
        "tool.work_object.translation" => Some("object_point"),
        "tool.work_object.rpy" => Some("object_turn"),
        "tool.orientation" => Some("orientation"),
        "tool.profile" => Some("profile"),
        "velocity" => Some("velocity"),
        "acceleration" => Some("acceleration"),
        "zone" => Some("zone"),
        "wait" => Some("wait"),
        "singular_limit" => Some("singular"),
        other => other.strip_prefix("tool.").and_then(number),
    };
    (Some(step), name, n)
}

/// A number as typed, with a point in the place of a decimal comma.
fn number(text: &str) -> String {
    let text = text.trim();
    let pointed = text.replacen(',', ".", 1);
    let is_number = |text: &str| text.split(' ').next().is_some_and(|number| number.parse::<f64>().is_ok());
    if text.matches(',').count() == 1 && !text.contains('.') && is_number(&pointed) {
        pointed
    } else {
        text.to_owned()
    }
}

/// What a field has; nothing where it is empty.
fn typed(owner: &Value, name: &str) -> Option<String> {
    owner[name].as_str().map(str::trim).filter(|text| !text.is_empty()).map(str::to_owned)
}

impl Draft {
    /// What was typed: one move, or a sequence with its `moves`. `limits` are those of the axes.
    pub fn of(body: &Value, limits: &[AxisLimits]) -> Draft {
        let mut draft = Draft::default();
        draft.comment(body, "head");
        draft.text += "JointMove(\n";
        let begin = draft.text.len();
        draft.list(
            "start",
            &body["from"],
            Field { step: 0, name: "from", n: None },
            |n| unit(limits, n),
            "the start",
        );
        draft.start = begin..draft.text.len();
        let single = std::slice::from_ref(body);
        let steps = match body["kind"] == "sequence" {
            true => body["moves"].as_array().map(Vec::as_slice).unwrap_or_default(),
            false => single,
        };
        if steps.is_empty() {
            draft.missing.push(Trouble {
                step: None,
                name: None,
                n: None,
                message: "the sequence has no moves".into(),
                help: "add at least one".into(),
            });
        }
        for (step, body) in steps.iter().enumerate() {
            if step == 1 {
                draft.text += "moves: [\n";
            }
            draft.comment(body, "comment");
            draft.text += if step > 0 { "(" } else { "" };
            let begin = draft.text.len();
            draft.step(step, body, limits);
            draft.moves.push(begin..draft.text.len());
            draft.text += if step > 0 { "),\n" } else { "" };
        }
        draft.text += if steps.len() > 1 { "],\n" } else { "" };
        draft.one("singular_limit", body, Field { step: 0, name: "singular", n: None }, "", false);
        draft.one("resolution", body, Field { step: 0, name: "table", n: None }, "deg", false);
        draft.text += ")\n";
        draft
    }

    fn step(&mut self, step: usize, body: &Value, limits: &[AxisLimits]) {
        let field = |name| Field { step, name, n: None };
        match body["kind"].as_str() {
            Some("joint") => {
                self.list("target", &body["to"], field("to"), |n| unit(limits, n), "the target");
                self.one("velocity", body, field("velocity"), "%", true);
                self.one("acceleration", body, field("acceleration"), "%", true);
            }
            Some(kind @ ("linear" | "circular")) => {
                self.text += "tool: (\n";
                self.list("target", &body["point"], field("point"), |_| "mm", "the target");
                if kind == "circular" {
                    self.list("via", &body["via"], field("via"), |_| "mm", "the point in between");
                }
                self.object(step, body);
                self.word("orientation", body, field("orientation"), "free");
                if body["orientation"] == "interpolated" {
                    self.list(
                        "rotation",
                        &body["rotation"],
                        field("rotation"),
                        |_| "deg",
                        "the orientation at the target",
                    );
                }
                for (member, name, unit, needed) in TOOL_NUMBERS {
                    self.one(member, body, field(name), unit, needed);
                }
                self.word("profile", body, field("profile"), "sin2");
                self.text += "),\n";
            }
            _ => self.missing.push(Trouble::at(
                field("kind"),
                "the kind of the move is missing",
                "choose a joint move, a line of the tool or an arc of the tool",
            )),
        }
        self.one("zone", body, field("zone"), "mm", false);
        self.one("wait", body, field("wait"), "s", false);
    }

    /// The work object, if any of its fields is filled; of a point or three angles that are given, an empty field is zero.
    fn object(&mut self, step: usize, body: &Value) {
        let parts = [("translation", "object_point", "mm"), ("rpy", "object_turn", "deg")];
        let filled = |name: &str| -> Option<Value> {
            let texts: Vec<&str> =
                body[name].as_array()?.iter().map(|text| text.as_str().unwrap_or_default().trim()).collect();
            let or_zero = |text: &&str| if text.is_empty() { "0".to_owned() } else { (*text).to_owned() };
            texts.iter().any(|text| !text.is_empty()).then(|| texts.iter().map(or_zero).collect())
        };
        let parts: Vec<_> = parts
            .into_iter()
            .filter_map(|(member, name, unit)| Some((member, name, unit, filled(name)?)))
            .collect();
        if parts.is_empty() {
            return;
        }
        self.text += "work_object: (";
        for (member, name, unit, values) in parts {
            self.list(member, &values, Field { step, name, n: None }, |_| unit, "the work object");
        }
        self.text += "),\n";
    }

    /// Lines above a move.
    fn comment(&mut self, body: &Value, name: &str) {
        for line in typed(body, name).unwrap_or_default().lines() {
            let line: String = line.chars().filter(|sign| !sign.is_control()).collect();
            self.text += format!("// {}", line.trim_end()).trim_end();
            self.text += "\n";
        }
    }

    fn mark(&mut self, field: Field, text: &str) {
        let begin = self.text.len();
        self.text += text;
        self.marks.push((begin..self.text.len(), field));
    }

    fn word(&mut self, member: &str, body: &Value, field: Field, otherwise: &str) {
        self.text += &format!("{member}: Text(");
        self.mark(field, &quoted(&typed(body, field.name).unwrap_or_else(|| otherwise.to_owned())));
        self.text += "),\n";
    }

    fn one(&mut self, member: &str, body: &Value, field: Field, unit: &str, needed: bool) {
        match typed(body, field.name) {
            Some(text) => {
                self.text += &format!("{member}: ");
                let text = number(&text);
                self.mark(field, &quoted(&if unit.is_empty() { text } else { united(&text, unit) }));
                self.text += ",\n";
            }
            None if needed => {
                self.missing.push(Trouble::at(field, "missing", format!("give a number in {unit}")))
            }
            None => {}
        }
    }

    fn list<'u>(
        &mut self,
        member: &str,
        values: &Value,
        field: Field,
        unit: impl Fn(usize) -> &'u str,
        what: &str,
    ) {
        let values = values.as_array().map(Vec::as_slice).unwrap_or_default();
        if values.is_empty() {
            self.missing.push(Trouble::at(field, format!("{what} is missing"), "fill all fields"));
        }
        self.text += &format!("{member}: ");
        let begin = self.text.len();
        self.text += "[";
        for (n, value) in values.iter().enumerate() {
            let field = Field { n: Some(n), ..field };
            let text = number(value.as_str().unwrap_or_default());
            if text.is_empty() {
                self.missing.push(Trouble::at(
                    field,
                    "missing",
                    format!("{what} has a number in each field"),
                ));
            }
            self.mark(field, &quoted(&united(&text, unit(n))));
            self.text += ", ";
        }
        self.text += "]";
        self.lists.push((begin..self.text.len(), field));
        self.text += ",\n";
    }

    /// The moves as the language reads them.
    ///
    /// # Errors
    /// What is wrong, at each field that can be read alone.
    pub fn read(&self) -> Result<Asked, Vec<Trouble>> {
        let found = self.missing.is_empty().then(|| Asked::in_words(self.text.clone()));
        let whole = match found {
            Some(Ok(asked)) => return Ok(asked),
            Some(Err(failure)) => Some(failure),
            None => None,
        };
        // One after the other, so that no mistake hides those of other moves.
        let mut all = self.missing.clone();
        let wrong = |n: usize| self.missing.iter().any(|trouble| trouble.step == Some(n));
        if !wrong(0) {
            all.extend(self.trouble::<JointPath>(self.start.clone()));
        }
        let moves = self.moves.iter().enumerate().filter(|(n, _)| !wrong(*n));
        all.extend(moves.filter_map(|(_, range)| self.trouble::<NextMove>(range.clone())));
        if all.is_empty() {
            all.extend(whole.map(|failure| self.located(failure, 0)));
        }
        Err(all)
    }

    /// What is wrong with a part of the text.
    fn trouble<T: DeserializeOwned>(&self, range: Range<usize>) -> Option<Trouble> {
        let failure = |text: &str| on_command_line::<T>(&format!("({text})")).err();
        let mut trouble = self.located(failure(&self.text[range.clone()])?, range.start as isize - 1);
        let list = self.lists.iter().find(|(list, field)| {
            range.start <= list.start
                && list.end <= range.end
                && trouble.n.is_none()
                && trouble.name == Some(field.name)
        });
        if let Some((list, _)) = list {
            // The language finds the list at fault: which of its values, is seen with zero in the place of the others.
            let items =
                self.marks.iter().filter(|(item, _)| list.start <= item.start && item.end <= list.end);
            let alone = |n: usize| {
                let all = items.clone().enumerate().map(|(k, (item, _))| match k == n {
                    true => &self.text[item.clone()],
                    false => "0",
                });
                let all = all.collect::<Vec<_>>().join(", ");
                let (before, after) = (&self.text[range.start..list.start], &self.text[list.end..range.end]);
                format!("{before}[{all}]{after}")
            };
            let is_guilty =
                |n: &usize| failure(&alone(*n)).is_some_and(|failure| failure.message() == trouble.message);
            trouble.n = (0..items.clone().count()).find(is_guilty);
        }
        Some(trouble)
    }

    /// The field of a problem, whose places are `ahead` of this text.
    fn located(&self, failure: Failure, ahead: isize) -> Trouble {
        let problem = failure.into_problems().into_iter().next();
        let at = problem
            .as_ref()
            .and_then(|problem| problem.labels.first())
            .map(|label| label.place.span.start as isize + ahead);
        let is_at =
            |range: &Range<usize>| at.is_some_and(|at| range.start as isize <= at && at < range.end as isize);
        let all = self.marks.iter().chain(&self.lists);
        let field = all.into_iter().find(|(range, _)| is_at(range)).map(|(_, field)| *field);
        let step = self.moves.iter().position(is_at);
        let (message, help) = problem.map(|problem| (problem.message, problem.help)).unwrap_or_default();
        Trouble {
            step: field.map(|field| field.step).or(step),
            name: field.map(|field| field.name),
            n: field.and_then(|field| field.n),
            message,
            help: help.unwrap_or_default(),
        }
    }
}

/// The unit of a bare number of an axis.
fn unit(limits: &[AxisLimits], n: usize) -> &'static str {
    match limits.get(n).map(|limits| limits.kind) {
        Some(AxisKind::Sliding) => "mm",
        _ => "deg",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decimal_comma_is_one_where_it_can_be_nothing_else() {
        assert_eq!(
            ["1,5", "1,5 m", "1.5", "a,b", "1,5,2", "1,000.5"].map(number),
            ["1.5", "1.5 m", "1.5", "a,b", "1,5,2", "1,000.5"]
        );
    }

    #[test]
    fn each_mistake_is_at_its_move_and_field() {
        let line = json!({
            "kind": "linear", "point": ["1", "2 kg", "3"], "speed": "250", "share": "20", "orientation": "free", "profile": "sin2",
        });
        let arc = json!({ "kind": "circular", "point": ["1", "2", ""], "via": ["1", "2", "3"], "speed": "", "share": "20" });
        let joint = json!({ "kind": "joint", "to": ["1", "2"], "velocity": "4 m", "acceleration": "30", "comment": "up\nand \u{7}away" });
        let last = json!({ "kind": "joint", "to": ["1", "x"], "velocity": "40", "acceleration": "30", "wait": "1 s" });
        let body = json!({ "kind": "sequence", "from": ["0", "0,5"], "moves": [line, arc, joint, last] });
        let draft = Draft::of(&body, &[]);
        assert!(
            draft.text.contains("\"0.5 deg\"") && draft.text.contains("// up\n// and away\n("),
            "{}",
            draft.text
        );
        let Err(all) = draft.read() else { panic!("{}", draft.text) };
        let places: Vec<_> = all.iter().map(|one| (one.step, one.name, one.n)).collect();
        assert_eq!(
            places,
            [
                (Some(1), Some("point"), Some(2)),
                (Some(1), Some("speed"), None),
                (Some(0), Some("point"), Some(1)),
                (Some(2), Some("velocity"), None),
                (Some(3), Some("to"), Some(1)),
            ],
            "{all:?}"
        );
    }

    #[test]
    fn a_parameter_that_is_refused_is_found_in_the_form() {
        assert_eq!(origin("move.moves[1].tool.velocity"), (Some(2), Some("speed"), None));
        assert_eq!(origin("move.target[3]"), (Some(0), Some("to"), Some(3)));
        assert_eq!(origin("move.start"), (Some(0), Some("from"), None));
        assert_eq!(origin("move.moves[0].start"), (Some(1), None, None));
        assert_eq!(origin("move.moves[0].wait"), (Some(1), Some("wait"), None));
        assert_eq!(origin("limits[2].upper"), (None, None, None));
    }
}
