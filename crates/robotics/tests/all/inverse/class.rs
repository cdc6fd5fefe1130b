//! Which arms have a closed form, and their dimensions.

use crate::inverse::Outcome;
use crate::inverse::arms::{Random, apart, flange, irb2600, serial};
use blocksim_multibody::{Frame, Inertia, Joint, ModelBuilder, Placement, forward_kinematics};
use blocksim_robotics::kinematics::{ClassError, ClosedForm};
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, PI};

#[test]
fn the_irb_2600_has_the_dimensions_of_its_drawing() -> Outcome {
    let (model, last) = irb2600()?;
    let found = ClosedForm::of(&model, &flange(last))?;
    let g = found.geometry;
    let got = [g.a1, g.a2, g.b, g.c1, g.c2, g.c3, g.c4];
    for (got, expected) in got.iter().zip([0.15, -0.115, 0.0, 0.445, 0.9, 0.795, 0.085]) {
        assert!((got - expected).abs() < 1e-15, "{g:?}");
    }
    assert_eq!(g.signs, [1.0; 6]);
    for (got, expected) in g.offsets.iter().zip([0.0, 0.0, -FRAC_PI_2, 0.0, 0.0, 0.0]) {
        assert!((got - expected).abs() < 1e-15, "{g:?}");
    }
    assert!(apart(&found.base, &Placement::identity()) < 1e-15);
    assert!(apart(&found.end, &Placement::identity()) < 1e-15);
    Ok(())
}

/// An arm of the class with random dimensions, senses, zero positions, frames and place.
fn any_arm(random: &mut Random) -> Result<(blocksim_multibody::Model, Frame), Box<dyn std::error::Error>> {
    let mut any = |scale: f64| scale * random.signed();
    let axes = [Vector3::z(), Vector3::y(), Vector3::y(), Vector3::z(), Vector3::y(), Vector3::z()];
    let steps = [
        [any(0.3), any(0.3), any(0.3)],
        [any(0.3), any(0.3), 0.5],
        [0.0, any(0.3), 0.9 + any(0.3)],
        [any(0.2), any(0.2), 0.0],
        [0.0, 0.0, 0.8 + any(0.3)],
        [0.0, 0.0, any(0.2)],
    ];
    let mut frame = Placement::from_rpy([any(1.0), any(1.0), any(1.0)], [any(3.0), any(1.5), any(3.0)]);
    let mut links = Vec::new();
    for (axis, step) in axes.into_iter().zip(steps) {
        // the joint at any zero position, in a frame of its own with any axes
        let zero = Placement::from_axis_angle(step, axis, any(3.0));
        let own = Placement::from_rpy([0.0; 3], [any(3.0), any(1.5), any(3.0)]);
        let sense = if any(1.0) < 0.0 { -1.0 } else { 1.0 };
        links.push((frame * zero * own, own.inverse().direction(&axis) * sense));
        frame = own.inverse();
    }
    let links: [_; 6] = links.try_into().map_err(|_| "six links")?;
    let (model, last) = serial(links)?;
    let tool = Placement::from_rpy([any(0.3), any(0.3), any(0.3)], [any(3.0), any(1.5), any(3.0)]);
    Ok((model, Frame::of(last).at(tool)))
}

#[test]
fn every_arm_of_the_class_is_recognised_and_solved() -> Outcome {
    let mut random = Random(6);
    for _ in 0..300 {
        let (model, tool) = any_arm(&mut random)?;
        let closed_form = ClosedForm::of(&model, &tool)?;
        let mut data = model.data();
        for _ in 0..30 {
            let q = [(); 6].map(|()| PI * random.signed());
            forward_kinematics(&model, &mut data, &q);
            let target = tool.in_world(&data);
            assert!(apart(&closed_form.forward(&q), &target) < 1e-13);
            let solutions = closed_form.inverse(&target, &q)?;
            let mut original = f64::INFINITY;
            for solution in solutions.iter() {
                assert!(apart(&closed_form.forward(&solution.q), &target) < 1e-9);
                original = original.min((0..6).fold(0.0, |m: f64, i| m.max((solution.q[i] - q[i]).abs())));
            }
            assert!(original < 1e-7, "{q:?} {solutions:?}");
        }
    }
    Ok(())
}

#[test]
fn an_arm_of_another_class_is_told_what_does_not_fit() -> Outcome {
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let standard = [
        ([0.0, 0.0, 0.4], z),
        ([0.1, 0.0, 0.0], y),
        ([0.0, 0.0, 0.9], y),
        ([0.0, 0.0, 0.1], x),
        ([0.8, 0.0, 0.0], y),
        ([0.1, 0.0, 0.0], x),
    ];
    let with = |changes: &[(usize, [f64; 3], Vector3<f64>)]| {
        let mut links = standard;
        changes.iter().for_each(|(i, origin, axis)| links[*i] = (*origin, *axis));
        let (model, last) = serial(links.map(|(at, axis)| (Placement::from_translation(at), axis)))?;
        Ok::<_, Box<dyn std::error::Error>>(ClosedForm::of(&model, &Frame::of(last)).map(|_| ()))
    };
    assert_eq!(with(&[])?, Ok(()));
    // a hand with an offset, as collaborative robots have it
    let offset = with(&[(5, [0.1, 0.0, 0.05], x)])?;
    let message = offset.map_err(|e| e.to_string()).unwrap_err();
    let expected = "axes 4 and 6 pass each other by 0.050000 m, the wrist is not spherical; use the general solver for \
                    this arm";
    assert_eq!(message, expected);
    let meeting = with(&[(4, [0.8, 0.0, 0.02], y)])?;
    assert!(matches!(meeting, Err(ClassError::NotMeeting { axes: [3, 4], .. })), "{meeting:?}");
    let skew = with(&[(1, [0.1, 0.0, 0.0], Vector3::new(0.0, 1.0, 0.1))])?;
    assert!(matches!(skew, Err(ClassError::NotPerpendicular { axes: [0, 1], .. })), "{skew:?}");
    let turned = with(&[(2, [0.0, 0.0, 0.9], x), (3, [0.0, 0.0, 0.1], z)])?;
    assert!(matches!(turned, Err(ClassError::NotParallel { axes: [1, 2], .. })), "{turned:?}");
    let short = with(&[(2, [0.0, 0.0, 0.0], y)])?;
    assert_eq!(short, Err(ClassError::NoLength { part: "upper arm" }));
    Ok(())
}

#[test]
fn other_joints_and_other_numbers_of_joints_are_named() -> Outcome {
    assert_eq!(
        ClosedForm::of(&irb2600()?.0, &Frame::ground()).map(|_| ()),
        Err(ClassError::NotSixAxes { axes: 0 })
    );
    let (mut builder, mut last) = (ModelBuilder::new(), None);
    for i in 0..7 {
        let joint = if i == 2 { Joint::prismatic([1.0, 0.0, 0.0]) } else { Joint::revolute([0.0, 0.0, 1.0]) };
        last = Some(builder.add_body(last, joint, Placement::identity(), Inertia::zero())?);
    }
    let model = builder.build();
    let bodies: Vec<_> = model.bodies().collect();
    let of = |i: usize| ClosedForm::of(&model, &Frame::of(bodies[i])).map(|_| ());
    assert_eq!(of(6), Err(ClassError::NotSixAxes { axes: 7 }));
    assert_eq!(of(5), Err(ClassError::NotRevolute { axis: 2 }));
    Ok(())
}
