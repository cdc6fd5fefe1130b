//! What nodes do, from their pages in the manual.

use super::model::{Edge, Gains, Gate, Law, Relation, Smooth, Way, Windup};

/// Output of a node that has neither states nor branches that are held, from its inputs.
pub fn plain(law: &Law, t: f64, u: &[f64]) -> Option<f64> {
    Some(match law {
        Law::Constant(value) => *value,
        Law::Sine { amplitude, frequency, phase, bias } => {
            bias + amplitude * (std::f64::consts::TAU * frequency * t + phase).sin()
        }
        Law::Ramp { slope, start, initial } => initial + slope * (t - start).max(0.0),
        Law::Clock => t,
        Law::Gain(k) => k * u[0],
        Law::Sum(signs) => signs.iter().zip(u).map(|(sign, u)| sign * u).sum(),
        Law::Product => u[0] * u[1],
        Law::Abs => u[0].abs(),
        Law::MinMax(true) => u[0].max(u[1]),
        Law::MinMax(false) => u[0].min(u[1]),
        Law::Function(Smooth::Sin) => u[0].sin(),
        Law::Function(Smooth::Atan) => u[0].atan(),
        Law::Function(Smooth::Tanh) => u[0].tanh(),
        Law::Function(Smooth::Square) => u[0] * u[0],
        Law::Table { way: Way::Linear, points, values } => line(points, values, u[0]),
        Law::Saturation { lower, upper } => u[0].clamp(*lower, *upper),
        Law::DeadZone { start, end } => u[0] - u[0].clamp(*start, *end),
        Law::Logic(gate) => f64::from(gate_of(*gate, u)),
        Law::Switch { threshold: None } => {
            if u[1] == 1.0 {
                u[0]
            } else {
                u[2]
            }
        }
        _ => return None,
    })
}

fn line(points: &[f64], values: &[f64], u: f64) -> f64 {
    let last = points.len() - 1;
    if u <= points[0] {
        return values[0];
    }
    if u >= points[last] {
        return values[last];
    }
    let i = (0..last).find(|&i| u < points[i + 1]).unwrap_or(last - 1);
    values[i] + (values[i + 1] - values[i]) * (u - points[i]) / (points[i + 1] - points[i])
}

fn gate_of(gate: Gate, u: &[f64]) -> bool {
    let count = u.iter().filter(|u| **u == 1.0).count();
    match gate {
        Gate::And => count == u.len(),
        Gate::Or => count > 0,
        Gate::Xor => count % 2 == 1,
        Gate::Nand => count < u.len(),
        Gate::Nor | Gate::Not => count == 0,
    }
}

/// The branch that a node takes for its inputs, if it holds one between instants; `held` is the present one. `shift` is added to
/// what decides.
pub fn branch(law: &Law, t: f64, u: &[f64], held: f64, shift: f64) -> Option<f64> {
    // A time written in decimals and a multiple of a period are the same instant.
    let late = t + 1e-12;
    Some(match law {
        Law::Step { time, .. } => f64::from(late >= *time),
        Law::Pulse { period, width, delay, .. } => {
            let periods = (late - delay) / period;
            let since = late - delay - periods.floor() * period;
            f64::from(periods >= 0.0 && since < width * period)
        }
        Law::Compare { relation, constant } => {
            let (a, b) = (u[0] + shift, constant.unwrap_or_else(|| u[1]));
            f64::from(match relation {
                Relation::Less => a < b,
                Relation::LessEqual => a <= b,
                Relation::Greater => a > b,
                Relation::GreaterEqual => a >= b,
            })
        }
        Law::Sign => {
            let a = u[0] + shift;
            if a == 0.0 { 0.0 } else { a.signum() }
        }
        Law::Relay { on_at, off_at, .. } => {
            let a = u[0] + shift;
            if a >= *on_at {
                1.0
            } else if a <= *off_at {
                0.0
            } else {
                held
            }
        }
        Law::Switch { threshold: Some(threshold) } => f64::from(u[1] + shift >= *threshold),
        Law::Quantizer { interval } => ((u[0] + shift) / interval).round(),
        Law::Table { way: Way::Flat, points, .. } => {
            points[1..].iter().filter(|point| u[0] + shift >= **point).count() as f64
        }
        Law::Table { way: Way::Nearest, points, .. } => {
            let middles = points.windows(2).map(|two| two[0] + (two[1] - two[0]) / 2.0);
            middles.filter(|middle| u[0] + shift >= *middle).count() as f64
        }
        _ => return None,
    })
}

/// On which side of its kinks a node is. Between two instants a slope that is limited is measured from a step's start, so that a
/// kink before it must not lie within a step.
pub fn piece(law: &Law, u: &[f64]) -> Option<f64> {
    let beyond = |lower: f64, upper: f64| f64::from(u[0] > upper) - f64::from(u[0] < lower);
    match law {
        Law::MinMax(_) => Some(f64::from(u[0] > u[1])),
        Law::Saturation { lower, upper } => Some(beyond(*lower, *upper)),
        Law::DeadZone { start, end } => Some(beyond(*start, *end)),
        _ => None,
    }
}

/// The output of a node on a branch.
pub fn on_branch(law: &Law, branch: f64, u: &[f64]) -> f64 {
    match law {
        Law::Step { before, after, .. } => {
            if branch == 1.0 {
                *after
            } else {
                *before
            }
        }
        Law::Pulse { amplitude, .. } => {
            if branch == 1.0 {
                *amplitude
            } else {
                0.0
            }
        }
        Law::Relay { on, off, .. } => {
            if branch == 1.0 {
                *on
            } else {
                *off
            }
        }
        Law::Switch { .. } => u[if branch == 1.0 { 0 } else { 2 }],
        Law::Quantizer { interval } => interval * branch,
        Law::Table { values, .. } => values[branch as usize],
        _ => branch,
    }
}

/// What watched conditions are measured by: distances from where they change.
pub fn distances(law: &Law, u: &[f64], held: f64, shift: f64) -> [Option<f64>; 2] {
    match law {
        Law::Compare { constant, .. } => [Some(u[0] + shift - constant.unwrap_or_else(|| u[1])), None],
        Law::Sign => [Some(u[0] + shift), None],
        Law::Relay { on_at, off_at, .. } => {
            [Some(u[0] + shift - if held == 1.0 { off_at } else { on_at }), None]
        }
        Law::Switch { threshold: Some(threshold) } => [Some(u[1] + shift - threshold), None],
        Law::Quantizer { interval } => {
            let from = u[0] + shift - interval * held;
            [Some(from - 0.5 * interval), Some(from + 0.5 * interval)]
        }
        Law::Table { way: Way::Flat | Way::Nearest, points, .. } => {
            let place = |i: usize| {
                let (below, above) = (points[i], points[i + 1]);
                if matches!(law, Law::Table { way: Way::Flat, .. }) { above } else { 0.5 * (below + above) }
            };
            let i = held as usize;
            let below = (i > 0).then(|| u[0] + shift - place(i - 1));
            [below, (i + 1 < points.len()).then(|| u[0] + shift - place(i))]
        }
        Law::HitCrossing { at, .. } => [Some(u[0] + shift - at), None],
        Law::Integrator { reset: Some(_), .. } => [Some(u[1] + shift), None],
        _ => [None, None],
    }
}

impl Gains {
    /// The sum of the three parts, and the derivative part.
    pub fn sum(&self, e: f64, integral: f64, filter: f64) -> (f64, f64) {
        let derivative = self.n * (self.kd * e - filter);
        (self.kp * e + integral + derivative, derivative)
    }

    /// Within the limits.
    pub fn limited(&self, v: f64) -> f64 {
        self.limit.map_or(v, |limit| v.clamp(-limit, limit))
    }

    /// Where the integral part is clamped: 1 above, -1 below, 0 nowhere. One that is clamped is so until the error has turned
    /// or `v` is back by a thousandth of the range.
    pub fn clamped(&self, v: f64, e: f64, held: f64, slack: bool) -> f64 {
        let (Windup::Clamping, Some(limit)) = (self.windup, self.limit) else { return 0.0 };
        let drive = self.ki * e;
        let back = if slack { 1e-3 * 2.0 * limit } else { 0.0 };
        let stays = held != 0.0 && held * drive > 0.0 && held * v > limit - back;
        if stays {
            held
        } else if v > limit && drive > 0.0 {
            1.0
        } else if v < -limit && drive < 0.0 {
            -1.0
        } else {
            0.0
        }
    }

    /// What the integral part grows by, over time.
    pub fn growth(&self, v: f64, e: f64, clamped: bool) -> f64 {
        if self.ki == 0.0 || clamped {
            return 0.0;
        }
        let back = if self.windup == Windup::BackCalculation { self.kb * (self.limited(v) - v) } else { 0.0 };
        self.ki * e + back
    }
}

/// Whether a reset holds the state as long as it is on.
pub fn holds(reset: Option<Edge>) -> bool {
    reset == Some(Edge::Level)
}
