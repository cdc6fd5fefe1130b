//! Where the rows of a run of a sweep go.

use blocksim_recording::Recording;
use blocksim_sim::{Control, Counts, Observer};

use super::runs::Keeping;
use crate::running::interrupt;

/// Takes the rows as they come.
pub struct Rows(pub Recording);

impl Observer for Rows {
    fn row(&mut self, t: f64, values: &[f64]) {
        let pushed = self.0.push_row(t, values);
        assert!(pushed.is_ok(), "the engine gives rows in their order");
    }

    fn progress(&mut self, _t: f64, _counts: &Counts) -> Control {
        if interrupt::is_requested() { Control::Stop } else { Control::Go }
    }
}

/// Gives rows both to what is measured and to what is kept, where anything is.
pub struct Both<'k, 'a> {
    /// All rows in memory.
    pub rows: Rows,
    /// What goes to the disk.
    pub keeping: Option<&'k mut Keeping<'a>>,
}

impl Observer for Both<'_, '_> {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.rows.row(t, values);
        if let Some(keeping) = &mut self.keeping {
            keeping.recorder.row(t, values);
        }
    }

    fn event(&mut self, t: f64, path: &str, what: &str) {
        if let Some(keeping) = &mut self.keeping {
            keeping.recorder.event(t, path, what);
        }
    }

    fn progress(&mut self, t: f64, counts: &Counts) -> Control {
        match &mut self.keeping {
            Some(keeping) => keeping.recorder.progress(t, counts),
            None => self.rows.progress(t, counts),
        }
    }
}
