//! What the continuous and the discrete PID controller have in common.

use std::ops::{Add, Mul};

use blocksim_block::prelude::*;

use super::units::{SECOND, agrees};

/// How the gains of a PID controller act together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Form {
    /// Each gain acts alone.
    Parallel,
    /// `kp` multiplies the other two as well.
    Ideal,
}

/// What happens to the integral part while the output is limited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum AntiWindup {
    /// Nothing: it winds up.
    None,
    /// It stops while it would lead further out.
    Clamping,
    /// What the limits cut off is fed back into it.
    BackCalculation,
}

/// The parameters of a PID controller.
#[derive(Debug, Clone, Copy, PartialEq, Parameters)]
pub struct PidLaw {
    /// Proportional gain.
    #[block(difference, finite)]
    pub kp: f64,
    /// Integral gain: the unit of `kp` over s, or 1/s with `form: Ideal`.
    #[block(difference, finite, default = 0.0)]
    pub ki: f64,
    /// Derivative gain: the unit of `kp` times s, or s with `form: Ideal`.
    #[block(difference, finite, default = 0.0)]
    pub kd: f64,
    /// Where the filter of the derivative cuts off, positive.
    #[block(unit = "1/s", positive, default = 100.0)]
    pub n: f64,
    /// `Parallel`, or `Ideal` where `kp` multiplies all parts.
    #[block(default = Form::Parallel)]
    pub form: Form,
    /// Lower limit of the output.
    #[block(below = f64::INFINITY, default = None)]
    pub lower: Option<f64>,
    /// Upper limit of the output.
    #[block(above = f64::NEG_INFINITY, above = lower, default = None)]
    pub upper: Option<f64>,
    /// Whether there are extra inputs `lower` and `upper` for the limits; one that is not connected has the value of the
    /// parameter, or no limit.
    #[block(default = false)]
    pub external_limits: bool,
    /// What happens to the integral part while the output is limited: `None`, `Clamping`, `BackCalculation`.
    #[block(default = AntiWindup::None)]
    pub anti_windup: AntiWindup,
    /// Gain of the feedback of `BackCalculation`.
    #[block(unit = "1/s", finite, default = 1.0)]
    pub kb: f64,
    /// Integral part at the start.
    #[block(finite, default = 0.0)]
    pub x0: f64,
    /// State of the derivative filter at the start; `kd` times the error at the start spares the peak.
    #[block(finite, default = 0.0)]
    pub d0: f64,
}

/// The limits of the output.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits<'r> {
    pub lower: Value<'r>,
    pub upper: Value<'r>,
}

impl<'r> Limits<'r> {
    /// The output within them.
    pub fn saturate(self, v: Value<'r>) -> Value<'r> {
        v.clamp(self.lower, self.upper)
    }
}

impl PidLaw {
    fn validate(&self, errors: &mut ParamErrors) {
        if self.anti_windup != AntiWindup::None && !self.limited() {
            errors
                .add(ParamError::new("anti_windup", "without limits nothing winds up").help(
                    "give `lower` and `upper`, or `external_limits: true`, or leave out `anti_windup`",
                ));
        }
        if self.anti_windup == AntiWindup::BackCalculation && self.per_integral() * self.kb < 0.0 {
            let message = format!("`kb` is {}, which drives the integral part away from the limits", self.kb);
            let sign = if self.per_integral() < 0.0 { "negative, as `kp`" } else { "positive" };
            errors.add(ParamError::new("kb", message).beside(&["kp"]).help(format!("make it {sign}")));
        }
    }

    /// Dimension of the output, after checking that the gains go together as written.
    pub(crate) fn dimension(&self, given: &Given) -> Result<Option<Dimension>, InterfaceError> {
        let kp = given.parameters.get("kp");
        let parts = match self.form {
            Form::Parallel => kp,
            Form::Ideal => Dimension::NONE,
        };
        if self.kp != 0.0 {
            agrees(given, "ki", "e", Some(parts.over(SECOND)))?;
            agrees(given, "kd", "e", Some(parts.times(SECOND)))?;
        }
        let u = given.input_or_unknown("e").dimension.map(|e| e.times(kp));
        agrees(given, "lower", "e", u)?;
        agrees(given, "upper", "e", u)?;
        Ok(u)
    }

    /// By how much the output changes with the integral part.
    pub(crate) fn per_integral(&self) -> f64 {
        match self.form {
            Form::Parallel => 1.0,
            Form::Ideal => self.kp,
        }
    }

    /// Output before the limits, from the error and the integral and derivative parts.
    pub(crate) fn sum<N>(&self, e: N, integral: N, derivative: N) -> N
    where
        N: Add<N, Output = N>,
        f64: Mul<N, Output = N>,
    {
        match self.form {
            Form::Parallel => self.kp * e + integral + derivative,
            Form::Ideal => self.kp * (e + integral + derivative),
        }
    }

    pub(crate) fn limited(&self) -> bool {
        self.lower.is_some() || self.upper.is_some() || self.external_limits
    }

    pub(crate) fn lower(&self) -> f64 {
        self.lower.unwrap_or(f64::NEG_INFINITY)
    }

    pub(crate) fn upper(&self) -> f64 {
        self.upper.unwrap_or(f64::INFINITY)
    }

    /// The inputs for limits that are signals, of the dimension of the output.
    pub(crate) fn inputs_of_limits(&self, interface: Interface, u: Option<Dimension>) -> Interface {
        if !self.external_limits {
            return interface;
        }
        let limit = |name, value| Input::real(name).dimension(u).default(value);
        interface
            .input(limit("lower", self.lower()).doc("Lower limit; the parameter if it is not connected."))
            .input(limit("upper", self.upper()).doc("Upper limit; the parameter if it is not connected."))
    }

    /// The limits of element `i`; those that are signals are the last two inputs. Limits that cross end the run.
    pub(crate) fn limits<'r>(&self, l: &Recording<'r>, i: usize) -> Limits<'r> {
        if !self.external_limits {
            return Limits { lower: l.constant(self.lower()), upper: l.constant(self.upper()) };
        }
        let port = l.inputs() - 2;
        let limits = Limits { lower: l.element(port, i), upper: l.element(port + 1, i) };
        limits.upper.only_where(!limits.upper.live(Relation::Less, limits.lower));
        limits
    }

    /// Why there is no output: limits cross.
    pub(crate) fn no_value(&self, c: &Context) -> Option<String> {
        let port = c.inputs.len().checked_sub(2).filter(|_| self.external_limits)?;
        crate::discontinuities::crossed(c.input(port), c.input(port + 1))
    }

    /// Where the integral part would lead the output further out: 1 above the upper limit, -1 below the lower
    /// one, 0 elsewhere. `slack` shifts the limits inwards.
    pub(crate) fn winds_up<'r>(
        &self,
        l: &Recording<'r>,
        Limits { lower, upper }: Limits<'r>,
        v: Value<'r>,
        e: Value<'r>,
        slack: Value<'r>,
    ) -> Value<'r> {
        let drive = self.per_integral() * self.ki * e;
        let zero = l.constant(0.0);
        let above = v.live(Relation::Greater, upper - slack).and(drive.live(Relation::Greater, zero));
        let below = v.live(Relation::Less, lower + slack).and(drive.live(Relation::Less, zero));
        above.select(l.constant(1.0), below.select(l.constant(-1.0), zero))
    }
}
