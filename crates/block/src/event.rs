//! What events are called: the words behind the path of a part, as in `bridge.diode_3 conducts`.
//!
//! A guard whose crossing says what happens has a phrase for each direction ([`Event::Crossing`]). Where only the mode that is
//! chosen then says it, such as whether a valve conducts, the mode has phrases for its values ([`Changes`]), and the
//! guard has none ([`Event::Mode`]). A phrase starts with a verb, so that it reads behind the name of the part.

/// What the crossing of a guard is called.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Event {
    /// By the name of the guard: it has no phrases of its own.
    #[default]
    Name,
    /// One phrase for each direction.
    Crossing {
        /// From below zero to zero or above, or at a maximum.
        upwards: &'static str,
        /// From above zero to zero or below.
        downwards: &'static str,
    },
    /// Not at all: a discrete state or a jump of the block has the words for what follows.
    Mode,
    /// Not at all: nothing happens there, the law only bends, and a step ends.
    Bend,
}

/// One way in which a discrete state may change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// The value before; any if absent.
    pub from: Option<f64>,
    /// The value after; any if absent.
    pub to: Option<f64>,
    /// What it is called; empty where the change is no event.
    pub phrase: &'static str,
}

impl Change {
    /// A change to a value.
    pub const fn to(value: f64, phrase: &'static str) -> Self {
        Self { from: None, to: Some(value), phrase }
    }

    /// A change from a value.
    pub const fn from(value: f64, phrase: &'static str) -> Self {
        Self { from: Some(value), to: None, phrase }
    }

    /// Any other change.
    pub const fn any(phrase: &'static str) -> Self {
        Self { from: None, to: None, phrase }
    }

    fn fits(&self, from: f64, to: f64) -> bool {
        self.from.is_none_or(|value| value == from) && self.to.is_none_or(|value| value == to)
    }
}

/// To whom an event happens.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Subject {
    /// Path of the part of a physical network; absent for a block that runs by itself.
    pub part: Option<String>,
    /// Which of several in the same part: `element 3`, `axis 2`.
    pub detail: Option<String>,
}

/// What the changes of a discrete state are called.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Changes {
    /// The first that fits counts; where none does, the change is no event.
    pub table: &'static [Change],
    /// To whom they happen.
    pub subject: Subject,
    /// Unit of the change, in SI, where how much the state changes belongs to the event: `jumps by 5 V`.
    pub unit: Option<&'static str>,
}

impl Changes {
    /// The phrase for a change of value, if it is an event.
    pub fn phrase(&self, from: f64, to: f64) -> Option<&'static str> {
        let found = self.table.iter().find(|change| change.fits(from, to))?;
        Some(found.phrase).filter(|phrase| !phrase.is_empty() && from != to)
    }

    /// All phrases, joined by `and`: `conducts and blocks`.
    pub fn summary(&self) -> String {
        let phrases = self.table.iter().map(|change| change.phrase).filter(|phrase| !phrase.is_empty());
        phrases.collect::<Vec<_>>().join(" and ")
    }
}

/// What a state that jumps is called, with the amount behind it.
pub const JUMP: &[Change] = &[Change::any("jumps")];

/// What friction that sticks is called.
pub const FRICTION: &[Change] =
    &[Change::to(0.0, "sticks"), Change::to(1.0, "slips forward"), Change::to(-1.0, "slips backward")];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_change_that_fits_counts() {
        const TABLE: &[Change] = &[Change::to(0.0, "rests"), Change::from(0.0, "leaves"), Change::any("")];
        let changes = Changes { table: TABLE, ..Changes::default() };
        assert_eq!(changes.phrase(1.0, 0.0), Some("rests"));
        assert_eq!(changes.phrase(0.0, -1.0), Some("leaves"));
        assert_eq!(changes.phrase(1.0, -1.0), None);
        assert_eq!(changes.phrase(0.0, 0.0), None, "no change");
        assert_eq!(changes.summary(), "rests and leaves");
    }
}
