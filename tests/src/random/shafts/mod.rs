//! Random shafts: discs with springs, dampers, bearings, clutches that engage and disengage, freewheels and ends of travel, driven
//! by torques over time and by sampled controllers of speed.
//!
//! The reference knows no modes: in each of its many short steps it finds the impulses of all joints, those of frictions and
//! freewheels within their bounds, by projected Gauss-Seidel (J. J. Moreau, *Unilateral contact and dry friction in finite freedom
//! dynamics*, 1988; M. Jean, *The non-smooth contact dynamics method*, 1999).
//!
//! | file | idea |
//! |---|---|
//! | `draw` | shafts of a seed |
//! | `text` | their diagram |
//! | `walk` | motion in time |
//! | `reference` | what comes out, and by how much it may be off |

mod draw;
mod reference;
mod text;
mod walk;

use super::changes::{changes, sizes};
use super::dice::rounded;
use super::puzzle::{Fault, Puzzle, Undecided};
use super::variants::Variant;
use crate::Run;
use reference::Outcome;

/// What joins two discs, or a disc and the housing. In N*m and rad.
#[allow(missing_docs, reason = "fields are named as the parameters of the blocks")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Joint {
    /// Spring and damper.
    Spring { k: f64, d: f64 },
    /// Bearing or clutch: the same torque at rest and while sliding. A clutch may be pressed for half of each period only.
    Friction(f64, Option<f64>),
    /// Lets the first end turn backwards against the second, and not forwards.
    Freewheel,
    /// Free between two angles, a spring and a damper beyond them, over a width.
    Stop { at: f64, k: f64, d: f64, width: f64 },
}

/// A torque on a disc, against the housing.
#[allow(missing_docs, reason = "fields are named as the parameters of the blocks")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Torque {
    /// `amplitude sin(2 pi frequency t)`.
    Sine { amplitude: f64, frequency: f64 },
    /// From one value to another.
    Step { time: f64, before: f64, after: f64 },
    /// Held from sample to sample: proportional to what is missing to a speed, within limits to both sides.
    Sampled { ts: f64, gain: f64, target: f64, limit: f64 },
}

/// Discs and what lies between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Shafts {
    /// Moment of inertia and speed at the start.
    pub discs: Vec<(f64, f64)>,
    /// Discs at both ends of the part, and its kind. Without a second disc it is attached to the housing.
    pub joints: Vec<(usize, Option<usize>, Joint)>,
    /// Disc, and what drives it.
    pub torques: Vec<(usize, Torque)>,
    /// End of the run, s.
    pub stop: f64,
}

impl Puzzle for Shafts {
    type Outcome = Outcome;

    fn of(seed: u64) -> Self {
        draw::draw(seed)
    }

    fn text(&self, variant: &Variant) -> String {
        text::diagram(self, variant)
    }

    fn refer(&self, effort: u32, change: f64) -> Result<Outcome, Undecided> {
        reference::refer(self, effort, change)
    }

    fn compare(&self, outcome: &Outcome, run: &Run) -> Option<Fault> {
        let mut ends = outcome.names.iter().enumerate().map(|(k, name)| {
            let found = run.last(&format!("scope.{name}"));
            Fault::value("end", name, found, outcome.values[k], outcome.slack[k])
        });
        ends.find_map(|fault| fault).or_else(|| self.compare_slides(outcome, run))
    }

    fn simpler(&self) -> Vec<Self> {
        let mut all = Vec::new();
        for share in [0.25, 0.5, 0.8] {
            all.push(Shafts { stop: rounded(share * self.stop), ..self.clone() });
        }
        if self.discs.len() > 1 {
            all.extend((0..self.discs.len()).map(|i| self.without(i)));
        }
        for k in 0..self.joints.len() {
            let mut fewer = self.clone();
            fewer.joints.remove(k);
            all.push(fewer);
        }
        for k in 0..self.torques.len() {
            let mut fewer = self.clone();
            fewer.torques.remove(k);
            all.push(fewer);
        }
        for i in 0..self.discs.len() {
            let mut still = self.clone();
            still.discs[i].1 = 0.0;
            all.push(still);
        }
        for (k, (_, _, joint)) in self.joints.iter().enumerate() {
            if let Joint::Friction(torque, Some(_)) = joint {
                let mut simple = self.clone();
                simple.joints[k].2 = Joint::Friction(*torque, None);
                all.push(simple);
            }
        }
        all
    }
}

impl Shafts {
    /// How often joints begin and end to slide.
    fn compare_slides(&self, outcome: &Outcome, run: &Run) -> Option<Fault> {
        let speeds = |disc: usize| run.column(&format!("scope.w{disc}"));
        self.joints.iter().zip(&outcome.slides).enumerate().find_map(|(k, ((a, b, _), known))| {
            let known = (*known)?;
            let mut slip = speeds(*a).to_vec();
            b.iter().for_each(|b| slip.iter_mut().zip(speeds(*b)).for_each(|(slip, w)| *slip -= w));
            let (times, sizes) = sizes(&run.time, &slip);
            let beyond: Vec<f64> = sizes.iter().map(|size| size - outcome.slip).collect();
            let found = changes(&times, &beyond, outcome.least);
            let what = || format!("joint {k} has begun or ended to slide {found} times instead of {known}");
            (found != known).then(|| Fault::new("slides", what()))
        })
    }

    /// Without a disc and all that acts on it.
    fn without(&self, disc: usize) -> Shafts {
        let mut fewer = self.clone();
        fewer.discs.remove(disc);
        fewer.joints.retain(|(a, b, _)| *a != disc && *b != Some(disc));
        fewer.torques.retain(|(at, _)| *at != disc);
        let later = |i: &mut usize| *i -= usize::from(*i > disc);
        for (a, b, _) in &mut fewer.joints {
            later(a);
            b.iter_mut().for_each(later);
        }
        fewer.torques.iter_mut().for_each(|(at, _)| later(at));
        fewer
    }
}
