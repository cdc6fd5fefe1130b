//! At and near singularities.

use crate::inverse::Outcome;
use crate::inverse::arms::{Random, apart, flange, irb2600, ranges, torch};
use blocksim_multibody::Placement;
use blocksim_robotics::kinematics::{ClosedForm, JointRange, Solution};

fn nearest(closed_form: &ClosedForm, target: &Placement, near: &[f64; 6]) -> Result<Solution, String> {
    closed_form.nearest(target, near, &ranges()).map_err(|error| error.to_string())
}

#[test]
fn with_a_straight_wrist_axis_four_stays_where_it_was() -> Outcome {
    let (model, last) = irb2600()?;
    let closed_form = ClosedForm::of(&model, &flange(last).at(torch()))?;
    let home = nearest(&closed_form, &closed_form.forward(&[0.0; 6]), &[0.0; 6])?;
    assert!(home.singular.wrist && home.q.iter().all(|q| q.abs() < 1e-9), "{home:?}");
    let mut random = Random(4);
    for _ in 0..1000 {
        let mut q = random.pose(&ranges());
        q[4] = 0.0;
        let target = closed_form.forward(&q);
        let all = closed_form.inverse(&target, &q)?;
        assert!(all.iter().all(|s| apart(&closed_form.forward(&s.q), &target) < 1e-9));
        // seen from elsewhere, axis 4 keeps its place and axis 6 takes the turn
        let mut near = q;
        near[3] = 0.4 * q[3] + 0.1;
        let seen = closed_form.inverse(&target, &near)?;
        let kept = |s: Solution| s.singular.wrist && (s.q[3] - near[3]).abs() < 1e-9;
        assert!(seen.within(&ranges(), &near).any(kept), "{near:?} {seen:?}");
    }
    Ok(())
}

/// Axes 4 and 6 are in line, and their ranges narrow: whatever their shares were before, a pose that both can reach together is found, and of
/// all shares (by looking at many) the nearest.
#[test]
fn with_a_straight_wrist_axes_four_and_six_share_the_turn() -> Outcome {
    let (model, last) = irb2600()?;
    let closed_form = ClosedForm::of(&model, &flange(last).at(torch()))?;
    let mut narrow = ranges();
    for axis in [3, 5] {
        narrow[axis] = JointRange { lower: -1.0, upper: 1.0 };
    }
    let mut random = Random(6);
    for _ in 0..300 {
        let mut q = random.pose(&narrow);
        q[4] = 0.0;
        let target = closed_form.forward(&q);
        let mut near = q;
        (near[3], near[5]) = (1.5 * random.signed(), 1.5 * random.signed());
        let found = closed_form.nearest(&target, &near, &narrow)?;
        assert!(apart(&closed_form.forward(&found.q), &target) < 1e-9, "{found:?}");
        assert!((0..6).all(|i| narrow[i].excess(found.q[i]) < 1e-9), "{found:?}");
        let away = |q: &[f64; 6]| q.iter().zip(&near).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let mut best = f64::INFINITY;
        for k in -1000..=1000 {
            let mut other = q;
            other[3] = f64::from(k) / 1000.0;
            // Which sense joint 6 has: the one that keeps the pose.
            for sense in [1.0, -1.0] {
                other[5] = q[5] - sense * (other[3] - q[3]);
                let is_there =
                    narrow[5].excess(other[5]) == 0.0 && apart(&closed_form.forward(&other), &target) < 1e-9;
                best = best.min(if is_there { away(&other) } else { f64::INFINITY });
            }
        }
        assert!(away(&found.q) < best + 1e-9, "{} {best} {near:?}", away(&found.q));
    }
    Ok(())
}

#[test]
fn near_every_singularity_the_solutions_keep_their_digits() -> Outcome {
    let (model, last) = irb2600()?;
    let closed_form = ClosedForm::of(&model, &flange(last).at(torch()))?;
    let stretched = -(0.795_f64.atan2(0.115));
    let mut random = Random(5);
    for exponent in 1..17 {
        let small = 10_f64.powi(-exponent);
        for _ in 0..100 {
            let mut q = random.pose(&ranges());
            // the wrist almost straight, the arm almost stretched, or both
            let mut near = 0;
            for (axis, at) in [(4, 0.0), (2, stretched)] {
                if random.unit() < 0.6 {
                    q[axis] = at + small * random.signed().signum();
                    near += 1;
                }
            }
            let target = closed_form.forward(&q);
            let all = closed_form.inverse(&target, &q)?;
            assert!(all.iter().all(|s| apart(&closed_form.forward(&s.q), &target) < 1e-9), "{q:?}");
            let found = nearest(&closed_form, &target, &q)?;
            // a stretched arm tells its bend by the root of a rounding error, and a straight wrist the shares of
            // axes 4 and 6 by a rounding error over its angle
            let close = [0, 1, 2, 4].iter().all(|i| (found.q[*i] - q[*i]).abs() < 1e-6);
            assert!(close || near == 2, "{q:?} {found:?}");
        }
    }
    Ok(())
}

#[test]
fn a_stretched_arm_has_one_elbow() -> Outcome {
    let (model, last) = irb2600()?;
    let closed_form = ClosedForm::of(&model, &flange(last))?;
    // pointing straight ahead: the shoulder offset keeps the arm from reaching there over itself
    let stretched = -(0.795_f64.atan2(0.115));
    let q = [0.2, 1.3, stretched, 0.4, 0.7, -0.3];
    let target = closed_form.forward(&q);
    // pushed out as far as rounding does
    for push in [-1e-13, 0.0, 1e-13] {
        let translation = target.translation + target.translation.normalize() * push;
        let all = closed_form.inverse(&Placement { translation, ..target }, &q)?;
        assert!(all.iter().all(|s| apart(&closed_form.forward(&s.q), &target) < 1e-9));
        assert!(all.iter().any(|s| s.q.iter().zip(&q).all(|(a, b)| (a - b).abs() < 2e-6)));
    }
    let exact = closed_form.inverse(&target, &q)?;
    assert!(exact.len() == 2 || exact.iter().all(|s| !s.singular.elbow), "{exact:?}");
    Ok(())
}

#[test]
fn with_the_wrist_above_axis_one_the_arm_stays_where_it_was() -> Outcome {
    let (model, last) = irb2600()?;
    let closed_form = ClosedForm::of(&model, &flange(last).at(torch()))?;
    // elbow and forearm lean so that 0.15 + 0.9 sin q2 + k sin(q2 + q3 + lag) = 0
    let (k, lag) = (0.795_f64.hypot(0.115), 0.795_f64.atan2(0.115));
    for (q1, q2) in [(0.7, 0.3), (-2.0, 0.5), (3.0, 0.1)] {
        let sum = -((0.15 + 0.9 * f64::sin(q2)) / k).asin();
        let q = [q1, q2, sum - lag - q2, 0.5, 0.6, -0.4];
        let target = closed_form.forward(&q);
        let all = closed_form.inverse(&target, &q)?;
        assert!(all.iter().all(|s| s.singular.shoulder), "{all:?}");
        assert!(all.iter().all(|s| apart(&closed_form.forward(&s.q), &target) < 1e-9));
        let found = nearest(&closed_form, &target, &q)?;
        assert!(found.q.iter().zip(&q).all(|(a, b)| (a - b).abs() < 1e-9), "{q:?} {found:?}");
    }
    Ok(())
}
