//! What a run says at its end: to people, to programs, and to the log.

use std::collections::HashSet;

use blocksim_block::problem::Problem;
use blocksim_block::schedule::{Recorded, Schedule};
use blocksim_recording::{Ended, EventRow, Manifest, Recording};
use blocksim_sim::Counts;
use serde_json::{Value, json};

use crate::args::model::RunArgs;
use crate::loaded::Loaded;
use crate::running::happenings;
use crate::running::start::Began;
use crate::running::summary::summary;
use crate::signals::display::{Shown, shown};
use crate::signals::tracking::trackings;
use crate::signals::{charts, naming, tracking_table};
use crate::terminal::console::Console;
use crate::terminal::places::Texts;
use crate::terminal::render;

/// A finished run.
pub struct Report<'a> {
    /// What was run.
    pub schedule: &'a Schedule,
    /// How it ended.
    pub manifest: &'a Manifest,
    /// Work done.
    pub counts: Counts,
    /// Signals to look at: those of the finest rate.
    pub recorded: &'a [Recorded],
    /// Their values; where they are very many, those of every n-th row.
    pub recording: &'a Recording,
    /// Number of all signals that were recorded.
    pub signals: usize,
    /// Number of all rows of the run.
    pub rows: u64,
    /// What blocks have to say about approximations that missed the tolerance.
    pub warnings: Vec<Problem>,
    /// The steady state that it began in, if it did.
    pub began: Option<Began>,
    /// What happened.
    pub events: &'a [EventRow],
}

impl Report<'_> {
    /// Summary, table and plots.
    pub fn text(&self, place: Option<&str>, args: &RunArgs, console: Console) -> String {
        let shown = self.shown();
        let mut parts =
            vec![self.summary(place), tracking_table::table(&trackings(&shown), &self.recording.time)];
        if !args.no_plot && self.recording.rows() > 1 {
            parts.push(self.plots(&shown, &args.plot, console));
        }
        parts.retain(|part| !part.is_empty());
        parts.join("\n")
    }

    /// The same as data.
    pub fn json(&self, place: &str) -> Value {
        let shown = self.shown();
        let (ended, reason) = match &self.manifest.ended {
            Ended::Unfinished => ("unfinished", None),
            Ended::Complete => ("complete", None),
            Ended::Stopped { reason } => ("stopped", Some(reason)),
            Ended::Interrupted => ("interrupted", None),
            Ended::Failed { reason } => ("failed", Some(reason)),
        };
        json!({
            "v": 2,
            "type": "done",
            "ended": ended,
            "reason": reason,
            "run": place,
            "simulated_time": self.manifest.simulated_time,
            "wall_time": self.manifest.wall_time,
            "steady_start": self.began.as_ref().map(Began::json),
            "steps": self.counts.accepted,
            "rejected": self.counts.rejected,
            "stiff_steps": self.counts.share.map(|share| share.stiff),
            "evaluations": self.counts.evaluations,
            "events": self.counts.events,
            "happened": happenings::data(self.events),
            "sample_hits": self.counts.hits,
            "signals": self.signals,
            "rows": self.rows,
            "tracking": tracking_table::json(&trackings(&shown), &self.recording.time),
        })
    }

    /// A sentence if somebody asked for a plot of signals that are not recorded.
    pub fn plot_warning(&self, args: &RunArgs) -> Option<String> {
        let paths = || self.recording.signals.iter().map(|signal| signal.path.as_str());
        let lost = args.plot.iter().find(|pattern| !paths().any(|path| naming::fits(path, pattern)))?;
        let some: Vec<&str> = paths().take(5).collect();
        let more = if paths().count() > some.len() { ", ..." } else { "" };
        Some(format!("warning: no recorded signal fits `{lost}`; recorded are {}{more}", some.join(", ")))
    }

    fn shown(&self) -> Vec<Shown<'_>> {
        shown(self.recorded, self.recording)
    }

    fn summary(&self, place: Option<&str>) -> String {
        let began = self.began.as_ref().map(Began::text);
        summary(
            &self.schedule.title,
            self.manifest,
            began.as_deref(),
            &self.counts,
            &happenings::lines(self.events),
            self.signals,
            self.rows,
            place,
        )
    }

    fn plots(&self, shown: &[Shown], patterns: &[String], console: Console) -> String {
        let time = &self.recording.time;
        if let Some(text) = charts::chosen(patterns, shown, time, console) {
            return text;
        }
        let trackings = trackings(shown);
        // A scope shows what its author wanted to see; other recorded signals only stand in for one.
        let scopes: HashSet<&str> = self
            .schedule
            .blocks
            .iter()
            .filter(|block| block.interface.recorded.is_some())
            .map(|block| block.path.as_str())
            .collect();
        let of_scope: Vec<&Shown> = shown.iter().filter(|s| scopes.contains(s.block())).collect();
        if !trackings.is_empty() {
            // What two scopes show is told once.
            let mut told: HashSet<usize> =
                trackings.iter().flat_map(|pair| [pair.set.cell, pair.actual.cell]).collect();
            let more: Vec<&Shown> = of_scope.into_iter().filter(|s| told.insert(s.cell)).collect();
            return charts::tracking(&trackings, &more, time, console);
        }
        match of_scope.first().copied().or(shown.first()) {
            Some(first) => charts::block(first.block(), shown, &of_scope, time, console),
            None => String::new(),
        }
    }
}

/// The lines of `log.txt`: the command line's problems, the first events, the summary.
pub fn log(report: &Report, loaded: &Loaded) -> Vec<String> {
    let (problems, texts) =
        (loaded.compiled.problems.iter().chain(&report.warnings), Texts::of(&loaded.files));
    let mut lines: Vec<String> = problems
        .flat_map(|problem| [render::full(problem, &texts, false).trim_end().to_owned(), String::new()])
        .collect();
    lines.push(report.summary(None));
    let shown = report.shown();
    lines.push(tracking_table::table(&trackings(&shown), &report.recording.time));
    lines.push(format!("{} in events.csv", render::plural(report.events.len(), "event")));
    lines.iter().flat_map(|text| text.lines().map(str::to_owned)).collect()
}
