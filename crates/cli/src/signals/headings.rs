//! What scopes are called: as their labels say, else by their paths.

use blocksim_recording::titles;

use crate::signals::naming::distinct_names;

/// A name for each scope, from its path and its labels (the outermost first; empty without). Where several scopes have the
/// same labels, what tells their paths apart stands behind them.
pub fn headings(scopes: &[(&str, &[String])]) -> Vec<String> {
    let names = distinct_names(&scopes.iter().map(|scope| scope.0).collect::<Vec<_>>());
    let labelled = titles(&scopes.iter().map(|scope| scope.1).collect::<Vec<_>>());
    let called = |(n, heading): (usize, &String)| {
        if heading.is_empty() {
            return names[n].to_owned();
        }
        let alike: Vec<&str> =
            (0..scopes.len()).filter(|&m| labelled[m] == *heading).map(|m| scopes[m].0).collect();
        if alike.iter().all(|path| *path == scopes[n].0) {
            return heading.clone();
        }
        let own = alike.iter().position(|path| *path == scopes[n].0).unwrap_or(0);
        format!("{heading} ({})", distinct_names(&alike)[own])
    };
    labelled.iter().enumerate().map(called).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn called(scopes: &[(&str, &[&str])]) -> Vec<String> {
        let labels: Vec<Vec<String>> =
            scopes.iter().map(|(_, labels)| labels.iter().map(ToString::to_string).collect()).collect();
        let all: Vec<(&str, &[String])> =
            scopes.iter().zip(&labels).map(|((path, _), labels)| (*path, labels.as_slice())).collect();
        headings(&all)
    }

    #[test]
    fn labels_go_before_paths_and_paths_tell_equal_labels_apart() {
        assert_eq!(called(&[("control/joint1/scope", &[]), ("tool/x", &["Tool", "x"])]), ["joint1", "x"]);
        assert_eq!(
            called(&[("a/left", &["Speed"]), ("a/right", &["Speed"])]),
            ["Speed (left)", "Speed (right)"]
        );
        assert_eq!(called(&[("a", &["Speed"]), ("a", &["Speed"]), ("b", &[])]), ["Speed", "Speed", "b"]);
        assert!(called(&[]).is_empty());
    }
}
