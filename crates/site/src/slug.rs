//! Anchors of headings, as the sites that show Markdown of repositories make them, so that links fit both.

use std::collections::HashMap;

/// Makes each anchor of a page once.
#[derive(Debug, Default)]
pub struct Slugs(HashMap<String, usize>);

impl Slugs {
    /// The anchor of a heading.
    pub fn of(&mut self, heading: &str) -> String {
        let kept = |sign: &char| sign.is_alphanumeric() || matches!(sign, ' ' | '-' | '_');
        let slug: String = heading.trim().to_lowercase().chars().filter(kept).collect();
        let slug = slug.replace(' ', "-");
        let count = self.0.entry(slug.clone()).or_default();
        *count += 1;
        if *count == 1 { slug } else { format!("{slug}-{}", *count - 1) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_are_lower_case_without_signs_and_differ() {
        let mut slugs = Slugs::default();
        let made: Vec<String> = ["Parts of the program", "What is `--set`?", "Übersicht", "Übersicht"]
            .map(|h| slugs.of(h))
            .to_vec();
        assert_eq!(made, ["parts-of-the-program", "what-is---set", "übersicht", "übersicht-1"]);
    }
}
