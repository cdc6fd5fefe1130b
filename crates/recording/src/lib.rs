//! What a run leaves on disk. Knows nothing of blocks.
//!
//! A run is a folder `runs/<UTC time>_<name>/` with `manifest.json` (what was run and how it ended),
//! `signals.rec`, `signals.csv`, `events.csv` and `log.txt`. [`RunFolder`] writes it so that it exists as a whole
//! or not at all, [`Run`] reads it.

pub mod clock;
mod csv;
mod csv_record;
mod csv_write;
mod error;
mod extremes;
mod foreign;
mod held_signals;
mod history;
mod manifest;
mod number;

mod place;
mod recording;
mod regular;
mod run;
mod run_folder;
mod store;
mod thin;
mod titles;

pub use csv::{ReadLimits, read_csv, read_csv_file, read_events};
pub use csv_write::{write_events, write_headings, write_rows, write_signals};
pub use error::{CsvError, RecordingError, ResultsError};
pub use foreign::{Beginning, Foreign, ForeignColumn, beginning, read_foreign, read_foreign_file};
pub use history::{Kept, history, locate};
pub use manifest::{
    BaseUsed, Choice, Counts, Ended, FileUsed, Manifest, Override, Program, RecordedUsed, SolverUsed,
};
pub use place::{probe, write_whole};
pub use recording::{Column, EventRow, Kind, Recording, Signal};
pub use regular::{MOST_TEXT, limited_bytes, limited_text, open_regular};
pub use run::{ALWAYS, Run, STORE};
pub use run_folder::RunFolder;
pub use store::{Layout, Rate, SignalInfo, Store, StoreWriter, Stream, Take, write_store};
pub use titles::titles;
