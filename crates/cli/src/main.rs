//! The program `blocksim`.

use std::process::ExitCode;

fn main() -> ExitCode {
    blocksim_cli::main()
}
