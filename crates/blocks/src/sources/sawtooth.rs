use crate::math::elements::common_unit;
use blocksim_block::prelude::*;

/// A sawtooth: rises on a straight line from `lower` to `upper` during the first part (`width`) of each period, and falls back
/// during the rest.
///
/// With `width: 1` it jumps back at the end of the period, with 0.5 it is a triangle, with 0 it jumps up and falls. It is `lower`
/// until `start`. The solver steps exactly onto each kink and jump; their times are computed from their numbers and do not drift.
///
/// ```ron
/// Sawtooth(lower: "-1 V", upper: "1 V", period: "20 ms")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sources", symbol = Curve(Ramp))]
pub struct Sawtooth {
    /// Least value.
    #[block(finite, default = 0.0)]
    pub lower: f64,
    /// Greatest value; its unit is that of the output.
    #[block(finite, above = lower, default = 1.0)]
    pub upper: f64,
    /// Period $T$.
    #[block(unit = "s", positive)]
    pub period: f64,
    /// Share of the period during which it rises, 0 to 1.
    #[block(
        unit = "1",
        at_least = 0.0,
        at_most = 1.0,
        default = 1.0,
        remedy = "a triangle rises for 0.5 of its period"
    )]
    pub width: f64,
    /// When the first period begins.
    #[block(unit = "s", finite, default = 0.0)]
    pub start: f64,
}

/// Numbers of kinks above this are no longer exact.
const MOST_KINKS: f64 = 9e15;

impl Sawtooth {
    /// Time of a kink, counted from 0: a rise begins at even ones, a fall at odd ones.
    fn kink(&self, number: f64) -> f64 {
        let (period, falls) = ((number / 2.0).floor(), number % 2.0 == 1.0);
        self.start + (period + if falls { self.width } else { 0.0 }) * self.period
    }

    /// How many kinks there have been up to and including `t`.
    fn kinks_until(&self, t: f64) -> f64 {
        // The division may be off by a rounding, so it counts only as a start for the comparison with true kinks.
        let mut number = (2.0 * (((t - self.start) / self.period).floor() - 1.0)).max(0.0);
        while self.kink(number) <= t && number < MOST_KINKS {
            number += 1.0;
        }
        number
    }
}

impl Block for Sawtooth {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let dimension = common_unit(given, &[("lower", self.lower), ("upper", self.upper)])?;
        Ok(Interface::new()
            .output(Output::real("y").dimension(Some(dimension)))
            .discrete("kinks", 0.0)
            .settles()
            .time_events())
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        d[0] = self.kinks_until(c.t);
    }

    /// The line of the present part, which begins and ends at kinks.
    fn law(&self, l: &Recording) -> bool {
        let (kinks, span) = (l.d()[0], self.upper - self.lower);
        let last = kinks - 1.0;
        let periods = (last * 0.5).below();
        let falls = (last - periods * 2.0).is_true();
        let since = l.time() - (self.start + periods * self.period);
        let zero = l.constant(0.0);
        let rising = match self.width {
            0.0 => zero,
            width => span / (width * self.period) * since,
        };
        let falling = match 1.0 - self.width {
            0.0 => zero,
            rest => span / (rest * self.period) * (self.period - since),
        };
        let begun = kinks.is_true();
        l.set(0, 0, self.lower + begun.select(falls.select(falling, rising), zero));
        true
    }

    fn next_event(&self, c: &Context) -> f64 {
        self.kink(self.kinks_until(c.t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    fn sawtooth(width: f64) -> Sawtooth {
        Sawtooth { lower: -1.0, upper: 3.0, period: 0.5, width, start: 0.25 }
    }

    #[test]
    fn it_rises_and_falls_on_straight_lines() {
        for width in [0.0, 0.3, 0.5, 1.0] {
            let mut bench = Bench::new(sawtooth(width));
            for k in 0..=4000 {
                let t = f64::from(k) / 1024.0;
                bench.t = t;
                let phase = (t - 0.25).rem_euclid(0.5) / 0.5;
                let expected = match phase {
                    _ if t < 0.25 => -1.0,
                    phase if phase < width => -1.0 + 4.0 * phase / width,
                    phase => 3.0 - 4.0 * (phase - width) / (1.0 - width),
                };
                let y = bench.major()[0];
                assert!((y - expected).abs() < 1e-11, "{width} at {t}: {y} instead of {expected}");
            }
        }
    }

    #[test]
    fn every_kink_is_an_event_however_late() {
        let mut bench = Bench::new(Sawtooth { period: 0.1, start: 0.0, ..sawtooth(0.25) });
        bench.t = 12_345.0;
        let next = bench.next_event();
        assert!(next > 12_345.0 && next <= 12_345.0 + 0.1, "{next}");
        bench.t = next;
        assert!(bench.next_event() > next);
    }

    #[test]
    fn what_is_no_sawtooth_is_refused() {
        for (block, param) in [
            (Sawtooth { width: 1.5, ..sawtooth(1.0) }, "width"),
            (Sawtooth { period: 0.0, ..sawtooth(1.0) }, "period"),
            (Sawtooth { upper: -1.0, ..sawtooth(1.0) }, "upper"),
            (Sawtooth { start: f64::NAN, ..sawtooth(1.0) }, "start"),
        ] {
            assert_eq!(block.errors()[0].param, param);
        }
    }
}
