//! Random mechanisms: pendulum chains with springs, dampers, dry friction and ends of travel, slider-cranks and four-bar linkages as closed
//! loops with dry friction, balls that bounce and slide on planes. Some of the drives are sampled controllers.
//!
//! The reference knows no bodies, joints or loops: it has equations of Lagrange in least coordinates, whose energies
//! follow from geometry in closed form, short equal steps, and bisection where friction begins to stick or to slide.
//!
//! | file | idea |
//! |---|---|
//! | `draw` | mechanisms of a seed |
//! | `text` | their diagram |
//! | `jet` | numbers with two derivatives |
//! | `plant` | equations of motion in least coordinates |
//! | `walk` | motion in time, with friction that sticks and slides |

mod draw;
mod jet;
mod plant;
mod text;
mod walk;

use super::changes::changes;
use super::puzzle::{Fault, Puzzle, Undecided};
use super::variants::Variant;
use crate::Run;
use walk::{Ends, refer};

/// By how much a run at default settings may be off, as part of the size of a motion.
const SLACK: f64 = 2e-4;
/// The same of a ball, whose errors grow from bounce to bounce: a stiff contact lasts a few steps.
const BOUNCING: f64 = 1e-3;

/// Gravity, m/s^2.
pub(super) const GRAVITY: f64 = 9.80665;

/// An end of travel to both sides of zero: where it is, stiffness, damping, width over which it sets in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limit {
    pub at: f64,
    pub stiffness: f64,
    pub damping: f64,
    pub width: f64,
}

/// What acts in a joint; zero is nothing. In N*m and rad, or N and m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Joint {
    pub stiffness: f64,
    pub relaxed: f64,
    pub damping: f64,
    pub friction: f64,
    pub limit: Option<Limit>,
}

/// The torque at the first joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Drive {
    None,
    Constant(f64),
    Step {
        time: f64,
        after: f64,
    },
    Sine {
        amplitude: f64,
        frequency: f64,
    },
    /// Held from sample to sample: towards an angle, against speed, within limits to both sides.
    Sampled {
        ts: f64,
        target: f64,
        kp: f64,
        kd: f64,
        limit: f64,
    },
}

/// A bar: length, mass, centre of mass from its near end, moment of inertia about that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bar {
    pub length: f64,
    pub mass: f64,
    pub centre: f64,
    pub inertia: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Mechanism {
    /// Bars that hang on each other, with angles against each other and speeds at the start.
    Chain { bars: Vec<Bar>, joints: Vec<Joint>, start: Vec<(f64, f64)>, drive: Drive },
    /// Crank, rod, mass of the slider; what acts at the crank and at the slider; angle and speed of the crank.
    Slider { crank: Bar, rod: Bar, piston: f64, joints: [Joint; 2], start: (f64, f64), drive: Drive },
    /// Crank, coupler, rocker, ground; what acts at crank and rocker; angle and speed of the crank.
    FourBar { bars: [Bar; 3], ground: f64, joints: [Joint; 2], start: (f64, f64), drive: Drive },
    /// A mass point over a tilted plane: stiffness, damping, width, friction and its speed; height and velocity.
    Ball {
        mass: f64,
        tilt: f64,
        stiffness: f64,
        damping: f64,
        width: f64,
        friction: f64,
        slow: f64,
        start: [f64; 3],
    },
}

/// Mechanisms beside each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanisms {
    pub(super) all: Vec<Mechanism>,
    pub(super) stop: f64,
}

impl Puzzle for Mechanisms {
    type Outcome = Vec<Ends>;
    const EFFORT: u32 = 2;

    fn of(seed: u64) -> Self {
        draw::draw(seed)
    }

    fn text(&self, variant: &Variant) -> String {
        text::diagram(self, variant)
    }

    fn refer(&self, effort: u32, change: f64) -> Result<Vec<Ends>, Undecided> {
        let known = |one: &Mechanism| {
            let ends = refer(one, self.stop, SLACK, effort, change)?;
            Ok(if matches!(one, Mechanism::Ball { .. }) { ends.at_least(BOUNCING) } else { ends })
        };
        self.all.iter().map(known).collect()
    }

    fn compare(&self, ends: &Vec<Ends>, run: &Run) -> Option<Fault> {
        ends.iter().enumerate().find_map(|(i, ends)| compare(i, ends, run))
    }

    fn simpler(&self) -> Vec<Self> {
        let mut all = Vec::new();
        if self.all.len() > 1 {
            all.extend(self.all.iter().map(|one| Mechanisms { all: vec![one.clone()], ..self.clone() }));
        }
        for (i, one) in self.all.iter().enumerate() {
            for simple in one.simpler() {
                let mut smaller = self.clone();
                smaller.all[i] = simple;
                all.push(smaller);
            }
        }
        for share in [0.25, 0.5, 0.8] {
            all.push(Mechanisms { stop: super::dice::rounded(share * self.stop), ..self.clone() });
        }
        all
    }
}

impl Mechanism {
    fn simpler(&self) -> Vec<Mechanism> {
        let mut all = Vec::new();
        if let Mechanism::Chain { bars, joints, start, drive } = self
            && bars.len() > 1
        {
            let n = bars.len() - 1;
            let (bars, joints, start) = (bars[..n].to_vec(), joints[..n].to_vec(), start[..n].to_vec());
            all.push(Mechanism::Chain { bars, joints, start, drive: *drive });
        }
        let mut still = self.clone();
        if let Some(drive) = still.drive() {
            *drive = Drive::None;
            all.push(still);
        }
        for k in 0..self.clone().joints().len() {
            for part in 0..4 {
                let mut fewer = self.clone();
                let joint = &mut fewer.joints()[k];
                match part {
                    0 => joint.friction = 0.0,
                    1 => joint.limit = None,
                    2 => joint.stiffness = 0.0,
                    _ => joint.damping = 0.0,
                }
                all.push(fewer);
            }
        }
        all
    }

    fn drive(&mut self) -> Option<&mut Drive> {
        match self {
            Mechanism::Chain { drive, .. }
            | Mechanism::Slider { drive, .. }
            | Mechanism::FourBar { drive, .. } => Some(drive),
            Mechanism::Ball { .. } => None,
        }
    }

    fn joints(&mut self) -> &mut [Joint] {
        match self {
            Mechanism::Chain { joints, .. } => joints,
            Mechanism::Slider { joints, .. } | Mechanism::FourBar { joints, .. } => joints,
            Mechanism::Ball { .. } => &mut [],
        }
    }
}

/// The first difference, if there is one.
fn compare(i: usize, ends: &Ends, run: &Run) -> Option<Fault> {
    let name = |k: usize| format!("show{i}.v{k}");
    let mut values = ends.values.iter().zip(&ends.slack).enumerate().map(|(k, (expected, slack))| {
        Fault::value("end", &format!("v{k} of mechanism {i}"), run.last(&name(k)), *expected, *slack)
    });
    let fault = values.find_map(|fault| fault);
    fault.or_else(|| {
        ends.changes.iter().enumerate().find_map(|(k, known)| {
            let known = (*known)?;
            let found = changes(&run.time, run.column(&name(k)), ends.least(k));
            let what =
                || format!("v{k} of mechanism {i} has changed its sign {found} times instead of {known}");
            (found != known).then(|| Fault::new("changes", what()))
        })
    })
}
