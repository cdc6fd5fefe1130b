//! What comes out of shafts, and by how much it may be off.

use super::super::changes::{certain, doubt};
use super::super::dice::Dice;
use super::super::puzzle::Undecided;
use super::walk::Walk;
use super::{Joint, Shafts};

/// Longest step of the coarse run at the least effort, s, and by how much it is shorter at the next.
const STEP: f64 = 2e-4;
const FINER: f64 = 8.0;
/// Torques are changed by this part to see what depends on them.
const CHANGE: f64 = 1e-5;
/// By how much a run at default settings may be off, as part of the maximum speed.
const SLACK: f64 = 5e-4;

/// A joint slides from this part of the maximum speed on. What begins or ends to slide goes on by so much beyond that and stays so
/// for this part of the run.
const SLIDES: f64 = 0.02;
const BAND: f64 = 3e-3;
const MOMENT: f64 = 3e-3;

/// Speeds and angles in the end.
#[derive(Debug)]
pub struct Outcome {
    /// Names of the values in the recording.
    pub names: Vec<String>,
    pub values: Vec<f64>,
    /// By how much each may be off.
    pub slack: Vec<f64>,
    /// How often each friction and freewheel begins or ends to slide; `None` for other joints and where that is not known.
    pub slides: Vec<Option<u32>>,
    /// Slip from which a joint slides, how much beyond counts, both rad/s, and for how long, s.
    pub slip: f64,
    pub least: (f64, f64),
    sizes: Vec<f64>,
}

/// What comes out, or why nobody knows.
pub(super) fn refer(shafts: &Shafts, effort: u32, change: f64) -> Result<Outcome, Undecided> {
    let step = STEP / FINER.powi(effort as i32);
    let exact = vec![0.0; shafts.torques.len() + shafts.joints.len()];
    let coarse = walk(shafts, step, &exact);
    let mut fine = walk(shafts, 0.5 * step, &exact);
    fine.slack = fine.sizes.iter().map(|size| SLACK * size).collect();
    fine.widen(&coarse, &fine.values.clone(), 2.0);
    if !fine.is_known() {
        return Err(Undecided::Coarse);
    }
    doubt(&mut fine.slides, &coarse.slides);
    for seed in [1, 2] {
        let mut dice = Dice::new(seed);
        let changes: Vec<f64> = exact.iter().map(|_| change * CHANGE * (2.0 * dice.unit() - 1.0)).collect();
        let other = walk(shafts, step, &changes);
        fine.widen(&coarse, &other.values, 5.0);
        doubt(&mut fine.slides, &other.slides);
    }
    if fine.is_known() { Ok(fine) } else { Err(Undecided::Sensitive) }
}

impl Outcome {
    /// Adds to the slack what two runs differ by.
    fn widen(&mut self, a: &Outcome, b: &[f64], factor: f64) {
        let off = a.values.iter().zip(b).map(|(a, b)| factor * (a - b).abs());
        self.slack.iter_mut().zip(off).for_each(|(slack, off)| *slack = slack.max(off));
    }

    fn is_known(&self) -> bool {
        self.slack.iter().zip(&self.sizes).all(|(slack, size)| *slack <= 5.0 * SLACK * size)
    }
}

fn walk(shafts: &Shafts, step: f64, changes: &[f64]) -> Outcome {
    let mut walk = Walk::new(shafts, changes);
    walk.go(shafts.stop, step);
    let size = walk.largest + 1e-2;
    let (slip, least) = (SLIDES * size, (BAND * size, MOMENT * shafts.stop));
    let number = |(slips, (_, _, joint)): (&Vec<f64>, &(usize, Option<usize>, Joint))| {
        let slides: Vec<f64> = slips.iter().map(|now| now.abs() - slip).collect();
        let is_counted = matches!(joint, Joint::Friction(..) | Joint::Freewheel);
        if is_counted { certain(&walk.times, &slides, least) } else { None }
    };
    let slides = walk.slips.iter().zip(&shafts.joints).map(number).collect();
    let (names, values, sizes) = (Vec::new(), Vec::new(), Vec::new());
    let mut outcome = Outcome { names, values, slack: Vec::new(), slides, slip, least, sizes };
    for (i, (w, phi)) in walk.w.iter().zip(&walk.phi).enumerate() {
        outcome.names.extend([format!("w{i}"), format!("phi{i}")]);
        outcome.values.extend([*w, *phi]);
        outcome.sizes.extend([size, shafts.stop * size]);
    }
    outcome
}
