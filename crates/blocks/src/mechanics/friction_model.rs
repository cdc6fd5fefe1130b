//! The two ways in which blocks describe dry friction.

use blocksim_block::physical::{Element, Grip, Part, Torque};
use blocksim_block::prelude::*;

/// How dry friction behaves around standstill.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum FrictionModel {
    /// One steep, smooth curve over the speed: no events, no true sticking; what is held creeps.
    #[default]
    Smooth,
    /// Sliding forward, sliding backward or stuck, with events in between: what is held stands still exactly.
    Stiction,
}

impl FrictionModel {
    /// Whether the modes with events are meant.
    pub(crate) fn sticks(self) -> bool {
        self == FrictionModel::Stiction
    }

    /// The element between the ports `r` and `c`.
    pub(crate) fn element(self) -> Element {
        match self {
            FrictionModel::Smooth => Element::Branch { r: 0, c: 1 },
            FrictionModel::Stiction => Element::Friction { r: 0, c: 1 },
        }
    }
}

/// Discs or bands that are pressed together: a clutch or a brake.
#[derive(Debug, Clone, Copy, Parameters)]
pub struct Pressed {
    /// Torque that it transmits while slipping, fully pressed.
    #[block(unit = "N*m", not_negative)]
    pub torque: f64,
    /// `Stiction` or `Smooth`.
    #[block(default = FrictionModel::Stiction)]
    pub model: FrictionModel,
    /// Torque $p$ that it holds at rest over that while slipping, at least 1; for `Stiction`.
    #[block(
        finite,
        at_least = 1.0,
        default = 1.0,
        remedy = "surfaces hold at least what they transmit while they slide: 1 means the same at rest"
    )]
    pub peak: f64,
    /// Speed at which 76 % of the torque act, far below the speeds of the machine; for `Smooth`.
    #[block(unit = "rad/s", not_negative, default = 0.01)]
    pub threshold: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

/// What a change of the mode of a clutch or a brake is called.
const PRESSED: &[Change] = &[
    Change::to(0.0, "locks"),
    Change::to(1.0, "slips forward"),
    Change::to(-1.0, "slips backward"),
    Change::any("opens"),
];

impl Pressed {
    fn validate(&self, errors: &mut ParamErrors) {
        if self.threshold == 0.0 && !self.model.sticks() {
            let message = "`threshold` is 0, but the torque would then jump at standstill";
            let help = "write a small speed such as \"0.01 rad/s\", or `model: Stiction`, which needs none";
            errors.add(ParamError::new("threshold", message).help(help));
        }
    }

    /// Ports, element and outputs; the input is the share of the load.
    pub(crate) fn part(&self, share: &str, doc: &'static str) -> Part {
        Part::new()
            .rod_and_case()
            .input(Input::any(share).scalar().doc(doc))
            .measures("tau", "N*m", Needs::Motion, "torque from r to c")
            .measures("heat", "W", Needs::Motion, "power that becomes heat")
            .output(
                Output::boolean("locked").doc("both sides turn as one; never for `Smooth`"),
                Needs::Motion,
            )
            .element(self.model.element())
            .friction_called(PRESSED)
            .heat_port(self.heat_port)
    }

    /// Smooth torque under a share of the load at a speed.
    pub(crate) fn smooth(&self, share: f64, w: f64) -> Torque {
        let capacity = share.clamp(0.0, 1.0) * self.torque;
        let onset = (w / self.threshold).tanh();
        Torque { value: capacity * onset, slope: capacity * (1.0 - onset * onset) / self.threshold }
    }

    /// Heat of a smooth branch with the share as its input; that of friction that sticks is booked by the network.
    pub(crate) fn energy(&self, c: &Flowing) -> Energy {
        match self.model.sticks() {
            true => Energy::default(),
            false => Energy::dissipated(self.smooth(c.scalar(0), c.speed[0]).value * c.speed[0]),
        }
    }

    /// What it holds and transmits under a share of the load; a share outside 0..1 counts as the nearer end, and none
    /// (NaN) as it is.
    pub(crate) fn grip(&self, share: f64) -> Grip {
        let capacity = share.clamp(0.0, 1.0) * self.torque;
        Grip {
            hold: [self.peak * capacity; 2],
            slide: [Torque { value: capacity, slope: 0.0 }; 2],
            stop: None,
        }
    }

    pub(crate) fn measure(&self, c: &Loaded, y: &mut [f64]) {
        let locked = c.mode.first().is_some_and(|mode| *mode == 0.0);
        y[..3].copy_from_slice(&[c.torque[0], c.torque[0] * c.speed[0], f64::from(locked)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMOOTH: Pressed =
        Pressed { model: FrictionModel::Smooth, torque: 8.0, peak: 1.0, threshold: 0.5, heat_port: false };

    #[test]
    fn far_from_standstill_the_torque_is_the_share_of_the_capacity() {
        for (share, capacity) in [(0.0, 0.0), (0.25, 2.0), (1.0, 8.0), (7.0, 8.0), (-1.0, 0.0)] {
            assert_eq!(SMOOTH.smooth(share, 50.0).value, capacity);
            assert_eq!(SMOOTH.smooth(share, -50.0).value, -capacity);
            assert_eq!(SMOOTH.grip(share).slide[1].value, capacity);
        }
    }

    #[test]
    fn the_slope_is_the_derivative_and_no_speed_gains_energy() {
        for w in [-3.0, -0.2, 0.0, 0.1, 0.6] {
            let h = 1e-6;
            let difference = (SMOOTH.smooth(0.7, w + h).value - SMOOTH.smooth(0.7, w - h).value) / (2.0 * h);
            let at = SMOOTH.smooth(0.7, w);
            assert!((at.slope - difference).abs() < 1e-8, "{w}: {} != {difference}", at.slope);
            assert!(at.value * w >= 0.0, "{w}");
        }
    }

    #[test]
    fn a_jump_at_standstill_is_refused_unless_it_sticks() {
        let jump = Pressed { threshold: 0.0, ..SMOOTH };
        let error = jump.errors()[0].clone();
        assert_eq!(error.param, "threshold");
        assert!(error.help.is_some_and(|help| help.contains("Stiction")));
        assert_eq!(Pressed { model: FrictionModel::Stiction, ..jump }.errors()[..], []);
        assert_eq!(Pressed { torque: -1.0, ..SMOOTH }.errors()[0].param, "torque");
        assert_eq!(Pressed { peak: 0.9, ..SMOOTH }.errors()[0].param, "peak");
    }
}
