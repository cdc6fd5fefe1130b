//! Finding by words: commands, options, pages and blocks by what they are about, whoever's term for it is used.

mod synonyms;

use std::collections::BTreeSet;

use self::synonyms::{SYNONYMS, elsewhere};

/// Share of the best score below which a result is noise.
const NOISE: u32 = 5;

/// What is looked for.
pub struct Query {
    words: Vec<Word>,
}

/// A word, what means the same, and the names of blocks that other programs give it.
struct Word {
    stem: String,
    same: BTreeSet<String>,
}

/// A text in which words are looked for, and how much it counts.
pub type Field<'a> = (&'a str, u32);

impl Query {
    /// The words of a text; short words of the language do not count unless there are no others.
    pub fn new(text: &str) -> Query {
        let all = tokens(text);
        let counting: Vec<&String> = all.iter().filter(|word| !STOP_WORDS.contains(&word.as_str())).collect();
        let chosen = if counting.is_empty() { all.iter().collect() } else { counting };
        Query { words: chosen.into_iter().map(|word| Word::new(word)).collect() }
    }

    /// How well texts fit: 0 unless every word is in one of them.
    pub fn score(&self, fields: &[Field]) -> u32 {
        let fields: Vec<(Vec<String>, u32)> =
            fields.iter().map(|(text, weight)| (tokens(text), *weight)).collect();
        let mut sum = 0;
        for word in &self.words {
            match fields.iter().map(|(tokens, weight)| word.best(tokens) * weight).max() {
                None | Some(0) => return 0,
                Some(score) => sum += score,
            }
        }
        sum
    }

    /// The results that fit, best first; equals keep their order.
    pub fn ranked<T>(&self, all: impl IntoIterator<Item = T>, score: impl Fn(&T) -> u32) -> Vec<T> {
        let mut scored: Vec<(u32, T)> =
            all.into_iter().map(|item| (score(&item), item)).filter(|(score, _)| *score > 0).collect();
        scored.sort_by_key(|(score, _)| std::cmp::Reverse(*score));
        let best = scored.first().map_or(0, |(score, _)| *score);
        scored.into_iter().take_while(|(score, _)| score * NOISE >= best).map(|(_, item)| item).collect()
    }
}

/// Kinds of block that Simulink, Simscape or Modelica call so.
pub fn kinds_elsewhere(name: &str) -> &'static [&'static str] {
    elsewhere(&tokens(name).concat())
}

/// Words that say nothing about what is looked for.
const STOP_WORDS: [&str; 22] = [
    "a", "an", "and", "as", "at", "by", "do", "for", "from", "how", "i", "in", "is", "it", "my", "of", "on",
    "or", "the", "to", "what", "with",
];

impl Word {
    fn new(word: &str) -> Word {
        let stem = stem(word);
        let groups = SYNONYMS.iter().filter(|group| group.iter().any(|other| self::stem(other) == stem));
        let same = groups.flat_map(|group| group.iter().map(|other| self::stem(other)));
        let same = same.filter(|other| *other != stem).collect();
        Word { stem, same }
    }

    /// 4 for the word itself, 3 for a word that begins with it, 2 for one that means the same, else 0.
    fn best(&self, tokens: &[String]) -> u32 {
        let of = |token: &String| {
            let token = stem(token);
            if token == self.stem {
                4
            } else if self.stem.len() >= 3 && token.starts_with(&self.stem) {
                3
            } else if self.same.contains(&token) {
                2
            } else {
                0
            }
        };
        tokens.iter().map(of).max().unwrap_or(0)
    }
}

/// Words in small letters: what stands between other signs, and the parts of `CamelCase`.
fn tokens(text: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for sign in text.chars() {
        let begins = sign.is_uppercase() && before.is_lowercase();
        if !sign.is_alphanumeric() || begins {
            words.push(String::new());
        }
        if sign.is_alphanumeric() {
            words.last_mut().expect("one word at least").extend(sign.to_lowercase());
        }
        before = sign;
    }
    words.retain(|word| !word.is_empty());
    words
}

/// A word without the endings of its forms: `springs` and `spring`, `damping` and `damp`.
fn stem(word: &str) -> String {
    let cut = ["ing", "ies", "es", "ed", "s"].iter().find_map(|ending| {
        let start = word.strip_suffix(ending)?;
        (start.len() >= 4 && !start.ends_with('s')).then_some((start, *ending))
    });
    match cut {
        Some((start, "ies")) => format!("{start}y"),
        Some((start, _)) => start.trim_end_matches('e').to_owned(),
        None => word.strip_suffix('e').filter(|start| start.len() >= 4).unwrap_or(word).to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_split_and_cut_to_their_stems() {
        assert_eq!(tokens("RotationalSpring, --until <TIME>"), ["rotational", "spring", "until", "time"]);
        for [one, other] in [
            ["springs", "spring"],
            ["switches", "switch"],
            ["limited", "limit"],
            ["energies", "energy"],
            ["noise", "noises"],
        ] {
            assert_eq!(stem(one), stem(other));
        }
        assert_eq!(stem("loss"), "loss");
        assert_eq!(stem("bus"), "bus");
    }

    #[test]
    fn all_words_must_be_found_and_names_count_more_than_texts() {
        let query = Query::new("a torsion spring");
        let spring = query.score(&[("RotationalSpring", 8), ("Torsion spring between two parts.", 4)]);
        let shaft = query.score(&[("Shaft", 8), ("A torsion spring and a damper.", 4)]);
        assert!(spring > shaft && shaft > 0, "{spring} {shaft}");
        assert_eq!(query.score(&[("TranslationalSpring", 8), ("Spring between two parts.", 4)]), 0);
    }

    #[test]
    fn what_means_the_same_is_found_behind_the_word_itself() {
        let query = Query::new("coil");
        let (coil, inductor) = (query.score(&[("Coil", 1)]), query.score(&[("Inductor", 1)]));
        assert!(coil > inductor && inductor > 0);
        assert_eq!(query.score(&[("Capacitor", 1)]), 0);
    }

    #[test]
    fn names_of_other_programs_lead_to_ours() {
        assert_eq!(kinds_elsewhere("Transfer Fcn"), ["TransferFunction"]);
        assert_eq!(kinds_elsewhere("to workspace"), ["Scope"]);
        assert!(kinds_elsewhere("Scope").is_empty());
    }
}
