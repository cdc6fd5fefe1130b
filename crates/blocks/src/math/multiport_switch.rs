use super::elements::numbered;
use blocksim_block::prelude::*;

/// Passes one of several inputs: the one whose number is at the input `index`; element by element.
///
/// Inputs are counted from 1, or from `first`. The index is rounded to the nearest whole number; the choice changes where the solver
/// stops, and it stops half-way between two numbers. An index without an input ends the run with an error, or counts as the
/// nearest that has one with `outside: Clamp`. All inputs are of one kind and unit.
///
/// ```ron
/// MultiportSwitch(inputs: 3)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Switch)]
pub struct MultiportSwitch {
    /// Number of inputs `u1`, `u2` ... to choose from.
    #[block(at_least = 1, at_most = 1000, default = 3)]
    pub inputs: usize,
    /// Index that chooses the first input.
    #[block(at_least = 0, at_most = 1_000_000, default = 1)]
    pub first: usize,
    /// What an index without an input does: `Error` or `Clamp`.
    #[block(default = Outside::Error)]
    pub outside: Outside,
}

/// What an index without an input does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Outside {
    /// It ends the run.
    Error,
    /// The nearest one counts.
    Clamp,
}

const CHOSEN: &[Change] = &[Change::any("passes another input")];

impl MultiportSwitch {
    fn names(&self) -> Vec<String> {
        if self.inputs == 1 { vec!["u1".to_owned()] } else { numbered("u", self.inputs) }
    }

    fn last(&self) -> f64 {
        (self.first + self.inputs - 1) as f64
    }
}

impl Block for MultiportSwitch {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let names = self.names();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let y = PortType {
            kind: given.common_kind(&names)?.unwrap_or(Kind::Real),
            shape: given.common_shape(&names, &[])?,
            dimension: given.common_dimension(&names)?,
        };
        let index = Input::any("index").scalar().dimension(Some(Dimension::NONE));
        let interface = Interface::new().input(index.doc("Number of the input that is passed."));
        let interface = names.iter().fold(interface, |interface, name| interface.input(Input::any(*name)));
        Ok(interface
            .output(Output::like("y", y))
            .modes("index", 1, self.first as f64, CHOSEN)
            .guard_when(Crossing::Holds, "index")
            .called_by_mode())
    }

    fn law(&self, l: &Recording) -> bool {
        let (index, held) = (l.u(0), l.d()[0]);
        let [first, last] = [self.first as f64, self.last()].map(|end| l.constant(end));
        let number = index.nearest();
        if self.outside == Outside::Error {
            let below = number.live(Relation::GreaterEqual, first);
            index.only_where(below.and(number.live(Relation::LessEqual, last)));
        }
        l.settle(0, number.clamp(first, last));
        // What a whole number is right for: half an interval around it, and all that lies beyond the last ones.
        let above = held.live(Relation::GreaterEqual, last).select(l.constant(1.0), held + 0.5 - index);
        let below = held.live(Relation::LessEqual, first).select(l.constant(1.0), index - (held - 0.5));
        l.guard(
            0,
            match self.outside {
                Outside::Clamp => above.min(below),
                // Beyond the last one is an error, which is to be found where it begins.
                Outside::Error => (held + 0.5 - index).min(index - (held - 0.5)),
            },
        );
        for i in 0..l.width(0) {
            let mut chosen = l.element(self.inputs, i);
            for port in (1..self.inputs).rev() {
                let this = l.constant((self.first + port - 1) as f64);
                chosen = held.live(Relation::Equal, this).select(l.element(port, i), chosen);
            }
            l.set(0, i, chosen);
        }
        true
    }

    fn no_value(&self, _failure: &Failure, c: &Context) -> Option<String> {
        let (index, first, last) = (c.scalar(0), self.first, self.last());
        Some(format!(
            "`index` is {index}, but the inputs are {first} to {last}; `outside: Clamp` takes the nearest"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    fn bench(outside: Outside) -> Bench {
        let inputs = vec![
            ("index".to_owned(), PortType::scalar()),
            ("u1".to_owned(), PortType::vector(2)),
            ("u2".to_owned(), PortType::scalar()),
            ("u3".to_owned(), PortType::vector(2)),
        ];
        let mut bench = Bench::with_inputs(MultiportSwitch { inputs: 3, first: 1, outside }, inputs);
        bench.set(1, &[10.0, 11.0]).set(2, &[20.0]).set(3, &[30.0, 31.0]);
        bench
    }

    #[test]
    fn the_index_chooses_and_is_rounded() {
        let mut bench = bench(Outside::Error);
        for (index, y) in [
            (1.0, [10.0, 11.0]),
            (2.0, [20.0, 20.0]),
            (2.4, [20.0, 20.0]),
            (2.6, [30.0, 31.0]),
            (3.2, [30.0, 31.0]),
            (0.7, [10.0, 11.0]),
        ] {
            assert_eq!(bench.set(0, &[index]).major(), y, "{index}");
            assert!(bench.guards()[0] >= 0.0, "the choice is right for {index}");
        }
        assert!(bench.set(0, &[1.6]).guards()[0] < 0.0, "another one is to be chosen");
    }

    #[test]
    fn an_index_without_an_input_is_an_error_or_the_nearest() {
        for index in [0.4, 4.0, f64::NAN, -1e300] {
            let mut bench = bench(Outside::Error);
            bench.set(0, &[index]);
            let reason =
                std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| bench.major())).unwrap_err();
            let reason = reason.downcast_ref::<String>().unwrap();
            assert!(reason.contains("but the inputs are 1 to 3"), "{reason}");
        }
        let mut bench = bench(Outside::Clamp);
        assert_eq!(bench.set(0, &[-7.0]).major(), [10.0, 11.0]);
        assert!(bench.guards()[0] > 0.0);
        assert_eq!(bench.set(0, &[1e300]).major(), [30.0, 31.0]);
        assert!(bench.guards()[0] > 0.0);
    }
}
