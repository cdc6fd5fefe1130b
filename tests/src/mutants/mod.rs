//! Files with mistakes: a valid one and a seed give a mutant, the same in every run.
//!
//! Texts are changed as people and broken programs change them (signs, tokens, numbers, brackets, units, names, lines), other
//! files as disks and networks do (bits, pieces, lengths); workbooks also inside of their parts.

mod binary;
mod parts;
mod runner;
mod samples;
mod subjects;
mod text;

pub use runner::{Answer, Desk};
pub use subjects::{PREPARATION, SLOW, Subject, subjects};

/// Numbers that look random (splitmix64).
#[derive(Debug, Clone)]
pub struct Dice(u64);

impl Dice {
    /// The numbers of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5851_F42D_4C95_7F2D)
    }

    /// The next number.
    pub fn roll(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number below `n`; 0 where `n` is 0.
    pub fn below(&mut self, n: usize) -> usize {
        (self.roll() % n.max(1) as u64) as usize
    }

    /// One of several.
    ///
    /// # Panics
    /// Panics if there is none.
    pub fn one<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }
}

/// What a file is, as far as mistakes go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Text: diagrams, tables, JSON, XML.
    Text,
    /// Anything else: recordings, workbooks, libraries.
    Binary,
    /// Texts in an archive: the parts of a workbook.
    Parts,
}

/// A mutant of a file: one to four changes.
pub fn mutant(valid: &[u8], form: Form, seed: u64) -> Vec<u8> {
    let mut dice = Dice::new(seed);
    let mut bytes = valid.to_vec();
    for _ in 0..1 + dice.below(4) {
        match form {
            Form::Text => text::change(&mut bytes, &mut dice),
            Form::Binary => binary::change(&mut bytes, &mut dice),
            Form::Parts => parts::change(&mut bytes, &mut dice),
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_gives_the_same_mutant_and_most_seeds_give_another_file() {
        let valid = b"Diagram(blocks: { \"a\": Gain(k: \"2 V\"), },\n connections: [\"a.y -> b.u\"])\n";
        for form in [Form::Text, Form::Binary] {
            let all: Vec<Vec<u8>> = (0..500).map(|seed| mutant(valid, form, seed)).collect();
            assert_eq!(all[7], mutant(valid, form, 7));
            let distinct: std::collections::BTreeSet<&Vec<u8>> = all.iter().collect();
            assert!(distinct.len() > 400, "{}", distinct.len());
            assert!(all.iter().filter(|mutant| mutant.as_slice() == valid).count() < 25);
        }
    }

    #[test]
    fn most_mutants_of_a_workbook_are_archives_with_another_text() {
        let parts = ["[Content_Types].xml", "xl/workbook.xml", "xl/worksheets/sheet1.xml"].map(|name| {
            (name.to_owned(), "<sheet r=\"A1\" s=\"2\"><c t=\"s\"><v>1</v></c></sheet>".to_owned())
        });
        let valid = blocksim_params::pack(&parts).expect("an archive");
        let all: Vec<Vec<u8>> = (0..300).map(|seed| mutant(&valid, Form::Parts, seed)).collect();
        assert_eq!(all[7], mutant(&valid, Form::Parts, 7));
        let changed = all.iter().filter(|bytes| blocksim_params::unpack(bytes).is_ok_and(|now| now != parts));
        let count = changed.count();
        assert!(count > 200, "{count}");
    }

    #[test]
    fn nothing_becomes_something_without_a_panic() {
        for seed in 0..200 {
            mutant(b"", Form::Text, seed);
            mutant(b"", Form::Binary, seed);
            mutant(b"", Form::Parts, seed);
            mutant(&[0xFF, 0xFE, b'"', 0xC3], Form::Text, seed);
        }
    }
}
