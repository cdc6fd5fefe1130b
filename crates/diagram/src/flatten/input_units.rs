//! Inputs of subsystems that say their unit.

use blocksim_block::problem::Problem;
use blocksim_signal::{Dimension, Unit};

use super::view::{Asked, Tree, View};
use super::{Declared, Source};
use crate::problems::Problems;
use blocksim_syntax::{Node, Shape};

impl View<'_> {
    /// Inputs of subsystems that say their unit, with what drives them.
    pub(super) fn declared(&self, problems: &mut Problems) -> Vec<Declared> {
        let mut declared = Vec::new();
        for level in &self.levels {
            let ast = &level.model.ast;
            for (name, node) in &ast.inputs {
                let dimension = match declared_unit(node) {
                    Ok(Some(dimension)) => dimension,
                    Ok(None) => continue,
                    Err((message, help)) => {
                        let problem = Problem::error("parameter", message).at(&ast.place(&node.span), "");
                        problems.push(problem.help(help));
                        continue;
                    }
                };
                let Some((parent, block)) = &level.parent else { continue };
                let Some((from, target)) =
                    self.levels[*parent].drivers.get(&(block.as_str(), name.text.as_str()))
                else {
                    continue;
                };
                let outer = &self.levels[*parent].model.ast;
                let (place, target) = (outer.place(&from.span), outer.place(&target.span));
                let mut asked = Asked::new(place.clone(), &from.port);
                // What is wrong with the name itself is reported where a block asks for it.
                let tree = self.tree(*parent, &from.block, &from.port, &from.elements, &mut asked);
                if let Ok(Tree::Leaf { block, output }) = tree {
                    declared.push(Declared {
                        name: format!("{}.{}", level.model.path, name.text),
                        dimension,
                        place: ast.place(&node.span),
                        source: Source { block, output, target, place },
                    });
                }
            }
        }
        declared
    }
}

/// The unit of `(unit: "rad/s")`; nothing for `()`.
fn declared_unit(node: &Node) -> Result<Option<Dimension>, (String, String)> {
    let help = "write `(unit: \"rad/s\")`, or `()` for any signal or bus".to_owned();
    let Some(members) = node.members() else {
        return Err((format!("expected a unit, found {}", node.describe()), help));
    };
    let mut dimension = None;
    for (name, value) in members {
        match (&value.value, name.text.as_str()) {
            (Shape::Text(text), "unit") => match Unit::parse(text) {
                Ok(unit) => dimension = Some(unit.dimension),
                Err(error) => return Err((error.message, error.help.unwrap_or(help))),
            },
            (_, "unit") => return Err((format!("expected a unit, found {}", value.describe()), help)),
            (_, other) => return Err((format!("an input has no `{other}`"), help)),
        }
    }
    Ok(dimension)
}
