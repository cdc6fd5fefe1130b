use crate::math::elements::{ROUNDING, clamp, parameters_like};
use blocksim_block::prelude::*;

/// Play of a signal, element by element: the output stands still until the input has crossed the play, then it follows
/// half a width behind.
///
/// $$ y(t) = \min(\max(y_0, u - \tfrac{w}{2}), u + \tfrac{w}{2}) $$
///
/// with the output $y_0$ at the end of the last accepted step. The solver stops where the input meets a flank and where it
/// turns round on one, so this is exact whatever the length of the steps. Methods of fixed step do not stop there. Lengths
/// written as plain numbers are in the unit of the input.
///
/// ```ron
/// Backlash(width: "0.2 deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Curve(Backlash))]
pub struct Backlash {
    /// Play $w$ from one flank to the other.
    #[block(difference, not_negative)]
    pub width: f64,
    /// Output at the start; where the input begins outside of the play around it, the nearer flank carries from the start.
    #[block(finite, default = 0.0)]
    pub y0: f64,
}

/// Which flank carries.
const UPWARDS: f64 = 1.0;
const DOWNWARDS: f64 = -1.0;
const NONE: f64 = 0.0;

/// What a change of the flank is called.
const FLANKS: &[Change] = &[
    Change::to(UPWARDS, "is carried upwards"),
    Change::to(DOWNWARDS, "is carried downwards"),
    Change::to(NONE, "rests in its play"),
];

impl Backlash {
    fn follow(&self, u: f64, last: f64) -> f64 {
        if u.is_nan() {
            return u;
        }
        clamp(last, u - 0.5 * self.width, u + 0.5 * self.width)
    }

    /// Which flank carries, where `before` has carried: the same one as long as nothing but rounding is against it. In an algebraic loop the
    /// input follows from the flank, and would have it change to and fro.
    fn flank(&self, u: f64, last: f64, before: f64) -> f64 {
        if self.width == 0.0 {
            return UPWARDS;
        }
        let rounding = ROUNDING * (u.abs() + last.abs() + self.width);
        let beyond = |flank: f64| flank * (u - last) - 0.5 * self.width;
        let carries = |flank: &f64| beyond(*flank) > if before == *flank { -rounding } else { rounding };
        [UPWARDS, DOWNWARDS].into_iter().find(carries).unwrap_or(NONE)
    }

    /// The flanks that carry now; whether they are others.
    fn choose(&self, inputs: &[f64], d: &mut [f64]) -> bool {
        let (last, flanks) = d.split_at_mut(inputs.len());
        let mut changed = false;
        for ((last, flank), u) in last.iter().zip(flanks).zip(inputs) {
            let before = *flank;
            *flank = self.flank(*u, *last, before);
            changed |= *flank != before;
        }
        changed
    }

    /// Notes the outputs.
    fn note(&self, inputs: &[f64], d: &mut [f64]) {
        d.iter_mut().zip(inputs).for_each(|(last, u)| *last = self.follow(*u, *last));
    }
}

impl Block for Backlash {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let dimension = parameters_like(given, "u", u.dimension, &["width", "y0"])?;
        let n = u.shape.len();
        let interface = Interface::new()
            .input(Input::real("u"))
            .output(Output::like("y", u.of(dimension)))
            .memory("y", n, self.y0)
            .modes("flank", n, 0.0, FLANKS)
            .settles()
            .accepts()
            .jumps()
            .jump_called("");
        let interface = interface.guard_each_when(Crossing::Holds, "flank", n);
        Ok(interface.guard_each_when(Crossing::Peak, "turns", n).called_by_mode())
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        self.choose(c.u, d);
    }

    /// Nothing jumps here: it is where all inputs are known. Noted before, iterates of an algebraic loop would carry the output.
    fn jump(&self, c: &Context, _w: &mut Scratch, _x: &mut [f64], d: &mut [f64]) -> bool {
        self.note(c.u, d);
        false
    }

    /// Which flank carries is held between instants. The guards are how far a flank has carried since the last step, or how far both
    /// are away; and the input in the direction in which it carries, which has a maximum where it turns round.
    fn law(&self, l: &Recording) -> bool {
        let n = l.input(0).len();
        let [zero, half] = [0.0, 0.5 * self.width].map(|value| l.constant(value));
        for (i, u) in l.input(0).iter().enumerate() {
            let (last, flank) = (l.d()[i], l.d()[n + i]);
            let rests = flank.live(Relation::Equal, l.constant(NONE));
            let carried = *u - flank * 0.5 * self.width;
            l.set(0, i, rests.and(u.is_number()).select(last, carried));
            if self.width == 0.0 {
                // Without play both flanks carry.
                l.guard(i, zero);
                l.guard(n + i, zero);
                continue;
            }
            let distance = *u - last;
            let right = rests.select(half - distance.abs(), flank * distance - half);
            let rounding = ROUNDING * (u.abs() + last.abs() + self.width);
            l.guard(i, right.abs().live(Relation::LessEqual, rounding).select(zero, right));
            l.guard(n + i, flank * *u);
        }
        true
    }

    fn accept(&self, c: &Context, d: &mut [f64]) -> bool {
        let changed = self.choose(c.u, d);
        self.note(c.u, d);
        changed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const PLAY: Backlash = Backlash { width: 1.0, y0: 0.0 };

    #[test]
    fn the_output_follows_half_a_width_behind_and_rests_at_a_turn() {
        let mut bench = Bench::new(PLAY);
        for (u, y) in [
            (0.5, 0.0),
            (1.0, 0.5),
            (2.0, 1.5),
            (1.5, 1.5),
            (1.0, 1.5),
            (0.75, 1.25),
            (-2.0, -1.5),
            (-1.5, -1.5),
        ] {
            assert_eq!(bench.respond(u), y, "{u}");
            bench.accept();
        }
    }

    #[test]
    fn a_start_outside_of_the_play_is_on_the_nearer_flank() {
        for (u, y) in [(3.0, 2.5), (-3.0, -2.5), (0.25, 0.0)] {
            let mut bench = Bench::new(PLAY);
            assert_eq!(bench.set(0, &[u]).major(), [y]);
            assert!(bench.guards()[0] >= 0.0, "the flank is right from the start");
        }
    }

    #[test]
    fn guards_are_distances_to_flanks_and_the_input_on_a_flank() {
        let mut bench = Bench::new(PLAY);
        bench.set(0, &[0.25]).major();
        assert_eq!(bench.guards(), [0.25, 0.0]);
        bench.set(0, &[2.0]).major();
        assert_eq!(bench.guards(), [0.0, 2.0], "carried upwards to 1.5");
        assert_eq!(bench.set(0, &[1.75]).guards(), [-0.25, 1.75], "turned");
        bench.accept();
        assert_eq!((bench.guards(), bench.minor()), (vec![0.25, 0.0], vec![1.5]), "it stays there");
        bench.set(0, &[0.5]).major();
        assert_eq!(bench.guards(), [0.0, -0.5], "carried downwards to 1");
    }

    #[test]
    fn rejected_trial_steps_leave_no_trace() {
        let mut bench = Bench::with_inputs(PLAY, vec![("u".to_owned(), PortType::vector(2))]);
        bench.set(0, &[3.0, -3.0]).major();
        assert_eq!(bench.set(0, &[4.0, -4.0]).minor(), [3.5, -3.5]);
        assert_eq!(bench.set(0, &[3.0, -3.0]).minor(), [2.5, -2.5]);
        assert!(bench.set(0, &[f64::NAN, 0.0]).minor()[0].is_nan());
    }

    #[test]
    fn the_play_is_in_the_unit_of_the_input_and_not_negative() {
        let y = PLAY.interface(&given(&[("u", "rad")], &[("width", "deg")])).unwrap().outputs[0].port_type;
        assert_eq!(y.dimension, Some(dimension("rad")));
        assert!(PLAY.interface(&given(&[("u", "rad")], &[("width", "V")])).is_err());
        assert_eq!(Backlash { width: -1.0, ..PLAY }.errors()[0].param, "width");
    }
}
