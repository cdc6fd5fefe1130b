//! What a page shows.

use serde_json::Value;

use crate::surface::Surface;

/// A run, ready to be shown.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// Title of the diagram.
    pub title: String,
    /// Names and values for the head of the page: model, solver, times.
    pub facts: Vec<(String, String)>,
    /// What the reader must know: an interrupted run, a changed model.
    pub warnings: Vec<String>,
    /// Pictures of signals over time.
    pub panels: Vec<Panel>,
    /// How actual values follow their set values.
    pub metrics: Rows,
    /// Parameters, variants and files that the run used.
    pub parameters: Rows,
    /// Drawings of the diagram, the top first.
    pub levels: Vec<Level>,
    /// What happened, by time.
    pub events: Vec<Event>,
    /// Mechanism and its movement.
    pub animation: Option<Animation>,
    /// Measurements to be laid over the pictures.
    pub overlays: Vec<Overlay>,
    /// Whether all values are kept.
    pub full: bool,
}

/// A table.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// One heading a column.
    pub head: Vec<String>,
    /// As many cells in each row.
    pub rows: Vec<Vec<String>>,
}

/// A picture: signals with common times and one unit.
#[derive(Debug, Clone, Default)]
pub struct Panel {
    /// What the picture belongs to; neighbours of one group stand under one heading.
    pub group: String,
    /// Title.
    pub title: String,
    /// Unit of the values as in print; empty for numbers without one.
    pub unit: String,
    /// Times, s, never falling.
    pub time: Vec<f64>,
    /// The signals.
    pub series: Vec<Series>,
}

/// A signal of a picture.
#[derive(Debug, Clone)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Full path.
    pub path: String,
    /// What it is.
    pub role: Role,
    /// Whether values hold until the next one.
    pub held: bool,
    /// One value for each time, in the unit of the picture.
    pub values: Vec<f64>,
}

/// What a signal is to the others of its picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Role {
    /// One among others.
    #[default]
    Plain,
    /// What should be: dashed.
    Set,
    /// What is.
    Actual,
}

/// A drawing of a level of the diagram.
#[derive(Debug, Clone)]
pub struct Level {
    /// Path of the subsystem; empty for the top.
    pub path: String,
    /// Its title.
    pub title: String,
    /// The drawing, from a source that escapes its texts.
    pub svg: String,
}

/// Something that happened.
#[derive(Debug, Clone)]
pub struct Event {
    /// When, s.
    pub time: f64,
    /// Where.
    pub path: String,
    /// What.
    pub what: String,
}

/// A mechanism and where it is over time.
#[derive(Debug, Clone)]
pub struct Animation {
    /// Bodies, shapes, masses and frames in JSON, as `blocksim emit scene` prints them.
    pub scene: Value,
    /// Times, s.
    pub time: Vec<f64>,
    /// Positions of the joints over time, in the order of their bodies: rad, m, or parts of quaternions.
    pub positions: Vec<Vec<f64>>,
    /// The same of the set values; where a joint has none, its position.
    pub set: Option<Vec<Vec<f64>>>,
    /// Meshes; a shape names the one it has by its number, `"surface": 0`.
    pub surfaces: Vec<Surface>,
}

/// A measurement.
#[derive(Debug, Clone)]
pub struct Overlay {
    /// Name of its file.
    pub name: String,
    /// Times, s.
    pub time: Vec<f64>,
    /// Name, unit and values of each column.
    pub columns: Vec<(String, String, Vec<f64>)>,
}
