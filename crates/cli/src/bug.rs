//! What is said when the program itself is wrong.

use std::io::Write;
use std::panic;

/// Lets a panic say that it is a bug and what to do; Rust then ends the program with 101.
pub fn report_panics() {
    panic::set_hook(Box::new(|info| {
        let payload = info.payload();
        let text = payload.downcast_ref::<String>().map(String::as_str);
        let what = text.or(payload.downcast_ref::<&str>().copied()).unwrap_or("no message");
        let place = info.location().map_or_else(|| "an unknown place".to_owned(), ToString::to_string);
        let _ = std::io::stderr().write_all(message(what, &place).as_bytes());
    }));
}

fn message(what: &str, place: &str) -> String {
    format!(
        "\nThis is a bug in blocksim {}, not in your model.\n  {what}\n  at {place}\n\
         Please report it with these lines, the command and, if you may share it, the model.\n",
        env!("CARGO_PKG_VERSION")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bug_is_called_a_bug_and_says_where_it_is() {
        let text = message("index out of bounds", "crates/sim/src/plan.rs:7:3");
        assert!(text.contains("bug in blocksim"));
        assert!(text.contains("index out of bounds\n  at crates/sim/src/plan.rs:7:3\nPlease report it"));
    }
}
