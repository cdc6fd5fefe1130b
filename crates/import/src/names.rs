//! Names of files of all kinds as names of blocks and parameters.

use std::collections::BTreeSet;

/// Gives names of blocks: letters, digits and `_`, each once.
#[derive(Debug, Clone)]
pub(crate) struct Names(BTreeSet<String>);

impl Names {
    /// No name given yet, but those taken by the diagram itself.
    pub fn new(taken: &[&str]) -> Names {
        Names(taken.iter().map(ToString::to_string).collect())
    }

    /// A name like `original` that nothing else has: `joint 6-flange` becomes `joint_6_flange`, a second one
    /// `joint_6_flange_2`.
    pub fn give(&mut self, original: &str) -> String {
        self.give_with(original, &[])
    }

    /// Takes names that others have given.
    pub fn take(&mut self, names: impl Iterator<Item = String>) {
        self.0.extend(names);
    }

    /// The same for a joint, whose transforms are called after it.
    pub fn give_joint(&mut self, original: &str) -> String {
        self.give_with(original, &["_seat", "_end"])
    }

    fn give_with(&mut self, original: &str, endings: &[&str]) -> String {
        let plain = plain(original);
        let free = |name: &String| {
            !self.0.contains(name) && endings.iter().all(|end| !self.0.contains(&format!("{name}{end}")))
        };
        let numbered = (2_u32..).map(|n| format!("{plain}_{n}"));
        // Some number is always free.
        let name = std::iter::once(plain.clone()).chain(numbered).find(free).unwrap_or_default();
        self.0.extend(endings.iter().map(|end| format!("{name}{end}")));
        self.0.insert(name.clone());
        name
    }
}

/// A name for files that are made of `original`: letters, digits and `_`, not too long.
pub fn file_name(original: &str) -> String {
    const LONGEST: usize = 80;
    plain(original).chars().take(LONGEST).collect()
}

/// Letters, digits and `_`, a letter first.
pub(crate) fn plain(original: &str) -> String {
    let mut name = String::new();
    for sign in original.chars() {
        match sign {
            'a'..='z' | 'A'..='Z' | '0'..='9' => name.push(sign),
            _ if name.ends_with('_') => {}
            _ => name.push('_'),
        }
    }
    let name = name.trim_matches('_');
    match name.chars().next() {
        Some(first) if first.is_ascii_alphabetic() && name != "in" => name.to_owned(),
        Some(_) => format!("n_{name}"),
        None => "unnamed".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_other_programs_become_names_of_blocks() {
        for (original, expected) in [
            ("link_1", "link_1"),
            ("joint_6-flange", "joint_6_flange"),
            ("Servo Motor Micro  9g_1 <4>", "Servo_Motor_Micro_9g_1_4"),
            ("55mm_paddle", "n_55mm_paddle"),
            ("Gövde-1", "G_vde_1"),
            ("in", "n_in"),
            ("世界", "unnamed"),
        ] {
            assert_eq!(plain(original), expected);
        }
    }

    #[test]
    fn a_name_is_given_once() {
        let mut names = Names::new(&["world"]);
        assert_eq!(names.give("j_seat"), "j_seat");
        assert_eq!([names.give_joint("j"), names.give("j_2_end")], ["j_2", "j_2_end_2"]);
        assert_eq!(
            ["a-b", "a b", "a_b", "world"].map(|n| names.give(n)),
            ["a_b", "a_b_2", "a_b_3", "world_2"]
        );
    }
}
