//! Numbers with their first two derivatives over one coordinate.

use std::ops::{Add, Mul, Neg, Sub};

/// Value, first and second derivative.
#[derive(Debug, Clone, Copy)]
pub(super) struct Jet(pub f64, pub f64, pub f64);

impl Jet {
    pub fn constant(value: f64) -> Jet {
        Jet(value, 0.0, 0.0)
    }

    /// A function with its derivatives at the value.
    fn through(self, f: f64, df: f64, ddf: f64) -> Jet {
        Jet(f, df * self.1, ddf * self.1 * self.1 + df * self.2)
    }

    pub fn sin(self) -> Jet {
        let (s, c) = self.0.sin_cos();
        self.through(s, c, -s)
    }

    pub fn cos(self) -> Jet {
        let (s, c) = self.0.sin_cos();
        self.through(c, -s, -c)
    }

    pub fn sqrt(self) -> Jet {
        let root = self.0.sqrt();
        self.through(root, 0.5 / root, -0.25 / (root * self.0))
    }

    pub fn over(self, other: Jet) -> Jet {
        let inverse = 1.0 / other.0;
        self * other.through(inverse, -inverse * inverse, 2.0 * inverse.powi(3))
    }

    /// The angle of a direction.
    pub fn angle(y: Jet, x: Jet) -> Jet {
        let slope = (x * Jet(y.1, y.2, 0.0) - y * Jet(x.1, x.2, 0.0)).over(x * x + y * y);
        Jet(y.0.atan2(x.0), slope.0, slope.1)
    }
}

impl Add for Jet {
    type Output = Jet;
    fn add(self, b: Jet) -> Jet {
        Jet(self.0 + b.0, self.1 + b.1, self.2 + b.2)
    }
}

impl Sub for Jet {
    type Output = Jet;
    fn sub(self, b: Jet) -> Jet {
        Jet(self.0 - b.0, self.1 - b.1, self.2 - b.2)
    }
}

impl Neg for Jet {
    type Output = Jet;
    fn neg(self) -> Jet {
        Jet(-self.0, -self.1, -self.2)
    }
}

impl Mul for Jet {
    type Output = Jet;
    fn mul(self, b: Jet) -> Jet {
        Jet(self.0 * b.0, self.1 * b.0 + self.0 * b.1, self.2 * b.0 + 2.0 * self.1 * b.1 + self.0 * b.2)
    }
}
