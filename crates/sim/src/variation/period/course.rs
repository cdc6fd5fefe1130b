//! What becomes of directions between two instants: the linear equations that follow from those of the model along its way.

use blocksim_linear::{DMatrix, Instant, NODES, transition};

/// Parts into which a way is divided at most.
const MOST_PARTS: usize = 64;
/// Part of what an entry is a sum of by which it may differ besides.
const ROUNDING: f64 = 1e-12;

/// How closely slopes are looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Accuracy {
    /// Part of a slope by which two are taken for one.
    same: f64,
    /// Part of an entry by which it may differ where the way is divided twice as finely; the finer one is some sixty times as exact.
    agrees: f64,
}

impl Accuracy {
    const OF_LAWS: Self = Self { same: 1e-14, agrees: 1e-9 };
    pub const OF_DIFFERENCES: Self = Self { same: 1e-10, agrees: 1e-7 };
}

/// `x(end) = phi x(begin) + gamma`, column by column.
pub(super) type Transition = (DMatrix<f64>, DMatrix<f64>);

/// The transition over a way of length `length`, s, from slopes at parts of it, which `at` gives for rising ones, with their accuracy;
/// nothing where no division is fine enough.
///
/// # Errors
/// Those of `at`.
pub(super) fn over<E>(
    length: f64,
    mut at: impl FnMut(&[f64], &mut Accuracy) -> Result<Vec<Instant>, E>,
) -> Result<Option<Transition>, E> {
    let mut coarse: Option<Transition> = None;
    let (mut parts, mut accuracy) = (1, Accuracy::OF_LAWS);
    while parts <= MOST_PARTS {
        let places = (0..parts).flat_map(|part| NODES.map(|node| (part as f64 + node) / parts as f64));
        let places: Vec<f64> = places.collect();
        let mut instants = at(&places, &mut accuracy)?;
        if parts == 1 && is_constant(&instants, accuracy.same) {
            let middle = instants.swap_remove(1);
            let found = transition(&[middle.clone(), middle.clone(), middle], length);
            return Ok(Some(found).filter(is_finite));
        }
        let (fine, sum) = composed(instants, length / parts as f64);
        if !is_finite(&fine) {
            return Ok(None);
        }
        if coarse.is_some_and(|coarse| agree(&coarse, &fine, &sum, accuracy.agrees)) {
            return Ok(Some(fine));
        }
        coarse = Some(fine);
        parts *= 2;
    }
    Ok(None)
}

/// Whether the slopes do not change on the way.
fn is_constant(instants: &[Instant], part: f64) -> bool {
    let same = |a: &DMatrix<f64>, b: &DMatrix<f64>| {
        a.iter().zip(b.iter()).all(|(a, b)| (a - b).abs() <= part * a.abs().max(b.abs()))
    };
    instants.iter().all(|other| same(&other.a, &instants[1].a) && same(&other.b, &instants[1].b))
}

/// Steps behind each other, and the same of the magnitudes of all entries.
fn composed(instants: Vec<Instant>, step: f64) -> (Transition, Transition) {
    let mut instants = instants.into_iter();
    let mut whole: Option<(Transition, Transition)> = None;
    while let (Some(a), Some(b), Some(c)) = (instants.next(), instants.next(), instants.next()) {
        let next = transition(&[a, b, c], step);
        let sizes = (next.0.abs(), next.1.abs());
        let joined = |(phi, gamma): Transition, (a, b): &Transition| (a * phi, a * gamma + b);
        whole = Some(match whole {
            None => (next, sizes),
            Some((values, sums)) => (joined(values, &next), joined(sums, &sizes)),
        });
    }
    whole.unwrap_or_else(|| unreachable!("a way has a part"))
}

fn is_finite((phi, gamma): &Transition) -> bool {
    phi.iter().chain(gamma.iter()).all(|entry| entry.is_finite())
}

fn agree(coarse: &Transition, fine: &Transition, sum: &Transition, part: f64) -> bool {
    let entries = |(phi, gamma): &Transition| phi.iter().chain(gamma.iter()).copied().collect::<Vec<f64>>();
    let (coarse, fine, sum) = (entries(coarse), entries(fine), entries(sum));
    let all = coarse.iter().zip(&fine).zip(&sum);
    all.into_iter().all(|((a, b), sum)| (a - b).abs() <= part * b.abs() + ROUNDING * sum)
}
