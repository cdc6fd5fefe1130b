use blocksim_block::prelude::*;

/// Voltage for a frequency at constant flux (V/f law), with a boost for the resistance of the stator at low
/// frequency.
///
/// $$ v = \sqrt{\tfrac23}\, V_n \Bigl(b + (1 - b)\frac{|f|}{f_n}\Bigr) \quad\text{for } |f| \le f_n,
///    \qquad v = \sqrt{\tfrac23}\, V_n \quad\text{above} $$
///
/// The output is the peak phase voltage that an inverter takes. Above the rated frequency the voltage stays
/// and the field weakens. More boost than the resistance asks for saturates a real machine, less lets it pull
/// out at low speed.
///
/// ```ron
/// VoltsPerHertz(v_rated: "220 V", f_rated: "60 Hz", boost: 0.02)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Text("V/f"))]
pub struct VoltsPerHertz {
    /// Rated voltage of the machine, RMS from line to line.
    #[block(unit = "V", not_negative)]
    pub v_rated: f64,
    /// Rated frequency of the machine.
    #[block(unit = "Hz", positive)]
    pub f_rated: f64,
    /// Share of the rated voltage at standstill, 0 to 1.
    #[block(
        at_least = 0.0,
        at_most = 1.0,
        default = 0.0,
        remedy = "divide the voltage at standstill by the rated voltage"
    )]
    pub boost: f64,
}

impl Block for VoltsPerHertz {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(Interface::new()
            .input(Input::real("f").scalar().unit("Hz").doc("frequency; its sign does not matter"))
            .output(Output::real("v").unit("V").doc("amplitude: peak phase voltage")))
    }

    fn law(&self, l: &Recording) -> bool {
        let share = (l.u(0).abs() / self.f_rated).min(l.constant(1.0));
        l.set(0, 0, (2.0_f64 / 3.0).sqrt() * self.v_rated * (self.boost + (1.0 - self.boost) * share));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn the_voltage_rises_from_the_boost_to_the_rated_voltage_and_stays() {
        let law = VoltsPerHertz { v_rated: 220.0, f_rated: 60.0, boost: 0.1 };
        let peak = 220.0 * (2.0_f64 / 3.0).sqrt();
        let given = vec![("f".to_owned(), PortType::scalar())];
        let mut bench = Bench::with_inputs(law, given);
        for (f, share) in [(0.0, 0.1), (30.0, 0.55), (-30.0, 0.55), (60.0, 1.0), (90.0, 1.0)] {
            let v = bench.respond(f);
            assert!((v - share * peak).abs() < 1e-12 * peak, "{f} Hz: {v}");
        }
    }

    #[test]
    fn a_boost_is_a_share() {
        assert_eq!(VoltsPerHertz { v_rated: 220.0, f_rated: 60.0, boost: 12.0 }.errors()[0].param, "boost");
    }
}
