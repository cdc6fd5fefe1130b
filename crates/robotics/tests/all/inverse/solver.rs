//! The general solver on poses and paths.

use crate::inverse::Outcome;
use crate::inverse::arms::{Random, apart, flange, irb2600, ranges, torch};
use blocksim_multibody::{Frame, forward_kinematics};
use blocksim_robotics::kinematics::{Constraint, Options, Solver, Status, follow_point};
use nalgebra::Vector3;

#[test]
fn of_5000_random_reachable_poses_at_least_999_in_1000_are_found() -> Outcome {
    let (model, last) = irb2600()?;
    let tool = flange(last).at(torch());
    let (ranges, mut random, mut data) = (ranges(), Random(10), model.data());
    let mut solver = Solver::new(&model, &ranges)?;
    let mut missed = 0;
    for i in 0..5000 {
        forward_kinematics(&model, &mut data, &random.pose(&ranges));
        let target = tool.in_world(&data);
        // every other time from the singular home pose
        let seed = if i % 2 == 0 { [0.0; 6] } else { random.pose(&ranges) };
        let solved =
            solver.solve(&[Constraint::pose(tool, Frame::ground(), target)], &seed, &Options::default())?;
        assert!(solved.q.iter().zip(&ranges).all(|(q, range)| range.excess(*q) == 0.0));
        if solved.status == Status::Success {
            forward_kinematics(&model, &mut data, &solved.q);
            assert!(apart(&tool.in_world(&data), &target) < 3e-8);
        } else {
            missed += 1;
        }
    }
    assert!(missed <= 5, "{missed} of 5000 missed");
    Ok(())
}

#[test]
fn the_same_question_has_the_same_answer() -> Outcome {
    let (model, last) = irb2600()?;
    let (ranges, mut random, mut data) = (ranges(), Random(11), model.data());
    let tool = flange(last).at(torch());
    for _ in 0..50 {
        forward_kinematics(&model, &mut data, &random.pose(&ranges));
        let wish = [Constraint::pose(tool, Frame::ground(), tool.in_world(&data))];
        let mut first = Solver::new(&model, &ranges)?;
        let a = first.solve(&wish, &[0.0; 6], &Options::default())?;
        let again = first.solve(&wish, &[0.0; 6], &Options::default())?;
        let b = Solver::new(&model, &ranges)?.solve(&wish, &[0.0; 6], &Options::default())?;
        assert!(a == b && a == again);
    }
    Ok(())
}

#[test]
fn the_tip_follows_a_line_there_and_back_with_small_steps_of_the_joints() -> Outcome {
    const POINTS: usize = 1233;
    const CHANGE: f64 = 0.05;
    let (model, last) = irb2600()?;
    let tool = flange(last).at(torch());
    let mut solver = Solver::new(&model, &ranges())?;
    let (start, end) = (Vector3::new(1.0, 0.1, 1.3), Vector3::new(1.3, -0.5, 0.8));
    let alone = Options { restarts: 0, ..Options::default() };
    let begin = [
        Constraint::position(tool, Frame::ground(), start),
        Constraint::aiming(tool, Frame::ground(), start),
    ];
    let mut q = solver.solve(&begin, &[0.0; 6], &Options::default())?;
    assert_eq!(q.status, Status::Success);
    let mut data = model.data();
    for k in (0..POINTS).chain((0..POINTS).rev()) {
        let point = start + (end - start) * (k as f64 / (POINTS - 1) as f64);
        let wish = follow_point(tool, Frame::ground(), point, &q.q, CHANGE);
        let next = solver.solve(&wish, &q.q, &alone)?;
        assert_eq!(next.status, Status::Success, "point {k}: {next:?}");
        forward_kinematics(&model, &mut data, &next.q);
        assert!((tool.in_world(&data).translation - point).norm() < 2e-8);
        // 0.63 mm from point to point; the arm is about a metre long
        let step = next.q.iter().zip(&q.q).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        assert!(step < 5e-3, "point {k}: {step}");
        q = next;
    }
    Ok(())
}

#[test]
fn a_target_out_of_reach_gives_the_nearest_position_and_its_distance() -> Outcome {
    let (model, last) = irb2600()?;
    let mut solver = Solver::new(&model, &ranges())?;
    // the wrist centre reaches 1.8533 m from axis 1, at the height of axis 2
    let wrist = Frame::of(model.parent(last).ok_or("no wrist")?);
    let reach = 0.15 + 0.9 + 0.795_f64.hypot(0.115);
    let wish = [Constraint::position(wrist, Frame::ground(), [0.0, -3.0, 0.445])];
    let options = Options { iterations: 200, restarts: 5, ..Options::default() };
    let solved = solver.solve(&wish, &[0.0; 6], &options)?;
    assert_eq!((solved.status, solved.restarts), (Status::BestAvailable, 5));
    let report = &solved.reports[0];
    assert!(!report.satisfied && (report.violation[0] - (3.0 - reach)).abs() < 1e-6, "{report:?}");
    Ok(())
}
