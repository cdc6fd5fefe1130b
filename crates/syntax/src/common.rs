//! The common part of RON, read in one pass: words, numbers, texts, lists, maps, what stands between parentheses, comments.
//!
//! `ron` reads a value of ours once for each bracket around it, since it has no places. So most texts are read here; what is rarer
//! (attributes, raw texts, characters, exotic white space, deep brackets), and every mistake, is left to `ron` and its messages: `None`
//! says no more than that. What is read here has to be what `ron` reads, which a test holds.

use crate::tree::{Name, Node, Shape};

/// Brackets within each other that are read here; `ron` refuses a few more than this.
const DEEPEST: usize = 100;

/// Reads a whole text. `scalar` reads a number or a text that needs more than a copy.
pub(super) fn read<'a>(
    text: &'a str,
    longest: usize,
    scalar: &dyn Fn(&'a str) -> Option<Shape>,
) -> Option<Node> {
    let mut reader = Reader { text, at: 0, depth: 0, longest, scalar };
    reader.skip()?;
    let node = reader.node()?;
    reader.skip()?;
    (reader.at == text.len()).then_some(node)
}

struct Reader<'a, 's> {
    text: &'a str,
    at: usize,
    depth: usize,
    /// Most elements of a list.
    longest: usize,
    scalar: &'s dyn Fn(&'a str) -> Option<Shape>,
}

impl<'a> Reader<'a, '_> {
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Passes a sign if it stands here.
    fn takes(&mut self, sign: u8) -> bool {
        let is_here = self.peek() == Some(sign);
        self.at += usize::from(is_here);
        is_here
    }

    /// Passes white space and comments.
    fn skip(&mut self) -> Option<()> {
        let bytes = self.text.as_bytes();
        loop {
            match bytes.get(self.at..)? {
                [b' ' | b'\t' | b'\n' | b'\r', ..] => self.at += 1,
                [b'/', b'/', rest @ ..] => {
                    // One that the text ends in is rare.
                    self.at += 2 + rest.iter().position(|byte| *byte == b'\n')?;
                }
                [b'/', b'*', ..] => self.block_comment()?,
                _ => return Some(()),
            }
        }
    }

    /// A comment that may hold others.
    fn block_comment(&mut self) -> Option<()> {
        let bytes = self.text.as_bytes();
        let mut open = 0;
        loop {
            match bytes.get(self.at..)? {
                [b'/', b'*', ..] => (open, self.at) = (open + 1, self.at + 2),
                [b'*', b'/', ..] => {
                    (open, self.at) = (open - 1, self.at + 2);
                    if open == 0 {
                        return Some(());
                    }
                }
                [_, ..] => self.at += 1,
                [] => return None,
            }
        }
    }

    fn node(&mut self) -> Option<Node> {
        let start = self.at;
        let value = match self.peek()? {
            b'"' => self.quoted()?,
            b'[' => Shape::List(self.list(b'[', b']')?),
            b'{' => Shape::Map(self.map()?),
            b'(' => self.parenthesised(None)?,
            b'A'..=b'Z' | b'a'..=b'z' | b'_' => self.worded()?,
            b'0'..=b'9' | b'-' | b'+' | b'.' => self.number()?,
            _ => return None,
        };
        Some(Node { span: start..self.at, value })
    }

    /// Goes into a bracket.
    fn opened(&mut self, sign: u8) -> Option<()> {
        self.depth += 1;
        (self.depth < DEEPEST && self.takes(sign)).then_some(())?;
        self.skip()
    }

    /// Whether a bracket ends here, or after the comma that separates from the next element.
    fn closes(&mut self, sign: u8, is_first: bool) -> Option<bool> {
        if !is_first && !self.takes(b',') {
            self.depth -= 1;
            return self.takes(sign).then_some(true);
        }
        self.skip()?;
        if self.takes(sign) {
            self.depth -= 1;
            return Some(true);
        }
        Some(false)
    }

    fn list(&mut self, open: u8, close: u8) -> Option<Vec<Node>> {
        self.opened(open)?;
        let mut items = Vec::new();
        while !self.closes(close, items.is_empty())? {
            if items.len() == self.longest {
                return None;
            }
            items.push(self.node()?);
            self.skip()?;
        }
        Some(items)
    }

    fn map(&mut self) -> Option<Vec<(Name, Node)>> {
        self.opened(b'{')?;
        let mut members = Vec::new();
        while !self.closes(b'}', members.is_empty())? {
            let start = self.at;
            let Shape::Text(text) = self.quoted()? else { return None };
            members.push(self.member(Name { text, span: start..self.at })?);
        }
        Some(members)
    }

    /// The colon and the value behind a name.
    fn member(&mut self, name: Name) -> Option<(Name, Node)> {
        self.skip()?;
        self.takes(b':').then_some(())?;
        self.skip()?;
        let node = self.node()?;
        self.skip()?;
        Some((name, node))
    }

    fn parenthesised(&mut self, word: Option<Name>) -> Option<Shape> {
        let start = self.at;
        self.opened(b'(')?;
        if !self.names_member() {
            (self.at, self.depth) = (start, self.depth - 1);
            return Some(Shape::Tuple(word, self.list(b'(', b')')?));
        }
        let mut members = Vec::new();
        while !self.closes(b')', members.is_empty())? {
            let start = self.at;
            let text = self.word()?.to_owned();
            members.push(self.member(Name { text, span: start..self.at })?);
        }
        Some(Shape::Struct(word, members))
    }

    /// Whether a name with a colon stands here.
    fn names_member(&mut self) -> bool {
        let start = self.at;
        let is_name = self.word().is_some() && self.skip().is_some() && self.takes(b':');
        self.at = start;
        is_name
    }

    /// A word of plain letters that is not part of anything else.
    fn word(&mut self) -> Option<&'a str> {
        let rest = &self.text[self.at..];
        let starts = rest.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        let length = rest.bytes().position(|byte| !(byte.is_ascii_alphanumeric() || byte == b'_'));
        let length = length.unwrap_or(rest.len());
        // Raw words and texts, paths, letters of other languages.
        let is_more = rest[length..].starts_with(|c: char| !c.is_ascii() || "\"'#.-+".contains(c));
        if !starts || is_more {
            return None;
        }
        self.at += length;
        Some(&rest[..length])
    }

    fn worded(&mut self) -> Option<Shape> {
        let start = self.at;
        let word = self.word()?;
        let end = self.at;
        match word {
            "true" => return Some(Shape::Bool(true)),
            "false" => return Some(Shape::Bool(false)),
            "inf" | "NaN" => return None,
            _ => {}
        }
        self.skip()?;
        match self.peek() {
            Some(b'(') => self.parenthesised(Some(Name { text: word.to_owned(), span: start..end })),
            Some(b',' | b')' | b']' | b'}') | None => {
                self.at = end;
                Some(Shape::Word(word.to_owned()))
            }
            _ => None,
        }
    }

    fn number(&mut self) -> Option<Shape> {
        let rest = &self.text[self.at..];
        let is_of = |byte: u8| byte.is_ascii_alphanumeric() || b"+-._".contains(&byte);
        let length = rest.bytes().position(|byte| !is_of(byte)).unwrap_or(rest.len());
        let written = &rest[..length];
        self.at += length;
        let digits = written.strip_prefix('-').unwrap_or(written);
        let is_plain = digits.starts_with(|c: char| c.is_ascii_digit())
            && digits.len() < 16
            && digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
        match is_plain {
            true => written.parse().ok().map(Shape::Number),
            false => (self.scalar)(written).filter(|shape| matches!(shape, Shape::Number(_))),
        }
    }

    fn quoted(&mut self) -> Option<Shape> {
        let rest = &self.text[self.at..];
        let bytes = rest.as_bytes();
        let mut end = 1;
        let mut is_copy = true;
        loop {
            match bytes.get(end)? {
                b'"' => break,
                b'\\' => (is_copy, end) = (false, end + 2),
                _ => end += 1,
            }
        }
        (bytes[0] == b'"').then_some(())?;
        self.at += end + 1;
        match is_copy {
            true => Some(Shape::Text(rest[1..end].to_owned())),
            false => (self.scalar)(&rest[..=end]).filter(|shape| matches!(shape, Shape::Text(_))),
        }
    }
}
