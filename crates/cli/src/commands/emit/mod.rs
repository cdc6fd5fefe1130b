mod program;

use std::collections::HashMap;

use blocksim_diagram::{Options, Stage};

use super::tell;
use crate::args::model::{EmitArgs, StageName};
use crate::exit::Exit;
use crate::failure::Outcome;
use crate::loaded::load_with;
use crate::scene;
use crate::terminal::console::Console;
use crate::terminal::render;
use crate::trust::Purpose;

/// Prints what a step of the compiler makes of a model, also of one with errors if the step was reached.
///
/// # Errors
/// If the model cannot be read.
pub fn emit(args: &EmitArgs, console: Console) -> Outcome {
    let loaded = load_with(&args.model, Purpose::Look, &Options { stages: true, ..Options::default() })?;
    let problems = &loaded.compiled.problems;
    tell(problems, &loaded.files, console)?;
    let stages = &loaded.compiled.stages;
    let text = match args.stage {
        StageName::Ast => stages.emit(Stage::Ast),
        StageName::Model => stages.emit(Stage::Model),
        StageName::Flat => stages.emit(Stage::Flat),
        StageName::Types => stages.emit(Stage::Types),
        StageName::Schedule => stages.emit(Stage::Schedule),
        StageName::Program => loaded.compiled.schedule.as_ref().map(program::text),
        StageName::Scene => loaded.compiled.scene.as_ref().map(|scene| scene::json(scene, &HashMap::new())),
    };
    match text {
        // What is JSON stays exactly as it is.
        Some(text) if args.stage == StageName::Scene => console.bytes_of(&text)?,
        Some(text) => console.data(&text)?,
        None => console.say(&format!("{}; this step was not reached", render::tally(problems))),
    }
    Ok(if render::errors(problems) == 0 { Exit::Done } else { Exit::Model })
}
