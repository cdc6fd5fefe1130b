use blocksim_block::physical::{Domain, Element, Pin, ValveKind};
use blocksim_block::prelude::*;

use super::valve::Valve;

/// Contacts that exchange the phases b and c while `reverse` is true: a machine behind them turns the other way.
///
/// Phase a passes. Four contacts lead b and c straight or crossed, of which two are always closed, so that currents of
/// inductances find a path; they change at once. `DirectionReverser` makes `reverse` from a signed command.
///
/// ```ron
/// ReversingContactor(r_on: "1 mOhm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Contact)]
pub struct ReversingContactor {
    /// Resistance of a closed contact.
    #[block(unit = "Ohm", not_negative, default = 0.01)]
    pub r_on: f64,
    /// Conductance of an open contact.
    #[block(unit = "S", not_negative, default = 0.0)]
    pub g_off: f64,
}

impl ReversingContactor {
    fn valve(&self) -> Valve {
        Valve { r_on: self.r_on, v_f: 0.0, g_off: self.g_off, heat_port: false }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.valve().validate(errors);
    }
}

impl Component for ReversingContactor {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new()
            .port("ac1", Domain::ThreePhase, "side of the supply")
            .port("ac2", Domain::ThreePhase, "side of the machine")
            .input(Input::boolean("reverse").scalar().doc("whether b and c are exchanged"))
            .element(Element::Junction { p: Pin::Phase(0, 0), n: Pin::Phase(1, 0) });
        let contact =
            |(from, to)| self.valve().element(Pin::Phase(0, from), Pin::Phase(1, to), ValveKind::Switch);
        [(1, 1), (2, 2), (1, 2), (2, 1)].map(contact).into_iter().fold(part, Part::element)
    }

    fn gates(&self, c: &Known, on: &mut [bool]) {
        let reverse = c.scalar(0) != 0.0;
        on.copy_from_slice(&[!reverse, !reverse, reverse, reverse]);
    }
}
