//! Blocks as what they are.

use std::any::Any;
use std::sync::Arc;

use blocksim_block::Block;

/// A block as what it is.
pub fn look_into<T: Any>(block: &Arc<dyn Block>) -> Option<&T> {
    (&**block as &dyn Any).downcast_ref()
}
