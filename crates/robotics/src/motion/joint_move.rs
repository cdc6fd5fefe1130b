//! A planned move of all axes together.

use crate::motion::error::{Endpoint, MoveError};
use crate::motion::limits::{AxisLimits, AxisQuantity, AxisViolation, Margin};
use crate::motion::profile::Profile;
use crate::motion::request::{JointMoveRequest, Synchronisation};
use crate::motion::times::{Times, synchronise};

/// How far outside its limits a position may be, rad or m. An angle that went through degrees and back is off by
/// a few 1e-16; nobody means an angle this small.
const POSITION_TOLERANCE: f64 = 1e-9;

/// What counts as exceeding a limit, relative: well above the rounding of the planning (some 1e-16).
const LIMIT_TOLERANCE: f64 = 1e-9;

/// A fully synchronised move: all axes accelerate, cruise and brake during the same times.
///
/// Per axis with distance $d_i$, $v_i$ = velocity share · maximum speed and $s$ = acceleration share:
///
/// $$ t_{end,i} = \frac{d_i}{v_i (1 - s)}, \quad t_{acc,i} = s\,t_{end,i}, \quad
///    T_{acc} = \max_i t_{acc,i}, \quad T_{dec} = \max_i \frac{d_i}{v_i}, \quad
///    v_{m,i} = \frac{d_i}{T_{dec}}, \quad a_{m,i} = \frac{2 v_{m,i}}{T_{acc}} $$
///
/// Where an $a_{m,i}$ exceeds its limit, both times are stretched by the square root of the worst ratio.
///
/// Source: W. Weber, Industrieroboter, 2017, fully synchronous joint moves; the rule of the longest times
/// takes the place of "the times of the leading axis", which can break limits of the others and remains
/// available as [`Synchronisation::AsPrinted`].
#[derive(Debug, Clone, PartialEq)]
pub struct JointMove {
    start: Vec<f64>,
    target: Vec<f64>,
    limits: Vec<AxisLimits>,
    profiles: Vec<Profile>,
    times: Times,
    rule: Synchronisation,
}

impl JointMove {
    /// Plans a move; `limits` has one entry per axis.
    ///
    /// # Errors
    ///
    /// A [`MoveError`] where the request or the limits make no move; its message names axis, value, limit
    /// and remedy.
    pub fn plan(request: &JointMoveRequest, limits: &[AxisLimits]) -> Result<JointMove, MoveError> {
        check_limits(limits)?;
        check_endpoint(Endpoint::Start, &request.start, limits)?;
        check_endpoint(Endpoint::Target, &request.target, limits)?;
        let (v_share, a_share) = (request.velocity, request.acceleration);
        if !(v_share > 0.0 && v_share <= 1.0) {
            return Err(MoveError::VelocityShare { value: v_share });
        }
        if !(a_share > 0.0 && a_share <= 0.5) {
            return Err(MoveError::AccelerationShare { value: a_share });
        }

        let signed: Vec<f64> = request.target.iter().zip(&request.start).map(|(b, a)| b - a).collect();
        let distances: Vec<f64> = signed.iter().map(|d| d.abs()).collect();
        if distances.iter().all(|&d| d == 0.0) {
            return Err(MoveError::NothingToMove);
        }
        let times = synchronise(&distances, limits, v_share, a_share, request.rule);
        let profiles = signed
            .iter()
            .enumerate()
            .map(|(axis, &distance)| {
                Profile::new(times.t_acc, times.t_dec, distance).ok_or(MoveError::NotComputable {
                    axis,
                    kind: limits[axis].kind,
                    distance,
                    duration: times.t_acc + times.t_dec,
                })
            })
            .collect::<Result<_, _>>()?;
        Ok(JointMove {
            start: request.start.clone(),
            target: request.target.clone(),
            limits: limits.to_vec(),
            profiles,
            times,
            rule: request.rule,
        })
    }

    /// Number of axes.
    pub fn axes(&self) -> usize {
        self.profiles.len()
    }

    /// Position (rad or m), velocity and acceleration of an axis after `t` s. Before 0 the axis
    /// rests at the start, after the end at the target, to the bit.
    ///
    /// # Panics
    ///
    /// If `axis` is not below [`JointMove::axes`].
    pub fn at(&self, axis: usize, t: f64) -> (f64, f64, f64) {
        let profile = &self.profiles[axis];
        let position =
            if t >= self.duration() { self.target[axis] } else { self.start[axis] + profile.position(t) };
        (position, profile.velocity(t), profile.acceleration(t))
    }

    /// Time from start to rest, s.
    pub fn duration(&self) -> f64 {
        self.times.t_acc + self.times.t_dec
    }

    /// Time spent accelerating, and again braking, s.
    pub fn t_acc(&self) -> f64 {
        self.times.t_acc
    }

    /// Time at which all axes begin to brake, s.
    pub fn t_dec(&self) -> f64 {
        self.times.t_dec
    }

    /// How much longer the move takes than the velocity and acceleration shares ask for, because an
    /// acceleration limit was in the way: 1 where none was.
    pub fn stretch(&self) -> f64 {
        self.times.stretch
    }

    /// Index of the axis that determines the times: the slowest, or, in a stretched move, the one whose
    /// acceleration limit was hit.
    pub fn leading_axis(&self) -> usize {
        self.times.leading
    }

    /// The rule by which the axes were synchronised.
    pub fn rule(&self) -> Synchronisation {
        self.rule
    }

    /// Profile of each axis, relative to its start.
    pub fn profiles(&self) -> &[Profile] {
        &self.profiles
    }

    /// Largest speed of each axis, rad/s or m/s.
    pub fn peak_velocities(&self) -> Vec<f64> {
        self.profiles.iter().map(|p| p.peak_velocity().abs()).collect()
    }

    /// Largest acceleration of each axis, rad/s² or m/s².
    pub fn peak_accelerations(&self) -> Vec<f64> {
        self.profiles.iter().map(|p| p.peak_acceleration().abs()).collect()
    }

    /// What is left to the limits of each axis.
    pub fn margins(&self) -> Vec<Margin> {
        let margin = |(i, profile): (usize, &Profile)| Margin {
            lower: self.start[i].min(self.target[i]) - self.limits[i].lower,
            upper: self.limits[i].upper - self.start[i].max(self.target[i]),
            speed: self.limits[i].speed - profile.peak_velocity().abs(),
            acceleration: self.limits[i].acceleration - profile.peak_acceleration().abs(),
        };
        self.profiles.iter().enumerate().map(margin).collect()
    }

    /// Speed and acceleration limits that the move exceeds, by axis; always empty with
    /// [`Synchronisation::Feasible`].
    pub fn violations(&self) -> Vec<AxisViolation> {
        let mut violations = Vec::new();
        for (axis, (profile, limits)) in self.profiles.iter().zip(&self.limits).enumerate() {
            for (quantity, value, limit) in [
                (AxisQuantity::Speed, profile.peak_velocity().abs(), limits.speed),
                (AxisQuantity::Acceleration, profile.peak_acceleration().abs(), limits.acceleration),
            ] {
                if value > limit * (1.0 + LIMIT_TOLERANCE) {
                    violations.push(AxisViolation { axis, kind: limits.kind, quantity, value, limit });
                }
            }
        }
        violations
    }
}

fn check_limits(limits: &[AxisLimits]) -> Result<(), MoveError> {
    if limits.is_empty() {
        return Err(MoveError::NoAxes);
    }
    for (axis, l) in limits.iter().enumerate() {
        // Written so that a NaN fails each of them.
        let ordered = l.lower < l.upper;
        if !ordered {
            return Err(MoveError::LimitsCrossed { axis, kind: l.kind, lower: l.lower, upper: l.upper });
        }
        if !(l.speed > 0.0 && l.speed.is_finite()) {
            return Err(MoveError::SpeedLimit { axis, kind: l.kind, value: l.speed });
        }
        let able = l.acceleration > 0.0;
        if !able {
            return Err(MoveError::AccelerationLimit { axis, kind: l.kind, value: l.acceleration });
        }
    }
    Ok(())
}

fn check_endpoint(endpoint: Endpoint, positions: &[f64], limits: &[AxisLimits]) -> Result<(), MoveError> {
    if positions.len() != limits.len() {
        return Err(MoveError::WrongLength { endpoint, given: positions.len(), axes: limits.len() });
    }
    for (axis, (&value, l)) in positions.iter().zip(limits).enumerate() {
        if !value.is_finite() {
            return Err(MoveError::NotFinite { endpoint, axis, kind: l.kind, value });
        }
        if value < l.lower - POSITION_TOLERANCE || value > l.upper + POSITION_TOLERANCE {
            let (kind, lower, upper) = (l.kind, l.lower, l.upper);
            return Err(MoveError::OutsideLimits { endpoint, axis, kind, value, lower, upper });
        }
    }
    Ok(())
}

#[cfg(test)]
#[path = "joint_move_tests.rs"]
mod tests;
