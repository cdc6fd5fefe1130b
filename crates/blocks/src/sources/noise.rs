use blocksim_block::prelude::*;

/// Random numbers, one at each sample and held until the next: white noise up to half the sample rate.
///
/// Give either the standard deviation `std`, or the power spectral density `power` $S$ of two-sided band-limited white noise,
/// from which it follows: $\sigma = \sqrt{S / T_s}$. `Uniform` numbers lie within $\pm\sqrt{3}\,\sigma$ of the mean.
///
/// The numbers follow from the `seed` of `simulation: (seed: ...)`, that of the block, its place in the model and the number of the
/// sample alone. So a run can be repeated, blocks of one seed are independent of each other, and neither the method nor the steps
/// change anything. Another seed of the run gives other numbers in all blocks, another one of the block in this one.
///
/// ```ron
/// Noise(ts: "1 ms", std: "0.1 deg")
/// ```
///
/// Source: finaliser of SplitMix64 (G. L. Steele, D. Lea, C. H. Flood: Fast splittable pseudorandom number generators, 2014);
/// normal numbers by Box and Muller.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sources", symbol = Curve(Record))]
pub struct Noise {
    /// Sample time $T_s$, positive.
    #[block(unit = "s", positive)]
    pub ts: f64,
    /// Standard deviation; its unit is that of the output.
    #[block(difference, not_negative, default = None)]
    pub std: Option<f64>,
    /// Power spectral density: the square of the unit of the output times s.
    #[block(difference, not_negative, default = None)]
    pub power: Option<f64>,
    /// Mean value, in the unit of the output.
    #[block(finite, default = 0.0)]
    pub mean: f64,
    /// `Gaussian` or `Uniform`.
    #[block(default = Distribution::Gaussian)]
    pub distribution: Distribution,
    /// Chooses the numbers, together with the seed of the run.
    #[block(default = 0)]
    pub seed: u32,
    /// Number of elements; each is independent of the others.
    #[block(at_least = 1, at_most = MOST_ELEMENTS, default = 1)]
    pub width: usize,
    /// Where the block is in the model.
    #[block(skip)]
    path: String,
}

/// How random numbers are distributed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Distribution {
    /// Normally.
    Gaussian,
    /// Equally within limits.
    Uniform,
}

/// Most elements of one block.
const MOST_ELEMENTS: usize = 10_000;

/// A number that depends on each bit of this one, and on nothing else.
fn mixed(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The odd number next to 2^64 over the golden ratio: its multiples are spread evenly.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A number between 0 and 1, neither of them.
fn unit(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) / (1u64 << 52) as f64
}

impl Noise {
    fn std(&self) -> f64 {
        self.std.or(self.power.map(|power| (power / self.ts).sqrt())).unwrap_or(f64::NAN)
    }

    /// What the seed of the run, that of the block and its place make of an element.
    fn stream(&self, run: u64, element: usize) -> u64 {
        // FNV-1a.
        let place = self.path.bytes().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        let seeded = mixed(place ^ mixed(u64::from(self.seed).wrapping_add(GOLDEN)) ^ mixed(run));
        mixed(seeded.wrapping_add((element as u64 + 1).wrapping_mul(GOLDEN)))
    }

    /// The number of a sample, of mean 0 and standard deviation 1.
    fn standard(&self, stream: u64, sample: f64) -> f64 {
        let draw = |k: u64| {
            let count = (sample as u64).wrapping_mul(2).wrapping_add(k + 1);
            unit(mixed(stream.wrapping_add(count.wrapping_mul(GOLDEN))))
        };
        match self.distribution {
            Distribution::Uniform => 3.0_f64.sqrt() * (2.0 * draw(0) - 1.0),
            Distribution::Gaussian => (-2.0 * draw(0).ln()).sqrt() * (std::f64::consts::TAU * draw(1)).cos(),
        }
    }
}

/// Places of the discrete states: the number of the sample, then its random numbers.
const SAMPLE: usize = 0;
const NUMBERS: usize = 1;

impl Noise {
    /// Draws the numbers of a sample.
    fn draw(&self, c: &Context, d: &mut [f64]) {
        let sample = d[SAMPLE];
        let numbers = d[NUMBERS..].iter_mut().enumerate();
        numbers.for_each(|(i, number)| *number = self.standard(self.stream(c.seed, i), sample));
    }

    fn validate(&self, errors: &mut ParamErrors) {
        match (self.std, self.power) {
            (None, None) => {
                let error = ParamError::new("std", "there is neither `std` nor `power`");
                errors.add(error.help("give the standard deviation, as in `std: \"0.1 V\"`"));
            }
            (Some(_), Some(_)) => {
                let error = ParamError::new("power", "both `std` and `power` are given").beside(&["std"]);
                errors.add(error.help("leave one of them out: the other follows"));
            }
            _ => {}
        }
    }
}

impl Block for Noise {
    fn place(&mut self, path: &str) -> bool {
        path.clone_into(&mut self.path);
        true
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let written = |name: &str| given.parameters.written(name);
        let wrong = |message: String| Err(InterfaceError::units(&["y"], message));
        let spread = match (written("std"), written("power")) {
            (Some(std), _) => std,
            (None, Some(power)) if power.is_open() || power == Dimension::NONE => power,
            (None, Some(power)) => match power.over(crate::math::elements::TIME).root(2) {
                Some(dimension) => dimension,
                None => return wrong(format!("`power` is in {power}, which is not a square times s")),
            },
            (None, None) => Dimension::OPEN,
        };
        let mean = written("mean").unwrap_or(Dimension::OPEN);
        let dimension = match spread.meet(mean) {
            Some(dimension) => dimension,
            None if self.mean == 0.0 => spread,
            None => return wrong(format!("`mean` is in {mean}, but the noise is in {spread}")),
        };
        let shape = if self.width == 1 { Shape::Scalar } else { Shape::Vector(self.width) };
        Ok(Interface::new()
            .output(Output::real("y").shape(shape).dimension(Some(dimension)))
            .discrete("sample", 0.0)
            .memory("number", self.width, 0.0)
            .sampled(self.ts))
    }

    fn initialize(&self, c: &Context, _x: &mut [f64], d: &mut [f64]) {
        self.draw(c, d);
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| self.mean + self.std() * l.d()[NUMBERS + i]);
        true
    }

    fn update(&self, c: &Context, _w: &mut Scratch, d: &mut [f64]) {
        d[SAMPLE] += 1.0;
        self.draw(c, d);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    fn noise() -> Noise {
        Noise {
            ts: 0.01,
            std: Some(1.0),
            power: None,
            mean: 0.0,
            distribution: Distribution::Gaussian,
            seed: 1,
            width: 1,
            path: "noise".to_owned(),
        }
    }

    fn samples(block: Noise, n: usize) -> Vec<f64> {
        let mut bench = Bench::new(block);
        (0..n).map(|_| bench.hit()[0]).collect()
    }

    fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
        let n = values.len() as f64;
        values.sum::<f64>() / n
    }

    fn correlation(a: &[f64], b: &[f64]) -> f64 {
        mean(a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<_>>().into_iter())
    }

    const N: usize = 40_000;

    /// Five standard deviations of a mean of `N` numbers.
    fn five_sigma() -> f64 {
        5.0 / (N as f64).sqrt()
    }

    #[test]
    fn moments_and_tails_are_those_of_the_distributions() {
        let gauss = samples(noise(), N);
        assert!(mean(gauss.iter().copied()).abs() < five_sigma());
        assert!((correlation(&gauss, &gauss) - 1.0).abs() < 2.0_f64.sqrt() * five_sigma());
        for (limit, beyond) in [(1.0, 0.317_310_5), (2.0, 0.045_500_3), (3.0, 0.002_699_8)] {
            let found = gauss.iter().filter(|y| y.abs() > limit).count() as f64 / N as f64;
            let deviation = 5.0 * (beyond * (1.0 - beyond) / N as f64).sqrt();
            assert!((found - beyond).abs() < deviation, "beyond {limit}: {found}");
        }
        let uniform = samples(Noise { distribution: Distribution::Uniform, ..noise() }, N);
        let limit = 3.0_f64.sqrt();
        assert!(uniform.iter().all(|y| y.abs() < limit));
        for tenth in 0..10 {
            let low = limit * (f64::from(tenth) / 5.0 - 1.0);
            let found = uniform.iter().filter(|y| (low..low + limit / 5.0).contains(*y)).count();
            assert!((found as f64 / N as f64 - 0.1).abs() < 0.3 * five_sigma(), "tenth {tenth}: {found}");
        }
        assert!((correlation(&uniform, &uniform) - 1.0).abs() < five_sigma());
    }

    #[test]
    fn samples_blocks_seeds_and_elements_are_independent() {
        let one = samples(noise(), N);
        for lag in [1, 2, 3, 7, 100, 4096] {
            assert!(correlation(&one[lag..], &one).abs() < five_sigma() * 1.1, "lag {lag}");
        }
        let mut two = noise();
        two.place("other");
        for other in [two, Noise { seed: 2, ..noise() }, Noise { seed: 0, ..noise() }] {
            assert!(correlation(&samples(other, N), &one).abs() < five_sigma());
        }
        let mut bench = Bench::new(Noise { width: 2, ..noise() });
        let pairs: Vec<Vec<f64>> = (0..N).map(|_| bench.hit()).collect();
        assert!(mean(pairs.iter().map(|pair| pair[0] * pair[1])).abs() < five_sigma());
        assert!(
            pairs.iter().zip(&one).all(|(pair, one)| pair[0] == *one),
            "the first is as if it were alone"
        );
        // The seed of the run chooses among the numbers of all blocks.
        let of_run = |run: u64| {
            let draw = |k| noise().standard(noise().stream(run, 0), f64::from(k));
            (0..N as u32).map(draw).collect::<Vec<f64>>()
        };
        assert_eq!(of_run(0), one);
        for run in [1, 2, u64::MAX] {
            assert!(correlation(&of_run(run), &one).abs() < five_sigma(), "run {run}");
        }
        let mut sorted = one;
        sorted.sort_by(f64::total_cmp);
        assert!(sorted.windows(2).all(|pair| pair[0] < pair[1]), "nothing repeats");
    }

    #[test]
    fn the_spread_follows_from_the_power_and_so_does_the_unit() {
        let power = Noise { std: None, power: Some(0.04), ..noise() };
        assert_eq!(samples(power.clone(), 3), samples(Noise { std: Some(2.0), ..noise() }, 3));
        let unit = |block: &Noise, units: &[(&str, &str)]| {
            block.interface(&given(&[], units)).map(|interface| interface.outputs[0].port_type.dimension)
        };
        assert_eq!(unit(&power, &[("power", "V^2*s")]), Ok(Some(dimension("V"))));
        assert_eq!(unit(&noise(), &[("std", "deg"), ("mean", "rad")]).unwrap(), Some(dimension("rad")));
        assert!(unit(&power, &[("power", "V*s")]).is_err());
        assert!(unit(&Noise { mean: 1.0, ..noise() }, &[("std", "V"), ("mean", "A")]).is_err());
        for (block, param) in [
            (Noise { std: None, ..noise() }, "std"),
            (Noise { power: Some(1.0), ..noise() }, "power"),
            (Noise { std: Some(-1.0), ..noise() }, "std"),
            (Noise { width: 0, ..noise() }, "width"),
        ] {
            assert_eq!(block.errors()[0].param, param);
        }
    }
}
