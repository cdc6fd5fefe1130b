use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

/// Account of the energy of a physical network: what is stored, supplied and dissipated, and whether it balances.
///
/// $$ e = E - E_0 - \int P_\mathrm{supplied}\,dt + \int P_\mathrm{dissipated}\,dt $$
///
/// Connect `node` anywhere in the network: it joins nothing, and the account is that of the whole network, across
/// subsystems. Stored are motion, gravity, springs, capacitors and magnetic fields (not those of permanent magnets).
/// Supplied is what sources, prescribed speeds and inputs of torque and force bring. Dissipated is what resistances,
/// valves, dampers, friction and meshes turn into heat. A payload that is taken up or let go brings or takes its energy
/// at once, booked as supplied; where speeds or currents jump, what is missing is booked as dissipated.
///
/// Each law states the three by itself, none follows from the balance. So `error` is a check: of the blocks, and of the
/// accuracy of the run, because both integrals are states of the solver. `relative` is the error over the largest
/// energy turned over so far, the sum of all amounts by which energies have changed. Where it exceeds `tolerance` at a
/// major step, the simulation ends with an error.
///
/// A speed source whose input `dw` is not the derivative of its `w` moves masses without a torque; the error shows it. An `MmfSource` is
/// refused beside an account: what it supplies follows from the rate of its flux, which no law gives.
/// A circuit of `SwitchedInverter(integration: Separate(..))` lies outside: what its machines do at their shafts is
/// booked as supplied. The little power by which the gaps of closed loops are drawn together is booked as heat of either sign.
///
/// ```ron
/// EnergyAccount(at: Electrical, tolerance: 1e-6)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Networks", symbol = Text("ΣE"))]
pub struct EnergyAccount {
    /// What kind of port `node` is.
    #[block(default = Joins::Rotational)]
    pub at: Joins,
    /// Largest error that is allowed, relative to the energy turned over; `None` allows any.
    #[block(not_negative, default = Some(1e-3))]
    pub tolerance: Option<f64>,
    /// Energy that counts as turned over at least: what is far below it is not judged.
    #[block(
        unit = "J",
        positive,
        default = 1e-3,
        remedy = "a small part of the energies of the network, such as \"1 mJ\""
    )]
    pub floor: f64,
}

/// What ports an account can be connected to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Joins {
    /// Shafts.
    #[default]
    Rotational,
    /// Slides.
    Translational,
    /// Pins.
    Electrical,
    /// Three phases.
    ThreePhase,
    /// Magnetic poles.
    Magnetic,
    /// Hydraulic ports.
    Hydraulic,
    /// Frames of bodies.
    Frame,
}

impl From<Joins> for Domain {
    fn from(joins: Joins) -> Self {
        match joins {
            Joins::Rotational => Domain::Rotational,
            Joins::Translational => Domain::Translational,
            Joins::Electrical => Domain::Electrical,
            Joins::ThreePhase => Domain::ThreePhase,
            Joins::Magnetic => Domain::Magnetic,
            Joins::Hydraulic => Domain::Hydraulic,
            Joins::Frame => Domain::Frame,
        }
    }
}

impl Component for EnergyAccount {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("node", self.at.into(), "any node of the network")
            .measures("stored", "J", Needs::Motion, "energy in motion, gravity, springs and fields")
            .measures("supplied", "W", Needs::Motion, "power from outside")
            .measures("dissipated", "W", Needs::Motion, "power that becomes heat")
            .measures("supplied_energy", "J", Needs::Motion, "integral of `supplied`")
            .measures("dissipated_energy", "J", Needs::Motion, "integral of `dissipated`")
            .measures("error", "J", Needs::Motion, "stored more than the balance allows")
            .measures(
                "turned_over",
                "J",
                Needs::Motion,
                "largest energy turned over so far, at least `floor`",
            )
            .measures("relative", "1", Needs::Motion, "`error` over `turned_over`")
            .drifting_sum("supplied_energy", self.floor)
            .drifting_sum("dissipated_energy", self.floor)
            .jumps()
            .element(Element::EnergyAccount { tolerance: self.tolerance, floor: self.floor })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_below_zero_and_floors_of_zero_are_refused() {
        let account = EnergyAccount { at: Joins::Frame, tolerance: None, floor: 1e-3 };
        assert_eq!(account.errors()[..], []);
        assert_eq!(EnergyAccount { tolerance: Some(-1.0), ..account.clone() }.errors()[0].param, "tolerance");
        assert_eq!(EnergyAccount { floor: 0.0, ..account }.errors()[0].param, "floor");
    }
}
