//! The command line of `blocksim sweep`: which values parameters take, and what is measured.

use std::path::PathBuf;

use blocksim_signal::{Unit, closest};

use super::model::{ModelArgs, SolverArgs};

/// `blocksim sweep`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Values of a parameter are a list, or so many from one end to the other, evenly or by equal factors:\n  \
                  pid.kp=4,8,16    drive=dc,asm    pid.kp=4..16/5    motor.l=\"1 mH..100 mH/5log\"\n\
                  Of several parameters all combinations are run. With --random a range has no number, pid.kp=4..16 or\n  \
                  motor.l=\"1 mH..100 mH/log\", and each run takes a value from somewhere between its ends.\n\n\
                  Numbers of how a set value is followed: rise, overshoot, settling, iae, ise, final_error, maximum_error;\n\
                  of any signal: min, max, peak, mean, rms, final. A part of a path or a pattern with `*` may follow.\n\n\
                  Examples:\n  blocksim sweep servo.ron --over pid.kp=4..16/5 --over pid.kd=0.2,0.4\n  \
                  blocksim sweep servo.ron --over inertia=\"0.1 kg*m^2..1 kg*m^2/10\" --metric settling,peak:motor.i\n  \
                  blocksim sweep irb2600.ron --over drive=asm,dc,torque --out drives.csv --keep drives\n  \
                  blocksim sweep servo.ron --over inertia=\"0.1 kg*m^2..1 kg*m^2\" --over pid.kp=6..10 --random 100 --seed 1\n  \
                  blocksim sweep servo.ron --sensitivity pid.kp,inertia --of angle"
)]
pub struct SweepArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// A parameter, named as for `--set`, and the values that it takes; may be repeated.
    #[arg(long, value_name = "TARGET=VALUES", value_parser = over, required_unless_present = "sensitivity")]
    pub over: Vec<Over>,
    /// Instead of runs over values: the derivatives of recorded signals by these parameters, over time, at the values that they have.
    #[arg(
        long,
        value_name = "TARGET",
        value_delimiter = ',',
        conflicts_with_all = ["over", "random", "seed", "metric", "keep", "jobs"]
    )]
    pub sensitivity: Vec<String>,
    /// The signals of --sensitivity, of those that the diagram records: parts of their paths or patterns with `*`, separated by commas.
    #[arg(long, value_name = "PATTERN", value_delimiter = ',')]
    pub of: Vec<String>,
    /// Draw what --sensitivity finds.
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// The same as a picture.
    #[arg(long, value_name = "FILE")]
    pub png: Option<PathBuf>,
    /// Make so many runs with random values, spread evenly over each range (latin hypercube), instead of all combinations.
    #[arg(long, value_name = "N")]
    pub random: Option<std::num::NonZeroUsize>,
    /// Other random values for another number; 0 unless given.
    #[arg(long, value_name = "N", requires = "random")]
    pub seed: Option<u64>,
    /// What to measure, separated by commas; without it how set values are followed.
    #[arg(long, value_name = "METRIC[:SIGNALS]", value_parser = wanted, value_delimiter = ',')]
    pub metric: Vec<Wanted>,
    #[command(flatten)]
    pub solver: SolverArgs,
    /// Runs at the same time; without it as many as there are processors.
    #[arg(long, short, value_name = "N")]
    pub jobs: Option<std::num::NonZeroUsize>,
    /// Write the table to a file, as CSV with a column for each parameter and each number; with --sensitivity the derivatives over time.
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Keep every run in this folder, which must be new or empty; `blocksim runs DIR` lists them.
    #[arg(long, value_name = "DIR")]
    pub keep: Option<PathBuf>,
    /// Replace files that are there.
    #[arg(long)]
    pub yes: bool,
    /// Draw nothing in the terminal.
    #[arg(long)]
    pub no_plot: bool,
    /// Print the table as JSON.
    #[arg(long)]
    pub json: bool,
    /// For the studio: with `--json`, print to the standard error how many runs are done.
    #[arg(long, hide = true, requires = "json")]
    pub progress: bool,
}

/// A parameter and the values that it takes, as texts.
#[derive(Debug, Clone, PartialEq)]
pub struct Over {
    /// Its name, as for `--set`.
    pub target: String,
    /// What stands behind it.
    pub values: Values,
}

/// What a parameter takes.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// These, one after another.
    Listed(Vec<String>),
    /// Any value of a range.
    Between(Span),
}

/// A range of values.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    from: f64,
    to: f64,
    unit: String,
    by_factors: bool,
}

/// Digits of a value that was chosen at random.
const DIGITS: usize = 6;

impl Over {
    /// The values that are listed; none of a range without a number.
    pub fn listed(&self) -> &[String] {
        match &self.values {
            Values::Listed(values) => values,
            Values::Between(_) => &[],
        }
    }

    /// The value at a share, from 0 up to 1, of the range or of the list.
    pub fn at(&self, share: f64) -> String {
        match &self.values {
            Values::Listed(values) => {
                let at = (share * values.len() as f64) as usize;
                values[at.min(values.len() - 1)].clone()
            }
            Values::Between(span) => span.text(span.at(share), DIGITS),
        }
    }
}

impl Span {
    fn at(&self, share: f64) -> f64 {
        match self.by_factors {
            true => self.from * (self.to / self.from).powf(share),
            false => self.from + (self.to - self.from) * share,
        }
    }

    fn text(&self, value: f64, digits: usize) -> String {
        format!("{} {}", rounded(value, digits), self.unit).trim_end().to_owned()
    }
}

/// What is measured of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Metric {
    /// Time from 10 % to 90 % of the step.
    Rise,
    /// How far the signal goes beyond its last set value.
    Overshoot,
    /// Time until it stays within 2 % of the step.
    Settling,
    /// Integral of the absolute error.
    Iae,
    /// Integral of the squared error.
    Ise,
    /// Mean error at the end.
    FinalError,
    /// Largest absolute error.
    MaximumError,
    /// Least value.
    Min,
    /// Maximum.
    Max,
    /// Maximum absolute value.
    Peak,
    /// Mean over time.
    Mean,
    /// Root of the mean square over time.
    Rms,
    /// Last value.
    Final,
}

/// Names on the command line, and as headings.
const METRICS: [(Metric, &str, &str); 13] = [
    (Metric::Rise, "rise", "rise"),
    (Metric::Overshoot, "overshoot", "overshoot"),
    (Metric::Settling, "settling", "settling"),
    (Metric::Iae, "iae", "IAE"),
    (Metric::Ise, "ise", "ISE"),
    (Metric::FinalError, "final_error", "final error"),
    (Metric::MaximumError, "maximum_error", "maximum error"),
    (Metric::Min, "min", "min"),
    (Metric::Max, "max", "max"),
    (Metric::Peak, "peak", "peak"),
    (Metric::Mean, "mean", "mean"),
    (Metric::Rms, "rms", "rms"),
    (Metric::Final, "final", "final"),
];

impl Metric {
    /// Whether it needs a set value.
    pub fn needs_set_value(self) -> bool {
        use Metric::*;
        matches!(self, Rise | Overshoot | Settling | Iae | Ise | FinalError | MaximumError)
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        METRICS.iter().find(|known| known.0 == self).map_or("", |known| known.1)
    }

    /// Its name in a heading.
    pub fn heading(self) -> &'static str {
        METRICS.iter().find(|known| known.0 == self).map_or("", |known| known.2)
    }
}

/// A number that is requested.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wanted {
    /// Which.
    pub metric: Metric,
    /// Of which signals; without it of all that have a set value.
    pub pattern: Option<String>,
}

/// `overshoot`, `peak:motor.i`.
fn wanted(text: &str) -> Result<Wanted, String> {
    let (name, pattern) = match text.split_once(':') {
        Some((name, pattern)) => (name.trim(), Some(pattern.trim()).filter(|pattern| !pattern.is_empty())),
        None => (text.trim(), None),
    };
    let Some((metric, ..)) = METRICS.iter().find(|known| known.1 == name) else {
        let names = METRICS.map(|known| known.1);
        let meant =
            closest(name, names).map_or_else(String::new, |meant| format!("; did you mean `{meant}`?"));
        return Err(format!("there is no metric `{name}`{meant} There are {}", names.join(", ")));
    };
    if pattern.is_none() && !metric.needs_set_value() {
        return Err(format!("of which signal? Write {name}:SIGNAL, such as {name}:motor.i"));
    }
    Ok(Wanted { metric: *metric, pattern: pattern.map(str::to_owned) })
}

/// `pid.kp=4,8,16`, `pid.kp=4..16/5`, or `pid.kp=4..16`.
///
/// # Errors
/// What is wrong with it.
pub fn over(text: &str) -> Result<Over, String> {
    let form = "write target=values, such as pid.kp=4,8,16 or pid.kp=4..16/5";
    let (target, values) = text.split_once('=').ok_or(form)?;
    let (target, values) = (target.trim(), values.trim());
    if target.is_empty() || values.is_empty() {
        return Err(form.to_owned());
    }
    // A name of a file may hold two points, too.
    let is_range = values.contains("..") && !values.contains(['"', '(', '\'']);
    let values = if is_range { range(values)? } else { Values::Listed(list(values)?) };
    Ok(Over { target: target.to_owned(), values })
}

/// Parts between the commas that stand in no brackets and no quotes.
fn list(text: &str) -> Result<Vec<String>, String> {
    let (mut parts, mut depth, mut quoted) = (vec![String::new()], 0_usize, false);
    for sign in text.chars() {
        match sign {
            '"' => quoted = !quoted,
            '(' | '[' | '{' if !quoted => depth += 1,
            ')' | ']' | '}' if !quoted => depth = depth.saturating_sub(1),
            ',' if !quoted && depth == 0 => {
                parts.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(part) = parts.last_mut() {
            part.push(sign);
        }
    }
    let parts: Vec<String> = parts.iter().map(|part| part.trim().to_owned()).collect();
    match parts.iter().any(String::is_empty) {
        true => Err("a value is missing between two commas".to_owned()),
        false => Ok(parts),
    }
}

/// The unit of ratios that a diagram reads in whole literals.
const DECIBEL: &str = "dB";
/// Most values of one range.
const MOST: usize = 100_000;

/// `from..to/n`: n values from one end to the other, both of them included; `from..to/nlog`: by equal factors. Without n any
/// value between them: `from..to`, `from..to/log`.
fn range(text: &str) -> Result<Values, String> {
    let form = "write from..to/n, such as 4..16/5, or from..to/nlog for equal factors";
    let (from, rest) = text.split_once("..").ok_or(form)?;
    // A unit may have a slash, too.
    let (to, last) = match rest.rsplit_once('/').map(|(to, last)| (to, last.trim())) {
        Some((to, last)) if last.ends_with("log") || last.chars().all(|sign| sign.is_ascii_digit()) => {
            (to, last)
        }
        _ => (rest, ""),
    };
    let (count, by_factors) = match last.strip_suffix("log") {
        Some(count) => (count.trim(), true),
        None => (last, false),
    };
    let span = span(from, to, by_factors)?;
    if count.is_empty() {
        return Ok(Values::Between(span));
    }
    let count: usize = count.parse().map_err(|_| form)?;
    if !(2..=MOST).contains(&count) {
        return Err(format!("a range has 2 to {MOST} values, not {count}"));
    }
    let value = |n: usize| match n {
        0 => span.from,
        _ if n == count - 1 => span.to,
        // Who asks for factors does not ask for more digits.
        _ if by_factors => rounded(span.at(n as f64 / (count - 1) as f64), 4),
        _ => span.at(n as f64 / (count - 1) as f64),
    };
    Ok(Values::Listed((0..count).map(|n| span.text(value(n), 12)).collect()))
}

fn span(from: &str, to: &str, by_factors: bool) -> Result<Span, String> {
    let ((from, unit), (to, other)) =
        (number_in(from, &is_unit_of_range)?, number_in(to, &is_unit_of_range)?);
    let unit = match (unit, other) {
        (unit, other) if unit == other => unit,
        ("", unit) | (unit, "") => unit,
        (unit, other) => {
            return Err(format!("both ends of a range have one unit, not `{unit}` and `{other}`"));
        }
    };
    if by_factors && unit == DECIBEL {
        return Err("decibels are factors already: leave `log` away".to_owned());
    }
    if by_factors && from * to <= 0.0 {
        return Err("the ends of a range by equal factors have one sign and are not zero".to_owned());
    }
    Ok(Span { from, to, unit: unit.to_owned(), by_factors })
}

/// A number and its unit, which may be empty.
///
/// # Errors
/// What is wrong with it.
pub fn number(text: &str) -> Result<(f64, &str), String> {
    number_in(text, &|unit| Unit::parse(unit).is_ok())
}

/// Steps of a range may be even in decibels, which are no factor but stand for one.
fn is_unit_of_range(unit: &str) -> bool {
    unit == DECIBEL || Unit::parse(unit).is_ok()
}

fn number_in<'t>(text: &'t str, is_unit: &dyn Fn(&str) -> bool) -> Result<(f64, &'t str), String> {
    let text = text.trim();
    let ends = text.char_indices().map(|(at, sign)| at + sign.len_utf8()).rev();
    let mut found =
        ends.filter_map(|end| Some((text[..end].trim_end().parse::<f64>().ok()?, text[end..].trim())));
    let Some((number, unit)) = found.find(|(number, _)| number.is_finite()) else {
        return Err(format!("`{text}` is not a number with or without a unit"));
    };
    match unit.is_empty() || is_unit(unit) {
        true => Ok((number, unit)),
        false => Err(format!("`{unit}` is not a unit")),
    }
}

/// With so many digits; twelve leave no dust behind the steps of a range.
fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<String> {
        over(text).unwrap().listed().to_vec()
    }

    #[test]
    fn a_list_is_cut_at_its_commas_but_not_within_brackets() {
        assert_eq!(
            over("drive = dc, asm").unwrap(),
            Over { target: "drive".into(), values: Values::Listed(vec!["dc".into(), "asm".into()]) }
        );
        assert_eq!(
            values(r#"motor=File("../a,b.ron"),File("c.ron")"#),
            [r#"File("../a,b.ron")"#, r#"File("c.ron")"#]
        );
        assert_eq!(values("gains=[1, 2],[3, 4]"), ["[1, 2]", "[3, 4]"]);
    }

    #[test]
    fn a_range_holds_both_ends_in_the_unit_of_the_user() {
        assert_eq!(values("pid.kp=4..16/5"), ["4", "7", "10", "13", "16"]);
        assert_eq!(values("l=1 mH..2 mH/3"), ["1 mH", "1.5 mH", "2 mH"]);
        assert_eq!(values("v=-1..1 m/s/3"), ["-1 m/s", "0 m/s", "1 m/s"]);
        assert_eq!(values("g=-6 dB..6 dB/3"), ["-6 dB", "0 dB", "6 dB"]);
        assert_eq!(values("k=0.1..0.7/7"), ["0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7"]);
        assert_eq!(values("k=1e-3..10/5log"), ["0.001", "0.01", "0.1", "1", "10"]);
        assert_eq!(values("k=-1..-10/4log"), ["-1", "-2.154", "-4.642", "-10"]);
    }

    #[test]
    fn a_range_without_a_number_has_a_value_at_every_share() {
        let at = |text: &str, share: f64| over(text).unwrap().at(share);
        assert_eq!(at("kp=1..2", 0.25), "1.25");
        assert_eq!(at("v=1 m/s..2 m/s", 0.5), "1.5 m/s");
        assert_eq!(at("l=1 mH..100 mH/log", 0.5), "10 mH");
        assert_eq!(["drive=dc,asm", "drive=dc,asm"].map(|text| at(text, 0.5)), ["asm", "asm"]);
        assert_eq!(at("kp=1..4/4", 0.99), "4", "one of those that are listed");
    }

    #[test]
    fn what_cannot_be_meant_is_refused_with_the_form() {
        for (wrong, said) in [
            ("kp", "write target=values"),
            ("kp=", "write target=values"),
            ("kp=1,,2", "a value is missing"),
            ("kp=1..2/x3log", "write from..to/n"),
            ("kp=1..2/1", "2 to 100000 values"),
            ("kp=1 m..2 s/3", "both ends"),
            ("kp=one..2/3", "`one` is not a number"),
            ("kp=1 parsec..2 parsec/3", "`parsec` is not a unit"),
            ("kp=0..2/3log", "one sign"),
            ("kp=3 dB..6 dB/3log", "decibels are factors already"),
            ("kp=-1..2/3log", "one sign"),
        ] {
            let error = over(wrong).unwrap_err();
            assert!(error.contains(said), "{wrong}: {error}");
        }
    }

    #[test]
    fn a_metric_of_any_signal_needs_to_know_of_which() {
        assert_eq!(wanted("overshoot").unwrap().metric, Metric::Overshoot);
        assert_eq!(wanted("peak:motor.i").unwrap().pattern.as_deref(), Some("motor.i"));
        assert!(wanted("peak").unwrap_err().contains("peak:SIGNAL"));
        assert!(wanted("overshot").unwrap_err().contains("did you mean `overshoot`?"));
    }
}
