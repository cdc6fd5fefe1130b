//! Meshes in few bits.

use serde_json::{Value, json};

use crate::pack::Pack;

/// A mesh whose corners are counted in steps from its lower end.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    /// Where the counting begins, m.
    pub low: [f64; 3],
    /// Length of a step along x, y and z, m.
    pub step: [f64; 3],
    /// Steps along x of all corners, then along y, then along z.
    pub corners: Vec<u16>,
    /// Indices of the first corners of all triangles, then of the second ones, then of the third ones.
    pub triangles: Vec<u32>,
}

impl Surface {
    /// Adds the numbers to a block; what finds them there. Neighbours differ by little: differences compress better.
    pub(crate) fn data(&self, pack: &mut Pack) -> Value {
        let small: Option<Vec<u16>> = self.triangles.iter().map(|index| u16::try_from(*index).ok()).collect();
        let corners = pack.whole(&differences(&self.corners));
        let triangles = match &small {
            Some(indices) => pack.whole(&differences(indices)),
            None => pack.narrow(&self.triangles.iter().map(|index| f64::from(*index)).collect::<Vec<f64>>()),
        };
        json!({
            "low": self.low, "step": self.step, "corners": corners, "triangles": triangles, "small": small.is_some(),
        })
    }
}

/// Meshes as the scripts of the 3D view take them, and the compressed numbers that they point into.
pub fn surfaces(all: &[Surface]) -> (Value, String) {
    let mut pack = Pack::default();
    let data = all.iter().map(|surface| surface.data(&mut pack)).collect();
    (data, pack.finish())
}

/// Each number without the one before it, modulo 65536.
fn differences(values: &[u16]) -> Vec<u16> {
    let before = std::iter::once(&0).chain(values);
    values.iter().zip(before).map(|(value, before)| value.wrapping_sub(*before)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_add_up_to_the_numbers() {
        let values = [5, 3, 65535, 0, 40000, 1];
        let sums = differences(&values).into_iter().scan(0_u16, |sum, x| {
            *sum = sum.wrapping_add(x);
            Some(*sum)
        });
        assert_eq!(sums.collect::<Vec<u16>>(), values);
    }

    #[test]
    fn indices_beyond_16_bits_are_kept_whole() {
        let few = Surface { triangles: vec![0, 1, 2], ..Surface::default() };
        let many = Surface { triangles: vec![0, 1, 70_000], ..Surface::default() };
        assert_eq!(few.data(&mut Pack::default())["small"], true);
        let large = many.data(&mut Pack::default());
        assert_eq!((&large["small"], &large["triangles"]), (&json!(false), &json!([0, 3, 4])));
    }
}
