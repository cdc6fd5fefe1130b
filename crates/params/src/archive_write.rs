//! A zip archive from parts: one disk, deflated, no dates, so that the same parts give the same bytes.

use miniz_oxide::deflate::compress_to_vec;

use crate::crc32::crc32;

/// Midnight of 1 January 1980, the zero of the format's calendar.
const DATE: u16 = 0x0021;

/// Packs parts (name, text) of a workbook, 4 GiB at most; the reverse of [`unpack`](crate::unpack).
///
/// Source: APPNOTE.TXT 6.3, sections 4.3.7, 4.3.12 and 4.3.16.
pub fn pack(parts: &[(String, String)]) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, text) in parts {
        let packed = compress_to_vec(text.as_bytes(), 6);
        let start = bytes.len() as u32;
        let mut common = Vec::new();
        // Version 2.0, names in UTF-8, deflated.
        [20, 0x0800, 8, 0, DATE].iter().for_each(|n: &u16| common.extend(n.to_le_bytes()));
        common.extend(crc32(text.as_bytes()).to_le_bytes());
        common.extend((packed.len() as u32).to_le_bytes());
        common.extend((text.len() as u32).to_le_bytes());
        common.extend((name.len() as u16).to_le_bytes());
        common.extend([0, 0]);
        bytes.extend(b"PK\x03\x04");
        bytes.extend(&common);
        bytes.extend(name.as_bytes());
        bytes.extend(packed);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&common);
        directory.extend([0; 10]);
        directory.extend(start.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let start = bytes.len() as u32;
    let count = (parts.len() as u16).to_le_bytes();
    bytes.extend(&directory);
    bytes.extend(b"PK\x05\x06\0\0\0\0");
    bytes.extend(count);
    bytes.extend(count);
    bytes.extend((directory.len() as u32).to_le_bytes());
    bytes.extend(start.to_le_bytes());
    bytes.extend([0, 0]);
    bytes
}
