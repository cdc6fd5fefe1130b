//! What a browser must know to be answered.

use std::fmt::Write;

/// A number that nobody can guess, as text.
#[derive(Clone, PartialEq, Eq)]
pub struct Token(String);

/// Random bytes of a token.
const BYTES: usize = 24;

impl Token {
    /// A new one, from the random numbers of the system.
    ///
    /// # Errors
    /// If the system has none.
    pub fn new() -> std::io::Result<Token> {
        let mut bytes = [0; BYTES];
        getrandom::fill(&mut bytes).map_err(|error| std::io::Error::other(error.to_string()))?;
        let mut text = String::with_capacity(2 * BYTES);
        for byte in bytes {
            let _ = write!(text, "{byte:02x}");
        }
        Ok(Token(text))
    }

    /// The token of a server that runs already.
    pub fn known(text: &str) -> Option<Token> {
        let is_token = text.len() == 2 * BYTES && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        is_token.then(|| Token(text.to_owned()))
    }

    /// As text.
    pub fn text(&self) -> &str {
        &self.0
    }

    /// Whether somebody else has it, too. Takes as long whatever differs.
    pub(crate) fn is(&self, other: &str) -> bool {
        let pairs = self.0.bytes().zip(other.bytes());
        self.0.len() == other.len() && pairs.fold(0, |seen, (a, b)| seen | (a ^ b)) == 0
    }
}

impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("Token(...)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_differ_and_know_themselves() {
        let (one, other) = (Token::new().unwrap(), Token::new().unwrap());
        assert!(one.is(one.text()) && !one.is(other.text()) && !one.is("") && !one.is(&one.text()[1..]));
        assert_eq!(Token::known(one.text()), Some(one.clone()));
        assert_eq!(Token::known("../etc/passwd"), None);
        assert_eq!(format!("{one:?}"), "Token(...)");
    }
}
