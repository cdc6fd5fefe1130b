//! Bodies and joints of a network: a tree, what members see of it, and the loops that it closes.

use blocksim_multibody::{BodyId, Data, Inertia, Model};
use blocksim_scene::Scene;

use crate::mechanics::place::Place;

/// The multibody side of a network.
#[derive(Debug, Clone, Default)]
pub(crate) struct Frames {
    /// The tree; `None` without frames.
    pub model: Option<Model>,
    /// Speeds of the joints in the order of the model.
    pub speeds: Vec<JointSpeed>,
    /// Balls among the joints.
    pub balls: Vec<Ball>,
    /// Positions at the start.
    pub position: Vec<f64>,
    /// The same as they are given, before loops are closed.
    pub asked: Vec<f64>,
    /// Names of the positions.
    pub position_names: Vec<String>,
    /// Names of the positions as recorded signals.
    pub signals: Vec<String>,
    /// How it looks.
    pub scene: Scene,
    /// Frames that members look at, in the order of the members.
    pub probes: Vec<Probe>,
    /// Bodies that come and go.
    pub payloads: Vec<Payload>,
    /// Member of the joint of each body, in the order of the model.
    pub body_members: Vec<usize>,
    /// Frames that must coincide.
    pub loops: Vec<Loop>,
}

/// A speed of a joint.
#[derive(Debug, Clone)]
pub(crate) struct JointSpeed {
    pub member: usize,
    /// Index of the freedom among those of the joints of the member.
    pub freedom: usize,
    /// Its position; `None` of a ball.
    pub position: Option<usize>,
    /// Where the member looks for it: members count from `base`, the tree from the world.
    pub user: usize,
    pub name: String,
    /// Speed at the start, in the terms of the tree.
    pub start: Option<f64>,
    /// The position at the start is given.
    pub given: bool,
    /// It is a length.
    pub slides: bool,
}

/// A ball among the freedoms of a joint.
#[derive(Debug, Clone)]
pub(crate) struct Ball {
    pub member: usize,
    /// First position.
    pub position: usize,
    /// First speed in the tree.
    pub speed: usize,
    /// First speed of the member.
    pub user: usize,
    /// The tree goes from `follower` to `base`.
    pub flipped: bool,
}

/// A frame that a member looks at.
#[derive(Debug, Clone)]
pub(crate) struct Probe {
    pub member: usize,
    pub place: Place,
    /// The member acts on it, too.
    pub acts: bool,
}

/// A body that comes and goes.
#[derive(Debug, Clone)]
pub(crate) struct Payload {
    pub member: usize,
    /// `None` is the world: it then changes nothing.
    pub body: Option<BodyId>,
    /// In the frame of the body.
    pub inertia: Inertia,
}

/// Two frames that must coincide, because a member closes a loop.
#[derive(Debug, Clone)]
pub(crate) struct Loop {
    pub member: usize,
    pub a: Place,
    pub b: Place,
}

impl Frames {
    pub(crate) fn data(&self) -> Option<Data> {
        self.model.as_ref().map(Model::data)
    }

    /// Index of the first speed of a freedom of a joint.
    pub(crate) fn speed_of(&self, member: usize, freedom: usize) -> Option<usize> {
        self.speeds.iter().position(|speed| speed.member == member && speed.freedom == freedom)
    }

    /// Members of the joints of a loop, without those that lead to both its ends.
    pub(crate) fn joints_between(&self, closing: &Loop) -> Vec<usize> {
        let way = |place: &Place| {
            let parent = |body: &BodyId| self.model.as_ref()?.parent(*body);
            std::iter::successors(place.body, parent).collect::<Vec<BodyId>>()
        };
        let (a, b) = (way(&closing.a), way(&closing.b));
        let one_way =
            a.iter().filter(|body| !b.contains(body)).chain(b.iter().filter(|body| !a.contains(body)));
        let mut members: Vec<usize> = one_way.map(|body| self.body_members[body.index()]).collect();
        members.sort_unstable();
        members.dedup();
        members
    }

    /// Frames that a member looks at.
    pub(crate) fn probe_range(&self, member: usize) -> std::ops::Range<usize> {
        let of_member = |probe: &Probe| probe.member == member;
        let first = self.probes.iter().position(of_member).unwrap_or(0);
        first..first + self.probes.iter().filter(|probe| of_member(probe)).count()
    }

    /// Gives the speeds of each member consecutive numbers in the order of its freedoms; the tree may hold those of
    /// others in between, and from the far end.
    pub(super) fn number_by_member(&mut self) {
        let mut order: Vec<usize> = (0..self.speeds.len()).collect();
        order.sort_by_key(|i| (self.speeds[*i].member, self.speeds[*i].freedom, *i));
        for (user, i) in order.into_iter().enumerate() {
            self.speeds[i].user = user;
        }
        for ball in &mut self.balls {
            ball.user = self.speeds[ball.speed].user;
        }
    }

    /// Speeds of the joints of a member as it counts them.
    pub(crate) fn user_range(&self, member: usize) -> std::ops::Range<usize> {
        let of_member = || self.speeds.iter().filter(|speed| speed.member == member).map(|speed| speed.user);
        let first = of_member().min().unwrap_or(0);
        first..first + of_member().count()
    }
}
