//! `blocksim studio`: a page that shows a project, runs its models and writes their parameters.
//!
//! | file | idea |
//! |---|---|
//! | `analysis` | sweeps and linear analysis, as other processes of this program |
//! | `desk` | answers what the page asks |
//! | `project` | which models there are; what is ready, stale, wrong or missing |
//! | `model` | a model as the page shows it: drawings, scopes, problems |
//! | `measured` | tables of other programs over its runs |
//! | `motion` | moves of its robot: planned, checked, kept |
//! | `plugins` | what its plug-ins offer and how they are; new ones |
//! | `runner` | a run, as another process of this program |
//! | `sheets` | parameters in sheets, and those of a run |
//! | `values` | parameters, and texts that change and change back |
//! | `edits` | what is done to the picture, done to the texts; ports, kinds, choices |
//! | `texts` | the text beside the picture: checked while it is written, completed, saved |
//! | `joined` | a studio of the same project that runs already |

mod analysis;
mod desk;
mod edits;
mod joined;
mod measured;
mod model;
mod motion;
mod plugins;
mod project;
mod runner;
mod sheets;
mod texts;
mod values;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use blocksim_studio::{News, Server, Token};

use self::desk::Studio;
use crate::args::studio::StudioArgs;
use crate::disk::{readable, text_files};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::running::interrupt;
use crate::terminal::browser;
use crate::terminal::console::Console;

/// The port that is taken if it is free.
const PORT: u16 = 7700;
/// How often files are looked at.
const LOOK: Duration = Duration::from_millis(25);

/// Serves a project until Ctrl-C.
///
/// # Errors
/// If there is no such project, or no port to serve it at.
pub fn studio(args: &StudioArgs, console: Console) -> Outcome {
    let (root, model) = place(&args.path)?;
    if let Some(address) = joined::address(&root) {
        console.data(&format!("{address}\n"))?;
        console.say("a studio of this project runs already; this is its address");
        shown(&address, args, console);
        return Ok(Exit::Done);
    }
    interrupt::take_over();
    let news = News::default();
    let token = Token::new().map_err(|error| {
        Failure::unreadable(format!(
            "the system gives no random numbers, and without a token anybody could ask: {error}"
        ))
    })?;
    let server = Server::open(args.port, PORT, token.clone(), news.clone()).map_err(|error| {
        let port = args.port.unwrap_or(PORT);
        Failure::new(
            Exit::Files,
            "studio",
            format!("no page can be served at port {port} of 127.0.0.1: {error}"),
        )
        .help("choose another port: `--port 0` takes any that is free")
    })?;
    let address = server.address();
    let joined = joined::Joined::tell(&root, server.port(), &token);
    let title = name_of(&root);
    let studio = Arc::new(Studio::new(root, model, args.edit, news, console));
    let started = server.start(studio.clone(), &title);
    console.data(&format!("{address}\n"))?;
    console.say("Ctrl-C ends it");
    shown(&address, args, console);
    while !interrupt::is_requested() {
        studio.look();
        std::thread::sleep(LOOK);
    }
    studio.end();
    drop(started);
    drop(joined);
    Ok(Exit::Done)
}

/// The folder of a project, and the model that was named, if one was.
fn place(path: &Path) -> Result<(PathBuf, Option<PathBuf>), Failure> {
    if path.is_dir() {
        if text_files(path).map_err(|error| unreadable(path, &error))?.is_empty() {
            let said = format!("there are no models in `{}`", path.display());
            return Err(Failure::unreadable(said).help("`blocksim new NAME` makes a project"));
        }
        return Ok((path.to_owned(), None));
    }
    readable(path)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Ok((folder.to_owned(), path.file_name().map(PathBuf::from)))
}

fn unreadable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::unreadable(format!("cannot read `{}`: {}", path.display(), crate::disk::reason(error)))
}

/// What the project is called: as its folder.
fn name_of(root: &Path) -> String {
    let whole = std::path::absolute(root).unwrap_or_else(|_| root.to_owned());
    let whole = whole.canonicalize().unwrap_or(whole);
    whole.file_name().map_or_else(|| whole.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Opens the page where somebody is there to see it.
fn shown(address: &str, args: &StudioArgs, console: Console) {
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let is_seen = cfg!(any(windows, target_os = "macos")) || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY");
    if !args.no_open && is_seen && !is_set("SSH_CONNECTION") && !is_set("CI") {
        browser::open(address.as_ref(), console);
    }
}
