use blocksim_block::prelude::*;

/// A pseudo-random binary sequence: `amplitude` or its negative at each sample, from a shift register of maximal length.
///
/// A register of $n$ bits repeats after $2^n - 1$ samples. Over a whole period the sequence has nearly the spectrum of white noise
/// up to half the sample rate: its autocorrelation is 1 at the lag 0 and $-1/(2^n - 1)$ at all others. It excites all frequencies
/// at once, for identification.
///
/// ```ron
/// Prbs(ts: "5 ms", register: 10, amplitude: "2 V")
/// ```
///
/// Source: feedback taps of maximal length from P. Alfke: Efficient shift registers, LFSR counters, and long pseudo-random
/// sequence generators, Xilinx XAPP 052, 1996.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sources", symbol = Curve(Pulse))]
pub struct Prbs {
    /// Sample time, positive: how long each value stands at least.
    #[block(unit = "s", positive)]
    pub ts: f64,
    /// Length $n$ of the register, 2 to 24.
    #[block(at_least = 2, at_most = TAPS.len() + 1, default = 10)]
    pub register: usize,
    /// Half the distance of the two values; its unit is that of the output.
    #[block(difference, finite, default = 1.0)]
    pub amplitude: f64,
    /// Mean of the two values, in the unit of the output.
    #[block(finite, default = 0.0)]
    pub bias: f64,
    /// Where in the sequence it begins: the first contents of the register, 1 to $2^n - 1$.
    #[block(at_least = 1, default = 1, zero = "a register of zeros stays so for ever")]
    pub start: u32,
}

/// Bits that are fed back, counted from 1, for each length of the register from 2 on.
const TAPS: [&[u32]; 23] = [
    &[2, 1],
    &[3, 2],
    &[4, 3],
    &[5, 3],
    &[6, 5],
    &[7, 6],
    &[8, 6, 5, 4],
    &[9, 5],
    &[10, 7],
    &[11, 9],
    &[12, 6, 4, 1],
    &[13, 4, 3, 1],
    &[14, 5, 3, 1],
    &[15, 14],
    &[16, 15, 13, 4],
    &[17, 14],
    &[18, 11],
    &[19, 6, 2, 1],
    &[20, 17],
    &[21, 19],
    &[22, 21],
    &[23, 18],
    &[24, 23, 22, 17],
];

impl Prbs {
    fn validate(&self, errors: &mut ParamErrors) {
        if errors.is_right("register") && u64::from(self.start) >= 1 << self.register {
            let most = (1_u64 << self.register) - 1;
            let message = format!("`start` is {}, but must be from 1 to {most}", self.start);
            let error = ParamError::new("start", message);
            errors.add(error.help(format!("a register of {} bits holds no more", self.register)));
        }
    }
}

impl Block for Prbs {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let parameters = [("amplitude", self.amplitude), ("bias", self.bias)];
        let dimension = crate::math::elements::common_unit(given, &parameters)?;
        let interface = Interface::new().output(Output::real("y").dimension(Some(dimension)));
        let bit = |i: usize| f64::from((self.start >> i) & 1);
        let bits = (0..self.register).fold(interface, |all, i| all.discrete(format!("bit[{i}]"), bit(i)));
        Ok(bits.sampled(self.ts))
    }

    /// Each bit of the register is a discrete state; the last one is what comes out, and the first becomes the sum of those that
    /// are fed back, without carry.
    fn law(&self, l: &Recording) -> bool {
        let bits: Vec<Condition> = l.d().iter().map(|bit| bit.is_true()).collect();
        let [high, low] = [self.amplitude, -self.amplitude].map(|side| l.constant(self.bias + side));
        l.set(0, 0, bits[self.register - 1].select(high, low));
        let fed = TAPS[self.register - 2].iter().map(|tap| bits[*tap as usize - 1]);
        let fed = fed.reduce(|sum, bit| sum.xor(bit));
        fed.into_iter().chain(bits.iter().copied()).take(self.register).enumerate().for_each(|(i, bit)| {
            l.update(i, bit.number());
        });
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    /// The contents of a register after the next shift, as a whole number.
    fn shifted(register: u32, n: usize) -> u32 {
        let fed = TAPS[n - 2].iter().fold(0, |fed, tap| fed ^ (register >> (tap - 1)) & 1);
        ((register << 1) | fed) & ((1 << n) - 1)
    }

    #[test]
    fn every_register_goes_through_all_its_values_before_it_repeats() {
        for n in 2..=TAPS.len() + 1 {
            let (mut register, mut length) = (1, 0_u32);
            loop {
                register = shifted(register, n);
                length += 1;
                if register == 1 {
                    break;
                }
                assert!(register != 0 && length < 1 << n, "{n} bits");
            }
            assert_eq!(length, (1 << n) - 1, "{n} bits");
        }
    }

    #[test]
    fn the_last_bit_of_the_register_comes_out() {
        for n in 2..=TAPS.len() + 1 {
            let mut register = (1 << n) - 2;
            let block = Prbs { ts: 0.1, register: n, amplitude: 2.0, bias: 3.0, start: register };
            let mut bench = Bench::new(block);
            for _ in 0..200 {
                let expected = if register >> (n - 1) == 1 { 5.0 } else { 1.0 };
                assert_eq!(bench.hit(), [expected], "{n} bits");
                register = shifted(register, n);
            }
        }
    }

    #[test]
    fn the_autocorrelation_over_a_period_is_that_of_a_sequence_of_maximal_length() {
        let block = Prbs { ts: 0.1, register: 7, amplitude: 2.0, bias: 3.0, start: 5 };
        let mut bench = Bench::new(block);
        let period = 127;
        let y: Vec<f64> = (0..2 * period).map(|_| (bench.hit()[0] - 3.0) / 2.0).collect();
        assert!(y.iter().all(|y| y.abs() == 1.0) && y[..period] == y[period..]);
        assert_eq!(y[..period].iter().sum::<f64>(), 1.0, "one more of the high values");
        for lag in 1..period {
            let sum: f64 = (0..period).map(|k| y[k] * y[k + lag]).sum();
            assert_eq!(sum, -1.0, "lag {lag}");
        }
    }

    #[test]
    fn registers_that_never_move_are_refused() {
        let block = Prbs { ts: 0.1, register: 4, amplitude: 1.0, bias: 0.0, start: 1 };
        for (block, param) in [
            (Prbs { start: 0, ..block.clone() }, "start"),
            (Prbs { start: 16, ..block.clone() }, "start"),
            (Prbs { register: 1, ..block.clone() }, "register"),
            (Prbs { register: 25, ..block.clone() }, "register"),
            (Prbs { ts: 0.0, ..block }, "ts"),
        ] {
            assert_eq!(block.errors()[0].param, param);
        }
    }
}
