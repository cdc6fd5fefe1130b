//! The law of a component.

use std::any::Any;
use std::fmt::Debug;

use super::{Characteristics, DryMesh, Energy, Grip, Law, Needs, Part, Supply, Torque, Wrench};
use crate::{Block, Files, Given, Interface, InterfaceError, LoadError};

/// The law of a block that belongs to a physical network. All functions are pure.
pub trait Component: Any + Debug + Send + Sync {
    /// Completes the paths of files that the parameters name. Called once, before everything else.
    fn locate(&mut self, _files: &dyn Files) {}

    /// Ports, signals, states and elements.
    fn part(&self, given: &Given) -> Part;

    /// Voltage of each voltage source and capacitance, V; not asked for where the part [says them](Part::voltage_is).
    fn voltages(&self, _c: &Law, _v: &mut [f64]) {}

    /// Derivative of each voltage of [`voltages`](Self::voltages), or of the three phases of the supply, V/s. Only when the part says
    /// [`Part::rates`].
    fn voltage_rates(&self, _c: &Law, _dv: &mut [f64]) {}

    /// The three-phase supply.
    fn supply(&self, _c: &Law) -> Supply {
        Supply::default()
    }

    /// Prescribed speed and its derivative of each speed source.
    fn speeds(&self, _c: &Law, _w: &mut [f64], _dw: &mut [f64]) {}

    /// Current of each winding and current source, A; not asked for where the part [says them](Part::current_is).
    fn currents(&self, _c: &Law, _i: &mut [f64]) {}

    /// Derivative of the current of each current source, A/s. Only when the part says [`Part::rates`].
    fn current_rates(&self, _c: &Law, _di: &mut [f64]) {}

    /// Current of each [`Element::Characteristic`](super::Element::Characteristic) and its exact slopes, at the voltages that
    /// `curves` shows. Time, inputs, states and speeds are known. The network calls it several times at an instant, until all
    /// voltages and currents fit.
    fn characteristics(&self, _c: &Law, _curves: &mut Characteristics) {}

    /// Ratio of each variable transformer; from time, inputs and states.
    fn ratios(&self, _c: &Law, _ratio: &mut [f64]) {}

    /// Current that a machine draws from its supply, as a space vector in the frame of the supply and zero sequence, A;
    /// from states alone.
    fn line_current(&self, _c: &Law) -> [f64; 3] {
        [0.0; 3]
    }

    /// Whether the gate of each valve is on; from inputs and discrete states.
    fn gates(&self, _c: &Law, _on: &mut [bool]) {}

    /// How the currents of windings that are states change with voltages: `di/dt = inverse * (v - internal)`.
    ///
    /// Where nothing but such currents meets at a node they depend on each other, and this tells the potential
    /// there. `internal` has one entry for each such winding, three for a machine: a space vector in the frame of its
    /// supply and zero sequence. `inverse`, 1/H, is symmetric and stored by rows. Speeds are known.
    fn reluctance(&self, _c: &Law, _internal: &mut [f64], _inverse: &mut [f64]) {}

    /// Adds volt-seconds, as numbered in [`reluctance`](Self::reluctance), to the fluxes: what a voltage without end
    /// does in no time when a contact opens.
    fn strike(&self, _c: &Law, _volt_seconds: &[f64], _x: &mut [f64]) {}

    /// Turns the states at the start, which hold for a voltage vector along the axis of phase a, to one at this angle, rad. Called
    /// once for machines in circuits whose voltages are known at the start.
    fn turn(&self, _angle: f64, _x: &mut [f64]) {}

    /// Torque of each branch.
    fn torques(&self, _c: &Law, _tau: &mut [Torque]) {}

    /// What each dry friction does.
    fn grips(&self, _c: &Law, _grips: &mut [Grip]) {}

    /// What each mesh of [`LossModel::Stiction`](super::LossModel::Stiction) loses, at these speeds of their bases in the direction they slide in.
    fn mesh_losses(&self, _c: &Law, _speed: &[f64], _losses: &mut [DryMesh]) {}

    /// Torque that the component itself applies to each speed of its joint (springs, stops, the torque input).
    fn joint_torques(&self, _c: &Law, _tau: &mut [Torque]) {}

    /// Force and torque on each frame that the component acts on, in the order of [`Element::FrameForce`](super::Element::FrameForce).
    fn wrenches(&self, _c: &Law, _f: &mut [Wrench]) {}

    /// Share of its payload that is attached: 0 or 1.
    fn load(&self, _c: &Law) -> f64 {
        0.0
    }

    /// What an account of energies books for the component: for its branches, windings, capacitances, machines, joint
    /// torques and wrenches, of which only it knows what becomes of the power. Each of the three numbers follows from
    /// the law on its own, none from the balance, so that the balance is a check of the law.
    ///
    /// All else the network books by itself: inertias and bodies, dry friction, meshes, resistances, valves, and what
    /// sources of speed, voltage and current, supplies and payloads bring.
    fn energy(&self, _c: &Law) -> Energy {
        Energy::default()
    }

    /// Heat flow out of each [`Element::Heat`](super::Element::Heat), W; torques and currents are known. `dissipated` is all that the
    /// component turns into heat, with what the network books for it: friction, meshes, resistances and valves. The sum of `q` must be
    /// that.
    fn heats(&self, _c: &Law, dissipated: f64, q: &mut [f64]) {
        q[0] = dissipated;
    }

    /// Derivatives of the states; voltages, currents and speeds are known.
    fn derivatives(&self, _c: &Law, _dx: &mut [f64]) {}

    /// How the states and the torque of the only branch change, for linearly implicit methods: `a` is the derivative of
    /// the derivatives of the states over the states, by rows; `b` that over the speed of the branch; `c` that of the
    /// torque over the states. Only when the part says [`Part::linear`]. They need not be exact: they keep what is
    /// stiff cheap to integrate, and never change the result.
    fn linearize(&self, _law: &Law, _a: &mut [f64], _b: &mut [f64], _c: &mut [f64]) {}

    /// Jumps of states at a major step: changes `x` and `d`, while the law shows everything as it was before; see
    /// [`Block::jump`](crate::Block::jump). Only when the part says [`Part::jumps`].
    fn jump(&self, _c: &Law, _x: &mut [f64], _d: &mut [f64]) -> bool {
        false
    }

    /// Functions whose sign changes are events; as many as [`Part::guards`].
    fn guards(&self, _c: &Law, _g: &mut [f64]) {}

    /// The next time after `c.t` at which the component changes by itself; of the law, only time, inputs and
    /// states are known. Only when the part says [`Part::time_events`].
    fn next_event(&self, _c: &Law) -> f64 {
        f64::INFINITY
    }

    /// Writes all outputs of one need, but for those that are [numbers of the network](Part::reads). `y` holds all outputs of the
    /// component, port after port.
    fn measure(&self, _c: &Law, _needs: Needs, _y: &mut [f64]) {}
}

/// A component is a block, whose ports and states are those of its part.
impl<C: Component> Block for C {
    fn load(&mut self, files: &dyn Files) -> Result<(), LoadError> {
        self.locate(files);
        Ok(())
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        Ok(self.part(given).interface())
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}
