//! Which rows are kept of the signals that `record` names.

use std::rc::Rc;

use blocksim_block::problem::Problem;
use blocksim_block::schedule::{Keep, OutputTimes, Recorded, Settings, Solver};
use serde::Deserialize;

use crate::ast::{Ast, RecordAst};
use crate::de::{Reading, Written};
use crate::flatten::record::matches;
use crate::problems::Problems;
use crate::scope::Scope;
use crate::settings::written::{Plain, Seconds};
use blocksim_syntax::{Name, Node};

/// Share of a spacing by which a multiple of it may be off.
const CLOSE: f64 = 1e-6;

/// The rate of each entry of `record`.
pub(crate) fn rates<'a>(
    ast: &Ast,
    scope: &Rc<Scope<'a>>,
    settings: &Settings,
    problems: &mut Problems,
) -> Vec<Keep> {
    let rate = |entry: &RecordAst| {
        let Some((word, node)) = &entry.rate else { return Keep::All };
        match read(ast, scope, settings, word, node) {
            Ok(keep) => keep,
            Err(problem) => {
                problems.push(problem);
                Keep::All
            }
        }
    };
    ast.record.iter().map(rate).collect()
}

fn read<'a>(
    ast: &Ast,
    scope: &Rc<Scope<'a>>,
    settings: &Settings,
    word: &Name,
    node: &Node,
) -> Result<Keep, Problem> {
    let place = ast.place(&node.span);
    let refuse = |message: String, label: &str, help: &str| {
        Problem::error("record_rate", message).at(&place, label).help(help)
    };
    let reading = Reading::new(scope.clone(), ast.file, None);
    let number = match word.text.as_str() {
        "rows" => Plain::deserialize(Written::new(&reading, node)).map(|rows| rows.0),
        _ => Seconds::deserialize(Written::new(&reading, node)).map(|time| time.0),
    };
    let number = number.map_err(|noted| reading.problem(noted, &place))?;
    if word.text == "rows" {
        let whole = number.fract() == 0.0 && (1.0..=f64::from(u32::MAX)).contains(&number);
        let message = format!("`rows` is {number}, but must be a whole number of at least 1");
        return if whole {
            Ok(Keep::Rows(number as u32))
        } else {
            Err(refuse(message, "no number of rows", "`rows: 10` keeps every tenth row"))
        };
    }
    if !(number.is_finite() && number > 0.0) {
        let message = format!("`{}` is {number} s, but must be positive", word.text);
        return Err(refuse(message, "no time", "`every: \"10 ms\"` keeps a row of each 10 ms"));
    }
    if word.text == "minmax" {
        return Ok(Keep::Extremes(number));
    }
    match off_grid(number, settings) {
        Some((spacing, what)) => {
            let near = (number / spacing).round().max(1.0);
            let message = format!(
                "`every` is {} ms, which is not a multiple of the {what}, {} ms",
                ms(number),
                ms(spacing)
            );
            let help = format!("write `every: \"{} ms\"`, or change the {what}", ms(near * spacing));
            Err(refuse(message, "falls between the rows", &help))
        }
        None => Ok(Keep::Every(number)),
    }
}

fn ms(seconds: f64) -> f64 {
    // What conversion has added behind the ninth digit is not shown.
    (seconds * 1e12).round() / 1e9
}

/// The spacing of the rows of a run and what sets it, if `time` is no multiple of it. Without an even spacing all times are
/// as good.
pub fn off_grid(time: f64, settings: &Settings) -> Option<(f64, &'static str)> {
    let (spacing, what) = match (settings.output, settings.solver) {
        (OutputTimes::Every(spacing), _) => (spacing, "output interval"),
        (OutputTimes::Steps, Solver::Fixed { step, .. }) => (step, "step"),
        _ => return None,
    };
    let ratio = time / spacing;
    ((ratio - ratio.round()).abs() > CLOSE * ratio || ratio < 0.5).then_some((spacing, what))
}

/// Gives each recorded signal the rate of the last entry with a pattern that matches it.
pub(crate) fn assign(ast: &Ast, rates: &[Keep], recorded: &mut [Recorded]) {
    for signal in recorded {
        // Patterns name signals, not elements of vectors.
        let name = match signal.path.rsplit_once('[') {
            Some((name, _)) if signal.path.ends_with(']') => name,
            _ => signal.path.as_str(),
        };
        let fits = |entry: &RecordAst| entry.signals.iter().any(|pattern| matches(&pattern.text, name));
        let mut entries = ast.record.iter().zip(rates).rev();
        if let Some((_, rate)) = entries.find(|(entry, _)| fits(entry)) {
            signal.keep = *rate;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ast::parse;
    use crate::settings::settings;
    use crate::source::Sources;
    use crate::toys::{NoFiles, messages};
    use blocksim_block::problem::FileId;
    use blocksim_syntax::read as read_tree;

    /// Rates and messages of `record: [...]` with these settings.
    fn read_rates(simulation: &str, record: &str) -> (Vec<Keep>, String) {
        let text = format!("Diagram(simulation: {simulation}, record: {record})");
        let root = read_tree(&text).expect("RON");
        let mut problems = Problems::default();
        let ast = parse(FileId(0), &root, &mut problems).expect("a diagram");
        let sources = Sources::new(&NoFiles);
        let scope = Rc::new(Scope::new(&sources, None));
        let settings = settings(&ast, &scope, None, false, &mut problems);
        let rates = rates(&ast, &scope, &settings, &mut problems);
        (rates, messages(&problems).join("; "))
    }

    #[test]
    fn every_form_of_a_rate_is_read() {
        let record = r#"["a", (signals: "b", every: "2 * 5 ms"), (signals: ["c", "d"], rows: 10), (signals: "e", minmax: 0.1)]"#;
        let wanted = vec![Keep::All, Keep::Every(0.01), Keep::Rows(10), Keep::Extremes(0.1)];
        assert_eq!(read_rates("(solver: Ode4(step: \"1 ms\"))", record), (wanted, String::new()));
    }

    #[test]
    fn a_rate_that_cannot_be_is_told() {
        let message = |record: &str| read_rates("(output: Every(\"4 ms\"))", record).1;
        for (record, told) in [
            (
                r#"[(signals: "a", every: "10 ms")]"#,
                "`every` is 10 ms, which is not a multiple of the output interval, 4 ms",
            ),
            (
                r#"[(signals: "a", every: "1 ms")]"#,
                "`every` is 1 ms, which is not a multiple of the output interval, 4 ms",
            ),
            (r#"[(signals: "a", every: -1)]"#, "`every` is -1 s, but must be positive"),
            (r#"[(signals: "a", every: "1 m")]"#, "expected a value in s, found one in m"),
            (r#"[(signals: "a", minmax: 0)]"#, "`minmax` is 0 s, but must be positive"),
            (r#"[(signals: "a", rows: 2.5)]"#, "`rows` is 2.5, but must be a whole number of at least 1"),
            (r#"[(signals: "a", rows: 0)]"#, "`rows` is 0, but must be a whole number of at least 1"),
            (r#"[(signals: "a", rows: 2, minmax: 1)]"#, "`rows` and `minmax` contradict each other"),
            (r#"[(every: "8 ms")]"#, "an entry of `record` names no signals"),
            (r#"[(signals: "a", evry: 1)]"#, "`record` knows no `evry`"),
            (r#"[(signals: 3)]"#, "expected a text, found a number"),
            (r#"[3]"#, "found a number"),
            (r#""a""#, "expected a list of patterns, found a text"),
        ] {
            let all = message(record);
            assert!(all.contains(told), "{record}: {all}");
        }
    }

    #[test]
    fn times_are_as_good_as_any_where_rows_are_not_evenly_spaced() {
        assert_eq!(read_rates("()", r#"[(signals: "a", every: "7.3 ms")]"#).1, "");
        assert_eq!(read_rates("(output: Every(0.1))", r#"[(signals: "a", every: 0.3)]"#).1, "");
    }
}
