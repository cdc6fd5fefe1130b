use std::f64::consts::TAU;

use blocksim_block::prelude::*;

use crate::continuous::{AntiWindup, Form, Pid, PidLaw, Reset};

/// Speed control of an asynchronous machine by its slip, for an inverter with constant volts per hertz.
///
/// $$ f_s = \operatorname{sat}(k_p e + k_i \int e \, dt), \qquad e = w_{ref} - w, \qquad
///    f = N w/(2\pi) + f_s $$
///
/// $N$ is the number of pole pairs. At constant flux the torque of the machine is nearly proportional to the slip
/// frequency $f_s$, so its limit $\pm$ `slip_limit` limits torque and current and keeps the machine from pulling out.
/// Outside the limit the integral part stops, unless the error leads back (as `Pid` with `Clamping`). Connect `f` to
/// `VoltsPerHertz` for the voltage, and to `AveragedInverter` or `PhaseReference`. A negative frequency turns the other
/// way.
///
/// A good limit is the slip frequency of the rated point, $f_n s_n$, or a little more.
///
/// Source: B. K. Bose, *Modern Power Electronics and AC Drives*, chapter 8.
///
/// ```ron
/// SlipControlledVf(pole_pairs: 2, kp: 0.2, ki: 1.0, slip_limit: "3 Hz")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Text("V/f, slip"))]
pub struct SlipControlledVf {
    /// Pole pairs $N$ of the machine, at least 1.
    #[block(at_least = 1, zero = "a machine of 50 Hz that runs at 1500 rpm without load has 2")]
    pub pole_pairs: u32,
    /// Proportional gain $k_p$: slip frequency for an error of the speed.
    #[block(unit = "Hz*s/rad", not_negative)]
    pub kp: f64,
    /// Integral gain $k_i$.
    #[block(unit = "Hz/rad", not_negative, default = 0.0)]
    pub ki: f64,
    /// Largest slip frequency, motoring and generating.
    #[block(
        unit = "Hz",
        positive,
        remedy = "without slip there is no torque: take the slip frequency of the rated point"
    )]
    pub slip_limit: f64,
}

const W_REF: usize = 0;
const W: usize = 1;

const F: usize = 0;
const SLIP: usize = 1;

impl SlipControlledVf {
    /// The controller of the slip frequency.
    fn pi(&self) -> Pid {
        let law = PidLaw {
            kp: self.kp,
            ki: self.ki,
            kd: 0.0,
            n: 1.0,
            form: Form::Parallel,
            lower: Some(-self.slip_limit),
            upper: Some(self.slip_limit),
            external_limits: false,
            anti_windup: AntiWindup::Clamping,
            kb: 1.0,
            x0: 0.0,
            d0: 0.0,
        };
        Pid { law, reset: Reset::None }
    }
}

impl Block for SlipControlledVf {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let pi = self.pi().interface(&Given::nothing())?;
        Ok(Interface {
            states: pi.states,
            discrete: pi.discrete,
            guards: pi.guards,
            settles: pi.settles,
            ..Interface::new()
                .input(Input::real("w_ref").scalar().unit("rad/s").doc("set speed"))
                .input(Input::real("w").scalar().unit("rad/s").doc("speed of the rotor"))
                .output(Output::real("f").unit("Hz").doc("frequency of the stator; may be negative"))
                .output(Output::real("slip").unit("Hz").doc("slip frequency"))
        })
    }

    fn law(&self, l: &Recording) -> bool {
        let slip = self.pi().record(l, 0, l.u(W_REF) - l.u(W));
        l.set(SLIP, 0, slip);
        l.set(F, 0, f64::from(self.pole_pairs) * l.u(W) / TAU + slip);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    const CONTROL: SlipControlledVf = SlipControlledVf { pole_pairs: 2, kp: 0.2, ki: 1.0, slip_limit: 3.0 };

    #[test]
    fn without_error_the_field_turns_with_the_rotor() {
        let mut bench = Bench::new(CONTROL);
        let y = bench.set(W_REF, &[150.0]).set(W, &[150.0]).major();
        assert!((y[F] - 300.0 / TAU).abs() < 1e-12 && y[SLIP] == 0.0);
    }

    #[test]
    fn the_slip_is_proportional_and_integral_and_limited() {
        let mut bench = Bench::new(CONTROL);
        bench.set(W_REF, &[152.0]).set(W, &[150.0]).major();
        bench.integrate(0.5, 50);
        let y = bench.major();
        assert!((y[SLIP] - (0.4 + 1.0)).abs() < 1e-12, "{y:?}");
        assert!((y[F] - y[SLIP] - 300.0 / TAU).abs() < 1e-12);
        assert_eq!(bench.set(W_REF, &[300.0]).major()[SLIP], 3.0);
        assert_eq!(bench.set(W_REF, &[-300.0]).major()[SLIP], -3.0);
    }

    #[test]
    fn at_the_limit_nothing_winds_up() {
        let mut bench = Bench::new(CONTROL);
        bench.set(W_REF, &[150.0]).set(W, &[0.0]).major();
        bench.integrate(10.0, 1000);
        // As soon as the error is gone, so is the slip.
        assert_eq!(bench.set(W, &[150.0]).major()[SLIP], 0.0);
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let refused = |control: SlipControlledVf| control.errors()[0].param.clone();
        assert_eq!(refused(SlipControlledVf { pole_pairs: 0, ..CONTROL }), "pole_pairs");
        assert_eq!(refused(SlipControlledVf { kp: -1.0, ..CONTROL }), "kp");
        assert_eq!(refused(SlipControlledVf { ki: f64::NAN, ..CONTROL }), "ki");
        assert_eq!(refused(SlipControlledVf { slip_limit: 0.0, ..CONTROL }), "slip_limit");
        assert!(SlipControlledVf { kp: 0.0, ki: 0.0, ..CONTROL }.errors().is_empty());
    }
}
