use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Resistance, inductance and capacitance in series, the same in each of three phases.
///
/// $$ v = R i + L \frac{di}{dt} + v_C, \qquad C \frac{dv_C}{dt} = i $$
///
/// Leave out what is not there: a line is `r` and `l`, a load with a `FloatingNeutral` or a `PhasePermute` behind it
/// stands in star or delta. Currents of inductances and voltages of capacitances are states; in a star whose point
/// floats, currents given for the start must add up to zero.
///
/// ```ron
/// ThreePhaseRlc(r: "0.1 Ohm", l: "2 mH")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Three-phase", symbol = Text("R L C"))]
pub struct ThreePhaseRlc {
    /// Resistance of a phase; zero for none.
    #[block(unit = "Ohm", not_negative, default = 0.0)]
    pub r: f64,
    /// Inductance of a phase; zero for none.
    #[block(unit = "H", not_negative, default = 0.0)]
    pub l: f64,
    /// Capacitance of a phase; without it the current passes.
    #[block(unit = "F", positive, default = None, remedy = "leave `c` out where there is no capacitor")]
    pub c: Option<f64>,
    /// Currents of the inductances at the start. Where none are given they follow from the inductances in series with them, else
    /// zero.
    #[block(unit = "A", finite, default = None)]
    pub i0: Option<[f64; 3]>,
    /// Voltages of the capacitances at the start. Where none are given they follow from ideal voltages around them,
    /// else zero.
    #[block(unit = "V", finite, default = None)]
    pub v0: Option<[f64; 3]>,
}

impl ThreePhaseRlc {
    /// Elements in series in each phase.
    fn count(&self) -> usize {
        usize::from(self.r > 0.0) + self.windings() + self.capacitances()
    }

    fn windings(&self) -> usize {
        usize::from(self.l > 0.0)
    }

    fn capacitances(&self) -> usize {
        usize::from(self.c.is_some())
    }

    /// Where the voltages of the capacitances lie among the states.
    fn first_voltage(&self) -> usize {
        3 * self.windings()
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.count() == 0 {
            let message = "`r` and `l` are zero, and there is no `c`: this is a wire";
            errors.add(ParamError::new("r", message).beside(&["l"]).help("join the two ports instead"));
        }
        if self.l == 0.0 && self.i0.is_some() {
            let error = ParamError::new("i0", "`i0` is given, but without `l` no current is a state");
            errors.add(error.help("leave `i0` out, or give `l`"));
        }
        if self.c.is_none() && self.v0.is_some() {
            let error = ParamError::new("v0", "`v0` is given, but without `c` no voltage is a state");
            errors.add(error.help("leave `v0` out, or give `c`"));
        }
    }
}

impl Component for ThreePhaseRlc {
    fn part(&self, _given: &Given) -> Part {
        let current = Output::real("i").shape(Shape::Vector(3)).unit("A").doc("currents from ac1 to ac2");
        let needs = if self.windings() > 0 { Needs::State } else { Needs::Electrics };
        let mut part = Part::new()
            .port("ac1", Domain::ThreePhase, "one end")
            .port("ac2", Domain::ThreePhase, "the other")
            .output(current, needs);
        let phases = ["a", "b", "c"];
        let winding_states = phases.iter().zip(self.i0.unwrap_or([0.0; 3])).filter(|_| self.windings() > 0);
        part = winding_states.fold(part, |part, (phase, i)| part.state(&format!("i_{phase}"), i));
        let voltage_states =
            phases.iter().zip(self.v0.unwrap_or([0.0; 3])).filter(|_| self.capacitances() > 0);
        part = voltage_states.fold(part, |part, (phase, v)| part.state(&format!("v_{phase}"), v));
        part.currents_follow = self.i0.is_none();
        let count = self.count();
        for k in 0..3 {
            // Pin before the element at this place of the series.
            let pin = |place: usize| match place {
                0 => Pin::Phase(0, k),
                last if last == count => Pin::Phase(1, k),
                inner => Pin::Inner((count - 1) * k + inner - 1),
            };
            let mut elements = Vec::new();
            let mut next = || {
                elements.push(());
                (pin(elements.len() - 1), pin(elements.len()))
            };
            if self.l > 0.0 {
                let (p, n) = next();
                part = part.element(Element::Winding { p, n, from_state: true });
            }
            if self.r > 0.0 {
                let (p, n) = next();
                part = part.element(Element::Resistance { p, n, resistance: self.r });
            }
            if let Some(capacitance) = self.c {
                let (p, n) = next();
                let (state, start) = (self.first_voltage() + k, self.v0.map(|v0| v0[k]));
                part = part.element(Element::Capacitance { p, n, capacitance, state, start });
            }
        }
        part
    }

    fn voltages(&self, c: &Moving, v: &mut [f64]) {
        v.copy_from_slice(&c.x[self.first_voltage()..]);
    }

    fn currents(&self, c: &Moving, i: &mut [f64]) {
        i.copy_from_slice(&c.x[..3]);
    }

    fn reluctance(&self, _c: &Flowing, _internal: &mut [f64], inverse: &mut [f64]) {
        (0..3).for_each(|k| inverse[4 * k] = 1.0 / self.l);
    }

    fn strike(&self, _c: &Fed, volt_seconds: &[f64], x: &mut [f64]) {
        x.iter_mut().zip(volt_seconds).for_each(|(i, v)| *i += v / self.l);
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        let (count, first) = (self.count(), self.first_voltage());
        for k in 0..3 {
            // The winding is the first of a phase, the capacitance the last.
            if self.windings() > 0 {
                dx[k] = c.voltage[count * k] / self.l;
            }
            if let Some(capacitance) = self.c {
                dx[first + k] = c.current[count * k + count - 1] / capacitance;
            }
        }
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let (currents, voltages) = c.x.split_at(self.first_voltage());
        let square = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
        Energy::stored(0.5 * (self.l * square(currents) + self.c.unwrap_or(0.0) * square(voltages)))
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y.iter_mut().zip(c.x).for_each(|(y, i)| *y = *i);
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        let count = self.count();
        y.iter_mut().enumerate().for_each(|(k, y)| *y = c.current[count * k]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: ThreePhaseRlc = ThreePhaseRlc { r: 0.1, l: 1e-3, c: None, i0: None, v0: None };

    #[test]
    fn what_is_not_there_is_no_element() {
        let elements =
            |rlc: &ThreePhaseRlc| rlc.component().map(|c| c.part(&Given::default()).elements.len());
        assert_eq!(elements(&LINE), Some(6));
        assert_eq!(elements(&ThreePhaseRlc { r: 0.0, ..LINE }), Some(3));
        assert_eq!(elements(&ThreePhaseRlc { c: Some(1e-6), ..LINE }), Some(9));
    }

    #[test]
    fn a_wire_and_start_values_of_nothing_are_refused() {
        let refused = |rlc: ThreePhaseRlc| rlc.errors()[0].clone();
        assert!(refused(ThreePhaseRlc { r: 0.0, l: 0.0, ..LINE }).help.is_some());
        assert_eq!(refused(ThreePhaseRlc { l: 0.0, i0: Some([1.0, -1.0, 0.0]), ..LINE }).param, "i0");
        assert_eq!(refused(ThreePhaseRlc { v0: Some([1.0, 0.0, 0.0]), ..LINE }).param, "v0");
        assert_eq!(refused(ThreePhaseRlc { c: Some(0.0), ..LINE }).param, "c");
    }
}
