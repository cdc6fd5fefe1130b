//! Files as the protocol names them: `file:///home/ada/servo%20arm.ron`.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use lsp_types::Uri;

/// The file that a name means; none for what is no file.
pub fn path_of(uri: &Uri) -> Option<PathBuf> {
    let text = uri.as_str().strip_prefix("file://")?;
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'%' => {
                let digits = [rest.next()?, rest.next()?];
                u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?
            }
            byte => byte,
        });
    }
    let text = String::from_utf8(bytes).ok()?;
    // `/C:/models/servo.ron`
    let drive =
        text.get(1..3).is_some_and(|drive| drive.ends_with(':') && drive.as_bytes()[0].is_ascii_alphabetic());
    Some(PathBuf::from(if drive { &text[1..] } else { &text }))
}

/// The name of a file; none where the path is not absolute.
pub fn uri_of(path: &Path) -> Option<Uri> {
    if !path.is_absolute() {
        return None;
    }
    let text = path.to_str()?.replace('\\', "/");
    let mut name = String::from(if text.starts_with('/') { "file://" } else { "file:///" });
    for byte in text.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b'~' | b':' => {
                name.push(byte.into())
            }
            byte => name.push_str(&format!("%{byte:02X}")),
        }
    }
    Uri::from_str(&name).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_go_there_and_back() {
        for path in ["/home/ada/servo.ron", "/tmp/a b/ö#%.ron"] {
            let uri = uri_of(Path::new(path)).unwrap();
            assert_eq!(path_of(&uri).unwrap(), Path::new(path), "{}", uri.as_str());
        }
        let windows = Uri::from_str("file:///c%3A/lab/servo.ron").unwrap();
        assert_eq!(path_of(&windows).unwrap(), Path::new("c:/lab/servo.ron"));
        for other in ["untitled:Untitled-1", "file:///%zz"] {
            assert_eq!(Uri::from_str(other).ok().and_then(|uri| path_of(&uri)), None, "{other}");
        }
        assert_eq!(uri_of(Path::new("servo.ron")), None);
    }
}
