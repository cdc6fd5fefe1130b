use blocksim_block::prelude::*;

use crate::continuous::units::{agrees, element};

/// Delays by a number of samples: $y_k = u_{k-n}$.
///
/// Before that many samples the output is `x0`. No direct feedthrough, so it breaks an algebraic loop. Takes
/// signals of every kind, vectors element by element.
///
/// ```ron
/// Delay(ts: "1 ms", steps: 5)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Text("z⁻ⁿ"))]
pub struct Delay {
    /// Sample time, positive.
    #[block(unit = "s")]
    pub ts: f64,
    /// Number of samples $n$, at least 1.
    #[block(default = 2)]
    pub steps: usize,
    /// Output during the first samples, in the unit of the input.
    #[block(default = 0.0)]
    pub x0: f64,
}

/// Discrete states before the cells: the cell that comes out next.
const NEXT: usize = 0;
const CELLS: usize = 1;

/// More cells than a simulation should carry along.
const MOST_STEPS: usize = 1_000_000;

impl Delay {
    /// The values that come out next.
    fn oldest(&self, d: &[f64], n: usize) -> std::ops::Range<usize> {
        let start = CELLS + d[NEXT] as usize * n;
        start..start + n
    }
}

impl Block for Delay {
    fn check(&self) -> Result<(), ParamError> {
        positive("ts", self.ts)?;
        if !(1..=MOST_STEPS).contains(&self.steps) {
            let message = format!("`steps` is {}, but must be from 1 to {MOST_STEPS}", self.steps);
            return Err(
                ParamError::new("steps", message).help("connect directly where nothing is to be delayed")
            );
        }
        finite("x0", self.x0)
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees(given, "x0", "u", u.dimension)?;
        let (steps, n) = (self.steps.min(MOST_STEPS), u.shape.len());
        InterfaceError::memory_fits(steps.checked_mul(n), &format!("{steps} samples of {n} elements"))?;
        Ok(Interface::new()
            .input(Input::any("u"))
            .output_from_state(Output::like("y", u))
            .discrete("next", 0.0)
            .memory("past", steps * n, self.x0)
            .turns(Ring { next: NEXT, first: CELLS, width: n })
            .sampled(self.ts))
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        y.copy_from_slice(&c.d[self.oldest(c.d, y.len())]);
    }

    fn update(&self, c: &Context, _w: &mut Scratch, d: &mut [f64]) {
        let cells = self.oldest(d, c.u.len());
        d[cells].iter_mut().enumerate().for_each(|(i, x)| *x = element(c.u, i));
        d[NEXT] = ((d[NEXT] as usize + 1) % self.steps) as f64;
    }

    fn rest(&self, c: &Context, d: &mut [f64]) -> bool {
        let n = d[CELLS..].len() / self.steps;
        d[CELLS..].iter_mut().enumerate().for_each(|(i, x)| *x = element(c.u, i % n));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuous::units::testing::{output_unit, vector};
    use blocksim_block::testing::Bench;

    #[test]
    fn each_sample_comes_out_n_later() {
        for steps in [1, 2, 7] {
            let mut bench = Bench::new(Delay { ts: 0.1, steps, x0: -1.0 });
            for k in 0..30_usize {
                let expected = if k < steps { -1.0 } else { (k - steps) as f64 };
                assert_eq!(bench.set(0, &[k as f64]).hit(), [expected]);
            }
        }
    }

    #[test]
    fn vectors_are_delayed_element_by_element() {
        let mut bench = Bench::with_inputs(Delay { ts: 0.1, steps: 2, x0: 0.0 }, vector("u", 2));
        bench.set(0, &[1.0, 2.0]).hit();
        bench.set(0, &[3.0, 4.0]).hit();
        assert_eq!(bench.hit(), [1.0, 2.0]);
        assert_eq!(bench.hit(), [3.0, 4.0]);
    }

    #[test]
    fn the_unit_stays_and_no_steps_are_refused() {
        let block = Delay { ts: 0.1, steps: 0, x0: 0.0 };
        assert_eq!(output_unit(&block, &[("u", "V")], &[]), "V");
        assert_eq!(block.check().unwrap_err().param, "steps");
    }
}
