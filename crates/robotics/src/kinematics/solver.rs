//! The general solver: damped least squares between bounds, with restarts.

use crate::kinematics::constraint::Constraint;
use crate::kinematics::error::SolveError;
use crate::kinematics::normal_equations::NormalEquations;
use crate::kinematics::random::Random;
use crate::kinematics::range::JointRange;
use crate::kinematics::residual::Rows;
use blocksim_multibody::{Data, Joint, Model, forward_kinematics};
use std::borrow::Borrow;
use std::f64::consts::PI;

/// Steps without much progress after which a descent is given up for another one.
const PATIENCE: usize = 4;
/// Steps of the last descent, which goes to the bottom where not all constraints can be fulfilled.
const LAST: usize = 300;

/// How the solver works.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// By how much a constraint may exceed its tolerance and count as fulfilled, m and rad.
    pub accuracy: f64,
    /// Steps of one descent.
    pub iterations: usize,
    /// Further descents from random positions where the first one does not fulfil all constraints. Along a path choose
    /// 0: a restart may jump to another configuration.
    pub restarts: usize,
    /// Start of the random numbers; the same start gives the same result.
    pub random_seed: u64,
}

impl Default for Options {
    /// Accuracy 1e-8, 40 steps, 100 restarts.
    fn default() -> Self {
        Options { accuracy: 1e-8, iterations: 40, restarts: 100, random_seed: 0 }
    }
}

/// Whether all constraints are fulfilled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// All are.
    Success,
    /// Not all: the positions are those with the least weighted sum of squared violations that was found.
    BestAvailable,
}

/// What became of one constraint.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// By how much it exceeds its tolerance, m and rad: position and angle of a pose, the three axes of a box, one
    /// number per joint, or the one number of the others.
    pub violation: Vec<f64>,
    /// Whether all of it is within the accuracy.
    pub satisfied: bool,
}

/// The outcome.
#[derive(Debug, Clone, PartialEq)]
pub struct Solved {
    /// Joint positions, rad or m, within the ranges.
    pub q: Vec<f64>,
    /// Whether all constraints are fulfilled.
    pub status: Status,
    /// Steps of all descents.
    pub iterations: usize,
    /// Descents after the first.
    pub restarts: usize,
    /// One report per constraint, in their order.
    pub reports: Vec<Report>,
}

/// Finds joint positions that fulfil a stack of [`Constraint`]s, for any tree of axes.
///
/// Levenberg-Marquardt with a damping in proportion to the remaining error (Chan and Lawrence 1988), steps projected
/// onto the ranges of the joints, restarts from random positions. The workspace is made once; with [`Solver::solve_into`]
/// nothing is allocated later. The model is borrowed (`Solver<&Model>`) or owned (`Solver<Model>`).
///
/// ```
/// use blocksim_robotics::kinematics::{Constraint, JointRange, Options, Solver, Status};
/// use blocksim_multibody::{Frame, Inertia, Joint, ModelBuilder, Placement};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut builder = ModelBuilder::new();
/// let hinge = Joint::revolute([0.0, 0.0, 1.0]);
/// let upper = builder.add_body(None, hinge, Placement::identity(), Inertia::zero())?;
/// let elbow = Placement::from_translation([1.0, 0.0, 0.0]);
/// let lower = builder.add_body(Some(upper), hinge, elbow, Inertia::zero())?;
/// let arm = builder.build();
/// let hand = Frame::of(lower).at(Placement::from_translation([1.0, 0.0, 0.0]));
///
/// let mut solver = Solver::new(&arm, &[JointRange { lower: -2.0, upper: 2.0 }; 2])?;
/// let target = [Constraint::position(hand, Frame::ground(), [1.0, 1.0, 0.0])];
/// let solved = solver.solve(&target, &[0.1, 0.1], &Options::default())?;
/// assert_eq!(solved.status, Status::Success);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Solver<M> {
    model: M,
    ranges: Vec<JointRange>,
    data: Data,
    rows: Rows,
    trial: Rows,
    equations: NormalEquations,
    /// Positions that are tried, from which a descent is at, and the best ones so far.
    tried: Vec<f64>,
    q: Vec<f64>,
    best: Vec<f64>,
}

impl<M: Borrow<Model>> Solver<M> {
    /// A solver for a model of axes. `ranges` has one entry per joint, in the order of the bodies; they always hold.
    ///
    /// # Errors
    /// [`SolveError::NoJoint`], [`SolveError::Spherical`], [`SolveError::WrongLength`],
    /// [`SolveError::BoundsCrossed`].
    pub fn new(model: M, ranges: &[JointRange]) -> Result<Self, SolveError> {
        let known = model.borrow();
        let n = known.dof();
        if n == 0 {
            return Err(SolveError::NoJoint);
        }
        if let Some(body) = known.bodies().find(|body| *known.joint(*body) == Joint::Spherical) {
            return Err(SolveError::Spherical { body: body.index() });
        }
        if ranges.len() != n {
            return Err(SolveError::WrongLength { list: "joint ranges", given: ranges.len(), joints: n });
        }
        if let Some(entry) = ranges.iter().position(|range| !range.is_sound()) {
            return Err(SolveError::BoundsCrossed { constraint: None, entry });
        }
        let data = known.data();
        Ok(Solver {
            model,
            ranges: ranges.to_vec(),
            data,
            rows: Rows::new(n),
            trial: Rows::new(n),
            equations: NormalEquations::new(n),
            tried: vec![0.0; n],
            q: vec![0.0; n],
            best: vec![0.0; n],
        })
    }

    /// Positions for the constraints, searched from `seed` (one entry per joint, put into the ranges).
    ///
    /// # Errors
    /// [`SolveError`] names a seed or a constraint that cannot be worked with. Constraints that cannot be fulfilled are
    /// no error: see [`Solved::status`].
    pub fn solve(
        &mut self,
        constraints: &[Constraint],
        seed: &[f64],
        options: &Options,
    ) -> Result<Solved, SolveError> {
        let (iterations, restarts) = self.search(constraints, seed, options)?;
        let reports = self.reports(constraints, options.accuracy);
        let status = self.status(options.accuracy);
        Ok(Solved { q: self.best.clone(), status, iterations, restarts, reports })
    }

    /// As [`Solver::solve`], into `q` and without allocating; stacks of more than sixteen rows may allocate once.
    ///
    /// # Errors
    /// Those of [`Solver::solve`], or [`SolveError::WrongLength`] for `q`.
    pub fn solve_into(
        &mut self,
        constraints: &[Constraint],
        seed: &[f64],
        options: &Options,
        q: &mut [f64],
    ) -> Result<Status, SolveError> {
        let joints = self.model.borrow().dof();
        if q.len() != joints {
            return Err(SolveError::WrongLength { list: "result", given: q.len(), joints });
        }
        self.search(constraints, seed, options)?;
        q.copy_from_slice(&self.best);
        Ok(self.status(options.accuracy))
    }

    /// Leaves the best positions, and the rows there. Steps of all descents, descents after the first.
    fn search(
        &mut self,
        constraints: &[Constraint],
        seed: &[f64],
        options: &Options,
    ) -> Result<(usize, usize), SolveError> {
        let joints = self.model.borrow().dof();
        if seed.len() != joints {
            return Err(SolveError::WrongLength { list: "start", given: seed.len(), joints });
        }
        if !seed.iter().all(|q| q.is_finite()) {
            return Err(SolveError::NotFinite { what: "a position", constraint: None });
        }
        for (i, constraint) in constraints.iter().enumerate() {
            constraint.check(i, self.model.borrow())?;
        }
        let mut random = Random(options.random_seed);
        for (i, range) in self.ranges.iter().enumerate() {
            self.q[i] = range.clamp(seed[i]);
        }
        self.best.copy_from_slice(&self.q);
        let mut least = f64::INFINITY;
        let (mut iterations, mut restarts) = (0, 0);
        loop {
            let (steps, cost) = self.descend(constraints, options, PATIENCE);
            iterations += steps;
            let fulfilled = self.rows.worst() <= options.accuracy;
            if cost < least || fulfilled {
                least = cost;
                self.best.copy_from_slice(&self.q);
            }
            if fulfilled || restarts == options.restarts {
                break;
            }
            restarts += 1;
            for (i, seed) in seed.iter().enumerate() {
                let JointRange { lower, upper } = self.around(i, *seed);
                self.q[i] = lower + (upper - lower) * random.unit();
            }
        }
        if self.rows.worst() > options.accuracy {
            let thorough = Options { iterations: LAST, ..*options };
            self.q.copy_from_slice(&self.best);
            iterations += self.descend(constraints, &thorough, LAST).0;
            self.best.copy_from_slice(&self.q);
        }
        self.q.copy_from_slice(&self.best);
        self.place(constraints);
        Ok((iterations, restarts))
    }

    fn status(&self, accuracy: f64) -> Status {
        // not so for NaN
        match self.rows.worst() <= accuracy && self.rows.excess.iter().all(|e| !e.is_nan()) {
            true => Status::Success,
            false => Status::BestAvailable,
        }
    }

    /// Where a restart may begin: an infinite range is searched half a turn (or three metres) around the seed.
    fn around(&self, joint: usize, seed: f64) -> JointRange {
        let JointRange { lower, upper } = self.ranges[joint];
        JointRange {
            lower: if lower.is_finite() { lower } else { upper.min(seed + PI) - 2.0 * PI },
            upper: if upper.is_finite() { upper } else { lower.max(seed - PI) + 2.0 * PI },
        }
    }

    /// Placements and rows at q.
    fn place(&mut self, constraints: &[Constraint]) {
        let model = self.model.borrow();
        forward_kinematics(model, &mut self.data, &self.q);
        self.rows.fill(model, &self.data, &self.q, constraints);
    }

    /// One descent from q; leaves q and the rows of its end. Steps and cost.
    fn descend(&mut self, constraints: &[Constraint], options: &Options, patience: usize) -> (usize, f64) {
        self.place(constraints);
        let mut cost = self.rows.cost();
        let model = self.model.borrow();
        let (mut damping, mut idle) = (1e-2, 0);
        self.equations.fill(&self.rows, &self.q, &self.ranges);
        for step in 0..options.iterations {
            if self.rows.worst() <= options.accuracy || self.equations.slope() < 1e-14 || idle == patience {
                return (step, cost);
            }
            let Some(move_by) = self.equations.step(damping * cost + 1e-14) else {
                damping = 10.0 * damping + 1e-9;
                continue;
            };
            for (i, range) in self.ranges.iter().enumerate() {
                self.tried[i] = range.clamp(self.q[i] + move_by[i]);
            }
            forward_kinematics(model, &mut self.data, &self.tried);
            self.trial.fill(model, &self.data, &self.tried, constraints);
            let next = self.trial.cost();
            // not so for NaN
            if next < cost {
                idle = if next > 0.9 * cost { idle + 1 } else { 0 };
                cost = next;
                self.q.copy_from_slice(&self.tried);
                std::mem::swap(&mut self.rows, &mut self.trial);
                self.equations.fill(&self.rows, &self.q, &self.ranges);
                damping = (0.3 * damping).max(1e-6);
            } else {
                idle += 1;
                damping *= 8.0;
            }
        }
        (options.iterations, cost)
    }

    fn reports(&self, constraints: &[Constraint], accuracy: f64) -> Vec<Report> {
        let mut rest = self.rows.excess.as_slice();
        let parts = |constraint: &Constraint| match constraint {
            Constraint::Pose { .. } => 2,
            Constraint::CartesianBounds { .. } => 3,
            Constraint::JointBounds { lower, .. } => lower.len(),
            _ => 1,
        };
        let report = |constraint| {
            let (own, others) = rest.split_at(parts(constraint));
            rest = others;
            Report { violation: own.to_vec(), satisfied: own.iter().all(|e| *e <= accuracy) }
        };
        constraints.iter().map(report).collect()
    }
}
