//! `blocksim plugin check`: whether the controllers of a plug-in keep the contract.

use std::collections::BTreeMap;
use std::path::Path;

use blocksim_block::ParamValue;
use blocksim_host::{Examined, Verdict, examine};
use blocksim_numbers::format::significant;
use serde_json::{Value, json};

use crate::args::plugin::PluginCheckArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::loaded::tell_builds;
use crate::terminal::console::Console;
use crate::trust::{isolate, limit_calls};

/// Examines a plug-in in processes of its own. It is built first; nothing is noted as trusted.
///
/// # Errors
/// Why it cannot be built or loaded.
pub fn check(args: &PluginCheckArgs, console: Console) -> Outcome {
    tell_builds();
    limit_calls(args.call_limit);
    isolate();
    let mut given: BTreeMap<String, ParamValue> = BTreeMap::new();
    given.extend(args.set.iter().cloned());
    let examined = examine(Path::new("."), &args.library, args.target.into(), args.block.as_deref(), &given)
        .map_err(|error| Failure::new(Exit::Files, error.code, error.message).perhaps_help(error.help))?;
    let text = |one: &Examined| if args.json { format!("{}\n", data(one, &args.library)) } else { text(one) };
    console.data(&examined.iter().map(text).collect::<Vec<_>>().join(if args.json { "" } else { "\n" }))?;
    Ok(if examined.iter().all(Examined::is_good) { Exit::Done } else { Exit::Failed })
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Passed => "passed",
        Verdict::Failed => "failed",
        Verdict::Skipped => "skipped",
    }
}

fn text(examined: &Examined) -> String {
    let mut text = format!("{}\n", examined.kind);
    for finding in &examined.findings {
        let line = format!("  {:8} {:11} {}", word(finding.verdict), finding.rule, finding.said);
        text += &format!("{}\n", line.trim_end());
    }
    if let Some((mean, longest)) = examined.times {
        let micro = |seconds: f64| significant(1e6 * seconds, 3);
        text += &format!("  {} us a step, {} us at most\n", micro(mean), micro(longest));
    }
    text
}

fn data(examined: &Examined, library: &str) -> Value {
    let finding = |finding: &blocksim_host::Finding| json!({"rule": finding.rule, "verdict": word(finding.verdict), "message": finding.said});
    json!({
        "v": 1,
        "type": "examined",
        "library": library,
        "kind": examined.kind,
        "good": examined.is_good(),
        "findings": examined.findings.iter().map(finding).collect::<Vec<_>>(),
        "mean_step_time": examined.times.map(|times| times.0),
        "longest_step_time": examined.times.map(|times| times.1),
    })
}
