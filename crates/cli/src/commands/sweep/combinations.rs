//! Which values the parameters take in each run.

use blocksim_identify::Random;

use crate::args::sweep::{Over, Values};
use crate::failure::Failure;

/// Most runs of one sweep.
pub const MOST: usize = 1_000_000;

/// The runs of a sweep.
pub enum Combinations<'a> {
    /// Each value with each other one; those of the last parameter change first.
    All(&'a [Over]),
    /// Values for each run.
    Random(Vec<Vec<String>>),
}

impl<'a> Combinations<'a> {
    /// All combinations, or so many random ones.
    ///
    /// # Errors
    /// A mistake of the command line.
    pub fn of(over: &'a [Over], random: Option<usize>, seed: u64) -> Result<Combinations<'a>, Failure> {
        if let Some(twice) = named_twice(over) {
            let said = format!("`{twice}` is varied twice");
            return Err(Failure::usage(said).help("write all its values behind one --over"));
        }
        if let Some(runs) = random {
            return match runs <= MOST {
                true => Ok(Combinations::Random(spread(over, runs, seed))),
                false => Err(too_many()),
            };
        }
        if let Some(open) = over.iter().find(|over| matches!(over.values, Values::Between(_))) {
            return Err(Failure::usage(format!("how many values of `{}`?", open.target)).help(
                "write from..to/n, such as 4..16/5, or from..to/nlog for equal factors; --random N takes values from \
                 anywhere between",
            ));
        }
        let runs = over.iter().map(|over| over.listed().len()).try_fold(1_usize, usize::checked_mul);
        match runs.is_some_and(|runs| runs <= MOST) {
            true => Ok(Combinations::All(over)),
            false => Err(too_many()),
        }
    }

    /// Number of runs.
    pub fn runs(&self) -> usize {
        match self {
            Combinations::All(over) => over.iter().map(|over| over.listed().len()).product(),
            Combinations::Random(all) => all.len(),
        }
    }

    /// The values of a run, in the order of the parameters.
    pub fn values(&self, run: usize) -> Vec<&str> {
        let over = match self {
            Combinations::All(over) => over,
            Combinations::Random(all) => return all[run].iter().map(String::as_str).collect(),
        };
        let mut rest = run;
        let value = |over: &'a Over| {
            let listed = over.listed();
            let value = &listed[rest % listed.len()];
            rest /= listed.len();
            value.as_str()
        };
        let mut values: Vec<&str> = over.iter().rev().map(value).collect();
        values.reverse();
        values
    }
}

fn too_many() -> Failure {
    Failure::usage(format!("that would be more than {MOST} runs")).help("take fewer values")
}

fn named_twice(over: &[Over]) -> Option<&str> {
    let twice =
        over.iter().enumerate().find(|(n, one)| over[..*n].iter().any(|other| other.target == one.target));
    twice.map(|(_, over)| over.target.as_str())
}

/// Values of a latin hypercube: of so many equal parts of each range every one is met once, somewhere in it, and which parts
/// meet is random (M. D. McKay, R. J. Beckman, W. J. Conover, 1979).
fn spread(over: &[Over], runs: usize, seed: u64) -> Vec<Vec<String>> {
    let mut random = Random::new(seed);
    let mut all = vec![Vec::with_capacity(over.len()); runs];
    for over in over {
        let mut parts: Vec<usize> = (0..runs).collect();
        for last in (1..runs).rev() {
            parts.swap(last, (random.share() * (last + 1) as f64) as usize);
        }
        for (values, part) in all.iter_mut().zip(parts) {
            values.push(over.at((part as f64 + random.share()) / runs as f64));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn over(target: &str, values: &[&str]) -> Over {
        let values = values.iter().map(|value| (*value).to_owned()).collect();
        Over { target: target.to_owned(), values: Values::Listed(values) }
    }

    fn mistake(over: &[Over]) -> Option<String> {
        Combinations::of(over, None, 0).err().map(|failure| failure.text())
    }

    #[test]
    fn all_combinations_come_and_the_last_parameter_changes_first() {
        let over = [over("a", &["1", "2"]), over("b", &["x", "y", "z"])];
        let all = Combinations::of(&over, None, 0).unwrap_or(Combinations::Random(Vec::new()));
        assert_eq!(all.runs(), 6);
        let texts: Vec<String> = (0..6).map(|n| all.values(n).concat()).collect();
        assert_eq!(texts, ["1x", "1y", "1z", "2x", "2y", "2z"]);
        let twice = [over[0].clone(), over[1].clone(), over[0].clone()];
        assert!(mistake(&twice).is_some_and(|said| said.contains("`a` is varied twice")));
    }

    #[test]
    fn random_values_meet_every_part_of_a_range_and_every_value_of_a_list_alike() {
        let ranges = ["a=0..1", "b=1..1000/log", "kind=x,y"]
            .map(|text| crate::args::sweep::over(text).expect("values"));
        let all = spread(&ranges, 50, 7);
        let numbers = |n: usize| {
            let mut values: Vec<f64> = all.iter().map(|run| run[n].parse().expect("a number")).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        for (part, value) in numbers(0).iter().enumerate() {
            assert!((part as f64..=part as f64 + 1.0).contains(&(value * 50.0)), "{part}: {value}");
        }
        for (part, value) in numbers(1).iter().enumerate() {
            let share = value.log10() / 3.0 * 50.0;
            assert!((part as f64 - 1e-3..=part as f64 + 1.0 + 1e-3).contains(&share), "{part}: {value}");
        }
        assert_eq!(all.iter().filter(|run| run[2] == "x").count(), 25);
        assert_eq!(all, spread(&ranges, 50, 7));
        assert_ne!(all, spread(&ranges, 50, 8));
        // The order of one says nothing of that of the other.
        let rising = all.windows(2).filter(|two| two[0][0] < two[1][0]).count();
        assert!((10..40).contains(&rising), "{rising}");
        assert!(mistake(&ranges).is_some_and(|said| said.contains("write from..to/n")));
    }
}
