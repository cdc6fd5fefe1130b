//! Words of a shell, for advice that can be typed as it stands.

use std::path::Path;

/// A path as it can be pasted into a shell.
pub fn quoted(path: &Path) -> String {
    quoted_text(&path.display().to_string())
}

/// The same of a text.
pub fn quoted_text(text: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/\\:._-+~".contains(c);
    if text.chars().all(is_plain) { text.to_owned() } else { format!("'{}'", text.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_can_be_pasted() {
        assert_eq!(quoted(Path::new("/home/a/my-plugin_1")), "/home/a/my-plugin_1");
        assert_eq!(quoted(Path::new("/home/a b/it's; rm")), r"'/home/a b/it'\''s; rm'");
    }
}
