//! Random models, as a judge of the engine that shares nothing with it.
//!
//! A model is made of a seed. The engine runs it from the text of its diagram, with default settings; a reference of the class finds what
//! must come out in another formulation, in tiny steps or exactly. Where both differ, the model is shrunk to the least that still
//! fails. What nobody can decide is left out and counted.
//!
//! | file | idea |
//! |---|---|
//! | `changes` | how often a value changes its sign |
//! | `dice` | numbers at random, from a seed |
//! | `puzzle` | what classes have in common: model, diagram, reference, judge, smaller models |
//! | `sheet` | the text of a diagram while it is written |
//! | `variants` | the same model put differently: other methods, tolerances, names, rows |
//! | `survey` | many models of a class |
//!
//! | class | models |
//! |---|---|
//! | `signals` | sources, limits, logic, memories, dead times, integrators and controllers |
//! | `sampled` | loops of sampled control at one or two rates around continuous plants |
//! | `mechanisms` | chains of pendulums, closed loops, balls on planes, with friction, springs and ends of travel |
//! | `circuits` | sources, coils, capacitors, transformers, and valves of all kinds |
//! | `shafts` | discs with springs, bearings, clutches, freewheels and ends of travel |

mod changes;
mod circuits;
mod dice;
mod mechanisms;
mod puzzle;
mod sampled;
mod shafts;
mod sheet;
mod signals;
mod survey;
mod variants;

pub use circuits::{Branch, Circuit, Gate, Kind, Source, Valve, contradiction};
pub use dice::Dice;
pub use mechanisms::Mechanisms;
pub use puzzle::{Fault, Finding, Judge, Puzzle, Undecided, least};
pub use sampled::Sampled;
pub use shafts::{Joint, Shafts, Torque};
pub use signals::Signals;
pub use survey::{Survey, survey};
pub use variants::{Variant, vary};
