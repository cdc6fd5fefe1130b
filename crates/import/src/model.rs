//! A mechanism as a tree of rigid bodies, for those who want its dynamics without a diagram.

use blocksim_multibody::{BodyId, Inertia, Joint as Freedom, Model, ModelBuilder, ModelError, Placement};

use crate::mechanism::{Joint, Mechanism, Motion};

/// Where a body of the file is: fixed to a body of the model (`None`: to the ground).
#[derive(Debug, Clone, Copy)]
struct Seat {
    on: Option<BodyId>,
    place: Placement,
}

/// A tree of rigid bodies and what its joints are called in it.
#[derive(Debug, Clone)]
pub struct Tree {
    /// The bodies, gravity along -z.
    pub model: Model,
    /// The last body that each joint of the mechanism moves; welds have none.
    pub moved: Vec<Option<BodyId>>,
}

/// The tree of rigid bodies of a mechanism.
///
/// # Errors
/// Masses or axes that are impossible.
///
/// Returns `None` where joints close a loop or bodies hang on nothing: that is no tree.
pub fn model(mechanism: &Mechanism) -> Result<Option<Tree>, ModelError> {
    let mut builder = ModelBuilder::new();
    let mut moved: Vec<Option<BodyId>> = vec![None; mechanism.joints.len()];
    let mut seats: Vec<Option<Seat>> = vec![None; mechanism.bodies.len()];
    // Bodies that no joint moves stand on the ground.
    for (i, seat) in seats.iter_mut().enumerate() {
        if mechanism.joints.iter().all(|joint| joint.follower != i) {
            *seat = Some(Seat { on: None, place: Placement::identity() });
        }
    }
    let mut left: Vec<usize> = (0..mechanism.joints.len()).collect();
    while !left.is_empty() {
        let before = left.len();
        let mut waiting = Vec::new();
        for index in left {
            let joint = &mechanism.joints[index];
            let base = match joint.base {
                None => Some(Seat { on: None, place: Placement::identity() }),
                Some(base) => seats[base],
            };
            match base {
                None => waiting.push(index),
                Some(_) if seats[joint.follower].is_some() => return Ok(None),
                Some(base) => {
                    let seat = add(&mut builder, joint, base)?;
                    moved[index] = seat.on.filter(|_| joint.motion != Motion::Weld);
                    seats[joint.follower] = Some(seat);
                }
            }
        }
        if waiting.len() == before {
            return Ok(None);
        }
        left = waiting;
    }
    for (body, seat) in mechanism.bodies.iter().zip(&seats) {
        if let (Some(inertia), Some(Seat { on: Some(on), place })) = (body.inertia, seat) {
            builder.add_inertia(*on, *place, inertia)?;
        }
    }
    Ok(Some(Tree { model: builder.build(), moved }))
}

/// Adds what a joint moves; the masses come later.
fn add(builder: &mut ModelBuilder, joint: &Joint, base: Seat) -> Result<Seat, ModelError> {
    let here = base.place * joint.in_base;
    let back = joint.in_follower.map_or_else(Placement::identity, |place| place.inverse());
    let chain: Vec<Freedom> = match joint.motion {
        Motion::Weld => return Ok(Seat { on: base.on, place: here * back }),
        Motion::Revolute { axis } => vec![Freedom::revolute(axis)],
        Motion::Prismatic { axis } => vec![Freedom::prismatic(axis)],
        Motion::Cylindrical => Freedom::cylindrical([0.0, 0.0, 1.0]).to_vec(),
        Motion::Planar => Freedom::planar().to_vec(),
        Motion::Spherical => vec![Freedom::Spherical],
        Motion::Free => Freedom::free().to_vec(),
    };
    let bodies = builder.add_chain(base.on, &chain, here, Inertia::zero())?;
    Ok(Seat { on: bodies.last().copied(), place: back })
}
