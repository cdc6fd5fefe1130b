//! How time goes on: steps, instants, sample hits.

pub(crate) mod advance;
pub(crate) mod angles;
pub(crate) mod clock;
pub(crate) mod early;
pub(crate) mod halves;
pub(crate) mod major;
pub(crate) mod methods;
pub(crate) mod past;
pub(crate) mod plain;
