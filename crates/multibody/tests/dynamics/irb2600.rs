//! Known facts of the ABB IRB 2600-12/1.85.

use crate::arm;
use crate::assert_close;
use crate::trees::Random;
use blocksim_multibody::{bias, crba, forward_kinematics};
use nalgebra::Matrix6;
use std::error::Error;

type Outcome = Result<(), Box<dyn Error>>;

#[test]
fn the_flange_at_home_is_where_the_data_sheet_draws_it() -> Outcome {
    let model = arm::bare()?;
    let mut data = model.data();
    forward_kinematics(&model, &mut data, &[0.0; 6]);
    let flange = model.bodies().last().ok_or("no flange")?;
    assert_close(data.placement(flange).translation.as_slice(), &[1.030, 0.0, 1.460], 1e-15);
    Ok(())
}

#[test]
fn the_masses_add_up_to_the_published_one() -> Outcome {
    // ABB: 284 kg
    assert!((arm::bare()?.mass() + arm::BASE_MASS - 284.0).abs() < 0.02);
    assert!((arm::with_torch()?.mass() - arm::bare()?.mass() - 5.25).abs() < 1e-12);
    Ok(())
}

#[test]
fn axis_two_holds_at_most_1061_newton_metres() -> Outcome {
    let model = arm::bare()?;
    let mut data = model.data();
    let (mut worst, mut vertical) = (0.0_f64, 0.0_f64);
    // the wrist moves light parts only: the two arm axes decide
    for q2 in -95..=155 {
        for q3 in -180..=75 {
            let q = [0.7, f64::from(q2).to_radians(), f64::from(q3).to_radians(), 0.0, 0.0, 0.0];
            let mut h = [0.0; 6];
            bias(&model, &mut data, &q, &[0.0; 6], &mut h);
            worst = worst.max(h[1].abs());
            vertical = vertical.max(h[0].abs());
        }
    }
    assert!((worst - 1061.0).abs() < 1.0, "{worst}");
    // axis 1 is vertical
    assert!(vertical < 1e-11, "{vertical:e}");
    Ok(())
}

#[test]
fn the_mass_matrix_is_positive_definite_everywhere() -> Outcome {
    let model = arm::with_torch()?;
    let mut data = model.data();
    let mut random = Random(42);
    for _ in 0..1000 {
        let mut m = [0.0; 36];
        crba(&model, &mut data, &random.vector(6, 3.2), &mut m);
        let m = Matrix6::from_row_slice(&m);
        assert_eq!(m, m.transpose());
        assert!(m.cholesky().is_some());
    }
    Ok(())
}
