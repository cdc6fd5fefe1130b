//! Lists of names of ports and elements.

use blocksim_block::{ParamError, ParamErrors};

/// Reports names of ports that are missing, are no words, or occur twice; each with its place in the list.
pub(crate) fn validate_names<'a>(
    param: &str,
    names: impl IntoIterator<Item = &'a str>,
    errors: &mut ParamErrors,
) {
    let mut known: Vec<&str> = Vec::new();
    for (i, name) in names.into_iter().enumerate() {
        let place = format!("{param}[{i}]");
        if !is_name(name) {
            errors.add(no_name(&place, param, name));
        } else if known.contains(&name) {
            let error = ParamError::new(place, format!("`{param}` names `{name}` twice"));
            errors.add(error.help("names of ports differ from each other"));
        }
        known.push(name);
    }
    if known.is_empty() {
        errors.add(ParamError::new(param, format!("`{param}` is empty")).help("name at least one"));
    }
}

/// Whether a port can have this name.
pub(crate) fn is_name(name: &str) -> bool {
    let is_word = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    is_word && name.starts_with(|c: char| c.is_ascii_alphabetic())
}

/// The error of a name that no port can have.
pub(crate) fn no_name(place: &str, param: &str, name: &str) -> ParamError {
    ParamError::new(place, format!("`{name}` in `{param}` is not a valid name"))
        .help("a name begins with a letter; letters, digits and _ may follow")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_words_that_differ() {
        let errors = |names: &[&'static str]| {
            let mut errors = ParamErrors::default();
            validate_names("inputs", names.iter().copied(), &mut errors);
            errors
        };
        assert!(errors(&["set", "actual_2"]).is_empty());
        for (names, message) in [
            (vec![], "`inputs` is empty"),
            (vec!["a", "b", "a"], "`inputs` names `a` twice"),
            (vec!["2a"], "`2a` in `inputs` is not a valid name"),
            (vec!["a b"], "`a b` in `inputs` is not a valid name"),
            (vec![""], "`` in `inputs` is not a valid name"),
        ] {
            assert_eq!(errors(&names)[0].message, message);
        }
    }
}
