//! Space vectors of machines and inverters.

/// A space vector: direct and quadrature component.
pub(crate) type Vector = [f64; 2];

/// A space vector turned by an angle, rad.
pub(crate) fn turned([d, q]: Vector, angle: f64) -> Vector {
    let (sin, cos) = angle.sin_cos();
    [d * cos - q * sin, d * sin + q * cos]
}
