use blocksim_block::prelude::*;
use blocksim_signal::{Quantity, Value};

/// Finds its output `z` so that its input `f` is zero at every instant.
///
/// $$ f(z, \ldots) = 0 $$
///
/// `f` must depend on `z` through blocks that pass it on at once. The equation is solved by Newton's method, at the start
/// from the guess `z0` and then from the solution of the last step, so that of several solutions the run stays with the
/// one nearest to the guess. Drawn this way, $\dot x = g(x, z)$, $0 = f(x, z)$ is a system of differential and algebraic
/// equations of index 1: `f` must move with `z`, however it is. Where it does not, or there is no solution, the run ends
/// with an error that has the time. What must be zero may have any unit and any size.
///
/// `z` is a vector where `z0` is a list; `f` then has as many elements. The unit of `z` is that of `z0`.
///
/// How far a nonlinear spring is pressed by its load, with `f` the difference of both forces:
///
/// ```ron
/// AlgebraicConstraint(z0: "1 mm")
/// ```
///
/// Source: as `Algebraic Constraint` of Simulink; E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, section VI.1
/// (the state space form method).
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Lines("find z", "f(z) = 0"))]
pub struct AlgebraicConstraint {
    /// Where the search begins; a list for a vector; 0 if it is not given.
    #[block(default = None)]
    pub z0: Option<ParamValue>,
}

impl AlgebraicConstraint {
    fn items(&self) -> &[Value] {
        match &self.z0 {
            Some(ParamValue(Value::List(items))) => items,
            Some(ParamValue(one)) => std::slice::from_ref(one),
            None => &[],
        }
    }

    fn shape(&self) -> Shape {
        match &self.z0 {
            Some(ParamValue(Value::List(items))) => Shape::Vector(items.len()),
            _ => Shape::Scalar,
        }
    }

    /// The unit that is written, if it is the same for all.
    fn dimension(&self) -> Option<Dimension> {
        let written: Vec<Dimension> = self
            .items()
            .iter()
            .filter_map(Value::as_number)
            .map(|quantity: Quantity| quantity.dimension)
            .filter(|dimension| *dimension != Dimension::NONE)
            .collect();
        written.first().copied().filter(|first| written.iter().all(|other| other.compatible(*first)))
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.z0.is_some() && self.items().is_empty() {
            errors.add(ParamError::new("z0", "`z0` is an empty list").help("give a guess for each unknown"));
        }
        for (i, item) in self.items().iter().enumerate() {
            let name = if self.shape() == Shape::Scalar { "z0".to_owned() } else { format!("z0[{i}]") };
            match item.as_number() {
                Some(quantity) => drop(errors.take(finite(&name, quantity.value))),
                None => {
                    let message = format!("`{name}` is {}, but must be a number", item.describe());
                    errors.add(ParamError::new(name, message));
                }
            }
        }
    }
}

impl Block for AlgebraicConstraint {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let shape = self.shape();
        if let Some(f) = given.input("f").map(|f| f.shape).filter(|f| f.len() != shape.len()) {
            let (n, equations) = (shape.len(), f.len());
            let message = format!("`f` is a {f}: {equations} equations for {n} unknown(s) `z`");
            return Err(InterfaceError::types(&["f"], message)
                .help(format!("give `z0` a list of {equations} guesses, or make `f` as long as `z0`")));
        }
        let z = PortType::UNKNOWN.shaped(shape).of(self.dimension());
        let guess =
            |i: usize| self.items().get(i).and_then(Value::as_number).map_or(0.0, |guess| guess.value);
        let unknowns = (0..shape.len()).map(|i| (i, guess(i))).collect();
        let f = Input::real("f").doc("What must be zero.");
        let z = Output::like("z", z).doc("The value with which it is.");
        Ok(Interface::new().input(f).output_sought(z, unknowns))
    }

    fn law(&self, l: &Recording) -> bool {
        l.input(0).iter().enumerate().for_each(|(i, f)| l.rest(i, *f));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn constraint(z0: Value) -> AlgebraicConstraint {
        AlgebraicConstraint { z0: Some(ParamValue(z0)) }
    }

    #[test]
    fn it_states_its_unknowns_with_their_guesses() {
        let block = constraint(Value::List(vec![1.0.into(), 2.0.into()]));
        let interface = block.interface(&Given::nothing()).unwrap();
        let found = interface.constraint.clone().unwrap();
        assert_eq!((found.group, found.rest, found.unknowns), (0, 1, vec![(0, 1.0), (1, 2.0)]));
        assert!(!interface.reads(0, 0) && interface.reads(1, 0));
        let one = AlgebraicConstraint { z0: None }.interface(&Given::nothing()).unwrap();
        assert_eq!(one.outputs[0].port_type.shape, Shape::Scalar);
    }

    #[test]
    fn guesses_that_are_none_or_do_not_fit_are_refused() {
        assert_eq!(constraint(Value::List(Vec::new())).errors()[0].param, "z0");
        assert_eq!(constraint(Value::Bool(true)).errors()[0].param, "z0");
        let list = constraint(Value::List(vec![1.0.into(), f64::NAN.into()]));
        assert_eq!(list.errors()[0].param, "z0[1]");
        let given = Given::new(vec![("f".to_owned(), PortType::vector(3))], Default::default());
        let error = constraint(1.0.into()).interface(&given).unwrap_err();
        assert!(error.message.contains("3 equations for 1 unknown"), "{}", error.message);
    }
}
