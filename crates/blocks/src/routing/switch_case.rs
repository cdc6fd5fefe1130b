use crate::math::elements::numbered;
use blocksim_block::prelude::*;

/// Chooses one of several conditional subsystems by a number: output `y1` is true while `u` is one of the numbers of the first case,
/// `y2` while it is one of the second, and `default` while it is in no case.
///
/// So exactly one output is true at any time. Connect each to the input `enable` of a subsystem (`enable: Held` or `enable: Reset`), and
/// the outputs of these subsystems to a `Merge`. An output that is not connected chooses nothing.
///
/// The numbers are whole, and each is in one case at most. `u` is rounded to the nearest whole number; the choice changes where the
/// solver stops, and it stops half-way between numbers of different cases.
///
/// ```ron
/// SwitchCase(cases: [[1], [2, 3], [-1]])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Routing", symbol = Lines("case", "default"))]
pub struct SwitchCase {
    /// The numbers of each case.
    #[block(finite, at_least = -LARGEST, at_most = LARGEST)]
    pub cases: Vec<Vec<f64>>,
}

/// Most numbers of all cases.
const MOST: usize = 1000;
/// Whole numbers beyond this have no neighbours half-way to which the choice could change.
const LARGEST: f64 = 4e15;
/// The place of `default` among the outputs is behind those of the cases.
const CHOSEN: &[Change] = &[Change::any("chooses another case")];

/// A stretch of numbers that choose the same.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stretch {
    from: f64,
    to: f64,
    /// Number of the output.
    chosen: usize,
}

impl SwitchCase {
    /// All numbers in their order, with their cases.
    fn sorted(&self) -> Vec<(f64, usize)> {
        let cases = self.cases.iter().enumerate();
        let mut all: Vec<(f64, usize)> =
            cases.flat_map(|(case, numbers)| numbers.iter().map(move |number| (*number, case))).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    /// The line of numbers, cut where the choice changes.
    fn stretches(&self) -> Vec<Stretch> {
        let default = self.cases.len();
        let mut all = vec![Stretch { from: f64::NEG_INFINITY, to: f64::INFINITY, chosen: default }];
        for (number, case) in self.sorted() {
            let (from, to) = (number - 0.5, number + 0.5);
            if let Some(last) = all.last_mut() {
                last.to = from;
            }
            all.push(Stretch { from, to, chosen: case });
            all.push(Stretch { from: to, to: f64::INFINITY, chosen: default });
        }
        all.retain(|stretch| stretch.from < stretch.to);
        all.dedup_by(|next, last| {
            let same = next.chosen == last.chosen;
            if same {
                last.to = next.to;
            }
            same
        });
        all
    }

    fn validate(&self, errors: &mut ParamErrors) {
        errors.take(count("cases", self.cases.iter().map(Vec::len).sum(), 1, MOST));
        for (case, numbers) in self.cases.iter().enumerate() {
            let param = format!("cases[{case}]");
            if numbers.is_empty() {
                let message = "the case has no number, so it would never be chosen";
                errors.add(ParamError::new(&param, message).help("give it a number, or remove it"));
            }
            for (i, number) in numbers.iter().enumerate().filter(|(_, number)| number.fract() != 0.0) {
                let error =
                    ParamError::new(format!("{param}[{i}]"), format!("{number} is not a whole number"));
                errors.add(error.help("cases are whole numbers; IfElse chooses by conditions"));
            }
        }
        for pair in self.sorted().windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            let ((number, one), (_, other)) = (pair[0], pair[1]);
            let (first, last) = (one.min(other), one.max(other));
            let message = match first == last {
                true => format!("{number} is twice in case {}", first + 1),
                false => format!("{number} is in case {} and in case {}", first + 1, last + 1),
            };
            errors.add(ParamError::new(format!("cases[{last}]"), message).help("leave it in one of them"));
        }
    }
}

impl Block for SwitchCase {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let n = self.cases.len();
        let mut names = if n == 1 { vec!["y1".to_owned()] } else { numbered("y", n) };
        names.push("default".to_owned());
        let u = Input::any("u").scalar().dimension(Some(Dimension::NONE));
        let interface = Interface::new().input(u.doc("Number that chooses a case."));
        let interface = names
            .iter()
            .fold(interface, |interface, name| interface.output(Output::like(name, PortType::boolean())));
        Ok(interface.modes("stretch", 1, 0.0, CHOSEN).guard_when(Crossing::Holds, "stretch").called_by_mode())
    }

    fn law(&self, l: &Recording) -> bool {
        let (u, held) = (l.u(0), l.d()[0]);
        u.only_where(u.is_number());
        let stretches = self.stretches();
        let number = u.nearest();
        let (mut now, mut right) = (l.constant(0.0), l.constant(1.0));
        let mut chosen = vec![l.constant(0.0); self.cases.len() + 1];
        for (i, stretch) in stretches.iter().enumerate() {
            let i = l.constant(i as f64);
            let is_held = held.live(Relation::Equal, i);
            if stretch.from.is_finite() {
                now = number.live(Relation::Greater, l.constant(stretch.from)).select(i, now);
            }
            let inside = match (stretch.from.is_finite(), stretch.to.is_finite()) {
                (true, true) => (u - stretch.from).min(stretch.to - u),
                (true, false) => u - stretch.from,
                (false, true) => stretch.to - u,
                (false, false) => l.constant(1.0),
            };
            right = is_held.select(inside, right);
            let output = &mut chosen[stretch.chosen];
            *output = is_held.select(l.constant(1.0), *output);
        }
        l.settle(0, now);
        l.guard(0, right);
        chosen.into_iter().enumerate().for_each(|(port, value)| l.set(port, 0, value));
        true
    }

    fn no_value(&self, _failure: &Failure, c: &Context) -> Option<String> {
        Some(format!("`u` is {}, which is not a number that could choose a case", c.scalar(0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    fn cases(cases: &[&[f64]]) -> SwitchCase {
        SwitchCase { cases: cases.iter().map(|numbers| numbers.to_vec()).collect() }
    }

    #[test]
    fn each_number_chooses_its_case_and_all_others_the_default() {
        let mut bench = Bench::new(cases(&[&[1.0], &[2.0, 3.0], &[-1.0, 7.0]]));
        for (u, chosen) in [
            (1.0, 0),
            (0.6, 0),
            (0.4, 3),
            (2.0, 1),
            (2.5, 1),
            (1.5, 1),
            (3.4, 1),
            (3.6, 3),
            (-1.2, 2),
            (-1.5, 3),
            (7.0, 2),
            (1e300, 3),
            (f64::NEG_INFINITY, 3),
        ] {
            let expected: Vec<f64> = (0..4).map(|k| f64::from(k == chosen)).collect();
            assert_eq!(bench.set(0, &[u]).major(), expected, "{u}");
            assert!(bench.guards()[0] >= 0.0, "the choice is right for {u}");
        }
        bench.set(0, &[2.0]).major();
        assert_eq!(bench.set(0, &[3.0]).guards(), [0.5], "both numbers are of one case");
        assert_eq!(bench.set(0, &[1.0]).guards(), [-0.5], "another one is to be chosen");
        bench.set(0, &[f64::NAN]);
        let reason = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| bench.major())).unwrap_err();
        let reason = reason.downcast_ref::<String>().unwrap();
        assert!(reason.contains("`u` is NaN"), "{reason}");
    }

    #[test]
    fn cases_that_overlap_or_can_never_be_chosen_are_refused() {
        for (block, param) in [
            (cases(&[]), "cases"),
            (cases(&[&[1.0], &[]]), "cases[1]"),
            (cases(&[&[1.0, 2.5]]), "cases[0][1]"),
            (cases(&[&[f64::NAN]]), "cases[0][0]"),
            (cases(&[&[1.0], &[2.0, 1.0]]), "cases[1]"),
            (cases(&[&[4.0, 4.0]]), "cases[0]"),
        ] {
            assert_eq!(block.errors()[0].param, param);
        }
        let error = cases(&[&[1.0], &[2.0, 1.0]]).errors()[0].clone();
        assert_eq!(error.message, "1 is in case 1 and in case 2");
    }
}
