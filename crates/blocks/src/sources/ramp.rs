use crate::math::elements::TIME;
use blocksim_block::prelude::*;

/// A ramp: $y = y_0 + k \max(t - t_0, 0)$ with slope $k$ from `start` $t_0$ on.
///
/// The solver steps exactly onto the kink.
///
/// ```ron
/// Ramp(slope: "2 V/s", start: "0.5 s")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sources", symbol = Curve(Ramp))]
pub struct Ramp {
    /// Slope $k$; its unit times s is that of the output.
    #[block(difference, finite)]
    pub slope: f64,
    /// Time $t_0$ of the kink.
    #[block(unit = "s", finite, default = 0.0)]
    pub start: f64,
    /// Value $y_0$ before.
    #[block(finite, default = 0.0)]
    pub initial: f64,
}

impl Ramp {
    fn dimension(&self, given: &Given) -> Result<Dimension, InterfaceError> {
        let initial = given.parameters.get("initial");
        let slope = given.parameters.get("slope");
        if slope.is_open() || slope == Dimension::NONE {
            return Ok(initial.meet(slope).unwrap_or(initial));
        }
        let ramp = slope.times(TIME);
        if ramp.compatible(initial) || (self.initial == 0.0 && initial == Dimension::NONE) {
            return Ok(ramp);
        }
        Err(InterfaceError::units(&["y"], format!("`initial` is in {initial}, but `slope` makes {ramp}"))
            .help(format!("write `initial` in {ramp} and `slope` in {slope}")))
    }
}

impl Block for Ramp {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let output = Output::real("y").dimension(Some(self.dimension(given)?));
        Ok(Interface::new().output(output).time_events())
    }

    fn law(&self, l: &Recording) -> bool {
        let since = (l.time() - self.start).max(l.constant(0.0));
        l.set(0, 0, self.initial + self.slope * since);
        true
    }

    fn next_event(&self, c: &Context) -> f64 {
        if c.t < self.start { self.start } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const RAMP: Ramp = Ramp { slope: 2.0, start: 0.5, initial: 1.0 };

    #[test]
    fn it_rises_from_the_kink_on() {
        let mut bench = Bench::new(RAMP);
        for (t, y, next) in [(0.0, 1.0, 0.5), (0.5, 1.0, f64::INFINITY), (2.0, 4.0, f64::INFINITY)] {
            bench.t = t;
            assert_eq!((bench.major(), bench.next_event()), (vec![y], next), "{t}");
        }
    }

    #[test]
    fn the_unit_is_that_of_the_slope_times_seconds() {
        let ramp = Ramp { initial: 0.0, ..RAMP };
        let unit = |ramp: &Ramp, written: &[(&str, &str)]| {
            ramp.interface(&given(&[], written)).map(|interface| interface.outputs[0].port_type.dimension)
        };
        assert_eq!(unit(&ramp, &[("slope", "V/s")]), Ok(Some(dimension("V"))));
        assert_eq!(unit(&RAMP, &[]), Ok(Some(Dimension::NONE)));
        assert_eq!(unit(&RAMP, &[("slope", "V/min"), ("initial", "kV")]), Ok(Some(dimension("V"))));
        assert_eq!(unit(&RAMP, &[("slope", "V/s")]).unwrap_err().code, "unit_mismatch");
    }

    #[test]
    fn values_must_be_finite() {
        assert_eq!(Ramp { slope: f64::NAN, ..RAMP }.errors()[0].param, "slope");
    }
}
