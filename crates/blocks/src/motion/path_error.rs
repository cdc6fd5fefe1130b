use blocksim_block::prelude::*;

/// How far a tool is from where it should be: in all, along its way and across it.
///
/// With $e = p - p_{set}$ and the set velocity $v$
///
/// $$ d = |e|, \qquad e_{along} = \frac{e \cdot v}{\sqrt{v^2 + v_0^2}}, \qquad
///    e_{across} = \left| e - v\,\frac{e \cdot v}{v^2 + v_0^2} \right| $$
///
/// `along` is negative where the tool lags behind. `across` is the distance from the way: what a seam or a cut shows, while
/// a lag does not. Where the tool is to rest there is no way; below `slow` ($v_0$) all of the distance becomes `across`.
///
/// ```ron
/// PathError
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Motion")]
pub struct PathError {
    /// Speed below which the tool counts as resting, positive.
    #[block(unit = "m/s", positive, default = 1e-3)]
    pub slow: f64,
}

impl Block for PathError {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let vector =
            |name: &str, unit: &str, doc| Input::real(name).shape(Shape::Vector(3)).unit(unit).doc(doc);
        Ok(Interface::new()
            .input(vector("set", "m", "where the tool should be"))
            .input(vector("v", "m/s", "velocity that it should have"))
            .input(vector("actual", "m", "where it is"))
            .output(Output::real("distance").unit("m").doc("distance of the two"))
            .output(Output::real("along").unit("m").doc("part along the way"))
            .output(Output::real("across").unit("m").doc("part across the way")))
    }

    fn law<'r>(&self, l: &Recording<'r>) -> bool {
        let (set, v, actual) = (l.input(0), l.input(1), l.input(2));
        let e = [0, 1, 2].map(|i| actual[i] - set[i]);
        let dot = |a: &[Value<'r>], b: &[Value<'r>]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let square = dot(v, v) + self.slow * self.slow;
        let share = dot(&e, v) / square;
        let across = [0, 1, 2].map(|i| e[i] - share * v[i]);
        l.set(0, 0, dot(&e, &e).sqrt());
        l.set(1, 0, share * square.sqrt());
        l.set(2, 0, dot(&across, &across).sqrt());
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    fn error(set: [f64; 3], v: [f64; 3], actual: [f64; 3]) -> Vec<f64> {
        let mut bench = Bench::new(PathError { slow: 1e-3 });
        bench.set(0, &set).set(1, &v).set(2, &actual).major()
    }

    #[test]
    fn lag_and_distance_from_the_way_are_told_apart() {
        // 3 mm behind and 4 mm beside a tool that goes along x at 0.5 m/s.
        let y = error([1.0, 0.0, 0.5], [0.5, 0.0, 0.0], [0.997, 0.004, 0.5]);
        for (y, expected) in y.iter().zip([5e-3, -3e-3, 4e-3]) {
            assert!((y - expected).abs() < 2e-8, "{y} is not {expected}");
        }
    }

    #[test]
    fn at_rest_all_of_the_distance_is_across() {
        assert_eq!(error([1.0, 0.0, 0.0], [0.0; 3], [1.0, 0.002, 0.0]), [0.002, 0.0, 0.002]);
        assert_eq!(error([1.0, 2.0, 3.0], [0.0; 3], [1.0, 2.0, 3.0]), [0.0; 3]);
    }

    #[test]
    fn a_speed_of_nothing_cannot_be_told_from_rest() {
        assert_eq!(PathError { slow: 0.0 }.errors()[0].param, "slow");
    }
}
