#[cfg(feature = "lsp")]
use crate::exit::Exit;
#[cfg(feature = "lsp")]
use crate::failure::Failure;
use crate::failure::Outcome;
#[cfg(feature = "lsp")]
use crate::terminal::prose::prose;
#[cfg(feature = "lsp")]
use crate::trust::Plugins;

/// Tells that there is no server for editors.
///
/// # Errors
/// Always.
#[cfg(not(feature = "lsp"))]
pub fn lsp() -> Outcome {
    Err(crate::left_out::failure("cannot serve an editor", "a language server", "lsp"))
}

/// Serves an editor on the standard input and output.
///
/// # Errors
/// What the editor does wrong.
#[cfg(feature = "lsp")]
pub fn lsp() -> Outcome {
    blocksim_lsp::serve(prose, Box::new(Plugins::looking())).map(|()| Exit::Done).map_err(|error| {
        Failure::usage(format!("the editor broke the Language Server Protocol: {error}"))
            .help("editors start `blocksim lsp`; see docs/editors.md")
    })
}
