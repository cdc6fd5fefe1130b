//! What modulation is calculated with.

use std::ops::{Add, Div, Mul, Neg, Sub};

use blocksim_block::law::{Relation, Value};

/// Numbers, and the numbers of a law.
pub trait Amount:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// The first of the others where this is greater than `than`, else the second.
    fn greater(self, than: Self, one: Self, other: Self) -> Self;

    /// The first of the others where this is equal to `to`, else the second.
    fn equal(self, to: Self, one: Self, other: Self) -> Self;

    /// The next whole number below.
    fn whole(self) -> Self;

    /// A number that never changes.
    fn fixed(self, number: f64) -> Self;

    /// It between two limits; what is not a number stays so.
    fn within(self, low: f64, high: f64) -> Self;
}

impl Amount for f64 {
    #[inline]
    fn greater(self, than: Self, one: Self, other: Self) -> Self {
        if self > than { one } else { other }
    }

    #[inline]
    fn equal(self, to: Self, one: Self, other: Self) -> Self {
        if self == to { one } else { other }
    }

    #[inline]
    fn whole(self) -> Self {
        self.floor()
    }

    #[inline]
    fn fixed(self, number: f64) -> Self {
        number
    }

    #[inline]
    fn within(self, low: f64, high: f64) -> Self {
        self.clamp(low, high)
    }
}

impl Amount for Value<'_> {
    fn greater(self, than: Self, one: Self, other: Self) -> Self {
        self.live(Relation::Greater, than).select(one, other)
    }

    fn equal(self, to: Self, one: Self, other: Self) -> Self {
        self.live(Relation::Equal, to).select(one, other)
    }

    fn whole(self) -> Self {
        self.below()
    }

    fn fixed(self, number: f64) -> Self {
        self.zero() + number
    }

    fn within(self, low: f64, high: f64) -> Self {
        self.clamp(self.fixed(low), self.fixed(high))
    }
}
