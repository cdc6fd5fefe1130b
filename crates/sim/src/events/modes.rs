//! Changes of modes: whether a valve conducts, whether friction sticks. They are events by what they become, which is known only
//! once all modes of an instant have been chosen; of a method of fixed step, which locates no event, they are those at its steps.

use blocksim_block::event::Changes;
use blocksim_block::schedule::{Instance, Schedule};

use crate::events::crossings::phrase;
use crate::{Observer, Simulation};

/// Modes that are looked at.
#[derive(Debug, Clone, Default)]
pub(crate) struct Modes {
    /// Block, place within it and place among all discrete states.
    watched: Vec<(usize, usize, usize)>,
    /// What they were after the last instant.
    before: Vec<f64>,
}

impl Modes {
    pub fn new(schedule: &Schedule) -> Self {
        let mut watched = Vec::new();
        for (index, block) in schedule.blocks.iter().enumerate() {
            let states = block.interface.discrete.iter().enumerate();
            let modes = states.filter(|(_, state)| state.changes.is_some());
            watched.extend(modes.map(|(place, _)| (index, place, block.d + place)));
        }
        Self { before: vec![0.0; watched.len()], watched }
    }

    /// Notes what they are.
    pub fn note(&mut self, d: &[f64]) {
        self.before.iter_mut().zip(&self.watched).for_each(|(before, &(.., cell))| *before = d[cell]);
    }
}

/// The words for the changes of a discrete state of a block.
fn changes(block: &Instance, place: usize) -> Option<&Changes> {
    block.interface.discrete[place].changes.as_deref()
}

/// Appends ` by 4.97 V`, without taking memory.
fn append_amount(words: &mut String, amount: f64, unit: &str) {
    use std::fmt::Write as _;
    use std::io::Write as _;
    // Three digits, then as short as they are.
    let mut digits = [0_u8; 32];
    let mut rest = &mut digits[..];
    let _ = write!(rest, "{amount:.2e}");
    let length = 32 - rest.len();
    let rounded = std::str::from_utf8(&digits[..length]).ok().and_then(|text| text.parse().ok());
    let rounded: f64 = rounded.unwrap_or(amount);
    let _ = match (1e-4..1e7).contains(&rounded.abs()) {
        true => write!(words, " by {rounded} {unit}"),
        false => write!(words, " by {rounded:e} {unit}"),
    };
}

impl Simulation {
    /// Reports the modes that have changed since they were noted last, and notes them; at the start there is no before.
    pub(crate) fn report_modes(&mut self, first: bool, observer: &mut dyn Observer) {
        let Self { modes, diagram, schedule, words, t, .. } = self;
        if modes.watched.is_empty() {
            return;
        }
        for (&(block, place, cell), before) in modes.watched.iter().zip(&modes.before) {
            let (now, block) = (diagram.d[cell], &schedule.blocks[block]);
            if first || now == *before {
                continue;
            }
            if let Some(changes) = changes(block, place)
                && let Some(verb) = changes.phrase(*before, now)
            {
                let path = phrase(words, block, &changes.subject, verb);
                if let Some(unit) = changes.unit {
                    append_amount(words, now - *before, unit);
                }
                observer.event(*t, path, words);
            }
        }
        modes.note(&diagram.d);
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn an_amount_has_three_digits_and_its_unit() {
        let of = |amount: f64| {
            let mut words = "jumps".to_owned();
            super::append_amount(&mut words, amount, "V");
            words
        };
        assert_eq!(of(5.0), "jumps by 5 V");
        assert_eq!(of(-4.9666), "jumps by -4.97 V");
        assert_eq!(of(123_456.0), "jumps by 123000 V");
        assert_eq!(of(3.21e-9), "jumps by 3.21e-9 V");
        assert_eq!(of(f64::INFINITY), "jumps by inf V");
    }
}
