//! What a run looks like in the terminal.

use blocksim_analysis::with_gaps;
use blocksim_results::format::with_unit;
use blocksim_results::{Align, Kind, PlotOptions, Series, Table, plot, sparkline};

use crate::signals::naming::{fits, short_names};
use crate::signals::shown::{Shown, turn};
use crate::signals::tracking::Tracking;
use crate::terminal::console::Console;

/// Most series in one plot.
const SERIES: usize = 8;
/// Most plots for one question.
const PLOTS: usize = 6;
/// Most lines of signals that nobody asked for.
const LINES: usize = 12;
/// Columns of a sparkline.
const SPARKS: usize = 40;

/// A plot of the scope with the largest motion, of those in the unit of the first one, and a line for each of the others.
/// An element of a vector comes into question only where there is nothing else.
pub fn following(trackings: &[Tracking], time: &[f64], console: Console) -> String {
    let motion = |tracking: &Tracking| range(tracking.set.si).map_or(0.0, |(low, high)| high - low);
    let is_like_first = |tracking: &Tracking| tracking.set.unit.text == trackings[0].set.unit.text;
    let rank =
        |tracking: &Tracking| (is_like_first(tracking), !tracking.set.port().contains('['), motion(tracking));
    let order = |a: &Tracking, b: &Tracking| {
        let (a, b) = (rank(a), rank(b));
        (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2))
    };
    let largest = trackings.iter().enumerate().rev().max_by(|a, b| order(a.1, b.1));
    let Some((largest, tracking)) = largest else { return String::new() };
    let title = if trackings.len() == 1 { tracking.scope } else { tracking.name.as_str() };
    let mut text = drawn(title, &[tracking.set, tracking.actual], &["set", "actual"], time, console);
    let rest: Vec<(&str, &Shown)> = trackings
        .iter()
        .enumerate()
        .filter(|&(n, _)| n != largest)
        .map(|(_, tracking)| (tracking.name.as_str(), tracking.actual))
        .collect();
    if !rest.is_empty() {
        text.push('\n');
        text.push_str(&sparks(&rest, console));
    }
    text
}

/// Plots of all signals that fit one of the patterns, one plot for each unit; `None` if nothing fits.
pub fn chosen(patterns: &[String], shown: &[Shown], time: &[f64], console: Console) -> Option<String> {
    let wanted = |s: &&Shown| patterns.iter().any(|pattern| fits(s.path, pattern));
    let found: Vec<&Shown> = shown.iter().filter(wanted).collect();
    if found.is_empty() { None } else { Some(by_unit("", &found, time, console)) }
}

/// Plots of all inputs of one block, and a line for each other signal.
pub fn block(path: &str, shown: &[Shown], time: &[f64], console: Console) -> String {
    let (found, rest): (Vec<&Shown>, Vec<&Shown>) = shown.iter().partition(|s| s.block() == path);
    let mut text = by_unit(path, &found, time, console);
    let lines: Vec<(&str, &Shown)> = rest.iter().take(LINES).map(|s| (s.path, *s)).collect();
    if !lines.is_empty() {
        text.push('\n');
        text.push_str(&sparks(&lines, console));
    }
    if rest.len() > LINES {
        text.push_str(&format!("and {} more signals\n", rest.len() - LINES));
    }
    text
}

/// One plot for each unit, as many series as a plot can take.
fn by_unit(title: &str, shown: &[&Shown], time: &[f64], console: Console) -> String {
    let mut units: Vec<&str> = Vec::new();
    for s in shown {
        if !units.contains(&s.unit.text.as_str()) {
            units.push(&s.unit.text);
        }
    }
    let of_unit = |unit: &str| shown.iter().copied().filter(|s| s.unit.text == unit).collect::<Vec<_>>();
    let groups: Vec<Vec<&Shown>> = units
        .iter()
        .flat_map(|unit| of_unit(unit).chunks(SERIES).map(<[&Shown]>::to_vec).collect::<Vec<_>>())
        .collect();
    let plots = groups.iter().take(PLOTS).map(|group| {
        let names: Vec<&str> = if title.is_empty() {
            group.iter().map(|s| s.path).collect()
        } else {
            group.iter().map(|s| s.port()).collect()
        };
        let names = if title.is_empty() { short_names(&names) } else { names };
        drawn(title, group, &names, time, console)
    });
    let mut text = plots.collect::<Vec<_>>().join("\n");
    if groups.len() > PLOTS {
        let left: usize = groups[PLOTS..].iter().map(Vec::len).sum();
        text.push_str(&format!("\n{left} more signals fit and are not drawn\n"));
    }
    text
}

fn drawn(title: &str, shown: &[&Shown], names: &[&str], time: &[f64], console: Console) -> String {
    let line = |s: &&Shown| {
        let values = s.values();
        let broken = turn(&s.unit).and_then(|turn| with_gaps(time, &values, turn));
        broken.unwrap_or_else(|| (time.to_vec(), values))
    };
    let lines: Vec<(Vec<f64>, Vec<f64>)> = shown.iter().map(line).collect();
    let unit = shown.first().map_or("1", |s| s.unit.text.as_str());
    let series: Vec<Series> = shown
        .iter()
        .zip(names)
        .zip(&lines)
        .map(|((s, name), (x, y))| Series { name, x, y, step: s.kind != Kind::Real })
        .collect();
    let heading = match (title, unit) {
        (title, "1") => title.to_owned(),
        ("", unit) => format!("[{unit}]"),
        (title, unit) => format!("{title} [{unit}]"),
    };
    let (width, ascii) = (console.width, console.ascii);
    plot(&series, &PlotOptions { title: &heading, width, height: 12, ascii, ..PlotOptions::default() })
}

/// A line for each signal: its course and the range of its values.
fn sparks(shown: &[(&str, &Shown)], console: Console) -> String {
    let mut table = Table::new(&[
        ("", Align::Left),
        ("", Align::Left),
        ("", Align::Right),
        ("", Align::Left),
        ("", Align::Right),
    ]);
    for (name, s) in shown {
        let values = s.values();
        let unit = s.unit.text.as_str();
        let course = if console.ascii { String::new() } else { sparkline(&values, SPARKS) };
        let (low, high) = range(&values).unwrap_or((f64::NAN, f64::NAN));
        let low = with_unit(low, unit);
        let low = low.strip_suffix(&format!(" {unit}")).unwrap_or(&low).to_owned();
        table.row([(*name).to_owned(), course, low, "to".to_owned(), with_unit(high, unit)]);
    }
    table.render()
}

/// Least and largest finite value.
fn range(values: &[f64]) -> Option<(f64, f64)> {
    let finite = || values.iter().copied().filter(|x| x.is_finite());
    let low = finite().fold(f64::INFINITY, f64::min);
    (low < f64::INFINITY).then(|| (low, finite().fold(f64::NEG_INFINITY, f64::max)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::model::Format;
    use crate::signals::shown::{shown, tests::example};
    use crate::signals::tracking::trackings;
    use expect_test::expect;

    const CONSOLE: Console =
        Console { colour: false, live: false, width: 60, ascii: false, format: Format::Full };

    fn ramp(end: f64) -> Vec<f64> {
        (0..41).map(|k| end * f64::from(k) / 40.0).collect()
    }

    #[test]
    fn the_largest_motion_is_plotted_and_the_others_are_lines() {
        let (recorded, recording) = example(vec![
            ("control/joint1/scope.set", "rad", "deg", ramp(0.5)),
            ("control/joint1/scope.actual", "rad", "deg", ramp(0.5)),
            ("control/joint2/scope.set", "rad", "deg", ramp(-1.0)),
            ("control/joint2/scope.actual", "rad", "deg", ramp(-0.9)),
        ]);
        let shown = shown(&recorded, &recording);
        expect![[r#"
            joint2 [deg]
                0 ┤⠑⠢⢄⣀
                  │    ⠉⠲⣤⣀
              -10 ┤       ⠉⠛⠶⣤⣀⡀
                  │           ⠉⠙⠳⡢⢄⡀
              -20 ┤              ⠈⠑⠪⢕⡢⢄⣀
                  │                  ⠈⠑⠒⠭⡒⠤⣀
              -30 ┤                      ⠈⠒⠤⣉⠒⠤⣀
              -40 ┤                          ⠉⠒⠤⣉⠑⠢⢄⡀
                  │                              ⠉⠢⢄⡈⠑⠢⢄⣀
              -50 ┤                                 ⠈⠑⠢⢄⣀⠉⠒⠤⣀
                  │                                      ⠉⠢⣀ ⠉  actual
              -60 ┤                                         ⠉⠒  set
                  └┬──────────┬─────────┬──────────┬─────────┬
                   0         10        20         30        40  time [s]

            joint1  ▁▁▁▁▁▂▂▂▂▂▃▃▃▃▃▄▄▄▄▄▅▅▅▅▅▆▆▆▆▆▇▇▇▇▇█████  0.00  to  28.65 deg
        "#]]
        .assert_eq(&following(&trackings(&shown), &recording.time, CONSOLE));
    }

    #[test]
    fn chosen_signals_are_plotted_by_unit() {
        let (recorded, recording) = example(vec![
            ("a.x", "m", "", ramp(1.0)),
            ("a.v", "m/s", "", ramp(2.0)),
            ("b.x", "m", "", ramp(3.0)),
        ]);
        let shown = shown(&recorded, &recording);
        let text = chosen(&["*.x".into()], &shown, &recording.time, CONSOLE).unwrap();
        assert!(text.starts_with("[m]\n") && text.contains("  a.x") && text.contains("  b.x"), "{text}");
        let text = chosen(&["a".into()], &shown, &recording.time, CONSOLE).unwrap();
        assert_eq!(text.matches("time [s]").count(), 2, "{text}");
        assert_eq!(chosen(&["z".into()], &shown, &recording.time, CONSOLE), None);
    }
}
