use std::io;

use crate::exit::Exit;
use crate::terminal::console::Console;
use crate::terminal::prose::prose;

/// Serves an editor on the standard input and output.
///
/// # Errors
/// None; what the editor does wrong is told on the standard error.
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
