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
    /// Pictures of signals over others.
    pub planes: Vec<PlanePicture>,
    /// Signals that were recorded and that no picture shows.
    pub unseen: Vec<Unseen>,
    /// How actual values follow their set values.
    pub metrics: Rows,
    /// What was set for the run, variants and files.
    pub parameters: Rows,
    /// Parameters of the model, a table for each set.
    pub tables: Vec<(String, Rows)>,
    /// The block diagram, level by level.
    pub diagram: Diagram,
    /// What happened, by time.
    pub events: Vec<Event>,
    /// Mechanism and its movement.
    pub animation: Option<Animation>,
    /// Measurements to be laid over the pictures.
    pub overlays: Vec<Overlay>,
    /// A second run beside this one.
    pub compared: Option<Compared>,
    /// Whether all values are kept.
    pub full: bool,
    /// Whether pictures over time were left out on request.
    pub has_no_scopes: bool,
}

/// A picture of one signal over another, which does not change.
#[derive(Debug, Clone, Default)]
pub struct PlanePicture {
    /// Title.
    pub title: String,
    /// Drawing in SVG for a light page, with literal colours and texts that are escaped.
    pub light: String,
    /// The same for a dark page.
    pub dark: String,
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
    /// A whole turn in the unit, where the values are angles that jump by one: there the lines have gaps.
    pub turn: Option<f64>,
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
    /// The same signal of the second run at the same times; not a number where that one has no value.
    pub other: Option<Vec<f64>>,
}

/// A signal that no picture shows: the diagram has its value on a wire, and the reader may ask for a picture.
#[derive(Debug, Clone, Default)]
pub struct Unseen {
    /// Full path.
    pub path: String,
    /// Unit of the values as in print; empty for numbers without one.
    pub unit: String,
    /// Whether values hold until the next one.
    pub held: bool,
    /// Times, s, never falling.
    pub time: Vec<f64>,
    /// One value for each time.
    pub values: Vec<f64>,
    /// How far values between the times may be off, in the unit of the values.
    pub tolerance: f64,
}

/// A second run and what differs.
#[derive(Debug, Clone, Default)]
pub struct Compared {
    /// Name of the second run.
    pub name: String,
    /// What came out, in a sentence or two.
    pub summary: String,
    /// Verdict for each signal.
    pub rows: Rows,
    /// Where signals differ for the first time: row of the table, path and time in s, by time.
    pub marks: Vec<(usize, String, f64)>,
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

/// The block diagram. Levels that look alike share a drawing.
#[derive(Debug, Clone, Default)]
pub struct Diagram {
    /// What the reader must know, such as that the model was changed since.
    pub note: String,
    /// Style sheet of the drawings. Its colours are variables `--diagram-ink` and so on, which the page sets.
    pub style: String,
    /// Drawings, each once.
    pub drawings: Vec<Drawing>,
    /// All levels, the top first.
    pub levels: Vec<Level>,
    /// What is known of each kind of block.
    pub kinds: Vec<Kind>,
}

/// A drawing.
#[derive(Debug, Clone, Default)]
pub struct Drawing {
    /// SVG from a source that escapes its texts. Blocks are groups with `data-node`, wires groups with `data-net`.
    pub svg: String,
    /// The wires in the order of `data-net`.
    pub nets: Vec<Net>,
    /// The ports that are drawn.
    pub ports: Vec<PortPlace>,
}

/// Where a port is drawn.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PortPlace {
    /// The block, as `data-node` numbers it.
    pub node: usize,
    /// The port as connections name it: `motor.r`; `in.set` and `out.torque` for what leads out of the level.
    pub end: String,
    /// `i` where a signal goes in, `o` where one comes out, `c` for a conserving one.
    pub kind: char,
    /// Its place within the drawing, dots.
    pub at: [f64; 2],
}

/// A wire of a drawing.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Net {
    /// What it is called: its ports, the source first.
    pub title: String,
    /// Nodes at its ends, the source first.
    pub nodes: Vec<usize>,
    /// The ports at its ends in the same order, as [`PortPlace::end`] has them; empty for what is within the drawing alone.
    pub ends: Vec<String>,
    /// Whether it has a direction, as signals have.
    pub directed: bool,
}

/// A level of the diagram.
#[derive(Debug, Clone, Default)]
pub struct Level {
    /// Path of the subsystem; empty for the top.
    pub path: String,
    /// Its title.
    pub title: String,
    /// Place of its drawing in [`Diagram::drawings`].
    pub drawing: usize,
    /// The blocks in the order of `data-node`; none for what is no block.
    pub blocks: Vec<Option<Inspected>>,
    /// What the wires carry, in the order of `data-net`, as far as it was recorded.
    pub probes: Vec<Vec<Probe>>,
    /// Names of the signals on the wires, from the top, in the same order; none for what is not one output.
    pub signals: Vec<Option<String>>,
    /// What is laid over the drawing, as the page takes it; null without.
    pub layers: serde_json::Value,
}

/// What is told of a block.
#[derive(Debug, Clone, Default)]
pub struct Inspected {
    /// Name in its level.
    pub name: String,
    /// Kind as written.
    pub kind: String,
    /// File and line.
    pub place: String,
    /// The chosen alternative and the others, if it is a variant.
    pub variant: String,
    /// Name, text as written, and value with unit of each parameter.
    pub parameters: Vec<[String; 3]>,
}

/// What is known of a kind.
#[derive(Debug, Clone, Default)]
pub struct Kind {
    /// Its name.
    pub name: String,
    /// What it does, in a sentence.
    pub does: String,
    /// Name and meaning of its parameters.
    pub parameters: Vec<(String, String)>,
}

/// A recorded signal on a wire.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Probe {
    /// Element of the bus; empty for a signal that is alone.
    pub element: String,
    /// Path of a signal that a picture shows, or of one in [`Report::unseen`].
    pub path: String,
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
    /// What the actuators exert on joints.
    pub efforts: Vec<Effort>,
    /// Meshes; a shape names the one it has by its number, `"surface": 0`.
    pub surfaces: Vec<Surface>,
    /// When what touches, by time.
    pub contacts: Vec<Contact>,
    /// Names of what is not looked at for contacts, because it is a mesh.
    pub unlooked: Vec<String>,
}

/// What the actuators of a joint exert on its body.
#[derive(Debug, Clone, PartialEq)]
pub struct Effort {
    /// The body, as the scene numbers it.
    pub body: usize,
    /// The recorded signal.
    pub signal: String,
    /// Torque about the axis of the joint, N·m, or force along it, N, at the times of the movement.
    pub values: Vec<f64>,
    /// Its largest magnitude in the whole run.
    pub largest: f64,
}

/// Two parts that touch each other for a while.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// From this time on, s.
    pub from: f64,
    /// Until this time, s.
    pub to: f64,
    /// Names of both.
    pub names: [String; 2],
    /// How deep one is in the other at most, m.
    pub depth: f64,
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
