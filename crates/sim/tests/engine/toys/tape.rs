use blocksim_sim::{Control, Counts, Observer};

/// Keeps everything.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Tape {
    pub rows: Vec<(f64, Vec<f64>)>,
    pub events: Vec<(f64, String)>,
    /// Times at which the simulation asked whether to go on.
    pub asked: Vec<f64>,
    /// When to say no.
    pub patience: Option<usize>,
}

impl Tape {
    pub fn times(&self) -> Vec<f64> {
        self.rows.iter().map(|row| row.0).collect()
    }

    pub fn column(&self, i: usize) -> Vec<f64> {
        self.rows.iter().map(|row| row.1[i]).collect()
    }

    /// Value of a column in the last row at `t`.
    pub fn at(&self, t: f64, column: usize) -> f64 {
        let row = self.rows.iter().rev().find(|row| row.0 == t);
        row.unwrap_or_else(|| panic!("no row at {t}")).1[column]
    }

    pub fn bits(&self) -> Vec<u64> {
        let rows = self.rows.iter();
        rows.flat_map(|(t, values)| std::iter::once(t).chain(values)).map(|v| v.to_bits()).collect()
    }
}

impl Observer for Tape {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.rows.push((t, values.to_vec()));
    }

    fn event(&mut self, t: f64, path: &str, what: &str) {
        self.events.push((t, format!("{path} {what}")));
    }

    fn progress(&mut self, t: f64, _counts: &Counts) -> Control {
        self.asked.push(t);
        if self.patience == Some(self.asked.len()) { Control::Stop } else { Control::Go }
    }
}
