//! The mechanics of a network: what is built once (`rotation`: the independent speeds and what follows from them;
//! `tree` makes `frames`, with `place`: the bodies, `scene`: how they look), and what an evaluation does, in this order: `speeds` and `joints`, `outside`,
//! `motion` with `mesh` (losses of gears), `constraints` (with `envelope`, `schur`, `bounded`, `loops` and `lock`), and `stiction`, which chooses modes at events.

pub(crate) mod bounded;
mod constraints;
pub(crate) mod envelope;
pub(crate) mod frames;
pub(crate) mod joints;
pub(crate) mod lock;
pub(crate) mod loops;
pub(crate) mod mesh;
pub(crate) mod motion;
pub(crate) mod outside;
pub(crate) mod place;
pub(crate) mod rotation;
pub(crate) mod scene;
pub(crate) mod schur;
pub(crate) mod speeds;
pub(crate) mod stiction;
pub(crate) mod tree;
