use blocksim_block::prelude::*;

use crate::continuous::reset::{Reset, UNSEEN};
use crate::continuous::units::{agrees, element};

/// Delays by a number of samples: $y_k = u_{k-n}$.
///
/// Before that many samples the output is `x0`. No direct feedthrough, so it breaks an algebraic loop. Takes
/// signals of every kind, vectors element by element. With `reset` an edge of the extra input `reset` makes the output `x0` from this
/// sample on, until what comes in from then on comes out; this input does reach the output at once.
///
/// ```ron
/// Delay(ts: "1 ms", steps: 5)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Text("z⁻ⁿ"))]
pub struct Delay {
    /// Sample time, positive.
    #[block(unit = "s", positive)]
    pub ts: f64,
    /// Number of samples $n$, at least 1.
    #[block(
        at_least = 1, at_most = MOST_STEPS, default = 2,
        zero = "connect directly where nothing is to be delayed",
    )]
    pub steps: usize,
    /// Output during the first samples, in the unit of the input.
    #[block(finite, default = 0.0)]
    pub x0: f64,
    /// What the extra input `reset` must do from one sample to the next, by its values there, to set the memory back:
    /// `None` (there is no such input), `Rising`, `Falling`, `Either`; with `Level` it is set back at each sample at which
    /// the input is true or positive.
    #[block(default = Reset::None)]
    pub reset: Reset,
}

/// The cell that comes out next, where that moves; behind it the trigger. Where all cells move, the trigger is the first.
const NEXT: usize = 0;
const TRIGGER: usize = 1;
/// The input `reset`.
const RESET: usize = 1;

/// More cells than a simulation should carry along.
const MOST_STEPS: usize = 1_000_000;
/// Up to so many cells all of them move at each sample, and a law says so. Of more, which one comes out next moves.
const FEW: usize = 64;

impl Delay {
    /// Whether all cells move.
    fn shifts(&self, n: usize) -> bool {
        self.steps.saturating_mul(n) <= FEW
    }

    /// Number of discrete states before the cells: the trigger, and the cell that comes out next where that moves.
    fn cells(&self, n: usize) -> usize {
        usize::from(self.reset != Reset::None) + usize::from(!self.shifts(n))
    }

    /// The values that come out next.
    fn oldest(&self, d: &[f64], n: usize) -> std::ops::Range<usize> {
        let start = self.cells(n) + d[NEXT] as usize * n;
        start..start + n
    }
}

impl Block for Delay {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees(given, "x0", "u", u.dimension)?;
        let (steps, n) = (self.steps.min(MOST_STEPS), u.shape.len());
        InterfaceError::memory_fits(steps.checked_mul(n), &format!("{steps} samples of {n} elements"))?;
        let y = Output::like("y", u);
        let interface = Interface::new().input(Input::any("u"));
        let interface = match self.reset.input() {
            Some(reset) => interface.input(reset).output_reading(&[RESET], y),
            None => interface.output_from_state(y),
        };
        let trigger = usize::from(self.reset != Reset::None);
        let ring = Ring { next: NEXT, first: self.cells(n), width: n };
        let interface = if self.shifts(n) { interface } else { interface.discrete("next", 0.0).turns(ring) };
        let interface = interface.memory("trigger", trigger, UNSEEN).memory("past", steps * n, self.x0);
        Ok(interface.sampled(self.ts))
    }

    fn law(&self, l: &Recording) -> bool {
        let n = l.width(0);
        if !self.shifts(n) {
            return false;
        }
        let fires = self.reset.sampled(l, 0, RESET);
        let cells = &l.d()[self.cells(n)..];
        let x0 = |x| fires.map_or(x, |(fires, _)| fires.select(l.constant(self.x0), x));
        for (at, cell) in cells.iter().enumerate() {
            if at < n {
                l.set(0, at, x0(*cell));
            }
            let next = cells.get(at + n).map_or_else(|| l.element(0, at % n), |newer| x0(*newer));
            l.update(self.cells(n) + at, next);
        }
        fires.into_iter().for_each(|(_, next)| l.update(0, next));
        true
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        if self.reset != Reset::None && self.reset.sampled_now(c.d[TRIGGER], c.scalar(RESET)).0 {
            return y.fill(self.x0);
        }
        y.copy_from_slice(&c.d[self.oldest(c.d, y.len())]);
    }

    fn update(&self, c: &Context, _w: &mut Scratch, d: &mut [f64]) {
        let n = c.output(0).len();
        if self.reset != Reset::None {
            let (fires, memory) = self.reset.sampled_now(d[TRIGGER], c.scalar(RESET));
            d[TRIGGER] = memory;
            if fires {
                d[self.cells(n)..].fill(self.x0);
            }
        }
        let cells = self.oldest(d, n);
        d[cells].iter_mut().enumerate().for_each(|(i, x)| *x = element(c.input(0), i));
        d[NEXT] = ((d[NEXT] as usize + 1) % self.steps) as f64;
    }

    fn rest(&self, c: &Context, d: &mut [f64]) -> bool {
        let n = c.output(0).len();
        let cells = d[self.cells(n)..].iter_mut().enumerate();
        cells.for_each(|(i, x)| *x = element(c.input(0), i % n));
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
        for steps in [1, 2, 7, 64, 65, 80] {
            let mut bench = Bench::new(Delay { ts: 0.1, steps, x0: -1.0, reset: Reset::None });
            for k in 0..200_usize {
                let expected = if k < steps { -1.0 } else { (k - steps) as f64 };
                assert_eq!(bench.set(0, &[k as f64]).hit(), [expected]);
            }
        }
    }

    #[test]
    fn vectors_are_delayed_element_by_element() {
        let mut bench =
            Bench::with_inputs(Delay { ts: 0.1, steps: 2, x0: 0.0, reset: Reset::None }, vector("u", 2));
        bench.set(0, &[1.0, 2.0]).hit();
        bench.set(0, &[3.0, 4.0]).hit();
        assert_eq!(bench.hit(), [1.0, 2.0]);
        assert_eq!(bench.hit(), [3.0, 4.0]);
    }

    #[test]
    fn the_unit_stays_and_no_steps_are_refused() {
        let block = Delay { ts: 0.1, steps: 0, x0: 0.0, reset: Reset::None };
        assert_eq!(output_unit(&block, &[("u", "V")], &[]), "V");
        assert_eq!(block.errors()[0].param, "steps");
    }

    #[test]
    fn a_reset_forgets_what_came_in_before_whether_all_cells_move_or_not() {
        for (steps, reset) in
            [(3, Reset::Rising), (3, Reset::Level), (70, Reset::Rising), (70, Reset::Either)]
        {
            let inputs =
                vec![("u".to_owned(), PortType::scalar()), ("reset".to_owned(), PortType::boolean())];
            let mut bench = Bench::with_inputs(Delay { ts: 0.1, steps, x0: -1.0, reset }, inputs);
            let (mut begin, mut was) = (0, false);
            for k in 0..300 {
                let is_on = k % 90 >= 85;
                let fires = match reset {
                    Reset::Level => is_on,
                    Reset::Either => is_on != was,
                    _ => is_on && !was,
                };
                was = is_on;
                begin = if fires { k } else { begin };
                let expected = if k < begin + steps { -1.0 } else { (k - steps) as f64 };
                let y = bench.set(0, &[k as f64]).set(1, &[f64::from(is_on)]).hit();
                assert_eq!(y, [expected], "sample {k} of {steps}, {reset:?}");
            }
            assert!(!bench.interface.reads(0, 0) && bench.interface.reads(0, 1));
        }
    }
}
