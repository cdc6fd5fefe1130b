//! All solutions of the closed form.

use crate::inverse::Outcome;
use crate::inverse::arms::{Random, apart, flange, irb2600, ranges, torch};
use blocksim_multibody::{Frame, Placement, forward_kinematics};
use blocksim_robotics::kinematics::{ClosedForm, InverseError, JointRange, OrthoParallel};
use nalgebra::{Matrix3, Vector3};
use std::collections::HashSet;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Largest distance of two sets of joint positions, full turns aside.
fn joints_apart(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    let turn = |x: f64| (x - TAU * (x / TAU).round()).abs();
    a.iter().zip(b).fold(0.0, |worst, (a, b)| worst.max(turn(a - b)))
}

#[test]
fn all_solutions_of_100_000_reachable_poses_are_right_and_contain_the_original() -> Outcome {
    let (model, last) = irb2600()?;
    let tool = flange(last).at(torch());
    let closed_form = ClosedForm::of(&model, &tool)?;
    let (ranges, mut random, mut data) = (ranges(), Random(1), model.data());
    let mut counts = [0; 9];
    for _ in 0..100_000 {
        let q = random.pose(&ranges);
        forward_kinematics(&model, &mut data, &q);
        let target = tool.in_world(&data);
        let solutions = closed_form.inverse(&target, &[0.0; 6])?;
        counts[solutions.len()] += 1;
        let mut nearest = f64::INFINITY;
        for solution in solutions.iter() {
            forward_kinematics(&model, &mut data, &solution.q);
            assert!(apart(&tool.in_world(&data), &target) < 1e-9, "{q:?}");
            nearest = nearest.min(joints_apart(&solution.q, &q));
        }
        // the angles lose digits near singularities; none of the random poses is nearer than 1e-6 to one
        assert!(nearest < 1e-8, "{q:?}: {nearest:e}");
        let distinct: HashSet<_> = solutions.iter().map(|s| s.configuration).collect();
        assert_eq!(distinct.len(), solutions.len());
        let best = closed_form.nearest(&target, &q, &ranges)?;
        assert!(best.q.iter().zip(&q).all(|(a, b)| (a - b).abs() < 1e-8), "{q:?} {best:?}");
    }
    // four where the arm cannot reach over itself, else eight: 28 % and 72 % by an independent program
    assert!((counts[4] - 28_000_i32).abs() < 1000 && (counts[8] - 72_000_i32).abs() < 1000, "{counts:?}");
    assert_eq!(counts[4] + counts[8], 100_000);
    Ok(())
}

#[test]
fn the_forward_kinematics_of_the_closed_form_are_those_of_the_model() -> Outcome {
    let (model, last) = irb2600()?;
    let tool = flange(last).at(torch());
    let closed_form = ClosedForm::of(&model, &tool)?;
    let (mut random, mut data) = (Random(2), model.data());
    for _ in 0..1000 {
        let q = random.pose(&ranges());
        forward_kinematics(&model, &mut data, &q);
        assert!(apart(&closed_form.forward(&q), &tool.in_world(&data)) < 4e-15);
    }
    Ok(())
}

#[test]
fn solutions_within_ranges_are_full_turns_of_all_solutions() -> Outcome {
    let (model, last) = irb2600()?;
    let closed_form = ClosedForm::of(&model, &flange(last))?;
    let (ranges, mut random) = (ranges(), Random(3));
    for _ in 0..1000 {
        let (q, near) = (random.pose(&ranges), random.pose(&ranges));
        let target = closed_form.forward(&q);
        let all = closed_form.inverse(&target, &near)?;
        let within: Vec<_> = all.within(&ranges, &near).collect();
        assert!(!within.is_empty() && within.len() <= all.len());
        for solution in &within {
            assert!(solution.q.iter().zip(&ranges).all(|(q, range)| range.excess(*q) == 0.0));
            assert!(apart(&closed_form.forward(&solution.q), &target) < 1e-9);
            // no other turn is nearer
            for i in 0..6 {
                let distance = (solution.q[i] - near[i]).abs();
                assert!(ranges[i].turns(solution.q[i]).all(|q| (q - near[i]).abs() > distance - 1e-9));
            }
        }
    }
    Ok(())
}

/// With the wrist centre on axis 1 its angle is free: the nearest solution within the ranges is compared with all of them at 2000 angles.
#[test]
fn a_free_first_axis_is_turned_to_the_nearest_solution() -> Outcome {
    let (model, last) = irb2600()?;
    let closed_form = ClosedForm::of(&model, &Frame::of(last))?;
    let (mut ranges, mut random) = (ranges(), Random(4));
    // A hand that turns as far as a man's.
    ranges[3..].fill(JointRange { lower: -1.2, upper: 1.2 });
    let (mut refused_there, mut in_vain) = (0, 0);
    for _ in 0..100 {
        let near = random.pose(&ranges);
        let rotation = closed_form.forward(&random.pose(&ranges)).rotation;
        let centre = Vector3::new(0.0, 0.0, 0.445 + 0.8 + 0.1 * near[0].sin());
        let hand = closed_form.geometry.c4 * (rotation * closed_form.end.rotation.transpose()).column(2);
        let target = Placement { rotation, translation: centre + hand };
        let (mut least, mut there) = (f64::INFINITY, false);
        for i in 0..2000 {
            let mut from = near;
            from[0] += TAU * f64::from(i) / 2000.0;
            for solution in closed_form.inverse(&target, &from)?.within(&ranges, &near) {
                there |= i == 0;
                let distance: f64 = solution.q.iter().zip(&near).map(|(a, b)| (a - b).powi(2)).sum();
                least = least.min(distance);
            }
        }
        refused_there += i32::from(!there);
        if least.is_infinite() {
            in_vain += 1;
            continue;
        }
        let found = closed_form.nearest(&target, &near, &ranges)?;
        assert!(found.singular.shoulder);
        assert!(apart(&closed_form.forward(&found.q), &target) < 1e-9, "{found:?}");
        assert!(found.q.iter().zip(&ranges).all(|(q, range)| range.excess(*q) == 0.0), "{found:?}");
        let distance: f64 = found.q.iter().zip(&near).map(|(a, b)| (a - b).powi(2)).sum();
        assert!(distance < least + 1e-9 && distance > least - 0.05, "{distance} {least}");
    }
    assert!(refused_there > 5 && in_vain < 95, "{refused_there} {in_vain}");
    Ok(())
}

#[test]
fn a_target_out_of_reach_is_told_with_its_distance() -> Outcome {
    let (model, last) = irb2600()?;
    let closed_form = ClosedForm::of(&model, &flange(last))?;
    // wrist centre level with axis 2, ahead: reach 0.15 + 0.9 + |(0.795, 0.115)| from axis 1
    let rotation = closed_form.forward(&[0.0; 6]).rotation;
    let reach = 0.15 + 0.9 + 0.795_f64.hypot(0.115);
    for beyond in [0.01, 1.0, 1e6] {
        let target = Placement { rotation, translation: Vector3::new(reach + 0.085 + beyond, 0.0, 0.445) };
        let Err(InverseError::Unreachable { distance }) = closed_form.inverse(&target, &[0.0; 6]) else {
            return Err("reached".into());
        };
        assert!((distance - beyond).abs() < 1e-9 * beyond.max(1.0), "{distance}");
    }
    // without an offset of axis 2 there is a hollow that the folded arm does not reach
    let hollow = OrthoParallel { a1: 0.0, ..closed_form.geometry };
    let target = Placement { rotation, translation: Vector3::new(0.085 + 0.05, 0.0, 0.445) };
    let message = hollow.inverse(&target, &[0.0; 6]).map(|_| ()).unwrap_err().to_string();
    // 0.9 - 0.80327... - 0.05
    assert_eq!(
        message,
        "the target is out of reach: the wrist centre lies 0.046725 m outside; move the target or the base by as \
         much, or turn the tool"
    );
    Ok(())
}

#[test]
fn bad_targets_and_ranges_are_refused() -> Outcome {
    let (model, last) = irb2600()?;
    let closed_form = ClosedForm::of(&model, &Frame::of(last))?;
    let home = closed_form.forward(&[0.0; 6]);
    let of = |target: Placement, near: [f64; 6]| closed_form.inverse(&target, &near).map(|_| ());
    let nan = Placement { translation: Vector3::new(f64::NAN, 0.0, 0.0), ..home };
    assert_eq!(of(nan, [0.0; 6]), Err(InverseError::NotFinite));
    assert_eq!(of(home, [f64::INFINITY; 6]), Err(InverseError::NotFinite));
    let mirror = Placement { rotation: -Matrix3::identity(), ..home };
    assert_eq!(of(mirror, [0.0; 6]), Err(InverseError::NotRotation));
    let mut ranges = ranges();
    ranges[1] = JointRange { lower: 1.0, upper: -1.0 };
    let crossed = closed_form.nearest(&home, &[0.0; 6], &ranges);
    assert_eq!(crossed, Err(InverseError::RangeCrossed { axis: 1, lower: 1.0, upper: -1.0 }));
    // axis 1 would have to turn by 90 degrees, or reach over itself
    ranges[1] = JointRange { lower: -0.5, upper: 0.5 };
    ranges[0] = JointRange { lower: 0.1, upper: 0.2 };
    let target = closed_form.forward(&[FRAC_PI_2, 0.0, 0.0, 0.0, 0.3, 0.0]);
    let Err(InverseError::OutsideRanges { axis: 0, excess }) =
        closed_form.nearest(&target, &[0.0; 6], &ranges)
    else {
        return Err("within ranges".into());
    };
    assert!((excess - (FRAC_PI_2 - 0.2)).abs() < 1e-12, "{excess}");
    Ok(())
}
