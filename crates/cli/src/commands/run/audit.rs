//! What an audit of a run has found, in words.

use blocksim_sim::{Findings, Undeclared};

use crate::terminal::format::short_time;
use crate::terminal::render::plural;

/// Changes that are listed.
const LISTED: usize = 20;

/// The findings as a note, or as an error if anything was passed over.
pub fn text(findings: &Findings) -> String {
    let mut texts = vec![of_conditions(findings)];
    if !findings.undeclared.is_empty() {
        texts.push(of_dependencies(&findings.undeclared));
    }
    texts.join("\n")
}

/// Derivatives that depend on more than blocks say, as an error.
fn of_dependencies(undeclared: &[Undeclared]) -> String {
    let count = plural(undeclared.len(), "time");
    let mut text = format!(
        "error: a derivative depends on a state although no block between them declares that, {count}"
    );
    for pair in undeclared.iter().take(LISTED) {
        text += &format!("\n  = note: the derivative of `{}` depends on `{}`", pair.derivative, pair.state);
    }
    if undeclared.len() > LISTED {
        text += &format!("\n  = note: and {} more", undeclared.len() - LISTED);
    }
    text + "\n  = help: a block between them reads an input of now that it declares to be without feedthrough; results are not to be trusted until it declares that"
}

fn of_conditions(findings: &Findings) -> String {
    let looks = plural(usize::try_from(findings.looks).unwrap_or(usize::MAX), "point");
    if findings.looks == 0 {
        return "note: audited: the model has no condition that could change within a step".to_owned();
    }
    if findings.count == 0 {
        return format!("note: audited at {looks} within steps: no change of a condition was passed over");
    }
    let count = plural(usize::try_from(findings.count).unwrap_or(usize::MAX), "change");
    let mut text =
        format!("error: the run has passed over {count} of a condition, seen at {looks} within steps");
    for missed in findings.missed.iter().take(LISTED) {
        let (t, path, what) = (short_time(missed.t), &missed.path, &missed.what);
        text += &format!(
            "\n  = note: t = {t} s: where `{path}` {what}, the condition was beyond zero by {:.3e}",
            missed.beyond
        );
    }
    if findings.missed.len() > LISTED || findings.count > LISTED as u64 {
        text += &format!("\n  = note: and {} more", findings.count - LISTED as u64);
    }
    text + "\n  = help: limit the steps, for example with `--step 1ms`, or use a smaller `--rtol`"
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_sim::Missed;

    #[test]
    fn what_was_passed_over_is_listed_with_time_block_and_remedy() {
        let missed = |t| Missed {
            t,
            path: "relay".to_owned(),
            what: "switches on and switches off".to_owned(),
            beyond: 0.125,
        };
        let findings = Findings {
            looks: 640,
            count: 30,
            missed: (0..30).map(|k| missed(f64::from(k))).collect(),
            ..Findings::default()
        };
        let text = text(&findings);
        assert!(
            text.starts_with("error: the run has passed over 30 changes of a condition, seen at 640 points")
        );
        assert!(
            text.contains(
                "where `relay` switches on and switches off, the condition was beyond zero by 1.250e-1"
            ),
            "{text}"
        );
        assert!(text.contains("and 10 more") && text.contains("--step 1ms"), "{text}");
    }

    #[test]
    fn a_dependency_that_no_block_declares_is_an_error() {
        let pair = Undeclared { derivative: "tank.x".to_owned(), state: "valve.x".to_owned() };
        let text = text(&Findings { looks: 1, undeclared: vec![pair], ..Findings::default() });
        let (first, rest) = text.split_once('\n').unwrap();
        assert!(first.starts_with("note: audited at 1 point"), "{first}");
        assert!(rest.starts_with("error: ") && rest.contains("`tank.x` depends on `valve.x`"), "{rest}");
        assert!(rest.contains("without feedthrough"), "{rest}");
    }

    #[test]
    fn an_audit_without_findings_is_a_note() {
        let text = text(&Findings { looks: 1, ..Findings::default() });
        assert_eq!(text, "note: audited at 1 point within steps: no change of a condition was passed over");
    }
}
