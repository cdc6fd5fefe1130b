//! Whose plug-ins are built and loaded. Reading a diagram must not run what somebody has put beside it: commands that look at a model
//! load trusted plug-ins alone and show others as they were when they were loaded last; commands that run a model run what it
//! names, and trust that from then on.
//!
//! | file | idea |
//! |---|---|
//! | `list` | what is trusted |
//! | `memory` | what plug-ins offered when they were loaded last |
//! | `policy` | what becomes of a plug-in |

mod list;
mod memory;
mod policy;

pub use list::TrustList;
pub use policy::{Plugins, Purpose, is_about_trust, isolate, key, limit_calls, note_trust};
