//! Elastic contacts between two parts that turn or slide: spring and damper with play, ends of travel.

use blocksim_block::prelude::*;

use super::elastic::ElasticLaw;
use crate::multibody::axis::spring_energy;
use crate::multibody::joint_limit::{JointLimit, LOWER_END, UPPER_END};

/// Spring and damper side by side, with play between the flanks if there is any. Units are those of rotation; in
/// translation N/m, N*s/m and m.
#[derive(Debug, Clone, Copy)]
pub struct SpringDamper {
    /// Stiffness, N*m/rad.
    pub(crate) k: f64,
    /// Damping, N*m*s/rad.
    pub(crate) d: f64,
    /// Play from one contact to the other, rad.
    pub(crate) backlash: f64,
    /// Width over which a contact sets in, rad; with backlash only.
    pub(crate) transition: f64,
}

impl ElasticLaw for SpringDamper {
    fn load(&self, deflection: f64, speed: f64, touches: &[f64]) -> Torque {
        if self.backlash == 0.0 {
            return Torque { value: self.k * deflection + self.d * speed, slope: self.d };
        }
        self.sides(deflection, speed).load(touches)
    }

    fn energy(&self, deflection: f64, speed: f64, touches: &[f64]) -> Energy {
        if self.backlash == 0.0 {
            return spring_energy(self.k, self.d, deflection, speed);
        }
        self.sides(deflection, speed).energy(touches)
    }

    fn events(&self, part: Part) -> Part {
        if self.backlash == 0.0 {
            return part;
        }
        with_sides(part, &self.flank(), [("lower_flank", LOWER_FLANK), ("upper_flank", UPPER_FLANK)])
    }

    fn distances(&self, deflection: f64, speed: f64, g: &mut [f64]) {
        self.sides(deflection, speed).write_distances(g);
    }
}

impl SpringDamper {
    /// A spring alone.
    pub(crate) fn spring(k: f64) -> Self {
        Self { k, d: 0.0, backlash: 0.0, transition: 0.0 }
    }

    fn flank(&self) -> JointLimit {
        JointLimit { stiffness: self.k, damping: self.d, transition: self.transition }
    }

    fn sides(&self, deflection: f64, speed: f64) -> Sides {
        let depths = [-1.0, 1.0].map(|side| (side * deflection - 0.5 * self.backlash, side * speed));
        Sides { law: self.flank(), depths }
    }

    /// Reports a law of flanks where there are none.
    pub(crate) fn validate(&self, errors: &mut ParamErrors) {
        if self.backlash == 0.0 && self.transition > 0.0 {
            let message = "`transition` describes how flanks meet, but without `backlash` there are none";
            let error = ParamError::new("transition", message).beside(&["backlash"]);
            errors.add(error.help("give a `backlash`, or leave `transition` out"));
        }
    }
}

/// What it is called where a side touches, and where it no longer does.
type Words = [Change; 2];

const LOWER_FLANK: &Words =
    &[Change::to(1.0, "touches the lower flank"), Change::to(0.0, "leaves the lower flank")];
const UPPER_FLANK: &Words =
    &[Change::to(1.0, "touches the upper flank"), Change::to(0.0, "leaves the upper flank")];

/// Adds the events of two sides: modes if the torque jumps there, else kinks, and behind them the places where they have set in, if they
/// do so over a width.
fn with_sides(mut part: Part, law: &JointLimit, sides: [(&str, &'static Words); 2]) -> Part {
    for (name, words) in sides {
        let [touches, leaves] = words;
        part = match law.is_sudden() {
            true => part.mode(name, words),
            false => part.kink(name, leaves.phrase, touches.phrase),
        };
    }
    if law.transition == 0.0 {
        return part;
    }
    part.kink("lower_firm", "yields at the lower contact", "presses fully at the lower contact").kink(
        "upper_firm",
        "yields at the upper contact",
        "presses fully at the upper contact",
    )
}

/// Two sides of the same law, the lower and the upper one, with their depths and rates.
struct Sides {
    law: JointLimit,
    depths: [(f64, f64); 2],
}

impl Sides {
    /// Torque of the upper side less that of the lower one.
    fn load(&self, touches: &[f64]) -> Torque {
        let push = |side: usize| {
            let (depth, rate) = self.depths[side];
            self.law.load(touches.get(side).map(|touches| *touches != 0.0), depth, rate)
        };
        let [below, above] = [push(0), push(1)];
        Torque { value: above.value - below.value, slope: above.slope + below.slope }
    }

    fn energy(&self, touches: &[f64]) -> Energy {
        let energy = |side: usize| {
            let (depth, rate) = self.depths[side];
            self.law.energy(touches.get(side).map(|touches| *touches != 0.0), depth, rate)
        };
        energy(0) + energy(1)
    }

    /// How far they are from pressing, and behind that how far they are from having set in, if they do so over a width.
    fn write_distances(&self, g: &mut [f64]) {
        let apart = self.depths.map(|(depth, rate)| self.law.apart(depth, rate));
        let firm = self.depths.into_iter().filter_map(|(depth, _)| self.law.firm(depth));
        g.iter_mut().zip(apart.into_iter().chain(firm)).for_each(|(g, distance)| *g = distance);
    }
}

/// Free between two positions, a spring and a damper beyond them.
#[derive(Debug, Clone, Copy)]
pub struct Travel {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// Law of both ends.
    pub(crate) end: JointLimit,
}

impl ElasticLaw for Travel {
    fn load(&self, position: f64, speed: f64, touches: &[f64]) -> Torque {
        self.sides(position, speed).load(touches)
    }

    fn energy(&self, position: f64, speed: f64, touches: &[f64]) -> Energy {
        self.sides(position, speed).energy(touches)
    }

    fn events(&self, part: Part) -> Part {
        with_sides(part, &self.end, [("lower", LOWER_END), ("upper", UPPER_END)])
    }

    fn distances(&self, position: f64, speed: f64, g: &mut [f64]) {
        self.sides(position, speed).write_distances(g);
    }
}

impl Travel {
    fn sides(&self, position: f64, speed: f64) -> Sides {
        Sides { law: self.end, depths: [(self.lower - position, -speed), (position - self.upper, speed)] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotational::{RotationalHardStop, RotationalSpringDamper};

    const SHAFT: SpringDamper = SpringDamper { k: 100.0, d: 2.0, backlash: 0.0, transition: 0.0 };
    const LOOSE: SpringDamper = SpringDamper { backlash: 0.5, ..SHAFT };
    const STOP: Travel = Travel {
        lower: -0.5,
        upper: 1.0,
        end: JointLimit { stiffness: 1000.0, damping: 20.0, transition: 0.1 },
    };

    #[test]
    fn without_backlash_it_is_a_spring_and_a_damper_in_both_directions() {
        assert_eq!(SHAFT.load(0.25, -30.0, &[]), Torque { value: -35.0, slope: 2.0 });
        assert_eq!(SHAFT.load(-0.25, 1.0, &[]), Torque { value: -23.0, slope: 2.0 });
    }

    #[test]
    fn within_the_play_nothing_is_transmitted_and_flanks_never_pull() {
        for phi in [-0.25, -0.1, 0.0, 0.2, 0.25] {
            assert_eq!(LOOSE.load(phi, 40.0, &[]).value, 0.0);
            assert_eq!(LOOSE.load(phi, 40.0, &[]).slope, 0.0);
        }
        assert_eq!(LOOSE.load(0.5, 3.0, &[]), Torque { value: 31.0, slope: 2.0 });
        assert_eq!(LOOSE.load(-0.5, -3.0, &[]), Torque { value: -31.0, slope: 2.0 });
        assert_eq!(LOOSE.load(0.5, -13.0, &[]).value, 0.0, "the flanks part");
        assert_eq!(LOOSE.load(-0.5, 13.0, &[]).slope, 0.0, "the flanks part");
    }

    #[test]
    fn guards_are_negative_where_something_is_pressed_and_nowhere_else() {
        let damper = SpringDamper { k: 0.0, ..LOOSE };
        for i in -20..=20 {
            for w in [-20.0, -3.0, -0.1, 0.1, 3.0, 20.0] {
                let phi = 0.037 * f64::from(i);
                let mut g = [0.0; 2];
                for law in [LOOSE, damper, SpringDamper { transition: 0.1, ..LOOSE }] {
                    law.distances(phi, w, &mut g);
                    let load = law.load(phi, w, &[]).value;
                    assert_eq!([load < 0.0, load > 0.0], g.map(|g| g < 0.0), "{law:?}: {phi}, {w}");
                }
                STOP.distances(phi, w, &mut g);
                let load = STOP.load(phi, w, &[]).value;
                assert_eq!([load < 0.0, load > 0.0], g.map(|g| g < 0.0), "{phi}, {w}");
            }
        }
    }

    #[test]
    fn the_slope_is_the_derivative_over_the_speed() {
        let soft = SpringDamper { transition: 0.2, ..LOOSE };
        for (phi, w) in [(0.3, 1.0), (0.35, -2.0), (-0.4, -0.5), (0.9, 4.0)] {
            let h = 1e-5;
            let difference =
                (soft.load(phi, w + h, &[]).value - soft.load(phi, w - h, &[]).value) / (2.0 * h);
            assert!((soft.load(phi, w, &[]).slope - difference).abs() < 1e-8, "{phi}, {w}");
        }
    }

    fn shaft(law: SpringDamper) -> RotationalSpringDamper {
        let SpringDamper { k, d, backlash, transition } = law;
        RotationalSpringDamper { k, d, backlash, transition, phi0: 0.0 }
    }

    #[test]
    fn negative_parameters_and_a_transition_without_play_are_refused() {
        assert_eq!(shaft(SpringDamper { k: -1.0, ..SHAFT }).errors()[0].param, "k");
        assert_eq!(shaft(SpringDamper { backlash: -0.1, ..SHAFT }).errors()[0].param, "backlash");
        let error = shaft(SpringDamper { transition: 0.1, ..SHAFT }).errors()[0].clone();
        assert_eq!(error.param, "transition");
        assert!(error.help.is_some());
        assert_eq!(shaft(LOOSE).errors()[..], []);
    }

    #[test]
    fn the_penetration_gives_the_torque_of_the_smoothed_law_at_both_ends() {
        // Penetration, rad, and the smooth step over a width of 0.1 rad.
        for (depth, onset) in [(0.0, 0.0), (0.025, 0.15625), (0.05, 0.5), (0.075, 0.84375), (0.1, 1.0)] {
            let torque = onset * 1000.0 * depth;
            assert!((STOP.load(1.0 + depth, 0.0, &[]).value - torque).abs() < 1e-11, "{depth}");
            assert!((STOP.load(-0.5 - depth, 0.0, &[]).value + torque).abs() < 1e-11, "{depth}");
        }
    }

    #[test]
    fn between_the_ends_it_is_free_and_beyond_them_it_never_pulls() {
        assert_eq!(STOP.load(0.9, 100.0, &[]), Torque::default());
        assert_eq!(STOP.load(1.2, -11.0, &[]), Torque::default(), "moving out fast");
        assert_eq!(STOP.load(1.25, 1.0, &[]), Torque { value: 270.0, slope: 20.0 });
        assert_eq!(STOP.load(-0.75, -1.0, &[]), Torque { value: -270.0, slope: 20.0 });
    }

    #[test]
    fn a_travel_out_of_order_and_a_start_in_the_stop_are_refused() {
        let stop = |upper, phi0| {
            let JointLimit { stiffness, damping, transition } = STOP.end;
            RotationalHardStop { lower: STOP.lower, upper, stiffness, damping, transition, phi0 }.errors()
        };
        assert_eq!(stop(-1.0, 0.0)[0].param, "upper");
        let error = &stop(STOP.upper, 1.5)[0];
        assert_eq!(error.param, "phi0");
        assert_eq!(error.message, "`phi0` is 1.5 rad, but must be at most `upper`, which is 1 rad");
        assert!(error.help.is_some());
        assert_eq!(stop(STOP.upper, 0.0)[..], []);
    }
}
