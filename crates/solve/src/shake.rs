//! Small changes without a pattern, the same on every machine.

/// A number whose bits look random, another one for each number.
///
/// Multiples of an odd number would have a pattern: their second differences are zero, as chains of cells take them.
/// G. Steele, D. Lea, C. Flood: Fast splittable pseudorandom number generators, OOPSLA 2014.
pub(crate) fn mixed(number: u64) -> u64 {
    let mut bits = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// A number from 0.5 to 1.5, another one for each number.
pub(crate) fn part(number: usize) -> f64 {
    0.5 + (mixed(number as u64) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Writes `x` with other last bits to `shaken`, others for each number. Both slices have the same length.
pub fn shake(x: &[f64], number: usize, shaken: &mut [f64]) {
    for (j, (shaken, x)) in shaken.iter_mut().zip(x).enumerate() {
        let up = mixed(((number as u64) << 32) + j as u64) & 1 == 0;
        let sign = if up { 1.0 } else { -1.0 };
        *shaken = x + sign * 2.0 * f64::EPSILON * x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_neighbours_do_not_vanish() {
        let parts: Vec<f64> = (0..10_000).map(part).collect();
        assert!(parts.iter().all(|part| (0.5..1.5).contains(part)));
        for window in parts.windows(4) {
            let [a, b, c, d] = [window[0], window[1], window[2], window[3]];
            assert!((a - b).abs() > 1e-6 && (a - 2.0 * b + c).abs() > 1e-6);
            assert!((a - 3.0 * b + 3.0 * c - d).abs() > 1e-6);
        }
    }

    #[test]
    fn signs_of_neighbours_and_of_repetitions_are_independent() {
        let mut shaken = [vec![0.0; 4000], vec![0.0; 4000]];
        for (number, shaken) in shaken.iter_mut().enumerate() {
            shake(&[1.0; 4000], number, shaken);
        }
        let signs = shaken.map(|shaken| shaken.iter().map(|x| (x - 1.0).signum()).collect::<Vec<_>>());
        let sum = |products: f64| assert!(products.abs() < 4.0 * 4000_f64.sqrt(), "{products}");
        sum(signs[0].iter().sum());
        sum(signs[0].windows(2).map(|pair| pair[0] * pair[1]).sum());
        sum(signs[0].windows(3).map(|three| three[0] * three[2]).sum());
        sum(signs[0].iter().zip(&signs[1]).map(|(a, b)| a * b).sum());
    }
}
