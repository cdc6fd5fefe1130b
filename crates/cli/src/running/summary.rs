//! What a run was, in a few lines.

use blocksim_numbers::format::{count, duration, significant, simulated};
use blocksim_recording::{Choice, Ended, Manifest};
use blocksim_sim::{Counts, Share};
use blocksim_terminal::{Align, Table};

use crate::running::solver;
use crate::terminal::render::plural;

/// Title, times, start, solver, work, events and what was recorded; `began` is the steady state in which the run began, `place`
/// where the results lie.
#[allow(clippy::too_many_arguments)]
pub fn summary(
    title: &str,
    manifest: &Manifest,
    began: Option<&str>,
    counts: &Counts,
    events: &[String],
    signals: usize,
    rows: u64,
    place: Option<&str>,
) -> String {
    let mut table = Table::new(&[("", Align::Left), ("", Align::Left)]);
    let factor = manifest.simulated_time / manifest.wall_time;
    let speed = match factor.is_finite() && factor > 0.0 {
        true => format!(" ({} times real time)", times(factor)),
        false => String::new(),
    };
    let simulated = format!("{} in {}{speed}", simulated(manifest.simulated_time), short(manifest.wall_time));
    let n = |n: u64, name: &str| format!("{} {name}{}", count(n), if n == 1 { "" } else { "s" });
    table.row(["simulated", &simulated]);
    match &manifest.ended {
        Ended::Complete | Ended::Unfinished => {}
        Ended::Interrupted => table.row(["ended", "interrupted before its end"]),
        Ended::Stopped { reason } => table.row(["ended", reason]),
        Ended::Failed { reason } => table.row(["failed", reason]),
    }
    if !manifest.overrides.is_empty() {
        let set = manifest.overrides.iter().map(|over| format!("{} = {}", over.path, over.value));
        table.row(["set", &set.collect::<Vec<_>>().join(", ")]);
    }
    if !manifest.variants.is_empty() {
        table.row(["variants", &variants(&manifest.variants)]);
    }
    if let Some(began) = began {
        table.row(["start", began]);
    }
    table.row(["solver", &solver::described(&manifest.solver)]);
    let rejected = format!("{} rejected", count(counts.rejected));
    let evaluations = n(counts.evaluations, "evaluation");
    table.row(["work", &[n(counts.accepted, "step"), rejected, evaluations].join(", ")]);
    if let Some(share) = &counts.share {
        table.row(["method", &chosen(share, counts.accepted)]);
    } else if 2 * counts.limited > counts.accepted && counts.limited >= FEW {
        table.row(["method", &limited(counts)]);
    }
    table.row(["events", &[n(counts.events, "zero crossing"), n(counts.hits, "sample hit")].join(", ")]);
    for line in events {
        table.row(["", line]);
    }
    let recorded = match signals {
        0 => "nothing; add a Scope, or `record: [\"...\"]` to the diagram".to_owned(),
        _ => format!("{}, {}", plural(signals, "signal"), n(rows, "row")),
    };
    table.row(["recorded", &recorded]);
    if let Some(place) = place {
        table.row(["results", place]);
    }
    format!("{title}\n{}", table.render())
}

/// Which of its two methods `Auto` has used, and why.
fn chosen(share: &Share, steps: u64) -> String {
    match share.first {
        Some(first) => format!(
            "Ode15s for {} of {}, first at {}: stability limited those of Ode45",
            count(share.stiff),
            plural(steps as usize, "step"),
            simulated(first)
        ),
        None => "Ode45: nothing was stiff".to_owned(),
    }
}

/// Steps below which their limit does not matter to anybody.
const FEW: u64 = 200;

/// Why an explicit method makes more steps than it should.
fn limited(counts: &Counts) -> String {
    format!(
        "stability limits {} of {} steps, not the tolerance: a stiff method takes fewer, `--solver auto` finds out where",
        count(counts.limited),
        count(counts.accepted)
    )
}

/// How often each alternative of the variants of one name was chosen: `motor: 5 asm, 1 dc`.
fn variants(choices: &[Choice]) -> String {
    let mut of_name: Vec<(&str, Vec<(&str, usize)>)> = Vec::new();
    for Choice { variant, choice } in choices {
        let name = variant.rsplit('/').next().unwrap_or(variant);
        let at = of_name.iter().position(|(known, _)| *known == name).unwrap_or_else(|| {
            of_name.push((name, Vec::new()));
            of_name.len() - 1
        });
        let chosen = &mut of_name[at].1;
        match chosen.iter_mut().find(|(known, _)| known == choice) {
            Some((_, n)) => *n += 1,
            None => chosen.push((choice, 1)),
        }
    }
    let told = |(name, chosen): &(&str, Vec<(&str, usize)>)| match chosen.as_slice() {
        [(only, 1)] => format!("{name}: {only}"),
        all => {
            let counted: Vec<String> = all.iter().map(|(choice, n)| format!("{n} {choice}")).collect();
            format!("{name}: {}", counted.join(", "))
        }
    };
    of_name.iter().map(told).collect::<Vec<_>>().join("; ")
}

/// A factor with three significant digits.
fn times(factor: f64) -> String {
    if factor < 1e4 {
        return significant(factor, 3);
    }
    let last = 10_f64.powf(factor.log10().floor() - 2.0).round();
    count(((factor / last).round() * last) as u64)
}

/// A duration on the clock on the wall; milliseconds below a tenth of a second.
pub fn short(seconds: f64) -> String {
    if seconds < 0.1 { format!("{} ms", significant(seconds * 1e3, 2)) } else { duration(seconds) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_recording::{FileUsed, Program, SolverUsed};
    use expect_test::expect;

    fn manifest(ended: Ended) -> Manifest {
        Manifest {
            schema: Manifest::SCHEMA,
            program: Program { name: "blocksim".into(), version: "0.1.0".into() },
            model: FileUsed { path: "servo.ron".into(), hash: String::new() },
            files: Vec::new(),
            overrides: Vec::new(),
            variants: Vec::new(),
            solver: SolverUsed { name: "RosW3".into(), rtol: Some(1e-6), atol: Some(1e-6), step: None },
            recorded: None,
            started: "2026-11-21T14:03:22Z".into(),
            wall_time: 0.42,
            simulated_time: 1.724,
            counts: blocksim_recording::Counts::default(),
            ended,
        }
    }

    #[test]
    fn a_summary_reads_like_this() {
        let counts = Counts {
            major: 4183,
            accepted: 4000,
            rejected: 96,
            evaluations: 25_674,
            events: 1,
            hits: 1724,
            limited: 0,
            share: None,
        };
        let folder = "runs/2026-11-21T14-03-22_servo";
        expect![[r#"
            Servo
            simulated  1.724 s in 0.42 s (4.10 times real time)
            solver     RosW3, rtol 1e-6, atol 1e-6
            work       4 000 steps, 96 rejected, 25 674 evaluations
            events     1 zero crossing, 1 724 sample hits
            recorded   84 signals, 1 725 rows
            results    runs/2026-11-21T14-03-22_servo
        "#]]
        .assert_eq(&summary("Servo", &manifest(Ended::Complete), None, &counts, &[], 84, 1725, Some(folder)));
    }

    #[test]
    fn the_method_that_was_chosen_is_told_with_the_reason() {
        let share = Share { stiff: 472, changes: 1, first: Some(0.03) };
        let told = chosen(&share, 719);
        assert_eq!(told, "Ode15s for 472 of 719 steps, first at 0.030 s: stability limited those of Ode45");
        assert_eq!(chosen(&Share::default(), 719), "Ode45: nothing was stiff");
    }

    #[test]
    fn an_explicit_method_that_stability_limits_is_told() {
        let counts = Counts { accepted: 302_094, limited: 301_000, ..Counts::default() };
        let said = summary("Rod", &manifest(Ended::Complete), None, &counts, &[], 1, 2, None);
        assert!(said.contains(
            "method     stability limits 301 000 of 302 094 steps, not the tolerance: a stiff method takes fewer, \
             `--solver auto` finds out where"
        ), "{said}");
        let counts = Counts { accepted: 4000, limited: 1000, ..Counts::default() };
        assert!(
            !summary("Rod", &manifest(Ended::Complete), None, &counts, &[], 1, 2, None).contains("method")
        );
    }

    #[test]
    fn great_speed_is_told_without_exponents() {
        assert_eq!(
            [4.1, 139_123.0, 9_999.0, 12_345_678.0].map(times),
            ["4.10", "139 000", "9999", "12 300 000"]
        );
    }

    #[test]
    fn variants_are_counted_by_name() {
        let choice = |variant: &str, choice: &str| Choice { variant: variant.into(), choice: choice.into() };
        let three = [
            choice("arm/link1/motor", "asm"),
            choice("arm/link2/motor", "dc"),
            choice("arm/link3/motor", "asm"),
        ];
        assert_eq!(variants(&three), "motor: 2 asm, 1 dc");
        assert_eq!(variants(&[choice("drive", "dc"), choice("a/plan", "b")]), "drive: dc; plan: b");
    }

    #[test]
    fn a_failure_and_an_empty_recording_are_said() {
        let ended = Ended::Failed { reason: "step size below 1e-12 s".into() };
        let text = summary(
            "Servo",
            &manifest(ended),
            Some("in a steady state"),
            &Counts::default(),
            &[],
            0,
            1,
            None,
        );
        assert!(text.contains("failed     step size below 1e-12 s\n"), "{text}");
        assert!(text.contains("\nstart      in a steady state\n"), "{text}");
        assert!(text.contains("recorded   nothing; add a Scope"), "{text}");
    }
}
