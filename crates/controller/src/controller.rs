//! The trait that an author implements.

use crate::context::Context;
use crate::quantity::{Continuous, Discrete, Input, Output, Parameter};
use crate::values::{ContinuousStates, Derivatives, DiscreteStates, Outputs, Parameters};

/// Done, or the reason why not, as the user shall read it.
pub type Outcome = Result<(), String>;

/// One block kind of a plug-in: constants describe it, functions act.
///
/// The type itself holds nothing; parameters, states and signals live in buffers of the simulator. All
/// functions depend on their arguments only: no globals, clock, files or random numbers. They may run on
/// several threads at once, and time may go back when the solver rejects a step. A panic is caught at the
/// border and ends the run with its message.
///
/// A controller is either sampled (`sample_time` above 0, `update`) or continuous (0, `derivatives`).
pub trait Controller: 'static {
    /// Name in diagrams, as "Cascade".
    const KIND: &'static str;
    /// Page of the manual, Markdown: law first.
    const DOC: &'static str;
    /// Parameters.
    const PARAMETERS: &'static [Parameter] = &[];
    /// Input ports, at most 64.
    const INPUTS: &'static [Input] = &[];
    /// Output ports.
    const OUTPUTS: &'static [Output] = &[];
    /// States that change at sample hits.
    const DISCRETE: &'static [Discrete] = &[];
    /// States that are integrated.
    const CONTINUOUS: &'static [Continuous] = &[];

    /// Refuses parameters that make no sense; the message names the parameter and its limits.
    fn check(_p: &Parameters) -> Outcome {
        Ok(())
    }

    /// Time between samples in seconds; 0: continuous.
    fn sample_time(_p: &Parameters) -> f64 {
        0.0
    }

    /// Writes start values that depend on parameters. Both buffers hold the defaults of the lists.
    fn reset(_p: &Parameters, _x: &mut ContinuousStates, _xd: &mut DiscreteStates) -> Outcome {
        Ok(())
    }

    /// y = h(t, x, xd, u): writes every output. Inputs that the wanted output does not read may hold any
    /// number at the call.
    fn outputs(c: &Context, y: &mut Outputs) -> Outcome;

    /// xd(k+1) = g(t, x, xd(k), u), at each sample hit after `outputs`. `next` holds a copy of the states:
    /// what is not written stays.
    fn update(_c: &Context, _next: &mut DiscreteStates) -> Outcome {
        Ok(())
    }

    /// dx/dt = f(t, x, xd, u): writes every derivative.
    fn derivatives(_c: &Context, _dx: &mut Derivatives) -> Outcome {
        Ok(())
    }
}
