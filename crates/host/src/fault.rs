//! What can be wrong with a plug-in, by the words of the manual.

use std::path::Path;

use blocksim_block::LoadError;
use blocksim_signal::closest;

/// There is no library, or no plug-in could be found where one should be.
pub const MISSING: &str = "plugin_missing";
/// The crate does not build.
pub const BUILD: &str = "plugin_build";
/// The file is a library of something else, or none at all.
pub const SYMBOL: &str = "plugin_symbol";
/// Another version of the border, or a table that breaks its rules.
pub const ABI: &str = "plugin_abi";
/// A panic was caught in the plug-in.
pub const PANIC: &str = "plugin_panic";
/// The plug-in died or broke a rule while a model was compiled.
pub const CRASH: &str = "plugin_crash";
/// The block or its parameters are not what the plug-in has.
pub const PARAMETER: &str = "plugin_parameter";

/// This program was built without what the plug-in needs.
pub const LEFT_OUT: &str = "left_out";

/// The constant of a code that another process reports.
pub fn known(code: &str) -> &'static str {
    [MISSING, BUILD, SYMBOL, PANIC, CRASH, PARAMETER, LEFT_OUT]
        .into_iter()
        .find(|known| *known == code)
        .unwrap_or(ABI)
}

/// A fault of what `library` names.
pub fn library(code: &'static str, message: impl Into<String>) -> LoadError {
    LoadError { param: "library", code, message: message.into(), help: None }
}

/// A fault of the values in `parameters`.
pub fn parameter(message: impl Into<String>) -> LoadError {
    LoadError { param: "parameters", code: PARAMETER, message: message.into(), help: None }
}

/// The same with advice.
pub fn help(error: LoadError, help: impl Into<String>) -> LoadError {
    LoadError { help: Some(help.into()), ..error }
}

/// A path as users see it: with `/`, without the prefix that Windows puts before canonical paths.
pub fn shown(path: &Path) -> String {
    let text = path.display().to_string();
    if cfg!(windows) { text.trim_start_matches(r"\\?\").replace('\\', "/") } else { text }
}

/// Advice for an unknown name: the likely one, and all there are.
pub fn meant<'a>(unknown: &str, what: &str, known: impl Iterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.collect();
    let all: Vec<String> = known.iter().map(|name| format!("`{name}`")).collect();
    match (closest(unknown, known), all.is_empty()) {
        (_, true) => format!("it has no {what}"),
        (Some(near), _) => format!("did you mean `{near}`? Its {what} are: {}", all.join(", ")),
        (None, _) => format!("its {what} are: {}", all.join(", ")),
    }
}
