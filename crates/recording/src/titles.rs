//! What scopes are called, from the labels of the diagram.

/// A heading for each list of labels (the outermost first): its last label, and as many before it as tell it from the other
/// lists. Equal lists have equal headings, an empty list has an empty one.
///
/// ```
/// let of = |labels: &[&str]| labels.iter().map(ToString::to_string).collect::<Vec<_>>();
/// let [a, b, c] = [of(&["Arm", "Speeds", "Axis 1"]), of(&["Arm", "Torques", "Axis 1"]), of(&["Arm", "Tool"])];
/// assert_eq!(blocksim_recording::titles(&[&a, &b, &c]), ["Speeds: Axis 1", "Torques: Axis 1", "Tool"]);
/// ```
pub fn titles(labels: &[&[String]]) -> Vec<String> {
    let heading = |own: &&[String]| {
        let ending = |n: usize| own[own.len() - n..].join(": ");
        let is_shared =
            |n: usize| labels.iter().any(|other| other != own && other.ends_with(&own[own.len() - n..]));
        (1..=own.len()).find(|&n| !is_shared(n)).map_or_else(|| own.join(": "), ending)
    };
    labels.iter().map(heading).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headings(lists: &[&[&str]]) -> Vec<String> {
        let owned: Vec<Vec<String>> =
            lists.iter().map(|list| list.iter().map(ToString::to_string).collect()).collect();
        titles(&owned.iter().map(Vec::as_slice).collect::<Vec<_>>())
    }

    #[test]
    fn a_heading_is_as_short_as_it_differs() {
        assert_eq!(headings(&[&["Speeds", "Axes 1 - 3"], &["Angles", "Axis 1"]]), ["Axes 1 - 3", "Axis 1"]);
        assert_eq!(headings(&[&["A", "x"], &["B", "x"], &["x"]]), ["A: x", "B: x", "x"]);
        assert_eq!(headings(&[&["A", "x"], &["A", "x"], &[]]), ["x", "x", ""]);
        assert!(headings(&[]).is_empty());
    }
}
