//! Signals of one time base as CSV, however many rows there are.

use std::io::{self, Write};
use std::ops::RangeInclusive;

use crate::within::within;
use blocksim_recording::ResultsError;
use blocksim_recording::Run;
use blocksim_recording::Signal;
use blocksim_recording::{write_headings, write_rows};

/// Writes signals of one time base as [`blocksim_recording::write_signals`] does, some thousand rows at a time.
///
/// # Errors
/// What the destination answers, and as an error of the kind `InvalidData` what reading the run brings.
pub fn write_run_csv(
    destination: &mut dyn Write,
    run: &Run,
    base: usize,
    signals: &[usize],
    range: &RangeInclusive<f64>,
) -> io::Result<()> {
    let heading = |&at: &usize| run.signals().get(at).map(|s| Signal::new(&s.path, &s.unit, s.kind));
    let headings: Vec<Signal> = signals.iter().filter_map(heading).collect();
    write_headings(destination, &headings)?;
    let mut refused = None;
    let done = run.blocks(base, signals, range, &mut |time, values| {
        write_rows(destination, time, values).map_err(|error| {
            let kind = error.kind();
            refused = Some(error);
            ResultsError::io("write", run.path(), kind.into())
        })
    });
    if let Some(error) = refused {
        return Err(error);
    }
    done.map_err(within)?;
    destination.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_recording::{ALWAYS, Kind, Recording, write_signals};

    #[test]
    fn a_run_reads_like_the_recording_it_is_of() {
        let kinds = [("a \"b\", c", "m", Kind::Real), ("open", "1", Kind::Bool), ("n", "1", Kind::Int)];
        let signals = kinds.map(|(path, unit, kind)| Signal::new(path, unit, kind));
        let mut recording = Recording::new(signals.to_vec());
        for k in 0..70_000 {
            recording
                .push_row(f64::from(k) * 1e-3, &[f64::from(k).sqrt(), f64::from(k % 2), -f64::from(k)])
                .unwrap();
        }
        let (mut whole, mut part) = (Vec::new(), Vec::new());
        write_signals(&mut whole, &recording).unwrap();
        let run = Run::of_recording(recording, "memory".as_ref());
        write_run_csv(&mut part, &run, 0, &[0, 1, 2], &ALWAYS).unwrap();
        assert!(whole == part);
        let mut some = Vec::new();
        write_run_csv(&mut some, &run, 0, &[2], &(0.001..=0.002)).unwrap();
        assert_eq!(String::from_utf8(some).unwrap(), "time [s],n [int]\n1e-3,-1\n2e-3,-2\n");
    }
}
