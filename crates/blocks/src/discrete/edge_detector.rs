use blocksim_block::prelude::*;

use crate::continuous::reset::UNSEEN;

/// Is true for one sample when its input has an edge, element by element.
///
/// `Rising`: false or not positive at the sample before, and true or positive now; `Falling` the other way round. The first sample
/// is no edge. What happens between two samples is not seen; `Counter` and `HitCrossing` see every edge, whenever it comes.
///
/// ```ron
/// EdgeDetector(ts: "10 ms", direction: Either)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Text("u ↑"))]
pub struct EdgeDetector {
    /// Sample time, positive.
    #[block(unit = "s", positive)]
    pub ts: f64,
    /// Which edges: `Rising`, `Falling` or `Either`.
    #[block(default = Crossing::Rising)]
    pub direction: Crossing,
}

impl Block for EdgeDetector {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let shape = given.input_or_unknown("u").shape;
        Ok(Interface::new()
            .input(Input::any("u").doc("Bool, or Real of which the sign counts."))
            .output(Output::boolean("y").shape(shape))
            .memory("before", shape.len(), UNSEEN)
            .sampled(self.ts))
    }

    fn law(&self, l: &Recording) -> bool {
        let [on, off] = [1.0, -1.0].map(|side| l.constant(side));
        for i in 0..l.width(0) {
            let is_on = l.element(0, i).live(Relation::Greater, l.constant(0.0));
            let was = |side| l.d()[i].live(Relation::Equal, side);
            let (rises, falls) = (was(off).and(is_on), was(on).and(!is_on));
            l.set_truth(
                0,
                i,
                match self.direction {
                    Crossing::Rising => rises,
                    Crossing::Falling => falls,
                    Crossing::Either | Crossing::Holds | Crossing::Peak => rises.or(falls),
                },
            );
            l.update(i, is_on.select(on, off));
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn each_edge_shows_for_one_sample() {
        let samples = [1.0, 1.0, 0.0, -1.0, 2.0, 3.0, -1.0, 0.5];
        for (direction, edges) in [
            (Crossing::Rising, vec![4, 7]),
            (Crossing::Falling, vec![2, 6]),
            (Crossing::Either, vec![2, 4, 6, 7]),
        ] {
            let mut bench = Bench::new(EdgeDetector { ts: 0.1, direction });
            let found: Vec<usize> =
                (0..samples.len()).filter(|k| bench.set(0, &[samples[*k]]).hit() == [1.0]).collect();
            assert_eq!(found, edges, "{direction:?}");
        }
    }
}
