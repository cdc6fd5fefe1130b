//! XML with bounds: size, depth and attributes are checked before anything is built from the text.

use std::path::Path;

use roxmltree::{Document, Node, ParsingOptions};

use crate::fault::{Fault, shown};
use crate::numbers::numbers;

/// Largest file that is read, bytes. A robot with a hundred links has some 100 kB.
const LARGEST: usize = 16 << 20;
/// Deepest nesting of elements.
const DEEPEST: usize = 100;
/// Most attributes of one element.
const MOST_ATTRIBUTES: usize = 100;
/// Most nodes of a document.
const MOST_NODES: u32 = 1_000_000;

/// The text of a file in UTF-8.
///
/// # Errors
/// A file that is too large or no text.
pub fn text<'a>(file: &Path, bytes: &'a [u8]) -> Result<&'a str, Fault> {
    if bytes.len() > LARGEST {
        let reason = format!("the file has {} MiB, at most {} are read", bytes.len() >> 20, LARGEST >> 20);
        return Err(Fault::new(file, reason, "is it the right file? meshes belong into files of their own"));
    }
    std::str::from_utf8(bytes).map_err(|error| {
        let line = 1 + bytes[..error.valid_up_to()].iter().filter(|b| **b == b'\n').count() as u32;
        Fault::new(file, "this is not text in UTF-8", "save the file in UTF-8").at(line)
    })
}

/// Reads XML. Document types, and with them entities of any kind, are refused.
///
/// # Errors
/// Text that is no XML, or XML beyond the bounds.
pub fn parse<'a>(file: &Path, text: &'a str) -> Result<Document<'a>, Fault> {
    bounded(file, text)?;
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| {
        let remedy = match error {
            roxmltree::Error::DtdDetected => {
                "take the DOCTYPE out; definitions of entities are never followed"
            }
            roxmltree::Error::NodesLimitReached => {
                "is it the right file? it has more than a million elements"
            }
            _ => "correct the file, or export it again",
        };
        Fault::new(file, format!("this is not XML that can be read: {error}"), remedy).at(error.pos().row)
    })
}

/// Refuses nesting and attributes that would cost a parser time or memory out of proportion.
fn bounded(file: &Path, text: &str) -> Result<(), Fault> {
    let fault = |at: usize, reason: String| {
        let line = 1 + text.as_bytes()[..at].iter().filter(|b| **b == b'\n').count() as u32;
        Fault::new(file, reason, "correct the file, or export it again").at(line)
    };
    let bytes = text.as_bytes();
    let (mut at, mut depth) = (0, 0_usize);
    while let Some(open) = bytes[at..].iter().position(|b| *b == b'<').map(|n| at + n) {
        let rest = &text[open..];
        let (end, size) = match rest {
            _ if rest.starts_with("<!--") => ("-->", 4),
            _ if rest.starts_with("<![CDATA[") => ("]]>", 9),
            _ if rest.starts_with("<?") => ("?>", 2),
            _ => ("", 1),
        };
        if !end.is_empty() {
            // Without an end the parser says what is missing.
            let Some(length) = rest[size..].find(end) else { return Ok(()) };
            at = open + size + length + end.len();
            continue;
        }
        let tag = tag(&bytes[open..]);
        if tag.attributes > MOST_ATTRIBUTES {
            let reason = format!("an element has more than {MOST_ATTRIBUTES} attributes");
            return Err(fault(open, reason));
        }
        if bytes.get(open + 1) == Some(&b'/') {
            depth = depth.saturating_sub(1);
        } else if !tag.closed {
            depth += 1;
        }
        if depth > DEEPEST {
            return Err(fault(open, format!("elements are nested deeper than {DEEPEST}")));
        }
        at = open + tag.length;
    }
    Ok(())
}

/// A tag as far as the bounds care.
struct Tag {
    length: usize,
    attributes: usize,
    /// It ends with `/>`.
    closed: bool,
}

fn tag(bytes: &[u8]) -> Tag {
    let (mut quote, mut attributes) = (None, 0);
    for (i, byte) in bytes.iter().enumerate().skip(1) {
        match (quote, byte) {
            (None, b'>') => return Tag { length: i + 1, attributes, closed: bytes[i - 1] == b'/' },
            (None, b'"' | b'\'') => {
                quote = Some(*byte);
                attributes += 1;
            }
            (Some(q), b) if q == *b => quote = None,
            _ => {}
        }
    }
    Tag { length: bytes.len(), attributes, closed: false }
}

/// An element with its file, for messages.
#[derive(Debug, Clone, Copy)]
pub struct Element<'a, 'd> {
    /// The file.
    pub file: &'a Path,
    /// The element.
    pub node: Node<'a, 'd>,
}

impl<'a, 'd> Element<'a, 'd> {
    /// The outermost element.
    pub fn root(file: &'a Path, document: &'a Document<'d>) -> Element<'a, 'd> {
        Element { file, node: document.root_element() }
    }

    /// Name of the element without its namespace.
    pub fn name(&self) -> &'a str {
        self.node.tag_name().name()
    }

    /// Line of its tag, from 1.
    pub fn line(&self) -> u32 {
        self.node.document().text_pos_at(self.node.range().start).row
    }

    /// A fault here.
    pub fn fault(&self, reason: impl Into<String>, remedy: impl Into<String>) -> Fault {
        Fault::new(self.file, reason, remedy).at(self.line())
    }

    /// Elements inside of this name, in order.
    pub fn all(self, name: &'a str) -> impl Iterator<Item = Element<'a, 'd>> + use<'a, 'd> {
        self.children().filter(move |child| child.name() == name)
    }

    /// All elements inside, in order.
    pub fn children(self) -> impl Iterator<Item = Element<'a, 'd>> + use<'a, 'd> {
        self.node.children().filter(Node::is_element).map(move |node| Element { file: self.file, node })
    }

    /// The element inside of this name, if there is one.
    ///
    /// # Errors
    /// If there are several.
    pub fn one(self, name: &'a str) -> Result<Option<Element<'a, 'd>>, Fault> {
        let mut all = self.all(name);
        let first = all.next();
        match all.next() {
            None => Ok(first),
            Some(second) => {
                Err(second.fault(format!("<{}> has a second <{name}>", self.name()), "remove one of them"))
            }
        }
    }

    /// The element inside of this name.
    ///
    /// # Errors
    /// If there is none, or several.
    pub fn need(self, name: &'a str) -> Result<Element<'a, 'd>, Fault> {
        self.one(name)?
            .ok_or_else(|| self.fault(format!("<{}> has no <{name}>", self.name()), format!("add <{name}>")))
    }

    /// An attribute, if it is there.
    pub fn attribute(&self, name: &str) -> Option<&'a str> {
        self.node.attribute(name)
    }

    /// An attribute that must be there and not be empty.
    ///
    /// # Errors
    /// If it is not.
    pub fn text_of(&self, name: &str) -> Result<&'a str, Fault> {
        match self.attribute(name) {
            Some(text) if !text.trim().is_empty() => Ok(text),
            _ => {
                Err(self.fault(format!("<{}> has no `{name}`", self.name()), format!("write {name}=\"...\"")))
            }
        }
    }

    /// Numbers in an attribute, if it is there.
    ///
    /// # Errors
    /// If there are not exactly `N` finite numbers.
    pub fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, Fault> {
        let Some(text) = self.attribute(name) else { return Ok(None) };
        let read = numbers(text).map_err(|(reason, remedy)| {
            self.fault(format!("`{name}` of <{}>: {reason}", self.name()), remedy)
        });
        read.map(Some)
    }

    /// One number in an attribute that must be there.
    ///
    /// # Errors
    /// If it is not there or no finite number.
    pub fn number(&self, name: &str) -> Result<f64, Fault> {
        self.text_of(name)?;
        Ok(self.numbers::<1>(name)?.map_or(0.0, |[x]| x))
    }

    /// Numbers between the tags.
    ///
    /// # Errors
    /// If there are not exactly `N` finite numbers.
    pub fn content<const N: usize>(&self) -> Result<[f64; N], Fault> {
        let text = self.node.text().unwrap_or_default();
        numbers(text).map_err(|(reason, remedy)| self.fault(format!("<{}>: {reason}", self.name()), remedy))
    }

    /// The name of something in a file: `name`, not too long.
    ///
    /// # Errors
    /// If it is missing, empty or too long.
    pub fn called(&self) -> Result<&'a str, Fault> {
        const LONGEST: usize = 200;
        let name = self.text_of("name")?;
        match name.len() > LONGEST {
            true => Err(self.fault(
                format!("the name `{}` has {} bytes", shown(name), name.len()),
                format!("take a name of at most {LONGEST}"),
            )),
            false => Ok(name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> Fault {
        parse(Path::new("a.urdf"), text).map(|_| ()).unwrap_err()
    }

    #[test]
    fn definitions_of_entities_are_refused_however_they_are_written() {
        let bomb = "<!DOCTYPE r [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;\">]>\n<robot name=\"&b;\"/>";
        let outside = "<!DOCTYPE r SYSTEM \"file:///etc/passwd\"><robot/>";
        for text in [bomb, outside] {
            assert!(refused(text).remedy.contains("DOCTYPE"), "{}", refused(text));
        }
        assert!(refused("<robot>&c;</robot>").reason.contains("entity"));
    }

    #[test]
    fn depth_and_attributes_are_bounded_before_the_text_is_parsed() {
        let deep = "<a>\n".repeat(1_000_000);
        assert_eq!(refused(&deep).line, Some(101));
        let wide = format!("<a {}/>", (0..200_000).map(|i| format!("a{i}='' ")).collect::<String>());
        assert!(refused(&wide).reason.contains("attributes"));
        let namespaces = "<a xmlns:x='u'>".repeat(200_000);
        assert!(refused(&namespaces).reason.contains("nested"));
    }

    #[test]
    fn comments_sections_and_quoted_brackets_do_not_count() {
        let good = "<r a='>'><!-- <b> --><![CDATA[<c>]]></r>";
        assert!(parse(Path::new("a"), good).is_ok());
    }

    #[test]
    fn a_fault_has_its_line() {
        assert_eq!(refused("<robot>\n<link>\n</robot>").line, Some(3));
        let bytes = [b'<', b'a', b'\n', 0xff];
        assert_eq!(text(Path::new("a"), &bytes).unwrap_err().line, Some(2));
    }
}
