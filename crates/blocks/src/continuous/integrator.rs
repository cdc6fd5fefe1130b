use blocksim_block::prelude::*;

use super::reset::{Reset, UNSEEN};
use super::units::{SECOND, agrees, agrees_as_written, element};
use crate::math::Entries;

/// Integrator, element by element.
///
/// $$ \dot x = u, \qquad y = x, \qquad x(0) = x_0 $$
///
/// The unit of the output is that of the input times s. No direct feedthrough, so it breaks an algebraic loop.
///
/// With limits the output stays on a limit as long as the input pushes outwards, and leaves it when the input
/// changes sign: nothing winds up, and nothing beyond a limit is ever given out. With `wrap` it jumps by the span when it leaves
/// $[\mathrm{lower}, \mathrm{upper})$, as an angle does. With `reset` the extra input `reset` sets it back to
/// `x0`; with `external: true` the value at a reset comes from the extra input `x0`, and so does the value at the
/// start unless the parameter `x0` gives it. Reaching a limit, leaving it, wrapping and resetting are events.
///
/// A ball that bounces: the velocity is set to -0.8 times itself where the height falls through zero.
///
/// ```ron
/// Integrator(x0: "5 m/s", reset: Falling, external: true)
/// ```
/// ```ron
/// Integrator(x0: "10 deg", wrap: (lower: "-180 deg", upper: "180 deg"))
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Continuous", symbol = Fraction("1","s"))]
pub struct Integrator {
    /// Output at the start, and after a reset unless `external`; 0 if it is not given. A list gives each element its own.
    #[block(finite, at_least = lower, at_most = upper, default = None)]
    pub x0: Option<Entries>,
    /// Lower limit of the output.
    #[block(below = f64::INFINITY, default = None)]
    pub lower: Option<f64>,
    /// Upper limit of the output.
    #[block(above = f64::NEG_INFINITY, above = lower, default = None)]
    pub upper: Option<f64>,
    /// What the extra input `reset` must do to set the output back: `None` (there is no such input), `Rising`,
    /// `Falling`, `Either`, `Level`.
    #[block(default = Reset::None)]
    pub reset: Reset,
    /// Whether the value at a reset, and at the start unless `x0` is given, comes from an extra input `x0`.
    #[block(default = false)]
    pub external: bool,
    /// Range around which the output wraps; not together with limits.
    #[block(default = None)]
    pub wrap: Option<Wrap>,
}

/// The range of an output that wraps around, from `lower` to just below `upper`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wrap {
    /// Lower end, included.
    pub lower: f64,
    /// Upper end, excluded.
    pub upper: f64,
}

/// Discrete states before the modes: memory of the trigger, and whether the first value was taken.
const FLAGS: usize = 2;
const TRIGGER: usize = 0;
const STARTED: usize = 1;

/// Modes of an element.
const FREE: f64 = 0.0;
const AT_UPPER: f64 = 1.0;
const AT_LOWER: f64 = -1.0;

/// What the crossings of the guards of the upper and of the lower limit are called, upwards and downwards.
const LIMITS: [[&str; 2]; 2] = [
    ["reaches the upper limit", "leaves the upper limit"],
    ["leaves the lower limit", "reaches the lower limit"],
];

impl Integrator {
    /// Whether anything but plain integration happens.
    fn jumps(&self) -> bool {
        let limited = self.lower.is_some() || self.upper.is_some();
        limited || self.wrap.is_some() || self.reset != Reset::None || self.external
    }

    /// Outputs at the start as far as the parameters tell; one stands for all.
    fn x0(&self) -> &[f64] {
        self.x0.as_ref().map_or(&[0.0], |x0| &x0.values)
    }

    fn x0_input(&self) -> usize {
        1 + usize::from(self.reset != Reset::None)
    }

    /// The state where it may be, and the mode it is then in, for this input.
    fn confine(&self, x: f64, u: f64) -> (f64, f64) {
        if let Some(Wrap { lower, upper }) = self.wrap {
            return (wrapped(x, lower, upper), FREE);
        }
        match (self.lower, self.upper) {
            (_, Some(upper)) if x >= upper => (upper, if u >= 0.0 { AT_UPPER } else { FREE }),
            (Some(lower), _) if x <= lower => (lower, if u <= 0.0 { AT_LOWER } else { FREE }),
            _ => (x, FREE),
        }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if let Some(Wrap { lower, upper }) = self.wrap {
            errors.take(finite("wrap.lower", lower));
            errors.take(finite("wrap.upper", upper));
            if errors.is_right("wrap") {
                errors.take(ordered("wrap.lower", lower, "wrap.upper", upper));
            }
            if self.lower.is_some() || self.upper.is_some() {
                errors.add(
                    ParamError::new("wrap", "an output that wraps around cannot have limits")
                        .help("leave out `wrap`, or `lower` and `upper`"),
                );
            }
        }
        let (lower, upper) = (self.lower.unwrap_or(f64::NEG_INFINITY), self.upper.unwrap_or(f64::INFINITY));
        if self.x0.is_none() && !self.external && !(lower..=upper).contains(&0.0) {
            let error = ParamError::new("x0", "`x0` is 0 if it is not given, outside the limits");
            errors.add(error.beside(&["lower", "upper"]).help(format!("choose it from {lower} to {upper}")));
        }
    }
}

/// `x` plus as many spans as bring it into the range.
fn wrapped(x: f64, lower: f64, upper: f64) -> f64 {
    if x >= lower && x < upper || !x.is_finite() {
        return x;
    }
    let inside = lower + (x - lower).rem_euclid(upper - lower);
    // Just below `lower`, rounding may give `upper`, which is outside and would wrap back at once.
    if inside < upper { inside } else { upper.next_down() }
}

impl Block for Integrator {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let own = u.dimension.map(|dimension| dimension.times(SECOND));
        let external = given.input("x0").filter(|_| self.external).and_then(|x0| x0.dimension);
        let written = match &self.x0 {
            Some(x0) => x0.written(given, "x0"),
            None => given.parameters.find("x0"),
        };
        let written = written.filter(|dimension| *dimension != Dimension::NONE);
        // What is said counts before what a bare number leaves open.
        let all = [own, external, written];
        let dimension = all.into_iter().flatten().find(|dimension| !dimension.is_open()).or(own).or(external);
        agrees_as_written(written, "x0", "u", dimension)?;
        for parameter in ["lower", "upper", "wrap"] {
            agrees(given, parameter, "u", dimension)?;
        }
        let starts = self.x0.as_ref().map_or(Shape::Scalar, |x0| x0.shape);
        let shape = given.common_shape(if self.external { &["u", "x0"] } else { &["u"] }, &[starts])?;
        let mut interface = Interface::new().input(Input::real("u"));
        if let Some(reset) = self.reset.input() {
            interface = interface.input(reset);
        }
        if self.external {
            let doc = "Value at a reset, and at the start unless the parameter `x0` gives it.";
            interface = interface.input(Input::real("x0").dimension(own).doc(doc));
        }
        let y = PortType::UNKNOWN.shaped(shape).of(dimension);
        interface = interface.output(Output::like("y", y));
        for i in 0..shape.len() {
            interface = interface.state_in("x", element(self.x0(), i), dimension);
        }
        if !self.jumps() {
            return Ok(interface);
        }
        interface = interface.jumps().discrete("trigger", UNSEEN).discrete("started", 0.0);
        let n = shape.len();
        let [[reaches_upper, leaves_upper], [leaves_lower, reaches_lower]] = match self.wrap {
            Some(_) => [["wraps round downwards"; 2], ["wraps round upwards"; 2]],
            None => LIMITS,
        };
        for i in 0..n {
            let detail = || (n > 1).then(|| format!("element {i}"));
            interface = interface.discrete("mode", FREE);
            if self.upper.is_some() || self.wrap.is_some() {
                interface = interface.guard("upper").detail(detail()).called(reaches_upper, leaves_upper);
            }
            if self.lower.is_some() || self.wrap.is_some() {
                interface = interface.guard("lower").detail(detail()).called(leaves_lower, reaches_lower);
            }
        }
        let interface = interface.jump_called(
            match (self.reset, self.lower.is_none() && self.upper.is_none() && self.wrap.is_none()) {
                (Reset::None, _) => "",
                (Reset::Level, true) => "is held or released",
                (_, true) => "is reset",
                (_, false) => "is reset or limited",
            },
        );
        Ok(self.reset.guard(interface, given))
    }

    fn law(&self, l: &Recording) -> bool {
        let n = l.width(0);
        // Up to the event at a limit the state goes on, by a rounding or, within a step that is only tried, by more; what a root or a
        // logarithm behind it is given does not.
        l.each(0, |i| {
            let x = l.x()[i];
            let [lower, upper] = [self.lower, self.upper].map(|limit| limit.map(|limit| l.constant(limit)));
            let x = upper.map_or(x, |upper| x.live(Relation::Greater, upper).select(upper, x));
            lower.map_or(x, |lower| x.live(Relation::Less, lower).select(lower, x))
        });
        if !self.jumps() {
            (0..n).for_each(|i| l.derive(i, l.element(0, i)));
            return true;
        }
        let (zero, held) = (l.constant(0.0), self.reset.held(l, l.d()[TRIGGER]));
        let upper = self.upper.or(self.wrap.map(|wrap| wrap.upper));
        let lower = self.lower.or(self.wrap.map(|wrap| wrap.lower));
        let mut guards = 0..;
        let mut guard = |value| guards.next().into_iter().for_each(|i| l.guard(i, value));
        for i in 0..n {
            let (u, x, mode) = (l.element(0, i), l.x()[i], l.d()[FLAGS + i]);
            let [at_upper, at_lower] =
                [AT_UPPER, AT_LOWER].map(|side| mode.live(Relation::Equal, l.constant(side)));
            // On a limit only an input that leads inwards counts.
            let free = match (self.upper, self.lower) {
                (None, None) => u,
                _ => at_upper.select(u.min(zero), at_lower.select(u.max(zero), u)),
            };
            l.derive(i, held.map_or(free, |held| held.select(zero, free)));
            // Free: distance to the limit. On a limit: the input, whose change of sign frees the state. Both
            // have the same sign where one follows the other.
            upper.into_iter().for_each(|upper| guard(at_upper.select(u, x - upper)));
            lower.into_iter().for_each(|lower| guard(at_lower.select(u, x - lower)));
        }
        // That of the reset, unless it is true or false.
        let of_limits = n * (usize::from(upper.is_some()) + usize::from(lower.is_some()));
        if l.guards() > of_limits {
            guard(l.u(1));
        }
        true
    }

    fn jump(&self, c: &Context, _w: &mut Scratch, x: &mut [f64], d: &mut [f64]) -> bool {
        if d.len() < FLAGS {
            return false;
        }
        let (flags, modes) = d.split_at_mut(FLAGS);
        let held = self.reset.holds(flags[TRIGGER]);
        let fires = self.reset != Reset::None && self.reset.fires(&mut flags[TRIGGER], c.scalar(1));
        let starts = self.external && self.x0.is_none() && flags[STARTED] == 0.0;
        flags[STARTED] = 1.0;
        let initial = if self.external { c.input(self.x0_input()) } else { self.x0() };
        // Whether the state is held shows in its derivative.
        let mut changed = held != self.reset.holds(flags[TRIGGER]);
        for (i, (x, mode)) in x.iter_mut().zip(modes).enumerate() {
            let before = (*x, *mode);
            let free = if fires || starts { element(initial, i) } else { *x };
            (*x, *mode) = self.confine(free, element(c.input(0), i));
            // NaN is not equal to itself, and must not be set again and again.
            changed |= (*x, *mode) != before && !(x.is_nan() && before.0.is_nan());
        }
        changed
    }
}

#[cfg(test)]
#[path = "integrator_tests.rs"]
mod tests;
