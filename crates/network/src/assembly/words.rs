//! What messages call things in rotation and in translation.

use blocksim_block::physical::Domain;

/// Words of one kind of mechanics.
#[derive(Debug)]
pub(crate) struct Words {
    /// What resists acceleration.
    pub inertia: &'static str,
    /// A block that has it, with its article.
    pub part: &'static str,
    /// The block that stands still.
    pub reference: &'static str,
    /// Symbol of the speed in names of states.
    pub speed: &'static str,
    /// Unit of the speed.
    pub unit: &'static str,
}

impl Words {
    pub(crate) fn of(domain: Domain) -> Words {
        match domain {
            Domain::Translational => Words {
                inertia: "mass",
                part: "a Mass",
                reference: "TranslationalReference",
                speed: "v",
                unit: "m/s",
            },
            _ => Words {
                inertia: "inertia",
                part: "an Inertia",
                reference: "RotationalReference",
                speed: "w",
                unit: "rad/s",
            },
        }
    }
}
