//! What stands in the text of a model: lines of places, texts in short, values that were set instead.

use blocksim_block::problem::Place;
use blocksim_diagram::{Model, Sources};

/// What was set for a parameter, if anything was.
pub fn set_for<'a>(overrides: &'a [String], path: &str) -> Option<&'a str> {
    // The last one counts.
    overrides
        .iter()
        .rev()
        .find_map(|text| text.split_once('=').filter(|(name, _)| *name == path))
        .map(|(_, value)| value)
}

/// File and line of a place.
pub fn line(sources: &Sources, place: &Place) -> String {
    let file = sources.file(place.file);
    let before = file.text.get(..place.span.start).unwrap_or_default();
    format!("{}:{}", file.path.display(), 1 + before.matches('\n').count())
}

/// The text of a place in one line.
pub fn written(sources: &Sources, model: &Model, span: &std::ops::Range<usize>, longest: usize) -> String {
    one_line(sources.file(model.ast.file).text.get(span.clone()).unwrap_or_default(), longest)
}

/// A text in one line, without the quotes around it.
pub fn one_line(text: &str, longest: usize) -> String {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let text = match text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) {
        Some(inner) if !inner.contains('"') => inner.to_owned(),
        _ => text,
    };
    if text.chars().count() <= longest {
        return text;
    }
    text.chars().take(longest - 1).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_short_and_without_quotes() {
        assert_eq!(one_line("\"2 *\n   kp\"", 20), "2 * kp");
        assert_eq!(one_line("[\"a\", \"b\"]", 20), "[\"a\", \"b\"]");
        assert_eq!(one_line("123456", 4), "123…");
    }

    #[test]
    fn the_last_value_that_was_set_counts() {
        let set = ["a.k=1".to_owned(), "a.k=2 m".to_owned(), "b=x=y".to_owned()];
        assert_eq!(set_for(&set, "a.k"), Some("2 m"));
        assert_eq!(set_for(&set, "b"), Some("x=y"));
        assert_eq!(set_for(&set, "a"), None);
    }
}
