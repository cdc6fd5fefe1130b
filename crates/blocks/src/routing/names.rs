//! Lists of names of ports and elements.

use blocksim_block::ParamError;

/// Names of ports must be given, be words and differ from each other.
///
/// # Errors
/// The first name that does not fit, as an error of parameter `param`.
pub(crate) fn check_names<'a>(
    param: &str,
    names: impl IntoIterator<Item = &'a str>,
) -> Result<(), ParamError> {
    let mut known: Vec<&str> = Vec::new();
    for name in names {
        let word = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if !word || !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
            return Err(ParamError::new(param, format!("`{name}` in `{param}` is not a valid name"))
                .help("a name begins with a letter; letters, digits and _ may follow"));
        }
        if known.contains(&name) {
            return Err(ParamError::new(param, format!("`{param}` names `{name}` twice")));
        }
        known.push(name);
    }
    if known.is_empty() {
        return Err(ParamError::new(param, format!("`{param}` is empty")).help("name at least one"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_words_that_differ() {
        assert!(check_names("inputs", ["set", "actual_2"]).is_ok());
        for (names, message) in [
            (vec![], "`inputs` is empty"),
            (vec!["a", "b", "a"], "`inputs` names `a` twice"),
            (vec!["2a"], "`2a` in `inputs` is not a valid name"),
            (vec!["a b"], "`a b` in `inputs` is not a valid name"),
            (vec![""], "`` in `inputs` is not a valid name"),
        ] {
            assert_eq!(check_names("inputs", names).unwrap_err().message, message);
        }
    }
}
