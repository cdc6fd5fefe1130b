//! Scripts and styles that go into every page.

/// A file of another project.
#[derive(Debug, Clone, Copy)]
pub struct Vendored {
    /// Name in the folder of assets.
    pub file: &'static str,
    /// Its text.
    pub text: &'static str,
}

/// All files of other projects; `assets/VENDORED.md` lists them with version, licence and checksum.
pub const VENDORED: [Vendored; 3] = [
    Vendored { file: "uPlot.iife.min.js", text: include_str!("../assets/uPlot.iife.min.js") },
    Vendored { file: "uPlot.min.css", text: include_str!("../assets/uPlot.min.css") },
    Vendored { file: "uPlot.LICENSE", text: include_str!("../assets/uPlot.LICENSE") },
];

/// Styles in their order.
pub(crate) const STYLES: [&str; 2] =
    [include_str!("../assets/uPlot.min.css"), include_str!("../assets/report.css")];

/// Scripts that every page runs.
pub(crate) const SCRIPTS: [&str; 8] = [
    include_str!("../assets/uPlot.iife.min.js"),
    include_str!("../assets/data.js"),
    include_str!("../assets/picture.js"),
    include_str!("../assets/plots.js"),
    include_str!("../assets/stretches.js"),
    include_str!("../assets/readings.js"),
    include_str!("../assets/overlay.js"),
    include_str!("../assets/measure.js"),
];

/// Scripts of the 3D view.
pub(crate) const SPACE: [&str; 5] = [
    include_str!("../assets/shapes.js"),
    include_str!("../assets/meshes.js"),
    include_str!("../assets/draw3d.js"),
    include_str!("../assets/camera.js"),
    include_str!("../assets/space.js"),
];

/// Scripts of the block diagram and the tables of parameters.
pub(crate) const DIAGRAM: [&str; 5] = [
    include_str!("../assets/signals.js"),
    include_str!("../assets/wires.js"),
    include_str!("../assets/diagram.js"),
    include_str!("../assets/tables.js"),
    include_str!("../assets/search.js"),
];

/// What comes last: keys, playback, drawings.
pub(crate) const MAIN: &str = include_str!("../assets/main.js");
