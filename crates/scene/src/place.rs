//! Placements in JSON: `{"translation": [x, y, z], "rotation": [[..], [..], [..]]}`, the matrix row by row.

use blocksim_multibody::Placement;
use serde::ser::{SerializeStruct, Serializer};

/// Writes a placement as the members `translation` and `rotation`, to be flattened into what is placed.
pub(crate) fn members<S: Serializer>(place: &Placement, serializer: S) -> Result<S::Ok, S::Error> {
    let rows: [[f64; 3]; 3] =
        std::array::from_fn(|row| std::array::from_fn(|column| place.rotation[(row, column)]));
    let translation: [f64; 3] = place.translation.into();
    let mut out = serializer.serialize_struct("Placement", 2)?;
    out.serialize_field("translation", &translation.map(without_sign))?;
    out.serialize_field("rotation", &rows.map(|row| row.map(without_sign)))?;
    out.end()
}

/// A zero without a sign, which nobody wants to read.
fn without_sign(x: f64) -> f64 {
    x + 0.0
}
