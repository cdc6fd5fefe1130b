//! What makes no robot.

use blocksim_multibody::ModelError;
use std::fmt;

/// Why parts make no robot.
#[derive(Debug, Clone, PartialEq)]
pub enum RobotError {
    /// There is no link.
    NoLinks,
    /// A link does not fit the mechanism: its number from 0 and what is wrong.
    Link {
        /// The link, counted from 0.
        link: usize,
        /// What is wrong.
        cause: ModelError,
    },
    /// A number of a link that must be finite, ordered or positive is not; the text is a member of the link such as
    /// `limits.upper`.
    Number {
        /// The link, counted from 0.
        link: usize,
        /// Member of the link.
        member: &'static str,
        /// The fact.
        message: String,
    },
    /// A frame (`base`, `reference`, `flange`, `tool`) or `gravity` has a number that is not finite.
    NotFinite {
        /// The frame.
        member: &'static str,
    },
    /// A limit of the tool centre point is not positive.
    TcpLimit {
        /// `tcp_limits.speed` or `tcp_limits.acceleration`.
        member: &'static str,
        /// m/s or m/s².
        value: f64,
    },
}

impl RobotError {
    /// The member of the description that is at fault: `links[2].limits.upper`.
    pub fn member(&self) -> String {
        match self {
            RobotError::NoLinks => "links".to_owned(),
            RobotError::Link { link, .. } => format!("links[{link}]"),
            RobotError::Number { link, member, .. } => format!("links[{link}].{member}"),
            RobotError::NotFinite { member } | RobotError::TcpLimit { member, .. } => (*member).to_owned(),
        }
    }
}

impl fmt::Display for RobotError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            RobotError::NoLinks => f.write_str("the robot has no links"),
            RobotError::Link { cause, .. } => cause.fmt(f),
            RobotError::Number { message, .. } => f.write_str(message),
            RobotError::NotFinite { member } => write!(f, "`{member}` holds a number that is not finite"),
            RobotError::TcpLimit { member, value } => write!(f, "`{member}` is {value}; it must be positive"),
        }
    }
}

impl std::error::Error for RobotError {}
