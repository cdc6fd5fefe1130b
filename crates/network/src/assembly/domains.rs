//! Domains whose networks are solved by nodal analysis, and what messages call things there.
//!
//! Electricity is one; heat, magnetism and hydraulics are others: an across quantity whose differences drive a through quantity, which
//! no node keeps. Their elements are the same ([`Element`](blocksim_block::physical::Element)), so a domain is a table of words here
//! and a variant of [`Domain`].

use blocksim_block::physical::Domain;

/// What things are called in a domain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nodal {
    /// Of a difference of the across quantity, its plural, and its unit: `voltage`, `voltages`, `V`.
    pub across: &'static str,
    pub several: &'static str,
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
    /// What lets a search for an operating point begin better.
    pub beside: &'static str,
    /// The block that holds a node at zero, where a network needs one.
    pub reference: Option<&'static str>,
    /// What stores, in the plural, and the parameter with the across quantity at the start.
    pub stores: &'static str,
    pub start: &'static str,
    /// What stands between a store and a signal of unknown slope.
    pub resist: &'static str,
}

const ELECTRICAL: Nodal = Nodal {
    across: "voltage",
    several: "voltages",
    unit: "V",
    at_node: "potential",
    through: "current",
    determine: "connect it to a source or to a reference",
    path: "connect a resistance or a capacitance there, in parallel to the source",
    between: "remove one of them, or connect them through a resistance",
    beside: "connect a resistance in parallel to it, for instance Resistor(r: \"1 MOhm\")",
    reference: Some("ElectricalReference"),
    stores: "capacitors",
    start: "v0",
    resist: "a Resistor",
};

const THERMAL: Nodal = Nodal {
    across: "temperature",
    several: "temperatures",
    unit: "K",
    at_node: "temperature",
    through: "heat flow",
    determine: "connect a HeatCapacity there, or a ThermalResistance that leads to an Ambient",
    path: "connect a HeatCapacity there, or a ThermalResistance that leads to an Ambient",
    between: "remove one of them, or connect them through a ThermalResistance",
    beside: "connect a HeatCapacity there",
    reference: None,
    stores: "heat capacities",
    start: "t0",
    resist: "a ThermalResistance",
};

const MAGNETIC: Nodal = Nodal {
    across: "magnetic potential difference",
    several: "magnetic potential differences",
    unit: "A",
    at_node: "magnetic potential",
    through: "flux",
    determine: "connect a Reluctance there, or join it to the MagneticReference",
    path: "close the path of the flux, or connect a Reluctance in parallel to the winding for its leakage",
    between: "remove one of them, or connect them through a Reluctance",
    beside: "connect a Reluctance in parallel to it",
    reference: Some("MagneticReference"),
    stores: "fields",
    start: "v0",
    resist: "a Reluctance",
};

const HYDRAULIC: Nodal = Nodal {
    across: "pressure",
    several: "pressures",
    unit: "Pa",
    at_node: "pressure",
    through: "volume flow",
    determine: "connect a FluidVolume there, or a resistance that leads to a Tank",
    path: "connect a FluidVolume there, or a resistance that leads to a Tank",
    between: "remove one of them, or connect them through an Orifice or a HydraulicResistance",
    beside: "connect a FluidVolume there, or let the valve leak a little",
    reference: None,
    stores: "fluid volumes",
    start: "p0",
    resist: "a HydraulicResistance",
};

impl Nodal {
    pub(crate) fn of(domain: Domain) -> Self {
        match domain {
            Domain::Thermal => THERMAL,
            Domain::Magnetic => MAGNETIC,
            Domain::Hydraulic => HYDRAULIC,
            Domain::Electrical
            | Domain::ThreePhase
            | Domain::Rotational
            | Domain::Translational
            | Domain::Frame => ELECTRICAL,
        }
    }
}
