//! What a run leaves on disk and shows in the terminal. Knows nothing of blocks.
//!
//! A run is a folder `runs/<UTC time>_<name>/` with `manifest.json` (what was run and how it ended),
//! `signals.rec`, `signals.csv`, `events.csv` and `log.txt`. [`RunFolder`] writes it so that it exists as a whole
//! or not at all, [`Run`] reads it. [`plot`], [`Table`] and the functions of [`format`](mod@format) are the same run for a person at a
//! terminal.

mod canvas;
pub mod clock;
mod csv;
mod csv_record;
mod csv_write;
mod error;
mod export;
mod extremes;
mod foreign;
mod held_signals;
mod history;
mod manifest;
mod place;
mod recording;
mod regular;
mod run;
mod run_folder;
mod sparkline;
mod store;
mod summary;
mod table;
mod terminal;
mod thin;
mod titles;

pub use blocksim_numbers::format;
pub use csv::{ReadLimits, read_csv, read_csv_file, read_events};
pub use csv_write::{write_events, write_signals};
pub use error::{CsvError, RecordingError, ResultsError};
#[cfg(feature = "parquet")]
pub use export::write_parquet;
pub use export::{resampled, write_mat, write_run_csv};
pub use foreign::{Foreign, ForeignColumn, read_foreign, read_foreign_file};
pub use history::{Kept, history, locate};
pub use manifest::{
    BaseUsed, Choice, Counts, Ended, FileUsed, Manifest, Override, Program, RecordedUsed, SolverUsed,
};
pub use place::{probe, write_whole};
pub use recording::{Column, EventRow, Kind, Recording, Signal};
pub use regular::{MOST_TEXT, limited_bytes, limited_text, open_regular};
pub use run::{ALWAYS, Run, STORE};
pub use run_folder::RunFolder;
pub use sparkline::sparkline;
pub use store::{Layout, Rate, SignalInfo, Store, StoreWriter, Stream, Take, write_store};
pub use summary::done_line;
pub use table::{Align, Table};
pub use terminal::{PlotOptions, Series, plot};
pub use titles::titles;
