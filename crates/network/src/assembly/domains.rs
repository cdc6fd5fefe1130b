//! Domains whose networks are solved by nodal analysis, and what messages call things there.
//!
//! Electricity is one, heat another: an across quantity whose differences drive a through quantity, which no node keeps. Their
//! elements are the same ([`Element`](blocksim_block::physical::Element)), so a domain is a line of words here, a
//! variant of [`Domain`] and a space of nodes in `members`.

use blocksim_block::physical::Domain;

/// What things are called in a domain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nodal {
    /// Of a difference of the across quantity, and its unit: `voltage`, `V`.
    pub across: &'static str,
    pub unit: &'static str,
    /// Of the across quantity at a node.
    pub at_node: &'static str,
    /// Of the through quantity.
    pub through: &'static str,
    /// What gives a node that nothing determines its quantity.
    pub determine: &'static str,
    /// What gives a prescribed flow a path.
    pub path: &'static str,
    /// What two parts that prescribe the same need between them.
    pub between: &'static str,
}

const ELECTRICAL: Nodal = Nodal {
    across: "voltage",
    unit: "V",
    at_node: "potential",
    through: "current",
    determine: "connect it to a source or to a reference",
    path: "connect a resistance or a capacitance there, in parallel to the source",
    between: "remove one of them, or connect them through a resistance",
};

const THERMAL: Nodal = Nodal {
    across: "temperature",
    unit: "K",
    at_node: "temperature",
    through: "heat flow",
    determine: "connect a HeatCapacity there, or a ThermalResistance that leads to an Ambient",
    path: "connect a HeatCapacity there, or a ThermalResistance that leads to an Ambient",
    between: "remove one of them, or connect them through a ThermalResistance",
};

impl Nodal {
    pub(crate) fn of(domain: Domain) -> Self {
        match domain {
            Domain::Thermal => THERMAL,
            Domain::Electrical
            | Domain::ThreePhase
            | Domain::Rotational
            | Domain::Translational
            | Domain::Frame => ELECTRICAL,
        }
    }
}
