//! Scripts and styles: those of the page of a run, and what the studio has beside them.

use blocksim_report::{Asset, DIAGRAM, SCRIPTS, SPACE, STYLES};

macro_rules! own {
    ($name:literal) => {
        ($name, include_str!(concat!("../assets/", $name)))
    };
}

/// Scripts of the studio, in their order behind those of the page of a run.
pub(crate) const OWN: [Asset; 21] = [
    own!("stream.js"),
    own!("desk.js"),
    own!("project.js"),
    own!("panel.js"),
    own!("futures.js"),
    own!("movement.js"),
    own!("live.js"),
    own!("values.js"),
    own!("joints.js"),
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

/// Names of all scripts in their order.
pub(crate) fn scripts() -> impl Iterator<Item = &'static str> {
    SCRIPTS.into_iter().chain(SPACE).chain(DIAGRAM).chain(OWN).map(|(name, _)| name)
}

/// Names of all style sheets in their order.
pub(crate) fn styles() -> impl Iterator<Item = &'static str> {
    STYLES.into_iter().chain([LOOK]).map(|(name, _)| name)
}

/// The type and the text of a file of the page.
pub(crate) fn find(name: &str) -> Option<(&'static str, &'static str)> {
    let all = SCRIPTS.into_iter().chain(SPACE).chain(DIAGRAM).chain(OWN).chain(STYLES).chain([LOOK]);
    let (_, text) = all.into_iter().find(|(known, _)| *known == name)?;
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
        assert_eq!([find("../Cargo.toml"), find(""), find("VENDORED.md")], [None; 3]);
    }
}
