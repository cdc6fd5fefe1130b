//! What blocks with valves have in common: switches, diodes and transistors as elements of a circuit.

use blocksim_block::physical::{Element, Pin, ValveKind};
use blocksim_block::prelude::*;

/// Properties of a valve.
#[derive(Debug, Clone, Copy, PartialEq, Parameters)]
pub struct Valve {
    /// Forward voltage of a diode, a thyristor or an `Igbt`; a conducting `Mosfet` or `Contact` has none.
    #[block(unit = "V", not_negative, default = 0.6)]
    pub v_f: f64,
    /// Resistance while it conducts.
    #[block(unit = "Ohm", not_negative, default = 0.01)]
    pub r_on: f64,
    /// Conductance while it blocks, that of a diode in parallel included.
    #[block(unit = "S", not_negative, default = 0.0)]
    pub g_off: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl Valve {
    /// Refuses what no valve has. Errors name the parameters as all blocks call them.
    pub(crate) fn validate(&self, errors: &mut ParamErrors) {
        if self.r_on * self.g_off >= 1.0 {
            let message = format!(
                "`g_off` ({} S) lets as much through as `r_on` ({} ohm): on and off are the same",
                self.g_off, self.r_on
            );
            let error = ParamError::new("g_off", message).beside(&["r_on"]);
            errors.add(error.help("a conductance is one over a resistance: 1e-6 S is 1 Mohm"));
        }
    }

    /// An element that conducts from `p` to `n`.
    pub(crate) fn element(&self, p: Pin, n: Pin, kind: ValveKind) -> Element {
        let Self { r_on, v_f, g_off, .. } = *self;
        Element::Valve { p, n, kind, on_resistance: r_on, forward_voltage: v_f, off_conductance: g_off }
    }
}

/// What the switches of a bridge are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Device {
    /// A transistor that conducts in one direction, and a diode in parallel for the other; both have `v_f` and `r_on`.
    #[default]
    Igbt,
    /// A transistor that conducts in both directions with `r_on`, and its body diode with `v_f` and `r_on`.
    Mosfet,
    /// A contact that conducts in both directions with `r_on`; no diode, so currents of inductances need a closed one.
    Contact,
}

impl Device {
    /// Valves of a device.
    pub(crate) fn valves(self) -> usize {
        if self == Device::Contact { 1 } else { 2 }
    }

    /// Elements of a device that connects `p` to `n` when its gate is on.
    pub(crate) fn elements(self, valve: &Valve, p: Pin, n: Pin) -> Vec<Element> {
        let contact = Valve { v_f: 0.0, ..*valve };
        // The diode beside a transistor leaks, too: half of `g_off` is that of each.
        let half = |valve: &Valve| Valve { g_off: 0.5 * valve.g_off, ..*valve };
        match self {
            Device::Igbt => vec![
                half(valve).element(p, n, ValveKind::GatedDiode),
                half(valve).element(n, p, ValveKind::Diode),
            ],
            Device::Mosfet => vec![
                half(&contact).element(p, n, ValveKind::Switch),
                half(valve).element(n, p, ValveKind::Diode),
            ],
            Device::Contact => vec![contact.element(p, n, ValveKind::Switch)],
        }
    }

    /// Gates of the valves of a row of devices for the gates of the devices: a diode has none.
    pub(crate) fn gates(self, u: &[f64], on: &mut [bool]) {
        for (valves, gate) in on.chunks_exact_mut(self.valves()).zip(u) {
            valves[0] = *gate != 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_valve_is_better_on_than_off() {
        let good = Valve { r_on: 0.01, v_f: 0.6, g_off: 1e-6, heat_port: false };
        assert_eq!(good.errors()[..], []);
        assert_eq!(Valve { r_on: 0.0, v_f: 0.0, g_off: 0.0, ..good }.errors()[..], []);
        assert_eq!(Valve { g_off: 100.0, ..good }.errors()[0].param, "g_off");
        assert_eq!(Valve { r_on: -1.0, ..good }.errors()[0].param, "r_on");
        assert_eq!(Valve { v_f: f64::NAN, ..good }.errors()[0].param, "v_f");
    }
}
