//! Names that C takes.

use std::collections::HashSet;

/// Words that C99 or the header files included have taken.
const TAKEN: &[&str] = &[
    "auto",
    "bool",
    "break",
    "case",
    "char",
    "const",
    "continue",
    "default",
    "do",
    "double",
    "else",
    "enum",
    "extern",
    "false",
    "float",
    "for",
    "goto",
    "if",
    "inline",
    "int",
    "long",
    "register",
    "restrict",
    "return",
    "short",
    "signed",
    "sizeof",
    "static",
    "struct",
    "switch",
    "true",
    "typedef",
    "union",
    "unsigned",
    "void",
    "volatile",
    "while",
    // Macros of the headers that the code and its test include, and of compilers.
    "INFINITY",
    "NAN",
    "NULL",
    "EOF",
    "HUGE_VAL",
    "HUGE_VALF",
    "HUGE_VALL",
    "EXIT_SUCCESS",
    "EXIT_FAILURE",
    "RAND_MAX",
    "MB_CUR_MAX",
    "BUFSIZ",
    "FOPEN_MAX",
    "FILENAME_MAX",
    "TMP_MAX",
    "SEEK_SET",
    "SEEK_CUR",
    "SEEK_END",
    "stdin",
    "stdout",
    "stderr",
    "errno",
    "assert",
    "math_errhandling",
    "linux",
    "unix",
    "main",
    "asm",
    "and",
    "or",
    "not",
    "xor",
    "class",
    "new",
    "delete",
    "this",
    "template",
    "namespace",
    "private",
    "public",
    "protected",
    "try",
    "catch",
    "throw",
    "virtual",
    "operator",
    "linux",
    "unix",
    "near",
    "far",
];

/// A name of letters, digits and underscores that is no word of the language.
pub(super) fn identifier(name: &str) -> String {
    let mut text: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    text.truncate(text.trim_end_matches('_').len());
    // Names that begin with an underscore belong to the language.
    if !text.starts_with(|c: char| c.is_ascii_alphabetic()) {
        text.insert(0, 'n');
    }
    if TAKEN.contains(&text.as_str()) {
        text.push('_');
    }
    text
}

/// Names in one scope, each only once.
#[derive(Debug, Default)]
pub(super) struct Names(HashSet<String>);

impl Names {
    /// Names of which some are taken.
    pub fn with(taken: &[&str]) -> Self {
        Self(taken.iter().map(|name| (*name).to_owned()).collect())
    }

    /// A name that nothing else has.
    pub fn add(&mut self, name: &str) -> String {
        let base = identifier(name);
        let mut text = base.clone();
        let mut number = 2;
        while !self.0.insert(text.clone()) {
            text = format!("{base}_{number}");
            number += 1;
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_valid_and_unique() {
        let mut names = Names::with(&["step"]);
        let made: Vec<String> =
            ["motor.w", "motor/w", "3rd", "\u{3c9}", "double", "_x", "step", "", "motor_w_2", "NULL"]
                .map(|name| names.add(name))
                .to_vec();
        assert_eq!(
            made,
            ["motor_w", "motor_w_2", "n3rd", "n", "double_", "n_x", "step_2", "n_2", "motor_w_2_2", "NULL_"]
        );
    }
}
