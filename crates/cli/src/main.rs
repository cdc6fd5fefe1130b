//! The program `blocksim`.

use std::process::ExitCode;

/// Compiling a diagram makes and drops many small values, for which it takes a quarter less time than the allocator of the system.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    blocksim_cli::main()
}
