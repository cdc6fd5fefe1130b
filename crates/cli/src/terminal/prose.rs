//! Markdown of the manual as text for a terminal.

use crate::terminal::formula::formulas;

/// Readable text: formulas in signs instead of commands, code indented, links by their words.
pub fn prose(markdown: &str) -> String {
    let mut text = String::new();
    for (n, part) in markdown.split("```").enumerate() {
        if n % 2 == 0 {
            // Formulas may reach over several lines, but not over an empty one.
            let paragraphs: Vec<String> = part.split("\n\n").map(|p| formulas(&links(p))).collect();
            text.push_str(&paragraphs.join("\n\n"));
        } else {
            let code = part.lines().skip(1).map(|line| format!("    {line}").trim_end().to_owned());
            text.push_str(&code.collect::<Vec<_>>().join("\n"));
        }
    }
    let lines = text.trim_end().lines().map(|line| format!("{}\n", line.trim_end()));
    lines.collect()
}

/// The first sentence of a comment, formulas included, in one line.
pub fn first_sentence(markdown: &str) -> String {
    let paragraph: Vec<&str> = markdown.trim().lines().take_while(|line| !line.trim().is_empty()).collect();
    let text = formulas(&links(&paragraph.join(" ")));
    let text = text.trim();
    // A point ends a sentence if a space follows, and not within "e.g." or behind a number of a formula.
    let mut points = text.match_indices(". ").map(|(at, _)| at);
    match points.find(|&at| !text[..at].ends_with('.')) {
        Some(end) => text[..=end].to_owned(),
        None => text.to_owned(),
    }
}

/// The text cut behind a word, with dots, where it has more than `room` signs.
pub fn shortened(text: &str, room: usize) -> String {
    if text.chars().count() <= room {
        return text.to_owned();
    }
    let start: String = text.chars().take(room.saturating_sub(3)).collect();
    let words = start.rsplit_once(' ').map_or(start.as_str(), |(words, _)| words);
    format!("{} ...", words.trim_end_matches([',', ':', ' ']))
}

/// A comment in one line.
pub fn one_line(markdown: &str) -> String {
    prose(markdown).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The text with line feeds instead of some spaces, so that no line is longer than `width` unless a word is.
pub fn wrapped(text: &str, width: usize) -> String {
    let mut out = String::with_capacity(text.len());
    let mut column = 0;
    for word in text.split_inclusive([' ', '\n']) {
        let length = word.trim_end().chars().count();
        if column > 0 && column + length > width {
            out.truncate(out.trim_end().len());
            out.push('\n');
            column = 0;
        }
        out.push_str(word);
        column = if word.ends_with('\n') { 0 } else { column + word.chars().count() };
    }
    out
}

/// Links to names, with or without an address, become the names.
fn links(line: &str) -> String {
    let mut text = String::new();
    let mut rest = line;
    while let Some(start) = rest.find("[`") {
        let Some(end) = rest[start..].find("`]").map(|end| start + end) else { break };
        text.push_str(&rest[..start]);
        text.push_str(&rest[start + 1..=end]);
        rest = &rest[end + 2..];
        if let Some(address) = rest.strip_prefix('(')
            && let Some(close) = address.find(')')
        {
            rest = &address[close + 1..];
        }
    }
    text + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_is_indented_and_links_are_words() {
        let text = "See [`Gain`] and [`Sum`](crate::Sum).\n\n```ron\nGain(k: 2)\n```\n";
        assert_eq!(prose(text), "See `Gain` and `Sum`.\n\n    Gain(k: 2)\n");
    }

    #[test]
    fn the_first_sentence_ends_at_its_point() {
        let doc = "Multiplies by a constant: $y = 1.5 u$, element\nby element. More.\n\nSecond.";
        assert_eq!(first_sentence(doc), "Multiplies by a constant: y = 1.5 u, element by element.");
        assert_eq!(first_sentence("No point"), "No point");
        assert_eq!(first_sentence("From `a` ... `b`. More."), "From `a` ... `b`.");
    }

    #[test]
    fn a_long_sentence_is_cut_behind_a_word() {
        assert_eq!(shortened("Limits, and protection", 30), "Limits, and protection");
        assert_eq!(shortened("Limits, and protection", 12), "Limits ...");
        assert!(shortened("Limits, and protection", 20).chars().count() <= 20);
    }

    #[test]
    fn long_texts_are_wrapped_at_spaces() {
        let list: Vec<String> = (0..40).map(|n| format!("`input_{n}` = {n}")).collect();
        let text = wrapped(&list.join(", "), 100);
        assert!(text.lines().all(|line| line.chars().count() <= 100) && text.lines().count() > 5, "{text}");
        assert_eq!(text.replace('\n', " "), list.join(", "));
        let long = "x".repeat(300);
        assert_eq!(wrapped(&long, 100), long);
        assert_eq!(wrapped("two\nlines", 100), "two\nlines");
    }
}
