//! The last line of a file that the program writes and may write again: a fingerprint of the lines above. It tells
//! whether somebody has changed them.

use blocksim_diagram::fingerprint;

const MARK: &str = "// Fingerprint of the lines above: ";

/// Whether a text is as it was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seal {
    /// Not a sign differs.
    Whole,
    /// It was changed.
    Broken,
    /// It bears no fingerprint.
    Missing,
}

/// The text with its fingerprint below.
pub fn seal(text: &str) -> String {
    format!("{text}{MARK}{}\n", fingerprint(text.as_bytes()))
}

/// Whether a text is as [`seal`] left it. Ends of lines may have become those of another system.
pub fn sealed(text: &str) -> Seal {
    let text = text.replace("\r\n", "\n");
    let Some(at) = text.rfind(MARK) else { return Seal::Missing };
    match seal(&text[..at]) == text {
        true => Seal::Whole,
        false => Seal::Broken,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_breaks_the_seal() {
        let text = seal("(\n    mass: \"1 kg\",\n)\n");
        assert_eq!(sealed(&text), Seal::Whole);
        assert_eq!(sealed(&text.replace('\n', "\r\n")), Seal::Whole);
        assert_eq!(sealed(&text.replace("1 kg", "2 kg")), Seal::Broken);
        assert_eq!(sealed(&format!("{text}// mine\n")), Seal::Broken);
        assert_eq!(sealed("()"), Seal::Missing);
    }
}
