//! What is found, for a person.

use blocksim_linear::{Complex, Gain, Margin, Margins, Mode, is_at_border};
use blocksim_numbers::format::{fixed, significant};
use blocksim_terminal::{Align, PlotOptions, Series, Table, plot};

use super::Found;
use super::facts::{Dead, Law, Way, decibels, degrees, has_circle};
use super::matrices::{Hold, Linearised, Method, Stays};
use crate::terminal::console::Console;
use crate::terminal::format::{digits, short_time};

/// Rows of poles that are told of one way.
const ROWS: usize = 24;
/// Distance from the unit circle below which no measured slope tells on which side a pole is.
const BORDER: f64 = 1e-6;
/// Entries of other lists.
const FEW: usize = 6;

/// All about a linear system.
pub fn text(found: &Found, console: Console, draws: bool) -> String {
    let mut text = heading(found);
    if found.question.from.is_none() {
        text.push_str(&of_model(found));
    }
    if let Some(locus) = &found.locus {
        text.push_str(&locus.text());
        return text;
    }
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
    let period = found.linearised.system.period;
    let instant = match period {
        Some(period) => format!("{instant}, from hit to hit of {} s", short_time(period)),
        None => instant,
    };
    let what = match (&question.from, question.is_loop) {
        (None, _) => "poles".to_owned(),
        (Some(from), true) => format!("loop through `{}`, once around", from.name),
        (Some(from), false) => format!("from `{}`", from.name),
    };
    let cut: Vec<String> = question
        .open
        .iter()
        .filter(|open| !question.is_loop || question.from.as_ref().is_none_or(|from| open.cell != from.cell))
        .map(|open| format!("`{}`", open.name))
        .collect();
    let cut = if cut.is_empty() { String::new() } else { format!(", cut at {}", cut.join(", ")) };
    let mut text = format!("{}, {instant}: {what}{cut}\n", found.title);
    let system = &found.linearised;
    if !system.names.is_empty() {
        text.push_str(&slopes(system));
    }
    if !found.adrift.is_empty() {
        text.push_str(&format!("moves on, as nothing depends on it: {}\n", few(&found.adrift)));
    }
    if !system.following.is_empty() {
        text.push_str(&format!(
            "no state of its own, as it follows from others: {}\n",
            few(&system.following)
        ));
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
        text.push_str(&format!(
            "held between samples, so that no change passes (--sampled takes the samples as they are): {sampled}\n"
        ));
    }
    if !remembers.is_empty() {
        text.push_str(&format!("their memory is held: {remembers}\n"));
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

/// The first of some names, and how many more there are.
fn few(names: &[String]) -> String {
    let shown: Vec<String> = names.iter().take(FEW).map(|name| format!("`{name}`")).collect();
    let more = names.len().saturating_sub(FEW);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{more}", shown.join(", "))
}

/// How exact slopes are, and where they are differences.
fn slopes(found: &Linearised) -> String {
    let Method { blocks, columns, because } = &found.method;
    let listed = |names: &[String]| {
        let more = names.len().saturating_sub(FEW);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!("{}{more}", names[..names.len().min(FEW)].join(", "))
    };
    let all = found.names.len() + found.system.b.ncols();
    let mut parts = Vec::new();
    if !blocks.is_empty() {
        let blocks: Vec<String> = blocks.iter().map(|path| format!("`{path}`")).collect();
        parts.push(format!("in {}", listed(&blocks)));
    }
    if columns.len() == all {
        parts = vec!["of the whole model".to_owned()];
    } else if !columns.is_empty() {
        parts.push(format!("over {}", listed(columns)));
    }
    match parts.is_empty() {
        true => "slopes are exact, from the laws of the blocks\n".to_owned(),
        false => {
            let because = because.iter().map(|because| format!(", as {because}")).collect::<String>();
            format!(
                "slopes are good to {}: differences {}{because}\n",
                digits(found.accuracy),
                parts.join(", and ")
            )
        }
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
        let from = question.from.as_ref().map_or_else(String::new, |from| from.unit());
        let unit = match (to.unit().as_str(), from.as_str()) {
            ("1", "1") => String::new(),
            (to, from) if to == from => String::new(),
            (to, from) => format!(", in {to} for a {from}"),
        };
        text.push_str(&format!("to `{}`{unit}: ", to.name));
    }
    let states = found.linearised.names.len();
    let left = match way.reduction {
        0.0 => String::new(),
        change => format!("; leaving the others out changes the response by {}", changed(change)),
    };
    text.push_str(&format!("{} of {states} states take part{left}\n", way.order()));
    if way.zeros.is_none() {
        text.push_str(&nothing(found));
        return text;
    }
    if let Law::Dead(dead) = &way.law {
        text.push_str(&dead_times(dead, question.is_loop));
    }
    if !way.modes.is_empty() {
        text.push_str(&poles(&way.modes, way.period().is_some()));
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
        of_margins(&mut facts, margins, way);
    }
    text.push_str(&facts.render());
    text
}

/// All poles of a model.
fn of_model(found: &Found) -> String {
    let system = &found.linearised;
    let mut text = "\n".to_owned();
    let is_circular = has_circle(system);
    let all: Vec<String> = system.dead.iter().map(|(path, _)| path.clone()).collect();
    if !is_circular && !all.is_empty() {
        text.push_str(&format!("no loop leads through a dead time, which adds no poles: {}\n", few(&all)));
    }
    if is_circular {
        let growing = match found.growing {
            Some(0) => "none of them grows".to_owned(),
            Some(count) => format!("{count} of them grow"),
            None => {
                let why = found.undecided.iter().map(|why| format!(", as {why}")).collect::<String>();
                format!("whether any of them grows cannot be decided{why}")
            }
        };
        let below = match found.modes.is_empty() {
            true => "",
            false => "; those below are of the model with what comes out of the dead times held",
        };
        text.push_str(&format!(
            "with dead times, {}, there are infinitely many poles: {growing}{below}\n",
            few(&all)
        ));
    }
    if !found.constant.is_empty() {
        text.push_str(&format!("constant, as nothing acts on it: {}\n", few(&found.constant)));
    }
    if found.modes.is_empty() {
        return text;
    }
    text.push_str(&poles(&found.modes, system.system.period.is_some()));
    if !is_circular {
        let stays = match found.unread.len() {
            0 => String::new(),
            1 => format!("; {} keeps what is added to it, and nothing else reads it", few(&found.unread)),
            _ => format!("; {} keep what is added to them, and nothing else reads them", few(&found.unread)),
        };
        text.push_str(match found.is_stable {
            Some(true) => "stable",
            Some(false) => "not stable: what has a negative damping grows",
            None => "at the border of stability: what has an infinite time constant stays",
        });
        text.push_str(&stays);
        text.push('\n');
    }
    text
}

/// Dead times on a way, and what they do to its poles.
fn dead_times(dead: &Dead, is_loop: bool) -> String {
    let times: Vec<String> =
        dead.delayed.times().iter().take(FEW).map(|time| format!("{} s", short_time(*time))).collect();
    let more = dead.delayed.times().len().saturating_sub(FEW);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let what = match (dead.is_circular, dead.growing) {
        (false, _) => "; poles are those of the rest",
        (true, _) if is_loop => "; poles are infinitely many, as one of them feeds itself",
        (true, Some(0)) => "; poles are infinitely many, as one of them feeds itself, and none grows",
        (true, Some(_)) => "; poles are infinitely many, as one of them feeds itself, and some grow",
        (true, None) => {
            "; poles are infinitely many, as one of them feeds itself; whether any grows is not known"
        }
    };
    format!("dead time {}{more}, exact in the response{what}\n", times.join(", "))
}

/// Why nothing comes through, as far as it is known.
fn nothing(found: &Found) -> String {
    match found.linearised.held.first() {
        Some((path, Hold::Sampled(_))) => format!(
            "nothing comes through: the way leads through `{path}`, which is held between its samples; begin or end at its \
             output, or linearise from hit to hit, --sampled\n"
        ),
        Some((path, Hold::Remembers)) => {
            format!("nothing comes through: the way leads through `{path}`, which answers from memory\n")
        }
        None => "nothing comes through: no way leads there, or what lies on it is at a limit or sticks\n"
            .to_owned(),
    }
}

/// The pole of a closed loop that grows fastest.
fn worst(margins: &Margins, is_sampled: bool) -> Option<Complex<f64>> {
    let growth = |pole: &Complex<f64>| if is_sampled { pole.norm() } else { pole.re };
    margins.closed.iter().copied().max_by(|a, b| growth(a).total_cmp(&growth(b)))
}

fn of_margins(facts: &mut Table, margins: &Margins, way: &Way) {
    let is_sampled = way.period().is_some();
    let none = |what: &str| format!("infinite, the {what} is nowhere");
    let at = |margin: Margin, value: String| match margin.frequency {
        f64::INFINITY => format!("{value} at high frequencies"),
        known => format!("{value} at {}", frequency(known)),
    };
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
    let up_to = format!("up to {}", significant(peak.value, 4));
    facts.row(["sensitivity", &at(peak, up_to)]);
    let closed = match margins.stable {
        true => way.unseen.map_or("stable".to_owned(), |pole| {
            format!(
                "stable, but the model is not: a pole at {}, which the loop does not reach or does not see",
                complex(pole)
            )
        }),
        false => match (margins.growing, worst(margins, is_sampled)) {
            (Some(1), _) => "not stable: a pole grows".to_owned(),
            (Some(count), _) => format!("not stable: {count} poles grow"),
            (None, Some(pole)) if is_sampled && pole.norm() < 1.0 + BORDER => format!(
                "at its border: a pole at {}, closer to the unit circle than slopes are exact",
                complex(pole)
            ),
            (None, Some(pole)) if !is_sampled && is_at_border(pole, &margins.closed, None) => {
                format!("at its border: a pole at {}, on the imaginary axis but for rounding", complex(pole))
            }
            (None, Some(pole)) => format!("not stable: a pole at {}", complex(pole)),
            (None, None) => "not stable: infinitely many poles may grow".to_owned(),
        },
    };
    facts.row(["closed loop", &closed]);
}

fn frequency(rad: f64) -> String {
    format!("{} rad/s ({} Hz)", significant(rad, 4), significant(rad / std::f64::consts::TAU, 4))
}

/// A table of poles, a pair in one row.
pub(super) fn poles(modes: &[Mode], is_sampled: bool) -> String {
    let heading = if is_sampled { "poles, z" } else { "poles [rad/s]" };
    let mut table = Table::new(&[
        (heading, Align::Right),
        ("frequency [rad/s]", Align::Right),
        ("damping", Align::Right),
        ("time constant [s]", Align::Right),
    ]);
    // What has died out after a sample or a few says little, and there may be many of them.
    let (over, rest): (Vec<&Mode>, Vec<&Mode>) =
        modes.iter().partition(|mode| is_sampled && mode.pole.norm() == 0.0);
    let mut shown: Vec<&Mode> = rest.into_iter().filter(|mode| mode.pole.im >= 0.0).collect();
    if is_sampled {
        shown.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    }
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
    let over = match over.len() {
        0 => String::new(),
        count => format!("and {count} at z = 0, which die out within as many samples\n"),
    };
    let table = if shown.is_empty() { String::new() } else { table.render() };
    format!("{table}{more}{over}")
}

/// Of two that mirror each other the one above the axis.
fn pairs(all: &[Complex<f64>]) -> Vec<Complex<f64>> {
    all.iter().copied().filter(|z| z.im >= 0.0).collect()
}

/// `-3.2`, `-1.5 ± 20j`.
pub(super) fn complex(z: Complex<f64>) -> String {
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
