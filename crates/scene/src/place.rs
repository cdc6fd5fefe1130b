//! Placements in JSON: `{"translation": [x, y, z], "rotation": [[..], [..], [..]]}`, the matrix row by row.

use blocksim_multibody::Placement;
use nalgebra::Matrix3;
use serde::ser::{SerializeStruct, Serializer};
use serde::{Deserialize, Deserializer};

/// Writes a placement as the members `translation` and `rotation`, to be flattened into what is placed.
pub(crate) fn serialize<S: Serializer>(place: &Placement, serializer: S) -> Result<S::Ok, S::Error> {
    let rows: [[f64; 3]; 3] =
        std::array::from_fn(|row| std::array::from_fn(|column| place.rotation[(row, column)]));
    let translation: [f64; 3] = place.translation.into();
    let mut out = serializer.serialize_struct("Placement", 2)?;
    out.serialize_field("translation", &translation.map(without_sign))?;
    out.serialize_field("rotation", &rows.map(|row| row.map(without_sign)))?;
    out.end()
}

/// Reads a placement from the members `translation` and `rotation`.
pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Placement, D::Error> {
    #[derive(Deserialize)]
    struct Members {
        translation: [f64; 3],
        rotation: [[f64; 3]; 3],
    }
    let Members { translation, rotation } = Members::deserialize(deserializer)?;
    let rotation = Matrix3::from_fn(|row, column| rotation[row][column]);
    Ok(Placement { rotation, translation: translation.into() })
}

/// A zero without a sign, which nobody wants to read.
fn without_sign(x: f64) -> f64 {
    x + 0.0
}
