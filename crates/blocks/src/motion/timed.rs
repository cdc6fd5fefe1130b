//! What the blocks of moves have in common.

use blocksim_block::prelude::*;

use super::joint_path::JointPath;

/// The seams of a move at which a solver stops: all, or the ends alone where there are so many that stopping would
/// cost more than it gains. The fastest course along a path has one at each knot.
pub(super) fn few(seams: Vec<f64>) -> Vec<f64> {
    const FEW: usize = 100;
    match (seams.first(), seams.last()) {
        (Some(first), Some(last)) if seams.len() > FEW => vec![*first, *last],
        _ => seams,
    }
}

/// The threshold of singular poses is a singular value, of which those of an arm are below 10 m.
pub(super) fn check_singular_limit(path: &JointPath, param: &str) -> Result<(), ParamError> {
    match path.singular_limit {
        Some(limit) if !(0.0..=10.0).contains(&limit) => {
            Err(ParamError::new(format!("{param}.singular_limit"), format!("`singular_limit` is {limit}"))
                .help("give a singular value from 0 to 10, in m and rad; 0.01 is usual, 0 never warns"))
        }
        _ => Ok(()),
    }
}

/// Reports what planning does not look at.
pub(super) fn validate_path(path: &JointPath, errors: &mut ParamErrors) {
    errors.take(positive("path.resolution", path.resolution));
}
