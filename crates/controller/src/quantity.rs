//! Names of parameters, ports and states: declared once, then used as indices.

use std::marker::PhantomData;

/// What a [`Quantity`] is, as a type: an input cannot be read as a parameter.
pub mod role {
    /// Given in the diagram, constant during a run.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Parameter {}
    /// Comes from another block.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Input {}
    /// Goes to other blocks.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Output {}
    /// State that changes at sample hits only.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Discrete {}
    /// State that is integrated over time.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Continuous {}
}

/// A parameter.
pub type Parameter = Quantity<role::Parameter>;
/// An input port.
pub type Input = Quantity<role::Input>;
/// An output port.
pub type Output = Quantity<role::Output>;
/// A discrete state.
pub type Discrete = Quantity<role::Discrete>;
/// A continuous state.
pub type Continuous = Quantity<role::Continuous>;

/// A named number or vector at a fixed place in its buffer.
///
/// Units are SI units as in diagrams: `"rad/s"`; `"1"` is dimensionless, `""` takes whatever comes.
/// The numbers are SI always.
#[derive(Debug, Clone, Copy)]
pub struct Quantity<R> {
    pub(crate) at: usize,
    pub(crate) length: usize,
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) doc: &'static str,
    pub(crate) default: Option<&'static [f64]>,
    pub(crate) reads: &'static [Input],
    role: PhantomData<R>,
}

impl<R> Quantity<R> {
    /// A number. `at` is its place: 0 for the first of its list, then counting on by 1 for each number
    /// and by the length for each vector. A wrong place is a compile error of `export_plugin!`.
    pub const fn new(at: usize, name: &'static str, unit: &'static str, doc: &'static str) -> Self {
        Self::vector(at, 1, name, unit, doc)
    }

    /// A vector of `length` numbers, at least 1.
    pub const fn vector(
        at: usize,
        length: usize,
        name: &'static str,
        unit: &'static str,
        doc: &'static str,
    ) -> Self {
        Quantity { at, length, name, unit, doc, default: None, reads: &[], role: PhantomData }
    }

    /// The value where nothing is given: of a parameter that the diagram leaves out, of an input that is
    /// not connected, of a state before `reset`. As many numbers as the quantity has.
    ///
    /// Without it a parameter must be given, an input must be connected, and a state starts at zero.
    pub const fn or(self, default: &'static [f64]) -> Self {
        Quantity { default: Some(default), ..self }
    }
}

impl Output {
    /// The inputs that this output depends on at the same instant (direct feedthrough).
    ///
    /// Leave out those that it sees through a state only. Without this line the output reads no input.
    pub const fn reads(self, inputs: &'static [Input]) -> Self {
        Quantity { reads: inputs, ..self }
    }
}
