//! What the axes of all joints have in common: direction, start values, spring, damper and end of travel.

use blocksim_block::physical::Torque;
use blocksim_block::prelude::*;

use super::joint_limit::{JointLimit, LOWER_END, UPPER_END, guard_of_side, settle};

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

/// What the ends of travel are called: the end, what happens there, and where it no longer presses fully and where it does.
const LOWER: (&str, &[Change; 2], [&str; 2]) =
    ("lower", LOWER_END, ["yields at the lower end", "presses fully at the lower end"]);
const UPPER: (&str, &[Change; 2], [&str; 2]) =
    ("upper", UPPER_END, ["yields at the upper end", "presses fully at the upper end"]);

/// An end of travel.
struct End {
    /// Where it is: -1 below, 1 above.
    side: f64,
    /// How far the joint is beyond it, and how fast that grows.
    depth: f64,
    rate: f64,
}

impl Inside {
    /// Torque at a position and a speed; the slope is positive where it damps. Which ends touch is known where the torque jumps there:
    /// `touches` are those that there are, from below, and empty elsewhere.
    pub(crate) fn torque(&self, q: f64, w: f64, touches: &[f64]) -> Torque {
        let mut torque = Torque {
            value: -self.stiffness * (q - self.equilibrium) - self.damping * w,
            slope: self.damping,
        };
        for (end, place) in self.ends(q, w).zip(0..) {
            let push =
                self.limit.load(touches.get(place).map(|touches| *touches != 0.0), end.depth, end.rate);
            torque = Torque { value: torque.value - end.side * push.value, slope: torque.slope + push.slope };
        }
        torque
    }

    /// How many modes [`events`](Self::events) adds.
    pub(crate) fn modes(&self) -> usize {
        if self.limit.is_sudden() { self.ends(0.0, 0.0).count() } else { 0 }
    }

    /// Adds what happens where an end of travel is reached, has set in, and is left; `number` tells several axes apart.
    pub(crate) fn events(&self, part: Part, number: &str) -> Part {
        let about = |part: Part| if number.is_empty() { part } else { part.detail(format!("axis {number}")) };
        self.ends(0.0, 0.0).fold(part, |mut part, end| {
            let (end, words, [yields, presses]) = if end.side < 0.0 { LOWER } else { UPPER };
            let (name, [touches, leaves]) = (format!("{end}{number}"), words);
            if self.limit.is_sudden() {
                return about(part.mode(&name, words));
            }
            part = about(part.kink(&name, leaves.phrase, touches.phrase));
            if self.limit.transition > 0.0 {
                let name = format!("{end}_firm{number}");
                part = about(part.kink(&name, yields, presses));
            }
            part
        })
    }

    /// Writes how far the ends of travel are from pressing, at a position and a speed; returns how many there are.
    pub(crate) fn guards(&self, q: f64, w: f64, touches: &[f64], g: &mut [f64]) -> usize {
        let mut count = 0;
        for (place, end) in self.ends(q, w).enumerate() {
            g[count] = guard_of_side(touches.get(place), self.limit.apart(end.depth, end.rate));
            count += 1;
            if let Some(firm) = self.limit.firm(end.depth) {
                g[count] = firm;
                count += 1;
            }
        }
        count
    }

    /// Finds which ends touch; returns whether any has changed.
    pub(crate) fn settle(&self, q: f64, w: f64, touches: &mut [f64]) -> bool {
        let sides = self.ends(q, w).zip(touches);
        sides.fold(false, |changed, (end, touches)| {
            settle(touches, self.limit.apart(end.depth, end.rate)) || changed
        })
    }

    /// The ends of travel that there are.
    fn ends(&self, q: f64, w: f64) -> impl Iterator<Item = End> {
        let lower = self.lower.map(|lower| End { side: -1.0, depth: lower - q, rate: -w });
        let upper = self.upper.map(|upper| End { side: 1.0, depth: q - upper, rate: w });
        [lower, upper].into_iter().flatten()
    }

    /// What spring, damper and both ends of travel store and turn into heat.
    pub(crate) fn energy(&self, q: f64, w: f64, touches: &[f64]) -> Energy {
        let inside = spring_energy(self.stiffness, self.damping, q - self.equilibrium, w);
        self.ends(q, w).zip(0..).fold(inside, |sum, (end, place)| {
            sum + self.limit.energy(touches.get(place).map(|touches| *touches != 0.0), end.depth, end.rate)
        })
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
