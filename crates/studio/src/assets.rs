//! Scripts and styles: those of the page of a run, and what the studio has beside them.

use std::sync::LazyLock;

use blocksim_report::{Asset, DIAGRAM, SCRIPTS, SPACE, STYLES};

macro_rules! own {
    ($name:literal) => {
        ($name, include_str!(concat!("../assets/", $name)))
    };
}

/// Scripts of the studio, in their order behind those of the page of a run.
pub(crate) const OWN: [Asset; 22] = [
    own!("stream.js"),
    own!("desk.js"),
    own!("project.js"),
    own!("panel.js"),
    own!("futures.js"),
    own!("movement.js"),
    own!("live.js"),
    own!("values.js"),
    own!("joints.js"),
    own!("sketch.js"),
    own!("sequence.js"),
    own!("motion.js"),
    own!("edit.js"),
    own!("text.js"),
    own!("measured.js"),
    own!("runs.js"),
    own!("charts.js"),
    own!("linear.js"),
    own!("sweep.js"),
    own!("plugins.js"),
    own!("keys.js"),
    own!("studio.js"),
];

/// The style sheet of the studio.
pub(crate) const LOOK: Asset = own!("studio.css");

/// Those of the page of a run.
fn shared() -> impl Iterator<Item = Asset> {
    SCRIPTS.into_iter().chain(SPACE).chain(DIAGRAM)
}

/// Scripts that are brought as one, for each file of its own takes a connection, and a browser has six of them.
fn joined(scripts: impl Iterator<Item = Asset>) -> String {
    let mut all = String::from("'use strict';\n");
    for (name, text) in scripts {
        all.push_str(&format!("// {name}\n{text}\n"));
    }
    all
}

static PAGE: LazyLock<String> = LazyLock::new(|| joined(shared()));
static STUDIO: LazyLock<String> = LazyLock::new(|| joined(OWN.into_iter()));

/// Names of the files with all scripts, in their order.
pub(crate) fn scripts() -> impl Iterator<Item = &'static str> {
    ["page.js", "studio.js"].into_iter()
}

/// Names of all style sheets in their order.
pub(crate) fn styles() -> impl Iterator<Item = &'static str> {
    STYLES.into_iter().chain([LOOK]).map(|(name, _)| name)
}

/// The type and the text of a file of the page.
pub(crate) fn find(name: &str) -> Option<(&'static str, &'static str)> {
    let text = match name {
        "page.js" => &PAGE,
        "studio.js" => &STUDIO,
        _ => STYLES.into_iter().chain([LOOK]).find(|(known, _)| *known == name)?.1,
    };
    let kind =
        if name.ends_with(".css") { "text/css; charset=utf-8" } else { "text/javascript; charset=utf-8" };
    Some((kind, text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_scripts_and_styles_are_there_and_nothing_else_is() {
        for name in scripts().chain(styles()) {
            assert!(find(name).is_some_and(|(_, text)| !text.is_empty()), "{name}");
        }
        for (script, file) in shared().map(|one| (one, "page.js")).chain(OWN.map(|one| (one, "studio.js"))) {
            assert!(find(file).is_some_and(|(_, text)| text.contains(script.1)), "{}", script.0);
        }
        assert_eq!([find("../Cargo.toml"), find(""), find("VENDORED.md")], [None; 3]);
    }
}
