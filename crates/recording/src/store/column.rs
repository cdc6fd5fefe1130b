//! The values of one signal in one chunk, as bytes: the shortest of a few forms that gives back the same bits.

use super::predict;
use crate::recording::Kind;

/// Eight bytes a value.
pub const REAL: u32 = 0;
/// Eight bytes: all values have these bits.
pub const CONSTANT: u32 = 1;
/// One bit a value, the first one lowest: 0 or 1.
pub const BITS: u32 = 2;
/// One signed byte a value.
pub const INT8: u32 = 3;
/// Two bytes a value, signed.
pub const INT16: u32 = 4;
/// Four bytes a value, signed.
pub const INT32: u32 = 5;
/// Differences from a prediction, see [`predict`].
pub const PREDICTED: u32 = 6;

/// Adds the values to `out`; returns the form.
pub fn encode(values: &[f64], kind: Kind, out: &mut Vec<u8>) -> u32 {
    let first = values.first().copied().unwrap_or(0.0).to_bits();
    if values.len() > 1 && values.iter().all(|value| value.to_bits() == first) {
        out.extend(first.to_le_bytes());
        return CONSTANT;
    }
    let form = if kind == Kind::Real { REAL } else { narrowest(values) };
    if form == REAL && predict::encode(values, out) {
        return PREDICTED;
    }
    match form {
        BITS => out.extend(values.chunks(8).map(|eight| {
            eight.iter().enumerate().fold(0, |byte, (at, &value)| byte | u8::from(value == 1.0) << at)
        })),
        // Values are known to fit here.
        INT8 => out.extend(values.iter().map(|&value| value as i8 as u8)),
        INT16 => out.extend(values.iter().flat_map(|&value| (value as i16).to_le_bytes())),
        INT32 => out.extend(values.iter().flat_map(|&value| (value as i32).to_le_bytes())),
        _ => {
            let start = out.len();
            out.resize(start + 8 * values.len(), 0);
            for (bytes, value) in out[start..].chunks_exact_mut(8).zip(values) {
                bytes.copy_from_slice(&value.to_le_bytes());
            }
        }
    }
    form
}

/// The form of fewest bytes; whole numbers that are none, such as -0.0 or NaN, stay as they are.
fn narrowest(values: &[f64]) -> u32 {
    let whole = |value: f64| f64::from(value as i32).to_bits() == value.to_bits();
    if !values.iter().all(|&value| whole(value)) {
        return REAL;
    }
    let within = |low: f64, high: f64| values.iter().all(|&value| low <= value && value <= high);
    match () {
        () if within(0.0, 1.0) => BITS,
        () if within(-128.0, 127.0) => INT8,
        () if within(-32768.0, 32767.0) => INT16,
        () => INT32,
    }
}

/// Whether `rows` values can take so many bytes in a form; unknown forms cannot.
pub fn can_have(form: u32, rows: usize, bytes: usize) -> bool {
    match form {
        REAL => bytes == 8 * rows,
        CONSTANT => bytes == 8,
        BITS => bytes == rows.div_ceil(8),
        INT8 => bytes == rows,
        INT16 => bytes == 2 * rows,
        INT32 => bytes == 4 * rows,
        PREDICTED => bytes < 8 * rows,
        _ => false,
    }
}

/// Adds `rows` values to `out`; returns whether the bytes were such. There must be as many as the form [`can_have`].
pub fn decode(form: u32, bytes: &[u8], rows: usize, out: &mut Vec<f64>) -> bool {
    let real = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().unwrap_or_default());
    match form {
        CONSTANT => out.resize(out.len() + rows, real(bytes)),
        BITS => out.extend((0..rows).map(|row| f64::from(bytes[row / 8] >> (row % 8) & 1))),
        INT8 => out.extend(bytes.iter().map(|&byte| f64::from(byte as i8))),
        INT16 => out.extend(bytes.chunks_exact(2).map(|b| f64::from(i16::from_le_bytes([b[0], b[1]])))),
        INT32 => {
            let whole = |b: &[u8]| f64::from(i32::from_le_bytes([b[0], b[1], b[2], b[3]]));
            out.extend(bytes.chunks_exact(4).map(whole));
        }
        PREDICTED => return predict::decode(bytes, rows, out),
        _ => out.extend(bytes.chunks_exact(8).map(real)),
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_gives_back_the_same_bits_and_is_chosen_where_it_fits() {
        let cases: [(&[f64], Kind, u32); 12] = [
            (&[0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], Kind::Bool, BITS),
            (&[-128.0, 127.0], Kind::Int, INT8),
            (&[-129.0, 127.0], Kind::Int, INT16),
            (&[0.0, 32768.0], Kind::Int, INT32),
            (&[0.0, -2147483648.0], Kind::Int, INT32),
            (&[0.0, 2147483648.0], Kind::Int, REAL),
            (&[0.0, -0.0], Kind::Int, REAL),
            (&[1.0, f64::NAN], Kind::Bool, REAL),
            (&[0.5, 1e300, f64::NEG_INFINITY, -5e-324], Kind::Real, REAL),
            (&[-0.0, -0.0, -0.0], Kind::Real, CONSTANT),
            (&[2.0, 3.0, 2.5, 2.0, 1.5, 1.0, 0.5, 0.25], Kind::Real, PREDICTED),
            (&[], Kind::Real, REAL),
        ];
        for (values, kind, form) in cases {
            let mut bytes = Vec::new();
            assert_eq!(encode(values, kind, &mut bytes), form, "{values:?}");
            assert!(can_have(form, values.len(), bytes.len()), "{values:?}");
            let mut back = Vec::new();
            assert!(decode(form, &bytes, values.len(), &mut back), "{values:?}");
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&back), bits(values));
        }
    }
}
