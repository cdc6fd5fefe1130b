//! Signals that no picture shows, as data of the page.

use serde_json::{Value, json};

use crate::corridor::few;
use crate::data::Unseen;
use crate::pack::Pack;

/// Adds their courses, of at most about `most` points each where that is asked for; what finds them there. All times
/// lie behind each other, and so do all values.
pub(crate) fn courses(signals: &[Unseen], most: Option<usize>, pack: &mut Pack) -> Value {
    let (mut counts, mut time, mut values, mut off) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for signal in signals {
        let length = signal.time.len();
        let (rows, more) = match most {
            Some(most) if length > most => {
                let few = few(&signal.time, &signal.values, signal.held, most);
                (few.rows, few.tolerance)
            }
            _ => ((0..length).collect(), 0.0),
        };
        counts.push(rows.len());
        time.extend(rows.iter().map(|&row| signal.time[row]));
        values.extend(rows.iter().map(|&row| signal.values[row]));
        off.push(signal.tolerance + more);
    }
    // Where all are kept, they are kept with all digits.
    let mut put = |values: &[f64]| if most.is_none() { pack.wide(values) } else { pack.narrow(values) };
    json!({ "counts": counts, "time": put(&time), "values": put(&values), "off": put(&off) })
}

/// What they are called: path, unit, and whether values are held.
pub(crate) fn names(signals: &[Unseen]) -> Value {
    let names = signals.iter().map(|signal| json!([signal.path, signal.unit, u8::from(signal.held)]));
    Value::Array(names.collect())
}
