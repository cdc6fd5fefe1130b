//! What is to be drawn, as plain data.

/// Panels in a grid, all over the same range of time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    /// Line above all; empty for none.
    pub title: String,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels side by side.
    pub columns: usize,
    /// What is to the right.
    pub across: Across,
    /// Range of time, s, or of what else is to the right.
    pub time: (f64, f64),
    /// Width of the whole, dots.
    pub width: f64,
}

/// What the horizontal axis shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Across {
    /// Time in s.
    #[default]
    Time,
    /// Numbers under this name.
    Numbers(String),
    /// Powers of ten under this name; the positions of points are exponents of ten, angles go in parts of a turn.
    Powers(String),
}

/// Lines over time that share a vertical axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panel {
    /// Its title.
    pub title: String,
    /// Unit of its values: `deg`; `1` for none.
    pub unit: String,
    /// Its lines.
    pub lines: Vec<Line>,
    /// A strip below it, with an axis of its own.
    pub strip: Option<Strip>,
    /// What is to the right, where that is not what the figure has there.
    pub plane: Option<PlaneAxis>,
    /// What the reader should know: where values are not finite, or that there are none.
    pub notes: Vec<String>,
}

/// The horizontal axis of a panel that shows one signal over another.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PlaneAxis {
    /// Its name, with the unit.
    pub name: String,
    /// Whether lengths are the same in both directions.
    pub equal: bool,
}

/// A low panel below another one, for what is left of the difference of its lines.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Strip {
    /// Name of its axis: `error`.
    pub name: String,
    /// Its lines.
    pub lines: Vec<Line>,
}

/// A signal over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Line {
    /// Its name in the legend; none is shown for an empty one.
    pub name: String,
    /// Number of its colour, from 0; beyond the sixth they repeat.
    pub colour: usize,
    /// How it is drawn.
    pub style: Style,
    /// Whether it is thinner than the others, as that of a second run.
    pub thin: bool,
    /// Its points `(time in s, value)`, in one course for each stretch without gaps.
    pub courses: Vec<Vec<(f64, f64)>>,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Style {
    /// What is.
    #[default]
    Solid,
    /// What should be.
    Dashed,
    /// What was measured elsewhere.
    Dotted,
    /// A limit: thin and without a colour of its own.
    Limit,
}
