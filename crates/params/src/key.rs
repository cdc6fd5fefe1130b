//! Keys of rows and headings of columns, and the path of a quantity that both name.

use std::collections::BTreeSet;

/// Most columns for members of the same kind.
const MOST_NUMBERED: usize = 64;

/// Longest list with a column for each item; those of longer ones have rows.
pub(crate) const ITEMS: [&str; 3] = ["Value / x", "y", "z"];

/// A column of values.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Column {
    /// An item of a list, from 0; a number on its own stands in the first.
    Item(usize),
    /// A member such as `axis3` by word and number.
    Numbered(String, usize),
}

impl Column {
    /// The heading, which names the column when the workbook is read.
    #[cfg(feature = "xlsx")]
    pub(crate) fn heading(&self, only_values: bool) -> String {
        match self {
            Column::Item(0) if only_values => "Value".to_owned(),
            Column::Item(n) => ITEMS.get(*n).map_or_else(|| format!("[{n}]"), |item| (*item).to_owned()),
            Column::Numbered(word, n) => format!("{} {n}", capital(word)),
        }
    }

    /// As a note names it.
    #[cfg(feature = "xlsx")]
    pub(crate) fn number(&self) -> usize {
        match self {
            Column::Item(n) => n + 1,
            Column::Numbered(_, n) => *n,
        }
    }

    fn read(heading: &str) -> Option<Column> {
        if let Some(item) = ITEMS.iter().position(|item| *item == heading) {
            return Some(Column::Item(item));
        }
        if heading == "Value" {
            return Some(Column::Item(0));
        }
        let (word, number) = heading.rsplit_once(' ')?;
        let number = number.parse().ok()?;
        is_word(word.trim()).then(|| Column::Numbered(word.trim().to_lowercase(), number))
    }
}

/// With its first letter as a capital.
#[cfg(feature = "xlsx")]
pub(crate) fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters
        .next()
        .filter(char::is_ascii)
        .map_or(word.to_owned(), |first| first.to_ascii_uppercase().to_string() + letters.as_str())
}

fn is_word(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_alphabetic() || c == '_')
}

/// Takes `axis3.limits.lower` apart.
pub(crate) fn numbered(path: &str) -> Option<(&str, usize, &str)> {
    let (head, rest) = path.split_once('.')?;
    let digits = head.len() - head.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    let (word, number) = head.split_at(head.len() - digits);
    let canonical = is_word(word) && !number.starts_with('0');
    Some((word, number.parse().ok().filter(|n| canonical && (1..=MOST_NUMBERED).contains(n))?, rest))
}

/// The words of keys such as `axis*.gear.inertia` or `axis3.gear.inertia`, in small letters: their columns have numbers.
pub(crate) fn words<'a>(keys: impl Iterator<Item = &'a str>) -> BTreeSet<String> {
    let word = |key: &'a str| {
        let starred = key.split_once("*.").map(|(word, _)| word).filter(|word| is_word(word));
        Some(starred.or_else(|| Some(numbered(key)?.0))?.to_lowercase())
    };
    keys.filter_map(word).collect()
}

/// The path of a cell: the reverse of `rows.rs`, from the texts of a sheet alone. `None` where the row has no such
/// column.
pub(crate) fn path_of(key: &str, heading: &str) -> Option<String> {
    match Column::read(heading.trim())? {
        Column::Numbered(word, n) => {
            if let Some((known, rest)) = key.split_once("*.") {
                return (known.to_lowercase() == word).then(|| format!("{known}{n}.{rest}"));
            }
            let (known, number, _) = numbered(key)?;
            (known.to_lowercase() == word && number == n).then(|| key.to_owned())
        }
        Column::Item(_) if key.contains("*.") => None,
        Column::Item(item) => match key.strip_suffix("[*]") {
            Some(list) => Some(format!("{list}[{item}]")),
            None => (item == 0).then(|| key.to_owned()),
        },
    }
}

/// Whether a heading is that of a column of values in a sheet whose keys have these words.
pub(crate) fn is_value_heading(heading: &str, words: &BTreeSet<String>) -> bool {
    match Column::read(heading.trim()) {
        Some(Column::Numbered(word, _)) => words.contains(&word),
        Some(Column::Item(_)) => true,
        None => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_and_a_heading_name_a_path() {
        for (key, heading, path) in [
            ("axis*.limits.lower", "Axis 3", Some("axis3.limits.lower")),
            ("axis3.limits.lower", "Axis 3", Some("axis3.limits.lower")),
            ("axis3.limits.lower", "Axis 2", None),
            ("axis*.limits.lower", "Value", None),
            ("axis*.limits.lower", "Link 3", None),
            ("tool.tcp[*]", "y", Some("tool.tcp[1]")),
            ("link1.mass", "Value", Some("link1.mass")),
            ("pid.kp", "Value / x", Some("pid.kp")),
            ("pid.kp", "z", None),
            ("pid.kp", "Remark", None),
        ] {
            assert_eq!(path_of(key, heading).as_deref(), path, "{key} under {heading}");
        }
    }

    #[test]
    fn numbers_of_members_are_written_in_one_way_only() {
        assert_eq!(numbered("axis12.a.b"), Some(("axis", 12, "a.b")));
        for path in ["axis01.a", "axis.a", "axis0.a", "axis65.a", "12.a", "axis3", "a/b1.c"] {
            assert_eq!(numbered(path), None, "{path}");
        }
    }

    #[test]
    fn columns_of_people_are_no_values() {
        let known = words(["axis*.a", "pid.kp"].into_iter());
        assert!(is_value_heading("Axis 2", &known) && is_value_heading("Value", &known));
        assert!(!is_value_heading("Remark 2", &known) && !is_value_heading("Note", &known));
    }
}
