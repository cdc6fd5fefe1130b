//! What a run leaves on disk beside its recording.

use std::path::PathBuf;

use blocksim_export::write_run_csv;
use blocksim_recording::{ALWAYS, EventRow, Manifest, Rate, Recording, ResultsError, Run, RunFolder};
use blocksim_scene::Scene;

use super::meshes;
use crate::scene;

/// Most numbers that are written as text without being asked: about 200 MB.
const MOST_TEXT: u64 = 20_000_000;
/// Most numbers that are looked at for the summary and the pictures.
const MOST_SEEN: u64 = 16_000_000;

/// Whether signals are written as CSV, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Csv {
    /// However many they are.
    Always,
    /// Unless they are very many.
    Sensibly,
    /// Not at all.
    Never,
}

/// Everything of a run but its recording.
#[derive(Debug, Clone, Copy)]
pub struct Rest<'a> {
    /// Whether signals are written as CSV.
    pub csv: Csv,
    /// What happened.
    pub events: &'a [EventRow],
    /// Lines of the log.
    pub log: &'a [String],
    /// What was run.
    pub manifest: &'a Manifest,
    /// How bodies look, where there are any.
    pub scene: Option<&'a Scene>,
}

/// What has become of the folder of a run.
#[derive(Debug)]
pub struct Kept {
    /// Where it is now.
    pub folder: PathBuf,
    /// Why signals are not there as text, if they should be. The recording has them.
    pub untold: Option<ResultsError>,
}

/// Writes it and gives the folder its name.
///
/// # Errors
/// [`ResultsError`] with the first file that cannot be written. The recording stays where it is.
pub fn keep(folder: RunFolder, run: &Run, rest: Rest) -> Result<Kept, ResultsError> {
    folder.write_events(rest.events)?;
    folder.write_log(rest.log)?;
    if let Some(scene) = rest.scene {
        let kept = meshes::keep(&folder, scene)?;
        folder.write("scene.json", |out| out.write_all(scene::json(scene, &kept).as_bytes()))?;
    }
    folder.write_manifest(rest.manifest)?;
    // Last, as it takes most room and can be made again.
    let tables = if is_csv_written(run, rest.csv) { write_tables(&folder, run) } else { Ok(()) };
    Ok(Kept { folder: folder.finish()?, untold: tables.err() })
}

fn write_tables(folder: &RunFolder, run: &Run) -> Result<(), ResultsError> {
    for (base, rate) in run.rates().iter().enumerate() {
        if let Some(name) = file_of(base, *rate) {
            let signals = of_base(run, base);
            folder.write(&name, |w| write_run_csv(w, run, base, &signals, &ALWAYS))?;
        }
    }
    Ok(())
}

/// Whether the signals of a run are written as text.
pub fn is_csv_written(run: &Run, csv: Csv) -> bool {
    let numbers = |base: usize| run.rows(base) * (of_base(run, base).len() as u64 + 1);
    match csv {
        Csv::Always => true,
        Csv::Never => false,
        Csv::Sensibly => (0..run.rates().len()).map(numbers).sum::<u64>() <= MOST_TEXT,
    }
}

/// Name of the table of a time base: `signals.csv`, `signals-10ms.csv`. Least and largest values have none: their times
/// differ from signal to signal.
fn file_of(base: usize, rate: Rate) -> Option<String> {
    Some(match rate {
        Rate::Extremes(_) => return None,
        _ if base == 0 => "signals.csv".to_owned(),
        Rate::All => "signals-all.csv".to_owned(),
        Rate::Nth(n) => format!("signals-{n}rows.csv"),
        Rate::Every(dt) if dt < 1.0 => format!("signals-{}ms.csv", 1e3 * dt),
        Rate::Every(dt) => format!("signals-{dt}s.csv"),
    })
}

/// The signals of a time base.
pub fn of_base(run: &Run, base: usize) -> Vec<usize> {
    (0..run.signals().len()).filter(|&at| run.signals()[at].base == base).collect()
}

/// Signals for the summary and the pictures.
pub struct Seen {
    /// Positions of the signals in the run: those of the time base that has most of them.
    pub signals: Vec<usize>,
    /// Their values.
    pub recording: Recording,
    /// Every so manieth row was looked at.
    pub stride: u64,
}

/// What is looked at of a run.
///
/// # Errors
/// [`ResultsError`] where it cannot be read.
pub fn seen(run: &Run) -> Result<Seen, ResultsError> {
    let bases = 0..run.rates().len();
    let base = bases.rev().max_by_key(|&base| of_base(run, base).len()).unwrap_or(0);
    let signals = of_base(run, base);
    let (recording, stride) = run.thinned(base, &signals, &ALWAYS, MOST_SEEN)?;
    Ok(Seen { signals, recording, stride })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_named_after_their_rates() {
        assert_eq!(file_of(0, Rate::Every(0.01)).as_deref(), Some("signals.csv"));
        assert_eq!(file_of(1, Rate::Every(0.01)).as_deref(), Some("signals-10ms.csv"));
        assert_eq!(file_of(1, Rate::Every(2.0)).as_deref(), Some("signals-2s.csv"));
        assert_eq!(file_of(1, Rate::Nth(10)).as_deref(), Some("signals-10rows.csv"));
        assert_eq!(file_of(0, Rate::Extremes(1.0)), None);
    }
}
