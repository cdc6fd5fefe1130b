use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use blocksim_block::prelude::*;

/// Commands for the two phases of a stepper motor: voltages or currents, whichever unit `amplitude` has.
///
/// It counts positions $n$; the field stands at the electrical angle $\varphi = n\,\pi/(2m)$, with $m$ positions in a full
/// step, and the rotor follows to $\theta = \varphi/N$:
///
/// | `drive` | $m$ | phases $(a, b)$ |
/// |---|---|---|
/// | `Wave` | 1 | one at a time: $A (\cos\varphi, \sin\varphi)$ |
/// | `Full` | 1 | always both, half a step ahead: $A (\pm1, \pm1)$, $\varphi + \pi/4$ |
/// | `Half` | 2 | one and both in turn: $A$ or $-A$ or 0 |
/// | `Micro(m)` | $m$ | $A (\cos\varphi, \sin\varphi)$ |
///
/// With `command: Pulses` each rise of `step` counts one position, down while `reverse` is true. With
/// `command: Angle(teeth: ..)` the position is the one at which the field stands nearest to the input `angle` of the rotor
/// (with `Full` half a step beside the full steps); the solver stops halfway between two of them. For a commanded speed, integrate it to an angle. A motor that cannot follow loses steps: nothing
/// looks whether it does.
///
/// Give the outputs to two `ControlledVoltageSource`, or compare them with the currents of the motor.
///
/// ```ron
/// StepperDriver(amplitude: "2.4 V", drive: Half, command: Angle(teeth: 50))
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Text("steps"))]
pub struct StepperDriver {
    /// Command of a phase that conducts fully, $A$; the outputs have its unit.
    #[block(difference, finite)]
    pub amplitude: f64,
    /// `Wave`, `Full`, `Half` or `Micro(..)`.
    #[block(default = Drive::Full)]
    pub drive: Drive,
    /// `Pulses` or `Angle(teeth: ..)`.
    #[block(default = Command::Pulses)]
    pub command: Command,
}

/// In which positions a stepper driver holds the field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Drive {
    /// Full steps, one phase at a time.
    Wave,
    /// Full steps, both phases at a time.
    #[default]
    Full,
    /// Half steps.
    Half,
    /// So many microsteps in a full step, at least 1.
    Micro(u32),
}

/// What a stepper driver follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Command {
    /// Pulses and a direction.
    #[default]
    Pulses,
    /// The angle of the rotor.
    Angle {
        /// Teeth of the rotor of the motor.
        teeth: u32,
    },
}

impl Drive {
    /// Positions in a full step.
    fn positions(self) -> u32 {
        match self {
            Self::Wave | Self::Full => 1,
            Self::Half => 2,
            Self::Micro(m) => m,
        }
    }

    /// How far the field stands ahead of a position, in positions.
    fn ahead(self) -> f64 {
        if self == Self::Full { 0.5 } else { 0.0 }
    }

    /// Shares of the amplitude of both phases at a position.
    fn phases<'r>(self, l: &Recording<'r>, n: Value<'r>) -> [Value<'r>; 2] {
        // The turn of four full steps is reduced first, so that many positions lose no digits.
        let turn = 4.0 * f64::from(self.positions());
        let phi = (n - turn * (n / turn).below()) * FRAC_PI_2 / f64::from(self.positions());
        let sign = |x: Value<'r>| {
            let is_zero = x.abs().live(Relation::Less, l.constant(1e-9));
            is_zero.select(l.constant(0.0), x.signum())
        };
        match self {
            Self::Full => [(phi + FRAC_PI_4).cos(), (phi + FRAC_PI_4).sin()].map(sign),
            Self::Wave | Self::Half => [phi.cos(), phi.sin()].map(sign),
            Self::Micro(_) => [phi.cos(), phi.sin()],
        }
    }
}

/// Inputs with `Pulses`; with `Angle` there is one.
const STEP: usize = 0;
const REVERSE: usize = 1;

/// Discrete states: the position, and whether `step` was true.
const N: usize = 0;
const WAS: usize = 1;

impl StepperDriver {
    /// The position, not rounded, at which the field stands at an angle of the rotor.
    fn wanted<'r>(&self, angle: Value<'r>, teeth: u32) -> Value<'r> {
        angle * f64::from(teeth) * f64::from(self.drive.positions()) / FRAC_PI_2 - self.drive.ahead()
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.drive == Drive::Micro(0) {
            errors.add(
                ParamError::new("drive", "`Micro(0)` leaves no position to go to")
                    .help("write the microsteps in a full step: `Micro(16)`"),
            );
        }
        if self.command == (Command::Angle { teeth: 0 }) {
            errors.add(
                ParamError::new("command.teeth", "`teeth` is 0, but the rotor of a stepper motor has teeth")
                    .help("90 degrees over the step angle: 50 for steps of 1.8 degrees"),
            );
        }
    }
}

impl Block for StepperDriver {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let phase = |name| Output::real(name).dimension(Some(given.parameters.get("amplitude")));
        let interface = match self.command {
            Command::Pulses => Interface::new()
                .input(Input::boolean("step").scalar().doc("each rise counts a position"))
                .input(Input::boolean("reverse").scalar().default(0.0).doc("counts down")),
            Command::Angle { .. } => Interface::new()
                .input(Input::real("angle").scalar().unit("rad").doc("set angle of the rotor"))
                .guard("above")
                .called("steps forward", "steps forward")
                .guard("below")
                .called("steps backward", "steps backward"),
        };
        Ok(interface
            .output(phase("a").doc("command for phase A"))
            .output(phase("b").doc("command for phase B"))
            .output(Output::real("position").unit("1").doc("positions counted"))
            .discrete("position", 0.0)
            .discrete("step", 0.0))
    }

    fn law(&self, l: &Recording) -> bool {
        let (n, [zero, one]) = (l.d()[N], [0.0, 1.0].map(|value| l.constant(value)));
        for (port, phase) in self.drive.phases(l, n).into_iter().enumerate() {
            l.set(port, 0, self.amplitude * phase);
        }
        l.set(2, 0, n);
        match self.command {
            Command::Pulses => {
                let is_on = l.u(STEP).live(Relation::NotEqual, zero);
                let rises = is_on.and(l.d()[WAS].live(Relation::Equal, zero));
                let by = l.u(REVERSE).live(Relation::Equal, zero).select(one, -one);
                l.settle(N, rises.select(n + by, n));
                l.settle(WAS, is_on.number());
            }
            Command::Angle { teeth } => {
                let wanted = self.wanted(l.u(0), teeth);
                let ahead = wanted - n;
                // Neither NaN nor a tie moves the motor.
                let moves = ahead.abs().live(Relation::Greater, l.constant(0.5));
                l.settle(N, moves.select(wanted.nearest(), n));
                l.guard(0, ahead - 0.5);
                l.guard(1, ahead + 0.5);
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use blocksim_block::testing::Bench;

    const DRIVER: StepperDriver =
        StepperDriver { amplitude: 2.0, drive: Drive::Full, command: Command::Pulses };

    /// Phases after each of eight pulses.
    fn pulses(drive: Drive, reverse: f64) -> Vec<[f64; 2]> {
        let mut bench = Bench::new(StepperDriver { drive, ..DRIVER });
        bench.set(REVERSE, &[reverse]);
        (0..8)
            .map(|_| {
                bench.set(STEP, &[0.0]).major();
                let y = bench.set(STEP, &[1.0]).major();
                // A pulse that goes on counts once.
                assert_eq!(bench.major(), y);
                [y[0], y[1]]
            })
            .collect()
    }

    #[test]
    fn the_phases_follow_each_other_as_in_the_tables() {
        let full = [[-2.0, 2.0], [-2.0, -2.0], [2.0, -2.0], [2.0, 2.0]];
        let wave = [[0.0, 2.0], [-2.0, 0.0], [0.0, -2.0], [2.0, 0.0]];
        let half = [[2.0, 2.0], [0.0, 2.0], [-2.0, 2.0], [-2.0, 0.0], [-2.0, -2.0], [0.0, -2.0], [2.0, -2.0]];
        assert_eq!(pulses(Drive::Full, 0.0)[..4], full);
        assert_eq!(pulses(Drive::Full, 0.0)[4..], full);
        assert_eq!(pulses(Drive::Wave, 0.0)[..4], wave);
        assert_eq!(pulses(Drive::Half, 0.0)[..7], half);
        assert_eq!(pulses(Drive::Wave, 1.0)[..3], [wave[2], wave[1], wave[0]]);
    }

    #[test]
    fn microsteps_go_round_a_circle() {
        for (k, [a, b]) in pulses(Drive::Micro(5), 0.0).into_iter().enumerate() {
            let phi = (k as f64 + 1.0) * PI / 10.0;
            assert!((a - 2.0 * phi.cos()).abs() < 1e-14 && (b - 2.0 * phi.sin()).abs() < 1e-14, "{k}");
        }
        // After a hundred million turns the phases are the same bits.
        let mut bench = Bench::new(StepperDriver { drive: Drive::Micro(5), ..DRIVER });
        let mut phases = |n: f64| {
            bench.d[N] = n;
            bench.minor()[..2].to_vec()
        };
        assert_eq!(phases(3.0), phases(3.0 + 20.0 * 1e8));
    }

    #[test]
    fn a_wanted_angle_moves_by_whole_positions() {
        let command = Command::Angle { teeth: 50 };
        let mut bench = Bench::new(StepperDriver { drive: Drive::Half, command, ..DRIVER });
        let half = PI / 200.0;
        for (angle, position) in
            [(0.0, 0.0), (0.49, 0.0), (0.51, 1.0), (0.49, 0.0), (-7.3, -7.0), (100.2, 100.0)]
        {
            assert_eq!(bench.set(0, &[angle * half]).major()[2], position, "{angle}");
        }
        let guards = bench.guards();
        assert!((guards[0] + 0.3).abs() < 1e-12 && (guards[1] - 0.7).abs() < 1e-12, "{guards:?}");
        assert_eq!(bench.set(0, &[f64::NAN]).major()[2], 100.0);
    }

    /// Wherever it is commanded to, the field is at most half a position away from there.
    #[test]
    fn the_field_stands_nearest_to_the_wanted_angle_with_every_drive() {
        for drive in [Drive::Wave, Drive::Full, Drive::Half, Drive::Micro(4)] {
            let command = Command::Angle { teeth: 50 };
            let mut bench = Bench::new(StepperDriver { drive, command, ..DRIVER });
            let position = PI / 100.0 / f64::from(drive.positions());
            for k in -100..100 {
                let angle = 0.0011 * f64::from(k) + 1e-5;
                let y = bench.set(0, &[angle]).major();
                let field = y[1].atan2(y[0]);
                let off = (50.0 * angle - field + PI).rem_euclid(2.0 * PI) - PI;
                assert!((off / 50.0).abs() <= 0.5 * position * (1.0 + 1e-9), "{drive:?} at {angle}: {off}");
            }
        }
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let refused = |driver: StepperDriver| driver.errors()[0].param.clone();
        assert_eq!(refused(StepperDriver { drive: Drive::Micro(0), ..DRIVER }), "drive");
        assert_eq!(
            refused(StepperDriver { command: Command::Angle { teeth: 0 }, ..DRIVER }),
            "command.teeth"
        );
        assert_eq!(refused(StepperDriver { amplitude: f64::NAN, ..DRIVER }), "amplitude");
    }
}
