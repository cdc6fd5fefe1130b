//! `--native`: machine code in the place of the interpreter.

use std::time::Instant;

use blocksim_host::{Machines, machines};
use blocksim_sim::Simulation;

use crate::home;
use crate::running::summary::short;
use crate::terminal::console::Console;

/// Where libraries are kept, below the folder of what can be worked out again.
const FOLDER: &str = "native";

/// Has machine code run what is recorded as data. The results are the same to the bit, so where there is none, that is told, and the
/// interpreter runs as always.
pub fn speed_up(simulation: &mut Simulation, is_quiet: bool, console: Console) {
    let begun = Instant::now();
    let tapes = simulation.tapes();
    let instructions: usize = tapes.iter().map(|tape| tape.len()).sum();
    if instructions == 0 {
        return console.say(
            "warning: --native makes nothing faster here, because no block of this model records its law as data",
        );
    }
    let cache = home::cache().map(|folder| folder.join(FOLDER));
    let Machines { machines, was_kept, not_kept } = match machines(&tapes, cache.as_deref()) {
        Ok(made) => made,
        Err(none) => {
            return console.say(&format!(
                "warning: {}; the model runs by the interpreter, with the same results\n  = help: {}",
                none.message, none.help
            ));
        }
    };
    if simulation.run_by(&machines).is_err() {
        return console.say(
            "warning: the machine code of this compiler leaves other bits than the interpreter, which runs the model in its place\n  \
             = help: name another compiler in the variable CC, such as `CC=gcc`",
        );
    }
    if let Some(reason) = not_kept {
        console.say(&format!("warning: the machine code is not kept for the next run: {reason}"));
    }
    if !is_quiet && !was_kept {
        let time = short(begun.elapsed().as_secs_f64());
        console.say(&format!("compiled {instructions} instructions to machine code in {time}"));
    }
}
