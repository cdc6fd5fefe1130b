use blocksim_block::prelude::*;

/// Angle of the point $(u_2, u_1)$: $y = \operatorname{atan2}(u_1, u_2)$, from $-\pi$ to $\pi$, element by element.
///
/// Both inputs have the same unit. The angle of the origin is 0. Where $u_1$ changes sign with $u_2 < 0$ the angle
/// jumps by $2\pi$; the solver stops there.
///
/// ```ron
/// Atan2
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Text("atan2"))]
pub struct Atan2;

impl Block for Atan2 {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        given.common_dimension(&["u1", "u2"])?;
        let shape = given.common_shape(&["u1", "u2"], &[])?;
        let interface = Interface::new()
            .input(Input::real("u1").doc("Ordinate, opposite to the angle."))
            .input(Input::real("u2").doc("Abscissa, adjacent to the angle."))
            .output(Output::real("y").shape(shape).unit("rad"));
        Ok(interface.guard_each("cut", shape.len()).called("turns positive", "turns negative"))
    }

    fn law(&self, l: &Recording) -> bool {
        for i in 0..l.width(0) {
            let ordinate = l.element(0, i);
            l.set(0, i, ordinate.angle(l.element(1, i)));
            l.guard(i, ordinate);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::elements::{dimension, given};
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn the_angle_of_a_point_on_the_unit_circle_is_found_in_every_quadrant() {
        let mut bench = Bench::new(Atan2);
        for degrees in [-179.0_f64, -120.0, -30.0, 0.0, 45.0, 90.0, 150.0, 180.0] {
            let angle = degrees.to_radians();
            let y = bench.set(0, &[angle.sin()]).set(1, &[angle.cos()]).major()[0];
            assert!((y - angle).abs() < 1e-15, "{degrees}: {y}");
        }
        assert_eq!(bench.set(0, &[0.0]).set(1, &[0.0]).major(), [0.0]);
        assert!(bench.set(0, &[f64::NAN]).major()[0].is_nan());
    }

    #[test]
    fn both_inputs_have_one_unit_and_the_output_is_an_angle() {
        let y = Atan2.interface(&given(&[("u1", "V"), ("u2", "V")], &[])).unwrap().outputs[0].port_type;
        assert_eq!(y.dimension, Some(dimension("rad")));
        assert!(Atan2.interface(&given(&[("u1", "V"), ("u2", "A")], &[])).is_err());
    }
}
