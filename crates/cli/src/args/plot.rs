//! The command lines of `blocksim plot` and `blocksim compare`.

use std::path::PathBuf;

use blocksim_signal::{Dimension, Unit};
use clap::{Args, ValueEnum};

use super::values::{difference, moment, positive, quantity};

/// `blocksim plot`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  blocksim plot latest                                  all scopes in the terminal\n  \
                  blocksim plot latest joint1 joint2 --from 0.2 --to 1\n  \
                  blocksim plot runs/before --with runs/after --svg both.svg\n  \
                  blocksim plot latest --with measured.csv --map 'q1=control/joint1/scope.actual[deg]'\n  \
                  blocksim plot latest --metrics --png report.png --theme dark"
)]
pub struct PlotArgs {
    /// The run: its folder, its name or the beginning of it, `latest`, or a table (CSV).
    pub run: String,
    /// Signals: parts of their paths or patterns with `*`; what scopes show if none is given.
    pub signals: Vec<String>,
    /// Another run or a table, drawn into the same pictures; may be repeated.
    #[arg(long = "with", value_name = "RUN")]
    pub with: Vec<String>,
    /// Begin of what is shown.
    #[arg(long, value_name = "TIME", value_parser = moment, allow_hyphen_values = true)]
    pub from: Option<f64>,
    /// End of what is shown.
    #[arg(long, value_name = "TIME", value_parser = moment, allow_hyphen_values = true)]
    pub to: Option<f64>,
    /// Unit to show signals of its kind in, such as `rad` or `rpm`; may be repeated.
    #[arg(long = "unit", value_name = "UNIT", value_parser = unit)]
    pub units: Vec<Unit>,
    /// What shares a picture.
    #[arg(long, value_enum, default_value_t = Layout::Scopes, value_name = "LAYOUT")]
    pub layout: Layout,
    /// Writes a drawing.
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// Writes a picture.
    #[arg(long, value_name = "FILE")]
    pub png: Option<PathBuf>,
    /// Replace files that are there.
    #[arg(long)]
    pub yes: bool,
    /// Colours of drawing and picture.
    #[arg(long, value_enum, default_value_t = ThemeName::Light, value_name = "THEME")]
    pub theme: ThemeName,
    /// Width of the drawing, dots.
    #[arg(long, value_name = "DOTS", default_value_t = 960, value_parser = clap::value_parser!(u32).range(240..=8000))]
    pub width: u32,
    /// Pictures side by side; without it two, one where there are few.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=8))]
    pub columns: Option<u8>,
    /// Page of the drawing, where all pictures do not fit on one.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub page: u32,
    /// Dots of the picture for a dot of the drawing.
    #[arg(long, value_name = "X", default_value_t = 2.0, value_parser = positive)]
    pub scale: f64,
    /// Prints how actual values track their set values: rise, overshoot, settling, errors. Of signals that are named and
    /// follow no set value, how they come to their last value.
    #[arg(long)]
    pub metrics: bool,
    /// Prints the metrics as JSON, and no plots.
    #[arg(long)]
    pub json: bool,
    /// What the columns of tables are called here: `COLUMN=PATH[unit]`, or a file of such lines; may be repeated.
    #[arg(long = "map", value_name = "MAPPING")]
    pub map: Vec<String>,
}

/// What shares a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Layout {
    /// The signals of each scope.
    Scopes,
    /// Each signal has its own.
    Signals,
    /// All signals of one unit.
    Units,
}

/// Colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ThemeName {
    /// On white.
    Light,
    /// On dark blue.
    Dark,
}

impl From<ThemeName> for blocksim_picture::Theme {
    fn from(name: ThemeName) -> blocksim_picture::Theme {
        match name {
            ThemeName::Light => blocksim_picture::Theme::Light,
            ThemeName::Dark => blocksim_picture::Theme::Dark,
        }
    }
}

fn unit(text: &str) -> Result<Unit, String> {
    Unit::parse(text).map_err(|error| match error.help {
        Some(help) => format!("{}; {help}", error.message),
        None => error.message,
    })
}

/// `blocksim compare`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  blocksim compare runs/before runs/after --rel 1e-6\n  \
                  blocksim compare latest measured.csv --abs 0.1deg --align correlation --map 'q1=control/joint1/scope.actual[deg]'\n  \
                  blocksim compare a.csv b.csv --abs 1e-9 --json\n\n\
                  Exit codes: 0 all signals agree, 1 some differ or are missing, 2 usage, 4 files.")]
pub struct CompareArgs {
    /// The baseline: a run (folder, name or `latest`) or a table (CSV).
    pub baseline: String,
    /// What is compared with it.
    pub other: String,
    /// Signals: parts of their paths or patterns with `*`; all of the baseline if none is given.
    #[arg(long, short, value_name = "PATTERN", value_delimiter = ',')]
    pub signals: Vec<String>,
    /// Absolute tolerance, such as `0.1deg` or `2 N*m`, for signals of this kind; a plain number holds for all, in SI.
    #[arg(long = "abs", value_name = "X", value_parser = tolerance, allow_hyphen_values = true)]
    pub absolute: Vec<Tolerance>,
    /// Relative tolerance, share of the baseline's size at each instant: `1e-3` or `0.1%`.
    #[arg(long = "rel", value_name = "X", default_value_t = 0.0, value_parser = share, allow_hyphen_values = true)]
    pub relative: f64,
    /// Tolerance as a share of the range that the baseline has in the run, its maximum less its minimum: `1e-3` or `0.1%`.
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = share, allow_hyphen_values = true)]
    pub range: f64,
    /// How much earlier or later a value may come.
    #[arg(long, value_name = "TIME", default_value_t = 0.0, value_parser = duration)]
    pub time_tolerance: f64,
    /// What signals are between their values; `smooth` if absent, but whole and truth values are held.
    #[arg(long, value_enum, value_name = "KIND")]
    pub interpolation: Option<Between>,
    /// Where signals are compared: at each instant at which either has a value, or only where both have one.
    #[arg(long, value_enum, default_value_t = Sync::Union, value_name = "WHERE")]
    pub sync: Sync,
    /// Moves the other recording in time: so that both start together, or agree best.
    #[arg(long, value_enum, value_name = "HOW", conflicts_with = "shift")]
    pub align: Option<Align>,
    /// Adds this to the times of the other recording.
    #[arg(long, value_name = "TIME", value_parser = moment, allow_hyphen_values = true)]
    pub shift: Option<f64>,
    /// Compares what both cover, even if one is shorter.
    #[arg(long)]
    pub overlap: bool,
    /// Compares what both have, even if a signal of the baseline is missing.
    #[arg(long)]
    pub common: bool,
    /// What the columns of tables are called here: `COLUMN=PATH[unit]`, or a file of such lines; may be repeated.
    #[arg(long = "map", value_name = "MAPPING")]
    pub map: Vec<String>,
    /// Draws both and their difference.
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// The same as a picture.
    #[arg(long, value_name = "FILE")]
    pub png: Option<PathBuf>,
    /// Page of the drawing, where all pictures do not fit on one.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub page: u32,
    /// Write a page with the baseline and, in thinner lines, the other one, as `blocksim report` makes it.
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Replace files that are there.
    #[arg(long)]
    pub yes: bool,
    /// Colours of drawing and picture.
    #[arg(long, value_enum, default_value_t = ThemeName::Light, value_name = "THEME")]
    pub theme: ThemeName,
    /// Prints the result as JSON.
    #[arg(long)]
    pub json: bool,
}

impl CompareArgs {
    /// As written without any option, but that what both cover is compared.
    pub fn of(baseline: String, other: String) -> CompareArgs {
        CompareArgs {
            baseline,
            other,
            signals: Vec::new(),
            absolute: Vec::new(),
            relative: 0.0,
            range: 0.0,
            time_tolerance: 0.0,
            interpolation: None,
            sync: Sync::Union,
            align: None,
            shift: None,
            overlap: true,
            common: true,
            map: Vec::new(),
            svg: None,
            png: None,
            page: 1,
            html: None,
            yes: false,
            theme: ThemeName::Light,
            json: false,
        }
    }
}

/// A tolerance in SI and what it is for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// The number.
    pub value: f64,
    /// What it measures; none for all signals.
    pub dimension: Option<Dimension>,
}

/// What signals are between their values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Between {
    /// On the cubic through the values around them where the signal is smooth, else on the straight line.
    Smooth,
    /// On the straight line between them.
    Linear,
    /// The earlier one, held.
    Zoh,
}

/// At which instants signals are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Sync {
    /// Where either has a value.
    Union,
    /// Where both have one.
    Intersection,
}

/// How recordings are brought together in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Align {
    /// Their first values come together.
    Start,
    /// Their signals agree best: the maximum cross-correlation.
    Correlation,
}

/// A tolerance with the unit of the signals that it is for, or for all signals.
pub fn tolerance(text: &str) -> Result<Tolerance, String> {
    let quantity = difference(text, "a tolerance is a number, such as 1e-6 or 0.1deg")?;
    match quantity.value {
        value if value >= 0.0 && value.is_finite() => {
            let dimension = (quantity.dimension != Dimension::NONE).then_some(quantity.dimension);
            Ok(Tolerance { value, dimension })
        }
        _ => Err("a tolerance is not below zero".to_owned()),
    }
}

fn share(text: &str) -> Result<f64, String> {
    let quantity = quantity(text, "a relative tolerance is a number, such as 1e-3 or 0.1%")?;
    match quantity.value {
        _ if quantity.dimension != Dimension::NONE => Err("a relative tolerance has no unit".to_owned()),
        value if value >= 0.0 && value.is_finite() => Ok(value),
        _ => Err("a tolerance is not below zero".to_owned()),
    }
}

/// A time that is allowed, s: not below zero.
pub fn duration(text: &str) -> Result<f64, String> {
    moment(text).and_then(|t| if t >= 0.0 { Ok(t) } else { Err("a tolerance is not below zero".to_owned()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_have_a_unit_or_hold_for_all() {
        let deg = tolerance("0.1deg").unwrap();
        assert!((deg.value - 0.1_f64.to_radians()).abs() < 1e-15);
        assert_eq!(deg.dimension, Unit::parse("rad").ok().map(|unit| unit.dimension));
        assert_eq!(tolerance("1e-6").unwrap(), Tolerance { value: 1e-6, dimension: None });
        assert_eq!(tolerance("2 N*m").unwrap().value, 2.0);
        for half in ["0.5degC", "0.5 degC", "0.5 °C", "0.5 [degC]", "0.5 K", "500 mK"] {
            let kelvin = Unit::parse("K").ok().map(|unit| unit.dimension);
            assert_eq!(tolerance(half), Ok(Tolerance { value: 0.5, dimension: kelvin }), "{half}");
        }
        assert_eq!(share("0.1%"), Ok(1e-3));
        for wrong in ["-1", "-1 degC", "deg", "1/0", "", "[1]"] {
            assert!(tolerance(wrong).is_err() && share(wrong).is_err(), "{wrong}");
        }
        assert!(share("1 m").is_err() && duration("-1s").is_err());
        assert_eq!(duration("5 ms"), Ok(0.005));
    }
}
