//! What quantities are called in a sheet.

use std::collections::BTreeMap;

use crate::key::capital;

/// `axis*.bearing.coulomb` is `Bearing: Coulomb friction torque`; words without another name keep their own.
pub(crate) fn label(key: &str, labels: &BTreeMap<String, String>) -> String {
    let path = key.split_once("*.").map_or(key, |(_, path)| path);
    let path = path.strip_suffix("[*]").unwrap_or(path);
    let words: Vec<String> = path
        .split('.')
        .map(|word| match labels.get(word) {
            Some(name) => name.clone(),
            None => word.replace('_', " "),
        })
        .collect();
    let text = words.join(": ");
    capital(&text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_become_words() {
        let labels = BTreeMap::from(
            [("coulomb", "Coulomb friction torque"), ("com", "centre of mass")]
                .map(|(word, name)| (word.to_owned(), name.to_owned())),
        );
        let label = |key| label(key, &labels);
        assert_eq!(label("axis*.bearing.coulomb"), "Bearing: Coulomb friction torque");
        assert_eq!(label("link2.com[*]"), "Link2: centre of mass");
        assert_eq!(label("new_thing"), "New thing");
        assert_eq!(label("ölstand"), "ölstand");
        assert_eq!(label(""), "");
    }
}
