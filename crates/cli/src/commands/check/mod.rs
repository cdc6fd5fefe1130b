mod fix;
mod panel;

use blocksim_block::schedule::Schedule;
use blocksim_diagram::Options;
use blocksim_numbers::format::count;
use serde_json::json;

use super::tell_with;
use crate::args::model::{CheckArgs, Format};
use crate::exit::Exit;
use crate::failure::Outcome;
use crate::loaded::load_with;
use crate::terminal::console::Console;
use crate::terminal::render;
use crate::trust::Purpose;

/// Tells all problems of a model; without errors, what it consists of in one line.
///
/// # Errors
/// If the model cannot be read, or mended.
pub fn check(args: &CheckArgs, console: Console) -> Outcome {
    if args.fix {
        fix::fix(args, console)?;
    }
    let units = args.units.into();
    let loaded = load_with(&args.model, Purpose::Look, &Options { units, ..Options::default() })?;
    let mut problems = loaded.compiled.problems.clone();
    problems.extend(panel::warnings(&args.model, &loaded));
    let problems = &problems;
    let exit = if loaded.compiled.schedule.is_some() { Exit::Done } else { Exit::Model };
    tell_with(problems, &loaded.files, (exit != Exit::Done).then_some(exit), console)?;
    let said = format!("{}: {}", args.model.model.display(), render::tally(problems));
    match (&loaded.compiled.schedule, args.output_format) {
        (Some(schedule), Format::Json) => console.data(&format!("{}\n", counts(schedule)))?,
        (Some(schedule), _) => console.data(&format!("{said}; {}\n", size(schedule)))?,
        (None, Format::Json) => {}
        (None, _) => console.say(&said),
    }
    if let Some(understood) = loaded.understood() {
        console.say(&understood);
    }
    let remedies = problems.iter().filter(|problem| problem.remedy().is_some()).count();
    if remedies > 0 && !args.fix && args.output_format == Format::Full {
        let which = if problems.len() == 1 { "it".to_owned() } else { format!("{remedies} of them") };
        console.say(&format!("  = help: `--fix` fixes {which}"));
    }
    Ok(exit)
}

/// `17 blocks, 44 signals, 12 states, sample times 1 ms and 10 ms`.
pub fn size(schedule: &Schedule) -> String {
    let n = |n: usize, name: &str| format!("{} {name}{}", count(n as u64), if n == 1 { "" } else { "s" });
    let parts = [
        n(schedule.blocks.len(), "block"),
        n(schedule.signals.len(), "signal"),
        n(schedule.states, "continuous state"),
        n(schedule.discrete, "discrete state"),
    ];
    let periods: Vec<String> = periods(schedule).iter().map(|period| short_time(*period)).collect();
    let sampled = match periods.as_slice() {
        [] => "continuous".to_owned(),
        [only] => format!("sample time {only}"),
        [all @ .., last] => format!("sample times {} and {last}", all.join(", ")),
    };
    format!("{}, {sampled}", parts.join(", "))
}

fn counts(schedule: &Schedule) -> serde_json::Value {
    json!({
        "v": 1,
        "type": "model",
        "title": schedule.title,
        "blocks": schedule.blocks.len(),
        "signals": schedule.signals.len(),
        "states": schedule.states,
        "discrete": schedule.discrete,
        "sample_times": periods(schedule),
    })
}

/// Sample times, s, fastest first, each once.
fn periods(schedule: &Schedule) -> Vec<f64> {
    let clock = &schedule.clock;
    let mut periods: Vec<f64> = clock.rates.iter().map(|rate| clock.time(rate.period)).collect();
    periods.dedup();
    periods
}

/// `1 ms`, `2 s`, `50 us`.
fn short_time(seconds: f64) -> String {
    let (factor, unit) = match seconds {
        s if s >= 1.0 => (1.0, "s"),
        s if s >= 1e-3 => (1e3, "ms"),
        _ => (1e6, "us"),
    };
    // Six decimals hide the rounding of the product.
    let number = format!("{:.6}", seconds * factor);
    format!("{} {unit}", number.trim_end_matches('0').trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_times_are_short() {
        let all = [0.001, 2.0, 0.01, 50e-6, 1.0 / 3.0, 0.1].map(short_time);
        assert_eq!(all, ["1 ms", "2 s", "10 ms", "50 us", "333.333333 ms", "100 ms"]);
    }
}
