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

/// A script or a style sheet: its name and its text.
pub type Asset = (&'static str, &'static str);

macro_rules! asset {
    ($name:literal) => {
        ($name, include_str!(concat!("../assets/", $name)))
    };
}

/// Styles in their order.
pub const STYLES: [Asset; 2] = [asset!("uPlot.min.css"), asset!("report.css")];

/// Scripts that every page runs.
pub const SCRIPTS: [Asset; 8] = [
    asset!("uPlot.iife.min.js"),
    asset!("data.js"),
    asset!("picture.js"),
    asset!("plots.js"),
    asset!("stretches.js"),
    asset!("readings.js"),
    asset!("overlay.js"),
    asset!("measure.js"),
];

/// Scripts of the 3D view.
pub const SPACE: [Asset; 9] = [
    asset!("shapes.js"),
    asset!("meshes.js"),
    asset!("draw3d.js"),
    asset!("camera.js"),
    asset!("record.js"),
    asset!("speed.js"),
    asset!("efforts.js"),
    asset!("poses.js"),
    asset!("space.js"),
];

/// Scripts of the block diagram and the tables of parameters.
pub const DIAGRAM: [Asset; 5] = [
    asset!("signals.js"),
    asset!("wires.js"),
    asset!("diagram.js"),
    asset!("tables.js"),
    asset!("search.js"),
];

/// What comes last: keys, playback, drawings.
pub const MAIN: Asset = asset!("main.js");
