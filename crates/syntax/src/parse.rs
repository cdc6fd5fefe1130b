//! Tokens become a tree with places, in one pass. What cannot go on is an error at the token where that shows; `mistakes` knows what
//! is more likely to be wrong.

use std::ops::Range;

use crate::error::SyntaxError;
use crate::scalar::{character, number, quoted, raw};
use crate::token::{LONGEST, Token, TokenKind, Tokens};
use crate::tree::{Name, Node, Shape};

/// Brackets within each other. They take the stack of the thread.
const DEEPEST: usize = 128;

/// Most elements of a list.
pub(crate) const MOST_ITEMS: usize = 1_000_000;

/// Extensions of RON that a text may name; all of them hold anyway.
const EXTENSIONS: [&str; 4] =
    ["implicit_some", "unwrap_newtypes", "unwrap_variant_newtypes", "explicit_struct_names"];

/// Reads a whole text.
pub(crate) fn parse(text: &str) -> Result<Node, SyntaxError> {
    if text.len() >= LONGEST {
        return Err(SyntaxError::new(0..0, "this file is larger than 4 GiB"));
    }
    let mut parser = Parser { text, tokens: Tokens::new(text), next: None, behind: 0, depth: 0, later: None };
    parser.advance();
    while let Some(token) = parser.next.filter(|token| token.kind == TokenKind::Attribute) {
        attribute(text, token)?;
        parser.advance();
    }
    let Some(first) = parser.advance() else {
        return Err(SyntaxError::new(0..0, "there is nothing in this file"));
    };
    let node = parser.value(first)?;
    match (parser.next, parser.later) {
        (None, None) => Ok(node),
        (None, Some(error)) => Err(error),
        (Some(token), _) => {
            Err(SyntaxError::new(token.span(), "nothing may follow behind the value of a file")
                .help("move this between the brackets, or delete it"))
        }
    }
}

fn attribute(text: &str, token: Token) -> Result<(), SyntaxError> {
    let inside = token.of(text).trim_start_matches("#![").trim_end_matches(']').trim();
    let names = inside.strip_prefix("enable").map(str::trim);
    let names = names.and_then(|names| names.strip_prefix('(')?.strip_suffix(')'));
    let known = names.is_some_and(|names| {
        names.split(',').map(str::trim).all(|name| name.is_empty() || EXTENSIONS.contains(&name))
    });
    if known {
        return Ok(());
    }
    Err(SyntaxError::new(token.span(), "this attribute is not known")
        .help(format!("delete it: nothing needs to be enabled; known are {}", EXTENSIONS.join(", "))))
}

struct Parser<'a> {
    text: &'a str,
    tokens: Tokens<'a>,
    /// The token that comes, which is no comment.
    next: Option<Token>,
    /// The byte behind the last one that was passed.
    behind: usize,
    depth: usize,
    /// The first mistake that does not keep the rest from being read. One in the brackets is more likely the cause.
    later: Option<SyntaxError>,
}

impl Parser<'_> {
    /// Passes a token.
    fn advance(&mut self) -> Option<Token> {
        let passed = self.next;
        self.behind = passed.map_or(self.behind, |token| token.end());
        self.next = self.tokens.by_ref().find(|token| !token.kind.is_comment() || !token.is_closed);
        if let Some(comment) = self.next.take_if(|token| token.kind.is_comment()) {
            self.later = Some(endless_comment(comment));
        }
        passed
    }

    fn passes(&mut self, kind: TokenKind) -> bool {
        let is_next = self.next.is_some_and(|token| token.kind == kind);
        if is_next {
            self.advance();
        }
        is_next
    }

    fn sign(&self, token: Token) -> u8 {
        self.text.as_bytes()[token.start()]
    }

    /// Where the next token stands, or the text ends.
    fn here(&self) -> Range<usize> {
        self.next.map_or(self.text.len()..self.text.len(), |token| token.span())
    }

    /// The value that begins with a token that was passed.
    fn value(&mut self, first: Token) -> Result<Node, SyntaxError> {
        let value = match first.kind {
            TokenKind::Word => self.worded(first)?,
            TokenKind::Number => number(self.text, first)?,
            TokenKind::Text => Shape::Text(quoted(self.text, first)?),
            TokenKind::RawText => Shape::Text(raw(first.of(self.text))),
            TokenKind::Character => Shape::Text(character(self.text, first)?),
            TokenKind::Open => match self.sign(first) {
                b'[' => Shape::List(self.items(first, Vec::new())?),
                b'{' => Shape::Map(self.map(first)?),
                _ => self.parenthesised(None, first)?,
            },
            _ => return Err(no_value(self.text, first)),
        };
        Ok(Node { span: first.start()..self.behind, value })
    }

    fn worded(&mut self, word: Token) -> Result<Shape, SyntaxError> {
        let text = word.of(self.text);
        match text {
            "true" => return Ok(Shape::Bool(true)),
            "false" => return Ok(Shape::Bool(false)),
            "inf" => return Ok(Shape::Number(f64::INFINITY)),
            "NaN" => return Ok(Shape::Number(f64::NAN)),
            _ => {}
        }
        match self.next {
            Some(open) if open.kind == TokenKind::Open && self.sign(open) == b'(' => {
                self.advance();
                self.parenthesised(Some(self.name(word)), open)
            }
            _ => Ok(Shape::Word(text.to_owned())),
        }
    }

    fn name(&self, word: Token) -> Name {
        Name { text: word.of(self.text).to_owned(), span: word.span() }
    }

    /// What stands in parentheses: named values or values.
    fn parenthesised(&mut self, word: Option<Name>, open: Token) -> Result<Shape, SyntaxError> {
        let Some(first) = self.next.filter(|token| token.kind == TokenKind::Word) else {
            return Ok(Shape::Tuple(word, self.items(open, Vec::new())?));
        };
        self.advance();
        if self.next.is_some_and(|token| token.kind == TokenKind::Colon) {
            return Ok(Shape::Struct(word, self.members(open, Some(first))?));
        }
        // One level deeper than the brackets that it is the first in.
        self.deeper(open)?;
        let value = self.value(first)?;
        self.depth -= 1;
        let mut items = vec![value];
        if !self.ends(open)? {
            items = self.items(open, items)?;
        }
        Ok(Shape::Tuple(word, items))
    }

    fn deeper(&mut self, open: Token) -> Result<(), SyntaxError> {
        self.depth += 1;
        if self.depth <= DEEPEST {
            return Ok(());
        }
        let message = format!("there are more than {DEEPEST} brackets inside each other");
        Err(SyntaxError::new(open.span(), message)
            .help("keep inner parts in files or parameters of their own"))
    }

    /// Passes the bracket that closes, if it comes.
    fn closes(&mut self, open: Token) -> bool {
        let close = match self.sign(open) {
            b'(' => b')',
            b'[' => b']',
            _ => b'}',
        };
        let is_next =
            self.next.is_some_and(|token| token.kind == TokenKind::Close && self.sign(token) == close);
        if is_next {
            self.advance();
        }
        is_next
    }

    /// Passes the bracket that closes or the comma before another value; whether it was the bracket.
    fn ends(&mut self, open: Token) -> Result<bool, SyntaxError> {
        if self.closes(open) {
            return Ok(true);
        }
        if !self.passes(TokenKind::Comma) {
            return Err(SyntaxError::new(self.here(), "a `,` or a closing bracket is missing here"));
        }
        Ok(self.closes(open))
    }

    /// What comes next, which has to be there.
    fn expected(&mut self) -> Result<Token, SyntaxError> {
        let end = self.here();
        self.advance().ok_or_else(|| SyntaxError::new(end, "a value or a closing bracket is missing here"))
    }

    /// Values up to the closing bracket, behind those that are there and their comma.
    fn items(&mut self, open: Token, mut items: Vec<Node>) -> Result<Vec<Node>, SyntaxError> {
        self.deeper(open)?;
        let mut is_closed = items.is_empty() && self.closes(open);
        let mut count = items.len();
        while !is_closed {
            let first = self.expected()?;
            let item = self.value(first)?;
            count += 1;
            if count <= MOST_ITEMS {
                items.push(item);
            }
            is_closed = self.ends(open)?;
        }
        self.depth -= 1;
        if count > MOST_ITEMS {
            let message = format!("this list has {count} elements, more than {MOST_ITEMS}");
            let help = "keep long tables in a file of their own, which `FromFile` reads";
            return Err(SyntaxError::new(open.span(), message).help(help));
        }
        Ok(items)
    }

    /// Named values in braces, whose names are quoted.
    fn map(&mut self, open: Token) -> Result<Vec<(Name, Node)>, SyntaxError> {
        self.deeper(open)?;
        let mut members = Vec::new();
        let mut is_closed = self.closes(open);
        while !is_closed {
            let first = self.expected()?;
            let text = match first.kind {
                TokenKind::Text => quoted(self.text, first)?,
                TokenKind::RawText => raw(first.of(self.text)),
                _ if self.next.is_some_and(|next| next.kind == TokenKind::Colon) => {
                    self.later.get_or_insert_with(|| no_key(self.text, first));
                    first.of(self.text).to_owned()
                }
                _ => return Err(SyntaxError::new(first.span(), "a name in quotes is expected here")),
            };
            members.push(self.member(Name { text, span: first.span() })?);
            is_closed = self.ends(open)?;
        }
        self.depth -= 1;
        Ok(members)
    }

    /// Named values in parentheses; `first` is the name of the first, behind which a colon comes.
    fn members(&mut self, open: Token, first: Option<Token>) -> Result<Vec<(Name, Node)>, SyntaxError> {
        self.deeper(open)?;
        let mut members = Vec::new();
        let mut name = first;
        loop {
            let word = match name.take() {
                Some(word) => word,
                None => self.expected()?,
            };
            if word.kind != TokenKind::Word {
                return Err(SyntaxError::new(word.span(), "a name is expected here"));
            }
            members.push(self.member(self.name(word))?);
            if self.ends(open)? {
                break;
            }
        }
        self.depth -= 1;
        Ok(members)
    }

    /// The colon and the value behind a name.
    fn member(&mut self, name: Name) -> Result<(Name, Node), SyntaxError> {
        if !self.passes(TokenKind::Colon) {
            return Err(SyntaxError::new(self.here(), "a `:` is missing here"));
        }
        let end = self.here();
        let first =
            self.advance().ok_or_else(|| SyntaxError::new(end, format!("`{}` has no value", name.text)))?;
        Ok((name, self.value(first)?))
    }
}

/// A token that begins no value.
fn no_value(text: &str, token: Token) -> SyntaxError {
    let sign = token.of(text);
    match token.kind {
        TokenKind::Comma | TokenKind::Colon | TokenKind::Close => {
            SyntaxError::new(token.span(), format!("a value is missing before this `{sign}`"))
        }
        _ if sign.contains(char::is_whitespace) => {
            SyntaxError::new(token.span(), "this blank is not white space of RON")
                .help("replace it by an ordinary blank")
        }
        _ => SyntaxError::new(token.span(), format!("`{sign}` does not begin a value"))
            .help("a value is a number, a text in quotes, a word, or something in brackets"),
    }
}

/// A token in the place of a name in braces.
fn no_key(text: &str, token: Token) -> SyntaxError {
    let quoted = format!("\"{}\"", token.of(text));
    SyntaxError::new(token.span(), "names between braces are written in quotes")
        .help(format!("write `{quoted}`"))
        .remedy(text, token.span(), quoted)
}

/// A comment that goes on to the end of the text.
pub(crate) fn endless_comment(comment: Token) -> SyntaxError {
    SyntaxError::new(comment.start()..comment.start() + 2, "this comment has no end")
        .help("close it with `*/`")
}
