//! What machines with a heat port have in common: the temperature of their winding.

use blocksim_block::physical::{HEAT, Handle};
use blocksim_block::prelude::*;

/// Heat of the rotor, apart from that of the winding.
const ROTOR: Handle = Handle::new("heat of the rotor");

/// All metals have boiled below this temperature, K: a winding that is hotter has run away.
const HOTTEST: f64 = 1e4;

/// Heat ports of a machine, and how its winding feels the heat.
#[derive(Debug, Clone, Copy, PartialEq, Parameters)]
pub struct WarmWinding {
    /// Has the thermal port `h`, by which the heat of all losses leaves; the winding has the temperature there.
    #[block(default = false)]
    pub heat_port: bool,
    /// Has the thermal port `h_r` for the heat of the rotor, which is all but that of the winding. With `heat_port` only.
    #[block(default = false)]
    pub rotor_heat_port: bool,
    /// Temperature coefficient of the resistance; 3.93e-3 1/K for copper. With `heat_port` only.
    #[block(unit = "1/K", finite, default = 0.0)]
    pub alpha: f64,
    /// Temperature at which the resistance is as given.
    #[block(unit = "K", positive, default = 293.15)]
    pub t_ref: f64,
    /// Temperature of the winding that is reported as an event when it is exceeded: 155 degC, thermal class F of IEC 60085, unless
    /// given.
    #[block(unit = "K", positive, default = 428.15)]
    pub t_max: f64,
}

impl WarmWinding {
    /// Without ports for heat.
    pub const NONE: WarmWinding =
        WarmWinding { heat_port: false, rotor_heat_port: false, alpha: 0.0, t_ref: 293.15, t_max: 428.15 };

    /// Refuses what no winding has.
    ///
    /// # Errors
    /// Names the parameter as all machines call it.
    fn validate(&self, errors: &mut ParamErrors) {
        for (name, is_given) in [("rotor_heat_port", self.rotor_heat_port), ("alpha", self.alpha != 0.0)] {
            if is_given && !self.heat_port {
                let error = ParamError::new(name, format!("`{name}` has no effect without a temperature"));
                errors
                    .add(error.help(format!("add `heat_port: true` and connect `h`, or leave `{name}` out")));
            }
        }
    }

    /// Adds the ports, behind all others.
    pub(crate) fn part(&self, part: Part) -> Part {
        if !self.heat_port {
            return part;
        }
        let limit = ("winding exceeds its temperature limit", "winding is below its temperature limit");
        let part = part.heat_port(true).guard("t_max", limit.0, limit.1);
        if self.rotor_heat_port {
            part.heat_port_named("h_r", ROTOR, "thermal port that the heat of the rotor leaves by")
        } else {
            part
        }
    }

    /// A resistance at the temperature of the winding; not a number where it would be negative, or where no metal is left: the run ends
    /// there.
    #[inline]
    pub(crate) fn resistance(&self, r: f64, c: &Flowing) -> f64 {
        if !self.heat_port || self.alpha == 0.0 {
            return r;
        }
        let t = c.voltage(HEAT);
        let warm = r * (1.0 + self.alpha * (t - self.t_ref));
        if warm >= 0.0 && t <= HOTTEST { warm } else { f64::NAN }
    }

    /// Divides the heat between the ports.
    pub(crate) fn heats(&self, winding: f64, dissipated: f64, q: &mut [f64]) {
        match q {
            [both] => *both = dissipated,
            [of_winding, rotor, ..] => (*of_winding, *rotor) = (winding, dissipated - winding),
            [] => {}
        }
    }

    /// The guard of the temperature limit, if there is one.
    pub(crate) fn guards(&self, c: &Flowing, g: &mut [f64]) {
        if self.heat_port {
            g[0] = c.voltage(HEAT) - self.t_max;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_needs_a_temperature_is_refused_without_one() {
        let refused = |warm: WarmWinding| warm.errors()[0].param.clone();
        assert_eq!(refused(WarmWinding { alpha: 4e-3, ..WarmWinding::NONE }), "alpha");
        assert_eq!(refused(WarmWinding { rotor_heat_port: true, ..WarmWinding::NONE }), "rotor_heat_port");
        assert_eq!(refused(WarmWinding { t_ref: 0.0, ..WarmWinding::NONE }), "t_ref");
        let both = WarmWinding { heat_port: true, rotor_heat_port: true, ..WarmWinding::NONE };
        assert_eq!(both.errors()[..], []);
    }
}
