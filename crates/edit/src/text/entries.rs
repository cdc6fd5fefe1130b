//! What stands between two brackets, entry by entry: taken out and put in with their commas, lines and comments.

use std::ops::Range;

use blocksim_syntax::{Node, Shape, TokenKind, Tokens};

use super::Splice;

/// Blanks by which an entry is indented more than its bracket.
const STEP: &str = "    ";

/// The entries of a list, of a map or of `Kind(...)`.
#[derive(Debug, Clone)]
pub(crate) struct Entries<'t> {
    text: &'t str,
    /// What is between the brackets.
    inside: Range<usize>,
    all: Vec<Entry>,
}

#[derive(Debug, Clone)]
struct Entry {
    /// With its name, without its comma.
    span: Range<usize>,
    /// The byte of its comma.
    comma: Option<usize>,
    /// Nothing but blanks is before it on its line.
    begins_line: bool,
    /// Nothing but blanks and a comment is behind it on its line.
    ends_line: bool,
}

impl Entry {
    /// The byte behind it and its comma.
    fn after(&self) -> usize {
        self.comma.map_or(self.span.end, |comma| comma + 1)
    }
}

fn is_blank(text: &str) -> bool {
    text.bytes().all(|byte| matches!(byte, b' ' | b'\t' | b'\r'))
}

fn line_start(text: &str, at: usize) -> usize {
    text[..at].rfind('\n').map_or(0, |feed| feed + 1)
}

/// The byte of the line feed, or the end of the text.
fn line_end(text: &str, at: usize) -> usize {
    text[at..].find('\n').map_or(text.len(), |feed| at + feed)
}

/// The blanks that a line begins with.
pub(crate) fn indentation(text: &str, at: usize) -> &str {
    let line = &text[line_start(text, at)..];
    &line[..line.bytes().take_while(|byte| matches!(byte, b' ' | b'\t')).count()]
}

/// How the lines of a text end.
pub(crate) fn line_feed(text: &str) -> &'static str {
    if text.contains("\r\n") { "\r\n" } else { "\n" }
}

/// Whether what is left of a line is blanks and a comment that ends with it.
fn is_rest(text: &str, from: usize) -> bool {
    let rest = &text[from..line_end(text, from)];
    if is_blank(rest) {
        return true;
    }
    // A comment of several lines belongs to none of them.
    let mut tokens = Tokens::new(&text[from..]).take_while(|token| token.start() < rest.len());
    tokens.all(|token| token.kind.is_comment() && token.end() <= rest.len())
}

impl<'t> Entries<'t> {
    /// The entries of a value of a text; `None` where it has no brackets.
    pub(crate) fn of(text: &'t str, node: &Node) -> Option<Entries<'t>> {
        let spans: Vec<Range<usize>> = match &node.value {
            Shape::List(items) | Shape::Tuple(_, items) => {
                items.iter().map(|item| item.span.clone()).collect()
            }
            Shape::Map(members) | Shape::Struct(_, members) => {
                members.iter().map(|(name, value)| name.span.start..value.span.end).collect()
            }
            _ => return None,
        };
        let written = text.get(node.span.clone())?;
        let open = Tokens::new(written).find(|token| token.kind == TokenKind::Open)?;
        let inside = node.span.start + open.end()..node.span.end - 1;
        let ends: Vec<usize> = spans.iter().skip(1).map(|span| span.start).chain([inside.end]).collect();
        let entry = |(span, next): (Range<usize>, &usize)| {
            let between = &text[span.end..*next];
            let comma = Tokens::new(between).find(|token| token.kind == TokenKind::Comma);
            let mut entry = Entry {
                comma: comma.map(|token| span.end + token.start()),
                begins_line: is_blank(&text[line_start(text, span.start)..span.start]),
                ends_line: false,
                span,
            };
            entry.ends_line = is_rest(text, entry.after());
            entry
        };
        let all = spans.into_iter().zip(&ends).map(entry).collect();
        Some(Entries { text, inside, all })
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.all.len()
    }

    /// An entry with the comment that ends its line, and whether it has its lines for itself.
    pub(crate) fn written(&self, at: usize) -> (&'t str, Option<&'t str>, bool) {
        let entry = &self.all[at];
        let note = self.text[entry.after()..line_end(self.text, entry.after())].trim();
        let is_alone = entry.begins_line && entry.ends_line;
        (&self.text[entry.span.clone()], (is_alone && !note.is_empty()).then_some(note), is_alone)
    }

    /// Its bytes with its name, without its comma.
    pub(crate) fn span(&self, at: usize) -> Range<usize> {
        self.all[at].span.clone()
    }

    /// The comment that ends the line that an entry has for itself, with the blanks before it.
    pub(crate) fn note(&self, at: usize) -> Option<Range<usize>> {
        self.written(at).1?;
        let after = self.all[at].after();
        Some(after..after + self.text[after..line_end(self.text, after)].trim_end().len())
    }

    /// The entries that the comment above one is about: up to the next blank line or comment on a line of its own.
    pub(crate) fn group(&self, at: usize) -> Range<usize> {
        let is_apart = |next: &usize| {
            let between = &self.text[self.all[next - 1].after()..self.all[*next].span.start];
            let lines: Vec<&str> = between.split('\n').collect();
            // The first is the rest of the line before, the last the beginning of that of the entry.
            lines.len() > 2
        };
        let end = (at + 1..self.len()).find(is_apart).unwrap_or(self.len());
        at..end
    }

    /// The lines of comments right above an entry, without a blank line or another entry between; without line feeds.
    pub(crate) fn comments_above(&self, at: usize) -> Range<usize> {
        let entry = &self.all[at];
        let from = at.checked_sub(1).map_or(self.inside.start, |before| self.all[before].after());
        let end = line_start(self.text, entry.span.start);
        let mut start = end;
        if !entry.begins_line {
            return end..end;
        }
        while start > from {
            let line = line_start(self.text, start - 1);
            let is_comment = line >= from && {
                let written = self.text[line..start].trim();
                written.starts_with("//") || written.starts_with("/*") && written.ends_with("*/")
            };
            if !is_comment {
                break;
            }
            start = line;
        }
        start..end
    }

    /// Takes entries out and puts others in, each behind one that stays.
    pub(crate) fn changed(
        &self,
        is_gone: impl Fn(usize) -> bool,
        new: &[(usize, Vec<String>)],
    ) -> Vec<Splice> {
        let is_followed = |at: usize| new.iter().any(|(behind, new)| *behind == at && !new.is_empty());
        let mut splices = self.without_unless(is_gone, is_followed);
        new.iter().for_each(|(behind, new)| splices.extend(self.with(Some(*behind), new)));
        splices
    }

    /// Takes entries out. A comment that ends the line of one goes with it, all others stay.
    pub(crate) fn without(&self, is_gone: impl Fn(usize) -> bool) -> Vec<Splice> {
        self.without_unless(is_gone, |_| false)
    }

    /// Takes entries out; those that are followed by others keep their commas.
    fn without_unless(
        &self,
        is_gone: impl Fn(usize) -> bool,
        is_followed: impl Fn(usize) -> bool,
    ) -> Vec<Splice> {
        let gone: Vec<bool> = (0..self.len()).map(is_gone).collect();
        if !gone.contains(&true) {
            return Vec::new();
        }
        let mut splices: Vec<Splice> = Vec::new();
        let mut at = 0;
        while at < self.len() {
            if !gone[at] {
                at += 1;
                continue;
            }
            // Those that stand on one line go together.
            let first = at;
            while at + 1 < self.len() && gone[at + 1] && self.share_line(at) {
                at += 1;
            }
            let mut splice = self.without_run(first, at, &gone);
            // What is before it may be gone with a line already.
            let end = splices.last().map_or(0, |last| last.span.end);
            splice.span.start = splice.span.start.max(end).min(splice.span.end);
            splices.push(splice);
            at += 1;
        }
        // A list without a comma behind its last entry stays one.
        let last_kept = gone.iter().rposition(|gone| !gone);
        if let (Some(kept), None) = (last_kept, self.all[self.len() - 1].comma)
            && let Some(comma) = self.all[kept].comma
            && kept + 1 < self.len()
            && !is_followed(kept)
            && !splices.iter().any(|splice| splice.span.contains(&comma))
        {
            splices.push(Splice::new(comma..comma + 1, ""));
        }
        splices.sort_by_key(|splice| splice.span.start);
        if last_kept.is_none() {
            let left: String = self.left(&splices);
            if left.trim().is_empty() {
                return vec![Splice::new(self.inside.clone(), "")];
            }
        }
        splices
    }

    /// What stays between the brackets.
    fn left(&self, splices: &[Splice]) -> String {
        let (mut left, mut at) = (String::new(), self.inside.start);
        for splice in splices {
            left.push_str(self.text.get(at..splice.span.start).unwrap_or_default());
            at = splice.span.end;
        }
        left + self.text.get(at..self.inside.end).unwrap_or_default()
    }

    /// Whether the next entry begins on the line on which this one ends.
    fn share_line(&self, at: usize) -> bool {
        !self.text[self.all[at].after()..self.all[at + 1].span.start].contains('\n')
    }

    /// Takes entries out that stand on lines of their own, or side by side on one.
    fn without_run(&self, first: usize, last: usize, gone: &[bool]) -> Splice {
        let (from, to) = (&self.all[first], &self.all[last]);
        let text = self.text;
        if from.begins_line && to.ends_line {
            let mut start = line_start(text, from.span.start);
            let end = (line_end(text, to.after()) + 1).min(self.inside.end);
            // Of two blank lines that would meet one goes.
            let above = line_start(text, start.saturating_sub(1));
            let is_apart = above >= self.inside.start
                && above < start
                && is_blank(text[above..start].trim_end_matches('\n'));
            let below = &text[end..line_end(text, end)];
            if is_apart && (is_blank(below) || below.trim_start().starts_with([')', ']', '}'])) {
                start = above;
            }
            return Splice::new(start..end, "");
        }
        if last + 1 < self.len() && self.share_line(last) {
            let between = &text[to.after()..self.all[last + 1].span.start];
            let end = if is_blank(between) { self.all[last + 1].span.start } else { to.after() };
            return Splice::new(from.span.start..end, "");
        }
        // Nothing of the list is behind it on its line: the blanks before it go too, and its comma or, without one, that of the
        // entry before.
        let before = &text[..from.span.start];
        let start = before.trim_end_matches([' ', '\t', '\r', '\n']).len();
        let end_of_last = first.checked_sub(1).map_or(self.inside.start, |before| self.all[before].after());
        let is_within_comment = start != end_of_last;
        let start = match first.checked_sub(1).map(|before| &self.all[before]) {
            _ if is_within_comment => from.span.start,
            Some(Entry { comma: Some(comma), .. }) if to.comma.is_none() && !gone[first - 1] => *comma,
            _ => start,
        };
        Splice::new(start..to.after(), "")
    }

    /// Puts entries in behind one, or before the first.
    pub(crate) fn with(&self, behind: Option<usize>, new: &[String]) -> Vec<Splice> {
        if new.is_empty() {
            return Vec::new();
        }
        let feed = line_feed(self.text);
        let Some(anchor) = behind.map(|at| &self.all[at]) else { return self.with_first(new, feed) };
        let is_last = behind == Some(self.len() - 1);
        let indent = indentation(self.text, anchor.span.start);
        // The anchor is the last of its line, which begins with an entry of the list: a new one has a line as well.
        if anchor.ends_line && self.begins_line(behind) {
            let end = line_end(self.text, anchor.after());
            let end = end - usize::from(self.text[..end].ends_with('\r'));
            let mut lines: String = new.iter().map(|entry| format!("{feed}{indent}{entry},")).collect();
            if anchor.comma.is_some() {
                return vec![Splice::new(end..end, lines)];
            }
            if is_last {
                lines.pop();
            }
            let comma = Splice::new(anchor.span.end..anchor.span.end, ",");
            if end == anchor.span.end {
                return vec![Splice::new(end..end, format!(",{lines}"))];
            }
            return vec![comma, Splice::new(end..end, lines)];
        }
        let entries: String = new.iter().map(|entry| format!(", {entry}")).collect();
        vec![Splice::new(anchor.span.end..anchor.span.end, entries)]
    }

    /// Whether the line of an entry begins with an entry of these brackets.
    fn begins_line(&self, at: Option<usize>) -> bool {
        let Some(mut at) = at else { return false };
        while at > 0 && !self.all[at].begins_line && self.share_line(at - 1) {
            at -= 1;
        }
        self.all[at].begins_line
    }

    fn with_first(&self, new: &[String], feed: &str) -> Vec<Splice> {
        let Range { start, end } = self.inside;
        if let Some(first) = self.all.first() {
            let at = first.span.start;
            if first.begins_line {
                let indent = indentation(self.text, at);
                let lines: String = new.iter().map(|entry| format!("{entry},{feed}{indent}")).collect();
                return vec![Splice::new(at..at, lines)];
            }
            let entries: String = new.iter().map(|entry| format!("{entry}, ")).collect();
            return vec![Splice::new(at..at, entries)];
        }
        let around = indentation(self.text, start);
        let lines: String = new.iter().map(|entry| format!("{around}{STEP}{entry},{feed}")).collect();
        if !is_blank(&self.text[start..end]) && self.text[start..end].contains('\n') {
            // Comments stand there, or lines: before the line of the bracket.
            let line = line_start(self.text, end);
            return match is_blank(&self.text[line..end]) {
                true => vec![Splice::new(line..line, lines)],
                false => vec![Splice::new(end..end, format!("{feed}{lines}{around}"))],
            };
        }
        let left = if is_blank(&self.text[start..end]) { start..end } else { end..end };
        vec![Splice::new(left, format!("{feed}{lines}{around}"))]
    }
}

#[cfg(test)]
mod tests {
    use super::super::spliced;
    use super::*;
    use blocksim_syntax::read;

    fn member<'n>(root: &'n Node, name: &str) -> &'n Node {
        &root.members().expect("members").iter().find(|(known, _)| known.text == name).expect("a member").1
    }

    /// `a` of a text without some entries.
    fn without(text: &str, gone: &[usize]) -> String {
        let root = read(text).expect("RON");
        let entries = Entries::of(text, member(&root, "a")).expect("brackets");
        let new = spliced(text, entries.without(|at| gone.contains(&at))).expect("no overlap");
        assert!(read(&new).is_ok(), "{new}");
        new
    }

    fn with(text: &str, behind: Option<usize>, new: &[&str]) -> String {
        let root = read(text).expect("RON");
        let entries = Entries::of(text, member(&root, "a")).expect("brackets");
        let new: Vec<String> = new.iter().map(|entry| (*entry).to_owned()).collect();
        let new = spliced(text, entries.with(behind, &new)).expect("no overlap");
        assert!(read(&new).is_ok(), "{new}");
        new
    }

    const LINES: &str =
        "(\n    a: [\n        1, // one\n        // of two\n        2,\n        3, 4,\n    ],\n)\n";

    #[test]
    fn entries_go_with_their_lines_and_the_comment_on_them() {
        assert_eq!(without(LINES, &[0]), LINES.replace("        1, // one\n", ""));
        assert_eq!(without(LINES, &[1]), LINES.replace("        2,\n", ""), "the comment above stays");
        assert_eq!(without(LINES, &[2]), LINES.replace("3, 4", "4"));
        assert_eq!(without(LINES, &[3]), LINES.replace("3, 4", "3"));
        assert_eq!(without(LINES, &[2, 3]), LINES.replace("        3, 4,\n", ""));
        assert_eq!(without(LINES, &[]), LINES);
        assert_eq!(without(LINES, &[0, 1, 2, 3]), "(\n    a: [\n        // of two\n    ],\n)\n");
        assert_eq!(without("(a: [\n  1,\n  2,\n])", &[0, 1]), "(a: [])");
    }

    #[test]
    fn a_list_on_one_line_keeps_its_commas() {
        assert_eq!(without("(a: [1, 2, 3])", &[0]), "(a: [2, 3])");
        assert_eq!(without("(a: [1, 2, 3])", &[1]), "(a: [1, 3])");
        assert_eq!(without("(a: [1, 2, 3])", &[2]), "(a: [1, 2])");
        assert_eq!(without("(a: [1, 2, 3])", &[1, 2]), "(a: [1])");
        assert_eq!(without("(a: [1, 2, 3,])", &[1, 2]), "(a: [1,])");
        assert_eq!(without("(a: [1, 2, 3])", &[0, 2]), "(a: [2])");
        assert_eq!(without("(a: [1, 2, 3])", &[0, 1, 2]), "(a: [])");
        assert_eq!(without("(a: [1, 2 /* two */, 3])", &[1]), "(a: [1, 3])");
        assert_eq!(without("(a: [1, /* two */ 2])", &[1]), "(a: [1 /* two */ ])");
        assert_eq!(without("(a: {\"x\": B(k: [1, 2]), \"y\": C})", &[0]), "(a: {\"y\": C})");
    }

    #[test]
    fn lists_that_are_laid_out_otherwise_stay_lists() {
        assert_eq!(without("(a: [1,\n  2,\n  3])", &[2]), "(a: [1,\n  2])");
        assert_eq!(without("(a: [1,\n  2,\n  3])", &[0]), "(a: [\n  2,\n  3])");
        assert_eq!(without("(a: [\n  1,\n  2\n])", &[1]), "(a: [\n  1\n])");
        assert_eq!(without("(a: [\n  1, // one\n  2\n])", &[1]), "(a: [\n  1 // one\n])");
        assert_eq!(without("(a: [ // first\n  1])", &[0]), "(a: [ // first\n  ])");
        assert_eq!(without("(a: [\n  1,\n\n  2,\n\n  3,\n])", &[1]), "(a: [\n  1,\n\n  3,\n])");
        assert_eq!(without("(a: [\n  1,\n\n  2,\n])", &[1]), "(a: [\n  1,\n])");
        assert_eq!(without("(a: [\r\n  1,\r\n  2,\r\n])", &[0]), "(a: [\r\n  2,\r\n])");
    }

    #[test]
    fn a_new_entry_stands_as_those_around_it() {
        assert_eq!(with(LINES, Some(0), &["9"]), LINES.replace("// one\n", "// one\n        9,\n"));
        assert_eq!(with(LINES, Some(1), &["8", "9"]), LINES.replace("2,\n", "2,\n        8,\n        9,\n"));
        assert_eq!(with(LINES, Some(2), &["9"]), LINES.replace("3, ", "3, 9, "));
        assert_eq!(with(LINES, Some(3), &["9"]), LINES.replace("4,\n", "4,\n        9,\n"));
        assert_eq!(with(LINES, None, &["9"]), LINES.replace("1, //", "9,\n        1, //"));
        assert_eq!(with("(a: [1])", Some(0), &["9"]), "(a: [1, 9])");
        assert_eq!(with("(a: [1, ])", Some(0), &["9"]), "(a: [1, 9, ])");
        assert_eq!(with("(a: [1])", None, &["8", "9"]), "(a: [8, 9, 1])");
        assert_eq!(with("(a: [\n  1\n])", Some(0), &["9"]), "(a: [\n  1,\n  9\n])");
        assert_eq!(with("(a: [\n  1 // one\n])", Some(0), &["9"]), "(a: [\n  1, // one\n  9\n])");
        assert_eq!(with("(a: [\r\n  1,\r\n])", Some(0), &["9"]), "(a: [\r\n  1,\r\n  9,\r\n])");
    }

    #[test]
    fn what_is_put_into_empty_brackets_gets_a_line() {
        assert_eq!(with("(\n    a: [],\n)", None, &["9"]), "(\n    a: [\n        9,\n    ],\n)");
        assert_eq!(
            with("(\n    a: { },\n)", None, &["\"b\": C"]),
            "(\n    a: {\n        \"b\": C,\n    },\n)"
        );
        assert_eq!(with("(\n    a: [\n    ],\n)", None, &["9"]), "(\n    a: [\n        9,\n    ],\n)");
        let noted = "(\n    a: [\n        // nothing yet\n    ],\n)";
        assert_eq!(with(noted, None, &["9"]), noted.replace("yet\n", "yet\n        9,\n"));
        assert_eq!(with("(a: [/* none */])", None, &["9"]), "(a: [/* none */\n    9,\n])");
    }

    #[test]
    fn comments_above_belong_to_what_follows_without_a_gap() {
        let text =
            "(\n  a: [\n    1,\n    // far\n\n    // near\n    // by\n    2, // behind\n    3,\n  ],\n)";
        let root = read(text).unwrap();
        let entries = Entries::of(text, member(&root, "a")).unwrap();
        assert_eq!(&text[entries.comments_above(1)], "    // near\n    // by\n");
        assert_eq!(&text[entries.comments_above(2)], "");
        assert_eq!(&text[entries.comments_above(0)], "");
        assert_eq!(entries.written(1), ("2", Some("// behind"), true));
    }

    #[test]
    fn any_entries_can_be_taken_out_of_any_layout_and_put_back() {
        let mut state = 1_u64;
        let mut below = |n: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % n
        };
        for _ in 0..4000 {
            let count = below(6) as usize;
            let mut list = "[".to_owned();
            for entry in 0..count {
                list.push_str(
                    ["", " ", "\n  ", "\n\n  ", " // c\n", "\n // c\n", "/* c */"][below(7) as usize],
                );
                list.push_str(&format!("{entry}"));
                list.push_str(["", " ", "\n", " // c\n", " /* c */"][below(5) as usize]);
                if entry + 1 < count || below(2) == 0 {
                    list.push(',');
                }
            }
            list.push_str(["", "\n", " // c\n", " /* c */ "][below(4) as usize]);
            let text = format!("(\n  a: {list}],\n)");
            let Ok(root) = read(&text) else { panic!("{text}") };
            let entries = Entries::of(&text, member(&root, "a")).unwrap();
            let gone: Vec<bool> = (0..count).map(|_| below(2) == 0).collect();
            let new =
                spliced(&text, entries.without(|at| gone[at])).unwrap_or_else(|| panic!("{text:?} {gone:?}"));
            let numbers = |text: &str| -> Vec<f64> {
                let root = read(text).unwrap_or_else(|error| panic!("{text:?}: {error:?}"));
                let Shape::List(items) = &member(&root, "a").value else { panic!("{text}") };
                items
                    .iter()
                    .map(|item| if let Shape::Number(x) = item.value { x } else { panic!() })
                    .collect()
            };
            let expected: Vec<f64> = (0..count).filter(|at| !gone[*at]).map(|at| at as f64).collect();
            assert_eq!(numbers(&new), expected, "{text:?} {gone:?} {new:?}");
            let behind = (count > 0).then(|| below(count as u64) as usize);
            let with = spliced(&text, entries.with(behind, &["77".to_owned()])).unwrap();
            let mut expected: Vec<f64> = (0..count).map(|at| at as f64).collect();
            expected.insert(behind.map_or(0, |at| at + 1), 77.0);
            assert_eq!(numbers(&with), expected, "{text:?} {behind:?} {with:?}");
            let count_comments = |text: &str| text.matches('c').count();
            assert_eq!(count_comments(&with), count_comments(&text), "{text:?} {with:?}");
        }
    }
}
