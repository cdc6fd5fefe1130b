use super::elements::parameters_like;
use blocksim_block::law;
use blocksim_block::prelude::*;

/// Compares two signals, or one with a constant: `y` is true where the relation holds; element by element.
///
/// With `constant` there is one input `u`, compared as "u operator constant"; without, `u1` is compared with `u2`.
/// Both sides have one unit; a constant written as a plain number takes that of the input. The result is chosen
/// where the solver stops, and it stops where both sides cross; in between it is held. `Equal` and `NotEqual`
/// compare exactly, which makes sense for sampled and constant signals. What is not a number is not equal to anything.
///
/// ```ron
/// Compare(operator: GreaterEqual, constant: "48 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Value("operator"))]
pub struct Compare {
    /// `Less`, `LessEqual`, `Greater`, `GreaterEqual`, `Equal` or `NotEqual`.
    pub operator: Relation,
    /// What the input is compared with, in the unit of the input; without it there is a second input.
    #[block(finite, default = None)]
    pub constant: Option<f64>,
}

/// Relation between two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Relation {
    /// $a < b$
    Less,
    /// $a \le b$
    LessEqual,
    /// $a > b$
    Greater,
    /// $a \ge b$
    GreaterEqual,
    /// $a = b$
    Equal,
    /// $a \ne b$
    NotEqual,
}

impl Relation {
    fn recorded(self) -> law::Relation {
        match self {
            Relation::Less => law::Relation::Less,
            Relation::LessEqual => law::Relation::LessEqual,
            Relation::Greater => law::Relation::Greater,
            Relation::GreaterEqual => law::Relation::GreaterEqual,
            Relation::Equal => law::Relation::Equal,
            Relation::NotEqual => law::Relation::NotEqual,
        }
    }
}

/// What the answer is called when it changes.
const TRUTH: &[Change] = &[Change::to(1.0, "becomes true"), Change::to(0.0, "becomes false")];

impl Block for Compare {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let mut interface = Interface::new();
        let shape = match self.constant {
            Some(_) => {
                let u = given.input_or_unknown("u");
                parameters_like(given, "u", u.dimension, &["constant"])?;
                interface = interface.input(Input::real("u"));
                u.shape
            }
            None => {
                given.common_dimension(&["u1", "u2"])?;
                interface = interface.input(Input::real("u1")).input(Input::real("u2"));
                given.common_shape(&["u1", "u2"], &[])?
            }
        };
        interface =
            interface.output(Output::boolean("y").shape(shape)).modes("holds", shape.len(), 0.0, TRUTH);
        Ok(interface.guard_each("difference", shape.len()).called_by_mode())
    }

    fn law(&self, l: &Recording) -> bool {
        for i in 0..l.width(0) {
            let (a, b) = (l.element(0, i), self.constant.map_or_else(|| l.element(1, i), |b| l.constant(b)));
            l.settle(i, a.live(self.operator.recorded(), b).number());
            l.set(0, i, l.d()[i]);
            l.guard(i, a - b);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::elements::given;
    use super::*;
    use blocksim_block::testing::Bench;

    const RELATIONS: [(Relation, [f64; 3]); 6] = [
        (Relation::Less, [1.0, 0.0, 0.0]),
        (Relation::LessEqual, [1.0, 1.0, 0.0]),
        (Relation::Greater, [0.0, 0.0, 1.0]),
        (Relation::GreaterEqual, [0.0, 1.0, 1.0]),
        (Relation::Equal, [0.0, 1.0, 0.0]),
        (Relation::NotEqual, [1.0, 0.0, 1.0]),
    ];

    #[test]
    fn each_relation_is_decided_below_on_and_above_the_constant() {
        for (operator, expected) in RELATIONS {
            let block = Compare { operator, constant: Some(2.0) };
            let mut bench = Bench::with_inputs(block, vec![("u".to_owned(), PortType::vector(3))]);
            assert_eq!(bench.set(0, &[1.0, 2.0, 3.0]).major(), expected, "{operator:?}");
            assert_eq!(bench.guards(), [-1.0, 0.0, 1.0]);
        }
    }

    #[test]
    fn without_a_constant_two_inputs_are_compared() {
        let mut bench = Bench::new(Compare { operator: Relation::Less, constant: None });
        assert_eq!(bench.set(0, &[1.0]).set(1, &[2.0]).major(), [1.0]);
        assert_eq!(bench.set(1, &[0.5]).minor(), [1.0], "held between major steps");
        assert_eq!(bench.guards(), [0.5]);
        assert_eq!(bench.major(), [0.0]);
    }

    #[test]
    fn what_is_not_a_number_is_only_unequal() {
        for (operator, _) in RELATIONS {
            let expected = f64::from(operator == Relation::NotEqual);
            assert_eq!(Bench::new(Compare { operator, constant: Some(0.0) }).respond(f64::NAN), expected);
        }
    }

    #[test]
    fn the_output_is_boolean_and_both_sides_have_one_unit() {
        let two = Compare { operator: Relation::Equal, constant: None };
        let one = Compare { constant: Some(1.0), ..two };
        let volts = given(&[("u", "V"), ("u1", "V"), ("u2", "V")], &[]);
        for block in [&one, &two] {
            assert_eq!(block.interface(&volts).unwrap().outputs[0].port_type, PortType::boolean());
        }
        let error = two.interface(&given(&[("u1", "V"), ("u2", "A")], &[])).unwrap_err();
        assert_eq!((error.code, error.ports.len()), ("unit_mismatch", 2));
        assert!(one.interface(&given(&[("u", "V")], &[("constant", "A")])).is_err());
        assert!(one.interface(&given(&[("u", "V")], &[("constant", "mV")])).is_ok());
        assert_eq!(Compare { constant: Some(f64::NAN), ..two }.errors()[0].param, "constant");
    }
}
