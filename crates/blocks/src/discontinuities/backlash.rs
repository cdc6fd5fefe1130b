use crate::math::elements::{clamp, parameters_like};
use blocksim_block::prelude::*;

/// Play of a signal, element by element: the output stands still until the input has crossed the play, then it follows
/// half a width behind.
///
/// $$ y(t) = \min(\max(y_0, u - \tfrac{w}{2}), u + \tfrac{w}{2}) $$
///
/// with the output $y_0$ at the end of the last accepted step. This is exact while the input does not turn round by
/// more than the width within one step. Lengths written as plain numbers are in the unit of the input.
///
/// ```ron
/// Backlash(width: "0.2 deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Curve(Backlash))]
pub struct Backlash {
    /// Play $w$ from one flank to the other.
    pub width: f64,
    /// Output at the start.
    #[block(default = 0.0)]
    pub y0: f64,
}

impl Backlash {
    fn follow(&self, u: f64, last: f64) -> f64 {
        if u.is_nan() {
            return u;
        }
        clamp(last, u - 0.5 * self.width, u + 0.5 * self.width)
    }
}

impl Block for Backlash {
    fn check(&self) -> Result<(), ParamError> {
        not_negative("width", self.width)?;
        finite("y0", self.y0)
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let dimension = parameters_like(given, "u", u.dimension, &["width", "y0"])?;
        Ok(Interface::new()
            .input(Input::real("u"))
            .output(Output::like("y", u.of(dimension)))
            .memory("y", u.shape.len(), self.y0)
            .accepts())
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        for ((y, u), last) in y.iter_mut().zip(c.u).zip(c.d) {
            *y = self.follow(*u, *last);
        }
    }

    fn accept(&self, c: &Context, d: &mut [f64]) {
        d.iter_mut().zip(c.u).for_each(|(last, u)| *last = self.follow(*u, *last));
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
    fn rejected_trial_steps_leave_no_trace() {
        let mut bench = Bench::with_inputs(PLAY, vec![("u".to_owned(), PortType::vector(2))]);
        assert_eq!(bench.set(0, &[3.0, -3.0]).minor(), [2.5, -2.5]);
        assert_eq!(bench.set(0, &[1.0, 0.0]).minor(), [0.5, 0.0]);
        assert!(bench.set(0, &[f64::NAN, 0.0]).minor()[0].is_nan());
    }

    #[test]
    fn the_play_is_in_the_unit_of_the_input_and_not_negative() {
        let y = PLAY.interface(&given(&[("u", "rad")], &[("width", "deg")])).unwrap().outputs[0].port_type;
        assert_eq!(y.dimension, Some(dimension("rad")));
        assert!(PLAY.interface(&given(&[("u", "rad")], &[("width", "V")])).is_err());
        assert_eq!(Backlash { width: -1.0, ..PLAY }.check().unwrap_err().param, "width");
    }
}
