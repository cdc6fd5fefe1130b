use crate::math::elements::{guard_each, parameters_like};
use blocksim_block::prelude::*;

/// Rounds to whole multiples of an interval: $y = q \operatorname{round}(u / q)$, element by element.
///
/// Halves are rounded away from zero. The value is chosen where the solver stops, and it stops half an interval above
/// and below the present value; in between it is held.
///
/// ```ron
/// Quantizer(interval: "0.1 deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Curve(Quantizer))]
pub struct Quantizer {
    /// Interval $q$, in the unit of the input.
    pub interval: f64,
}

impl Block for Quantizer {
    fn check(&self) -> Result<(), ParamError> {
        positive("interval", self.interval)
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let dimension = parameters_like(given, "u", u.dimension, &["interval"])?;
        let n = u.shape.len();
        let interface = Interface::new()
            .input(Input::real("u"))
            .output(Output::like("y", u.of(dimension)))
            .memory("y", n, 0.0)
            .settles();
        Ok(guard_each(guard_each(interface, "above", n), "below", n))
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        d.iter_mut().zip(c.u).for_each(|(d, u)| *d = self.interval * (u / self.interval).round());
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        y.copy_from_slice(c.d);
    }

    fn guards(&self, c: &Context, _w: &mut Scratch, g: &mut [f64]) {
        let half = 0.5 * self.interval;
        let (above, below) = g.split_at_mut(c.u.len());
        for (((above, below), u), y) in above.iter_mut().zip(below).zip(c.u).zip(c.d) {
            *above = u - (y + half);
            *below = u - (y - half);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const QUANTIZER: Quantizer = Quantizer { interval: 0.5 };

    #[test]
    fn multiples_of_the_interval_come_out() {
        let mut bench = Bench::new(QUANTIZER);
        for (u, y) in
            [(0.0, 0.0), (0.24, 0.0), (0.25, 0.5), (0.6, 0.5), (-0.25, -0.5), (-0.2, 0.0), (7.3, 7.5)]
        {
            assert_eq!(bench.respond(u), y, "{u}");
        }
        assert!(bench.respond(f64::NAN).is_nan());
    }

    #[test]
    fn the_guards_lie_half_an_interval_above_and_below() {
        let mut bench = Bench::with_inputs(QUANTIZER, vec![("u".to_owned(), PortType::vector(2))]);
        bench.set(0, &[1.0, -1.0]).major();
        assert_eq!(bench.set(0, &[1.5, -1.0]).minor(), [1.0, -1.0]);
        assert_eq!(bench.guards(), [0.25, -0.25, 0.75, 0.25]);
        assert_eq!(bench.major(), [1.5, -1.0]);
    }

    #[test]
    fn the_interval_is_in_the_unit_of_the_input() {
        let y = QUANTIZER.interface(&given(&[("u", "rad")], &[("interval", "deg")])).unwrap().outputs[0]
            .port_type;
        assert_eq!(y.dimension, Some(dimension("rad")));
        assert!(QUANTIZER.interface(&given(&[("u", "rad")], &[("interval", "V")])).is_err());
        assert_eq!(Quantizer { interval: 0.0 }.check().unwrap_err().param, "interval");
    }
}
