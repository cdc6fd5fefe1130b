//! Random loops of sampled control around continuous plants, at one or two rates each.
//!
//! The reference shares no formula with the library. Plants are linear between instants: their matrix exponential is exact,
//! limits within the plant are switched where it says. Controllers are difference equations of their outputs over what has been
//! measured, not state equations.
//!
//! | file | idea |
//! |---|---|
//! | `draw` | loops of a seed |
//! | `text` | their diagram |
//! | `plant` | exact motion of a plant between two instants |
//! | `control` | controllers as difference equations |
//! | `reference` | a loop over its samples |

mod control;
mod draw;
mod plant;
mod reference;
mod text;

use super::puzzle::{Fault, Puzzle, Undecided};
use super::variants::Variant;
use crate::Run;
use reference::{Outcome, refer};

/// By how much a run at default settings may be off, as part of the size of a signal.
const SLACK: f64 = 1e-4;

/// A signal that depends on time alone.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Signal {
    Constant(f64),
    Step { time: f64, after: f64 },
    Sine { amplitude: f64, frequency: f64 },
    Pulse { amplitude: f64, period: f64, width: f64 },
}

/// What lies between the output of a plant and its controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Measuring {
    Directly,
    Hold,
    /// The mean of so many samples.
    Mean(usize),
    /// Later by so many samples.
    Late(usize),
    /// Whole multiples.
    Coarse(f64),
}

/// How a sum stands for an integral: the part of a sample that counts at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sum {
    ForwardEuler,
    BackwardEuler,
    Trapezoidal,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Windup {
    None,
    Clamping,
    BackCalculation,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Controller {
    Pid {
        kp: f64,
        ki: f64,
        kd: f64,
        n: f64,
        integrator: Sum,
        filter: Sum,
        limit: Option<f64>,
        windup: Windup,
    },
    Transfer {
        num: Vec<f64>,
        den: Vec<f64>,
    },
    Integral {
        gain: f64,
        method: Sum,
        limit: Option<f64>,
    },
}

/// A part of an actuator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Static {
    Saturation(f64),
    DeadZone(f64),
    Quantizer(f64),
}

/// A part of a plant; all have the gain 1 at rest, but for the integrator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Stage {
    Integrator(f64),
    Lag(f64),
    /// Angular frequency and damping.
    Swing(f64, f64),
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Loop {
    pub reference: Signal,
    /// Added to what the actuator gives.
    pub disturbance: Signal,
    pub ts: f64,
    pub measuring: Measuring,
    pub controller: Controller,
    /// A slower controller around the whole plant, with its sample time; then the inner one measures behind `first`.
    pub outer: Option<(f64, Controller)>,
    pub actuator: Vec<Static>,
    pub rate: Option<f64>,
    pub first: Vec<Stage>,
    /// Limits to both sides between the halves of the plant.
    pub limit: Option<f64>,
    pub second: Vec<Stage>,
    /// Samples at which what is measured lies above this are counted.
    pub count: Option<f64>,
}

/// Loops beside each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    pub(super) loops: Vec<Loop>,
    pub(super) stop: f64,
}

impl Puzzle for Sampled {
    type Outcome = Vec<Outcome>;
    const EFFORT: u32 = 0;

    fn of(seed: u64) -> Self {
        draw::draw(seed)
    }

    fn text(&self, variant: &Variant) -> String {
        text::diagram(self, variant)
    }

    /// Its plants are exact whatever the effort.
    fn refer(&self, _effort: u32, change: f64) -> Result<Vec<Outcome>, Undecided> {
        self.loops.iter().map(|one| refer(one, self.stop, SLACK, change)).collect()
    }

    fn compare(&self, outcomes: &Vec<Outcome>, run: &Run) -> Option<Fault> {
        let mut loops = self.loops.iter().zip(outcomes).enumerate();
        loops.find_map(|(i, (one, outcome))| compare(i, outcome, one, run))
    }

    fn simpler(&self) -> Vec<Self> {
        let mut all = Vec::new();
        if self.loops.len() > 1 {
            all.extend(self.loops.iter().map(|one| Sampled { loops: vec![one.clone()], ..self.clone() }));
        }
        for (i, one) in self.loops.iter().enumerate() {
            for simple in one.simpler() {
                let mut smaller = self.clone();
                smaller.loops[i] = simple;
                all.push(smaller);
            }
        }
        for share in [0.25, 0.5, 0.8] {
            all.push(Sampled { stop: super::dice::rounded(share * self.stop), ..self.clone() });
        }
        all
    }
}

impl Loop {
    fn simpler(&self) -> Vec<Loop> {
        let change = |f: &dyn Fn(&mut Loop)| {
            let mut simple = self.clone();
            f(&mut simple);
            simple
        };
        let mut all = vec![
            change(&|one| {
                one.outer = None;
                one.second.clear();
                one.limit = None;
            }),
            change(&|one| one.outer = None),
            change(&|one| one.disturbance = Signal::Constant(0.0)),
            change(&|one| one.measuring = Measuring::Directly),
            change(&|one| one.rate = None),
            change(&|one| one.limit = None),
            change(&|one| one.count = None),
            change(&|one| one.reference = Signal::Constant(1.0)),
            change(&|one| one.controller = Controller::Transfer { num: vec![0.5], den: vec![1.0] }),
        ];
        all.extend((0..self.actuator.len()).map(|i| {
            change(&|one| {
                one.actuator.remove(i);
            })
        }));
        if self.first.len() > 1 {
            all.extend((0..self.first.len()).map(|i| {
                change(&|one| {
                    one.first.remove(i);
                })
            }));
        }
        if self.second.len() > 1 {
            all.extend((0..self.second.len()).map(|i| {
                change(&|one| {
                    one.second.remove(i);
                })
            }));
        }
        all
    }
}

/// The first difference, if there is one.
fn compare(i: usize, outcome: &Outcome, one: &Loop, run: &Run) -> Option<Fault> {
    for (name, expected, slack) in outcome.ends() {
        let found = run.last(&format!("show{i}.{name}"));
        let fault = Fault::value("end", &format!("{name} of loop {i}"), found, expected, slack);
        if fault.is_some() {
            return fault;
        }
    }
    let slack = SLACK * (outcome.control_size() + 1e-3);
    for (k, &expected) in outcome.control.iter().enumerate() {
        let t = (k as f64 + 0.5) * one.ts;
        if t >= *run.time.last()? {
            break;
        }
        // What is held has no row of its own before the next sample.
        let row = run.time.partition_point(|time| *time <= t).max(1) - 1;
        let found = run.column(&format!("show{i}.c"))[row];
        let fault = Fault::value("sample", &format!("c of loop {i} in sample {k}"), found, expected, slack);
        if fault.is_some() {
            return fault;
        }
    }
    None
}
