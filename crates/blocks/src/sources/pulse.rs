use blocksim_block::prelude::*;

/// Rectangular pulses: `amplitude` during the first part (`width`) of each period, else 0.
///
/// $$ y = A \text{ where } 0 \le (t - t_0) \bmod T < w T, \text{ from } t_0 \text{ on} $$
///
/// The solver steps exactly onto each edge. The time of an edge is computed from its number, so the edges do not
/// drift, however many there are.
///
/// ```ron
/// Pulse(amplitude: "24 V", period: "1 s", width: "5 %", delay: "0.2 s")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sources", symbol = Curve(Pulse))]
pub struct Pulse {
    /// Height $A$; its unit is that of the output.
    #[block(difference, finite, default = 1.0)]
    pub amplitude: f64,
    /// Period $T$.
    #[block(unit = "s", positive)]
    pub period: f64,
    /// Share $w$ of the period during which the pulse is on, 0 to 1.
    #[block(unit = "1", at_least = 0.0, at_most = 1.0, remedy = "write 5 percent as 0.05 or \"5 %\"")]
    pub width: f64,
    /// Time $t_0$ of the first rise.
    #[block(unit = "s", finite, default = 0.0)]
    pub delay: f64,
}

/// Numbers of edges above this are no longer exact.
const MOST_EDGES: f64 = 9e15;

impl Pulse {
    /// Time of an edge, counted from 0: even ones rise, odd ones fall.
    fn edge(&self, number: f64) -> f64 {
        let (period, falls) = ((number / 2.0).floor(), number % 2.0 == 1.0);
        self.delay + (period + if falls { self.width } else { 0.0 }) * self.period
    }

    /// How many edges there have been up to and including `t`.
    fn edges_until(&self, t: f64) -> f64 {
        // The division may be off by a rounding, so it counts only as a start for the comparison with true edges.
        let mut number = (2.0 * (((t - self.delay) / self.period).floor() - 1.0)).max(0.0);
        while self.edge(number) <= t && number < MOST_EDGES {
            number += 1.0;
        }
        number
    }
}

impl Block for Pulse {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let dimension = given.parameters.get("amplitude");
        Ok(Interface::new()
            .output(Output::real("y").dimension(Some(dimension)))
            .discrete("edges", 0.0)
            .settles()
            .time_events())
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        d[0] = self.edges_until(c.t);
    }

    fn law(&self, l: &Recording) -> bool {
        let edges = l.d()[0];
        let high = (edges - (edges * 0.5).below() * 2.0).is_true();
        l.set(0, 0, high.select(l.constant(self.amplitude), l.constant(0.0)));
        true
    }

    fn next_event(&self, c: &Context) -> f64 {
        self.edge(self.edges_until(c.t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const PULSE: Pulse = Pulse { amplitude: 24.0, period: 0.1, width: 0.3, delay: 0.0 };

    #[test]
    fn a_million_edges_later_they_are_still_where_they_belong() {
        let mut bench = Bench::new(PULSE);
        for n in [0.0, 1.0, 3.0, 7.0, 1e6] {
            for (edge, y) in [(n * 0.1, 24.0), ((n + 0.3) * 0.1, 0.0)] {
                bench.t = edge;
                assert_eq!(bench.major(), [y], "{edge}");
                bench.t = edge.next_down();
                assert_eq!(bench.next_event(), edge);
            }
        }
    }

    #[test]
    fn from_edge_to_edge_every_event_is_met_once() {
        let mut bench = Bench::new(PULSE);
        let mut on = 0.0;
        for edge in 0..2000 {
            on += f64::from(bench.major()[0] == 24.0);
            let next = bench.next_event();
            assert!(next > bench.t, "edge {edge}");
            bench.t = next;
        }
        assert_eq!(on, 1000.0);
        assert!((bench.t - 100.0).abs() < 1e-12, "{}", bench.t);
    }

    #[test]
    fn before_the_delay_there_is_nothing() {
        let mut bench = Bench::new(Pulse { delay: 0.5, ..PULSE });
        assert_eq!((bench.major(), bench.next_event()), (vec![0.0], 0.5));
    }

    #[test]
    fn full_and_empty_pulses_are_constant_and_events_advance() {
        for (width, y) in [(0.0, 0.0), (1.0, 24.0)] {
            let mut bench = Bench::new(Pulse { width, ..PULSE });
            for _ in 0..100 {
                assert_eq!(bench.major(), [y]);
                let next = bench.next_event();
                assert!(next > bench.t);
                bench.t = next;
            }
        }
    }

    #[test]
    fn between_major_steps_the_value_is_held() {
        let mut bench = Bench::new(PULSE);
        bench.major();
        bench.t = 0.03;
        assert_eq!((bench.minor(), bench.major()), (vec![24.0], vec![0.0]));
    }

    #[test]
    fn width_is_a_share_and_the_unit_that_of_the_amplitude() {
        assert_eq!(Pulse { width: 5.0, ..PULSE }.errors()[0].param, "width");
        assert_eq!(Pulse { period: 0.0, ..PULSE }.errors()[0].param, "period");
        let y = PULSE.interface(&given(&[], &[("amplitude", "V")])).unwrap().outputs[0].port_type;
        assert_eq!(y.dimension, Some(dimension("V")));
    }
}
