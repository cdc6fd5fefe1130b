//! A command line that makes no sense, as the parser of command lines tells it.

use std::ffi::OsString;

use clap::error::{Error, ErrorKind};

use crate::exit::Exit;
use crate::failure::Failure;
use crate::terminal::console::Console;

/// Tells it, or prints the help that was asked for; how the program is to end.
pub fn tell(error: &Error, console: Console, is_data: bool) -> Exit {
    let is_asked = matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
    if is_data && !is_asked {
        return failure(&error.render().to_string()).tell(console);
    }
    match error.print() {
        Ok(()) if is_asked => Exit::Done,
        Ok(()) => Exit::Usage,
        Err(error) => Failure::from(error).tell(console),
    }
}

/// Whether a command line that cannot be read asks for data.
pub fn asks_for_data(words: impl Iterator<Item = OsString>) -> bool {
    // What is no text in Unicode is no option of ours.
    let words: Vec<OsString> = words.collect();
    let formats = words.iter().zip(words.iter().skip(1));
    words.iter().any(|word| word == "--json" || word == "--output-format=json")
        || formats.into_iter().any(|(option, value)| option == "--output-format" && value == "json")
}

/// What clap writes below `error: `: the fact, and behind it advice and usage.
fn failure(text: &str) -> Failure {
    let text = text.strip_prefix("error: ").unwrap_or(text).trim_end();
    match text.split_once("\n\n") {
        Some((message, rest)) => Failure::usage(message).help(rest.trim()),
        None => Failure::usage(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::Args;
    use clap::Parser;

    #[test]
    fn the_fact_and_the_advice_of_the_parser_are_kept_apart() {
        let error = Args::try_parse_from(["blocksim", "run"]).unwrap_err();
        let told = failure(&error.render().to_string());
        assert_eq!(told.message(), "the following required arguments were not provided:\n  <MODEL>");
    }

    #[test]
    fn data_is_asked_for_in_two_ways() {
        let asks = |line: &str| asks_for_data(line.split(' ').map(OsString::from));
        assert!(
            asks("run --json") && asks("check a --output-format json") && asks("check --output-format=json")
        );
        assert!(!asks("check a --output-format short") && !asks("run json"));
    }
}
