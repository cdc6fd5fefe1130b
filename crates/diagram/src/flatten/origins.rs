//! Which output stands behind each name of a model, for those who show values beside a drawing.

use std::collections::BTreeMap;

use super::executed;
use super::record::name_leaves;
use super::view::{Asked, Tree, View};
use crate::model::{Model, ModelBlock};

/// For every name of a signal the output that it stands for, `path.port`: inputs and outputs of blocks and subsystems
/// on all levels, and the elements of buses behind them (`arm.signals.Joint1.Angle`). Names that lead to nothing are
/// left out, as those of a model with mistakes may.
pub fn origins(model: &Model) -> BTreeMap<String, String> {
    let mut view = View::default();
    let mut found: Vec<(usize, &ModelBlock)> = Vec::new();
    view.add(model, None, &mut found);
    for (at, (level, block)) in found.iter().enumerate() {
        if executed(block) {
            view.index.insert((*level, block.name.as_str()), at);
        }
    }
    let mut names = BTreeMap::new();
    for (level, block) in &found {
        for output in block.outputs() {
            let mut asked = Asked::new(block.place.clone(), &output);
            if let Ok(tree) = view.tree(*level, &block.name, &output, &[], &mut asked) {
                name_leaves(&format!("{}.{output}", block.path), &tree, &mut names);
            }
        }
        for input in block.inputs() {
            let mut asked = Asked::new(block.place.clone(), &input);
            let tree = view.driven(*level, &block.name, &input, &[], &mut asked).unwrap_or(Tree::Unknown);
            name_leaves(&format!("{}.{input}", block.path), &tree, &mut names);
        }
    }
    let origin = |(block, output): (usize, usize)| {
        let block = found[block].1;
        block.outputs().get(output).map(|port| format!("{}.{port}", block.path))
    };
    names.into_iter().filter_map(|(name, leaf)| Some((name, origin(leaf)?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toys;

    #[test]
    fn inputs_and_outputs_have_the_output_that_drives_them_as_origin() {
        let model = toys::model(
            r#""a": State(), "b": Gain(), "c": Gain()"#,
            r#""a.y -> b.u", "b.y -> a.u, c.u", "missing.y -> d.u""#,
        );
        let names: Vec<(String, String)> = origins(&model).into_iter().collect();
        let expected =
            [("a.u", "b.y"), ("a.y", "a.y"), ("b.u", "a.y"), ("b.y", "b.y"), ("c.u", "b.y"), ("c.y", "c.y")];
        assert_eq!(names, expected.map(|(name, origin)| (name.to_owned(), origin.to_owned())));
    }
}
