//! One record of a CSV text at a time, in memory that does not grow with the text.

use std::io::{BufRead, Read};

use crate::error::CsvError;

/// Reads records; lines may end in LF or CRLF, quoted fields may hold line breaks.
pub(crate) struct Records<R> {
    source: R,
    limit: usize,
    /// What stands between fields; found in the first record where it is not known.
    delimiter: Option<char>,
    bytes: Vec<u8>,
    next_line: u64,
    /// Line on which the present record starts, from 1.
    pub line: u64,
    /// The fields of the present record, without quotes.
    pub fields: Vec<String>,
    /// How many of `fields` belong to the present record; the others are kept for their memory.
    pub count: usize,
}

impl<R: BufRead> Records<R> {
    /// Records of at most `limit` bytes each.
    pub fn new(source: R, limit: usize) -> Records<R> {
        Records {
            source,
            limit,
            delimiter: Some(','),
            bytes: Vec::new(),
            next_line: 1,
            line: 1,
            fields: Vec::new(),
            count: 0,
        }
    }

    /// The same with semicolons, tabs or commas between fields, whichever of them occurs in the first record, in this
    /// order. Lines before it that begin with `#` are passed over; `sep=;` in a line of its own says the sign.
    pub fn of_any_delimiter(source: R, limit: usize) -> Records<R> {
        Records { delimiter: None, ..Records::new(source, limit) }
    }

    /// What stands between fields.
    pub fn delimiter(&self) -> char {
        self.delimiter.unwrap_or(',')
    }

    /// Moves to the next record that is not an empty line; false at the end of the text.
    pub fn advance(&mut self) -> Result<bool, CsvError> {
        loop {
            self.line = self.next_line;
            self.bytes.clear();
            if !self.read_line()? {
                return Ok(false);
            }
            if self.line == 1 && self.bytes.starts_with(b"\xef\xbb\xbf") {
                self.bytes.drain(..3);
            }
            if self.is_preamble() {
                continue;
            }
            let mut open = odd_quotes(&self.bytes);
            while open {
                let before = self.bytes.len();
                if !self.read_line()? {
                    return Err(self.error(None, "a quoted field is not closed; add the missing \""));
                }
                open ^= odd_quotes(&self.bytes[before..]);
            }
            while matches!(self.bytes.last(), Some(b'\n' | b'\r')) {
                self.bytes.pop();
            }
            if !self.bytes.is_empty() {
                if self.bytes.contains(&b'\r') && !self.bytes.contains(&b'"') {
                    let problem = "lines end in carriage returns alone; save the file with line feeds (CSV for Windows or Unix)";
                    return Err(self.error(None, problem));
                }
                self.split()?;
                return Ok(true);
            }
        }
    }

    /// The fields of the present record.
    pub fn fields(&self) -> &[String] {
        &self.fields[..self.count]
    }

    /// An error on the line of the present record; columns count from 0 here.
    pub fn error(&self, column: Option<usize>, problem: impl Into<String>) -> CsvError {
        CsvError { line: self.line, column: column.map(|c| c + 1), problem: problem.into() }
    }

    fn read_line(&mut self) -> Result<bool, CsvError> {
        let room = (self.limit + 1).saturating_sub(self.bytes.len());
        let read = (&mut self.source).take(room as u64).read_until(b'\n', &mut self.bytes);
        match read {
            Err(error) => Err(self.error(None, format!("reading stopped: {error}"))),
            Ok(_) if self.bytes.len() > self.limit => {
                let problem = format!("the line is longer than {} bytes; is this a CSV file?", self.limit);
                Err(self.error(None, problem))
            }
            Ok(read) => {
                self.next_line += u64::from(read > 0);
                Ok(read > 0)
            }
        }
    }

    /// Whether the present line is one of those that programs put before the names of the columns: a comment, or what
    /// tells Excel the sign between the columns, `sep=;`.
    fn is_preamble(&mut self) -> bool {
        if self.delimiter.is_some() {
            return false;
        }
        let line = self.bytes.trim_ascii_end();
        if let [b's', b'e', b'p', b'=', sign @ (b',' | b';' | b'\t')] = line {
            self.delimiter = Some(char::from(*sign));
            return true;
        }
        line.starts_with(b"#")
    }

    fn split(&mut self) -> Result<(), CsvError> {
        let Ok(text) = std::str::from_utf8(&self.bytes) else {
            let is_utf16 = self.bytes.starts_with(b"\xff\xfe") || self.bytes.starts_with(b"\xfe\xff");
            let problem = match is_utf16 {
                true => "the text is UTF-16; save the file as UTF-8 (`CSV UTF-8` in Excel)",
                false => "the line is not UTF-8 text; save the file as UTF-8 (`CSV UTF-8` in Excel)",
            };
            return Err(self.error(None, problem));
        };
        let delimiter = *self.delimiter.get_or_insert_with(|| delimiter_in(text));
        let mut count = 0;
        let mut rest = text;
        loop {
            if count == self.fields.len() {
                self.fields.push(String::new());
            }
            let field = &mut self.fields[count];
            field.clear();
            if let Some(mut quoted) = rest.strip_prefix('"') {
                loop {
                    let Some((part, after)) = quoted.split_once('"') else {
                        return Err(
                            self.error(Some(count), "the quotes do not match; write \"\" for a quote")
                        );
                    };
                    field.push_str(part);
                    quoted = after;
                    match quoted.strip_prefix('"') {
                        Some(after) => {
                            field.push('"');
                            quoted = after;
                        }
                        None => break,
                    }
                }
                if !(quoted.is_empty() || quoted.starts_with(delimiter)) {
                    return Err(
                        self.error(Some(count), "text follows a closing quote; write \"\" for a quote")
                    );
                }
                rest = quoted;
            } else {
                let end = rest.find(delimiter).unwrap_or(rest.len());
                field.push_str(&rest[..end]);
                rest = &rest[end..];
            }
            count += 1;
            match rest.strip_prefix(delimiter) {
                Some(after) => rest = after,
                None => break,
            }
        }
        self.count = count;
        Ok(())
    }
}

/// What stands between the fields of a record, outside quotes.
fn delimiter_in(record: &str) -> char {
    let outside: String = record.split('"').step_by(2).collect();
    [';', '\t'].into_iter().find(|&sign| outside.contains(sign)).unwrap_or(',')
}

fn odd_quotes(bytes: &[u8]) -> bool {
    bytes.iter().filter(|&&b| b == b'"').count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Result<Vec<(u64, Vec<String>)>, CsvError> {
        let mut records = Records::new(text.as_bytes(), 60);
        let mut found = Vec::new();
        while records.advance()? {
            found.push((records.line, records.fields().to_vec()));
        }
        Ok(found)
    }

    fn owned(fields: &[&str]) -> Vec<String> {
        fields.iter().map(|&f| f.to_owned()).collect()
    }

    #[test]
    fn quotes_line_breaks_byte_order_marks_and_empty_fields_are_understood() {
        let text = "\u{feff}a,\"b,\"\"c\"\"\",\r\n\r\n\"two\nlines\",x\nlast";
        assert_eq!(
            all(text).unwrap(),
            [(1, owned(&["a", "b,\"c\"", ""])), (3, owned(&["two\nlines", "x"])), (5, owned(&["last"])),]
        );
    }

    #[test]
    fn comments_and_hints_for_excel_before_the_first_record_are_passed_over() {
        let first = |text: &str| {
            let mut records = Records::of_any_delimiter(text.as_bytes(), 60);
            records.advance().unwrap();
            (records.line, records.fields().to_vec())
        };
        assert_eq!(first("\u{feff}# John's \"log\n#\n\nt;a,b\n"), (4, owned(&["t", "a,b"])));
        assert_eq!(first("sep=,\r\nt,a;b\n"), (2, owned(&["t", "a;b"])));
        assert_eq!(all("# no comment,1\n").unwrap(), [(1, owned(&["# no comment", "1"]))]);
    }

    #[test]
    fn broken_records_are_refused_with_their_line() {
        let message = |text: &str| all(text).unwrap_err().to_string();
        assert_eq!(message("a\n\"b"), "line 2: a quoted field is not closed; add the missing \"");
        assert_eq!(
            message("a,\"b\"c"),
            "line 1, column 2: text follows a closing quote; write \"\" for a quote"
        );
        let long = "x".repeat(61);
        assert_eq!(message(&long), "line 1: the line is longer than 60 bytes; is this a CSV file?");
        let open = format!("\"{}", "x\n".repeat(100));
        assert_eq!(message(&open), "line 1: the line is longer than 60 bytes; is this a CSV file?");
        assert_eq!(
            message("a,b\r0,1\r"),
            "line 1: lines end in carriage returns alone; save the file with line feeds (CSV for Windows or Unix)"
        );
        let of_bytes = |bytes: &[u8]| Records::new(bytes, 60).advance().unwrap_err().to_string();
        let advice = "save the file as UTF-8 (`CSV UTF-8` in Excel)";
        assert_eq!(of_bytes(b"\xff\xfet\0\n\0"), format!("line 1: the text is UTF-16; {advice}"));
        assert_eq!(of_bytes(b"q [\xb0]\n"), format!("line 1: the line is not UTF-8 text; {advice}"));
    }
}
