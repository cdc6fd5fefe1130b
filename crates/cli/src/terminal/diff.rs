//! What changed in a text, as `diff -u` and `git` show it.

use std::path::Path;

use similar::TextDiff;

/// Lines that change with three around them; nothing if none do.
pub fn difference(path: &Path, old: &str, new: &str) -> String {
    let path = path.display().to_string();
    let lines = TextDiff::from_lines(old, new);
    lines.unified_diff().context_radius(3).header(&path, &path).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_change_stand_with_those_around_them() {
        let said = difference(Path::new("a.ron"), "1\n2\n3\n4\n5\n", "1\n2\n3\n4\nfive\n");
        assert_eq!(said, "--- a.ron\n+++ a.ron\n@@ -2,4 +2,4 @@\n 2\n 3\n 4\n-5\n+five\n");
        assert_eq!(difference(Path::new("a.ron"), "1\n", "1\n"), "");
    }
}
