//! What is found, for a person.

use blocksim_linear::{Complex, Gain, Margin, Margins, Mode};
use blocksim_results::format::{fixed, significant};
use blocksim_results::{Align, PlotOptions, Series, Table, plot};

use super::Found;
use super::facts::{Way, decibels, degrees};
use super::matrices::{Hold, Stays};
use crate::terminal::console::Console;
use crate::terminal::format::short_time;

/// Rows of poles that are told of one way.
const ROWS: usize = 24;
/// Entries of other lists.
const FEW: usize = 6;

/// All about a linear system.
pub fn text(found: &Found, console: Console, draws: bool) -> String {
    let mut text = heading(found);
    for (n, way) in found.ways.iter().enumerate() {
        text.push('\n');
        text.push_str(&of_way(found, way, n));
        if draws && way.zeros.is_some() {
            text.push('\n');
            text.push_str(&drawn(way, console));
        }
    }
    text
}

fn heading(found: &Found) -> String {
    let question = &found.question;
    let instant = match found.steady {
        true => "at rest".to_owned(),
        false => format!("at {} s", short_time(found.t)),
    };
    let what = match question.is_loop {
        true => format!("loop through `{}`, once around", question.from.name),
        false => format!("from `{}`", question.from.name),
    };
    let cut: Vec<String> = question
        .open
        .iter()
        .filter(|open| !question.is_loop || open.cell != question.from.cell)
        .map(|open| format!("`{}`", open.name))
        .collect();
    let cut = if cut.is_empty() { String::new() } else { format!(", cut at {}", cut.join(", ")) };
    let mut text = format!("{}, {instant}: {what}{cut}\n", found.title);
    let system = &found.linearised;
    if !system.names.is_empty() {
        text.push_str(&format!("slopes are good to {}\n", part(system.accuracy)));
    }
    if !found.adrift.is_empty() {
        let names: Vec<String> = found.adrift.iter().take(FEW).map(|name| format!("`{name}`")).collect();
        let more = found.adrift.len().saturating_sub(FEW);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        text.push_str(&format!("moves on, as nothing depends on it: {}{more}\n", names.join(", ")));
    }
    for kink in system.kinks.iter().take(FEW) {
        text.push_str(&format!("not smooth here: {kink}; the mean is taken\n"));
    }
    if system.kinks.len() > FEW {
        text.push_str(&format!("and {} more places that are not smooth\n", system.kinks.len() - FEW));
    }
    let told = |hold: &dyn Fn(Hold) -> Option<String>| {
        let all: Vec<String> =
            system.held.iter().filter_map(|(path, how)| Some(format!("`{path}`{}", hold(*how)?))).collect();
        let more = all.len().saturating_sub(FEW);
        let few = all[..all.len() - more].join(", ");
        if more > 0 { format!("{few} and {more} more") } else { few }
    };
    let sampled = told(&|how| match how {
        Hold::Sampled(period) => Some(format!(" ({} s)", short_time(period))),
        Hold::Remembers => None,
    });
    let remembers = told(&|how| (how == Hold::Remembers).then(String::new));
    if !sampled.is_empty() {
        text.push_str(&format!("held between samples, so that no change passes: {sampled}\n"));
    }
    if !remembers.is_empty() {
        text.push_str(&format!("held, as they answer from memory: {remembers}\n"));
    }
    for (stays, words) in
        [(Stays::Stuck, "sticks, and goes on sticking"), (Stays::Limited, "at a limit, and stays there")]
    {
        let all: Vec<String> =
            system.modes.iter().filter(|mode| mode.1 == stays).map(|mode| format!("`{}`", mode.0)).collect();
        let more = all.len().saturating_sub(FEW);
        if !all.is_empty() {
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            text.push_str(&format!("{words}: {}{more}\n", all[..all.len().min(FEW)].join(", ")));
        }
    }
    text
}

/// A part of one, as a power of ten.
fn part(accuracy: f64) -> String {
    match accuracy {
        a if a < 1e-15 => "all digits".to_owned(),
        a if a < 1e-2 => format!("{} digits", (-a.log10()).floor()),
        a => format!("{} %", significant(100.0 * a, 1)),
    }
}

/// A change as a power of ten that it is below.
fn changed(change: f64) -> String {
    format!("less than 1e{}", change.max(1e-15).log10().floor() + 1.0)
}

fn of_way(found: &Found, way: &Way, output: usize) -> String {
    let question = &found.question;
    let to = &question.to[output];
    let mut text = String::new();
    if !question.is_loop {
        let unit = match (to.unit().as_str(), question.from.unit().as_str()) {
            ("1", "1") => String::new(),
            (to, from) if to == from => String::new(),
            (to, from) => format!(", in {to} for a {from}"),
        };
        text.push_str(&format!("to `{}`{unit}: ", to.name));
    }
    let states = found.linearised.names.len();
    let left = match way.reduction {
        0.0 => String::new(),
        change => format!("; leaving the others away changes the response by {}", changed(change)),
    };
    text.push_str(&format!("{} of {states} states take part{left}\n", way.channel.order()));
    if way.zeros.is_none() {
        text.push_str(&nothing(found));
        return text;
    }
    if !way.modes.is_empty() {
        text.push_str(&poles(&way.modes, way.channel.period.is_some()));
    }
    if let Some(zeros) = way.zeros.as_ref().filter(|zeros| !zeros.is_empty()) {
        let shown: Vec<String> = pairs(zeros).iter().take(FEW).map(|zero| complex(*zero)).collect();
        let more = pairs(zeros).len().saturating_sub(FEW);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        text.push_str(&format!("zeros {}{more}\n", shown.join(", ")));
    }
    let mut facts = Table::new(&[("", Align::Left), ("", Align::Left)]);
    let gain = match way.gain {
        Gain::Finite(gain) => significant(gain, 5),
        Gain::Infinite => "infinite, it integrates".to_owned(),
    };
    facts.row(["static gain", &gain]);
    if let Some(bandwidth) = way.bandwidth {
        facts.row(["bandwidth", &frequency(bandwidth)]);
    }
    if let Some(step) = way.step {
        let step = format!(
            "overshoot {} %, rise {} s, settling {} s",
            fixed(100.0 * step.overshoot, 2),
            significant(step.rise, 3),
            significant(step.settling, 3)
        );
        facts.row(["step", &step]);
    }
    if let Some(margins) = &way.margins {
        of_margins(&mut facts, margins);
    }
    text.push_str(&facts.render());
    text
}

/// Why nothing comes through, as far as it is known.
fn nothing(found: &Found) -> String {
    match found.linearised.held.first() {
        Some((path, Hold::Sampled(_))) => format!(
            "nothing comes through: the way leads through `{path}`, which is held between its samples; begin or end at its \
             output\n"
        ),
        Some((path, Hold::Remembers)) => {
            format!("nothing comes through: the way leads through `{path}`, which answers from memory\n")
        }
        None => "nothing comes through: no way leads there, or what lies on it is at a limit or sticks\n"
            .to_owned(),
    }
}

fn of_margins(facts: &mut Table, margins: &Margins) {
    let none = |what: &str| format!("infinite, the {what} is nowhere");
    let at = |margin: Margin, value: String| format!("{value} at {}", frequency(margin.frequency));
    let gain = margins.least_gain().map_or(none("phase of -180 deg"), |margin| {
        at(
            margin,
            format!(
                "{} dB (a factor of {})",
                fixed(20.0 * margin.value.log10(), 2),
                significant(margin.value, 4)
            ),
        )
    });
    let phase = margins.least_phase().map_or(none("gain of 1"), |margin| {
        at(margin, format!("{} deg", fixed(margin.value.to_degrees(), 2)))
    });
    facts.row(["gain margin", &gain]);
    facts.row(["phase margin", &phase]);
    if let Some(delay) = margins.delay {
        facts.row(["delay margin", &at(delay, format!("{} s", significant(delay.value, 3)))]);
    }
    let peak = margins.sensitivity;
    facts.row(["sensitivity", &at(peak, format!("up to {}", significant(peak.value, 4)))]);
    let closed = match margins.stable {
        true => "stable".to_owned(),
        false => {
            let worst = margins.closed.iter().max_by(|a, b| a.re.total_cmp(&b.re));
            format!("not stable: a pole at {}", worst.map_or_else(String::new, |pole| complex(*pole)))
        }
    };
    facts.row(["closed loop", &closed]);
}

fn frequency(rad: f64) -> String {
    format!("{} rad/s ({} Hz)", significant(rad, 4), significant(rad / std::f64::consts::TAU, 4))
}

/// A table of poles, a pair in one row.
fn poles(modes: &[Mode], is_sampled: bool) -> String {
    let heading = if is_sampled { "poles, z" } else { "poles [rad/s]" };
    let mut table = Table::new(&[
        (heading, Align::Right),
        ("frequency [rad/s]", Align::Right),
        ("damping", Align::Right),
        ("time constant [s]", Align::Right),
    ]);
    let shown: Vec<&Mode> = modes.iter().filter(|mode| mode.pole.im >= 0.0).collect();
    for mode in shown.iter().take(ROWS) {
        table.row([
            complex(mode.pole),
            significant(mode.frequency, 4),
            fixed(mode.damping, 3),
            significant(mode.time_constant, 4),
        ]);
    }
    let more = shown.len().saturating_sub(ROWS);
    let more = if more > 0 { format!("and {more} more\n") } else { String::new() };
    format!("{}{more}", table.render())
}

/// Of two that mirror each other the one above the axis.
fn pairs(all: &[Complex<f64>]) -> Vec<Complex<f64>> {
    all.iter().copied().filter(|z| z.im >= 0.0).collect()
}

/// `-3.2`, `-1.5 ± 20j`.
fn complex(z: Complex<f64>) -> String {
    match z.im {
        im if im.abs() <= 1e-12 * z.norm() => significant(z.re, 4),
        im if z.re.abs() <= 1e-12 * z.norm() => format!("±{}j", significant(im.abs(), 4)),
        im => format!("{} ± {}j", significant(z.re, 4), significant(im.abs(), 4)),
    }
}

/// Magnitude and phase in the terminal.
fn drawn(way: &Way, console: Console) -> String {
    let across: Vec<f64> = way.frequencies.iter().map(|w| w.log10()).collect();
    let one = |y: &[f64], y_label: &str| {
        let series = [Series { name: "", x: &across, y, step: false }];
        let options = PlotOptions {
            x_label: "rad/s",
            y_label,
            width: console.width.min(100),
            height: 8,
            ascii: console.ascii,
            powers: true,
            ..PlotOptions::default()
        };
        plot(&series, &options)
    };
    format!(
        "{}{}",
        one(&decibels(&way.response), "magnitude [dB]"),
        one(&degrees(&way.response), "phase [deg]")
    )
}
