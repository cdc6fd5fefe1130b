//! The start of closed loops: positions in which they close, speeds that keep them closed.

use blocksim_block::physical::{Element, Freedom};
use blocksim_multibody::{Data, Model, add_jacobian, forward_kinematics, move_positions};
use nalgebra::{DMatrix, DVector};

use crate::assembly::members::Members;
use crate::mechanics::frames::{Frames, Loop};
use crate::mechanics::rotation::Rotation;
use crate::problem::NetworkProblem;

/// How much a start value that is given yields, against one that is not, where it has to.
const GIVEN: f64 = 1e-2;
/// Singular values below this part of the largest count as zero.
const SINGULAR: f64 = 1e-7;
/// Largest step of one iteration, rad or m.
const STEP: f64 = 0.3;
/// Iterations from one set of positions, and sets that are tried.
const ITERATIONS: usize = 100;
const TRIES: usize = 12;
/// Gaps, rad and m: as good as none; larger than rounding explains; what axes and lengths of a few printed digits leave.
const CLOSED: f64 = 1e-13;
const ROUNDED: f64 = 1e-10;
pub(crate) const ACCEPTED: f64 = 1e-6;
/// Speeds that miss by this part of the largest fit.
const FITTING: f64 = 1e-13;

/// Moves the joints to the nearest positions in which all loops close; those without start values first.
///
/// Newton's method on the gaps, each step the smallest that closes them to first order. Where it fails, it begins
/// again with the free joints moved away a little: bars in line do not know to which side to fold.
///
/// # Errors
/// `inconsistent_start` with the gap that remains.
pub(crate) fn assemble(m: &Members, frames: &mut Frames) -> Result<(), Vec<NetworkProblem>> {
    let Some(model) = frames.model.as_ref().filter(|_| !frames.loops.is_empty()) else { return Ok(()) };
    let mut data = model.data();
    if model.dof() == 0 {
        return rigid(m, frames, &data);
    }
    let mut best: Option<(f64, Vec<f64>)> = None;
    let mut offer = |left: f64, q: Vec<f64>| {
        if best.as_ref().is_none_or(|(least, _)| left < *least) {
            best = Some((left, q));
        }
        best.as_ref().is_some_and(|(least, _)| *least <= ACCEPTED)
    };
    // Joints with start values move only where the others cannot close the loops.
    'search: for yields in [0.0, GIVEN] {
        let mobility: Vec<f64> =
            frames.speeds.iter().map(|speed| if speed.given { yields } else { 1.0 }).collect();
        for attempt in 0..TRIES {
            let mut q = frames.position.clone();
            move_positions(model, &mut q, &aside(&mobility, attempt));
            let left = close(model, &mut data, &frames.loops, &mobility, &mut q);
            if offer(left, q) {
                break 'search;
            }
        }
    }
    let Some((left, mut q)) = best else { return Ok(()) };
    if left <= ACCEPTED {
        if left > ROUNDED {
            let mut exact = q.clone();
            if close(model, &mut data, &frames.loops, &vec![1.0; model.dof()], &mut exact) < left {
                q = exact;
            }
        }
        frames.position = q;
        return Ok(());
    }
    forward_kinematics(model, &mut data, &q);
    Err(open(m, frames, &data))
}

/// Joints that start beyond an end of their travel where nobody has given their start: at zero, or where a loop closes.
pub(crate) fn beyond_travel(m: &Members, frames: &Frames) -> Vec<NetworkProblem> {
    let free = frames.speeds.iter().filter(|speed| !speed.given);
    let beyond = free.filter_map(|speed| {
        let q = frames.position[speed.position?];
        let [lower, upper] = m.list[speed.member].part.travel;
        let below = lower.filter(|end| q < end - ACCEPTED).map(|end| ("lower", end, "below"));
        let above = upper.filter(|end| q > end + ACCEPTED).map(|end| ("upper", end, "above"));
        let (name, end, side) = below.or(above)?;
        let path = m.path(speed.member);
        let slides = |e: &Element| matches!(e, Element::Joint { freedoms, .. } if matches!(freedoms[..], [Freedom::Slide(_)]));
        let unit = if m.list[speed.member].part.elements.iter().any(slides) { "m" } else { "rad" };
        let message = format!("`{path}` starts at {q} {unit}, {side} its {name} limit of {end} {unit}");
        let help = format!("give `{path}` a `position` within its limits, or change them");
        Some(NetworkProblem::new("inconsistent_start", message, &help).with(speed.member, "has these limits"))
    });
    beyond.collect()
}

/// Loops of transforms alone close or do not.
fn rigid(m: &Members, frames: &Frames, data: &Data) -> Result<(), Vec<NetworkProblem>> {
    let problems = open(m, frames, data);
    if problems.is_empty() { Ok(()) } else { Err(problems) }
}

/// The loops that are open at the current placements.
fn open(m: &Members, frames: &Frames, data: &Data) -> Vec<NetworkProblem> {
    let open = frames.loops.iter().filter(|closing| size(&gap(closing, data)) > ACCEPTED);
    open.map(|closing| inconsistent(m, frames, closing, data)).collect()
}

/// A displacement of the joints that are free to move, another one for each attempt (Weyl's sequence).
fn aside(mobility: &[f64], attempt: usize) -> Vec<f64> {
    let scattered = |i: usize| 2.0 * (i as f64 * 0.618_033_988_749_894_9).fract() - 1.0;
    let reach = 0.25 * attempt as f64;
    let n = mobility.len();
    mobility.iter().enumerate().map(|(i, m)| m * reach * scattered(attempt * n + i + 1)).collect()
}

/// Newton's method from `q`; returns the gap that remains.
pub(crate) fn close(model: &Model, data: &mut Data, loops: &[Loop], mobility: &[f64], q: &mut [f64]) -> f64 {
    let n = model.dof();
    let mut least = f64::INFINITY;
    let mut idle = 0;
    for _ in 0..ITERATIONS {
        forward_kinematics(model, data, q);
        let gaps: Vec<f64> = loops.iter().flat_map(|closing| gap(closing, data)).collect();
        let left = size(&gaps);
        idle = if left < 0.9 * least { 0 } else { idle + 1 };
        least = least.min(left);
        if left <= CLOSED || (idle > 3 && left <= ACCEPTED) || idle > 30 {
            return left;
        }
        let d = rows(model, data, loops);
        let scaled = DMatrix::from_fn(d.nrows(), n, |i, k| d[(i, k)] * mobility[k]);
        let Some(step) = smallest(scaled, &DVector::from_vec(gaps)) else { return left };
        let step: Vec<f64> = step.iter().zip(mobility).map(|(x, m)| -x * m).collect();
        let longest = step.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
        let shorter = if longest > STEP { STEP / longest } else { 1.0 };
        move_positions(model, q, &step.iter().map(|x| shorter * x).collect::<Vec<_>>());
    }
    forward_kinematics(model, data, q);
    size(&loops.iter().flat_map(|closing| gap(closing, data)).collect::<Vec<_>>())
}

/// The shortest solution of `a x = b` in the sense of least squares.
fn smallest(a: DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let svd = a.svd(true, true);
    let cut = SINGULAR * svd.singular_values.iter().fold(0.0_f64, |max, s| max.max(*s));
    svd.solve(b, cut).ok()
}

/// Angles (rad) and lengths (m) between the two frames of a loop in world axes.
fn gap(closing: &Loop, data: &Data) -> [f64; 6] {
    let [turn, way] = closing.gap(data);
    [turn.x, turn.y, turn.z, way.x, way.y, way.z]
}

fn size(gaps: &[f64]) -> f64 {
    gaps.iter().fold(0.0, |max, gap| gap.abs().max(max))
}

/// How the gaps change with the speeds of the joints.
fn rows(model: &Model, data: &Data, loops: &[Loop]) -> DMatrix<f64> {
    let n = model.dof();
    let mut d = vec![0.0; 6 * loops.len() * n];
    for (closing, rows) in loops.iter().zip(d.chunks_exact_mut(6 * n)) {
        for (place, sign) in [(&closing.b, 1.0), (&closing.a, -1.0)] {
            if let Some(body) = place.body {
                add_jacobian(model, data, body, &place.placement.translation, sign, rows);
            }
        }
    }
    DMatrix::from_row_slice(6 * loops.len(), n, &d)
}

/// Changes the speeds at the start as little as possible so that they keep the loops closed; those that nobody asks for
/// first.
pub(crate) fn fit_speeds(frames: &Frames, rotation: &mut Rotation) {
    let Some(model) = frames.model.as_ref().filter(|_| !frames.loops.is_empty()) else { return };
    let mut data = model.data();
    forward_kinematics(model, &mut data, &frames.position);
    let n = rotation.free;
    if n == 0 {
        return;
    }
    let over_joints = rows(model, &data, &frames.loops);
    let mut d = DMatrix::zeros(over_joints.nrows(), n);
    for (i, row) in over_joints.row_iter().enumerate() {
        let mut line = vec![0.0; n];
        row.iter().zip(&rotation.joints).for_each(|(value, joint)| joint.add_to(*value, &mut line));
        line.iter().enumerate().for_each(|(k, value)| d[(i, k)] = *value);
    }
    let mut asked: Vec<bool> = rotation.start.iter().map(|speed| *speed != 0.0).collect();
    for (joint, _) in rotation.joints.iter().zip(&frames.speeds).filter(|(_, speed)| speed.start.is_some()) {
        joint.terms().iter().for_each(|(k, _)| asked[*k as usize] = true);
    }
    // Speeds that are asked for change only where the others cannot do it.
    for yields in [0.0, 1.0] {
        let mobility: Vec<f64> = asked.iter().map(|asked| if *asked { yields } else { 1.0 }).collect();
        let misfit = &d * DVector::from_column_slice(&rotation.start);
        let fastest = rotation.start.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
        if misfit.amax() <= FITTING * d.amax() * fastest {
            return;
        }
        let scaled = DMatrix::from_fn(d.nrows(), n, |i, k| d[(i, k)] * mobility[k]);
        let Some(change) = smallest(scaled, &misfit) else { return };
        for (k, speed) in rotation.start.iter_mut().enumerate() {
            *speed -= mobility[k] * change[k];
        }
    }
}

fn inconsistent(m: &Members, frames: &Frames, closing: &Loop, data: &Data) -> NetworkProblem {
    let [x, y, z, a, b, c] = gap(closing, data);
    let turn = (x * x + y * y + z * z).sqrt().to_degrees();
    let way = 1e3 * (a * a + b * b + c * c).sqrt();
    let problem = NetworkProblem::new(
        "inconsistent_start",
        format!(
            "the loop that `{}` closes stays open: {way:.3} mm and {turn:.3} deg are between its ends",
            m.path(closing.member)
        ),
        "check the lengths and axes in the loop, or start its joints near a position in which it closes",
    )
    .with(closing.member, "closes the loop");
    let others = frames.joints_between(closing).into_iter().filter(|member| *member != closing.member);
    others.fold(problem, |problem, member| problem.with(member, "belongs to the loop"))
}
