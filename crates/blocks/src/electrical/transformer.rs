use blocksim_block::prelude::*;

use super::coupled::Coupled;

/// Transformer with resistances, leakages and a magnetising inductance.
///
/// $$ v_1 = r_1 i_1 + l_1 \frac{di_1}{dt} + l_m \frac{di_m}{dt}, \qquad
///    v_2 = r_2 i_2 + l_2 \frac{di_2}{dt} + \frac{l_m}{n} \frac{di_m}{dt}, \qquad i_m = i_1 + \frac{i_2}{n} $$
///
/// The T circuit with the magnetising inductance $l_m$ on the first side and $n$ the ratio of the turns. Both currents
/// count into the positive pins and are states. No saturation, no losses of the iron (a `Resistor` in parallel to the
/// first winding stands for them). Nothing connects the sides electrically: the circuit of each needs a reference of
/// its own.
///
/// ```ron
/// Transformer(ratio: 10, l_m: "2 H", l1: "5 mH", l2: "50 uH", r1: "0.8 Ohm", r2: "8 mOhm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Transformer)]
pub struct Transformer {
    /// Turns of the first winding over turns of the second; negative for the other sense.
    #[block(
        unit = "1",
        not_zero,
        zero = "write the turns of the first winding over those of the second, negative for the other sense"
    )]
    pub ratio: f64,
    /// Magnetising inductance as seen from the first winding, positive.
    #[block(unit = "H", positive)]
    pub l_m: f64,
    /// Leakage of the first winding; one of both leakages may be zero.
    #[block(unit = "H", not_negative)]
    pub l1: f64,
    /// Leakage of the second winding.
    #[block(unit = "H", not_negative)]
    pub l2: f64,
    /// Resistance of the first winding.
    #[block(unit = "Ohm", not_negative, default = 0.0)]
    pub r1: f64,
    /// Resistance of the second winding.
    #[block(unit = "Ohm", not_negative, default = 0.0)]
    pub r2: f64,
}

impl Transformer {
    fn windings(&self) -> Coupled {
        let (n, l_m) = (self.ratio, self.l_m);
        Coupled { own: [self.l1 + l_m, self.l2 + l_m / (n * n)], mutual: l_m / n, r: [self.r1, self.r2] }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        let relative = self.l1 / self.l_m + self.l2 * self.ratio * self.ratio / self.l_m;
        if relative < 1e-9 {
            let message = "`l1` and `l2` are zero against `l_m`: the two currents are no states of their own";
            let help =
                "give one winding a leakage of some percent, or use an IdealTransformer beside an Inductor";
            errors.add(ParamError::new("l1", message).beside(&["l2", "ratio", "l_m"]).help(help));
        }
    }
}

impl Component for Transformer {
    fn part(&self, _given: &Given) -> Part {
        Coupled::part([0.0; 2])
    }

    fn currents(&self, c: &Moving, i: &mut [f64]) {
        i.copy_from_slice(c.x);
    }

    fn reluctance(&self, c: &Flowing, internal: &mut [f64], inverse: &mut [f64]) {
        let windings = self.windings();
        internal.copy_from_slice(&windings.drop(c.x));
        inverse.copy_from_slice(&windings.inverse());
    }

    fn strike(&self, _c: &Fed, volt_seconds: &[f64], x: &mut [f64]) {
        let change = self.windings().change([volt_seconds[0], volt_seconds[1]]);
        x.iter_mut().zip(change).for_each(|(x, change)| *x += change);
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx.copy_from_slice(&self.windings().slopes(c));
    }

    fn energy(&self, c: &Flowing) -> Energy {
        self.windings().energy(c.x)
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y.copy_from_slice(c.x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leakage_is_needed_on_one_side_only() {
        let both = Transformer { ratio: 10.0, l_m: 2.0, l1: 5e-3, l2: 5e-5, r1: 0.0, r2: 0.0 };
        assert_eq!(Transformer { l1: 0.0, ..both.clone() }.errors()[..], []);
        assert_eq!(Transformer { l2: 0.0, ..both.clone() }.errors()[..], []);
        assert!(Transformer { l1: 0.0, l2: 0.0, ..both.clone() }.errors()[0].help.is_some());
        assert_eq!(Transformer { ratio: 0.0, ..both }.errors()[0].param, "ratio");
    }
}
