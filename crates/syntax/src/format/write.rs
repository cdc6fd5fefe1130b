//! Pieces become text.

use super::WIDTH;
use super::layout::{Form, columns, form, spans_lines, width_of_head, width_of_line};
use super::pieces::{Comment, File, Group, Item, Value};

/// Blanks for each level of brackets.
const STEP: usize = 4;

/// The text of a file, with these ends of lines.
pub(super) fn written(file: &File, feed: &'static str) -> String {
    let mut writer = Writer { out: String::new(), column: 0, indent: 0, feed };
    if let Some(item) = &file.value {
        writer.above(item, 0, true);
        writer.item(item, 0, 0);
        writer.after(&item.after);
    }
    for (n, comment) in file.end.iter().enumerate() {
        let is_first = n == 0 && file.value.is_none();
        writer.own_line(comment, 0, is_first);
    }
    if !writer.out.is_empty() {
        writer.out.push_str(feed);
    }
    writer.out
}

struct Writer {
    out: String,
    /// Columns of the present line.
    column: usize,
    /// Blanks at its begin.
    indent: usize,
    feed: &'static str,
}

impl Writer {
    fn push(&mut self, text: &str) {
        self.out.push_str(text);
        self.column = match text.rfind('\n') {
            Some(feed) => columns(&text[feed + 1..]),
            None => self.column + columns(text),
        };
    }

    fn blanks(&mut self, count: usize) {
        self.out.extend(std::iter::repeat_n(' ', count));
        self.column += count;
    }

    fn new_line(&mut self, indent: usize) {
        self.out.push_str(self.feed);
        (self.column, self.indent) = (0, indent);
        self.blanks(indent);
    }

    /// A line for what comes; `is_apart` leaves one empty before it. Nothing stands before the first in a file.
    fn begin_line(&mut self, indent: usize, is_apart: bool) {
        if self.out.is_empty() {
            return;
        }
        if is_apart {
            self.out.push_str(self.feed);
        }
        self.new_line(indent);
    }

    fn own_line(&mut self, comment: &Comment, indent: usize, is_first: bool) {
        self.begin_line(indent, comment.is_apart && !is_first);
        self.push(comment.token.text);
    }

    /// The comments above an item, and the line that it begins.
    fn above(&mut self, item: &Item, indent: usize, is_first: bool) {
        for (n, comment) in item.above.iter().enumerate() {
            self.own_line(comment, indent, is_first && n == 0);
        }
        self.begin_line(indent, item.is_apart && !(is_first && item.above.is_empty()));
    }

    /// Comments behind an item. One that stood apart from the code keeps its column where there is room.
    fn after(&mut self, comments: &[Comment]) {
        for comment in comments {
            let token = &comment.token;
            let moved = (token.column + self.indent).saturating_sub(token.indent);
            let column = if token.gap > 1 { moved } else { 0 };
            self.blanks(column.max(self.column + 1) - self.column);
            self.push(token.text);
        }
    }

    /// An item without what stands above it and behind its comma.
    fn item(&mut self, item: &Item, indent: usize, reserve: usize) {
        for comment in &item.before {
            self.push(comment);
            self.push(" ");
        }
        if let Some(key) = item.key {
            self.push(key);
            self.push(": ");
        }
        for comment in &item.between {
            self.push(comment);
            self.push(" ");
        }
        let behind: usize = item.behind.iter().map(|text| columns(text) + 1).sum();
        match &item.value {
            Value::Atom(text) => self.push(text),
            Value::Group(group) => self.group(group, indent, reserve + behind),
        }
        for comment in &item.behind {
            self.push(" ");
            self.push(comment);
        }
    }

    fn group(&mut self, group: &Group, indent: usize, reserve: usize) {
        let form = form(group, self.column, indent + STEP, reserve);
        self.push(group.word);
        self.push(group.open);
        match form {
            Form::Flat | Form::Hugging => {
                let has_blanks = group.open == "{" && !group.items.is_empty();
                let blank = if has_blanks { " " } else { "" };
                self.push(blank);
                for (n, item) in group.items.iter().enumerate() {
                    if n > 0 {
                        self.push(", ");
                    }
                    self.item(item, indent, reserve + 1);
                }
                self.push(blank);
            }
            Form::Broken | Form::Filled | Form::Listed => self.lines(group, form, indent + STEP),
        }
        if !matches!(form, Form::Flat | Form::Hugging) {
            self.new_line(indent);
        }
        self.push(group.close);
    }

    /// Items between the lines of their brackets.
    fn lines(&mut self, group: &Group, form: Form, indent: usize) {
        let mut must_end = true;
        for (n, item) in group.items.iter().enumerate() {
            let width = width_of_line(item).unwrap_or_else(|| width_of_head(item));
            let fits = self.column + 1 + width < WIDTH;
            // What has a name and spans lines begins one.
            let spans = item.key.is_some() && spans_lines(&item.value);
            let begins = match form {
                Form::Filled => false,
                Form::Listed => true,
                _ => item.begins_line || !item.above.is_empty() || spans,
            };
            if must_end || begins || !fits {
                self.above(item, indent, n == 0);
            } else {
                self.push(" ");
            }
            let line = self.out.len();
            self.item(item, indent, 1);
            self.push(",");
            self.after(&item.after);
            must_end = !item.after.is_empty() || self.out[line..].contains('\n');
        }
        for (n, comment) in group.end.iter().enumerate() {
            self.own_line(comment, indent, n == 0 && group.items.is_empty());
        }
    }
}
