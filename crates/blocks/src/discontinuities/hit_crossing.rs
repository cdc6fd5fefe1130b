use crate::continuous::{Reset, UNSEEN};
use crate::math::elements::parameters_like;
use blocksim_block::prelude::*;

/// Counts how often a signal crosses a value, and gives the time of the last one; element by element.
///
/// The solver stops at each crossing in the direction that counts, and at no other, also where the signal only dips through
/// the value and back within a step. A signal that reaches the value has crossed it, and does not when it goes on from there.
/// Whether one that turns round at the value has is decided by its last digit. A signal that stands on the value at the start has
/// not crossed it, wherever it goes.
///
/// ```ron
/// HitCrossing(at: "90 deg", direction: Rising)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Text("u × → n"))]
pub struct HitCrossing {
    /// The value, in the unit of the input.
    #[block(finite, default = 0.0)]
    pub at: f64,
    /// Which crossings count: `Rising`, `Falling` or `Either`.
    #[block(default = Crossing::Either)]
    pub direction: Crossing,
}

impl HitCrossing {
    fn edge(&self) -> Reset {
        match self.direction {
            Crossing::Either | Crossing::Holds | Crossing::Peak => Reset::Either,
            Crossing::Rising => Reset::Rising,
            Crossing::Falling => Reset::Falling,
        }
    }
}

impl Block for HitCrossing {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        parameters_like(given, "u", u.dimension, &["at"])?;
        let n = u.shape.len();
        let interface = Interface::new()
            .input(Input::real("u"))
            .output(Output::real("count").shape(u.shape).doc("crossings so far"))
            .output(
                Output::real("time")
                    .shape(u.shape)
                    .unit("s")
                    .doc("when the last one was; 0 before the first"),
            )
            .memory("side", n, UNSEEN)
            .memory("count", n, 0.0)
            .memory("time", n, 0.0);
        let guarded = interface.guard_each_when(self.direction, "crosses", n);
        Ok(guarded.called("counts a crossing upwards", "counts a crossing downwards"))
    }

    fn law(&self, l: &Recording) -> bool {
        let n = l.input(0).len();
        for (i, u) in l.input(0).iter().enumerate() {
            let [side, count, time] = [i, n + i, 2 * n + i].map(|at| l.d()[at]);
            let distance = *u - self.at;
            let (fires, now) = self.edge().fires_in(l, side, distance);
            // What has stood on the value from the start on comes from neither side.
            let unseen = l.constant(UNSEEN);
            let on = side.live(Relation::Equal, unseen).and(distance.live(Relation::Equal, l.constant(0.0)));
            l.settle(i, on.select(unseen, now));
            l.settle(n + i, fires.select(count + 1.0, count));
            l.settle(2 * n + i, fires.select(l.time(), time));
            l.set(0, i, count);
            l.set(1, i, time);
            l.guard(i, distance);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    fn counts(direction: Crossing, values: &[f64]) -> [f64; 2] {
        let mut bench = Bench::new(HitCrossing { at: 1.0, direction });
        let mut y = Vec::new();
        for (k, value) in values.iter().enumerate() {
            bench.t = k as f64;
            y = bench.set(0, &[*value]).major();
        }
        [y[0], y[1]]
    }

    #[test]
    fn each_direction_counts_its_own_and_tells_the_last_time() {
        let values = [0.0, 2.0, 0.5, 3.0, 1.0, 0.0, 0.0];
        assert_eq!(counts(Crossing::Rising, &values), [2.0, 3.0]);
        assert_eq!(counts(Crossing::Falling, &values), [2.0, 4.0]);
        assert_eq!(counts(Crossing::Either, &values), [4.0, 4.0]);
        assert_eq!(counts(Crossing::Either, &[2.0, 2.0]), [0.0, 0.0]);
        assert_eq!(
            counts(Crossing::Either, &[1.0, 1.0, 2.0, 0.5]),
            [1.0, 3.0],
            "it stands there at the start"
        );
        assert_eq!(counts(Crossing::Rising, &[0.0, 1.0, 1.0, 2.0]), [1.0, 1.0], "it goes on");
    }

    #[test]
    fn the_guard_has_the_direction_and_elements_count_alone() {
        let block = HitCrossing { at: 1.0, direction: Crossing::Falling };
        let mut bench = Bench::with_inputs(block, vec![("u".to_owned(), PortType::vector(2))]);
        assert!(bench.interface.guards.iter().all(|guard| guard.crossing == Crossing::Falling));
        bench.set(0, &[2.0, 2.0]).major();
        bench.t = 0.5;
        assert_eq!(bench.set(0, &[2.0, 0.0]).major(), [0.0, 1.0, 0.0, 0.5]);
        assert_eq!(bench.guards(), [1.0, -1.0]);
        assert_eq!(HitCrossing { at: f64::NAN, direction: Crossing::Either }.errors()[0].param, "at");
    }
}
