//! Physical networks: components joined by conserving connections become one block with states.
//!
//! [`assemble`] takes the components of one connected network and the sets of ports that are joined, eliminates
//! what is rigid or ideal exactly, and returns a [`Network`], which is an ordinary block: its inputs are the
//! signals that drive sources, its outputs what sensors read. No equation is solved simultaneously while it runs
//! but one: accelerations and the losses of gear meshes.
//!
//! Mechanics: every speed is `w = T v + P s` with independent speeds `v` (joints first) and prescribed speeds
//! `s`; `T` and `P` are constant. Then `(M(q) + T'JT) dv = T' tau - h(q, v)`: rotors and gears act inside the mass
//! matrix. Electrics: potentials follow from the sources, currents of windings from states or from voltages, the
//! currents of sources from Kirchhoff's law; torques follow, then accelerations. Rotation and translation are one
//! system: what the code calls speed, torque and inertia are velocity, force and mass at translational ports.
//!
//! | module | idea |
//! |---|---|
//! | `assembly` | from members to a network, once |
//! | `mechanics`, `electrics` | the two sides: what is known beforehand, and what each evaluation does |
//! | `implicit` | what linearly implicit methods are told |
//! | `energy`, `accounts` | what becomes of energy, and its books |
//! | `describe` | what others may see of the mechanics |
//! | `network`, `member`, `seat` | its values, its members and where theirs lie |
//! | `readings` | outputs that are numbers of the network |
//! | `work`, `law` | the working space of an evaluation, and what members see of it |
//! | `start`, `block` | what must hold before a run; the network as a block |

mod accounts;
mod assembly;
mod block;
mod describe;
mod electrics;
mod energy;
mod implicit;
mod invariants;
mod law;
mod mechanics;
mod member;
mod network;
mod problem;
mod readings;
mod seat;
mod start;
mod work;

pub use assembly::assemble;
pub use describe::{AxisView, PartView};
pub use member::{Member, Terminal};
pub use network::Network;
pub use problem::NetworkProblem;
