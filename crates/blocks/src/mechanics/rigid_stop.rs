//! Rigid ends of travel between two parts that turn or slide.

use blocksim_block::physical::{Element, Grip, Stop};
use blocksim_block::prelude::*;

use super::quantities::Quantities;

/// Free between two positions; an end is never passed. Units are those of rotation, in translation m and m/s.
#[derive(Debug, Clone, Copy)]
pub struct RigidStop {
    pub(crate) lower: Option<f64>,
    pub(crate) upper: Option<f64>,
    /// Part of the speed that is left after a bounce.
    pub(crate) restitution: f64,
    pub(crate) quantities: &'static Quantities,
    /// Position at the start.
    pub(crate) start: f64,
}

/// Between its ends the direction is no event.
const AT_REST: &[Change] = &[Change::to(0.0, "rests at its end"), Change::from(0.0, "leaves its end")];

/// How far from its end, as a part of its position, what rests there may be, and the least position that this is taken of, SI.
const AT_END: f64 = 1e-6;
const LEAST: f64 = 1e-3;

/// A bounce that rises by less than this part of the position is lost in rounding: the next steps do not leave the end.
const ROUNDED: f64 = 1e3 * f64::EPSILON;

/// Reports a travel without an end.
pub(crate) fn without_end() -> ParamError {
    ParamError::new("lower", "the travel has no end").help("give `lower`, `upper` or both")
}

impl Component for RigidStop {
    fn part(&self, _given: &Given) -> Part {
        let mut part = self.quantities.held(Element::Friction { r: 0, c: 1 }, self.start);
        for (name, _) in self.ends(self.start) {
            part = match name {
                "lower" => part.guard(name, "leaves the lower end", "touches the lower end"),
                _ => part.guard(name, "leaves the upper end", "touches the upper end"),
            };
        }
        part.friction_called(AT_REST)
    }

    fn grips(&self, c: &Flowing, grips: &mut [Grip]) {
        grips[0] = self.grip(self.place(c));
    }

    fn guards(&self, c: &Flowing, g: &mut [f64]) {
        self.ends(self.place(c)).zip(g).for_each(|((_, distance), g)| *g = distance);
    }

    fn fit(&self, _c: &Flowing, x: &mut [f64]) -> Option<String> {
        let [lower, upper] =
            [self.lower, self.upper].map(|end| end.map(|end| (end, AT_END * end.abs().max(LEAST))));
        let below = lower.filter(|(end, close)| x[0] < end - close);
        let (end, _) = below.or(upper.filter(|(end, close)| x[0] > end + close))?;
        let beyond = (x[0] - end).abs();
        x[0] = end;
        Some(format!("is {beyond:.3e} rad or m beyond its end"))
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.speed[0];
    }
}

impl RigidStop {
    /// The position; that of the end while it rests there. An implicit method leaves a rest of its iterations in a position that
    /// does not change, and an end that is missed by that would be left and touched again and again.
    fn place(&self, c: &Flowing) -> f64 {
        let position = c.x[0];
        let rests = |end: &f64| c.mode == [0.0] && (position - end).abs() <= AT_END * end.abs().max(LEAST);
        [self.lower, self.upper].into_iter().flatten().find(rests).unwrap_or(position)
    }

    /// Nothing is held within the travel, everything at its ends.
    fn grip(&self, position: f64) -> Grip {
        let upper = self.upper.filter(|upper| position >= *upper);
        let lower = self.lower.filter(|lower| position <= *lower);
        let hold = [upper, lower].map(|beyond| if beyond.is_some() { f64::INFINITY } else { 0.0 });
        let depth = upper.or(lower).map_or(0.0, |end| (position - end).abs().max(ROUNDED * end.abs()));
        Grip { hold, stop: Some(Stop { restitution: self.restitution, depth }), ..Grip::default() }
    }

    /// Distances from the ends.
    fn ends(&self, position: f64) -> impl Iterator<Item = (&'static str, f64)> {
        let lower = self.lower.map(|lower| ("lower", position - lower));
        lower.into_iter().chain(self.upper.map(|upper| ("upper", upper - position)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::translational::TranslationalRigidStop;

    const FLOOR: RigidStop = RigidStop {
        lower: Some(0.0),
        upper: None,
        restitution: 0.5,
        quantities: &crate::mechanics::quantities::TRANSLATION,
        start: 1.0,
    };

    #[test]
    fn it_holds_at_its_end_and_pushes_one_way() {
        assert_eq!(FLOOR.grip(0.1).hold, [0.0, 0.0]);
        assert_eq!(FLOOR.grip(0.0).hold, [0.0, f64::INFINITY]);
        assert_eq!(FLOOR.grip(-0.25).stop, Some(Stop { restitution: 0.5, depth: 0.25 }));
        let both = RigidStop { upper: Some(2.0), ..FLOOR };
        assert_eq!(both.grip(2.0).hold, [f64::INFINITY, 0.0]);
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        let check = |stop: RigidStop, x0| {
            let RigidStop { lower, upper, restitution, .. } = stop;
            let errors = TranslationalRigidStop { lower, upper, restitution, x0 }.errors();
            errors.first().map(|error| error.param.clone())
        };
        assert_eq!(check(FLOOR, 1.0), None);
        assert_eq!(check(FLOOR, -1.0).as_deref(), Some("x0"));
        assert_eq!(check(RigidStop { lower: None, ..FLOOR }, 1.0).as_deref(), Some("lower"));
        assert_eq!(check(RigidStop { upper: Some(-1.0), ..FLOOR }, 0.0).as_deref(), Some("upper"));
        assert_eq!(check(RigidStop { restitution: 1.5, ..FLOOR }, 0.0).as_deref(), Some("restitution"));
    }
}
