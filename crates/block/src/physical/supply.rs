//! Three-phase supplies and space vectors.

/// Three-phase voltages as a space vector (amplitude invariant) in a frame of its own.
///
/// An ideal source gives its frame, which turns with it, to the machines that it feeds directly; elsewhere the frame
/// stands still with its real axis on phase a.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Supply {
    /// Components on the real (d) and imaginary (q) axis of the frame, V; their length is the peak phase voltage.
    pub voltage: [f64; 2],
    /// Zero sequence: the mean of the three voltages, V.
    pub zero: f64,
    /// Speed of the frame, Hz; negative for the sequence a, c, b.
    pub frequency: f64,
    /// Angle of the frame against the axis of phase a, rad.
    pub angle: f64,
    /// How the voltages turn where the frame stands still.
    pub field: Field,
}

/// What is known of how voltages turn, as space vectors, in a frame that stands still.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Field {
    /// Nothing: behind an inverter that switches.
    #[default]
    Unknown,
    /// At this frequency, Hz; negative for the sequence a, c, b.
    Turns(f64),
    /// At this frequency, Hz, in a sense that contacts may change.
    Either(f64),
}

impl Field {
    /// The same behind contacts that may exchange phases.
    pub fn exchanged(self) -> Self {
        if let Field::Turns(frequency) = self { Field::Either(frequency) } else { self }
    }
}

impl Supply {
    /// No voltage, in a frame that stands still.
    pub const NONE: Self =
        Self { voltage: [0.0; 2], zero: 0.0, frequency: 0.0, angle: 0.0, field: Field::Unknown };

    /// Peak phase voltage, V.
    pub fn amplitude(&self) -> f64 {
        self.voltage[0].hypot(self.voltage[1])
    }

    /// Voltages of the phases, V.
    pub fn phases(&self) -> [f64; 3] {
        let (sin, cos) = self.angle.sin_cos();
        let [d, q] = self.voltage;
        from_space_vector([cos * d - sin * q, sin * d + cos * q, self.zero])
    }
}

/// Half the square root of three.
const HALF_SQRT_3: f64 = 0.866_025_403_784_438_6;

/// Phase values of a space vector with zero sequence in the frame of phase a.
#[inline]
pub fn from_space_vector([alpha, beta, zero]: [f64; 3]) -> [f64; 3] {
    let (half, lift) = (-0.5 * alpha, HALF_SQRT_3 * beta);
    [alpha + zero, half + lift + zero, half - lift + zero]
}

/// Space vector and zero sequence of phase values, in the frame of phase a.
#[inline]
pub fn space_vector([a, b, c]: [f64; 3]) -> [f64; 3] {
    [(2.0 * a - b - c) / 3.0, (b - c) / (2.0 * HALF_SQRT_3), (a + b + c) / 3.0]
}
