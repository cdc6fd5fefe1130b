//! What a smaller program says of the parts that it was built without.

use crate::exit::Exit;
use crate::failure::Failure;

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
pub fn failure(asked: &str, part: &str, feature: &str) -> Failure {
    Failure::new(Exit::Files, "left_out", format!("{asked}: {}", reason(part))).help(help(feature))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_the_feature_and_the_command_are_named() {
        assert_eq!(
            failure("cannot write `a.png`", "pictures as PNG", "png").message(),
            "cannot write `a.png`: this blocksim was built without pictures as PNG"
        );
        assert_eq!(
            help("png"),
            "build it with `cargo build --release --features png`, or with `--features full` for all of its parts"
        );
    }
}
