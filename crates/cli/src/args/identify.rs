//! The command line of `blocksim identify`.

use std::path::PathBuf;

use blocksim_signal::{Unit, evaluate};
use clap::{Args, Subcommand};

use super::model::{ModelArgs, PluginArgs, SolverArgs};
use super::values::{NoNames, assignment};

/// The verbs of `blocksim identify`.
#[derive(Debug, Subcommand)]
pub enum IdentifyCommand {
    /// Measure the friction of each axis by moves at constant speed, and compare it with the parameters.
    Friction(FrictionArgs),
    /// Measure masses and inertias by an exciting motion: the base parameters, compared with the model.
    Dynamics(DynamicsArgs),
    /// Find parameters of any model with which its runs come closest to a measurement.
    Parameters(ParametersArgs),
}

impl IdentifyCommand {
    /// Whether the result is data.
    pub fn json(&self) -> bool {
        match self {
            IdentifyCommand::Friction(args) => args.common.json,
            IdentifyCommand::Dynamics(args) => args.common.json,
            IdentifyCommand::Parameters(args) => args.json,
        }
    }
}

/// What all experiments need.
#[derive(Debug, Args)]
pub struct Common {
    /// File of the model; without it diagrams/irb2600/irb2600.ron, the robot that comes with blocksim.
    pub model: Option<PathBuf>,
    /// Sets a parameter for this call, as in `blocksim run`; may be repeated.
    #[arg(long = "set", value_name = "TARGET=VALUE", value_parser = assignment)]
    pub set: Vec<String>,
    #[command(flatten)]
    pub plugins: PluginArgs,
    /// Drive of the axes; without it `torque`, where the model has this choice.
    #[arg(long, value_name = "NAME")]
    pub drive: Option<String>,
    /// File for the result, which must be new.
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace a file that is there.
    #[arg(long)]
    pub yes: bool,
    /// Print the result as JSON, an object a line.
    #[arg(long)]
    pub json: bool,
}

/// A recording in the place of experiments.
#[derive(Debug, Args)]
pub struct RecordedArgs {
    /// Evaluate a recorded motion instead of making experiments: a run (its folder, `latest`) or a CSV file.
    #[arg(long, value_name = "RUN")]
    pub from: Option<String>,
    /// Signals with the positions of the joints; `{}` stands for the number of the axis, `*` for anything.
    #[arg(long, value_name = "PATTERN", default_value = "measurements/angles/axis{}.actual")]
    pub q: String,
    /// Signals with their speeds; where there are none of `measurements/velocities/*.axis{}` they are derived.
    #[arg(long, value_name = "PATTERN", conflicts_with = "derive")]
    pub qd: Option<String>,
    /// Signals with their accelerations; where there are none of `measurements/accelerations/*.axis{}` they are derived.
    #[arg(long, value_name = "PATTERN", conflicts_with = "derive")]
    pub qdd: Option<String>,
    /// Signals with the torques on the joints.
    #[arg(long, value_name = "PATTERN", default_value = "measurements/torques/*.axis{}")]
    pub tau: String,
    /// Derive speeds and accelerations from the positions, as on a robot that measures nothing else.
    #[arg(long)]
    pub derive: bool,
    /// Cutoff of the low pass that all signals go through where derivatives are made.
    #[arg(long, value_name = "FREQUENCY", default_value = "15 Hz", value_parser = frequency)]
    pub cutoff: f64,
    /// Most instants that are evaluated; of more every second, third and so on is taken.
    #[arg(long, value_name = "N", default_value_t = 2000)]
    pub rows: usize,
}

/// `blocksim identify friction`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  blocksim identify friction my_robot.ron\n  blocksim identify friction --axis 1,4 --out friction.ron\n  \
                  blocksim identify friction --axis 1 --speeds \"10 deg/s,20 deg/s,40 deg/s,80 deg/s\"\n\n\
                  --out takes .csv (speed and torque of each move) or .ron (what was identified).\n\n\
                  From a recording:\n  blocksim identify friction --from latest\n  \
                  blocksim identify friction --from log.csv --q 'q{}' --tau 'joint_torque{}' --motor 'motor_torque{}'"
)]
pub struct FrictionArgs {
    #[command(flatten)]
    pub common: Common,
    #[command(flatten)]
    pub recorded: RecordedArgs,
    /// Signals with the torques of the motors, on their shafts; for --from.
    #[arg(long, value_name = "PATTERN", default_value = "measurements/torques/motors.motor{}")]
    pub motor: String,
    /// Axes to measure, from 1, separated by commas; all if none is given.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    pub axis: Vec<usize>,
    /// Speeds, each in both directions, separated by commas, such as `10 deg/s`; chosen by the program if none is given.
    #[arg(long, value_name = "SPEEDS", value_delimiter = ',', value_parser = speed)]
    pub speeds: Vec<f64>,
}

/// `blocksim identify dynamics`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  blocksim identify dynamics my_robot.ron\n  blocksim identify dynamics --noise 0.05 --seed 7 --out base.csv\n\n\
                  From a recording:\n  blocksim identify dynamics --from latest --predict runs/other\n  \
                  blocksim identify dynamics --from log.csv --q 'q{}' --tau 'torque{}' --cutoff \"8 Hz\""
)]
pub struct DynamicsArgs {
    #[command(flatten)]
    pub common: Common,
    #[command(flatten)]
    pub recorded: RecordedArgs,
    /// Another recording, with the same signals, whose torques are predicted by what was found.
    #[arg(long, value_name = "RUN", requires = "from")]
    pub predict: Option<String>,
    /// Noise that is added to the torques: standard deviation as a share of their root mean square.
    #[arg(long, value_name = "SHARE", default_value_t = 0.01, value_parser = share)]
    pub noise: f64,
    /// Seed of the search for a motion and of the noise.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Length of the motion, s.
    #[arg(long, value_name = "TIME", default_value = "6 s", value_parser = crate::args::values::time)]
    pub period: f64,
    /// Harmonics of the motion, from 2.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = harmonics)]
    pub harmonics: usize,
}

/// `blocksim identify parameters`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  blocksim identify parameters motor.ron --from measured.csv --of motor.k,motor.j\n  \
                  blocksim identify parameters motor.ron --from measured.csv --map 'rpm=speed.w[rpm]' --of motor.j --set motor.j=\"1e-4 kg*m^2\"\n  \
                  blocksim identify parameters motor.ron --from runs/other --of motor.k --signals 'current.*'"
)]
pub struct ParametersArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// The measurement: a CSV file whose columns are called as recorded signals, a run (its folder, `latest`), or a file that the page
    /// Results of the studio has made. Its times are those of the model.
    #[arg(long, value_name = "FILE|RUN")]
    pub from: String,
    /// What a column is: `COLUMN=SIGNAL[UNIT]`, or a file with a line for each; may be repeated.
    #[arg(long = "map", value_name = "MAPPING")]
    pub map: Vec<String>,
    /// The parameters to find, named as for `--set`, separated by commas. The search begins at the values that they have.
    #[arg(long, value_name = "TARGET", value_delimiter = ',', required = true)]
    pub of: Vec<String>,
    /// The signals to compare, of those that are measured: parts of their paths or patterns with `*`, separated by commas.
    #[arg(long, value_name = "PATTERN", value_delimiter = ',')]
    pub signals: Vec<String>,
    #[command(flatten)]
    pub solver: SolverArgs,
    /// Most steps to better values.
    #[arg(long, value_name = "N", default_value_t = 50)]
    pub steps: usize,
    /// Print the result as JSON, an object a line.
    #[arg(long)]
    pub json: bool,
}

/// A share from 0 to 1.
fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (0.0..=1.0).contains(&x) => Ok(x),
        _ => Err("a share from 0 to 1, such as 0.01".to_owned()),
    }
}

/// A number of harmonics with which a motion can start at rest.
fn harmonics(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(n) if (2..=50).contains(&n) => Ok(n),
        _ => Err("a whole number from 2 to 50".to_owned()),
    }
}

/// A frequency above zero, Hz.
fn frequency(text: &str) -> Result<f64, String> {
    let value = evaluate(text, &NoNames).map_err(|error| error.message)?;
    let quantity = value.as_number().ok_or("a frequency is a number, such as \"15 Hz\"")?;
    let fits = Unit::parse("Hz").is_ok_and(|unit| quantity.dimension == unit.dimension);
    match quantity.value {
        _ if !fits && !quantity.dimension.is_none() => Err("a frequency has the unit Hz".to_owned()),
        x if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err("a frequency here is above zero".to_owned()),
    }
}

/// A speed above zero, rad/s.
fn speed(text: &str) -> Result<f64, String> {
    let value = evaluate(text, &NoNames).map_err(|error| error.message)?;
    let quantity = value.as_number().ok_or("a speed is a number, such as \"10 deg/s\"")?;
    let fits = Unit::parse("rad/s").is_ok_and(|unit| quantity.dimension == unit.dimension);
    match quantity.value {
        _ if !fits && !quantity.dimension.is_none() => {
            Err("a speed has a unit such as deg/s or rad/s".to_owned())
        }
        x if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err("a speed here is above zero; each is run in both directions".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_have_units_or_are_radians_per_second() {
        assert_eq!(speed("2"), Ok(2.0));
        assert!(speed("180 deg/s").is_ok_and(|x| (x - std::f64::consts::PI).abs() < 1e-12));
        for wrong in ["0", "-1 deg/s", "3 m", "fast", "1/0"] {
            assert!(speed(wrong).is_err(), "{wrong}");
        }
    }
}
