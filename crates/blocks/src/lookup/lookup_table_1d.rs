use blocksim_block::prelude::*;

use super::akima;
use super::interval::{
    Extrapolation, Kinks, below, bends, enough, in_interval, interval, mix, recorded_below, recorded_mix,
    recorded_share, share,
};
use crate::continuous::units::{agrees, element};

/// Looks a value up in a table, with interpolation: $y = f(u)$ through the points
/// $(\mathrm{breakpoints}_i, \mathrm{table}_i)$.
///
/// | interpolation | between two breakpoints |
/// |---|---|
/// | `Linear` | the straight line |
/// | `Flat` | the value at the lower one |
/// | `Nearest` | the value at the nearer one; in the middle, at the upper one |
/// | `Cubic` | Akima's curve: smooth up to the first derivative, no overshoot beside flat stretches |
///
/// At the breakpoints the values are exact. Beyond the ends `Linear` and `Cubic` go on along the tangent, or stay
/// at the end with `extrapolation: Clip`; `Flat` and `Nearest` stay at the end. Where these two jump is an event; where
/// slope or curvature of the others change the solver steps onto the kink.
/// The output has the unit of `table`. Direct feedthrough; vectors are looked up element by element.
///
/// ```ron
/// LookupTable1D(breakpoints: ["0 deg", "30 deg", "90 deg"], table: ["0 N", "2 N", "3 N"], extrapolation: Clip)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Lookup", symbol = Curve(Table))]
pub struct LookupTable1D {
    /// Values of the input, strictly increasing.
    #[block(not_empty, finite, increasing, remedy = "sort the breakpoints and name each only once")]
    pub breakpoints: Vec<f64>,
    /// Values of the output, one for each breakpoint.
    #[block(finite, as_many_as = breakpoints)]
    pub table: Vec<f64>,
    /// `Linear`, `Flat`, `Nearest` or `Cubic`.
    #[block(default = Interpolation::Linear)]
    pub interpolation: Interpolation,
    /// `Clip` or `Linear`.
    #[block(default = Extrapolation::Linear)]
    pub extrapolation: Extrapolation,
}

/// The value of a table between its breakpoints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Interpolation {
    /// The straight line.
    Linear,
    /// The value at the lower breakpoint.
    Flat,
    /// The value at the nearer breakpoint.
    Nearest,
    /// Akima's curve.
    Cubic,
}

impl LookupTable1D {
    /// Whether the output jumps.
    fn steps(&self) -> bool {
        matches!(self.interpolation, Interpolation::Flat | Interpolation::Nearest)
    }

    /// Number of places where a stepped output jumps: at each breakpoint after the first (`Flat`), or in the
    /// middle before each of them (`Nearest`).
    fn jumps(&self) -> usize {
        self.table.len() - 1
    }

    fn place_of_jump(&self, i: usize) -> f64 {
        let (below, above) = (self.breakpoints[i], self.breakpoints[i + 1]);
        if self.interpolation == Interpolation::Flat { above } else { below + (above - below) / 2.0 }
    }

    /// How many jumps lie at or below `u`: the index of the value in the table.
    fn step(&self, u: f64) -> usize {
        let i = interval(&self.breakpoints, u);
        if self.jumps() > 0 && u >= self.place_of_jump(i) { i + 1 } else { i }
    }

    /// The slope just below and just above breakpoint `i`.
    fn slopes(&self, i: usize) -> [f64; 2] {
        let (x, y) = (&self.breakpoints, &self.table);
        let last = x.len() - 1;
        let secant = |k: usize| (y[k + 1] - y[k]) / (x[k + 1] - x[k]);
        let inside = |k: usize| match self.interpolation {
            Interpolation::Cubic => akima::slope(x, y, i),
            _ => secant(k),
        };
        let outside = |k: usize| if self.extrapolation == Extrapolation::Clip { 0.0 } else { inside(k) };
        match i {
            _ if last == 0 => [0.0; 2],
            0 => [outside(0), inside(0)],
            i if i == last => [inside(i - 1), outside(i - 1)],
            i => [inside(i - 1), inside(i)],
        }
    }

    /// Whether the second derivative of Akima's curve jumps at breakpoint `i`.
    fn curvature_jumps(&self, i: usize) -> bool {
        let (x, y) = (&self.breakpoints, &self.table);
        if self.interpolation != Interpolation::Cubic || x.len() < 2 {
            return false;
        }
        let before = if i > 0 { akima::curvature(x, y, i - 1)[1] } else { 0.0 };
        let after = if i + 1 < x.len() { akima::curvature(x, y, i)[0] } else { 0.0 };
        bends(before, after, x, i, before.abs() + after.abs())
    }

    fn kinks(&self) -> Kinks<'_, impl Fn(usize) -> bool> {
        Kinks {
            breakpoints: &self.breakpoints,
            is_kink: |i| {
                let [before, after] = self.slopes(i);
                bends(before, after, &self.breakpoints, i, self.table[i]) || self.curvature_jumps(i)
            },
        }
    }

    fn smooth(&self, u: f64) -> f64 {
        let (x, y) = (&self.breakpoints, &self.table);
        let (i, share) = share(x, u, self.extrapolation);
        if x.len() == 1 {
            return if u.is_nan() { u } else { y[0] };
        }
        if self.interpolation != Interpolation::Cubic {
            return mix(y[i], y[i + 1], share);
        }
        if share <= 0.0 {
            y[i] + share * (x[i + 1] - x[i]) * akima::slope(x, y, i)
        } else if share >= 1.0 {
            y[i + 1] + (share - 1.0) * (x[i + 1] - x[i]) * akima::slope(x, y, i + 1)
        } else {
            akima::curve(x, y, i, u)
        }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        let ends = if self.steps() { Extrapolation::Clip } else { self.extrapolation };
        enough("breakpoints", &self.breakpoints, ends, errors);
    }
}

/// Adds guards for the places above and below the present one, for element `i` of `n`.
fn both(
    mut interface: Interface,
    i: usize,
    n: usize,
    add: impl Fn(Interface, &str) -> Interface,
) -> Interface {
    for name in ["above", "below"] {
        interface = add(interface, name).detail((n > 1).then(|| format!("element {i}")));
    }
    interface.called("passes a breakpoint upwards", "passes a breakpoint downwards")
}

/// Most breakpoints of a table that is a law: of more, the place of a value is searched for.
const FEW: usize = 32;

impl Block for LookupTable1D {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees(given, "breakpoints", "u", u.dimension)?;
        let y = Output::like("y", u.of(Some(given.parameters.get("table"))));
        let mut interface = Interface::new().input(Input::real("u")).output(y);
        let n = u.shape.len();
        if self.steps() {
            interface = interface.settles().memory("step", u.shape.len(), 0.0);
            for i in 0..n {
                interface = both(interface, i, n, |all, name| all.guard(name));
            }
        } else if self.kinks().any() {
            interface = interface.settles().memory("interval", u.shape.len(), 0.0);
            for i in 0..n {
                interface = both(interface, i, n, |all, name| all.kink(name));
            }
        }
        Ok(interface)
    }

    /// Straight lines of few breakpoints; all others are called.
    fn law(&self, l: &Recording) -> bool {
        let (x, y) = (&self.breakpoints, &self.table);
        if self.interpolation != Interpolation::Linear || !(2..=FEW).contains(&x.len()) {
            return false;
        }
        for i in 0..l.width(0) {
            let u = l.element(0, i);
            let [y0, y1] = [0, 1].map(|side| in_interval(l, x, u, |i| l.constant(y[i + side])));
            l.set(0, i, recorded_mix(y0, y1, recorded_share(l, x, u, self.extrapolation)));
            if l.guards() > 0 {
                let [above, below] = self.kinks().recorded(l, u, l.d()[i]);
                l.guard(2 * i, above);
                l.guard(2 * i + 1, below);
                l.settle(i, recorded_below(l, x, u));
            }
        }
        true
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        let place = |u| if self.steps() { self.step(u) } else { below(&self.breakpoints, u) };
        d.iter_mut().enumerate().for_each(|(i, at)| *at = place(element(c.u, i)) as f64);
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        for (i, y) in y.iter_mut().enumerate() {
            let u = element(c.u, i);
            *y = match self.steps() {
                false => self.smooth(u),
                true if u.is_nan() => u,
                true => self.table[c.d[i] as usize],
            };
        }
    }

    /// Distances to the jumps above and below the held value, or to the kinks around the interval of the last instant.
    /// A guard without a jump or kink keeps its sign.
    fn guards(&self, c: &Context, _w: &mut Scratch, g: &mut [f64]) {
        for (i, (g, step)) in g.chunks_exact_mut(2).zip(c.d).enumerate() {
            let (u, step) = (element(c.u, i), *step as usize);
            if !self.steps() {
                g.copy_from_slice(&self.kinks().around(step, u));
                continue;
            }
            g[0] = if step < self.jumps() { u - self.place_of_jump(step) } else { -1.0 };
            g[1] = if step > 0 { u - self.place_of_jump(step - 1) } else { 1.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuous::units::testing::{interface_with, output_unit, vector};
    use blocksim_block::testing::Bench;

    const ALL: [Interpolation; 4] =
        [Interpolation::Linear, Interpolation::Flat, Interpolation::Nearest, Interpolation::Cubic];

    fn block(interpolation: Interpolation, extrapolation: Extrapolation) -> LookupTable1D {
        LookupTable1D {
            breakpoints: vec![-1.0, 0.0, 0.3, 2.0],
            table: vec![0.1, 0.7, -0.2, 5.0],
            interpolation,
            extrapolation,
        }
    }

    #[test]
    fn values_at_breakpoints_are_exact() {
        for interpolation in ALL {
            for extrapolation in [Extrapolation::Clip, Extrapolation::Linear] {
                let table = block(interpolation, extrapolation);
                let mut bench = Bench::new(table.clone());
                for (u, y) in table.breakpoints.iter().zip(&table.table) {
                    assert_eq!(bench.respond(*u), *y, "{interpolation:?} {extrapolation:?} at {u}");
                }
            }
        }
    }

    #[test]
    fn between_breakpoints_each_interpolation_says_its_own() {
        let y = |interpolation, u| Bench::new(block(interpolation, Extrapolation::Linear)).respond(u);
        assert!((y(Interpolation::Linear, -0.25) - 0.55).abs() < 1e-15);
        assert_eq!(y(Interpolation::Flat, 1.999), -0.2);
        assert_eq!(y(Interpolation::Nearest, 1.1), -0.2);
        assert_eq!(y(Interpolation::Nearest, 1.2), 5.0);
        assert_eq!(y(Interpolation::Nearest, -0.5), 0.7);
    }

    #[test]
    fn the_cubic_curve_and_its_slope_are_continuous() {
        let mut bench = Bench::new(block(Interpolation::Cubic, Extrapolation::Linear));
        let h = 1e-7;
        for u in [-1.0, 0.0, 0.3, 2.0] {
            let (before, at, after) = (bench.respond(u - h), bench.respond(u), bench.respond(u + h));
            let (left, right) = ((at - before) / h, (after - at) / h);
            // Curvature is below 100 here, so the slopes differ by some 1e-5.
            assert!((left - right).abs() < 1e-4, "{u}: {left} {right}");
        }
    }

    #[test]
    fn beyond_the_ends_the_table_is_clipped_or_goes_straight_on() {
        for interpolation in ALL {
            let mut bench = Bench::new(block(interpolation, Extrapolation::Clip));
            assert_eq!((bench.respond(-9.0), bench.respond(9.0)), (0.1, 5.0));
        }
        let mut bench = Bench::new(block(Interpolation::Linear, Extrapolation::Linear));
        assert!((bench.respond(-2.0) - (0.1 - 0.6)).abs() < 1e-15);
        assert!((bench.respond(3.7) - 10.2).abs() < 1e-14);
        let mut bench = Bench::new(block(Interpolation::Flat, Extrapolation::Linear));
        assert_eq!((bench.respond(-9.0), bench.respond(9.0)), (0.1, 5.0));
    }

    #[test]
    fn what_is_not_a_number_stays_so() {
        for interpolation in ALL {
            for extrapolation in [Extrapolation::Clip, Extrapolation::Linear] {
                assert!(Bench::new(block(interpolation, extrapolation)).respond(f64::NAN).is_nan());
            }
        }
    }

    #[test]
    fn one_breakpoint_is_enough_for_a_clipped_table() {
        for interpolation in ALL {
            let one = |extrapolation| LookupTable1D {
                breakpoints: vec![1.0],
                table: vec![4.0],
                ..block(interpolation, extrapolation)
            };
            let mut bench = Bench::new(one(Extrapolation::Clip));
            assert_eq!((bench.respond(-3.0), bench.respond(3.0)), (4.0, 4.0));
            assert!(bench.respond(f64::NAN).is_nan());
        }
        let line = LookupTable1D {
            breakpoints: vec![1.0],
            table: vec![4.0],
            ..block(Interpolation::Linear, Extrapolation::Linear)
        };
        assert_eq!(line.errors()[0].param, "breakpoints");
    }

    #[test]
    fn the_guards_hold_the_value_between_its_jumps_however_far_the_input_goes() {
        for (interpolation, jumps) in
            [(Interpolation::Flat, [0.0, 0.3, 2.0]), (Interpolation::Nearest, [-0.5, 0.15, 1.15])]
        {
            let mut bench = Bench::new(block(interpolation, Extrapolation::Clip));
            for held in [-0.9, 0.1, 0.9, 3.0] {
                bench.set(0, &[held]).major();
                let value = bench.minor()[0];
                for u in [-9.0, -0.7, -0.2, 0.07, 0.2, 1.0, 1.5, 9.0] {
                    let g = bench.set(0, &[u]).guards();
                    let between = jumps.iter().filter(|jump| (held < **jump) != (u < **jump)).count();
                    assert_eq!(
                        g[0] >= 0.0 || g[1] < 0.0,
                        between > 0,
                        "{interpolation:?} from {held} to {u}"
                    );
                    assert_eq!(bench.minor()[0], value);
                }
            }
        }
    }

    #[test]
    fn the_guards_of_kinks_change_their_sign_however_many_lie_within_a_step() {
        for (interpolation, extrapolation, kinks) in [
            (Interpolation::Linear, Extrapolation::Linear, &[0.0, 0.3][..]),
            (Interpolation::Linear, Extrapolation::Clip, &[-1.0, 0.0, 0.3, 2.0]),
            (Interpolation::Cubic, Extrapolation::Clip, &[-1.0, 0.0, 0.3, 2.0]),
        ] {
            let mut bench = Bench::new(block(interpolation, extrapolation));
            for held in [-1.5, -0.9, 0.1, 0.9, 3.0] {
                bench.set(0, &[held]).major();
                for u in [-9.0, -0.7, -0.2, 0.07, 0.2, 1.0, 1.5, 9.0] {
                    let g = bench.set(0, &[u]).guards();
                    let between = kinks.iter().any(|kink| (held < *kink) != (u < *kink));
                    assert_eq!(g[0] >= 0.0 || g[1] < 0.0, between, "{interpolation:?} from {held} to {u}");
                    assert_eq!(bench.minor()[0], Bench::new(block(interpolation, extrapolation)).respond(u));
                }
            }
        }
    }

    #[test]
    fn what_is_straight_has_no_kinks_in_spite_of_rounding() {
        let breakpoints: Vec<f64> = (0..50).map(|k| 0.1 * f64::from(k)).collect();
        let line = |extrapolation| LookupTable1D {
            table: breakpoints.iter().map(|x| 1e3 + 0.3 * x).collect(),
            breakpoints: breakpoints.clone(),
            interpolation: Interpolation::Linear,
            extrapolation,
        };
        assert!(!line(Extrapolation::Linear).kinks().any());
        let clipped = line(Extrapolation::Clip);
        let kinks: Vec<usize> = (0..50).filter(|i| (clipped.kinks().is_kink)(*i)).collect();
        assert_eq!(kinks, [0, 49]);
    }

    #[test]
    fn within_a_step_the_value_of_the_table_stays() {
        let mut bench = Bench::with_inputs(block(Interpolation::Flat, Extrapolation::Clip), vector("u", 2));
        bench.set(0, &[-0.5, 1.0]).major();
        assert_eq!(bench.set(0, &[0.1, 3.0]).minor(), [0.1, -0.2]);
        assert_eq!(bench.major(), [0.7, 5.0]);
    }

    #[test]
    fn the_unit_is_that_of_the_table() {
        let block = block(Interpolation::Linear, Extrapolation::Clip);
        assert_eq!(output_unit(&block, &[("u", "rad")], &[("table", "N"), ("breakpoints", "deg")]), "N");
        assert_eq!(output_unit(&block, &[("u", "V")], &[]), "1");
        assert!(interface_with(&block, &[("u", "V")], &[("breakpoints", "A")]).is_err());
    }

    #[test]
    fn tables_that_make_no_function_are_refused() {
        let linear = || block(Interpolation::Linear, Extrapolation::Linear);
        let refused = [
            (LookupTable1D { breakpoints: vec![0.0, 1.0, 1.0, 2.0], ..linear() }, "breakpoints[2]"),
            (LookupTable1D { breakpoints: Vec::new(), ..linear() }, "breakpoints"),
            (LookupTable1D { table: vec![1.0], ..linear() }, "table"),
            (LookupTable1D { table: vec![1.0, 2.0, f64::NAN, 3.0], ..linear() }, "table[2]"),
        ];
        for (block, param) in refused {
            assert_eq!(block.errors()[0].param, param);
        }
    }
}
