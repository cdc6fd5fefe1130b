//! The contract between blocks, the diagram compiler and the engine.
//!
//! A block is a struct of parameters with pure functions ([`Block`]). What it looks like from outside is data
//! ([`Interface`]); what it needs while running is handed to it ([`Context`]); what it remembers lives in
//! buffers of the engine. Blocks of physical networks state a law instead of outputs ([`physical::Component`]).
//! A compiled diagram is a [`schedule::Schedule`].

mod code;
mod context;
mod contract;
mod defaults;
mod draft;
pub mod event;
mod given;
pub mod in_unit;
mod interface;
mod invariant;
pub mod law;
pub mod methods;
mod param_errors;
mod parameter;
mod parameters;
pub mod physical;
mod piece;
mod ports;
pub mod problem;
mod reading;
mod registry;
mod requirements;
mod resolution;
pub mod schedule;
mod shapes;
pub mod shell;
mod symbol;
pub mod synonyms;
pub mod testing;

pub use blocksim_block_macros::{BlockMeta, Parameters};
pub use code::{AnyCode, CodePolicy, Decision, NoCode, UNTRUSTED, untrusted};
pub use context::{Context, Fault};
pub use contract::{Block, Bus, Files, LoadError, Scratch};
pub use defaults::in_diagram;
pub use draft::{BlockKind, Draft, Fields};
pub use given::{Given, ParamUnits};
pub use interface::{
    Constraint, Crossing, Discrete, Floor, Guard, Interface, InterfaceError, JumpPhrase, MOST_MEMORY,
    Merging, RecordRequest, Ring, State,
};
pub use invariant::Invariant;
pub use param_errors::ParamErrors;
pub use parameter::{
    MOST_PORTS, ParamError, ParamValue, VALUE_ENUM, at_least, count, finite, hand_over, not_negative,
    ordered, positive,
};
pub use parameters::{ParameterInfo, Parameters};
pub use piece::{NODES, Piece, derivatives, roughness, through};
pub use ports::{CONDITION, Input, Output, PortType};
pub use registry::{BlockInfo, Registered, kinds};
pub use requirements::{Bound, Inspect, Requirement, Requirements};
pub use resolution::Resolution;
pub use shapes::Shapes;
pub use symbol::{Curve, Symbol};

/// What the derive macro needs; not for use by hand.
#[doc(hidden)]
pub mod private {
    pub use crate::draft::FieldsOf;
    pub use crate::parameters::{Missing, NoValidation, count, joined, names, read_value, with_default};
    pub use crate::reading::{ReadError, Values};
    pub use inventory;
    pub use serde;
    pub use typetag;
}

/// What a block file needs.
pub mod prelude {
    pub use crate::event::{Change, Event};
    pub use crate::law::{Condition, Failure, Recording, Relation, Value};
    pub use crate::physical::{
        Component, Energy, Fed, Flowing, Gives, Known, Loaded, Moving, Needs, Part, Reading, Torque,
    };
    pub use crate::{
        Block, BlockInfo, BlockKind, BlockMeta, Bus, Context, Crossing, Discrete, Files, Floor, Given, Input,
        Inspect, Interface, InterfaceError, LoadError, MOST_PORTS, Output, ParamError, ParamErrors,
        ParamValue, Parameters, Piece, PortType, Ring, Scratch, Shapes, State, at_least, count, finite,
        not_negative, ordered, positive,
    };
    pub use blocksim_signal::{Dimension, Kind, SampleTime, Shape};
    pub use serde::Deserialize;
}
