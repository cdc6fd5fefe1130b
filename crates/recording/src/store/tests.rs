use std::fs;

use super::*;
use crate::place::tests::Scratch;
use crate::run::ALWAYS;
use crate::{Kind, Recording, ResultsError, Run, Signal};

/// Two time bases, all kinds, names that need escaping, and all bit patterns that a generator comes by.
fn layout() -> Layout {
    let signal = |path: &str, kind, base| SignalInfo {
        path: path.into(),
        unit: "rad".into(),
        display: (base == 0).then(|| "deg".into()),
        kind,
        base,
        ..SignalInfo::default()
    };
    Layout {
        rates: vec![Rate::All, Rate::Every(0.1)],
        signals: vec![
            signal("servo/angle.actual", Kind::Real, 0),
            signal("odd, \"name\"\nü<script>", Kind::Real, 1),
            signal("is_open", Kind::Bool, 0),
            signal("hits", Kind::Int, 1),
            signal("constant", Kind::Real, 0),
        ],
    }
}

fn row(k: u32) -> [f64; 3] {
    let bits = u64::from(k).wrapping_mul(0x5851_f42d_4c95_7f2d).rotate_left(k % 64);
    [f64::from_bits(bits), f64::from(k % 3 / 2), -0.0]
}

/// 1000 rows in three chunks on the first base, 100 in two on the second.
fn bytes() -> Vec<u8> {
    let mut writer = StoreWriter::new(Vec::new(), &layout()).unwrap();
    for (from, to) in [(0, 400), (400, 401), (401, 1000)] {
        let rows = (from..to).flat_map(|k| [[f64::from(k) * 0.01].as_slice(), &row(k)].concat());
        writer.write(0, &rows.collect::<Vec<_>>()).unwrap();
        let coarse = (from / 10..to / 10).flat_map(|k| [f64::from(k) * 0.1, f64::NAN, f64::from(k)]);
        writer.write(1, &coarse.collect::<Vec<_>>()).unwrap();
    }
    writer.close().unwrap();
    writer.into_inner()
}

fn opened(scratch: &Scratch, bytes: &[u8]) -> Result<Store, ResultsError> {
    let path = scratch.0.join("signals.rec");
    fs::write(&path, bytes).unwrap();
    Store::open(&path)
}

fn all(store: &Store, base: usize, signals: &[usize]) -> Result<(Vec<f64>, Vec<Vec<f64>>), ResultsError> {
    let (mut times, mut columns) = (Vec::new(), vec![Vec::new(); signals.len()]);
    store.blocks(base, signals, &ALWAYS, &mut |t, values| {
        times.extend(t);
        columns.iter_mut().zip(values).for_each(|(column, values)| column.extend(values));
        Ok(())
    })?;
    Ok((times, columns))
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn what_was_written_is_read_back_bit_by_bit_on_both_time_bases() {
    let scratch = Scratch::new();
    let store = opened(&scratch, &bytes()).unwrap();
    assert!(store.is_whole());
    assert_eq!(*store.layout(), layout());
    assert_eq!((store.rows(0), store.rows(1), store.rows(9)), (1000, 100, 0));
    assert_eq!(store.span(0), Some((0.0, 9.99)));
    let (times, columns) = all(&store, 0, &[4, 0, 2]).unwrap();
    assert_eq!(times, (0..1000).map(|k| f64::from(k) * 0.01).collect::<Vec<_>>());
    for (column, element) in columns.iter().zip([2, 0, 1]) {
        assert_eq!(bits(column), bits(&(0..1000).map(|k| row(k)[element]).collect::<Vec<_>>()));
    }
    let (_, columns) = all(&store, 1, &[3, 1]).unwrap();
    assert_eq!(columns[0], (0..100).map(f64::from).collect::<Vec<_>>());
    assert!(columns[1].iter().all(|value| value.is_nan()));
    assert!(all(&store, 0, &[1]).is_err(), "a signal of the other time base");
}

#[test]
fn a_range_of_time_is_read_with_both_its_bounds() {
    let scratch = Scratch::new();
    opened(&scratch, &bytes()).unwrap();
    let run = Run::open(&scratch.0).unwrap();
    let hits = run.find("hits").unwrap();
    let column = run.read(hits, &(0.3..=0.5)).unwrap();
    assert_eq!(column.values, [3.0, 4.0, 5.0]);
    assert_eq!(run.read(0, &(3.985..=4.015)).unwrap().time, [3.99, 4.0, 4.01], "over three chunks");
    assert!(run.read(0, &(20.0..=30.0)).unwrap().time.is_empty());
    assert!(run.read(0, &(5.0..=4.0)).unwrap().time.is_empty());
    let together = run.read_together(&[0, 2], &(0.0..=0.05)).unwrap();
    assert_eq!((together.rows(), together.signals[1].path.as_str()), (6, "is_open"));
    assert!(matches!(run.read_together(&[0, 1], &ALWAYS), Err(ResultsError::TwoRates { .. })));
    assert!(
        run.overview(4, &ALWAYS, 10)
            .unwrap()
            .values
            .iter()
            .all(|value| value.to_bits() == (-0.0_f64).to_bits())
    );
    assert_eq!(run.shortfall(), None);
    assert_eq!(run.span(), Some((0.0, 9.99)));
    let error = run.find("Servo/Angle").unwrap_err();
    assert!(error.to_string().contains("did you mean `servo/angle.actual`?"), "{error}");
    assert!(run.read(5, &ALWAYS).is_err());
}

#[test]
fn an_unfinished_recording_is_read_to_its_last_whole_chunk() {
    let scratch = Scratch::new();
    let whole = bytes();
    let header = 20 + u32::from_le_bytes(whole[12..16].try_into().unwrap()) as usize;
    let mut rows_before = 0;
    for length in (header..whole.len()).step_by(67).chain([whole.len() - 1]) {
        let store = opened(&scratch, &whole[..length]).unwrap();
        assert!(!store.is_whole());
        let rows = store.rows(0);
        assert!([0, 400, 401, 1000].contains(&rows) && rows >= rows_before, "{rows}");
        rows_before = rows;
        let (_, columns) = all(&store, 0, &[0]).unwrap();
        assert_eq!(bits(&columns[0]), bits(&(0..rows as u32).map(|k| row(k)[0]).collect::<Vec<_>>()));
    }
    assert_eq!(rows_before, 1000);
    for length in (0..header).step_by(11) {
        assert!(opened(&scratch, &whole[..length]).is_err());
    }
    let run = Run::open(&scratch.0.join("signals.rec"));
    assert!(run.is_err());
    fs::write(scratch.0.join("signals.rec"), &whole[..whole.len() - 1]).unwrap();
    let run = Run::open(&scratch.0).unwrap();
    assert!(run.shortfall().unwrap().starts_with("its recording was not closed"));
}

#[test]
fn a_damaged_recording_is_refused_or_read_as_it_was() {
    let scratch = Scratch::new();
    let whole = bytes();
    let (_, expected) = all(&opened(&scratch, &whole).unwrap(), 0, &[0, 2, 4]).unwrap();
    let mut refused = 0;
    for at in (0..300).chain((300..whole.len()).step_by(41)) {
        for flip in [0x01, 0xff] {
            let mut damaged = whole.clone();
            damaged[at] ^= flip;
            let Ok(store) = opened(&scratch, &damaged) else {
                refused += 1;
                continue;
            };
            match all(&store, 0, &[0, 2, 4]) {
                Err(_) => refused += 1,
                // What is left of a file whose index is lost may be shorter.
                Ok((_, columns)) => {
                    for (column, expected) in columns.iter().zip(&expected) {
                        assert_eq!(bits(column), bits(&expected[..column.len()]), "byte {at}");
                    }
                }
            }
        }
    }
    assert!(refused > whole.len() / 41, "{refused}");
}

#[test]
fn any_bytes_behind_the_first_ones_are_refused_without_a_panic() {
    let scratch = Scratch::new();
    let whole = bytes();
    let mut seed = 1_u64;
    let mut next = move || {
        seed = seed.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        (seed >> 33) as usize
    };
    for _ in 0..500 {
        let mut damaged = whole.clone();
        for _ in 0..1 + next() % 8 {
            let (from, to, length) = (next() % whole.len(), next() % whole.len(), next() % 64);
            // Copies parts over others, so that tags and lengths meet where they should not.
            let length = length.min(whole.len() - from.max(to));
            damaged[to..to + length].copy_from_slice(&whole[from..from + length]);
        }
        damaged.truncate(whole.len() - next() % 200);
        if let Ok(store) = opened(&scratch, &damaged) {
            let _ = all(&store, 0, &[0, 2, 4]);
            let _ = all(&store, 1, &[1]);
        }
    }
}

#[test]
fn mistakes_are_told_with_a_reason() {
    let scratch = Scratch::new();
    let reason = |bytes: &[u8]| opened(&scratch, bytes).unwrap_err().reason();
    assert_eq!(reason(b""), "it is not a recording of blocksim, or only the first bytes of one");
    assert_eq!(
        reason(b"time [s],a\n0,1\n1,2\n3,4\n"),
        "it is not a recording of blocksim, or only the first bytes of one"
    );
    let mut newer = bytes();
    newer[8] = 9;
    assert_eq!(reason(&newer), "it is a recording of version 9; this program reads versions 1 to 2");
    assert_eq!(reason(&bytes()[..30]), "it ends within its header");
    let mut damaged = bytes();
    damaged[25] ^= 1;
    assert_eq!(reason(&damaged), "its header is damaged");
    let error = Run::open(&scratch.0.join("none")).unwrap_err();
    assert!(error.to_string().ends_with("it does not exist; check the path"), "{error}");
    fs::create_dir(scratch.0.join("empty")).unwrap();
    assert!(matches!(Run::open(&scratch.0.join("empty")), Err(ResultsError::NoRun { .. })));
}

#[test]
fn a_recording_in_memory_is_written_and_a_run_without_rows_or_signals_is_read() {
    let scratch = Scratch::new();
    let mut recording = Recording::new(vec![Signal::new("a", "m", Kind::Real)]);
    let store = |recording: &Recording| {
        let bytes = write_store(Vec::new(), &Layout::of(recording), recording).unwrap();
        opened(&scratch, &bytes).unwrap()
    };
    let empty = store(&recording);
    assert_eq!((empty.rows(0), empty.span(0), empty.is_whole()), (0, None, true));
    let column = Run::open(&scratch.0).unwrap().overview(0, &ALWAYS, 100).unwrap();
    assert!(column.time.is_empty());
    for k in 0..200_000 {
        recording.push_row(f64::from(k), &[f64::from(k).sqrt()]).unwrap();
    }
    let (times, columns) = all(&store(&recording), 0, &[0]).unwrap();
    assert_eq!((times, &columns[0]), (recording.time.clone(), &recording.signals[0].values));
    let mut nothing = Recording::new(Vec::new());
    nothing.push_row(0.0, &[]).unwrap();
    assert_eq!(store(&nothing).rows(0), 1);
}

#[test]
fn a_table_is_a_run_as_well() {
    let scratch = Scratch::new();
    fs::write(scratch.0.join("signals.csv"), "time [s],a [m],b [bool]\n0,1,0\n1,2,1\n1,3,1\n").unwrap();
    fs::write(scratch.0.join("events.csv"), "time [s],path,what\n1,a,jump\n").unwrap();
    let run = Run::open(&scratch.0).unwrap();
    assert_eq!(run.signals()[1].kind, Kind::Bool);
    assert_eq!(run.read(0, &(0.5..=1.0)).unwrap().values, [2.0, 3.0]);
    assert_eq!(run.overview(0, &ALWAYS, 100).unwrap().values, [1.0, 2.0, 3.0]);
    assert_eq!(run.events().unwrap()[0].what, "jump");
    let alone = Run::open(&scratch.0.join("signals.csv")).unwrap();
    assert_eq!((alone.name().as_str(), alone.events().unwrap().len()), ("signals", 0));
}

#[test]
fn a_range_is_widened_to_rows_on_both_sides() {
    let scratch = Scratch::new();
    let store = opened(&scratch, &bytes()).unwrap();
    let recording = Recording { time: (0..1000).map(|k| f64::from(k) * 0.01).collect(), signals: Vec::new() };
    let signal = Signal { values: vec![0.0; 1000], ..Signal::new("x", "1", Kind::Real) };
    let table = Run::of_recording(Recording { signals: vec![signal], ..recording }, &scratch.0);
    // Within a chunk, at its ends, in the one of a single row, between two rows, and all.
    for (from, to) in
        [(1.005, 1.2), (0.0, 3.99), (4.0, 4.0), (3.995, 4.002), (4.012, 4.018), (9.98, 9.99), (-1.0, 11.0)]
    {
        for wide in [store.around(0, &(from..=to)), table.around(0, &(from..=to)).unwrap()] {
            assert!(*wide.start() < from || from <= 0.0, "{wide:?} of {from} to {to}");
            assert!(*wide.end() > to || to >= 9.99, "{wide:?} of {from} to {to}");
            assert!(*wide.start() <= from && *wide.end() >= to, "{wide:?} of {from} to {to}");
        }
    }
    assert_eq!(store.around(0, &ALWAYS), ALWAYS);
    assert_eq!(table.around(0, &ALWAYS).unwrap(), ALWAYS);
    assert!(table.around(7, &ALWAYS).is_err());
}
