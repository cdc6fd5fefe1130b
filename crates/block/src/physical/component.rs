//! The law of a component.

use std::any::Any;
use std::fmt::Debug;

use super::{
    Characteristics, DryMesh, Energy, Fed, Flowing, Grip, Known, Loaded, Moving, Part, Supply, Torque, Wrench,
};
use crate::{Block, Files, Given, Interface, InterfaceError, LoadError};

/// The law of a block that belongs to a physical network. All functions are pure, and see what is known when they are asked: see
/// [`Known`], [`Moving`], [`Fed`], [`Flowing`] and [`Loaded`].
pub trait Component: Any + Debug + Send + Sync {
    /// Completes the paths of files that the parameters name. Called once, before everything else.
    fn locate(&mut self, _files: &dyn Files) {}

    /// Ports, signals, states and elements.
    fn part(&self, given: &Given) -> Part;

    /// Voltage of each voltage source and capacitance, V; not asked for where the part [says them](Part::voltage_is).
    fn voltages(&self, _c: &Moving, _v: &mut [f64]) {}

    /// Derivative of each voltage of [`voltages`](Self::voltages), or of the three phases of the supply, V/s. Only when the part says
    /// [`Part::rates`].
    fn voltage_rates(&self, _c: &Moving, _dv: &mut [f64]) {}

    /// The three-phase supply.
    fn supply(&self, _c: &Known) -> Supply {
        Supply::default()
    }

    /// Prescribed speed and its derivative of each speed source.
    fn speeds(&self, _c: &Known, _w: &mut [f64], _dw: &mut [f64]) {}

    /// Current of each winding and current source, A; not asked for where the part [says them](Part::current_is). What follows from
    /// voltages is written by [`currents_by_voltages`](Self::currents_by_voltages).
    fn currents(&self, _c: &Moving, _i: &mut [f64]) {}

    /// The same where voltages are known, for components with windings whose current is no state.
    fn currents_by_voltages(&self, _c: &Flowing, _i: &mut [f64]) {}

    /// Derivative of the current of each current source, A/s. Only when the part says [`Part::rates`].
    fn current_rates(&self, _c: &Moving, _di: &mut [f64]) {}

    /// Current of each [`Element::Characteristic`](super::Element::Characteristic) and its exact slopes, at the voltages that
    /// `curves` shows. Time, inputs, states and speeds are known. The network calls it several times at an instant, until all
    /// voltages and currents fit.
    fn characteristics(&self, _c: &Moving, _curves: &mut Characteristics) {}

    /// Ratio of each variable transformer; from time, inputs and states.
    fn ratios(&self, _c: &Known, _ratio: &mut [f64]) {}

    /// Current that a machine draws from its supply, as a space vector in the frame of the supply and zero sequence, A;
    /// from states alone.
    fn line_current(&self, _c: &Fed) -> [f64; 3] {
        [0.0; 3]
    }

    /// Whether the gate of each valve is on; from inputs and discrete states.
    fn gates(&self, _c: &Known, _on: &mut [bool]) {}

    /// How the currents of windings that are states change with voltages: `di/dt = inverse * (v - internal)`.
    ///
    /// Where nothing but such currents meets at a node they depend on each other, and this tells the potential
    /// there. `internal` has one entry for each such winding, three for a machine: a space vector in the frame of its
    /// supply and zero sequence. `inverse`, 1/H, is symmetric and stored by rows. All voltages are known but those at such nodes.
    fn reluctance(&self, _c: &Flowing, _internal: &mut [f64], _inverse: &mut [f64]) {}

    /// Adds volt-seconds, as numbered in [`reluctance`](Self::reluctance), to the fluxes: what a voltage without end
    /// does in no time when a contact opens.
    fn strike(&self, _c: &Fed, _volt_seconds: &[f64], _x: &mut [f64]) {}

    /// Turns the states at the start, which hold for a voltage vector along the axis of phase a, to one at this angle, rad. Called
    /// once for machines in circuits whose voltages are known at the start.
    fn turn(&self, _angle: f64, _x: &mut [f64]) {}

    /// Torque of each branch.
    fn torques(&self, _c: &Flowing, _tau: &mut [Torque]) {}

    /// What each dry friction does.
    fn grips(&self, _c: &Flowing, _grips: &mut [Grip]) {}

    /// What each mesh of [`LossModel::Stiction`](super::LossModel::Stiction) loses, at these speeds of their bases in the direction they slide in.
    fn mesh_losses(&self, _c: &Flowing, _speed: &[f64], _losses: &mut [DryMesh]) {}

    /// Torque that the component itself applies to each speed of its joint (springs, stops, the torque input).
    fn joint_torques(&self, _c: &Moving, _tau: &mut [Torque]) {}

    /// Force and torque on each frame that the component acts on, in the order of [`Element::FrameForce`](super::Element::FrameForce).
    fn wrenches(&self, _c: &Moving, _f: &mut [Wrench]) {}

    /// Share of its payload that is attached: 0 or 1.
    fn load(&self, _c: &Known) -> f64 {
        0.0
    }

    /// What an account of energies books for the component: for its branches, windings, capacitances, machines, joint
    /// torques and wrenches, of which only it knows what becomes of the power. Each of the three numbers follows from
    /// the law on its own, none from the balance, so that the balance is a check of the law.
    ///
    /// All else the network books by itself: inertias and bodies, dry friction, meshes, resistances, valves, and what
    /// sources of speed, voltage and current, supplies and payloads bring.
    fn energy(&self, _c: &Flowing) -> Energy {
        Energy::default()
    }

    /// Heat flow out of each [`Element::Heat`](super::Element::Heat), W; torques and currents are known. `dissipated` is all that the
    /// component turns into heat, with what the network books for it: friction, meshes, resistances and valves. The sum of `q` must be
    /// that.
    fn heats(&self, _c: &Flowing, dissipated: f64, q: &mut [f64]) {
        q[0] = dissipated;
    }

    /// Derivatives of the states; voltages, currents and speeds are known.
    fn derivatives(&self, _c: &Flowing, _dx: &mut [f64]) {}

    /// How the states and the torque of the only branch change, for linearly implicit methods: `a` is the derivative of
    /// the derivatives of the states over the states, by rows; `b` that over the speed of the branch; `c` that of the
    /// torque over the states. Only when the part says [`Part::linear`]. They need not be exact: they keep what is
    /// stiff cheap to integrate, and never change the result.
    fn linearize(&self, _law: &Flowing, _a: &mut [f64], _b: &mut [f64], _c: &mut [f64]) {}

    /// Jumps of states at a major step: changes `x` and `d`, while the law shows everything as it was before; see
    /// [`Block::jump`](crate::Block::jump). Only when the part says [`Part::jumps`].
    fn jump(&self, _c: &Flowing, _x: &mut [f64], _d: &mut [f64]) -> bool {
        false
    }

    /// Brings its states to where they can be, once a search for a steady state has found something; says by how much they were elsewhere, in
    /// words such as `is 3 mm beyond its end`.
    fn fit(&self, _c: &Flowing, _x: &mut [f64]) -> Option<String> {
        None
    }

    /// Functions whose sign changes are events; as many as [`Part::guards`].
    fn guards(&self, _c: &Flowing, _g: &mut [f64]) {}

    /// The same where they follow from states and speeds alone: in the place of [`guards`](Self::guards), when the part says
    /// [`Part::guards_of_state`].
    fn guards_of_state(&self, _c: &Moving, _g: &mut [f64]) {}

    /// The next time after `c.t` at which the component changes by itself; of the law, only time, inputs and
    /// states are known. Only when the part says [`Part::time_events`].
    fn next_event(&self, _c: &Known) -> f64 {
        f64::INFINITY
    }

    /// Writes the outputs that follow from states and speeds ([`Needs::State`](super::Needs::State)), but for those that are
    /// [numbers of the network](Part::reads). `y` holds all outputs of the component, port after port.
    fn measure_state(&self, _c: &Moving, _y: &mut [f64]) {}

    /// The same for those that need voltages and currents ([`Needs::Electrics`](super::Needs::Electrics)).
    fn measure_electrics(&self, _c: &Flowing, _y: &mut [f64]) {}

    /// The same for those that need torques and accelerations ([`Needs::Motion`](super::Needs::Motion)).
    fn measure_motion(&self, _c: &Loaded, _y: &mut [f64]) {}
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
