use crate::math::elements::parameters_like;
use blocksim_block::prelude::*;

/// No output while the input is between `start` and `end`, beyond that the distance to the zone; element by element.
///
/// $$ y = u - \min(\max(u, u_\text{start}), u_\text{end}) $$
///
/// The solver steps onto the kinks. Limits written as plain numbers are in the unit of the input.
///
/// ```ron
/// DeadZone(start: "-0.5 deg", end: "0.5 deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Curve(DeadZone))]
pub struct DeadZone {
    /// Lower end of the zone.
    #[block(finite)]
    pub start: f64,
    /// Upper end of the zone.
    #[block(finite, above = start)]
    pub end: f64,
}

impl Block for DeadZone {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let dimension = parameters_like(given, "u", u.dimension, &["start", "end"])?;
        let n = u.shape.len();
        let interface = Interface::new().input(Input::real("u")).output(Output::like("y", u.of(dimension)));
        let start =
            interface.kink_each("start", n).called("enters the dead zone", "leaves the dead zone downwards");
        Ok(start.kink_each("end", n).called("leaves the dead zone upwards", "enters the dead zone"))
    }

    fn law(&self, l: &Recording) -> bool {
        let (start, end, n) = (l.constant(self.start), l.constant(self.end), l.width(0));
        for i in 0..n {
            let u = l.element(0, i);
            l.set(0, i, u - u.clamp(start, end));
            l.guard(i, u - start);
            l.guard(n + i, u - end);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const ZONE: DeadZone = DeadZone { start: -0.5, end: 1.0 };

    #[test]
    fn beyond_the_zone_the_distance_to_it_is_left() {
        let mut bench = Bench::with_inputs(ZONE, vec![("u".to_owned(), PortType::vector(5))]);
        assert_eq!(bench.set(0, &[-2.0, -0.5, 0.25, 1.0, 4.0]).major(), [-1.5, 0.0, 0.0, 0.0, 3.0]);
        assert_eq!(bench.guards(), [-1.5, 0.0, 0.75, 1.5, 4.5, -3.0, -1.5, -0.75, 0.0, 3.0]);
        assert!(bench.set(0, &[f64::NAN; 5]).major()[0].is_nan());
    }

    #[test]
    fn the_zone_is_in_the_unit_of_the_input() {
        let y = ZONE.interface(&given(&[("u", "rad")], &[("start", "deg"), ("end", "deg")])).unwrap().outputs
            [0]
        .port_type;
        assert_eq!(y.dimension, Some(dimension("rad")));
        assert_eq!(
            ZONE.interface(&given(&[("u", "rad")], &[("end", "V")])).unwrap_err().code,
            "unit_mismatch"
        );
    }

    #[test]
    fn a_zone_the_wrong_way_round_is_refused() {
        assert_eq!(DeadZone { start: 1.0, end: -1.0 }.errors()[0].param, "end");
        assert_eq!(DeadZone { start: f64::NEG_INFINITY, end: 0.0 }.errors()[0].param, "start");
    }
}
