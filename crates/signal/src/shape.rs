//! What a signal looks like: its shape, the kind of its elements and when it changes.

use std::fmt;

/// The arrangement of the numbers of one signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Shape {
    /// One number.
    #[default]
    Scalar,
    /// A column of that many numbers.
    Vector(usize),
    /// Rows and columns.
    Matrix(usize, usize),
}

impl Shape {
    /// How many numbers a signal of this shape carries.
    pub fn len(self) -> usize {
        match self {
            Shape::Scalar => 1,
            Shape::Vector(n) => n,
            Shape::Matrix(rows, columns) => rows * columns,
        }
    }

    /// Whether a signal of this shape carries no number at all.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Shape::Scalar => write!(f, "scalar"),
            Shape::Vector(n) => write!(f, "vector of {n}"),
            Shape::Matrix(rows, columns) => write!(f, "{rows}x{columns} matrix"),
        }
    }
}

/// The kind of the elements of a signal. All are carried as `f64`; the kind says what may be done with them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Kind {
    /// Any finite number.
    #[default]
    Real,
    /// 0 or 1.
    Bool,
    /// A whole number.
    Int,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Kind::Real => "real",
            Kind::Bool => "bool",
            Kind::Int => "int",
        })
    }
}

/// When a signal or a block may change.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum SampleTime {
    /// At every instant.
    #[default]
    Continuous,
    /// At `offset + n * period`, n = 0, 1, ...
    Discrete {
        /// Time between two hits in s, positive.
        period: f64,
        /// Time of the first hit in s, at least 0 and less than the period.
        offset: f64,
    },
    /// As often as the inputs.
    Inherited,
    /// Never during a run.
    Constant,
}

impl fmt::Display for SampleTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SampleTime::Continuous => write!(f, "continuous"),
            SampleTime::Discrete { period, offset } if *offset == 0.0 => write!(f, "every {period} s"),
            SampleTime::Discrete { period, offset } => write!(f, "every {period} s from {offset} s"),
            SampleTime::Inherited => write!(f, "inherited"),
            SampleTime::Constant => write!(f, "constant"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_knows_its_length_and_says_itself_in_words() {
        for (shape, len, text) in [
            (Shape::Scalar, 1, "scalar"),
            (Shape::Vector(3), 3, "vector of 3"),
            (Shape::Matrix(3, 4), 12, "3x4 matrix"),
        ] {
            assert_eq!((shape.len(), shape.to_string().as_str()), (len, text));
        }
        assert!(Shape::Vector(0).is_empty() && !Shape::Scalar.is_empty());
    }

    #[test]
    fn a_sample_time_says_its_offset_only_when_it_has_one() {
        let plain = SampleTime::Discrete { period: 0.001, offset: 0.0 };
        let shifted = SampleTime::Discrete { period: 0.001, offset: 0.0005 };
        assert_eq!(plain.to_string(), "every 0.001 s");
        assert_eq!(shifted.to_string(), "every 0.001 s from 0.0005 s");
    }
}
