//! Where the poles go, over the gain of a loop or a parameter of the model.

use std::sync::Arc;

use blocksim_linear::{Channel, Complex, poles};
use blocksim_numbers::format::significant;
use blocksim_picture::{Line, Mark, Plane, Sign, Theme, plane_svg};
use blocksim_terminal::{Align, Table};
use serde_json::{Value, json};

use super::data::complex;
use super::facts::Law;
use super::nyquist::{SIZE, around};
use super::pole_map::{Ground, axes, ground};
use super::{Found, asked, found, report};
use crate::args::linearise::LineariseArgs;
use crate::args::model::ModelArgs;
use crate::args::sweep::{Over, Values};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::loaded::load_to_watch;
use crate::running::interrupt;
use crate::terminal::console::Console;
use crate::trust::Purpose;

/// Gains of a loop, as powers of ten around its own, and how many there are at first.
const DECADES: f64 = 3.0;
const GAINS: usize = 121;
/// Most gains, where poles move fast, and how far a pole may go from one to the next, as a part of the size of all.
const MOST_GAINS: usize = 3000;
const HOP: f64 = 0.02;
/// Rows of the table.
const ROWS: usize = 24;

/// Poles over values of something.
pub struct Locus {
    /// What varies.
    pub target: String,
    /// A value, as a number where it is one, and the poles; each in the place of the one that it comes from.
    pub points: Vec<Point>,
    /// Time between two samples, s; none in continuous time.
    pub period: Option<f64>,
    /// Zeros of a loop, at which poles end.
    pub zeros: Vec<Complex<f64>>,
    /// Gains of a loop at which stability begins or ends; none of a parameter.
    pub borders: Option<Vec<f64>>,
}

/// The poles for one value.
pub struct Point {
    /// As it was written.
    pub value: String,
    /// The poles.
    pub poles: Vec<Complex<f64>>,
}

/// Of the loop that is cut, closed again with a gain from zero upwards; 1 is the one it has.
///
/// # Errors
/// If there is no loop, or dead times make infinitely many poles of it.
pub fn of_gain(found: &Found) -> Result<Locus, Failure> {
    let no_loop = || {
        Failure::usage("there is no loop whose gain varies").help(
            "cut one with --open and without --from, or name a parameter, as in --locus=pid.kp=1..100/60log",
        )
    };
    let way = found.ways.first().filter(|_| found.question.is_loop).ok_or_else(no_loop)?;
    let Law::Rational(channel) = &way.law else {
        return Err(Failure::usage(
            "a dead time in the loop makes infinitely many poles, of which no locus is drawn",
        )
        .help("draw the response instead, --chart nyquist"));
    };
    let closed = |gain: f64| -> Result<Option<Vec<Complex<f64>>>, Failure> {
        if gain == 0.0 {
            return Ok(Some(sorted(channel)?));
        }
        channel.clone().scaled(gain).closed().map(|closed| sorted(&closed)).transpose()
    };
    let factor = |k: usize| 10_f64.powf(DECADES * (2.0 * k as f64 / (GAINS - 1) as f64 - 1.0));
    let mut gains: Vec<f64> = std::iter::once(0.0).chain((0..GAINS).map(factor)).collect();
    let mut all: Vec<(f64, Vec<Complex<f64>>)> = Vec::new();
    gains.reverse();
    while let Some(gain) = gains.pop() {
        let Some(mut next) = closed(gain)? else { continue };
        if let Some((before, last)) = all.last() {
            next = continued(last, next);
            let size = next.iter().map(|pole| pole.norm()).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
            let hop =
                last.iter().zip(&next).map(|(a, b)| (a - b).norm() / size.min(b.norm().max(0.05 * size)));
            let between = if *before == 0.0 { gain / 2.0 } else { (before * gain).sqrt() };
            let is_fine = gain - before <= 1e-4 * gain || all.len() + gains.len() >= MOST_GAINS;
            if hop.fold(0.0, f64::max) > HOP * 2.0 && !is_fine && between > 1e-6 {
                gains.extend([gain, between]);
                continue;
            }
        }
        all.push((gain, next));
    }
    // The borders of stability, as exactly as numbers are; nothing is at its border without a gain.
    let is_stable = |poles: &[Complex<f64>]| blocksim_linear::is_stable(poles, way.period());
    let mut borders = Vec::new();
    for pair in all.windows(2).filter(|pair| pair[0].0 > 0.0) {
        let (before, after) = (is_stable(&pair[0].1), is_stable(&pair[1].1));
        if before == after {
            continue;
        }
        let (mut low, mut high) = (pair[0].0, pair[1].0);
        for _ in 0..60 {
            let middle = (low * high).sqrt();
            match closed(middle)? {
                Some(poles) if is_stable(&poles) == before => low = middle,
                _ => high = middle,
            }
        }
        borders.push(high);
    }
    let points = all.into_iter().map(|(gain, poles)| Point { value: format!("{gain}"), poles });
    Ok(Locus {
        target: format!("gain of the loop through {}", found.question.name()),
        points: points.collect(),
        period: way.period(),
        zeros: way.zeros.clone().unwrap_or_default(),
        borders: Some(borders),
    })
}

fn sorted(channel: &Channel) -> Result<Vec<Complex<f64>>, Failure> {
    poles(&channel.a).map_err(|error| Failure::new(Exit::Failed, "linearise", error.to_string()))
}

/// Of a model over the values of a parameter: of the ways that are asked for, a loop closed; without signals of all of it.
///
/// # Errors
/// What is wrong with a value, or with the model at one; what has infinitely many poles.
pub fn of_parameter(args: &LineariseArgs, over: &Over, console: Console) -> Result<Locus, Failure> {
    if matches!(over.values, Values::Between(_)) {
        return Err(Failure::usage(format!("how many values of `{}`?", over.target))
            .help("write from..to/n, such as 4..16/50, or from..to/nlog for equal factors"));
    }
    let watched: Vec<String> = args.to.iter().chain(&args.open).chain(&args.from).cloned().collect();
    let mut points: Vec<Point> = Vec::new();
    let mut period = None;
    for (number, value) in over.listed().iter().enumerate() {
        if interrupt::is_requested() {
            return Err(Failure::interrupted("no locus was made"));
        }
        if console.live && !args.json {
            console.rewrite(&format!("  {number} of {} values", over.listed().len()));
        }
        let set = args.model.set.iter().cloned().chain([format!("{}={value}", over.target)]).collect();
        let model = ModelArgs { model: args.model.model.clone(), set, plugins: args.model.plugins };
        let mut loaded = load_to_watch(&model, Purpose::Run, &watched)?;
        let schedule = Arc::new(loaded.take_schedule("no locus was made", console)?);
        let question = asked(args, &schedule)?;
        let one = found(args, &schedule, question, &loaded)?;
        let has_dead_times = one.ways.iter().any(|way| matches!(&way.law, Law::Dead(_)));
        if has_dead_times || one.ways.is_empty() && !one.linearised.dead.is_empty() {
            return Err(Failure::usage(
                "a dead time makes infinitely many poles, of which no locus is drawn",
            )
            .help("draw the response instead, --chart nyquist"));
        }
        let poles: Vec<Complex<f64>> = match one.ways.first() {
            None => one.modes.iter().map(|mode| mode.pole).collect(),
            Some(way) => match &way.margins {
                Some(margins) => margins.closed.clone(),
                None => way.modes.iter().map(|mode| mode.pole).collect(),
            },
        };
        period = one.linearised.system.period;
        let poles = match points.last() {
            Some(last) => continued(&last.poles, poles),
            None => poles,
        };
        points.push(Point { value: value.clone(), poles });
    }
    if console.live && !args.json {
        console.rewrite("");
    }
    Ok(Locus { target: over.target.clone(), points, period, zeros: Vec::new(), borders: None })
}

/// The poles in the order of those before them: the nearest pairs first.
fn continued(last: &[Complex<f64>], mut next: Vec<Complex<f64>>) -> Vec<Complex<f64>> {
    if last.len() != next.len() {
        return next;
    }
    let n = last.len();
    let mut pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).collect();
    let distance = |pair: &(usize, usize)| (last[pair.0] - next[pair.1]).norm();
    pairs.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    let (mut order, mut taken) = (vec![None; n], vec![false; n]);
    for (i, j) in pairs {
        if order[i].is_none() && !taken[j] {
            (order[i], taken[j]) = (Some(next[j]), true);
        }
    }
    order.into_iter().zip(&mut next).for_each(|(found, place)| *place = found.unwrap_or(*place));
    next
}

impl Locus {
    /// The branches, each without gaps.
    fn branches(&self) -> Vec<Vec<(f64, f64)>> {
        let mut branches: Vec<Vec<(f64, f64)>> = Vec::new();
        let mut open = 0;
        for (n, point) in self.points.iter().enumerate() {
            if n == 0 || self.points[n - 1].poles.len() != point.poles.len() {
                open = branches.len();
                branches.resize(open + point.poles.len(), Vec::new());
            }
            for (branch, pole) in branches[open..].iter_mut().zip(&point.poles) {
                branch.push((pole.re, pole.im));
            }
        }
        branches
    }

    /// Values and poles, and where stability begins or ends.
    pub fn text(&self) -> String {
        let mut table =
            Table::new(&[(self.target.as_str(), Align::Right), ("", Align::Left), ("poles", Align::Left)]);
        let every = self.points.len().div_ceil(ROWS).max(1);
        let last = self.points.len().saturating_sub(1);
        for (_, point) in self.points.iter().enumerate().filter(|(n, _)| n % every == 0 || *n == last) {
            let shown: Vec<String> = point
                .poles
                .iter()
                .filter(|pole| pole.im >= -1e-9 * pole.norm())
                .take(6)
                .map(|pole| report::complex(*pole))
                .collect();
            let value = point
                .value
                .parse::<f64>()
                .map_or_else(|_| point.value.clone(), |value| significant(value, 4));
            let stable = if self.is_stable(point) { "" } else { "unstable" };
            table.row([value, stable.to_owned(), shown.join(", ")]);
        }
        format!("\n{}{}", table.render(), self.stability())
    }

    /// Where stability begins or ends.
    fn stability(&self) -> String {
        let short = |value: &str| {
            value.parse::<f64>().map_or_else(|_| value.to_owned(), |value| significant(value, 4))
        };
        // Without a gain a loop is open.
        let first = usize::from(self.borders.is_some());
        let points = &self.points[first.min(self.points.len())..];
        let begins = points.first().is_some_and(|point| self.is_stable(point));
        let changes: Vec<String> = match &self.borders {
            Some(borders) => borders.iter().map(|border| significant(*border, 5)).collect(),
            None => points
                .windows(2)
                .filter(|pair| self.is_stable(&pair[0]) != self.is_stable(&pair[1]))
                .map(|pair| format!("{} to {}", short(&pair[0].value), short(&pair[1].value)))
                .collect(),
        };
        match (&changes[..], begins) {
            ([], true) => "stable at all values\n".to_owned(),
            ([], false) => "not stable at any value\n".to_owned(),
            (changes, true) => format!("stable at first, which changes at {}\n", changes.join(", ")),
            (changes, false) => format!("not stable at first, which changes at {}\n", changes.join(", ")),
        }
    }

    fn is_stable(&self, point: &Point) -> bool {
        blocksim_linear::is_stable(&point.poles, self.period)
    }

    /// All points, with all digits.
    pub fn json(&self) -> Value {
        let point = |point: &Point| {
            json!({
                "value": point.value.parse::<f64>().map_or_else(|_| json!(point.value), |value| json!(value)),
                "poles": point.poles.iter().map(complex).collect::<Vec<_>>(),
                "stable": self.is_stable(point),
            })
        };
        json!({ "target": self.target, "points": self.points.iter().map(point).collect::<Vec<_>>(), "borders": self.borders })
    }
}

/// The locus as a drawing, with the poles at its beginning, and of a loop at its own gain and with the zeros.
pub fn drawing(found: &Found, theme: Theme) -> String {
    let Some(locus) = &found.locus else { return String::new() };
    let is_sampled = locus.period.is_some();
    let mark = |pole: &Complex<f64>, sign: Sign, colour: Option<usize>, name: String| Mark {
        at: (pole.re, pole.im),
        sign,
        colour,
        name,
    };
    let mut marks = Vec::new();
    let (first, last) = (locus.points.first(), locus.points.last());
    let named = |point: &Point| {
        point.value.parse::<f64>().map_or_else(|_| point.value.clone(), |value| significant(value, 3))
    };
    let of_gain = found.question.is_loop && locus.target.starts_with("gain of the loop");
    let mut seen: Vec<Complex<f64>> = locus.zeros.clone();
    if let Some(point) = first {
        seen.extend(&point.poles);
        let name = if of_gain { "poles of the open loop".to_owned() } else { format!("at {}", named(point)) };
        marks.extend(point.poles.iter().map(|pole| mark(pole, Sign::Cross, Some(0), name.clone())));
    }
    if of_gain {
        let own = locus.points.iter().find(|point| point.value == "1");
        for pole in own.iter().flat_map(|point| &point.poles) {
            seen.push(*pole);
            marks.push(mark(pole, Sign::Dot, Some(1), "closed with its own gain".to_owned()));
        }
        marks.extend(locus.zeros.iter().map(|zero| mark(zero, Sign::Ring, Some(0), "zeros".to_owned())));
    } else {
        for point in &locus.points {
            seen.extend(&point.poles);
        }
        if let Some(point) = last {
            let name = format!("at {}", named(point));
            marks.extend(point.poles.iter().map(|pole| mark(pole, Sign::Dot, Some(1), name.clone())));
        }
    }
    // Branches of a gain go on without end: some room for them around what is marked.
    if of_gain && !is_sampled {
        let range = around(seen.iter().copied());
        let room = 0.6 * (range[1] - range[0]).max(range[3] - range[2]);
        let near = |z: &Complex<f64>| {
            z.re > range[0] - room
                && z.re < range[1] + room
                && z.im > range[2] - room
                && z.im < range[3] + room
        };
        let more: Vec<Complex<f64>> =
            locus.points.iter().flat_map(|point| point.poles.iter().copied()).filter(near).collect();
        seen.extend(more);
    }
    let Ground { range, mut lines, labels } = ground(&seen, is_sampled);
    let courses = locus.branches();
    lines.push(Line { courses, ..Line::default() });
    let plane = Plane {
        title: format!(
            "Poles over the {}",
            if of_gain { locus.target.clone() } else { format!("parameter {}", locus.target) }
        ),
        axes: axes(is_sampled),
        range,
        equal: is_sampled,
        size: SIZE,
        lines,
        marks,
        labels,
    };
    plane_svg(&plane, theme)
}
