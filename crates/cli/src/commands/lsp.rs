use std::io;

use crate::exit::Exit;
use crate::terminal::console::Console;
#[cfg(feature = "lsp")]
use crate::terminal::prose::prose;

/// Tells that there is no server for editors.
///
/// # Errors
/// None.
#[cfg(not(feature = "lsp"))]
pub fn lsp(console: Console) -> io::Result<Exit> {
    console.say(&crate::left_out::said("cannot serve an editor", "a language server", "lsp"));
    Ok(Exit::Usage)
}

/// Serves an editor on the standard input and output.
///
/// # Errors
/// None; what the editor does wrong is told on the standard error.
#[cfg(feature = "lsp")]
pub fn lsp(console: Console) -> io::Result<Exit> {
    match blocksim_lsp::serve(prose) {
        Ok(()) => Ok(Exit::Done),
        Err(error) => {
            console.say(&format!(
                "error: the editor broke the Language Server Protocol: {error}\n  = help: `blocksim lsp` is started by \
                 editors; docs/editors.md tells how"
            ));
            Ok(Exit::Usage)
        }
    }
}
