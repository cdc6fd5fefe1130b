//! What a run looks like in the terminal.

use blocksim_analysis::continued;
use blocksim_numbers::format::with_unit;
use blocksim_recording::Kind;
use blocksim_terminal::{Align, PlotOptions, Series, Table, plot, sparkline};

use crate::signals::display::{Shown, turn};
use crate::signals::headings::headings;
use crate::signals::naming::{fits, short_names};
use crate::signals::tracking::Tracking;
use crate::terminal::console::Console;

/// Most series in one plot.
const SERIES: usize = 8;
/// Most plots for one question.
const PLOTS: usize = 6;
/// Most lines of signals that scopes show, and of others.
const SCOPE_LINES: usize = 96;
const LINES: usize = 12;
/// What signals of one unit differ by below this share of the largest of them is rounding; below `NOTHING`, in any unit, it is
/// nothing that a diagram is about.
const ROUNDING: f64 = 1e-12;
const NOTHING: f64 = 1e-14;
/// Rows of a plot of one signal over another.
const PLANE_ROWS: usize = 20;
/// Columns of a sparkline.
const SPARKS: usize = 40;

/// A plot of the scope with the largest motion, of those in the unit of the first one, and a line for each of the others and
/// for each signal of `more`, which are what other scopes show. An element of a vector comes into question for the plot only
/// where there is nothing else.
pub fn tracking(trackings: &[Tracking], more: &[&Shown], time: &[f64], console: Console) -> String {
    let motion =
        |tracking: &Tracking| range(&course(tracking.set, time)).map_or(0.0, |(low, high)| high - low);
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
    let rest = trackings.iter().enumerate().filter(|&(n, _)| n != largest);
    let mut rest: Vec<(String, &Shown)> =
        rest.map(|(_, tracking)| (tracking.name.clone(), tracking.actual)).collect();
    rest.extend(named(more));
    text.push_str(&lines(&rest, SCOPE_LINES, time, console));
    text
}

/// A line for each signal, at most so many, below an empty one; those left over are counted.
fn lines(all: &[(String, &Shown)], most: usize, time: &[f64], console: Console) -> String {
    let Some(left) = all.len().checked_sub(1).map(|last| (last + 1).saturating_sub(most)) else {
        return String::new();
    };
    let mut text = format!("\n{}", sparks(&all[..all.len() - left], time, console));
    if left > 0 {
        text.push_str(&format!("and {left} more signals\n"));
    }
    text
}

/// Signals of scopes with their names: the label of the scope and, where it shows several of these signals, what it calls
/// each; the path where there is no label. Scopes of one subsystem that have labels stand in the order of these.
fn named<'a, 's>(shown: &[&'a Shown<'s>]) -> Vec<(String, &'a Shown<'s>)> {
    let titles = headings(&shown.iter().map(|s| (s.block(), s.title)).collect::<Vec<_>>());
    let name = |(s, title): (&&'a Shown<'s>, &String)| {
        let is_alone = shown.iter().filter(|other| other.block() == s.block()).count() == 1;
        match s.title.is_empty() {
            true => s.path.to_owned(),
            false if is_alone => title.clone(),
            false => format!("{title} {}", s.legend.unwrap_or(s.port())),
        }
    };
    let parent = |n: usize| shown[n].block().rsplit_once('/').map_or("", |(parent, _)| parent);
    let family = |n: usize| (0..=n).find(|&first| parent(first) == parent(n)).unwrap_or(n);
    let label = |n: usize| if shown[n].title.is_empty() { "" } else { titles[n].as_str() };
    let mut order: Vec<usize> = (0..shown.len()).collect();
    order.sort_by_key(|&n| (family(n), label(n)));
    order.into_iter().map(|n| (name((&shown[n], &titles[n])), shown[n])).collect()
}

/// Plots of all signals that fit one of the patterns, one plot for each unit; `None` if nothing fits.
pub fn chosen(patterns: &[String], shown: &[Shown], time: &[f64], console: Console) -> Option<String> {
    let wanted = |s: &&Shown| patterns.iter().any(|pattern| fits(s.path, pattern));
    let found: Vec<&Shown> = shown.iter().filter(wanted).collect();
    if found.is_empty() { None } else { Some(by_unit("", &found, time, console)) }
}

/// Plots of all inputs of one block, and a line for each other signal of `scopes`, or for each other signal if `scopes` is empty.
pub fn block(path: &str, shown: &[Shown], scopes: &[&Shown], time: &[f64], console: Console) -> String {
    let (found, rest): (Vec<&Shown>, Vec<&Shown>) = shown.iter().partition(|s| s.block() == path);
    let mut text = plane(path, &found, console).unwrap_or_else(|| by_unit(path, &found, time, console));
    let (rest, most) = match scopes.is_empty() {
        true => (rest, LINES),
        false => (scopes.iter().copied().filter(|s| s.block() != path).collect(), SCOPE_LINES),
    };
    text.push_str(&lines(&named(&rest), most, time, console));
    text
}

/// A plot of the signals that a scope draws over others of its own; `None` where it draws all over time.
fn plane(title: &str, shown: &[&Shown], console: Console) -> Option<String> {
    let below = |s: &Shown| shown.iter().find(|other| Some(other.path) == s.over).copied();
    let pairs: Vec<(&Shown, &Shown)> =
        shown.iter().filter_map(|s| Some((*s, below(s)?))).take(SERIES).collect();
    let (first, across) = pairs.first()?;
    let values: Vec<(Vec<f64>, Vec<f64>)> = pairs.iter().map(|(y, x)| (x.values(), y.values())).collect();
    let series: Vec<Series> = pairs
        .iter()
        .zip(&values)
        .map(|((s, _), (x, y))| Series { name: s.legend.unwrap_or(s.port()), x, y, step: false })
        .collect();
    let (width, ascii) = (console.width, console.ascii);
    let (title, x_label) = (in_unit(title, first), in_unit(across.port(), across));
    let options = PlotOptions {
        title: &title,
        x_label: &x_label,
        width,
        height: PLANE_ROWS,
        ascii,
        ..PlotOptions::default()
    };
    Some(plot(&series, &options))
}

/// A heading with the unit of a signal.
fn in_unit(title: &str, signal: &Shown) -> String {
    match (title, signal.unit.text.as_str()) {
        (title, "1") => title.to_owned(),
        ("", unit) => format!("[{unit}]"),
        (title, unit) => format!("{title} [{unit}]"),
    }
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
    let lines: Vec<Vec<f64>> = shown.iter().map(|s| course(s, time)).collect();
    let series: Vec<Series> = shown
        .iter()
        .zip(names)
        .zip(&lines)
        .map(|((s, name), y)| Series { name, x: time, y, step: s.kind != Kind::Real })
        .collect();
    let heading = shown.first().map_or_else(|| title.to_owned(), |first| in_unit(title, first));
    let (width, ascii) = (console.width, console.ascii);
    plot(&series, &PlotOptions { title: &heading, width, height: 12, ascii, ..PlotOptions::default() })
}

/// A line for each signal: its course over time and the range of its values. An angle goes on where its scale has an end.
fn sparks(shown: &[(String, &Shown)], time: &[f64], console: Console) -> String {
    let courses: Vec<Vec<f64>> = shown.iter().map(|(_, s)| course(s, time)).collect();
    let size = |course: &Vec<f64>| range(course).map_or(0.0, |(low, high)| low.abs().max(high.abs()));
    // What signals of one unit differ by is rounding, or not, beside the largest of them.
    let floor = |unit: &str| {
        let alike = shown.iter().zip(&courses).filter(|((_, s), _)| s.unit.text == unit);
        alike.map(|(_, course)| ROUNDING * size(course)).fold(NOTHING, f64::max)
    };
    let mut table = Table::new(&[
        ("", Align::Left),
        ("", Align::Left),
        ("", Align::Right),
        ("", Align::Left),
        ("", Align::Right),
    ]);
    for ((name, s), values) in shown.iter().zip(&courses) {
        let unit = s.unit.text.as_str();
        let floor = floor(unit);
        let course = match console.ascii {
            true => String::new(),
            false => sparkline(time, values, s.kind != Kind::Real, floor, SPARKS),
        };
        let (low, high) = range(values).unwrap_or((f64::NAN, f64::NAN));
        let told = |x: f64| with_unit(if x.abs() <= floor { 0.0 } else { x }, unit);
        let low = told(low);
        let low = low.strip_suffix(&format!(" {unit}")).unwrap_or(&low).to_owned();
        table.row([name.clone(), course, low, "to".to_owned(), told(high)]);
    }
    table.render()
}

/// The values of a signal in the unit to show them in; an angle goes on where its scale has an end.
fn course(s: &Shown, time: &[f64]) -> Vec<f64> {
    let values = s.values();
    turn(&s.unit).and_then(|turn| continued(time, &values, turn)).unwrap_or(values)
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
    use crate::signals::display::{shown, tests::example};
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
        .assert_eq(&tracking(&trackings(&shown), &[], &recording.time, CONSOLE));
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

    #[test]
    fn lines_name_what_other_scopes_show_and_angles_go_on() {
        let pi = std::f64::consts::PI;
        let turning: Vec<f64> = (0..41).map(|k| pi + 0.05 * f64::from(k)).collect();
        let wrapped = turning.iter().map(|x| if *x > pi { x - 2.0 * pi } else { *x }).collect();
        let (mut recorded, recording) = example(vec![
            ("scope.set", "rad", "deg", ramp(0.5)),
            ("scope.actual", "rad", "deg", ramp(0.5)),
            ("tool/angle.z", "rad", "deg", wrapped),
            ("motors/b.one", "N*m", "", ramp(2.0)),
            ("motors/b.two", "N*m", "", ramp(1.0).iter().map(|x| 1e-15 * x.sin()).collect()),
            ("motors/speed.w", "rad/s", "", ramp(-1e-15)),
            ("motors/a.x", "m", "", ramp(-1.0)),
        ]);
        recorded[6].title = vec!["Stroke".to_owned()];
        recorded[2].title = vec!["Direction".to_owned()];
        recorded[3..5].iter_mut().for_each(|r| r.title = vec!["Torques".to_owned()]);
        recorded[3].legend = Some("first".to_owned());
        let shown = shown(&recorded, &recording);
        let more: Vec<&Shown> = shown[2..].iter().collect();
        let text = tracking(&trackings(&shown), &more, &recording.time, CONSOLE);
        let lines = text.split_once("\n\n").unwrap().1;
        expect![[r#"
            Direction       ▁▁▁▁▁▂▂▂▂▂▃▃▃▃▃▄▄▄▄▄▅▅▅▅▅▆▆▆▆▆▇▇▇▇▇█████  -180.00  to  -65.41 deg
            motors/speed.w  ▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁        0  to     0 rad/s
            Stroke          █████▇▇▇▇▇▆▆▆▆▆▅▅▅▅▅▄▄▄▄▄▃▃▃▃▃▂▂▂▂▂▁▁▁▁▁  -1.0000  to         0 m
            Torques first   ▁▁▁▁▁▂▂▂▂▂▃▃▃▃▃▄▄▄▄▄▅▅▅▅▅▆▆▆▆▆▇▇▇▇▇█████        0  to   2.000 N*m
            Torques two     ▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁        0  to       0 N*m
        "#]]
        .assert_eq(lines);
    }

    #[test]
    fn no_scope_is_left_away() {
        let paths: Vec<String> = (0..40).map(|k| format!("s{k}.u")).collect();
        let columns = paths.iter().map(|path| (path.as_str(), "m", "", ramp(1.0))).collect();
        let (recorded, recording) = example(columns);
        let shown = shown(&recorded, &recording);
        let scopes: Vec<&Shown> = shown.iter().collect();
        let text = block("s0", &shown, &scopes, &recording.time, CONSOLE);
        assert!(paths[1..].iter().all(|path| text.contains(path.as_str())), "{text}");
        // What nobody has made a scope for is cut short.
        let text = block("s0", &shown, &[], &recording.time, CONSOLE);
        assert!(text.ends_with("and 27 more signals\n"), "{text}");
    }
}
