//! The command line of `blocksim plan`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::values::assignment;

/// The verbs of `blocksim plan`.
#[derive(Debug, Subcommand)]
pub enum PlanCommand {
    /// A move of all axes to given positions.
    Joint(JointArgs),
    /// A line of the tool.
    Linear(LinearArgs),
    /// An arc of the tool through a point.
    Circular(CircularArgs),
    /// The moves of a file, one behind the other.
    Sequence(SequenceArgs),
}

impl PlanCommand {
    /// What all moves need.
    pub fn common(&self) -> &PlanCommon {
        match self {
            PlanCommand::Joint(args) => &args.common,
            PlanCommand::Linear(args) => &args.tool.common,
            PlanCommand::Circular(args) => &args.tool.common,
            PlanCommand::Sequence(args) => &args.common,
        }
    }
}

/// What all moves need.
#[derive(Debug, Args)]
pub struct PlanCommon {
    /// Diagram with the parameter `manipulator`, or a file that describes a robot.
    #[arg(long, value_name = "MODEL", default_value = "diagrams/irb2600/irb2600.ron")]
    pub robot: PathBuf,
    /// Sets a parameter of the diagram for this call, as in `blocksim run`; may be repeated.
    #[arg(long = "set", value_name = "TARGET=VALUE", value_parser = assignment)]
    pub set: Vec<String>,
    /// What stands around the robot: a file with its shapes, or a diagram with the parameter `surroundings`; without it, that of
    /// the model, where it has one.
    #[arg(long, value_name = "FILE")]
    pub surroundings: Option<PathBuf>,
    /// File for the move, which must be new.
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace a file that is there.
    #[arg(long)]
    pub yes: bool,
    /// Accept a move that exceeds limits or hits something: it is written all the same, and the exit code is 0.
    #[arg(long)]
    pub accept_violations: bool,
    /// Print what was found as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Where a move begins.
#[derive(Debug, Args)]
pub struct FromArgs {
    /// Positions of the axes at the start, such as "0 deg, 10 deg, ..." (bare numbers are degrees); without it those of the
    /// description.
    #[arg(long, value_name = "POSITIONS", allow_hyphen_values = true)]
    pub from: Option<String>,
}

/// `blocksim plan joint`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  blocksim plan joint --to \"60 deg, 30 deg, -20 deg, 45 deg, 60 deg, 90 deg\" --velocity \"40 %\" \
                  --out moves/pick.ron"
)]
pub struct JointArgs {
    #[command(flatten)]
    pub common: PlanCommon,
    #[command(flatten)]
    pub from: FromArgs,
    /// Positions of the axes at the end; bare numbers are degrees.
    #[arg(long, value_name = "POSITIONS", allow_hyphen_values = true)]
    pub to: String,
    /// Share of the maximum speed of each axis; a bare number is per cent.
    #[arg(long, allow_hyphen_values = true, value_name = "SHARE", default_value = "40 %")]
    pub velocity: String,
    /// Share of the move time spent accelerating; a bare number is per cent.
    #[arg(long, allow_hyphen_values = true, value_name = "SHARE", default_value = "30 %")]
    pub acceleration: String,
}

/// How the tool goes.
#[derive(Debug, Args)]
pub struct ToolArgs {
    #[command(flatten)]
    pub common: PlanCommon,
    #[command(flatten)]
    pub from: FromArgs,
    /// Where the tool begins, such as "1 m, 100 mm, 1.3 m" (bare numbers are mm), in the place of `--from`.
    #[arg(long, value_name = "POINT", allow_hyphen_values = true, conflicts_with = "from")]
    pub from_point: Option<String>,
    /// ZYX Euler angles of the tool there, bare numbers in degrees; without them they are left to the axes.
    #[arg(long, value_name = "ANGLES", allow_hyphen_values = true, requires = "from_point")]
    pub from_rotation: Option<String>,
    /// The configuration in which the arm begins: shoulder, elbow and wrist, such as `front-up-plain`. Without it, `--from`
    /// keeps its positions, and of a point the nearest configuration is taken that can go the whole way.
    #[arg(long, value_name = "WORD")]
    pub configuration: Option<String>,
    /// Where the tool goes, in the reference frame of the robot; bare numbers are mm.
    #[arg(long, value_name = "POINT", allow_hyphen_values = true)]
    pub to: String,
    /// What its orientation does: free, fixed, interpolated or tool-axis.
    #[arg(long, value_name = "WORD", default_value = "free")]
    pub orientation: String,
    /// ZYX Euler angles at the target, for `--orientation interpolated`; bare numbers are degrees.
    #[arg(long, value_name = "ANGLES", allow_hyphen_values = true)]
    pub rotation: Option<String>,
    /// Speed of the tool; a bare number is mm/s.
    #[arg(long, allow_hyphen_values = true, value_name = "SPEED", default_value = "250 mm/s")]
    pub velocity: String,
    /// Share of the maximum acceleration of the tool; a bare number is per cent.
    #[arg(long, allow_hyphen_values = true, value_name = "SHARE", default_value = "20 %")]
    pub acceleration: String,
    /// How fast the tool may turn, on the spot or along an interpolated path; 90 deg/s if not given. A bare number is deg/s.
    #[arg(long, allow_hyphen_values = true, value_name = "SPEED")]
    pub rotation_velocity: Option<String>,
    /// Angular acceleration of the tool; 180 deg/s^2 if not given. A bare number is deg/s^2.
    #[arg(long, allow_hyphen_values = true, value_name = "ACCELERATION")]
    pub rotation_acceleration: Option<String>,
    /// How the speed rises and falls: sin2, trapezoid, s-curve or time-optimal.
    #[arg(long, value_name = "WORD", default_value = "sin2")]
    pub profile: String,
    /// Distance of waypoints; a bare number is mm.
    #[arg(long, allow_hyphen_values = true, value_name = "LENGTH", default_value = "1 mm")]
    pub resolution: String,
    /// How near the move may come to a singular pose: the smallest singular value, in m and rad; 0.01 if not given.
    #[arg(long, allow_hyphen_values = true, value_name = "NUMBER")]
    pub singular_limit: Option<String>,
}

/// `blocksim plan linear`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  blocksim plan linear --from-point \"1000 mm, 100 mm, 1300 mm\" --to \"1200 mm, -300 mm, 900 mm\" \
                  --velocity \"250 mm/s\" --out moves/weld.ron"
)]
pub struct LinearArgs {
    #[command(flatten)]
    pub tool: ToolArgs,
}

/// `blocksim plan circular`.
#[derive(Debug, Args)]
pub struct CircularArgs {
    #[command(flatten)]
    pub tool: ToolArgs,
    /// A point that the arc passes; bare numbers are mm.
    #[arg(long, value_name = "POINT", allow_hyphen_values = true)]
    pub via: String,
}

/// `blocksim plan sequence`.
#[derive(Debug, Args)]
pub struct SequenceArgs {
    #[command(flatten)]
    pub common: PlanCommon,
    /// A file with a move: `JointMove(start: [...], tool: (...), moves: [...])`.
    pub file: PathBuf,
}
