//! Blocks for the tests of this crate, which knows no library: as much as order, types and clocks need.

use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

use blocksim_block::problem::FileId;
use blocksim_block::{Block, Given, Input, Interface, InterfaceError, Output};
use blocksim_signal::{SampleTime, Shape as SignalShape};

use crate::ast::{Ast, BlockAst, parse};
use crate::flatten::{Flat, flatten};
use crate::model::{Content, Model, ModelBlock};
use crate::problems::Problems;
use crate::source::Reader;
use blocksim_syntax::{Shape, read};

/// `Gain`, `Limit` (with a guard), `Sum`, `Constant(n: 3)`, `State`, `Sampled(period: 0.001, offset: 0)`, or `Columns(n: 2)`, which
/// multiplies by a square matrix.
#[derive(Debug)]
struct Toy {
    kind: String,
    numbers: Vec<f64>,
}

impl Block for Toy {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        Ok(match self.kind.as_str() {
            "Constant" => Interface::new()
                .output(Output::real("y").shape(SignalShape::Vector(self.numbers[0] as usize)))
                .constant(),
            "State" => Interface::new()
                .input(Input::any("u"))
                .output_from_state(Output::like("y", u))
                .state("x", 0.0),
            "Limit" => Interface::new().input(Input::any("u")).output(Output::like("y", u)).guard("limit"),
            "Sampled" => {
                let mut interface =
                    Interface::new().input(Input::any("u")).output_from_state(Output::like("y", u));
                let (period, offset) = (self.numbers[0], self.numbers[1]);
                interface.sample_time = Some(SampleTime::Discrete { period, offset });
                interface
            }
            "Columns" => {
                let n = self.numbers[0] as usize;
                let shape = match given.input("u").map(|u| u.shape) {
                    None | Some(SignalShape::Scalar) => SignalShape::Matrix(n, n),
                    Some(SignalShape::Vector(m)) if m == n => SignalShape::Vector(n),
                    Some(other) => return Err(InterfaceError::types(&["u"], format!("`u` is a {other}"))),
                };
                Interface::new().input(Input::any("u")).output(Output::like("y", u).shape(shape))
            }
            "Sum" => {
                let shape = given.common_shape(&["u", "v"], &[])?;
                let inputs = Interface::new().input(Input::any("u")).input(Input::any("v"));
                inputs.output(Output::like("y", u).shape(shape))
            }
            _ => Interface::new().input(Input::any("u").default(0.0)).output(Output::like("y", u)),
        })
    }
}

/// The diagram with these blocks and connections, as written.
pub(crate) fn ast(blocks: &str, connections: &str) -> Ast {
    let text = format!("Diagram(blocks: {{{blocks}}}, connections: [{connections}])");
    let root = read(&text).expect("RON");
    parse(FileId(0), &root, &mut Problems::default()).expect("a diagram")
}

fn toy(ast: &Ast, block: &BlockAst) -> ModelBlock {
    let numbers = block
        .parameters
        .iter()
        .filter_map(|(_, node)| if let Shape::Number(value) = node.value { Some(value) } else { None })
        .collect();
    let built = Toy { kind: block.kind.text.clone(), numbers };
    let interface = built.interface(&Given::nothing()).expect("an interface");
    ModelBlock {
        name: block.name.text.clone(),
        path: block.name.text.clone(),
        kind: block.kind.text.clone(),
        label: None,
        place: ast.place(&block.name.span),
        variant: None,
        content: Content::Block {
            block: Arc::new(built),
            units: Arc::default(),
            numbers: Arc::default(),
            interface: Arc::new(interface),
            plain: false,
        },
    }
}

/// A diagram of toys.
pub(crate) fn model(blocks: &str, connections: &str) -> Model {
    let ast = Rc::new(ast(blocks, connections));
    let blocks = ast.blocks.iter().map(|block| toy(&ast, block)).collect();
    Model { path: String::new(), ast, blocks, condition: None }
}

/// The same as a list of blocks.
pub(crate) fn flat(blocks: &str, connections: &str) -> Flat {
    flatten(&model(blocks, connections), &[], &mut Problems::default())
}

/// Messages of all problems.
pub(crate) fn messages(problems: &Problems) -> Vec<String> {
    problems.sorted().into_iter().map(|problem| problem.message).collect()
}

/// No files at all.
pub(crate) struct NoFiles;

impl Reader for NoFiles {
    fn read(&self, _: &Path) -> Result<String, String> {
        Err("there are no files".to_owned())
    }
}
