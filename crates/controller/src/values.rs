//! Buffers of the host, indexed by the names of what they hold.

use std::marker::PhantomData;
use std::ops::{Index, IndexMut};

use crate::quantity::{Quantity, role};

/// The parameters of one instance.
pub type Parameters = Values<role::Parameter>;
/// The outputs to write.
pub type Outputs = Values<role::Output>;
/// Discrete states to write: those of the next sample, or of the start.
pub type DiscreteStates = Values<role::Discrete>;
/// Continuous states to write at the start.
pub type ContinuousStates = Values<role::Continuous>;
/// Time derivatives to write, under the names of the continuous states.
pub type Derivatives = Values<role::Continuous>;

/// Numbers of one role, one quantity after the other. `values[NAME]` is a number, or the first one of a
/// vector; [`Values::vector`] gives all of them.
///
/// # Panics
///
/// Indexing with a quantity that is not in the list of its controller, if it points behind the buffer.
#[derive(Debug)]
#[repr(transparent)]
pub struct Values<R> {
    role: PhantomData<R>,
    numbers: [f64],
}

impl<R> Values<R> {
    /// A view of `numbers`.
    pub fn of(numbers: &[f64]) -> &Self {
        // SAFETY: `Values` is a transparent wrapper of `[f64]`.
        unsafe { &*(std::ptr::from_ref(numbers) as *const Self) }
    }

    /// A view of `numbers` to write through.
    pub fn of_mut(numbers: &mut [f64]) -> &mut Self {
        // SAFETY: `Values` is a transparent wrapper of `[f64]`.
        unsafe { &mut *(std::ptr::from_mut(numbers) as *mut Self) }
    }

    /// The numbers of `quantity`.
    pub fn vector(&self, quantity: Quantity<R>) -> &[f64] {
        &self.numbers[quantity.at..][..quantity.length]
    }

    /// The numbers of `quantity`, to write.
    pub fn vector_mut(&mut self, quantity: Quantity<R>) -> &mut [f64] {
        &mut self.numbers[quantity.at..][..quantity.length]
    }
}

impl<R> Index<Quantity<R>> for Values<R> {
    type Output = f64;
    fn index(&self, quantity: Quantity<R>) -> &f64 {
        &self.numbers[quantity.at]
    }
}

impl<R> IndexMut<Quantity<R>> for Values<R> {
    fn index_mut(&mut self, quantity: Quantity<R>) -> &mut f64 {
        &mut self.numbers[quantity.at]
    }
}
