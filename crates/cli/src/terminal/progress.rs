//! How far a run is.

use std::time::{Duration, Instant};

use blocksim_numbers::format::{duration, fixed, significant};
use serde_json::json;

use crate::terminal::console::Console;

/// Signs of the bar.
const BAR: usize = 30;

/// How progress is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Telling {
    /// A line on the standard error that is rewritten, or, without a terminal, one every five seconds.
    People,
    /// A JSON object every second on the standard output.
    Data,
    /// The same ten times a second, for who looks at it.
    Live,
    /// Not at all.
    Silent,
}

/// Tells from time to time how far a run is.
#[derive(Debug)]
pub struct Progress {
    console: Console,
    telling: Telling,
    began: Instant,
    last: Instant,
    /// A line stands on the terminal and must be wiped.
    standing: bool,
    end: f64,
}

impl Progress {
    /// Begins now; `end` is the time to be simulated, s.
    pub fn new(console: Console, telling: Telling, end: f64) -> Progress {
        let now = Instant::now();
        Progress { console, telling, began: now, last: now, standing: false, end }
    }

    /// Tells where the run is, if it is time for it.
    pub fn report(&mut self, t: f64) {
        let every = match self.telling {
            Telling::Silent => return,
            Telling::Data => Duration::from_secs(1),
            Telling::Live => Duration::from_millis(100),
            Telling::People if self.console.live => Duration::from_millis(100),
            Telling::People => Duration::from_secs(5),
        };
        let now = Instant::now();
        if now.duration_since(self.last) < every {
            return;
        }
        self.last = now;
        let wall = now.duration_since(self.began).as_secs_f64();
        match self.telling {
            Telling::Data | Telling::Live => {
                let event = json!({"v": 1, "type": "progress", "t": t, "until": self.end, "real_time_factor": t / wall});
                // A reader that has gone away is noticed when the result is written.
                let _ = self.console.data(&format!("{event}\n"));
            }
            _ if self.console.live => {
                self.standing = true;
                self.console.rewrite(&bar(t, self.end, wall, self.console));
            }
            _ => self.console.say(&line(t, self.end, wall)),
        }
    }

    /// Wipes the line; returns the time on the clock on the wall since the start, s.
    pub fn finish(&mut self) -> f64 {
        if self.standing {
            self.console.rewrite("");
            self.standing = false;
        }
        self.began.elapsed().as_secs_f64()
    }
}

/// `  Running 7.620 / 10.000 s, 23.8 times real time, 0.10 s left`.
fn line(t: f64, end: f64, wall: f64) -> String {
    let left = if t > 0.0 { format!(", {} left", duration(wall * (end - t) / t)) } else { String::new() };
    format!(
        "  Running {} / {} s, {} times real time{left}",
        fixed(t, 3),
        fixed(end, 3),
        significant(t / wall.max(1e-9), 3)
    )
}

/// The line with a bar, cut to the width of the terminal so that it can be rewritten.
fn bar(t: f64, end: f64, wall: f64, console: Console) -> String {
    let (full, empty) = if console.ascii { ("#", "-") } else { ("━", "┄") };
    let done = ((t / end).clamp(0.0, 1.0) * BAR as f64) as usize;
    let text = line(t, end, wall);
    let numbers = text.trim_start_matches("  Running ");
    let whole = format!("  Running {}{} {numbers}", full.repeat(done), empty.repeat(BAR - done));
    if whole.chars().count() < console.width { whole } else { text.chars().take(console.width - 1).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::model::Format;
    use expect_test::expect;

    const CONSOLE: Console =
        Console { colour: false, live: true, width: 100, ascii: false, format: Format::Full };

    #[test]
    fn a_line_tells_time_speed_and_what_is_left() {
        expect!["  Running 7.620 / 10.000 s, 23.8 times real time, 0.10 s left"]
            .assert_eq(&line(7.62, 10.0, 0.32));
        expect!["  Running 0.000 / 10.000 s, 0 times real time"].assert_eq(&line(0.0, 10.0, 3.0));
    }

    #[test]
    fn the_bar_fits_the_terminal() {
        expect![
            "  Running ━━━━━━━━━━━━━━━━━━━━━━┄┄┄┄┄┄┄┄ 7.620 / 10.000 s, 23.8 times real time, 0.10 s left"
        ]
        .assert_eq(&bar(7.62, 10.0, 0.32, CONSOLE));
        expect![
            "  Running ###############--------------- 5.000 / 10.000 s, 50.0 times real time, 0.10 s left"
        ]
        .assert_eq(&bar(5.0, 10.0, 0.1, Console { ascii: true, ..CONSOLE }));
        let narrow = Console { width: 40, ..CONSOLE };
        for t in [0.0, 5.0, 10.0, 11.0] {
            assert!(bar(t, 10.0, 0.1, narrow).chars().count() < 40);
        }
    }
}
