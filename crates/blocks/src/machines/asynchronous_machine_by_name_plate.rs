use std::f64::consts::TAU;

use blocksim_block::in_unit;
use blocksim_block::prelude::*;

use super::asynchronous_machine_component::{Motor, has_zero_sequence};
use super::asynchronous_machine_parameters::{Connection, Start};
use super::induction::{self, Circuit, NamePlate};

/// Three-phase induction machine with a squirrel cage, from the data of a catalogue or a name plate.
///
/// Equations, ports, states and outputs are those of `AsynchronousMachine`; its resistances and reactances are found
/// from the figures, all of them at rated voltage and frequency. With the current and the voltage 1, power factor
/// $\cos\varphi$, efficiency $\eta$ and slip $s$, the power that reaches the rotor is the torque
///
/// $$ T = \frac{\eta \cos\varphi}{1 - s}\Bigl(1 + \frac{P_{loss}}{P}\Bigr), \qquad R_s = \cos\varphi - T $$
///
/// and the rest follows, by least squares, from the reactive power $\sin\varphi$ and the breakdown torque: $X_m$, $R_r$ and
/// $X_{lr}$ of a single cage. With torque and current at standstill (`locked_rotor`) the machine gets two cages; the
/// second has the higher resistance and the smaller reactance. $X_{ls}$ is `leakage_ratio` times the reactance of the
/// (outer) cage.
///
/// Catalogues round, and measure standstill where iron saturates that is linear here: figures of small machines often fit
/// no circuit exactly. `tolerance` is the deviation that is accepted; an error lists the deviations of the nearest circuit.
/// Iron losses count as losses in the resistance of the stator.
///
/// ```ron
/// AsynchronousMachineByNamePlate(
///     power: "37 kW", voltage: "400 V", frequency: "50 Hz", pole_pairs: 2, speed: "1482 rpm",
///     power_factor: 0.85, efficiency: "93.9 %", breakdown_torque: 2.8, locked_rotor: (torque: 2.6, current: 7.0),
/// )
/// ```
///
/// Source: J. Pedra, F. Corcoles, *Estimation of induction motor double-cage model parameters from manufacturer data*,
/// IEEE Trans. Energy Conversion 19 (2004), for the equations and the choice of unknowns.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Machines", symbol = Machine("M 3~"), builds = Motor)]
pub struct AsynchronousMachineByNamePlate {
    /// Rated power at the shaft.
    #[block(unit = "W", positive)]
    pub power: f64,
    /// Rated voltage, RMS from line to line; with open windings, that of a winding.
    #[block(unit = "V", positive)]
    pub voltage: f64,
    /// Rated frequency.
    #[block(unit = "Hz", positive)]
    pub frequency: f64,
    /// Number of pole pairs.
    #[block(at_least = 1, zero = "frequency times 60 over the speed in rpm, rounded down")]
    pub pole_pairs: u32,
    /// Speed of the shaft at rated power.
    #[block(unit = "rad/s", positive)]
    pub speed: f64,
    /// Power factor at rated power.
    #[block(unit = "1", positive, below = 1.0)]
    pub power_factor: f64,
    /// Power at the shaft over power from the lines, at rated power.
    #[block(unit = "1", positive, below = 1.0)]
    pub efficiency: f64,
    /// Largest torque over rated torque.
    #[block(
        unit = "1",
        finite,
        above = 1.0,
        remedy = "it is the maximum torque over the rated one, so more than 1"
    )]
    pub breakdown_torque: f64,
    /// Standstill: `(torque: .., current: ..)` over rated values; `None` for a single cage.
    #[block(default = None)]
    pub locked_rotor: Option<LockedRotor>,
    /// Part of the losses that is friction and fan; it is not simulated: add a `RotationalDamper` or a `QuadraticLoad`.
    #[block(unit = "W", not_negative, default = 0.0)]
    pub mechanical_loss: f64,
    /// Leakage reactance of the stator over that of the cage, the outer one of two.
    #[block(unit = "1", positive, default = 1.0)]
    pub leakage_ratio: f64,
    /// Deviation of the figures that is accepted.
    #[block(unit = "1", not_negative, default = 0.01)]
    pub tolerance: f64,
    /// `Delta`, `Wye` or `Open`.
    #[block(default = Connection::Delta)]
    pub connection: Connection,
    /// `Zero`, `Magnetised(voltage: .., frequency: .., slip: ..)` or `Explicit(psi_s: [..], psi_r: [..])`.
    #[block(default = Start::Zero)]
    pub start: Start,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

/// Standstill at rated voltage and frequency.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LockedRotor {
    /// Torque over rated torque.
    #[serde(deserialize_with = "in_unit::share")]
    pub torque: f64,
    /// Current over rated current.
    #[serde(deserialize_with = "in_unit::share")]
    pub current: f64,
}

impl AsynchronousMachineByNamePlate {
    fn plate(&self) -> NamePlate {
        // The circuit is that of a winding, which sees less in a star.
        let winding = if self.connection == Connection::Wye { 3.0_f64.sqrt() } else { 1.0 };
        NamePlate {
            power: self.power,
            voltage: self.voltage / winding,
            frequency: self.frequency,
            pole_pairs: self.pole_pairs,
            slip: 1.0 - self.speed * f64::from(self.pole_pairs) / (TAU * self.frequency),
            power_factor: self.power_factor,
            efficiency: self.efficiency,
            mechanical_loss: self.mechanical_loss,
            breakdown_torque: self.breakdown_torque,
            locked_rotor: self
                .locked_rotor
                .map(|LockedRotor { torque, current }| induction::LockedRotor { torque, current }),
            leakage_ratio: self.leakage_ratio,
            tolerance: self.tolerance,
        }
    }

    /// The equivalent circuit in per unit; the base is the apparent power that is drawn at rated power.
    ///
    /// # Errors
    /// Figures that fit no circuit.
    pub fn circuit(&self) -> Result<Circuit, ParamError> {
        let circuit = self.plate().circuit()?;
        let zero = has_zero_sequence(self.connection, &self.start);
        Ok(Circuit { l_0: zero.then_some(circuit.l_ls), ..circuit })
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.plate().validate(errors);
        self.start.validate(errors);
    }

    fn build(self, errors: &mut ParamErrors) -> Option<Motor> {
        let circuit = errors.take(self.circuit())?;
        let apparent = self.power / (self.efficiency * self.power_factor);
        let motor =
            Motor::new((self.plate().base(), apparent), circuit, self.connection, &self.start, errors)?;
        Some(motor.with_heat_port(self.heat_port))
    }
}

#[cfg(test)]
mod tests {
    use super::super::asynchronous_machine_outputs as out;
    use super::*;
    use crate::mechanics::testing::{Seen, law};
    use blocksim_block::physical::Supply;

    fn machine(connection: Connection) -> AsynchronousMachineByNamePlate {
        let rated = TAU * 50.0 / 2.0;
        AsynchronousMachineByNamePlate {
            power: 37e3,
            voltage: 400.0,
            frequency: 50.0,
            pole_pairs: 2,
            speed: 0.988 * rated,
            power_factor: 0.85,
            efficiency: 0.939,
            breakdown_torque: 2.8,
            locked_rotor: Some(LockedRotor { torque: 2.6, current: 7.0 }),
            mechanical_loss: 0.0,
            leakage_ratio: 1.0,
            tolerance: 0.01,
            connection,
            start: Start::Magnetised { voltage: 400.0, frequency: 50.0, slip: 0.012 },
            heat_port: false,
        }
    }

    #[test]
    fn at_rated_speed_the_machine_does_what_its_name_plate_says() {
        for connection in [Connection::Delta, Connection::Wye] {
            let machine = machine(connection);
            let component = machine.clone().built();
            let part = component.part(&Given::nothing());
            let x: Vec<f64> = part.states.iter().map(|state| state.initial).collect();
            let amplitude = 400.0 * (2.0_f64 / 3.0).sqrt();
            let supply = Supply { voltage: [amplitude, 0.0], frequency: 50.0, ..Supply::default() };
            let seen = Seen { x: &x, speed: &[machine.speed], supply: &supply, ..law() };
            let c = seen.loaded();
            let mut y = [0.0; out::COUNT];
            component.measure_state(&c, &mut y);
            component.measure_electrics(&c, &mut y);
            let close = |found: f64, expected: f64| {
                assert!(
                    (found / expected - 1.0).abs() < 1e-9,
                    "{connection:?}: {found} instead of {expected}"
                );
            };
            close(y[out::TORQUE] * machine.speed, 37e3);
            close(y[out::POWER], 37e3 / 0.939);
            close(y[out::POWER_FACTOR], 0.85);
            close(y[out::PU_CURRENT], 1.0);
            // The current of a line, from three phases of 400 V / sqrt(3).
            let [d, q, _] = component.line_current(&c);
            close(d.hypot(q) / 2.0_f64.sqrt(), 37e3 / 0.939 / 0.85 / (3.0_f64.sqrt() * 400.0));
        }
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let refused =
            |machine: AsynchronousMachineByNamePlate| machine.try_build().unwrap_err()[0].param.clone();
        let good = || machine(Connection::Delta);
        assert_eq!(refused(AsynchronousMachineByNamePlate { pole_pairs: 0, ..good() }), "pole_pairs");
        assert_eq!(refused(AsynchronousMachineByNamePlate { pole_pairs: 3, ..good() }), "speed");
        assert_eq!(refused(AsynchronousMachineByNamePlate { efficiency: 0.99, ..good() }), "efficiency");
        assert_eq!(refused(AsynchronousMachineByNamePlate { frequency: 0.0, ..good() }), "frequency");
        assert_eq!(refused(AsynchronousMachineByNamePlate { frequency: f64::NAN, ..good() }), "frequency");
        let small = AsynchronousMachineByNamePlate { breakdown_torque: 5.0, ..good() };
        assert!(small.try_build().is_err());
        assert_eq!(
            refused(AsynchronousMachineByNamePlate { breakdown_torque: 0.9, ..good() }),
            "breakdown_torque"
        );
        assert_eq!(refused(AsynchronousMachineByNamePlate { power_factor: 1.2, ..good() }), "power_factor");
    }
}
