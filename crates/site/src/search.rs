//! The index of the search: each section with its words, as a script, so that it is read from the disk as well.

use serde_json::json;

use crate::Page;
use crate::markdown::{Text, title};

/// Most signs of the text of a section that are searched.
const LONGEST: usize = 1500;

/// The script that gives the index to the page.
pub fn index(pages: &[Page], texts: &[Text]) -> String {
    let mut entries = Vec::new();
    for (page, text) in pages.iter().zip(texts) {
        let name = if page.name.is_empty() { title(text) } else { &page.name };
        for heading in &text.headings {
            let below = heading.below.split_whitespace().collect::<Vec<_>>().join(" ");
            let below: String = below.chars().take(LONGEST).collect();
            let anchor = if heading.level == 1 { String::new() } else { format!("#{}", heading.anchor) };
            let address = format!("{}.html{anchor}", page.path);
            let heading = if heading.level == 1 { "" } else { heading.text.as_str() };
            entries.push(json!([name, heading, address, below, page.group]));
        }
    }
    format!("window.manualIndex = {};\n", json!(entries))
}
