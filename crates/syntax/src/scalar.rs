//! Numbers, quoted texts and characters: from what is written to what is meant.

use crate::error::SyntaxError;
use crate::token::Token;
use crate::tree::Shape;

/// A number.
pub(crate) fn number(text: &str, token: Token) -> Result<Shape, SyntaxError> {
    let written = token.of(text);
    match value(written) {
        Some(value) => Ok(Shape::Number(value)),
        None => Err(range(text, token, written)
            .unwrap_or_else(|| SyntaxError::new(token.span(), format!("`{written}` is not a number")))),
    }
}

/// `0..50`, which needs quotes.
fn range(text: &str, token: Token, written: &str) -> Option<SyntaxError> {
    let (low, high) = written.split_once("..")?;
    value(low).and(value(high))?;
    let error = SyntaxError::new(token.span(), "a range stands between quotes");
    let quoted = format!("\"{low} .. {high}\"");
    Some(error.help(format!("write {quoted}")).remedy(text, token.span(), quoted))
}

fn value(written: &str) -> Option<f64> {
    let is_negative = written.starts_with('-');
    let digits = written.strip_prefix(['-', '+']).unwrap_or(written);
    // The commonest are digits with a point.
    if digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.') {
        return written.parse().ok();
    }
    let sign = if is_negative { -1.0 } else { 1.0 };
    match digits {
        "inf" => return Some(sign * f64::INFINITY),
        "NaN" => return Some(sign * f64::NAN),
        _ => {}
    }
    let is_of = |byte: u8| byte.is_ascii_digit() || b"eE.+-_".contains(&byte);
    if !digits.starts_with(|sign: char| sign.is_ascii_digit() || sign == '.') || !digits.bytes().all(is_of) {
        return None;
    }
    // Digits may be set apart by `_`, but not at the start and not behind the point.
    if digits.contains("._") {
        return None;
    }
    written.replace('_', "").parse().ok()
}

/// What a text between quotes holds.
pub(crate) fn quoted(text: &str, token: Token) -> Result<String, SyntaxError> {
    let written = token.of(text);
    if !token.is_closed {
        return Err(SyntaxError::new(token.span(), "this text has no end").help("close it with `\"`"));
    }
    let inside = &written[1..written.len() - 1];
    if !inside.contains('\\') {
        return Ok(inside.to_owned());
    }
    unescaped(text, token, inside)
}

/// What `r#"..."#` holds.
pub(crate) fn raw(written: &str) -> String {
    let body = written[1..].trim_start_matches('#');
    let hashes = written.len() - 1 - body.len();
    body[1..body.len() - 1 - hashes].to_owned()
}

/// What a character between quotes is.
pub(crate) fn character(text: &str, token: Token) -> Result<String, SyntaxError> {
    let written = token.of(text);
    let inside = &written[1..written.len() - 1];
    let meant = if inside.starts_with('\\') { unescaped(text, token, inside)? } else { inside.to_owned() };
    if meant.chars().count() == 1 {
        return Ok(meant);
    }
    Err(SyntaxError::new(token.span(), format!("{written} is not one character"))
        .help("write a text between `\"`"))
}

/// Escapes in a text are replaced by what they stand for.
fn unescaped(text: &str, token: Token, inside: &str) -> Result<String, SyntaxError> {
    let mut out = String::with_capacity(inside.len());
    let mut rest = inside;
    while let Some(at) = rest.find('\\') {
        out.push_str(&rest[..at]);
        let escape = &rest[at..];
        // The backslash of a line feed takes out the indentation of the next line, too.
        if let Some(next) = escape[1..].strip_prefix("\r\n").or(escape[1..].strip_prefix('\n')) {
            rest = next.trim_start_matches([' ', '\t', '\n', '\r']);
            continue;
        }
        let Some((sign, length)) = escaped(escape) else {
            let start = token.start() + 1 + (inside.len() - escape.len());
            let length = 1 + escape[1..].chars().next().map_or(0, char::len_utf8);
            let message = format!("`{}` is not an escape", &escape[..length]);
            return Err(SyntaxError::new(start..start + length, message)
                .help("write `\\\\` for a backslash; names of folders are separated by `/`")
                .remedy(text, start..start + 1, "\\\\"));
        };
        out.push(sign);
        rest = &escape[length..];
    }
    out.push_str(rest);
    Ok(out)
}

/// The character that an escape at the start stands for, and its length.
fn escaped(escape: &str) -> Option<(char, usize)> {
    let code = |digits: &str| {
        let is_hex = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
        char::from_u32(u32::from_str_radix(digits, 16).ok().filter(|_| is_hex)?)
    };
    let plain = match escape.as_bytes().get(1)? {
        b'n' => '\n',
        b'r' => '\r',
        b't' => '\t',
        b'0' => '\0',
        sign @ (b'\\' | b'"' | b'\'') => char::from(*sign),
        // Beyond ASCII it would be a byte of a letter.
        b'x' => return Some((code(escape.get(2..4)?).filter(char::is_ascii)?, 4)),
        b'u' => {
            let digits = escape[2..].strip_prefix('{')?;
            let digits = &digits[..digits.find('}').filter(|length| *length <= 6)?];
            return Some((code(digits)?, 4 + digits.len()));
        }
        _ => return None,
    };
    Some((plain, 2))
}
