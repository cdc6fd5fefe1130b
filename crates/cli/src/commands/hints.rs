use std::path::Path;

use blocksim_recording::limited_text;

use crate::disk::models;
use crate::exit::Exit;
use crate::failure::Outcome;
use crate::terminal::console::Console;

/// Texts that are looked at for a model.
const MOST: usize = 50;

/// What `blocksim` alone prints: the most likely commands, with a model of this folder.
///
/// # Errors
/// If the standard output cannot be written.
pub fn hints(console: Console) -> Outcome {
    let found = models(".".as_ref()).into_iter().take(MOST).find(|path| is_whole(path));
    let name =
        found.as_ref().and_then(|path| path.file_name()).map(|name| name.to_string_lossy().into_owned());
    let start = name.is_none().then(|| ("blocksim new lab".to_owned(), "make a project that runs at once"));
    let model = name.unwrap_or_else(|| "MODEL.ron".to_owned());
    let of = |verb: &str, more: &str| format!("blocksim {verb} {model}{more}");
    let plain = |command: &str| format!("blocksim {command}");
    let lines = [
        (of("run", ""), "simulate, show and keep the results"),
        (of("run", " --set TARGET=VALUE"), "with another value of a parameter"),
        (plain("plot latest"), "draw its signals, also as SVG or PNG"),
        (plain("report latest"), "one HTML page of a run: scopes, mechanism, numbers"),
        (of("check", ""), "list all problems without running; --fix corrects some"),
        (of("graph", ""), "draw the block diagram"),
        (of("params list", ""), "its parameters; `params set` changes one"),
        (plain("blocks Gain"), "all about a kind of block; `blocks` lists them"),
        (plain("help friction"), "commands, options, pages and blocks about something"),
        (plain("manual"), "the pages of the manual"),
        (plain("doctor"), "whether everything is there that runs need"),
    ];
    let lines: Vec<_> = start.into_iter().chain(lines).collect();
    let width = lines.iter().map(|(command, _)| command.chars().count()).max().unwrap_or_default();
    let listed: String =
        lines.iter().map(|(command, about)| format!("  {command:width$}  {about}\n")).collect();
    console.data(&format!(
        "blocksim simulates block diagrams written as text.\n\n{listed}\n`blocksim --help` lists all commands, \
         `blocksim run --help` the options of one.\n"
    ))?;
    Ok(Exit::Done)
}

/// Whether a text is a model rather than a part of one.
fn is_whole(path: &Path) -> bool {
    limited_text(path, 1 << 20).is_ok_and(|text| text.contains("Diagram(") && text.contains("simulation:"))
}
