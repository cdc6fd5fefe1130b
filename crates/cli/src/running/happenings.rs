//! The events of a run in a few lines: which part did what, how often and since when.

use std::collections::HashMap;

use blocksim_numbers::format::{count, significant};
use blocksim_recording::EventRow;
use serde_json::{Value, json};

/// Events that are listed in the summary.
const LISTED: usize = 4;
/// Events that are listed as data.
const LISTED_AS_DATA: usize = 1000;

/// All events of one part that read the same, but for an amount.
#[derive(Debug, Clone, PartialEq)]
pub struct Happening<'a> {
    /// The part.
    path: &'a str,
    /// What it does, in words that go behind its path; without the amount where that differs from one to the other.
    what: &'a str,
    /// How often.
    count: u64,
    /// Time of the first and of the last one, s.
    first: f64,
    last: f64,
}

/// The events by part and words, in the order of their first times.
pub fn happenings(events: &[EventRow]) -> Vec<Happening<'_>> {
    let mut places: HashMap<(&str, &str), usize> = HashMap::new();
    let mut all: Vec<Happening> = Vec::new();
    for EventRow { time, path, what } in events {
        let kind = without_amount(what);
        let place = *places.entry((path, kind)).or_insert_with(|| {
            all.push(Happening { path, what, count: 0, first: *time, last: *time });
            all.len() - 1
        });
        let known = &mut all[place];
        if known.what != what {
            known.what = kind;
        }
        known.count += 1;
        known.last = *time;
    }
    all
}

/// `jumps` of `jumps by 5 V`.
fn without_amount(what: &str) -> &str {
    let amount = what
        .split_once(" by ")
        .filter(|(_, amount)| amount.split(' ').next().is_some_and(|number| number.parse::<f64>().is_ok()));
    amount.map_or(what, |(kind, _)| kind)
}

/// A line for each of the first ones: `relay switches on 12 times from 0.350 s`.
pub fn lines(events: &[EventRow]) -> Vec<String> {
    let all = happenings(events);
    let line = |happening: &Happening| {
        let Happening { path, what, first, .. } = happening;
        match happening.count {
            1 => format!("{path} {what} at {} s", significant(*first, 3)),
            n => format!("{path} {what} {} times from {} s", count(n), significant(*first, 3)),
        }
    };
    let mut lines: Vec<String> = all.iter().take(LISTED).map(line).collect();
    if all.len() > LISTED {
        lines.push(format!("and {} more in events.csv", count((all.len() - LISTED) as u64)));
    }
    lines
}

/// The same as data.
pub fn data(events: &[EventRow]) -> Value {
    let entry = |happening: &Happening| {
        let Happening { path, what, count, first, last } = happening;
        json!({ "part": path, "what": what, "count": count, "first": first, "last": last })
    };
    happenings(events).iter().take(LISTED_AS_DATA).map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(time: f64, path: &str, what: &str) -> EventRow {
        EventRow { time, path: path.to_owned(), what: what.to_owned() }
    }

    #[test]
    fn events_are_counted_by_part_and_words() {
        let events = [
            row(0.5, "relay", "switches on"),
            row(0.75, "relay", "switches off"),
            row(1.5, "relay", "switches on"),
            row(2.0, "stop", "touches the upper end"),
        ];
        assert_eq!(
            lines(&events),
            [
                "relay switches on 2 times from 0.500 s",
                "relay switches off at 0.750 s",
                "stop touches the upper end at 2.00 s",
            ]
        );
        let first = json!({ "part": "relay", "what": "switches on", "count": 2, "first": 0.5, "last": 1.5 });
        assert_eq!(data(&events)[0], first);
    }

    #[test]
    fn amounts_are_shown_where_they_are_the_same() {
        let events = [
            row(0.5, "a", "jumps by 5 V"),
            row(0.5, "b", "jumps by -5 V"),
            row(0.6, "a", "jumps by 4.97 V"),
            row(0.7, "b", "jumps by -5 V"),
            row(0.8, "c", "is lifted by hand"),
        ];
        assert_eq!(
            lines(&events),
            [
                "a jumps 2 times from 0.500 s",
                "b jumps by -5 V 2 times from 0.500 s",
                "c is lifted by hand at 0.800 s",
            ]
        );
    }

    #[test]
    fn of_very_many_the_first_are_listed() {
        let events: Vec<EventRow> = (0..9).map(|k| row(f64::from(k), &format!("d{k}"), "conducts")).collect();
        let lines = lines(&events);
        assert_eq!((lines.len(), lines[4].as_str()), (5, "and 5 more in events.csv"));
    }
}
