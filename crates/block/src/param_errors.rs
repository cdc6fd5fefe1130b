//! All that is wrong with the parameters of a block.

use std::ops::Deref;

use crate::ParamError;

/// What is wrong with the parameters of a block, all of it: who checks goes on behind the first mistake.
///
/// A cause comes before what follows from it, and without it: an error about several parameters
/// ([`ParamError::beside`]) is passed over where one of them is wrong already, and so is one about a parameter that could not be read or
/// does not meet the requirements of its declaration.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ParamErrors {
    found: Vec<ParamError>,
    /// Parameters without a value: what is wrong with them has been reported.
    unread: Vec<String>,
    /// How many of them are about declared requirements.
    declared: usize,
}

impl ParamErrors {
    /// Reports what is wrong.
    pub fn add(&mut self, error: ParamError) {
        let param = top(&error.param);
        let declared = &self.found[..self.declared];
        let is_consequence = self.unread.iter().any(|name| name == param)
            || declared.iter().any(|error| top(&error.param) == param)
            || error.beside.iter().any(|name| !self.is_right(name));
        if !is_consequence {
            self.found.push(error);
        }
    }

    /// The value, if there is one; what is wrong is reported.
    pub fn take<T>(&mut self, result: Result<T, ParamError>) -> Option<T> {
        result.map_err(|error| self.add(error)).ok()
    }

    /// Notes that a parameter could not be read. Whoever read it reports why.
    pub fn unread(&mut self, name: &str) {
        self.unread.push(name.to_owned());
    }

    /// Notes that all requirements have been looked at: who does not meet its own has no further mistakes.
    pub(crate) fn settle(&mut self) {
        self.declared = self.found.len();
    }

    /// Whether nothing is known against a parameter so far.
    pub fn is_right(&self, name: &str) -> bool {
        let name = top(name);
        !self.unread.iter().any(|unread| unread == name)
            && !self.found.iter().any(|error| top(&error.param) == name)
    }

    /// Whether nothing is known against any of these parameters so far: what follows from them can be worked out.
    pub fn are_right(&self, names: &[&str]) -> bool {
        names.iter().all(|name| self.is_right(name))
    }

    /// Whether all is well so far.
    pub fn is_empty(&self) -> bool {
        self.found.is_empty() && self.unread.is_empty()
    }
}

/// What has been reported.
impl Deref for ParamErrors {
    type Target = [ParamError];

    fn deref(&self) -> &[ParamError] {
        &self.found
    }
}

impl IntoIterator for ParamErrors {
    type Item = ParamError;
    type IntoIter = std::vec::IntoIter<ParamError>;

    fn into_iter(self) -> Self::IntoIter {
        self.found.into_iter()
    }
}

/// The parameter itself of a path such as `axes[2].upper`.
fn top(path: &str) -> &str {
    path.split(['.', '[']).next().unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consequences_are_not_reported() {
        let mut errors = ParamErrors::default();
        errors.unread("c");
        errors.add(ParamError::new("a[1]", "first"));
        errors.add(ParamError::new("b", "follows from a").beside(&["a"]));
        errors.add(ParamError::new("c", "has no value"));
        errors.add(ParamError::new("b", "second"));
        errors.settle();
        errors.add(ParamError::new("b", "is wrong in itself"));
        errors.add(ParamError::new("d", "third"));
        errors.add(ParamError::new("d", "fourth"));
        let messages: Vec<&str> = errors.iter().map(|error| error.message.as_str()).collect();
        assert_eq!(messages, ["first", "second", "third", "fourth"]);
        assert!(!errors.are_right(&["e", "c"]) && errors.is_right("e") && !errors.is_right("a"));
    }
}
