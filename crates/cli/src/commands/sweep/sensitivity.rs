//! `blocksim sweep --sensitivity`: derivatives of recorded signals by parameters, over time.

use blocksim_block::schedule::{Recorded, Schedule};
use blocksim_numbers::format::significant;
use blocksim_picture::{Figure, Line, Panel, Style, svg};
use blocksim_signal::{Kind, Unit};
use blocksim_sim::{Control, Sensitivity, SimError};
use blocksim_terminal::{Align, PlotOptions, Series, Table, plot};
use serde_json::{Value, json};

use crate::args::sweep::SweepArgs;
use crate::disk::{free, write_file};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::loaded::load;
use crate::picture_file::write_pictures;
use crate::running::blame::failure;
use crate::running::interrupt;
use crate::running::varied::{Parameter, parameter, variants};
use crate::signals::display::display_unit;
use crate::signals::naming::fits;
use crate::terminal::console::Console;
use crate::terminal::format::digits;
use crate::trust::Purpose;

/// Part of a value above which its error leaves nothing of it.
const NOISE: f64 = 0.3;
/// Most plots in the terminal.
const FEW: usize = 4;
/// Width of a drawing, dots.
const WIDTH: f64 = 900.0;
/// Dots of a picture for one of the drawing.
const SCALE: f64 = 2.0;

/// What was found for one parameter.
struct Derivatives {
    parameter: Parameter,
    found: Sensitivity,
}

/// A signal and the unit to show it in.
struct Shown {
    number: usize,
    path: String,
    unit: Unit,
}

/// Prints and writes the derivatives.
///
/// # Errors
/// What is wrong with the command line or the model, or what cannot be written.
pub fn sensitivity(args: &SweepArgs, console: Console) -> Outcome {
    for file in [&args.out, &args.svg, &args.png].into_iter().flatten() {
        free(file, args.yes)?;
    }
    // What is wrong with the model is told once and before anything is run.
    let mut first = load(&args.model, Purpose::Run)?;
    let schedule = first.take_schedule("nothing was run", console)?;
    if let Some(understood) = first.understood() {
        console.say(&understood);
    }
    let signals = chosen(&schedule.recorded, &args.of)?;
    interrupt::take_over();
    let mut all = Vec::new();
    for name in &args.sensitivity {
        let parameter = parameter(&args.model, name)?;
        if console.live && !args.json {
            console.rewrite(&format!("  {name}"));
        }
        let variants = variants(&args.model, &args.solver, &parameter)?;
        let wrong = |error: &SimError| {
            Failure::of(Exit::Failed, vec![failure(error, &variants[2])], first.files.clone())
        };
        let found =
            blocksim_sim::sensitivity(
                &variants,
                parameter.distance,
                &mut || match interrupt::is_requested() {
                    true => Control::Stop,
                    false => Control::Go,
                },
            );
        match found.map_err(|error| wrong(&error))? {
            Some(found) => all.push(Derivatives { parameter, found }),
            None => return Err(Failure::interrupted("no derivatives were found")),
        }
    }
    if console.live && !args.json {
        console.rewrite("");
    }
    let text = if args.json {
        format!("{}\n", data(&all, &signals))
    } else {
        text(&all, &signals, args.no_plot, console)
    };
    console.data(&text)?;
    if let Some(file) = &args.out {
        write_file(file, csv(&all, &signals).as_bytes(), args.yes)?;
        console.say(&format!("the derivatives over time are in {}", file.display()));
    }
    if args.svg.is_some() || args.png.is_some() {
        let drawing = svg(&figure(&all, &signals, &schedule), crate::args::plot::ThemeName::Light.into());
        for file in write_pictures(&drawing, args.svg.as_deref(), args.png.as_deref(), SCALE, args.yes)? {
            console.say(&format!("the drawing is in {}", file.display()));
        }
    }
    Ok(Exit::Done)
}

/// The recorded signals that are asked for.
fn chosen(recorded: &[Recorded], patterns: &[String]) -> Result<Vec<Shown>, Failure> {
    let names = || {
        let some: Vec<&str> = recorded.iter().take(5).map(|recorded| recorded.path.as_str()).collect();
        format!("recorded are {}{}", some.join(", "), if recorded.len() > some.len() { ", ..." } else { "" })
    };
    if recorded.is_empty() {
        return Err(Failure::usage("the model records nothing of which there could be a derivative")
            .help("add a Scope, or `record: [\"...\"]` to the diagram"));
    }
    for pattern in patterns {
        if !recorded.iter().any(|recorded| fits(&recorded.path, pattern)) {
            return Err(Failure::usage(format!("no recorded signal fits `{pattern}`")).help(names()));
        }
    }
    let is_meant = |recorded: &Recorded| {
        patterns.is_empty() || patterns.iter().any(|pattern| fits(&recorded.path, pattern))
    };
    let numbers = recorded.iter().enumerate().filter(|(_, r)| r.kind == Kind::Real && is_meant(r));
    let signals: Vec<Shown> =
        numbers.map(|(number, r)| Shown { number, path: r.path.clone(), unit: display_unit(r) }).collect();
    match signals.is_empty() {
        true => Err(Failure::usage("none of the chosen signals is a real number").help(names())),
        false => Ok(signals),
    }
}

impl Shown {
    fn scale(&self) -> f64 {
        self.unit.from_si(1.0) - self.unit.from_si(0.0)
    }
}

/// The largest magnitude of numbers and where it is.
fn largest(values: &[f64]) -> (usize, f64) {
    let all = values.iter().copied().enumerate();
    all.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap_or((0, 0.0))
}

fn text(all: &[Derivatives], signals: &[Shown], no_plot: bool, console: Console) -> String {
    let mut text = String::new();
    let mut table = Table::new(&[
        ("signal", Align::Left),
        ("by", Align::Left),
        ("largest", Align::Right),
        ("at [s]", Align::Right),
        ("at the end", Align::Right),
        ("unit", Align::Left),
        ("for 1 %", Align::Right),
        ("good to", Align::Right),
    ]);
    for signal in signals {
        for Derivatives { parameter, found } in all {
            let factor = signal.scale() * parameter.scale();
            let values = &found.values[signal.number];
            let (at, most) = largest(values);
            let (_, error) = largest(&found.errors[signal.number]);
            let last = values.last().copied().unwrap_or_default();
            let good = match most == 0.0 {
                true => String::new(),
                false if error.abs() > NOISE * most.abs() => "no digit".to_owned(),
                false => digits(error.abs() / most.abs()),
            };
            let percent = match parameter.value == 0.0 || parameter.unit.from_si(0.0) != 0.0 {
                true => String::new(),
                false => format!(
                    "{} {}",
                    significant(0.01 * parameter.value * most * signal.scale(), 3),
                    signal.unit
                ),
            };
            table.row([
                &signal.path,
                &parameter.name,
                &significant(most * factor, 4),
                &significant(found.times.get(at).copied().unwrap_or_default(), 4),
                &significant(last * factor, 4),
                &parameter.per(&signal.unit),
                percent.trim_end_matches(" 1"),
                &good,
            ]);
        }
    }
    text.push_str(&table.render());
    for Derivatives { parameter, found } in all {
        match &found.by_differences {
            None => text.push_str(&format!(
                "`{}`: by the tangent of the laws, compared with differences of runs\n",
                parameter.name
            )),
            Some(reason) => {
                text.push_str(&format!("`{}`: by differences of runs, as {reason}\n", parameter.name))
            }
        }
    }
    for signal in signals.iter().take(if no_plot { 0 } else { FEW }) {
        let shown = all.iter().map(|Derivatives { parameter, found }| {
            let values = &found.values[signal.number];
            let factor = signal.scale() * percent(parameter);
            (
                parameter.name.as_str(),
                &found.times,
                values.iter().map(|value| value * factor).collect::<Vec<f64>>(),
            )
        });
        let shown: Vec<(&str, &Vec<f64>, Vec<f64>)> = shown.collect();
        if shown.iter().all(|(_, _, values)| values.iter().all(|value| *value == 0.0)) {
            continue;
        }
        let series: Vec<Series> = shown
            .iter()
            .map(|(name, x, y)| Series { name, x: x.as_slice(), y: y.as_slice(), step: false })
            .collect();
        let label = of_percent(signal);
        text.push('\n');
        text.push_str(&plot(
            &series,
            &PlotOptions {
                y_label: &label,
                width: console.width.min(100),
                height: 8,
                ascii: console.ascii,
                ..PlotOptions::default()
            },
        ));
    }
    text
}

/// By what derivatives are multiplied in plots, so that all parameters are comparable: one percent, or a unit of what is zero.
fn percent(parameter: &Parameter) -> f64 {
    if parameter.value == 0.0 { parameter.scale() } else { 0.01 * parameter.value }
}

fn of_percent(signal: &Shown) -> String {
    let unit = signal.unit.to_string();
    let unit = if unit == "1" { String::new() } else { format!(" [{unit}]") };
    format!("{} for 1 %{unit}", signal.path)
}

fn figure(all: &[Derivatives], signals: &[Shown], schedule: &Schedule) -> Figure {
    let panel = |signal: &Shown| Panel {
        title: format!("{} for 1 %", signal.path),
        unit: signal.unit.to_string(),
        lines: all
            .iter()
            .enumerate()
            .map(|(colour, Derivatives { parameter, found })| {
                let factor = signal.scale() * percent(parameter);
                let values = found.values[signal.number].iter().map(|value| value * factor);
                Line {
                    name: parameter.name.clone(),
                    colour,
                    style: Style::Solid,
                    thin: false,
                    courses: vec![found.times.iter().copied().zip(values).collect()],
                }
            })
            .collect(),
        ..Panel::default()
    };
    Figure {
        title: format!("{}: changes by parameters", schedule.title).trim_start_matches(": ").to_owned(),
        panels: signals.iter().map(panel).collect(),
        columns: 1,
        time: (0.0, schedule.settings.stop_time),
        width: WIDTH,
        ..Figure::default()
    }
}

/// A row for each time; the derivatives, then how far each may be off.
fn csv(all: &[Derivatives], signals: &[Shown]) -> String {
    let quoted = |text: String| match text.contains([',', '"']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text,
    };
    let mut text = "time [s]".to_owned();
    for signal in signals {
        for Derivatives { parameter, .. } in all {
            let name = format!("d {} / d {} [{}]", signal.path, parameter.name, parameter.per(&signal.unit));
            text.push_str(&format!(",{},{}", quoted(name.clone()), quoted(format!("error of {name}"))));
        }
    }
    text.push('\n');
    let rows = all.iter().map(|one| one.found.times.len()).min().unwrap_or(0);
    for row in 0..rows {
        text.push_str(&all[0].found.times[row].to_string());
        for signal in signals {
            for Derivatives { parameter, found } in all {
                let factor = signal.scale() * parameter.scale();
                let (value, error) = (found.values[signal.number][row], found.errors[signal.number][row]);
                text.push_str(&format!(",{},{}", value * factor, (error * factor).abs()));
            }
        }
        text.push('\n');
    }
    text
}

/// Everything with all digits, in SI units.
fn data(all: &[Derivatives], signals: &[Shown]) -> Value {
    let one = |Derivatives { parameter, found }: &Derivatives| {
        let of = |signal: &Shown| {
            json!({
                "path": signal.path,
                "derivative": found.values[signal.number],
                "error": found.errors[signal.number],
            })
        };
        json!({
            "parameter": parameter.name,
            "value": parameter.value,
            "by": if found.by_differences.is_none() { "tangent" } else { "differences" },
            "reason": found.by_differences,
            "time": found.times,
            "signals": signals.iter().map(of).collect::<Vec<_>>(),
        })
    };
    json!({ "v": 1, "type": "sensitivity", "parameters": all.iter().map(one).collect::<Vec<_>>() })
}
