//! `blocksim identify friction`.

use blocksim_identify::{KnownFriction, Point, Torques, TwoPoint, curve, line, two_point};

use super::axis_friction::{AxisFriction, TakenFriction};
use super::bench::{Bench, Experiment};
use super::constant_speed::{Measured, Move, fastest, fastest_for, fits, measure, plan, room};
use super::drive::{Drive, Taken};
use super::failure::failed;
use super::friction_report::short;
use super::pose::{Pose, find};
use super::{friction_report, load_bench, out};
use crate::args::identify::FrictionArgs;
use crate::disk::write_file;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::running::interrupt;
use crate::terminal::console::Console;

/// Share of the friction that gravity may have in a window.
const GRAVITY: f64 = 0.4;
/// Slow speeds, and fast ones.
const SLOW: usize = 10;
const FAST: usize = 6;
/// Slowest and fastest of the slow speeds, over the maximum speed of the axis.
const SLOWEST: f64 = 3e-4;
const SLOW_END: f64 = 0.02;
/// Largest speed of the experiments, over that of the axis.
const LARGEST: f64 = 0.6;
/// Half the window of the first look at an axis under gravity, rad.
const LOOK: f64 = 0.01;
/// Speed above which friction is a line, over the breakaway velocity: the rest of the bump is below 1e-10 there.
const STRAIGHT: f64 = 8.0;
/// Speed above which the losses of gears are complete, over their thresholds: 4e-9 is missing there.
const ONSET: f64 = 10.0;

/// An axis with its place and its speeds.
struct Setup {
    axis: usize,
    pose: Pose,
    moves: Vec<Move>,
}

/// Measures the friction of the axes of a robot by moves at constant speed.
///
/// # Errors
/// Why it cannot be measured or written.
pub fn friction(args: &FrictionArgs, console: Console) -> Outcome {
    out::check(args.common.out.as_deref(), args.common.yes, &["csv", "ron"])?;
    let bench = load_bench(&args.common, console)?;
    interrupt::take_over();
    let axes = chosen(&bench, &args.axis)?;
    let setups = axes.into_iter().map(|axis| setup(&bench, axis, args)).collect::<Result<Vec<_>, _>>()?;
    let experiments: Vec<Experiment> =
        setups.iter().flat_map(|setup| setup.moves.iter().map(|course| course.experiment.clone())).collect();
    let live = console.live && !args.common.json;
    let count = experiments.len();
    let mut rows = bench
        .run_all(&experiments, |done| {
            if live {
                console.rewrite(&format!("  {done} of {count} moves"));
            }
        })
        .into_iter();
    if live {
        console.rewrite("");
    }
    let mut results = Vec::new();
    for setup in &setups {
        let mut measured = Vec::new();
        for course in &setup.moves {
            match rows.next() {
                Some(Ok(rows)) => measured.extend(measure(&bench, setup.axis, &setup.pose, course, &rows)),
                Some(Err(error)) => return Err(failed(&error, bench.axes[setup.axis].number)),
                None => {}
            }
        }
        results.push(evaluate(&bench, setup, measured));
    }
    if let Some(path) = &args.common.out {
        let text = match path.extension().and_then(|ending| ending.to_str()) {
            Some("ron") => friction_report::ron(&results),
            _ => friction_report::csv(&results),
        };
        write_file(path, text.as_bytes(), args.common.yes)?;
    }
    let text =
        if args.common.json { friction_report::json(&results) } else { friction_report::text(&results) };
    console.data(&text)?;
    if let (Some(path), false) = (&args.common.out, args.common.json) {
        console.say(&format!("wrote {}", path.display()));
    }
    Ok(if results.iter().all(|result| result.line.is_ok()) { Exit::Done } else { Exit::Failed })
}

/// Indices of the axes that were asked for.
fn chosen(bench: &Bench, numbers: &[usize]) -> Result<Vec<usize>, Failure> {
    let count = bench.axes.len();
    if numbers.is_empty() {
        return Ok((0..count).collect());
    }
    let mut axes: Vec<usize> = Vec::new();
    for number in numbers {
        if !(1..=count).contains(number) {
            return Err(no_axis(*number, count));
        }
        if !axes.contains(&(number - 1)) {
            axes.push(number - 1);
        }
    }
    Ok(axes)
}

/// That a robot has fewer axes.
pub fn no_axis(number: usize, count: usize) -> Failure {
    Failure::usage(format!("there is no axis {number}"))
        .help(format!("the axes of this robot are 1 to {count}"))
}

fn setup(bench: &Bench, axis: usize, args: &FrictionArgs) -> Result<Setup, Failure> {
    let it = &bench.axes[axis];
    let number = it.number;
    let refuse = |message: String, help: &str| Failure::usage(message).help(help);
    if !it.has_motor() {
        return Err(refuse(
            format!("axis {number}: there is no signal of the torque of the motor of `{}`", it.joint),
            "drive the joint by a machine with an output `torque`, or by an `IdealTorqueSource`",
        ));
    }
    if let Some(obstacle) = &it.drive.wandering {
        return Err(refuse(format!("axis {number}: {}", obstacle.reason), &obstacle.remedy));
    }
    let limits: Vec<_> = bench.axes.iter().map(|axis| axis.limits).collect();
    let Some(pose) = find(&bench.tree, &limits, axis) else {
        return Err(refuse(
            format!("axis {number} is loaded by gravity in all its positions"),
            "a range of the axis that holds a balance of what it bears makes the measurement possible",
        ));
    };
    let widest = match pose.slope == 0.0 {
        true => room(bench, axis, &pose),
        false => widest_under_gravity(bench, axis, &pose)?,
    };
    let largest = it.limits.speed;
    let speeds = if args.speeds.is_empty() {
        let wanted = (LARGEST * largest).min(fastest_for(widest));
        let top = fastest(bench, axis, &pose, wanted, widest);
        let slow_end = (SLOW_END * largest).min(0.5 * top / FAST as f64);
        let first = (SLOWEST * largest).min(0.1 * slow_end);
        let slow = (0..SLOW).map(|k| first * (slow_end / first).powf(k as f64 / (SLOW - 1) as f64));
        slow.chain((1..=FAST).map(|k| top * k as f64 / FAST as f64)).collect()
    } else {
        for speed in &args.speeds {
            if !fits(bench, axis, &pose, *speed, widest) || *speed > fastest_for(widest) {
                let top = fastest(bench, axis, &pose, largest.min(fastest_for(widest)), widest);
                return Err(refuse(
                    format!(
                        "axis {number} cannot keep {} deg/s long enough {}",
                        short(speed.to_degrees()),
                        if pose.slope == 0.0 { "within its limits" } else { "where gravity is balanced" }
                    ),
                    &format!("choose speeds up to {} deg/s", short(top.to_degrees())),
                ));
            }
        }
        args.speeds.clone()
    };
    let both = speeds.iter().flat_map(|speed| [*speed, -*speed]);
    let moves = both.filter_map(|speed| plan(bench, axis, &pose, speed, widest)).collect();
    Ok(Setup { axis, pose, moves })
}

/// Half the window in which gravity stays well below friction, so that the motor drives the gear in both directions and
/// gravity drops out of their difference: from a first pair of moves.
fn widest_under_gravity(bench: &Bench, axis: usize, pose: &Pose) -> Result<f64, Failure> {
    let it = &bench.axes[axis];
    let speed = fastest(bench, axis, pose, (0.02 * it.limits.speed).min(fastest_for(LOOK)), LOOK);
    let mut torques = [0.0; 2];
    for (torque, sense) in torques.iter_mut().zip([1.0, -1.0]) {
        let found = plan(bench, axis, pose, sense * speed, LOOK);
        let rows = found.as_ref().map(|course| bench.run(&course.experiment)).transpose();
        let rows = rows.map_err(|error| failed(&error, it.number))?;
        let measured = found.zip(rows).and_then(|(course, rows)| measure(bench, axis, pose, &course, &rows));
        *torque = measured.map_or(0.0, |measured| measured.point.torque);
    }
    let friction = 0.5 * (torques[0] - torques[1]);
    let widest = GRAVITY * friction / pose.slope.abs();
    if !(widest > 0.0 && widest.is_finite()) {
        let said = format!("axis {} shows no friction at {} deg/s", it.number, short(speed.to_degrees()));
        return Err(Failure::usage(said).help(
            "where gravity acts on an axis, its friction is measured as the difference of two directions; an axis \
             without friction cannot be measured so",
        ));
    }
    Ok(widest.min(room(bench, axis, pose)))
}

fn evaluate(bench: &Bench, setup: &Setup, measured: Vec<Measured>) -> AxisFriction {
    let it = &bench.axes[setup.axis];
    let train = &it.drive.train;
    let good = measured.iter().filter(|m| m.is_steady && m.is_driving);
    let points: Vec<Point> = good.map(|m| m.point).collect();
    let fitted = curve(&points, train, it.drive.law);
    // What is not known beside the bearing is in the curve as well, but its bump is that of the bearing.
    let breakaway = fitted.as_ref().map_or(0.0, |curve| curve.breakaway_velocity.value);
    let curve = match it.drive.unknown.first() {
        Some(obstacle) => Err(format!("{}; {}", obstacle.reason, obstacle.remedy)),
        None => {
            fitted.map_err(|error| format!("{error}; speeds below the breakaway velocity may be missing"))
        }
    };
    let slowest = (STRAIGHT * breakaway).max(ONSET * train.threshold());
    let straight: Vec<Point> = points.iter().filter(|p| p.speed.abs() >= slowest).copied().collect();
    let found = line(&straight).map_err(|error| {
        let fastest = points.iter().map(|p| p.speed.abs()).fold(0.0, f64::max);
        match slowest > fastest {
            true => format!(
                "friction is a line above {} deg/s only, and the axis was measured up to {} deg/s",
                short(slowest.to_degrees()),
                short(fastest.to_degrees())
            ),
            false => error.to_string(),
        }
    });
    let set_line = it.drive.bearing.filter(|_| it.drive.unknown.is_empty()).and_then(|bearing| {
        let by_parameters = |p: &Point| Point { torque: train.torque(&bearing, p.speed), ..*p };
        let line = line(&straight.iter().map(by_parameters).collect::<Vec<_>>()).ok()?;
        Some((line.viscous.value, line.coulomb.value))
    });
    AxisFriction {
        number: it.number,
        joint: it.joint.clone(),
        pose: setup.pose.clone(),
        two_point: pair(&straight),
        measured,
        line: found,
        curve,
        set_line,
        set_bearing: it.drive.bearing,
        taken: taken(&it.drive, &points),
        notes: notes(bench, &it.drive),
        train: train.clone(),
        ratio: it.drive.ratio,
    }
}

/// What the parameters give of parts beside the bearing, as lines through half and full speed.
fn taken(drive: &Drive, points: &[Point]) -> Vec<TakenFriction> {
    let fast = points.iter().map(|p| p.speed.abs()).fold(0.0, f64::max);
    let line = |torque: &Torques| {
        let at = |w: f64| Point { speed: w, torque: 0.5 * (torque.at(w) - torque.at(-w)) };
        two_point(at(0.5 * fast), at(fast)).unwrap_or(TwoPoint { coulomb: 0.0, viscous: 0.0 })
    };
    let parts = drive.taken.iter().zip(&drive.train.known);
    let of = |(part, known): (&Taken, &KnownFriction)| {
        let TwoPoint { coulomb, viscous } = line(&known.torque);
        let constant = 0.5 * (known.torque.at(fast) + known.torque.at(-fast));
        TakenFriction { path: part.path.clone(), is_at_motor: part.is_at_motor, viscous, coulomb, constant }
    };
    parts.map(of).collect()
}

/// What the result holds beside what it seems to hold.
fn notes(bench: &Bench, drive: &Drive) -> Vec<String> {
    let forces = bench.forces().into_iter().map(|path| {
        format!("the force of `{path}` on the bodies is not taken off; what of it follows the speed counts as friction")
    });
    drive.notes.iter().cloned().chain(forces).collect()
}

/// The two-point formula at the fastest speed and the one nearest to half of it, each the mean of both directions.
fn pair(points: &[Point]) -> Option<(TwoPoint, f64, f64)> {
    let fast = points.iter().map(|p| p.speed).fold(0.0, f64::max);
    let nearest = |wanted: f64| {
        let of = |sense: f64| {
            let side = points.iter().filter(move |p| p.speed * sense > 0.0);
            side.min_by(|a, b| (a.speed.abs() - wanted).abs().total_cmp(&(b.speed.abs() - wanted).abs()))
        };
        let (forward, backward) = (of(1.0)?, of(-1.0)?);
        Some(Point {
            speed: 0.5 * (forward.speed - backward.speed),
            torque: 0.5 * (forward.torque - backward.torque),
        })
    };
    let (half, full) = (nearest(0.5 * fast)?, nearest(fast)?);
    Some((two_point(half, full).ok()?, half.speed, full.speed))
}
