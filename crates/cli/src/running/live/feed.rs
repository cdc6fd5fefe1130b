//! Rows on their way to who looks: thirty times a second, no more than a screen shows, and without a lost peak.

use std::time::{Duration, Instant};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use blocksim_diagram::PanelItem;
use blocksim_signal::Unit;
use serde_json::json;

use super::mechanism::Mechanism;
use super::panel::{Shown, standing};
use super::scopes::{Scope, panels_json};
use crate::running::tuning::{Came, Setting, written};
use crate::terminal::console::Console;

/// How often rows are told.
const EVERY: Duration = Duration::from_millis(33);
/// Most rows that wait; as soon as there are so many, half of them are left.
const ROWS: usize = 512;
/// Rows between two looks at the clock.
const LOOK: u32 = 4;

/// Rows that wait. Where there are many, stretches of as many rows each have two: the least and the largest value of every signal that
/// is drawn over time, and of positions those of the first and of the last row, since a mechanism is to be seen where it was.
pub struct Feed {
    console: Console,
    /// For each column the position in a row, and what makes its unit of SI.
    columns: Vec<(usize, Unit)>,
    /// How many of them are drawn over time; positions stand behind them, and their set values behind these.
    curves: usize,
    times: Vec<f64>,
    /// Values, column by column.
    values: Vec<Vec<f32>>,
    /// Rows of the run in a stretch of which two are kept; none as long as all are kept.
    stretch: usize,
    /// The stretch that is not full yet: its rows, first and last time, and the rows to be kept of it.
    begun: usize,
    span: [f64; 2],
    kept: Vec<[f32; 2]>,
    told: Instant,
    unlooked: u32,
}

impl Feed {
    /// Tells which scopes there are, which signals the panel shows, and what is seen of the mechanism. Columns of the panel stand behind
    /// those of the scopes, and those of the mechanism behind both.
    pub fn begin(
        scopes: &[Scope],
        (items, shown): (&[PanelItem], &[Shown]),
        mechanism: &Mechanism,
        until: f64,
        console: Console,
    ) -> Feed {
        let paths: Vec<&str> = shown.iter().map(|shown| shown.path.as_str()).collect();
        let event = json!({
            "v": 1, "type": "scopes", "until": until, "panels": panels_json(scopes), "shown": paths, "joints": mechanism.sources.len(),
            "sets": mechanism.sets.iter().map(|(position, _)| position).collect::<Vec<_>>(),
            "scene": mechanism.scene, "unseen": mechanism.unseen, "standing": standing(items),
        });
        // Whoever does not read on is noticed when the run is told at the end.
        let _ = console.data(&format!("{event}\n"));
        let of_scopes = scopes.iter().flat_map(|scope| scope.sources.iter().cloned());
        let curves = of_scopes.chain(shown.iter().map(|shown| shown.source.clone()));
        let sets = mechanism.sets.iter().map(|(_, source)| source.clone());
        let positions = mechanism.sources.iter().cloned().chain(sets);
        Feed::of(curves.collect(), positions.collect(), console)
    }

    fn of(curves: Vec<(usize, Unit)>, positions: Vec<(usize, Unit)>, console: Console) -> Feed {
        let drawn = curves.len();
        let columns: Vec<_> = curves.into_iter().chain(positions).collect();
        Feed {
            console,
            curves: drawn,
            times: Vec::with_capacity(ROWS),
            values: columns.iter().map(|_| Vec::with_capacity(ROWS)).collect(),
            stretch: 0,
            begun: 0,
            span: [0.0; 2],
            kept: vec![[0.0; 2]; columns.len()],
            columns,
            told: Instant::now(),
            unlooked: 0,
        }
    }

    /// Takes a row in SI.
    pub fn row(&mut self, t: f64, values: &[f64]) {
        self.take(t, values);
        self.unlooked += 1;
        if self.unlooked >= LOOK {
            self.unlooked = 0;
            if self.told.elapsed() >= EVERY {
                self.tell();
            }
        }
    }

    fn take(&mut self, t: f64, values: &[f64]) {
        let shown = self.columns.iter().map(|(source, unit)| unit.from_si(values[*source]) as f32);
        if self.stretch == 0 {
            self.times.push(t);
            shown.zip(&mut self.values).for_each(|(value, column)| column.push(value));
        } else {
            for (n, (value, kept)) in shown.zip(&mut self.kept).enumerate() {
                *kept = match self.begun {
                    0 => [value; 2],
                    _ if n < self.curves => ends(&[kept[0], kept[1], value]),
                    _ => [kept[0], value],
                };
            }
            self.span = if self.begun == 0 { [t; 2] } else { [self.span[0], t] };
            self.begun += 1;
            if self.begun == self.stretch {
                self.close();
            }
        }
        if self.times.len() == ROWS {
            self.thin();
        }
    }

    /// Keeps two rows of the stretch that has begun.
    fn close(&mut self) {
        if self.begun > 0 {
            self.times.extend(self.span);
            self.kept.iter().zip(&mut self.values).for_each(|(kept, column)| column.extend(kept));
            self.begun = 0;
        }
    }

    /// Makes stretches twice as long, so that all of them stay alike.
    fn thin(&mut self) {
        self.stretch = if self.stretch == 0 { 4 } else { 2 * self.stretch };
        for (at, column) in self.values.iter_mut().enumerate() {
            for n in 0..ROWS / 4 {
                let four = &column[4 * n..4 * n + 4];
                let [first, last] = if at < self.curves { ends(four) } else { [four[0], four[3]] };
                (column[2 * n], column[2 * n + 1]) = (first, last);
            }
            column.truncate(ROWS / 2);
        }
        for n in 0..ROWS / 4 {
            (self.times[2 * n], self.times[2 * n + 1]) = (self.times[4 * n], self.times[4 * n + 3]);
        }
        self.times.truncate(ROWS / 2);
    }

    /// Tells what came of a parameter that was to change, and where the panel stands now.
    pub fn tuned(&mut self, t: f64, set: &str, came: Came, panel: &[PanelItem]) {
        self.tell();
        let event = match came {
            Ok(without_effect) => {
                json!({
                    "v": 1, "type": "tuned", "t": t, "set": set, "without_effect": without_effect, "change": written(t, set),
                    "standing": standing(panel),
                })
            }
            Err((message, help)) => {
                json!({ "v": 1, "type": "tuned", "t": t, "set": set, "refused": message, "help": help })
            }
        };
        self.say(&event);
    }

    /// Tells that the run is left for another one, which goes back into its past.
    pub fn leaves(&mut self, t: f64) {
        self.tell();
        self.say(&json!({ "v": 1, "type": "left", "t": t }));
    }

    /// Tells that the run stands at a time of its past, with what was set there.
    pub fn is_back<'r>(&mut self, t: f64, setting: &Setting, last: impl Iterator<Item = (f64, &'r [f64])>) {
        let standing = standing(&setting.panel);
        self.say(&json!({ "v": 1, "type": "back", "t": t, "set": setting.set, "standing": standing }));
        last.for_each(|(t, values)| self.take(t, values));
        self.tell();
    }

    /// Tells why the run does not go back.
    pub fn stays(&mut self, t: f64, refused: &str) {
        self.say(&json!({ "v": 1, "type": "back", "t": t, "refused": refused }));
    }

    fn say(&self, event: &serde_json::Value) {
        let _ = self.console.data(&format!("{event}\n"));
    }

    /// Tells what waits.
    pub fn tell(&mut self) {
        self.told = Instant::now();
        self.close();
        self.stretch = 0;
        if self.times.is_empty() {
            return;
        }
        let bytes: Vec<u8> = self.times.iter().flat_map(|t| t.to_le_bytes()).collect();
        let (times, last) = (STANDARD.encode(bytes), self.times.last());
        let bytes: Vec<u8> = self.values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        let event =
            json!({ "v": 1, "type": "rows", "last": last, "t": times, "values": STANDARD.encode(bytes) });
        let _ = self.console.data(&format!("{event}\n"));
        self.times.clear();
        self.values.iter_mut().for_each(Vec::clear);
    }
}

/// Least and largest value in the order in which they came.
fn ends(values: &[f32]) -> [f32; 2] {
    let (mut low, mut high) = (0, 0);
    for (at, value) in values.iter().enumerate() {
        // What is not a number must be seen.
        if value.is_nan() {
            return [*value, *value];
        }
        if *value < values[low] {
            low = at;
        }
        if *value > values[high] {
            high = at;
        }
    }
    [values[low.min(high)], values[low.max(high)]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn however_many_rows_wait_their_course_and_its_peaks_are_kept() {
        let console = Console {
            colour: false,
            live: false,
            width: 80,
            ascii: true,
            format: crate::args::model::Format::Json,
        };
        for rows in [1, 100, ROWS - 1, ROWS, 3 * ROWS, 100_000] {
            let one = Unit::parse("1").unwrap();
            let mut feed = Feed::of(vec![(0, one.clone())], vec![(1, one.clone()), (2, one)], console);
            let at = |n: usize| n as f64 / rows as f64;
            for n in 0..rows {
                // Two positions that turn back and forth within every stretch, but belong together.
                let swing = (n as f64).sin();
                feed.take(at(n), &[if n == rows / 3 { 7.0 } else { at(n) }, swing, -swing]);
            }
            feed.close();
            for ((t, x), y) in feed.times.iter().zip(&feed.values[1]).zip(&feed.values[2]) {
                let swing = (t * rows as f64).round().sin();
                assert_eq!((*x, *y), (swing as f32, -swing as f32), "at {t} of {rows} rows");
            }
            let (times, values) = (&feed.times, &feed.values[0]);
            assert_eq!(times.len(), values.len());
            assert!(
                times.len() <= ROWS + 2 && times.len() >= rows.min(ROWS / 2),
                "{} of {rows}",
                times.len()
            );
            assert_eq!((times[0], *times.last().unwrap()), (0.0, at(rows - 1)));
            assert!(values.contains(&7.0), "the peak of {rows} rows");
            // Stretches are alike, so nothing but the peak is far off.
            let far = times
                .iter()
                .zip(values)
                .filter(|(t, x)| (**t - f64::from(**x)).abs() > 8.0 / ROWS as f64 && **x != 7.0);
            assert_eq!(far.count(), 0, "{rows} rows");
        }
    }

    #[test]
    fn the_ends_of_a_stretch_keep_their_order() {
        assert_eq!(ends(&[1.0, 5.0, -2.0, 3.0]), [5.0, -2.0]);
        assert_eq!(ends(&[1.0, 1.0, 1.0, 1.0]), [1.0, 1.0]);
        assert!(ends(&[1.0, f32::NAN, 9.0, 0.0]).iter().all(|value| value.is_nan()));
    }
}
