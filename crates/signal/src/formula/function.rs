//! The functions of a formula.

/// A function of a formula.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// Square root.
    Sqrt,
    /// Absolute value.
    Abs,
    /// -1, 0 or 1.
    Sign,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// Inverse sine.
    Asin,
    /// Inverse cosine.
    Acos,
    /// Inverse tangent.
    Atan,
    /// Angle of a point, ordinate first.
    Atan2,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// Power of e.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Logarithm to base 10.
    Log10,
    /// Distance of a point from the origin.
    Hypot,
    /// Least argument.
    Min,
    /// Greatest argument.
    Max,
    /// Next whole number below.
    Floor,
    /// Next whole number above.
    Ceil,
    /// Nearest whole number, halves away from zero.
    Round,
    /// Remainder with the sign of the divisor.
    Mod,
    /// The second argument where the first is true, else the third.
    If,
    /// Whether all are true.
    And,
    /// Whether one is true.
    Or,
    /// Whether it is false.
    Not,
}

/// Name, fewest and most arguments.
pub(super) const FUNCTIONS: [(&str, Function, usize, usize); 27] = [
    ("sqrt", Function::Sqrt, 1, 1),
    ("abs", Function::Abs, 1, 1),
    ("sin", Function::Sin, 1, 1),
    ("cos", Function::Cos, 1, 1),
    ("tan", Function::Tan, 1, 1),
    ("sign", Function::Sign, 1, 1),
    ("asin", Function::Asin, 1, 1),
    ("acos", Function::Acos, 1, 1),
    ("atan", Function::Atan, 1, 1),
    ("atan2", Function::Atan2, 2, 2),
    ("sinh", Function::Sinh, 1, 1),
    ("cosh", Function::Cosh, 1, 1),
    ("tanh", Function::Tanh, 1, 1),
    ("exp", Function::Exp, 1, 1),
    ("ln", Function::Ln, 1, 1),
    ("log10", Function::Log10, 1, 1),
    ("hypot", Function::Hypot, 2, 2),
    ("min", Function::Min, 1, usize::MAX),
    ("max", Function::Max, 1, usize::MAX),
    ("floor", Function::Floor, 1, 1),
    ("ceil", Function::Ceil, 1, 1),
    ("round", Function::Round, 1, 1),
    ("mod", Function::Mod, 2, 2),
    ("if", Function::If, 3, 3),
    ("and", Function::And, 2, usize::MAX),
    ("or", Function::Or, 2, usize::MAX),
    ("not", Function::Not, 1, 1),
];

impl Function {
    /// Its name.
    pub fn name(self) -> &'static str {
        FUNCTIONS.iter().find(|(_, function, ..)| *function == self).map_or("", |(name, ..)| name)
    }

    /// Whether a function has this name.
    pub fn is_name(name: &str) -> bool {
        Self::find(name).is_some()
    }

    /// The function of a name, with its fewest and most arguments.
    pub(super) fn find(name: &str) -> Option<(Self, usize, usize)> {
        let found = FUNCTIONS.iter().find(|(known, ..)| *known == name);
        found.map(|(_, function, least, most)| (*function, *least, *most))
    }
}
