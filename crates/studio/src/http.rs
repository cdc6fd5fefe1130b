//! One request and its answer (RFC 9112): each connection serves one, so that none waits behind another.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// Longest head of a request, bytes.
const HEAD: usize = 32 << 10;
/// Longest body, bytes.
const BODY: usize = 16 << 20;
/// Most headers.
const HEADERS: usize = 64;
/// How long a browser may take to send its request, or to read on.
const PATIENCE: Duration = Duration::from_secs(10);

/// A request that was read as a whole.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Request {
    pub method: String,
    /// Path and query, as sent.
    pub target: String,
    /// Names in small letters, and values.
    headers: Vec<(String, String)>,
    pub body: Vec<u8>,
}

/// Why a request is not answered as it should be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bad {
    /// Nobody is there any more.
    Gone,
    /// It is no request.
    Damaged,
    /// It is too long.
    Long,
}

impl Request {
    /// The value of a header; nothing where there is none, or several.
    pub fn header(&self, name: &str) -> Option<&str> {
        let mut found = self.headers.iter().filter(|(known, _)| known == name);
        let (_, value) = found.next()?;
        found.next().is_none().then_some(value)
    }

    /// Whether there is such a header at all.
    pub fn has(&self, name: &str) -> bool {
        self.headers.iter().any(|(known, _)| known == name)
    }

    /// Reads a request.
    ///
    /// # Errors
    /// If there is none.
    pub fn read(stream: &TcpStream) -> Result<Request, Bad> {
        stream.set_read_timeout(Some(PATIENCE)).map_err(|_| Bad::Gone)?;
        stream.set_write_timeout(Some(PATIENCE)).map_err(|_| Bad::Gone)?;
        // What is sent is small, and waited for.
        stream.set_nodelay(true).map_err(|_| Bad::Gone)?;
        Request::parse(stream)
    }

    fn parse(mut from: impl Read) -> Result<Request, Bad> {
        let mut bytes = Vec::new();
        let mut part = [0; 4096];
        let (mut request, begin) = loop {
            if let Some(done) = Request::head(&bytes)? {
                break done;
            }
            if bytes.len() > HEAD {
                return Err(Bad::Long);
            }
            match from.read(&mut part) {
                Ok(0) | Err(_) => return Err(Bad::Gone),
                Ok(count) => bytes.extend_from_slice(&part[..count]),
            }
        };
        if request.has("transfer-encoding") {
            return Err(Bad::Damaged);
        }
        let length = match request.header("content-length") {
            Some(length) => length.parse::<usize>().map_err(|_| Bad::Damaged)?,
            None if request.has("content-length") => return Err(Bad::Damaged),
            None => 0,
        };
        if length > BODY {
            return Err(Bad::Long);
        }
        request.body = bytes.split_off(begin);
        while request.body.len() < length {
            match from.read(&mut part) {
                Ok(0) | Err(_) => return Err(Bad::Gone),
                Ok(count) => request.body.extend_from_slice(&part[..count]),
            }
        }
        request.body.truncate(length);
        Ok(request)
    }

    /// The head of a request, and where its body begins; nothing yet where it is not whole.
    fn head(bytes: &[u8]) -> Result<Option<(Request, usize)>, Bad> {
        let mut headers = [httparse::EMPTY_HEADER; HEADERS];
        let mut parsed = httparse::Request::new(&mut headers);
        let begin = match parsed.parse(bytes).map_err(|_| Bad::Damaged)? {
            httparse::Status::Complete(begin) => begin,
            httparse::Status::Partial => return Ok(None),
        };
        let text = |value: &[u8]| String::from_utf8(value.to_vec()).map_err(|_| Bad::Damaged);
        let headers =
            parsed.headers.iter().map(|header| Ok((header.name.to_ascii_lowercase(), text(header.value)?)));
        let request = Request {
            method: parsed.method.unwrap_or_default().to_owned(),
            target: parsed.path.unwrap_or_default().to_owned(),
            headers: headers.collect::<Result<_, Bad>>()?,
            body: Vec::new(),
        };
        Ok(Some((request, begin)))
    }
}

/// An answer.
#[derive(Debug)]
pub(crate) struct Answer {
    status: u16,
    headers: Vec<(&'static str, String)>,
    body: Vec<u8>,
}

impl Answer {
    /// One with a type and a text, which nobody keeps or uses elsewhere.
    pub fn new(status: u16, kind: &str, body: impl Into<Vec<u8>>) -> Answer {
        let all = [
            ("Content-Type", kind),
            ("Cache-Control", "no-store"),
            ("X-Content-Type-Options", "nosniff"),
            ("Referrer-Policy", "no-referrer"),
            ("Cross-Origin-Resource-Policy", "same-origin"),
        ];
        Answer {
            status,
            headers: all.map(|(name, value)| (name, value.to_owned())).to_vec(),
            body: body.into(),
        }
    }

    /// Text for people.
    pub fn plain(status: u16, text: &str) -> Answer {
        Answer::new(status, "text/plain; charset=utf-8", text)
    }

    /// With a header more.
    pub fn with(mut self, name: &'static str, value: impl Into<String>) -> Answer {
        self.headers.push((name, value.into()));
        self
    }

    /// Sends it; of an answer to `HEAD` the head alone.
    ///
    /// # Errors
    /// If nobody reads it.
    pub fn send(&self, mut out: impl Write, whole: bool) -> io::Result<()> {
        let reason = match self.status {
            200 => "OK",
            303 => "See Other",
            400 => "Bad Request",
            403 => "Forbidden",
            404 => "Not Found",
            405 => "Method Not Allowed",
            409 => "Conflict",
            413 => "Content Too Large",
            _ => "Service Unavailable",
        };
        let mut head = format!(
            "HTTP/1.1 {} {reason}\r\nContent-Length: {}\r\nConnection: close\r\n",
            self.status,
            self.body.len()
        );
        for (name, value) in &self.headers {
            head.push_str(&format!("{name}: {value}\r\n"));
        }
        head.push_str("\r\n");
        let mut all = head.into_bytes();
        if whole {
            all.extend_from_slice(&self.body);
        }
        out.write_all(&all)?;
        out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_read_however_they_are_cut() {
        let whole =
            "POST /api/set?x=1 HTTP/1.1\r\nHost: localhost:1\r\nContent-Length: 7\r\n\r\n{\"a\":1}rest";
        for step in [1, 7, 1000] {
            struct Slow<'a>(&'a [u8], usize);
            impl Read for Slow<'_> {
                fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
                    let count = self.1.min(self.0.len()).min(to.len());
                    to[..count].copy_from_slice(&self.0[..count]);
                    self.0 = &self.0[count..];
                    Ok(count)
                }
            }
            let read = Request::parse(Slow(whole.as_bytes(), step)).unwrap();
            assert_eq!((read.method.as_str(), read.target.as_str()), ("POST", "/api/set?x=1"));
            assert_eq!((read.header("host"), read.body.as_slice()), (Some("localhost:1"), &b"{\"a\":1}"[..]));
        }
        let read = |text: &str| Request::parse(text.as_bytes()).err();
        assert_eq!(read("GET / HTTP/1.1\r\nHost: a"), Some(Bad::Gone));
        assert_eq!(read("nonsense\r\n\r\n"), Some(Bad::Damaged));
        assert_eq!(read("GET / HTTP/1.1\r\nContent-Length: -1\r\n\r\n"), Some(Bad::Damaged));
        assert_eq!(
            read("GET / HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\nab"),
            Some(Bad::Damaged)
        );
        assert_eq!(
            read("POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n"),
            Some(Bad::Damaged)
        );
        assert_eq!(read("POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n"), Some(Bad::Long));
        assert_eq!(read(&format!("GET /{} HTTP/1.1\r\n", "x".repeat(2 * HEAD))), Some(Bad::Long));
        // Several hosts are none.
        let two = Request::parse(&b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n"[..]).unwrap();
        assert_eq!((two.header("host"), two.has("host")), (None, true));
    }

    #[test]
    fn an_answer_has_its_length_and_its_headers() {
        let mut out = Vec::new();
        Answer::plain(404, "nothing").with("X", "y").send(&mut out, true).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(
            text.starts_with("HTTP/1.1 404 Not Found\r\nContent-Length: 7\r\nConnection: close\r\n"),
            "{text}"
        );
        assert!(text.contains("\r\nX: y\r\n") && text.ends_with("\r\n\r\nnothing"), "{text}");
        let mut out = Vec::new();
        Answer::plain(200, "all").send(&mut out, false).unwrap();
        assert!(String::from_utf8(out).unwrap().ends_with("\r\n\r\n"));
    }
}
