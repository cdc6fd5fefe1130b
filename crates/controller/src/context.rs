//! What a controller sees when it is asked.

use std::ops::Index;

use crate::quantity::{Continuous, Discrete, Input, Parameter};
use crate::role;
use crate::values::{Parameters, Values};

/// Time, parameters, states and inputs of one evaluation, all read-only.
///
/// `c[NAME]` is the number of a parameter, input or state; vectors are at `c.u.vector(NAME)`.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// Time in seconds.
    pub t: f64,
    /// Parameters.
    pub p: &'a Parameters,
    /// Continuous states.
    pub x: &'a Values<role::Continuous>,
    /// Discrete states as they are before the update.
    pub xd: &'a Values<role::Discrete>,
    /// Inputs.
    pub u: &'a Values<role::Input>,
}

impl<'a> Context<'a> {
    /// A context over plain numbers, laid out as the lists of the controller say.
    pub fn new(t: f64, p: &'a [f64], x: &'a [f64], xd: &'a [f64], u: &'a [f64]) -> Self {
        Context { t, p: Values::of(p), x: Values::of(x), xd: Values::of(xd), u: Values::of(u) }
    }
}

impl Index<Parameter> for Context<'_> {
    type Output = f64;
    fn index(&self, parameter: Parameter) -> &f64 {
        &self.p[parameter]
    }
}

impl Index<Input> for Context<'_> {
    type Output = f64;
    fn index(&self, input: Input) -> &f64 {
        &self.u[input]
    }
}

impl Index<Discrete> for Context<'_> {
    type Output = f64;
    fn index(&self, state: Discrete) -> &f64 {
        &self.xd[state]
    }
}

impl Index<Continuous> for Context<'_> {
    type Output = f64;
    fn index(&self, state: Continuous) -> &f64 {
        &self.x[state]
    }
}
