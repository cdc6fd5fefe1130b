//! A diagram around the example of a block: drawn, run, plotted.

use std::path::Path;
use std::sync::Arc;

use blocksim_diagram::{Options, Reader, Sources, compile_and_keep};
use blocksim_drawing::{inline, level_at};
use blocksim_layout::layout;
use blocksim_picture::Theme;
use blocksim_picture::{Figure, Line, Panel, svg, thinned};
use blocksim_recording::Recording;
use blocksim_sim::{Observer, Simulation};

use crate::signals::display::{Shown, recording, shown as paired};

/// What is shown of an example.
pub struct Example {
    /// The drawing, to stand within a page.
    pub drawing: String,
    /// The run, as a picture for light and for dark pages.
    pub light: String,
    pub dark: String,
    /// Rows and lines of the run.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests look whether there is something to see"))]
    pub rows: usize,
    #[cfg_attr(not(test), expect(dead_code, reason = "tests look whether there is something to see"))]
    pub lines: usize,
}

/// Width of the plot, and columns that a course is thinned to.
const WIDTH: f64 = 780.0;
const COLUMNS: usize = 700;
/// Most lines of a panel; what vectors have beyond is left out.
const LINES: usize = 6;

/// Draws and runs a diagram, which is in no file.
///
/// # Errors
/// The first problem, in a sentence.
pub fn shown(kind: &str, text: &str) -> Result<Example, String> {
    let name = format!("{kind}.ron");
    let reader = Alone { name: &name, text };
    let sources = Sources::new(&reader);
    let (model, compiled) = compile_and_keep(&sources, Path::new(&name), &Options::default());
    let first = || {
        compiled
            .problems
            .first()
            .map_or_else(|| "it cannot be read".to_owned(), |problem| problem.message.clone())
    };
    let model = model.ok_or_else(first)?;
    let level = level_at(&model, &sources, "").map_err(|_| "it has no top".to_owned())?;
    let drawing = inline(&level, &layout(&level.graph));
    let schedule = Arc::new(compiled.schedule.clone().ok_or_else(first)?);
    let mut rows = Rows(recording(&schedule.recorded));
    let mut simulation = Simulation::new(Arc::clone(&schedule)).map_err(|error| error.message)?;
    simulation.run(&mut rows).map_err(|error| error.message)?;
    let signals = paired(&schedule.recorded, &rows.0);
    let figure = figure(&signals, &rows.0.time, schedule.settings.stop_time);
    Ok(Example {
        drawing,
        light: svg(&figure, Theme::Light),
        dark: svg(&figure, Theme::Dark),
        rows: rows.0.time.len(),
        lines: figure.panels.iter().map(|panel| panel.lines.len()).sum(),
    })
}

/// A panel for each unit, in the order of the signals.
fn figure(signals: &[Shown], time: &[f64], end: f64) -> Figure {
    let mut panels: Vec<Panel> = Vec::new();
    for signal in signals {
        let unit = signal.unit.text.as_str();
        let place = panels.iter().position(|panel| panel.unit == unit).unwrap_or(panels.len());
        if place == panels.len() {
            panels.push(Panel { unit: unit.to_owned(), ..Panel::default() });
        }
        let panel = &mut panels[place];
        if panel.lines.len() == LINES {
            continue;
        }
        let is_stepped = !matches!(signal.kind, blocksim_recording::Kind::Real);
        let courses = thinned(time, &signal.values(), &(0.0..=end), COLUMNS, is_stepped);
        let name = signal.legend.unwrap_or(signal.port()).to_owned();
        panel.lines.push(Line { name, colour: panel.lines.len(), courses, ..Line::default() });
    }
    Figure { panels, columns: 1, time: (0.0, end), width: WIDTH, ..Figure::default() }
}

/// Keeps the rows of a run.
struct Rows(Recording);

impl Observer for Rows {
    fn row(&mut self, t: f64, values: &[f64]) {
        let pushed = self.0.push_row(t, values);
        assert!(pushed.is_ok(), "the engine gives rows in their order");
    }
}

/// One text that is in no file.
struct Alone<'a> {
    name: &'a str,
    text: &'a str,
}

impl Reader for Alone<'_> {
    fn read(&self, path: &Path) -> Result<String, String> {
        if path == Path::new(self.name) {
            Ok(self.text.to_owned())
        } else {
            Err("there is only the example".to_owned())
        }
    }
}
