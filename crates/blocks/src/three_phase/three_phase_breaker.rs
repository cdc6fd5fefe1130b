use blocksim_block::physical::{Domain, Element, Pin, ValveKind};
use blocksim_block::prelude::*;

use crate::power_electronics::valve::Valve;

/// Three contacts that a signal opens and closes together.
///
/// A breaker draws an arc that lasts until the current of its phase passes through zero: so do its contacts,
/// phase after phase, with `opens: AtZeroCurrent`. With `AtOnce` all open at the same instant, and inductances in the
/// line must find another path for their currents.
///
/// ```ron
/// ThreePhaseBreaker(r_on: "1 mOhm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Three-phase", symbol = Contact)]
pub struct ThreePhaseBreaker {
    /// Resistance of a closed contact.
    #[block(unit = "Ohm", not_negative, default = 0.01)]
    pub r_on: f64,
    /// Conductance of an open contact; zero cuts the phase.
    #[block(unit = "S", not_negative, default = 0.0)]
    pub g_off: f64,
    /// `AtZeroCurrent` or `AtOnce`.
    #[block(default = Opening::AtZeroCurrent)]
    pub opens: Opening,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

/// When contacts open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Opening {
    /// Each when its current passes through zero.
    AtZeroCurrent,
    /// All at once.
    AtOnce,
}

impl ThreePhaseBreaker {
    fn valve(&self) -> Valve {
        Valve { r_on: self.r_on, v_f: 0.0, g_off: self.g_off, heat_port: self.heat_port }
    }

    /// A contact. Its arc is that of two thyristors, one for each direction.
    fn contact(&self, k: usize) -> Vec<Element> {
        let (p, n) = (Pin::Phase(0, k), Pin::Phase(1, k));
        let half = Valve { g_off: 0.5 * self.g_off, ..self.valve() };
        match self.opens {
            Opening::AtOnce => vec![self.valve().element(p, n, ValveKind::Switch)],
            Opening::AtZeroCurrent => {
                vec![half.element(p, n, ValveKind::Thyristor), half.element(n, p, ValveKind::Thyristor)]
            }
        }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.valve().validate(errors);
    }
}

impl Component for ThreePhaseBreaker {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new()
            .port("ac1", Domain::ThreePhase, "one side")
            .port("ac2", Domain::ThreePhase, "the other")
            .input(Input::boolean("closed").scalar().doc("whether the contacts are closed"));
        (0..3).flat_map(|k| self.contact(k)).fold(part, Part::element).heat_port(self.heat_port)
    }

    fn gates(&self, c: &Known, on: &mut [bool]) {
        on.fill(c.scalar(0) != 0.0);
    }
}
