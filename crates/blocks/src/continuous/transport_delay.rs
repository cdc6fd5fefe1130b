use blocksim_block::prelude::*;

use super::ring::{self, CELLS, CELLS_PER_SPACING, Ring};
use super::units::agrees;

/// Delays a signal by a fixed time (dead time).
///
/// $$ y(t) = \begin{cases} y_0 & t < t_0 + T \\ u(t - T) & t \ge t_0 + T \end{cases} \qquad G(s) = e^{-T s} $$
///
/// where $t_0$ is the start. The input is remembered at the accepted steps, not closer than a thousandth of the delay,
/// and interpolated linearly. A jump of the input comes out as a jump, which is hit exactly. Steps are no longer than
/// the delay. No direct feedthrough, so it breaks an algebraic loop. Vectors are delayed element by element.
///
/// ```ron
/// TransportDelay(delay: "20 ms")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Continuous", symbol = Text("e⁻ˢᵀ"))]
pub struct TransportDelay {
    /// Delay $T$, positive.
    #[block(unit = "s")]
    pub delay: f64,
    /// Output until the first input comes out, in the unit of the input.
    #[block(default = 0.0)]
    pub y0: f64,
}

/// Share of the delay that two remembered instants are apart at least. The ring then covers a little more than the
/// delay.
const SPACING: f64 = 1.0 / 1000.0;
const _: () = assert!((CELLS / CELLS_PER_SPACING - 2) as f64 * SPACING > 1.0);

/// Discrete states: up to when jumps have come out; then the ring.
const KNOWN: usize = 0;
const RING: usize = 1;

/// Before any time.
const NEVER: f64 = f64::MIN;

impl TransportDelay {
    fn note(&self, c: &Context, d: &mut [f64]) {
        let n = c.input(0).len();
        ring::note(&mut d[RING..], c.t, c.input(0), n, self.delay * SPACING);
    }
}

impl Block for TransportDelay {
    fn check(&self) -> Result<(), ParamError> {
        positive("delay", self.delay)?;
        finite("y0", self.y0)
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees(given, "y0", "u", u.dimension)?;
        Ok(Interface::new()
            .input(Input::real("u"))
            .output_from_state(Output::like("y", u))
            .discrete("known", NEVER)
            .memory("past", ring::size(u.shape.len()), 0.0)
            .uses_time()
            .settles()
            .jumps()
            .accepts()
            .time_events()
            .max_step(self.delay))
    }

    /// Lets jumps out whose time has come; within a step none comes out.
    fn settle(&self, c: &Context, d: &mut [f64]) {
        let (known, past) = d.split_at_mut(RING);
        let ring = Ring::new(past, c.input(0).len());
        loop {
            let jump = ring.next_jump(known[KNOWN], self.delay);
            if jump > c.t {
                return;
            }
            known[KNOWN] = jump;
        }
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        if !Ring::new(&c.d[RING..], y.len()).read(c.t, self.delay, c.d[KNOWN], y) {
            y.fill(self.y0);
        }
    }

    /// Nothing jumps here; but this is where the input is known after the jumps of others.
    fn jump(&self, c: &Context, _w: &mut Scratch, _x: &mut [f64], d: &mut [f64]) -> bool {
        self.note(c, d);
        false
    }

    fn next_event(&self, c: &Context) -> f64 {
        Ring::new(&c.d[RING..], c.input(0).len()).next_jump(c.t, self.delay)
    }

    /// Here the input is known before the jumps of others.
    fn accept(&self, c: &Context, d: &mut [f64]) {
        self.note(c, d);
    }
}

#[cfg(test)]
mod tests {
    use super::super::units::testing::{output_unit, vector};
    use super::*;
    use blocksim_block::testing::Bench;

    /// Runs over steps of length `h` with input `u(t)` and returns time and output after each.
    fn run(delay: f64, h: f64, steps: usize, u: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let mut bench = Bench::new(TransportDelay { delay, y0: -7.0 });
        (0..=steps)
            .map(|step| {
                bench.t = step as f64 * h;
                bench.set(0, &[u(bench.t)]);
                if step > 0 {
                    bench.accept();
                }
                (bench.t, bench.major()[0])
            })
            .collect()
    }

    #[test]
    fn a_ramp_comes_out_later_and_exact() {
        for (delay, h) in [(1.0, 0.3), (1.0, 1.0), (0.5, 1e-3), (0.05, 1e-5)] {
            let steps = (3.0 * delay / h) as usize;
            for (t, y) in run(delay, h, steps, |t| 2.0 + 3.0 * t) {
                let expected = if t < delay { -7.0 } else { 2.0 + 3.0 * (t - delay) };
                assert!((y - expected).abs() < 1e-9, "delay {delay}, h {h}, t {t}: {y} != {expected}");
            }
        }
    }

    #[test]
    fn a_sine_is_as_good_as_straight_lines_between_the_instants() {
        let (delay, h) = (0.2, 1e-3);
        for (t, y) in run(delay, h, 1000, |t| (10.0 * t).sin()).into_iter().filter(|(t, _)| *t >= delay) {
            // Linear interpolation: h^2 / 8 times the largest second derivative, 100.
            assert!((y - (10.0 * (t - delay)).sin()).abs() < 1.3e-5, "t {t}");
        }
    }

    #[test]
    fn trial_steps_leave_no_trace() {
        let mut bench = Bench::new(TransportDelay { delay: 1.0, y0: 0.0 });
        bench.respond(1.0);
        let d = bench.d.clone();
        bench.t = 0.7;
        bench.set(0, &[99.0]).minor();
        assert_eq!(bench.d, d);
        bench.t = 0.5;
        bench.set(0, &[2.0]).accept();
        bench.major();
        bench.t = 1.25;
        assert_eq!(bench.major(), [1.5]);
    }

    #[test]
    fn a_jump_comes_out_as_a_jump_at_a_time_event() {
        let mut bench = Bench::new(TransportDelay { delay: 0.1, y0: -1.0 });
        bench.t = 0.2;
        bench.respond(3.0);
        assert_eq!(bench.next_event(), 0.2 + 0.1);
        // At 0.25 the input jumps from 4 to 8: the step ends with 4, the instant with 8.
        bench.t = 0.25;
        bench.set(0, &[4.0]).accept();
        bench.respond(8.0);
        // A step up to the event sees the value before, the instant itself the value after.
        for (event, before, after) in [(0.2 + 0.1, -1.0, 3.0), (0.25 + 0.1, 4.0, 8.0)] {
            assert_eq!(bench.next_event(), event);
            bench.t = event;
            assert_eq!(bench.minor(), [before]);
            bench.accept();
            assert_eq!(bench.major(), [after]);
        }
        assert_eq!(bench.next_event(), f64::INFINITY);
        assert_eq!(bench.interface.max_step, Some(0.1));
    }

    #[test]
    fn vectors_are_delayed_element_by_element() {
        let mut bench = Bench::with_inputs(TransportDelay { delay: 0.5, y0: 0.0 }, vector("u", 2));
        assert_eq!(bench.set(0, &[1.0, 2.0]).major(), [0.0, 0.0]);
        bench.t = 0.5;
        assert_eq!(bench.set(0, &[3.0, 4.0]).major(), [1.0, 2.0]);
    }

    #[test]
    fn the_unit_is_that_of_the_input_and_no_delay_is_refused() {
        let block = TransportDelay { delay: 0.0, y0: 0.0 };
        assert_eq!(output_unit(&block, &[("u", "V")], &[("y0", "mV")]), "V");
        assert_eq!(block.check().unwrap_err().param, "delay");
    }
}
