//! Numbers as one compressed block of bytes, and where each list lies in it.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::{Value, json};

/// Lists of numbers, little endian, the first bytes of all numbers of a list before the second ones, which compresses
/// far better.
#[derive(Default)]
pub struct Pack {
    bytes: Vec<u8>,
}

impl Pack {
    /// Adds a list with 53 bits a number; returns where it is.
    pub fn wide(&mut self, values: &[f64]) -> Value {
        let all: Vec<[u8; 8]> = values.iter().map(|x| x.to_le_bytes()).collect();
        self.list(&all, 8)
    }

    /// Adds a list with 24 bits a number; returns where it is.
    pub fn narrow(&mut self, values: &[f64]) -> Value {
        let all: Vec<[u8; 4]> = values.iter().map(|&x| (x as f32).to_le_bytes()).collect();
        self.list(&all, 4)
    }

    /// Adds a list of whole numbers with 16 bits each; returns where it is.
    pub fn whole(&mut self, values: &[u16]) -> Value {
        let all: Vec<[u8; 2]> = values.iter().map(|x| x.to_le_bytes()).collect();
        self.list(&all, 2)
    }

    fn list<const N: usize>(&mut self, numbers: &[[u8; N]], width: usize) -> Value {
        let at = self.bytes.len();
        for byte in 0..N {
            self.bytes.extend(numbers.iter().map(|number| number[byte]));
        }
        json!([at, numbers.len(), width])
    }

    /// All lists, compressed (zlib), as base64.
    pub fn finish(&self) -> String {
        compressed(&self.bytes)
    }
}

/// Bytes, compressed (zlib), as base64.
pub fn compressed(bytes: &[u8]) -> String {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    // Writing into memory does not fail.
    let compressed = encoder.write_all(bytes).and_then(|()| encoder.finish()).unwrap_or_default();
    STANDARD.encode(compressed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_lie_behind_each_other_byte_by_byte() {
        let mut pack = Pack::default();
        assert_eq!(pack.wide(&[1.0, -1.0]), json!([0, 2, 8]));
        assert_eq!(pack.narrow(&[1.0, 2.0, f64::NAN]), json!([16, 3, 4]));
        assert_eq!(pack.bytes[12..16], [0xf0, 0xf0, 0x3f, 0xbf]);
        assert_eq!(pack.bytes.len(), 28);
        assert_eq!(pack.bytes[25..28], [0x3f, 0x40, 0x7f]);
    }
}
