//! When a subsystem runs, as it is written.

use std::rc::Rc;

use blocksim_block::Crossing;
use blocksim_block::problem::Problem;
use blocksim_signal::{Dimension, Quantity, Value, closest};

use super::Resolver;
use crate::ast::{Ast, BlockAst};
use crate::condition::{Condition, SetOutput, WhenEnabled};
use crate::problems::list;
use crate::scope::{Evaluation, Scope};
use blocksim_syntax::{Name, Node, Shape};

/// The condition has been reported as wrong.
pub(super) struct Reported;

const STATES: [(&str, WhenEnabled); 2] = [("Held", WhenEnabled::Held), ("Reset", WhenEnabled::Reset)];
const EDGES: [(&str, Crossing); 3] =
    [("Rising", Crossing::Rising), ("Falling", Crossing::Falling), ("Either", Crossing::Either)];

impl<'a> Resolver<'a> {
    /// When a subsystem runs, if not always; `inside` is its diagram.
    pub(super) fn condition(
        &self,
        ast: &Ast,
        block: &BlockAst,
        scope: &Rc<Scope<'a>>,
        inside: &Ast,
    ) -> Result<Option<Condition>, Reported> {
        let parameter = |name: &str| block.parameters.iter().find(|(n, _)| n.text == name);
        let condition = Condition {
            enable: self.word(ast, parameter("enable"), &STATES)?,
            trigger: self.word(ast, parameter("trigger"), &EDGES)?,
            reset: self.word(ast, parameter("reset"), &EDGES)?,
            when_disabled: self.set_outputs(ast, parameter("when_disabled"), scope, inside)?,
        };
        if let (Some((name, _)), None) = (parameter("when_disabled"), condition.enable) {
            self.report(
                Problem::error(
                    "conditional",
                    "`when_disabled` needs `enable`: without it the subsystem is never disabled",
                )
                .at(&ast.place(&name.span), "")
                .help("add `enable: Held` or `enable: Reset`, or remove it"),
            );
            return Err(Reported);
        }
        if let Some((own, _)) =
            inside.inputs.iter().find(|(own, _)| condition.inputs().any(|name| name == own.text))
        {
            self.report(
                Problem::error("conditional", format!("the subsystem has two inputs `{}`", own.text))
                    .at(&ast.place(&block.span), format!("`{}:` adds one", own.text))
                    .at(&inside.place(&own.span), "the diagram declares the other")
                    .help("rename the input that the diagram declares"),
            );
            return Err(Reported);
        }
        Ok(condition.inputs().next().is_some().then_some(condition))
    }

    fn word<T: Copy>(
        &self,
        ast: &Ast,
        parameter: Option<&(Name, Node)>,
        words: &[(&str, T)],
    ) -> Result<Option<T>, Reported> {
        let Some((name, node)) = parameter else { return Ok(None) };
        let word = if let Shape::Word(word) = &node.value { word.as_str() } else { "" };
        if let Some((_, value)) = words.iter().find(|(known, _)| *known == word) {
            return Ok(Some(*value));
        }
        let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
        let message = format!("`{}` is one of {}, found {}", name.text, list(&known), node.describe());
        let problem = Problem::error("parameter", message).at(&ast.place(&node.span), "");
        self.report(match closest(word, known.iter().copied()) {
            Some(close) => problem.help(format!("did you mean `{close}`?")),
            None => problem.help(format!("write `{}: {}`", name.text, known[0])),
        });
        Err(Reported)
    }

    fn set_outputs(
        &self,
        ast: &Ast,
        parameter: Option<&(Name, Node)>,
        scope: &Rc<Scope<'a>>,
        inside: &Ast,
    ) -> Result<Vec<SetOutput>, Reported> {
        let Some((_, node)) = parameter else { return Ok(Vec::new()) };
        let Some(members) = node.members() else {
            self.report(
                Problem::error("parameter", format!("`when_disabled` is a set, found {}", node.describe()))
                    .at(&ast.place(&node.span), "")
                    .help("write `when_disabled: { \"output\": 0 }`"),
            );
            return Err(Reported);
        };
        let known: Vec<&str> = inside.outputs.iter().map(|(name, _)| name.text.as_str()).collect();
        let mut set: Vec<SetOutput> = Vec::new();
        let mut fits = true;
        for (name, node) in members {
            let place = ast.place(&name.span);
            if set.iter().any(|other| other.name == name.text) {
                self.report(
                    Problem::error("duplicate_name", format!("`{}` occurs twice in this set", name.text))
                        .at(&place, "the second")
                        .help("remove one of them"),
                );
                fits = false;
            } else if !known.contains(&name.text.as_str()) {
                let problem =
                    Problem::error("unknown_port", format!("the subsystem has no output `{}`", name.text))
                        .at(&place, "no such output");
                self.report(match closest(&name.text, known.iter().copied()) {
                    Some(close) => problem.help(format!("did you mean `{close}`?")),
                    None => problem.help(format!("its outputs are {}", list(&known))),
                });
                fits = false;
            } else if let Some(value) = self.number(ast, node, scope) {
                set.push(SetOutput { name: name.text.clone(), value, place });
            } else {
                fits = false;
            }
        }
        if fits { Ok(set) } else { Err(Reported) }
    }

    /// A finite number with or without a unit; the unit of a bare one is open.
    fn number(&self, ast: &Ast, node: &Node, scope: &Rc<Scope<'a>>) -> Option<Quantity> {
        let stack = Vec::new();
        let place = ast.place(&node.span);
        let problem = match (Evaluation { scope, file: ast.file, stack: &stack }).value(node) {
            Ok(Value::Number(quantity)) if quantity.value.is_finite() => {
                let bare = matches!(node.value, Shape::Number(_));
                let dimension = if bare { Dimension::OPEN } else { quantity.dimension };
                return Some(Quantity { dimension, ..quantity });
            }
            Ok(Value::Bool(value)) => {
                return Some(Quantity { value: f64::from(value), dimension: Dimension::NONE });
            }
            Ok(Value::Number(quantity)) => {
                Problem::error("parameter", format!("an output cannot be {}", quantity.value)).at(&place, "")
            }
            Ok(other) => {
                let message = format!("expected a number, found {}", other.describe());
                Problem::error("parameter", message).at(&place, "")
            }
            Err(problem) => problem,
        };
        self.report(problem);
        None
    }
}
