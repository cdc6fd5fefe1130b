//! Real values as differences from a prediction: what is smooth takes fewer bytes, and every bit comes back.
//!
//! The bits of a value are taken as a whole number. Between values of one sign and a similar size these numbers run as smoothly as the
//! values do, so their first, second or third differences are small. Each group of values takes the order of
//! differences that needs the fewest bytes, and all of its differences have the same width. The first three values are as they
//! are; a group begins with a byte that tells order (its upper half) and width in bytes (its lower half).

/// Values of a group.
const GROUP: usize = 128;
/// Values before a group that its differences reach back to.
const BACK: usize = 3;
/// Most bytes that rounding up to whole words adds behind the last difference.
const SLACK: usize = 8;

/// Differences of a group, by their order.
type Differences = [[i64; GROUP]; BACK + 1];

/// Adds the values to `out`, unless they would take as many bytes as they are; returns whether it has.
pub fn encode(values: &[f64], out: &mut Vec<u8>) -> bool {
    let start = out.len();
    let most = start + 8 * values.len();
    let Some((whole, rest)) = values.split_at_checked(BACK) else { return false };
    out.resize(most + 9 * GROUP + SLACK, 0);
    let (mut x, mut differences) = ([0_i64; BACK + GROUP], [[0; GROUP]; BACK + 1]);
    let mut at = start;
    for (x, value) in x.iter_mut().zip(whole) {
        *x = value.to_bits() as i64;
        out[at..at + 8].copy_from_slice(&value.to_le_bytes());
        at += 8;
    }
    for group in rest.chunks(GROUP) {
        for (x, value) in x[BACK..].iter_mut().zip(group) {
            *x = value.to_bits() as i64;
        }
        let n = group.len();
        let (order, width) = best(&x, n, &mut differences);
        out[at] = (order << 4 | width) as u8;
        at += 1;
        // Each as a whole word, of which the next one covers what is too much.
        for difference in &differences[order][..n] {
            out[at..at + 8].copy_from_slice(&folded(*difference).to_le_bytes());
            at += width;
        }
        if at >= most {
            break;
        }
        x.copy_within(n..n + BACK, 0);
    }
    let pays = at < most;
    out.truncate(if pays { at } else { start });
    pays
}

/// Small numbers of both signs as small ones without sign: 0, -1, 1, -2 become 0, 1, 2, 3.
fn folded(difference: i64) -> u64 {
    ((difference << 1) ^ (difference >> 63)) as u64
}

/// The order of differences of the least width, and this width in bytes. The `n` values of a group stand in `x` behind those
/// before it.
fn best(x: &[i64; BACK + GROUP], n: usize, differences: &mut Differences) -> (usize, usize) {
    // Each order is the difference of the one before; what reaches back too far is not used.
    let mut d = *x;
    let mut least = (0, 9);
    for (order, kept) in differences.iter_mut().enumerate() {
        if order > 0 {
            for i in (order..BACK + GROUP).rev() {
                d[i] = d[i].wrapping_sub(d[i - 1]);
            }
        }
        kept.copy_from_slice(&d[BACK..]);
        let bits = kept[..n].iter().fold(0, |bits, difference| bits | (difference ^ (difference >> 63)));
        // One bit more for the sign.
        let width = (65 - u64::leading_zeros(bits as u64) as usize).div_ceil(8);
        let width = if kept[..n].iter().all(|difference| *difference == 0) { 0 } else { width };
        // Of equal widths the lowest order is the quickest to read.
        if width < least.1 {
            least = (order, width);
        }
    }
    least
}

/// Adds `rows` values to `out`; returns whether the bytes were such, exactly.
pub fn decode(bytes: &[u8], rows: usize, out: &mut Vec<f64>) -> bool {
    let Some((whole, mut rest)) = bytes.split_at_checked(8 * BACK).filter(|_| rows >= BACK) else {
        return false;
    };
    let mut back = [0_i64; BACK];
    for (back, value) in back.iter_mut().zip(whole.chunks_exact(8)) {
        *back = i64::from_le_bytes(value.try_into().unwrap_or_default());
        out.push(f64::from_bits(*back as u64));
    }
    let mut x = [0_i64; GROUP];
    for from in (BACK..rows).step_by(GROUP) {
        let n = GROUP.min(rows - from);
        let Some((&tag, after)) = rest.split_first() else { return false };
        let (order, width) = (usize::from(tag >> 4), usize::from(tag & 15));
        if order > BACK || width > 8 || after.len() < width * n {
            return false;
        }
        read(after, width, &mut x[..n]);
        rest = &after[width * n..];
        // The last differences before the group, of each order, which the sums go on from.
        let [a, b, c] = back;
        let slope = c.wrapping_sub(b);
        let before = [c, slope, slope.wrapping_sub(b.wrapping_sub(a))];
        for sum in before[..order].iter().rev() {
            let mut sum = *sum;
            for x in &mut x[..n] {
                sum = sum.wrapping_add(*x);
                *x = sum;
            }
        }
        out.extend(x[..n].iter().map(|&x| f64::from_bits(x as u64)));
        for &x in &x[n.saturating_sub(BACK)..n] {
            back = [back[1], back[2], x];
        }
    }
    rest.is_empty()
}

/// Reads differences of a width that lie one behind the other. There are as many bytes.
fn read(bytes: &[u8], width: usize, into: &mut [i64]) {
    let mask = if width == 8 { u64::MAX } else { (1 << (8 * width)) - 1 };
    for (n, difference) in into.iter_mut().enumerate() {
        let at = n * width;
        let word = match bytes.get(at..at + 8) {
            Some(word) => u64::from_le_bytes(word.try_into().unwrap_or_default()) & mask,
            None => {
                let mut word = [0; 8];
                word[..width].copy_from_slice(&bytes[at..at + width]);
                u64::from_le_bytes(word)
            }
        };
        *difference = (word >> 1) as i64 ^ -((word & 1) as i64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes a value, after all bits have come back.
    fn width(values: &[f64]) -> Option<f64> {
        let mut bytes = vec![7];
        if !encode(values, &mut bytes) {
            assert_eq!(bytes, [7]);
            return None;
        }
        let mut back = vec![0.5];
        assert!(decode(&bytes[1..], values.len(), &mut back));
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back[1..]), bits(values));
        Some((bytes.len() - 1) as f64 / values.len() as f64)
    }

    fn noise(n: usize) -> Vec<f64> {
        let mut bits = 1_u64;
        let mut next = || {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from_bits(bits ^ bits >> 29)
        };
        (0..n).map(|_| next()).collect()
    }

    #[test]
    fn all_bits_come_back_and_what_is_smooth_is_small() {
        let sampled = |f: &dyn Fn(f64) -> f64| (0..1000).map(|k| f(f64::from(k) * 1e-4)).collect::<Vec<_>>();
        assert!(width(&sampled(&|t| t)).unwrap() < 4.0, "times");
        assert!(width(&sampled(&|t| 2.0 + (50.0 * t).sin())).unwrap() < 4.7, "a wave");
        assert!(width(&sampled(&|t| (50.0 * t).sin())).unwrap() < 6.0, "a wave through zero");
        assert!(width(&sampled(&|t| if t < 0.05 { 0.0 } else { -3.0 })).unwrap() < 1.3, "a step");
        assert_eq!(width(&noise(1000)), None);
        let odd = [f64::NAN, -0.0, 0.0, f64::INFINITY, f64::NEG_INFINITY, 5e-324, f64::MAX, f64::MIN];
        let mut long = vec![1.0; 500];
        long.extend(odd);
        assert!(width(&long).unwrap() < 2.5);
        assert_eq!((width(&[]), width(&[1.0, 1.0]), width(&[1.0; 3])), (None, None, None));
        for n in [1, 2, 127, 128, 129, 256, 257] {
            width(&vec![0.1; n]);
            width(&noise(n));
        }
    }

    #[test]
    fn bytes_that_cannot_be_are_refused() {
        let mut bytes = Vec::new();
        assert!(encode(&[1.0; 300], &mut bytes));
        for length in 0..bytes.len() {
            assert!(!decode(&bytes[..length], 300, &mut Vec::new()), "{length}");
        }
        assert!(!decode(&bytes, 800, &mut Vec::new()) && !decode(&bytes, 2, &mut Vec::new()));
        for tag in [0x09, 0x40, 0xff] {
            let mut odd = bytes.clone();
            odd[24] = tag;
            assert!(!decode(&odd, 300, &mut Vec::new()));
        }
    }
}
