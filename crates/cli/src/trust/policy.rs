//! What becomes of the plug-ins that a model names.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use blocksim_block::problem::Problem;
use blocksim_block::shell::quoted;
use blocksim_block::{CodePolicy, Decision, LoadError, UNTRUSTED, untrusted};
use blocksim_host::{is_module, locate, set_call_limit, set_isolation};

use super::{TrustList, memory};
use crate::args::model::PluginArgs;
use crate::loaded::with_slashes;
use crate::terminal::console::notice;

/// What a command wants of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// To show or check it.
    Look,
    /// To run it, with all that it names.
    Run,
}

/// Decides what becomes of plug-ins, and gathers what they offer.
#[derive(Debug)]
pub struct Plugins {
    args: PluginArgs,
    purpose: Purpose,
    offers: RefCell<BTreeMap<String, String>>,
}

impl Plugins {
    /// As the command line says.
    pub fn of(args: PluginArgs, purpose: Purpose) -> Plugins {
        limit_calls(args.call_limit);
        if args.isolate {
            isolate();
        }
        Plugins { args, purpose, offers: RefCell::default() }
    }

    /// For commands that look at models and leave no choice.
    pub fn looking() -> Plugins {
        Plugins::of(PluginArgs::default(), Purpose::Look)
    }

    /// What each plug-in offers that was loaded, by [`key`].
    pub fn offers(&self) -> BTreeMap<String, String> {
        self.offers.borrow().clone()
    }
}

/// Sets how long a call of a plug-in may take, s.
pub fn limit_calls(limit: Option<f64>) {
    if let Some(limit) = limit.and_then(|limit| Duration::try_from_secs_f64(limit).ok()) {
        set_call_limit(limit);
    }
}

/// Keeps plug-ins in processes of their own from now on: of this program, called to serve them.
pub fn isolate() {
    if let Ok(program) = std::env::current_exe() {
        set_isolation(program, &["plugin", "serve"]);
    }
}

/// The name of a plug-in in the texts that a run keeps: its path as the diagram names it.
pub fn key(folder: &Path, named: &str) -> String {
    with_slashes(&folder.join(named))
}

impl CodePolicy for Plugins {
    fn decide(&self, folder: &Path, named: &str) -> Decision {
        let code = match locate(folder, named) {
            Ok(source) => source.path().to_owned(),
            Err(error) => return Decision::Refuse(error),
        };
        if self.args.no_plugins {
            let message = format!("the plug-in `{named}` was not built or loaded, because of `--no-plugins`");
            let refusal = LoadError { message, ..untrusted(named) };
            return match memory::recall(&code).filter(|_| self.purpose == Purpose::Look) {
                Some(offer) => Decision::Recall { offer, warning: None, refusal },
                None => Decision::Refuse(refusal),
            };
        }
        // What cannot leave its memory is as good as data.
        if is_module(named) {
            return Decision::Load;
        }
        if self.purpose == Purpose::Run || self.args.trust {
            note_trust(&code);
            return Decision::Load;
        }
        let advice = match is_trusted(folder, &code) {
            Ok(true) => return Decision::Load,
            Ok(false) => advice(&code),
            Err(reason) => {
                format!("the list of what is trusted is damaged: {reason}; remove it or correct it")
            }
        };
        let refusal = LoadError { help: Some(advice.clone()), ..untrusted(named) };
        match memory::recall(&code) {
            None => Decision::Refuse(refusal),
            Some(offer) => {
                let message =
                    format!("the plug-in `{named}` is not trusted: it is shown as it was loaded last");
                let warning = Some(LoadError { message, help: Some(advice), ..untrusted(named) });
                Decision::Recall { offer, warning, refusal }
            }
        }
    }

    fn remember(&self, folder: &Path, named: &str, offer: &str) {
        if let Ok(source) = locate(folder, named) {
            memory::remember(source.path(), offer);
        }
        self.offers.borrow_mut().insert(key(folder, named), offer.to_owned());
    }
}

/// Whether a plug-in may be loaded to look at a diagram: it or the diagram that names it is trusted.
fn is_trusted(folder: &Path, code: &Path) -> Result<bool, String> {
    let list = TrustList::read()?;
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    Ok(list.covers(code) || here.canonicalize().is_ok_and(|folder| list.covers(&folder)))
}

/// From now on a plug-in is trusted. One that cannot be noted is run all the same: the command says so.
pub fn note_trust(code: &Path) {
    match TrustList::add(code) {
        Ok(false) => {}
        Ok(true) => notice(&format!(
            "  trusting `{}` from now on; `blocksim trust` lists what is trusted",
            near(code).display()
        )),
        Err(reason) => notice(&format!("  `{}` is not noted as trusted: {reason}", near(code).display())),
    }
}

fn advice(code: &Path) -> String {
    format!("if you trust its author, `blocksim trust {}` lets it be built and loaded", quoted(&near(code)))
}

/// A path from the present folder where it lies below.
fn near(path: &Path) -> PathBuf {
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    let below = here.ok().and_then(|here| path.strip_prefix(here).ok().map(Path::to_owned));
    below.filter(|below| !below.as_os_str().is_empty()).unwrap_or_else(|| path.to_owned())
}

/// Whether a problem is only that a plug-in was not loaded, which says nothing about the model itself.
pub fn is_about_trust(problem: &Problem) -> bool {
    problem.code == UNTRUSTED
}
