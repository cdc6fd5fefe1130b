use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Three-phase converter between a DC link and three phases without its switching: each leg is the mean of a period.
///
/// $$ v_{xn} = d_x v_{pn}, \qquad i_{dc} = \sum_x d_x i_x, \qquad x = a, b, c $$
///
/// $d_x$, 0 to 1 and limited to that, is the share of the period during which a leg is high, as `DutyCycles` and
/// `PwmGenerator` give it; $v_{xn}$ lies between the phase and `n`, and $i_x$ flows out of the phase. Power balances at each
/// instant, in both directions: what a braking machine feeds back charges the capacitor of the link. The voltage of
/// the link is the limit of that of the phases. It is the mean of a `SixPulseInverter` without forward voltages and
/// dead times, and runs as fast as a circuit without switches does; `AveragedInverter` does without the link.
///
/// `r_on` is the resistance of the one switch of each leg that conducts at a time. The DC side needs something that determines its
/// voltage: a source, or the capacitor of a link.
///
/// ```ron
/// AverageValueConverter(r_on: "20 mOhm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Converter("=","="))]
pub struct AverageValueConverter {
    /// Resistance of a conducting switch.
    #[block(unit = "Ohm", not_negative, default = 0.0)]
    pub r_on: f64,
}

const LEGS: usize = 3;

impl Component for AverageValueConverter {
    fn part(&self, _given: &Given) -> Part {
        let mut part = Part::new()
            .pins()
            .port("ac", Domain::ThreePhase, "phases a, b, c")
            .input(
                Input::real("duty")
                    .shape(Shape::Vector(LEGS))
                    .unit("1")
                    .doc("share of the time that a leg is high"),
            )
            .measures("i_dc", "A", Needs::Electrics, "current from p to n")
            .measures("power", "W", Needs::Electrics, "power from the DC side to the phases");
        // Three transformers, first of all: currents and voltages are counted by them.
        let leg = |k| if self.r_on == 0.0 { Pin::Phase(2, k) } else { Pin::Inner(k) };
        for k in 0..LEGS {
            part = part.element(Element::VariableTransformer {
                primary: (leg(k), Pin::Port(1)),
                secondary: (Pin::Port(0), Pin::Port(1)),
            });
        }
        if self.r_on == 0.0 {
            return part;
        }
        (0..LEGS).fold(part, |part, k| {
            part.element(Element::Resistance { p: leg(k), n: Pin::Phase(2, k), resistance: self.r_on })
        })
    }

    fn ratios(&self, c: &Known, ratio: &mut [f64]) {
        ratio.iter_mut().zip(c.input(0)).for_each(|(ratio, duty)| *ratio = duty.clamp(0.0, 1.0));
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        let i_dc = (0..LEGS).map(|k| c.current[2 * k + 1]).sum::<f64>();
        y.copy_from_slice(&[i_dc, i_dc * c.voltage[1]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn duties_are_shares_and_what_is_no_number_does_not_hide() {
        let mut ratio = [0.5; 3];
        let u = [0.3, 1.7, f64::NAN];
        AverageValueConverter { r_on: 0.0 }
            .ratios(&Seen { u: &u, inputs: &[(0, 3)], ..law() }.loaded(), &mut ratio);
        assert_eq!(ratio[..2], [0.3, 1.0]);
        assert!(ratio[2].is_nan());
        assert_eq!(AverageValueConverter { r_on: -1.0 }.errors()[0].param, "r_on");
    }
}
