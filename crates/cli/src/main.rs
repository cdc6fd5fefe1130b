//! blocksim
fn main() {}
