//! Mistakes inside of a workbook: its parts are unpacked, damaged and packed again, so that what reads them is reached.

use blocksim_params::{pack, unpack};

use super::{Dice, binary, text};

/// Makes one change in a part, or to the list of parts.
pub(super) fn change(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let Ok(parts) = unpack(bytes) else { return binary::change(bytes, dice) };
    let mut parts: Vec<(String, Vec<u8>)> =
        parts.into_iter().map(|(name, text)| (name, text.into_bytes())).collect();
    if parts.is_empty() {
        return;
    }
    let at = dice.below(parts.len());
    match dice.below(12) {
        0 => drop(parts.remove(at)),
        1 => parts[at].1.clear(),
        2 => {
            let other = dice.below(parts.len());
            parts[at].1 = parts[other].1.clone();
        }
        3 => {
            let mut name = std::mem::take(&mut parts[at].0).into_bytes();
            text::change(&mut name, dice);
            // No name is longer than the format allows.
            name.truncate(1000);
            parts[at].0 = String::from_utf8_lossy(&name).into_owned();
        }
        4 => references(&mut parts[at].1, dice),
        _ => text::change(&mut parts[at].1, dice),
    }
    // Two parts of one name cannot be packed; the mutant stays as it was.
    if let Ok(packed) = pack(&parts) {
        *bytes = packed;
    }
}

/// Puts the value of one attribute in the place of another: a reference to another cell, sheet, style or string.
fn references(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let quotes: Vec<usize> = (0..bytes.len()).filter(|at| bytes[*at] == b'"').collect();
    let values: Vec<std::ops::Range<usize>> =
        quotes.chunks_exact(2).map(|pair| pair[0] + 1..pair[1]).collect();
    if !values.is_empty() {
        let value = bytes[dice.one(&values).clone()].to_vec();
        bytes.splice(dice.one(&values).clone(), value);
    }
}
