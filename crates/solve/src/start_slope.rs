//! The slope with which a continuous extension leaves the start of a step.
//!
//! Extensions that are made of stages leave the start with a slope that is good to their order. What a body does that has
//! just broken away is decided by less: its acceleration begins at zero, and the error of the slope would push it back.
//! Where the step resolves a state, that error is small against the way of the state, and a cubic that vanishes at both
//! ends takes it out. Where a step is much longer than a decay that it damps out, the slope at the start says nothing
//! about the step and is left alone.

/// Up to this part of the way over a step the slope over the step may be corrected.
const RESOLVED: f64 = 0.1;

/// What has to be added of `theta (1 - theta)^2` where an extension leaves with the slope `has` instead of `wants`, both
/// over a step that leads as far as `way`.
#[inline]
pub(crate) fn bend(wants: f64, has: f64, way: f64) -> f64 {
    let bend = wants - has;
    if bend.abs() <= RESOLVED * way.abs() { bend } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_error_is_taken_out_and_a_decay_that_is_damped_out_left_alone() {
        assert_eq!(bend(0.0, -0.01, 0.5), 0.01);
        assert_eq!(bend(-1e4, -3.0, -1.0), 0.0);
    }
}
