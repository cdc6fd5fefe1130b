//! The algorithms against each other, closed forms, conservation laws and an independent program.

mod agreement;
mod arm;
mod closed_forms;
mod conservation;
mod frames;
mod irb2600;
mod motion;
mod pinocchio;
mod rotations;
mod trees;

/// Asserts that two vectors differ by at most `tolerance` relative to the largest entry of either.
#[track_caller]
fn assert_close(got: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(got.len(), expected.len());
    let scale = got.iter().chain(expected).fold(0.0_f64, |m, x| m.max(x.abs()));
    let error = got.iter().zip(expected).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
    assert!(error <= tolerance * scale, "error {error:e} at scale {scale:e}: {got:?} is not {expected:?}");
}
