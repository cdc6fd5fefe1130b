//! The command line of `blocksim linearise`.

use std::path::PathBuf;

use super::model::ModelArgs;
use super::plot::ThemeName;
use super::sweep::{Over, over};
use super::values::{moment, positive, time};

/// `blocksim linearise`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Signals are named as they are recorded, or by block and port: `angle.actual`, `pid.u`. Without signals the \
                  poles of the whole model are printed. Modes stay as they are at that instant: what sticks goes on sticking, and \
                  without --sampled what is sampled is held.\n\nExamples:\n  \
                  blocksim linearise servo.ron --open pid.u --at 0.3s\n  \
                  blocksim linearise servo.ron --open pid.u --sampled --chart nyquist --png nyquist.png\n  \
                  blocksim linearise servo.ron --from demand.y --to encoder.phi,motor.i --png servo.png\n  \
                  blocksim linearise servo.ron --from volts.y --to encoder.w --open pid.u --steady --json\n  \
                  blocksim linearise servo.ron --at 0.3s --locus=pid.kp=1..100/60log --png locus.png"
)]
pub struct LineariseArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// Signal that is changed, for all that read it.
    #[arg(long, value_name = "SIGNAL", requires = "to")]
    pub from: Option<String>,
    /// Signals that answer, separated by commas.
    #[arg(long, value_name = "SIGNAL", value_delimiter = ',', requires = "from")]
    pub to: Vec<String>,
    /// Cut the loops that go through these signals, separated by commas. Without --from the loop through the first of them
    /// is measured, once around, as for a negative feedback.
    #[arg(long, value_name = "SIGNAL", value_delimiter = ',')]
    pub open: Vec<String>,
    /// Run to this instant first, such as `0.5s`.
    #[arg(long, value_name = "TIME", value_parser = moment, default_value = "0", hide_default_value = true)]
    pub at: f64,
    /// Look for states at which nothing moves, beginning with those at that instant.
    #[arg(long)]
    pub steady: bool,
    /// Linearise in discrete time, from one sample hit to that a period later, with all hits in between. Without a period the
    /// shortest one that the sample times on the way have in common.
    #[arg(long, value_name = "PERIOD", value_parser = time, num_args = 0..=1, require_equals = true)]
    pub sampled: Option<Option<f64>>,
    /// Where the poles go: of the loop that --open cuts, closed again with its gain from zero upwards; or of the model, over values of a
    /// parameter as for `blocksim sweep`, `pid.kp=1..100/60log`.
    #[arg(long, value_name = "TARGET=VALUES", value_parser = over, num_args = 0..=1, require_equals = true)]
    pub locus: Option<Option<Over>>,
    /// What --svg and --png draw; without it magnitude and phase, or what else there is.
    #[arg(long, value_enum, value_name = "CHART")]
    pub chart: Option<Chart>,
    /// Write the chart as a drawing.
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// Write the chart as a picture.
    #[arg(long, value_name = "FILE")]
    pub png: Option<PathBuf>,
    /// Write magnitude and phase over frequency as a table.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Replace files that are there.
    #[arg(long)]
    pub yes: bool,
    /// Colours of drawing and picture.
    #[arg(long, value_enum, default_value_t = ThemeName::Light, value_name = "THEME")]
    pub theme: ThemeName,
    /// Dots of the picture for a dot of the drawing.
    #[arg(long, value_name = "X", default_value_t = 2.0, value_parser = positive)]
    pub scale: f64,
    /// Draw nothing in the terminal.
    #[arg(long)]
    pub no_plot: bool,
    /// Print the matrices, poles, zeros and margins as JSON, and no plots.
    #[arg(long)]
    pub json: bool,
    /// With --json: the frequency response and the step response of each way as well, point by point; of a loop the step response of
    /// the closed loop.
    #[arg(long, requires = "json")]
    pub curves: bool,
}

/// What can be drawn of a linear system.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Chart {
    /// Magnitude and phase over frequency.
    Bode,
    /// The loop gain in the complex plane, with the critical point.
    Nyquist,
    /// Poles and zeros.
    Poles,
    /// Where the poles go, with --locus.
    Locus,
}
