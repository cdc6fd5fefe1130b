//! The command lines of `blocksim run`, `check` and `emit`, which take a model.

use std::path::PathBuf;

use clap::ValueEnum;

use super::values::{assignment, change, moment, positive, speed, time};
use crate::running::selection::{Wanted, wanted};
use crate::running::tuning::When;

/// A model and what to change in it.
#[derive(Debug, clap::Args)]
pub struct ModelArgs {
    /// File of the model.
    pub model: PathBuf,
    /// Sets a parameter for this call: `drive=dc`, `robot.axis1.gear.ring_teeth=51`, `pid.kp=40`; may be repeated.
    #[arg(long = "set", value_name = "TARGET=VALUE", value_parser = assignment)]
    pub set: Vec<String>,
    #[command(flatten)]
    pub plugins: PluginArgs,
}

/// What may become of the plug-ins that a model names.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct PluginArgs {
    /// Trust the plug-ins that the model names from now on, so that they are built and loaded; to run a model does this anyway.
    #[arg(long, conflicts_with = "no_plugins")]
    pub trust: bool,
    /// Build and load no plug-ins; blocks of plug-ins are shown as they were when they were loaded last.
    #[arg(long)]
    pub no_plugins: bool,
    /// Run plug-ins in processes of their own, so that none of them can end or damage this one. The numbers are the same, each
    /// call takes some 20 us more.
    #[arg(long)]
    pub isolate: bool,
    /// Longest time that a call of a plug-in may take; without it 10 s.
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub call_limit: Option<f64>,
}

/// How long a model is simulated, and by which method.
#[derive(Debug, clap::Args)]
pub struct SolverArgs {
    /// End of the simulation, such as `10`, `10s` or `250ms`.
    #[arg(long, allow_hyphen_values = true, value_name = "TIME", value_parser = time)]
    pub until: Option<f64>,
    /// Method: auto, ode45, ode23, dop853, ode15s, radau5, rodas4, ode23tb, ode23t, rosw3 (variable step), ode1 to ode5 (fixed step).
    #[arg(long, value_name = "NAME")]
    pub solver: Option<String>,
    /// Relative tolerance of a method of variable step.
    #[arg(long, allow_hyphen_values = true, value_name = "X", value_parser = positive)]
    pub rtol: Option<f64>,
    /// Absolute tolerance of a method of variable step, in SI units of every state; without it each state has its own,
    /// which follows its size.
    #[arg(long, allow_hyphen_values = true, value_name = "X", value_parser = positive)]
    pub atol: Option<f64>,
    /// Step of a method of fixed step, or the maximum one of a method of variable step.
    #[arg(long, allow_hyphen_values = true, value_name = "TIME", value_parser = time)]
    pub step: Option<f64>,
}

/// `blocksim run`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  blocksim run servo.ron\n  blocksim run servo.ron --set pid.kp=12 --until \"500 ms\"\n  \
                        blocksim run servo.ron --plot 'angle.*' --out before\n  blocksim run servo.ron --signals 'angle.*,motor.**@10ms'"
)]
pub struct RunArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub solver: SolverArgs,
    /// Folder for the results, which must be new or empty; without it `runs/<time>_<model>`.
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Change a parameter while the run goes on, at a time: `0.5s:pid.kp=12`; may be repeated.
    /// `after 0.5s:pid.kp=12` waits for the end of the step that reaches the time, as a change in the studio does.
    /// Numbers may change, but not which blocks and states there are; values at the start have no effect any more.
    #[arg(long, value_name = "TIME:TARGET=VALUE", value_parser = change, allow_hyphen_values = true,
        conflicts_with_all = ["audit", "verify"])]
    pub change: Vec<(When, String)>,
    /// Record further signals, as `record` of the diagram does: patterns of their paths, separated by commas.
    #[arg(long, value_name = "PATTERN", value_delimiter = ',')]
    pub record: Vec<String>,
    /// Signals to keep, of those that the diagram records: parts of their paths or patterns with `*`, separated by
    /// commas. A rate may follow: `arm/**@10ms`, `arm/**@10rows`, or the minimum and maximum with `@minmax:10ms`.
    #[arg(long, value_name = "PATTERN[@RATE]", value_delimiter = ',', value_parser = wanted)]
    pub signals: Vec<Wanted>,
    /// Write the signals as CSV however many they are; without this only up to about 200 MB.
    #[arg(long, conflicts_with = "no_csv")]
    pub csv: bool,
    /// Write no CSV, only the recording.
    #[arg(long)]
    pub no_csv: bool,
    /// Signals to plot: parts of their paths or patterns with `*`, separated by commas.
    #[arg(long, value_name = "PATTERN", value_delimiter = ',', conflicts_with = "no_plot")]
    pub plot: Vec<String>,
    /// Draw nothing.
    #[arg(long)]
    pub no_plot: bool,
    /// Make a page of the run, `report.html` in the folder of the results.
    #[arg(long)]
    pub report: bool,
    /// Look at all conditions on a fine grid within each step and list the changes that the run has passed over, if any; vary each
    /// state in the end, and list what depends on it although no block declares that.
    /// The results stay the same; the run takes several times as long.
    #[arg(long)]
    pub audit: bool,
    /// Run the model again a hundred times more exactly (with half the step, where that is fixed) and report how far all recorded
    /// signals are from that, at a thousand times. The run takes several times as long.
    #[arg(long)]
    pub verify: bool,
    /// Compile what the blocks record as data to native code, with the C compiler of the system, in the place of interpreting it.
    /// The results are the same to the bit. What was compiled before is used again.
    #[arg(long)]
    pub native: bool,
    /// Run again whenever a file of the model or a source of a plug-in changes, each time into a folder of its own.
    #[arg(long, conflicts_with = "out")]
    pub watch: bool,
    /// Say only what is wrong, and print the folder of the results.
    #[arg(long, short, conflicts_with = "json")]
    pub quiet: bool,
    /// Print problems, progress and the result as JSON, one object a line.
    #[arg(long)]
    pub json: bool,
    /// For the studio: with `--json`, print what scopes show while it runs, and do what lines of JSON on the standard input
    /// say. The run goes at so many times real time, 0 for as fast as it can, and ends where the standard input ends.
    #[arg(long, hide = true, requires = "json", value_name = "SPEED", value_parser = speed)]
    pub live: Option<f64>,
    /// With `--live`: go as fast as it can up to this time, whatever the speed, to where another run of the model was.
    #[arg(long, hide = true, requires = "live", value_name = "TIME", value_parser = moment)]
    pub catch_up: Option<f64>,
    /// With `--live`: stand still at first, behind the time of `--catch-up` if there is one.
    #[arg(long, hide = true, requires = "live")]
    pub paused: bool,
}

/// `blocksim check`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  blocksim check servo.ron\n  blocksim check servo.ron --watch\n  \
                        blocksim check servo.ron --fix      fix what has one likely remedy, and show it")]
pub struct CheckArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// How problems are printed: with the text around them, a line each, or as JSON, an object a line.
    #[arg(long, value_enum, default_value_t = Format::Full, value_name = "FORMAT")]
    pub output_format: Format,
    /// Fix the problems that have one likely remedy, such as a name spelt wrong or a missing comma, in the texts of the
    /// model; shows each change.
    #[arg(long, conflicts_with = "watch")]
    pub fix: bool,
    /// What a number without a unit means: in SI, with an open unit where the place has none (open), or an error where the place
    /// has a unit and a number of no unit elsewhere (strict).
    #[arg(long, value_enum, default_value_t = UnitsName::Open, value_name = "HOW")]
    pub units: UnitsName,
    /// Check again whenever a file of the model or a source of a plug-in changes.
    #[arg(long)]
    pub watch: bool,
}

/// What a number without a unit means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum UnitsName {
    /// It is in SI where the place has a unit, and fits any unit elsewhere.
    Open,
    /// It is an error where the place has a unit, and has no unit elsewhere.
    Strict,
}

impl From<UnitsName> for blocksim_diagram::Units {
    fn from(name: UnitsName) -> Self {
        match name {
            UnitsName::Open => Self::Open,
            UnitsName::Strict => Self::Strict,
        }
    }
}

/// How problems are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// With the text around them.
    Full,
    /// A line each.
    Short,
    /// A JSON object a line, on the standard output.
    Json,
}

/// `blocksim emit`.
#[derive(Debug, clap::Args)]
pub struct EmitArgs {
    /// Which step.
    #[arg(value_enum)]
    pub stage: StageName,
    #[command(flatten)]
    pub model: ModelArgs,
}

/// The steps of the compiler whose result can be printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StageName {
    /// Files as read.
    Ast,
    /// Parameters and variants resolved.
    Model,
    /// All blocks and connections without levels.
    Flat,
    /// Types and sample times of all ports.
    Types,
    /// The order of evaluation, and where every value lies.
    Schedule,
    /// What the engine runs: the laws of blocks joined to programs, pass by pass, and what it calls.
    Program,
    /// What is seen of mechanisms, as JSON: bodies, joints, shapes, masses, frames.
    Scene,
}
