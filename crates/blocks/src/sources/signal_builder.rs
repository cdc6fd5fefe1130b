use blocksim_signal::{Quantity, Value as Written};

use super::course::{After, Course};
use super::table::Table;
use crate::math::elements::TIME;
use crate::math::entries::common;
use blocksim_block::prelude::*;

/// A signal through given points, `(time, value)`.
///
/// Between two points it follows a straight line, or with `interpolation: Hold` it keeps the value of the former. Two points of
/// equal time are a jump: the former value counts until then, the latter from then on. Before the first point its value holds.
/// The solver steps exactly onto each point.
///
/// ```ron
/// SignalBuilder(points: [(0, 0), ("1 s", "5 V"), ("3 s", "5 V"), ("3 s", "-2 V"), ("4 s", 0)])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sources", symbol = Curve(Record), builds = SignalBuilder)]
pub struct SignalBuilder {
    /// Pairs of a time and a value, in the order of time.
    pub points: Vec<(ParamValue, ParamValue)>,
    /// What lies between two points: `Linear` or `Hold`.
    #[block(default = Interpolation::Linear)]
    pub interpolation: Interpolation,
    /// What follows the last point: `Hold` its value, `Extrapolate` the last straight line, `Zero`, or `Cyclic`: the whole again.
    #[block(default = After::Hold)]
    pub after: After,
    /// The points in SI.
    #[block(skip)]
    course: Course,
}

/// What lies between two points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Interpolation {
    /// A straight line.
    Linear,
    /// The value of the former.
    Hold,
}

impl SignalBuilder {
    /// The numbers of the points; what is none counts as missing.
    fn numbers(&self) -> Vec<(Option<Quantity>, Option<Quantity>)> {
        let number = |value: &ParamValue| Written::as_number(&value.0);
        self.points.iter().map(|(time, value)| (number(time), number(value))).collect()
    }

    fn course(&self) -> Course {
        let numbers = self.numbers();
        let values: Vec<Quantity> = numbers.iter().filter_map(|(_, value)| *value).collect();
        let si = |number: Option<Quantity>| number.map_or(f64::NAN, |number| number.value);
        let table = Table {
            times: numbers.iter().map(|(time, _)| si(*time)).collect(),
            values: numbers.iter().map(|(_, value)| si(*value)).collect(),
            columns: vec![("y".to_owned(), common(&values).unwrap_or(Dimension::NONE))],
        };
        Course { table, after: self.after, held: self.interpolation == Interpolation::Hold }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.points.is_empty() {
            let error = ParamError::new("points", "there are no points");
            errors.add(error.help("give pairs of a time and a value: [(0, 0), (\"1 s\", \"5 V\")]"));
        }
        let mut before = f64::NEG_INFINITY;
        let mut values = Vec::new();
        for (i, point) in self.numbers().into_iter().enumerate() {
            let wrong = |message: String| ParamError::new(format!("points[{i}]"), message);
            let (Some(time), Some(value)) = point else {
                let (time, value) = &self.points[i];
                let other = if point.0.is_none() { time } else { value }.0.describe();
                errors.add(wrong(format!("point {i} contains {other}, but must be two numbers")));
                continue;
            };
            if time.dimension != Dimension::NONE && !time.dimension.compatible(TIME) {
                errors
                    .add(wrong(format!("the time of point {i} is in {}, but must be in s", time.dimension)));
                continue;
            }
            if let Some(number) = [time.value, value.value].into_iter().find(|number| !number.is_finite()) {
                errors.take(finite(&format!("points[{i}]"), number));
                continue;
            }
            if time.value < before {
                let message =
                    format!("point {i} is at {} s, before point {} at {before} s", time.value, i - 1);
                let help = "write the points in the order of time; two of equal time are a jump";
                errors.add(wrong(message).help(help));
            }
            before = time.value;
            values.push(value);
        }
        if let Err(reason) = common(&values) {
            let error = ParamError::new("points", format!("`points` {reason}"));
            errors.add(error.help("give all values the same unit"));
        }
        let times = self.numbers();
        if self.after == After::Cyclic && times.first().map(|p| p.0) == times.last().map(|p| p.0) {
            let error = ParamError::new("after", "the points span no time, so there is no cycle");
            errors.add(error.beside(&["points"]));
        }
    }

    fn build(mut self, _errors: &mut ParamErrors) -> Option<Self> {
        self.course = self.course();
        Some(self)
    }
}

impl Block for SignalBuilder {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let dimension = self.course().table.columns[0].1;
        Ok(Course::declare(Interface::new().output(Output::real("y").dimension(Some(dimension))), 1))
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        self.course.keep(c.t, d);
    }

    fn law(&self, l: &Recording) -> bool {
        Course::record(l);
        true
    }

    fn next_event(&self, c: &Context) -> f64 {
        self.course.next(c.t)
    }

    fn end_time(&self) -> Option<f64> {
        if self.after == After::Cyclic { None } else { self.course.table.times.last().copied() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    fn builder(points: &[(f64, f64)]) -> SignalBuilder {
        let value = |value: f64| ParamValue(value.into());
        SignalBuilder {
            points: points.iter().map(|(time, y)| (value(*time), value(*y))).collect(),
            interpolation: Interpolation::Linear,
            after: After::Hold,
            course: Course::default(),
        }
    }

    fn at(block: &SignalBuilder, times: &[f64]) -> Vec<f64> {
        let mut bench = Bench::new(block.clone());
        let y = |t: &f64| {
            bench.t = *t;
            bench.major()[0]
        };
        times.iter().map(y).collect()
    }

    const POINTS: [(f64, f64); 4] = [(1.0, 2.0), (2.0, 4.0), (2.0, -1.0), (4.0, 1.0)];

    #[test]
    fn points_are_joined_and_jumps_are_at_their_times() {
        let times = [0.0, 1.0, 1.5, 2.0_f64.next_down(), 2.0, 3.0, 4.0, 9.0];
        let expected = [2.0, 2.0, 3.0, 4.0, -1.0, 0.0, 1.0, 1.0];
        for (y, expected) in at(&builder(&POINTS), &times).into_iter().zip(expected) {
            assert!((y - expected).abs() < 1e-14, "{y} instead of {expected}");
        }
        let hold = SignalBuilder { interpolation: Interpolation::Hold, ..builder(&POINTS) };
        assert_eq!(at(&hold, &times[..7]), [2.0, 2.0, 2.0, 2.0, -1.0, -1.0, 1.0]);
    }

    #[test]
    fn what_follows_the_last_point_is_chosen() {
        let after = |after| at(&SignalBuilder { after, ..builder(&POINTS) }, &[5.0, 6.0]);
        assert_eq!(after(After::Zero), [0.0, 0.0]);
        assert_eq!(after(After::Extrapolate), [2.0, 3.0]);
        // The course begins again at 4 s, with the point of 1 s.
        assert_eq!(after(After::Cyclic), [-1.0, 0.0]);
    }

    #[test]
    fn every_point_is_an_event() {
        let mut bench = Bench::new(builder(&POINTS));
        let mut events = Vec::new();
        while bench.next_event().is_finite() {
            bench.t = bench.next_event();
            events.push(bench.t);
        }
        assert_eq!(events, [1.0, 2.0, 4.0]);
    }

    #[test]
    fn what_makes_no_course_is_refused() {
        let volt = |unit: &str| {
            let dimension = crate::math::elements::dimension(unit);
            ParamValue(Quantity::new(1.0, dimension).into())
        };
        let mixed = |time: &str, value: &str| {
            let mut block = builder(&POINTS);
            block.points[1] = (volt(time), volt(value));
            block
        };
        for (block, what) in [
            (builder(&[]), "no points"),
            (builder(&[(1.0, 0.0), (0.5, 1.0)]), "point 1 is at 0.5 s, before point 0 at 1 s"),
            (builder(&[(f64::NAN, 0.0)]), "finite"),
            (mixed("V", "1"), "the time of point 1 is in V"),
            (mixed("s", "V"), "mixes 1 and V"),
            (SignalBuilder { after: After::Cyclic, ..builder(&[(1.0, 0.0), (1.0, 2.0)]) }, "no cycle"),
        ] {
            let error = &block.errors()[0];
            assert!(error.message.contains(what), "{}", error.message);
        }
    }
}
