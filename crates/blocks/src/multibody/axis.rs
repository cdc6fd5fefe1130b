//! What the axes of all joints have in common: direction, start values, spring, damper and end of travel.

use blocksim_block::physical::Torque;
use blocksim_block::prelude::*;

use super::joint_limit::JointLimit;

/// A direction as a vector of length one.
pub(crate) fn unit(axis: [f64; 3]) -> [f64; 3] {
    let length = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
    axis.map(|a| a / length)
}

/// Spring, damper and end of travel of an axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Inside {
    pub equilibrium: f64,
    pub stiffness: f64,
    pub damping: f64,
    pub lower: Option<f64>,
    pub upper: Option<f64>,
    pub limit: JointLimit,
}

impl Inside {
    /// Torque at a position and a speed; the slope is positive where it damps.
    pub(crate) fn torque(&self, q: f64, w: f64) -> Torque {
        let mut torque = Torque {
            value: -self.stiffness * (q - self.equilibrium) - self.damping * w,
            slope: self.damping,
        };
        if let Some(upper) = self.upper {
            let push = self.limit.push(q - upper, w);
            torque = Torque { value: torque.value - push.value, slope: torque.slope + push.slope };
        }
        if let Some(lower) = self.lower {
            let push = self.limit.push(lower - q, -w);
            torque = Torque { value: torque.value + push.value, slope: torque.slope + push.slope };
        }
        torque
    }

    /// Adds what happens where an end of travel is reached, has set in, and is left; `number` tells several axes apart.
    pub(crate) fn events(&self, mut part: Part, number: &str) -> Part {
        for (name, _) in self.ends(0.0, 0.0) {
            let [leaves, touches] = match name {
                "lower" => ["leaves the lower end", "touches the lower end"],
                "upper" => ["leaves the upper end", "touches the upper end"],
                "lower_firm" => ["yields at the lower end", "presses fully at the lower end"],
                _ => ["yields at the upper end", "presses fully at the upper end"],
            };
            part = part.kink(&format!("{name}{number}"), leaves, touches);
            if !number.is_empty() {
                part = part.detail(format!("axis {number}"));
            }
        }
        part
    }

    /// Writes how far the ends of travel are from pressing, at a position and a speed; returns how many there are.
    pub(crate) fn guards(&self, q: f64, w: f64, g: &mut [f64]) -> usize {
        self.ends(q, w).zip(g).map(|((_, distance), g)| *g = distance).count()
    }

    /// Names of the ends of travel, and how far they are from pressing and from doing so in full.
    fn ends(&self, q: f64, w: f64) -> impl Iterator<Item = (&'static str, f64)> {
        let lower = self.lower.map(|lower| ("lower", self.limit.apart(lower - q, -w)));
        let lower_firm = self.lower.and_then(|lower| Some(("lower_firm", self.limit.firm(lower - q)?)));
        let upper = self.upper.map(|upper| ("upper", self.limit.apart(q - upper, w)));
        let upper_firm = self.upper.and_then(|upper| Some(("upper_firm", self.limit.firm(q - upper)?)));
        [lower, lower_firm, upper, upper_firm].into_iter().flatten()
    }

    /// What spring, damper and both ends of travel store and turn into heat.
    pub(crate) fn energy(&self, q: f64, w: f64) -> Energy {
        let above = self.upper.map(|upper| self.limit.energy(None, q - upper, w));
        let below = self.lower.map(|lower| self.limit.energy(None, lower - q, -w));
        let inside = spring_energy(self.stiffness, self.damping, q - self.equilibrium, w);
        inside + above.unwrap_or_default() + below.unwrap_or_default()
    }

    /// Reports a start that is given and not within the limits. Where none is given, a closed loop may lead elsewhere than to zero, and
    /// the network tells.
    pub(crate) fn validate(&self, position: Option<f64>, unit: &str, errors: &mut ParamErrors) {
        let Some(position) = position else { return };
        let below = self.lower.filter(|lower| position < *lower).map(|lower| ("lower", lower, "below"));
        let above = self.upper.filter(|upper| position > *upper).map(|upper| ("upper", upper, "above"));
        if let Some((name, limit, side)) = below.or(above) {
            let message =
                format!("the joint starts at {position} {unit}, {side} its {name} limit of {limit} {unit}");
            let error = ParamError::new("position", message).beside(&[name]);
            errors.add(error.help(format!("start within the limits, or change `{name}`")));
        }
    }
}

/// A vector output.
pub(crate) fn vector_output(name: &str, length: usize, unit: &str, doc: &'static str) -> Output {
    Output::real(name).shape(Shape::Vector(length)).unit(unit).doc(doc)
}

/// A vector input that is zero where nothing is connected.
pub(crate) fn vector_input(name: &str, length: usize, unit: &str, doc: &'static str) -> Input {
    Input::real(name).shape(Shape::Vector(length)).unit(unit).default(0.0).doc(doc)
}

/// What [`spring`] stores and turns into heat.
pub(crate) fn spring_energy(stiffness: f64, damping: f64, q: f64, w: f64) -> Energy {
    Energy { stored: 0.5 * stiffness * q * q, dissipated: damping * w * w, ..Energy::default() }
}

/// A spring about zero and a damper.
pub(crate) fn spring(stiffness: f64, damping: f64, q: f64, w: f64) -> Torque {
    Torque { value: -stiffness * q - damping * w, slope: damping }
}
