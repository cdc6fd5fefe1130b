use blocksim_block::prelude::*;

use super::coupled::Coupled;

/// Two coils that share a part of their flux.
///
/// $$ v_1 = L_1 \frac{di_1}{dt} + M \frac{di_2}{dt}, \qquad
///    v_2 = M \frac{di_1}{dt} + L_2 \frac{di_2}{dt}, \qquad M = k \sqrt{L_1 L_2} $$
///
/// Both currents are states. Where both are positive the fluxes add up; exchange the pins of one coil for the other
/// sense. Nothing connects the coils electrically: the circuit of each needs a reference of its own.
///
/// ```ron
/// MutualInductance(l1: "10 mH", l2: "2.5 mH", k: 0.95)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Transformer)]
pub struct MutualInductance {
    /// Inductance of the first coil while the other is open, positive.
    #[block(unit = "H", positive)]
    pub l1: f64,
    /// Inductance of the second coil while the other is open, positive.
    #[block(unit = "H", positive)]
    pub l2: f64,
    /// Coupling factor, from 0 (none) to less than 1 (no leakage).
    #[block(
        unit = "1",
        not_negative,
        below = 1.0,
        remedy = "coils without leakage are an IdealTransformer beside an Inductor"
    )]
    pub k: f64,
    /// Current of the first coil at the start.
    #[block(unit = "A", finite, default = 0.0)]
    pub i1_0: f64,
    /// Current of the second coil at the start.
    #[block(unit = "A", finite, default = 0.0)]
    pub i2_0: f64,
}

impl MutualInductance {
    fn coils(&self) -> Coupled {
        let mutual = self.k * (self.l1 * self.l2).sqrt();
        Coupled { own: [self.l1, self.l2], mutual, r: [0.0; 2] }
    }
}

impl Component for MutualInductance {
    fn part(&self, _given: &Given) -> Part {
        Coupled::part([self.i1_0, self.i2_0])
    }

    fn currents(&self, c: &Moving, i: &mut [f64]) {
        i.copy_from_slice(c.x);
    }

    fn reluctance(&self, _c: &Flowing, _internal: &mut [f64], inverse: &mut [f64]) {
        inverse.copy_from_slice(&self.coils().inverse());
    }

    fn strike(&self, _c: &Fed, volt_seconds: &[f64], x: &mut [f64]) {
        let change = self.coils().change([volt_seconds[0], volt_seconds[1]]);
        x.iter_mut().zip(change).for_each(|(x, change)| *x += change);
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx.copy_from_slice(&self.coils().slopes(c));
    }

    fn energy(&self, c: &Flowing) -> Energy {
        self.coils().energy(c.x)
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y.copy_from_slice(c.x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coupling_without_leakage_is_refused_with_advice() {
        let coils = MutualInductance { l1: 1.0, l2: 1.0, k: 1.0, i1_0: 0.0, i2_0: 0.0 };
        let error = coils.errors()[0].clone();
        assert!(error.param == "k" && error.help.is_some());
        assert_eq!(MutualInductance { k: 0.0, ..coils.clone() }.errors()[..], []);
        assert_eq!(MutualInductance { l2: 0.0, ..coils }.errors()[0].param, "l2");
    }
}
