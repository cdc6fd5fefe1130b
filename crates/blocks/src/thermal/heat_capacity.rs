use blocksim_block::physical::{Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// The body.
const BODY: Handle = Handle::new("body");

/// Heat capacity of a body of one temperature: $C \frac{dT}{dt} = q$. Its temperature is a state.
///
/// A body with a temperature that differs from place to place is a chain of capacities and resistances. Capacities at one node
/// have one temperature. One that has fallen below absolute zero is named at the end of the run.
///
/// ```ron
/// HeatCapacity(c: "120 J/K", t0: "20 degC")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Thermal", symbol = Capacitor)]
pub struct HeatCapacity {
    /// Heat capacity, positive: mass times specific heat capacity.
    #[block(unit = "J/K", positive, zero = "without heat capacity it stores nothing: leave it out")]
    pub c: f64,
    /// Temperature at the start. Where none is given it follows from given temperatures at the same node, else it is 20 degC.
    #[block(unit = "K", not_negative, default = None)]
    pub t0: Option<f64>,
}

impl Component for HeatCapacity {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("h", Domain::Thermal, "thermal port")
            .state_in("t", self.t0.unwrap_or(ROOM), "K")
            .floor(ABSOLUTE_ZERO)
            .named(
                BODY,
                Element::Capacitance {
                    p: Pin::Port(0),
                    n: Pin::Ground,
                    capacitance: self.c,
                    state: 0,
                    start: self.t0,
                },
            )
            .voltage_is(Gives::State(0))
            .reads("t", "K", Reading::State(0), "temperature")
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.current(BODY) / self.c;
    }
}

/// Nothing is colder.
const ABSOLUTE_ZERO: Floor = Floor {
    value: 0.0,
    name: "absolute zero",
    unit: "K",
    help: "more heat is taken out than there is: look at the sign of the heat flows, or cool by a resistance to something cold",
};

/// 20 degC in K.
const ROOM: f64 = 293.15;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_temperature_at_the_start_is_that_of_a_room_unless_given() {
        let start = |t0| HeatCapacity { c: 1.0, t0 }.part(&Given::nothing()).states[0].initial;
        assert_eq!((start(None), start(Some(350.0))), (293.15, 350.0));
    }

    #[test]
    fn capacities_that_are_none_are_refused() {
        assert!(HeatCapacity { c: 0.0, t0: None }.errors()[0].help.is_some());
        assert_eq!(HeatCapacity { c: 1.0, t0: Some(-3.0) }.errors()[0].param, "t0");
    }
}
