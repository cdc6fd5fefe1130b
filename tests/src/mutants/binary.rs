//! Mistakes of disks, networks and wrong lengths.

use super::Dice;

/// Makes one change.
pub(super) fn change(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let at = dice.below(bytes.len());
    let to = (at + 1 + dice.below(64)).min(bytes.len());
    if bytes.is_empty() {
        bytes.push(dice.roll() as u8);
        return;
    }
    match dice.below(10) {
        0 => bytes[at] ^= 1 << dice.below(8),
        1 => bytes[at] = *dice.one(&[0, 1, 0x7F, 0x80, 0xFF]),
        2 if dice.below(4) == 0 => bytes.truncate(at),
        2 | 3 => drop(bytes.drain(at..to)),
        4 => {
            let piece = bytes[at..to].to_vec();
            let elsewhere = dice.below(bytes.len() + 1);
            bytes.splice(elsewhere..elsewhere, piece);
        }
        5 => bytes[at..to].fill(0),
        // A length or a place that is far off.
        6 | 7 => {
            let number: u64 =
                *dice.one(&[0, 1, 0x7FFF_FFFF, 0xFFFF_FFFF, u64::MAX, 1 << 40, 1 << 63, 0xFFFF]);
            let width = *dice.one(&[2, 4, 8]);
            let end = (at + width).min(bytes.len());
            bytes[at..end].copy_from_slice(&number.to_le_bytes()[..end - at]);
        }
        // The heads and tails of formats hold what matters.
        8 => {
            let at = dice.below(bytes.len().min(64));
            bytes[at] = dice.roll() as u8;
        }
        _ => {
            let at = bytes.len() - 1 - dice.below(bytes.len().min(64));
            bytes[at] = dice.roll() as u8;
        }
    }
}
