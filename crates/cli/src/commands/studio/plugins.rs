//! Plug-ins of a model: what they offer, whether they are built from what their sources are now, and new ones.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use blocksim_studio::Reply;
use serde_json::{Value, json};

use super::model::Shown;
use super::values::refusal;
use crate::args::plugin::{Language, PluginNewArgs};
use crate::commands::plugin;
use crate::watch::newest;

/// Where new plug-ins come to be.
const FOLDER: &str = "plugins";

/// How the plug-ins of a model are.
pub struct State {
    /// `ready`, `stale`, `error` or `missing`.
    pub state: &'static str,
    /// Which they are, or what is wrong.
    pub detail: String,
    /// When the oldest of them was built.
    pub built: Option<SystemTime>,
}

/// Whether the plug-ins of a model are built from what their sources are now; nothing if it has none.
pub fn state(shown: &Shown) -> Option<State> {
    if let Some(reason) = &shown.untrusted {
        let detail = format!("{reason}; to run the model builds and loads it, and trusts it from then on");
        return Some(State { state: "missing", detail, built: None });
    }
    if let Some(problem) = shown.of("plugin_", "error") {
        return Some(State { state: "error", detail: problem.to_owned(), built: None });
    }
    let names: Vec<&str> = shown.offers.keys().map(|path| name(path)).collect();
    if names.is_empty() {
        return None;
    }
    let modified = |path: &Path| path.metadata().and_then(|data| data.modified()).ok();
    let all = blocksim_host::built();
    let library = |path: &str| {
        let folder = Path::new(path).canonicalize().ok()?;
        all.iter()
            .find(|(known, _)| known.canonicalize().is_ok_and(|known| known == folder))
            .map(|(_, library)| library)
    };
    // Each one has its own age: another one that was built long ago is not out of date.
    let built: Vec<(&str, SystemTime)> =
        shown.offers.keys().filter_map(|path| Some((path.as_str(), modified(library(path)?)?))).collect();
    let is_stale = |(path, time): &&(&str, SystemTime)| {
        newest(&[PathBuf::from(path)]).is_some_and(|source| source > *time)
    };
    let stale: Vec<&str> = built.iter().filter(is_stale).map(|(path, _)| *path).collect();
    let (state, more) = match stale.as_slice() {
        [] => ("ready", String::new()),
        changed => {
            ("stale", format!("; sources have changed in {}, the next run builds them", changed.join(", ")))
        }
    };
    let built = built.iter().map(|(_, time)| *time).min();
    Some(State { state, detail: names.join(", ") + &more, built })
}

/// The last part of a path that is a name.
fn name(path: &str) -> &str {
    Path::new(path).file_name().and_then(|name| name.to_str()).unwrap_or(path)
}

/// All plug-ins of a model with their controllers; what keeps them from being known.
pub fn list(shown: &Shown, may_edit: bool) -> Value {
    let state = state(shown);
    let one = |(path, offer): (&String, &String)| {
        let library = blocksim_host::recalled(path, offer).ok()?;
        let kinds: Vec<Value> = library.blocks.iter().map(|kind| plugin::controller(library, kind)).collect();
        Some(json!({ "path": path, "name": library.name, "version": library.version, "kinds": kinds }))
    };
    json!({
        "state": state.as_ref().map(|state| state.state), "detail": state.map(|state| state.detail),
        "plugins": shown.offers.iter().filter_map(one).collect::<Vec<_>>(),
        "problems": shown.problems.iter().filter(|problem| problem["code"].as_str().is_some_and(|code| code.starts_with("plugin_")))
            .collect::<Vec<_>>(),
        "edit": may_edit,
    })
}

/// Where plug-ins are: beside the project if it has them there, else in its folder.
fn folder(root: &Path) -> PathBuf {
    let here = PathBuf::from(FOLDER);
    if here.is_dir() { here } else { root.join(FOLDER) }
}

/// Makes the sources of a controller, as `blocksim plugin new` does; gives the file of its law, a diagram that runs it, and how another
/// diagram names it.
pub fn make(root: &Path, model: &Path, body: &Value) -> Reply {
    let language = match body["language"].as_str() {
        Some("rust") => Language::Rust,
        Some("c") => Language::C,
        Some("cpp") => Language::Cpp,
        _ => return Reply::refused("a controller is written in Rust, C or C++", "choose one of them"),
    };
    let name = body["name"].as_str().unwrap_or_default().trim();
    // A path would lead elsewhere.
    if name.is_empty() || name.contains(['/', '\\']) {
        return Reply::refused("the name of a plug-in is a word", "small letters, digits and _ make one");
    }
    let args = PluginNewArgs { folder: folder(root).join(name), kind: None, language, blocksim: None };
    let kind = match plugin::make(&args) {
        Ok(kind) => kind,
        Err(failure) => return refusal(failure),
    };
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    // A file of the present folder has an empty one above it.
    let above = model.parent().filter(|above| !above.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (from, to) = (absolute(above), absolute(&args.folder));
    let shown = |file: &str| args.folder.join(file).display().to_string();
    Reply::Data(json!({
        "kind": kind, "source": shown(plugin::source(language)), "demo": shown(plugin::DEMO),
        "call": format!("Plugin(library: {:?}, block: {kind:?})", relative(&from, &to)),
    }))
}

/// The way from one folder to another, both absolute or both relative.
pub fn relative(from: &Path, to: &Path) -> String {
    let (from, to): (Vec<_>, Vec<_>) = (from.components().collect(), to.components().collect());
    let common = from.iter().zip(&to).take_while(|(one, other)| one == other).count();
    let up = std::iter::repeat_n("..".to_owned(), from.len() - common);
    let down = to[common..].iter().map(|part| part.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagram_names_a_plug_in_by_the_way_there() {
        let of = |from: &str, to: &str| relative(Path::new(from), Path::new(to));
        assert_eq!(of("diagrams/irb2600", "plugins/pid"), "../../plugins/pid");
        assert_eq!(of("", "plugins/pid"), "plugins/pid");
        assert_eq!(of("lab", "lab/plugins/pid"), "plugins/pid");
        assert_eq!(["plugins/pid", "a.so", "x/y/", "x/y/."].map(name), ["pid", "a.so", "y", "y"]);
    }
}
