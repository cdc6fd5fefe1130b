//! Complex numbers: phasors and space vectors.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A complex number: direct and quadrature component of a space vector, or a phasor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Complex {
    /// Real part, direct axis.
    pub re: f64,
    /// Imaginary part, quadrature axis.
    pub im: f64,
}

/// The imaginary unit.
pub const J: Complex = complex(0.0, 1.0);
/// Zero.
pub const ZERO: Complex = complex(0.0, 0.0);

/// `re + j im`.
pub const fn complex(re: f64, im: f64) -> Complex {
    Complex { re, im }
}

impl Complex {
    /// From both components of a space vector.
    #[inline]
    pub const fn from_vector([d, q]: [f64; 2]) -> Self {
        complex(d, q)
    }

    /// Both components of a space vector.
    #[inline]
    pub const fn vector(self) -> [f64; 2] {
        [self.re, self.im]
    }

    /// Absolute value.
    #[inline]
    pub fn abs(self) -> f64 {
        self.re.hypot(self.im)
    }

    /// Square of the absolute value.
    #[inline]
    pub fn square(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// Scalar product of two space vectors.
    #[inline]
    pub fn dot(self, other: Self) -> f64 {
        self.re * other.re + self.im * other.im
    }

    /// Cross product of two space vectors: `a x b = a_d b_q - a_q b_d`.
    #[inline]
    pub fn cross(self, other: Self) -> f64 {
        self.re * other.im - self.im * other.re
    }

    /// Turned by an angle, rad.
    #[inline]
    pub fn turned(self, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        self * complex(cos, sin)
    }
}

impl Add for Complex {
    type Output = Self;

    #[inline]
    fn add(self, b: Self) -> Self {
        complex(self.re + b.re, self.im + b.im)
    }
}

impl Sub for Complex {
    type Output = Self;

    #[inline]
    fn sub(self, b: Self) -> Self {
        complex(self.re - b.re, self.im - b.im)
    }
}

impl Neg for Complex {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        complex(-self.re, -self.im)
    }
}

impl Mul for Complex {
    type Output = Self;

    #[inline]
    fn mul(self, b: Self) -> Self {
        complex(self.re * b.re - self.im * b.im, self.re * b.im + self.im * b.re)
    }
}

impl Mul<Complex> for f64 {
    type Output = Complex;

    #[inline]
    fn mul(self, b: Complex) -> Complex {
        complex(self * b.re, self * b.im)
    }
}

impl Div for Complex {
    type Output = Self;

    #[inline]
    fn div(self, b: Self) -> Self {
        let product = self * complex(b.re, -b.im);
        complex(product.re / b.square(), product.im / b.square())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn division_undoes_multiplication() {
        let (a, b) = (complex(3.0, -4.0), complex(0.5, 2.0));
        assert!((a * b / b - a).abs() < 1e-15);
        assert_eq!(J * J, -complex(1.0, 0.0));
        assert_eq!(a.abs(), 5.0);
    }

    #[test]
    fn a_quarter_turn_multiplies_by_the_imaginary_unit() {
        let a = complex(3.0, -4.0);
        assert!((a.turned(std::f64::consts::FRAC_PI_2) - J * a).abs() < 1e-15);
    }
}
