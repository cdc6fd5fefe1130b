//! Parquet files: tables by columns with types, for pandas, Polars, DuckDB, MATLAB and others.

use std::io::{self, Write};
use std::ops::RangeInclusive;
use std::sync::Arc;

use ::parquet::basic::{Compression, Repetition, Type as Physical};
use ::parquet::data_type::{BoolType, DoubleType, Int64Type};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::{EnabledStatistics, WriterProperties};
use ::parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use ::parquet::schema::types::Type;

use crate::within::within;
use blocksim_recording::Kind;
use blocksim_recording::ResultsError;
use blocksim_recording::Run;
use blocksim_recording::SignalInfo;

/// Most values of a row group: what is in memory at a time.
const GROUP: usize = 4 << 20;
/// Most rows of a row group. Readers work on whole groups at once.
const ROWS: usize = 1 << 17;
/// Name of the column of times.
const TIME: &str = "time";

/// Writes signals of one time base within a range of time: the column `time` in s, then one for each signal, named by its
/// path, in SI units. Real signals are doubles; truth values and whole numbers have types of their own and are null where
/// they are not known (NaN). The metadata of the file has under `blocksim` what is known of each column, as JSON, and under
/// `unit:<path>` its unit. Memory is taken for one group of rows, however long the run is.
///
/// # Errors
/// What the destination answers; `InvalidData` for a value that its kind does not have, and for what reading the run brings.
pub fn write_parquet(
    destination: &mut (dyn Write + Send),
    run: &Run,
    base: usize,
    signals: &[usize],
    range: &RangeInclusive<f64>,
) -> io::Result<()> {
    let infos: Vec<&SignalInfo> = signals.iter().filter_map(|&at| run.signals().get(at)).collect();
    let properties = WriterProperties::builder()
        .set_created_by(format!("blocksim {}", env!("CARGO_PKG_VERSION")))
        .set_compression(Compression::SNAPPY)
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_key_value_metadata(Some(metadata(run, &infos)))
        .build();
    let schema = Arc::new(schema(&infos).map_err(refused)?);
    let mut file = SerializedFileWriter::new(destination, schema, Arc::new(properties)).map_err(refused)?;
    let most = (GROUP / (infos.len() + 1)).clamp(64, ROWS);
    let mut columns: Vec<Vec<f64>> = vec![Vec::with_capacity(most); infos.len() + 1];
    let mut failure = None;
    let done = run.blocks(base, signals, range, &mut |time, values| {
        let mut from = 0;
        while from < time.len() {
            let to = time.len().min(from + most - columns[0].len());
            let parts = std::iter::once(time).chain(values.iter().map(Vec::as_slice));
            columns.iter_mut().zip(parts).for_each(|(column, part)| column.extend(&part[from..to]));
            from = to;
            if columns[0].len() == most {
                write_group(&mut file, &mut columns, &infos).map_err(|error| {
                    let kind = error.kind();
                    failure = Some(error);
                    ResultsError::io("write", run.path(), kind.into())
                })?;
            }
        }
        Ok(())
    });
    if let Some(error) = failure {
        return Err(error);
    }
    done.map_err(within)?;
    if !columns[0].is_empty() {
        write_group(&mut file, &mut columns, &infos)?;
    }
    file.close().map_err(refused).map(|_| ())
}

fn schema(infos: &[&SignalInfo]) -> Result<Type, ParquetError> {
    let column = |name: &str, physical, repetition| {
        Type::primitive_type_builder(name, physical).with_repetition(repetition).build().map(Arc::new)
    };
    let mut fields = vec![column(TIME, Physical::DOUBLE, Repetition::REQUIRED)?];
    for info in infos {
        fields.push(match info.kind {
            Kind::Real => column(&info.path, Physical::DOUBLE, Repetition::REQUIRED),
            Kind::Bool => column(&info.path, Physical::BOOLEAN, Repetition::OPTIONAL),
            Kind::Int => column(&info.path, Physical::INT64, Repetition::OPTIONAL),
        }?);
    }
    Type::group_type_builder("run").with_fields(fields).build()
}

fn metadata(run: &Run, infos: &[&SignalInfo]) -> Vec<KeyValue> {
    let columns: Vec<serde_json::Value> = infos
        .iter()
        .map(|info| {
            // The time base says nothing in a file that has only one.
            serde_json::to_value(SignalInfo { base: 0, ..(*info).clone() }).unwrap_or_default()
        })
        .collect();
    let about = serde_json::json!({ "run": run.name(), "columns": columns });
    let mut all = vec![
        KeyValue::new("blocksim".to_owned(), about.to_string()),
        KeyValue::new(format!("unit:{TIME}"), "s".to_owned()),
    ];
    all.extend(infos.iter().map(|info| KeyValue::new(format!("unit:{}", info.path), info.unit.clone())));
    all
}

fn write_group<W: Write + Send>(
    file: &mut SerializedFileWriter<W>,
    columns: &mut [Vec<f64>],
    infos: &[&SignalInfo],
) -> io::Result<()> {
    let mut group = file.next_row_group().map_err(refused)?;
    // The first column is time.
    let kinds = std::iter::once(None).chain(infos.iter().copied().map(Some));
    for (values, info) in columns.iter_mut().zip(kinds) {
        let Some(mut column) = group.next_column().map_err(refused)? else { break };
        write_column(&mut column, values, info)?;
        column.close().map_err(refused)?;
        values.clear();
    }
    group.close().map_err(refused).map(|_| ())
}

fn write_column(
    column: &mut SerializedColumnWriter,
    values: &[f64],
    info: Option<&SignalInfo>,
) -> io::Result<()> {
    let Some(info) = info.filter(|info| info.kind != Kind::Real) else {
        return column.typed::<DoubleType>().write_batch(values, None, None).map_err(refused).map(|_| ());
    };
    let known: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
    let levels: Vec<i16> = values.iter().map(|value| i16::from(!value.is_nan())).collect();
    let odd = |what: &str, value: f64| {
        let message = format!("`{}` is {value}, which is not a {what}", info.path);
        io::Error::new(io::ErrorKind::InvalidData, message)
    };
    let written = if info.kind == Kind::Bool {
        if let Some(&value) = known.iter().find(|&&value| value != 0.0 && value != 1.0) {
            return Err(odd("truth value", value));
        }
        let known: Vec<bool> = known.iter().map(|&value| value == 1.0).collect();
        column.typed::<BoolType>().write_batch(&known, Some(&levels), None)
    } else {
        if let Some(&value) = known.iter().find(|value| value.fract() != 0.0 || value.abs() >= 2_f64.powi(63))
        {
            return Err(odd("whole number", value));
        }
        let known: Vec<i64> = known.iter().map(|&value| value as i64).collect();
        column.typed::<Int64Type>().write_batch(&known, Some(&levels), None)
    };
    written.map_err(refused).map(|_| ())
}

/// An error of the library is one of the destination, where it comes from there.
fn refused(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(source) => match source.downcast::<io::Error>() {
            Ok(source) => *source,
            Err(source) => io::Error::other(source),
        },
        error => io::Error::other(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::parquet::file::reader::{FileReader, SerializedFileReader};
    use ::parquet::record::RowAccessor;
    use blocksim_recording::{ALWAYS, Recording, Signal};
    use bytes::Bytes;

    fn example(rows: u32) -> Run {
        let kinds = [
            ("servo/angle.actual", "rad", Kind::Real),
            ("is open", "1", Kind::Bool),
            ("n[0]", "1", Kind::Int),
        ];
        let mut recording =
            Recording::new(kinds.map(|(path, unit, kind)| Signal::new(path, unit, kind)).to_vec());
        for k in 0..rows {
            let odd = if k == 2 { f64::NAN } else { f64::from(k % 2) };
            recording
                .push_row(f64::from(k) * 1e-3, &[f64::from(k).sqrt() - 1.0, odd, -f64::from(k)])
                .unwrap();
        }
        Run::of_recording(recording, "runs/example".as_ref())
    }

    fn written(run: &Run, range: &RangeInclusive<f64>) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_parquet(&mut bytes, run, 0, &[0, 1, 2], range).unwrap();
        bytes
    }

    #[test]
    fn all_values_come_back_from_several_groups_of_rows_with_names_units_and_types() {
        let rows = 2 * ROWS as u32 + 10;
        let file = SerializedFileReader::new(Bytes::from(written(&example(rows), &ALWAYS))).unwrap();
        assert_eq!((file.num_row_groups(), file.metadata().file_metadata().num_rows()), (3, i64::from(rows)));
        let about = file.metadata().file_metadata().key_value_metadata().unwrap();
        let value = |key: &str| about.iter().find(|pair| pair.key == key).and_then(|pair| pair.value.clone());
        assert_eq!(value("unit:servo/angle.actual").as_deref(), Some("rad"));
        assert!(value("blocksim").unwrap().contains(r#""kind":"bool","path":"is open","unit":"1""#));
        for (k, row) in file.get_row_iter(None).unwrap().enumerate() {
            let row = row.unwrap();
            assert_eq!(
                (row.get_double(0).unwrap(), row.get_double(1).unwrap()),
                (k as f64 * 1e-3, (k as f64).sqrt() - 1.0)
            );
            assert_eq!(row.get_bool(2).ok(), (k != 2).then_some(k % 2 == 1));
            assert_eq!(row.get_long(3).unwrap(), -(k as i64));
        }
    }

    /// A file with this fingerprint was read by pyarrow 26, pandas 3.1 and DuckDB 2.0: names, types, values, nulls and metadata
    /// as written. Where it changes, such a reader has to see the new file.
    #[test]
    fn a_small_file_is_the_one_that_other_programs_have_read() {
        let bytes = written(&example(5), &ALWAYS);
        expect_test::expect!["b9d4118d"].assert_eq(&format!("{:08x}", crc32fast::hash(&bytes)));
    }

    #[test]
    fn a_part_of_a_run_and_an_empty_one_are_written() {
        let rows = |bytes: Vec<u8>| {
            SerializedFileReader::new(Bytes::from(bytes)).unwrap().metadata().file_metadata().num_rows()
        };
        assert_eq!(rows(written(&example(10), &(0.0015..=0.0045))), 3);
        assert_eq!(rows(written(&example(0), &ALWAYS)), 0);
    }

    #[test]
    fn a_value_that_its_kind_does_not_have_is_told() {
        let mut recording = Recording::new(vec![Signal::new("a.y", "1", Kind::Int)]);
        recording.push_row(0.0, &[0.5]).unwrap();
        let run = Run::of_recording(recording, "runs/odd".as_ref());
        let error = write_parquet(&mut Vec::new(), &run, 0, &[0], &ALWAYS).unwrap_err();
        assert_eq!(
            (error.kind(), error.to_string()),
            (io::ErrorKind::InvalidData, "`a.y` is 0.5, which is not a whole number".to_owned())
        );
    }

    /// Takes so many bytes and no more.
    struct Full(usize);

    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if bytes.len() > self.0 {
                return Err(io::ErrorKind::StorageFull.into());
            }
            self.0 -= bytes.len();
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_full_disk_is_told_as_such() {
        for room in [0, 10_000, 3_000_000] {
            let run = example(2 * ROWS as u32);
            let error = write_parquet(&mut Full(room), &run, 0, &[0, 1, 2], &ALWAYS).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::StorageFull, "{room}");
        }
    }
}
