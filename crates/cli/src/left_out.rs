//! What a smaller program says of the parts that it was built without.

/// Why something cannot be done; `part` is what is missing.
pub fn reason(part: &str) -> String {
    format!("this blocksim was built without {part}")
}

/// The command that builds a program with this feature.
pub fn help(feature: &str) -> String {
    format!(
        "build it with `cargo build --release --features {feature}`, or with `--features full` for all of its parts"
    )
}

/// Both behind what was asked for: `cannot write ...`.
pub fn said(asked: &str, part: &str, feature: &str) -> String {
    format!("error: {asked}: {}\n  = help: {}", reason(part), help(feature))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_the_feature_and_the_command_are_named() {
        assert_eq!(
            said("cannot write `a.png`", "pictures as PNG", "png"),
            "error: cannot write `a.png`: this blocksim was built without pictures as PNG\n  = help: build it with `cargo \
             build --release --features png`, or with `--features full` for all of its parts"
        );
    }
}
