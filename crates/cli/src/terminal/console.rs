//! Where text goes: data to the standard output, what is said to people about it to the standard error.

use std::io::{self, IsTerminal, Write};

use clap::ValueEnum;

use crate::args::model::Format;
use crate::terminal::clean::clean_but_colours;

/// When messages are coloured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Colour {
    /// On a terminal.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

/// Columns of tables and plots where nobody says how wide the terminal is.
const WIDTH: usize = 100;

/// What the terminal can show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Console {
    /// Colour on the standard error.
    pub colour: bool,
    /// The standard error is a terminal, so a line there may be rewritten.
    pub live: bool,
    /// Columns.
    pub width: usize,
    /// No signs beyond ASCII in plots and progress.
    pub ascii: bool,
    /// How problems are told.
    pub format: Format,
}

impl Console {
    /// What the terminal of this process can show. `NO_COLOR` and `CLICOLOR_FORCE` are heeded
    /// (<https://no-color.org>, <https://bixense.com/clicolors>), as is `COLUMNS`.
    pub fn of_process(colour: Colour, ascii: bool, format: Format) -> Console {
        let live = io::stderr().is_terminal();
        let set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty() && value != "0");
        let columns = std::env::var("COLUMNS").ok().and_then(|text| text.parse().ok());
        Console {
            colour: coloured(colour, live, set("NO_COLOR"), set("CLICOLOR_FORCE")),
            live,
            width: columns.unwrap_or(WIDTH).clamp(40, 2 * WIDTH),
            ascii,
            format,
        }
    }

    /// Data. Text for people is cleaned of signs that act on a terminal; JSON is written as it is.
    ///
    /// # Errors
    /// What the system says, for example that nobody reads on.
    pub fn data(&self, text: &str) -> io::Result<()> {
        match self.format {
            Format::Json => self.bytes_of(text),
            Format::Full | Format::Short => self.bytes_of(&clean_but_colours(text)),
        }
    }

    /// The text of a file, as it is.
    ///
    /// # Errors
    /// As of [`Console::data`].
    pub fn bytes_of(&self, text: &str) -> io::Result<()> {
        let mut out = io::stdout().lock();
        out.write_all(text.as_bytes())?;
        out.flush()
    }

    /// A line to the person at the keyboard. Where even this cannot be written, nobody is left to tell.
    pub fn say(&self, line: &str) {
        notice(line);
    }

    /// Rewrites the present line of the terminal.
    pub fn rewrite(&self, line: &str) {
        let mut err = io::stderr().lock();
        let _ = write!(err, "\r\x1b[2K{}", clean_but_colours(line)).and_then(|()| err.flush());
    }
}

/// A line to the person at the keyboard, from where no console is at hand.
pub fn notice(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", clean_but_colours(line));
}

fn coloured(asked: Colour, terminal: bool, no_color: bool, forced: bool) -> bool {
    match asked {
        Colour::Always => true,
        Colour::Never => false,
        Colour::Auto => !no_color && (terminal || forced),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colour_is_for_terminals_unless_somebody_says_otherwise() {
        assert!(coloured(Colour::Auto, true, false, false));
        assert!(!coloured(Colour::Auto, false, false, false));
        assert!(coloured(Colour::Auto, false, false, true));
        assert!(!coloured(Colour::Auto, true, true, true), "NO_COLOR wins");
        assert!(coloured(Colour::Always, false, true, false));
        assert!(!coloured(Colour::Never, true, false, true));
    }
}
