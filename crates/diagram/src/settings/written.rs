//! The words and numbers of `simulation: (...)`.

use std::collections::BTreeMap;

use blocksim_block::ParamValue;
use blocksim_block::schedule::LoopPolicy;
use blocksim_signal::{Dimension, Unit, Value};
use serde::{Deserialize, Deserializer};

use crate::de::{Either, word_or};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Simulation {
    pub stop_time: Option<Stop>,
    pub solver: Option<Method>,
    pub output: Option<Output>,
    #[serde(default)]
    pub seed: u64,
    pub start: Option<Begin>,
    #[serde(default)]
    pub atol: BTreeMap<String, ParamValue>,
    #[serde(default)]
    pub algebraic_loops: LoopPolicy,
}

/// Where a run begins.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) enum Begin {
    Given,
    Steady {
        #[serde(default)]
        hold: BTreeMap<String, ParamValue>,
        #[serde(default)]
        free: Vec<String>,
        #[serde(default)]
        drift: Vec<String>,
    },
}

/// A time in s with its unit checked.
pub(crate) struct Seconds(pub f64);

impl<'de> Deserialize<'de> for Seconds {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        quantity(deserializer, "s").map(Seconds)
    }
}

/// A number without unit.
pub(crate) struct Plain(pub f64);

impl<'de> Deserialize<'de> for Plain {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        quantity(deserializer, "1").map(Plain)
    }
}

fn quantity<'de, D: Deserializer<'de>>(deserializer: D, unit: &str) -> Result<f64, D::Error> {
    let value = ParamValue::deserialize(deserializer)?.0;
    let Value::Number(quantity) = value else {
        return Err(serde::de::Error::custom(format!("expected a number, found {}", value.describe())));
    };
    let wanted = Unit::parse(unit).map_or(Dimension::NONE, |unit| unit.dimension);
    if quantity.dimension != Dimension::NONE && !wanted.takes(quantity.dimension) {
        return Err(serde::de::Error::custom(format!(
            "expected a value in {wanted}, found one in {}",
            quantity.dimension
        )));
    }
    Ok(quantity.value)
}

pub(super) enum Stop {
    At(f64),
    Auto(f64),
}

impl<'de> Deserialize<'de> for Stop {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        enum Auto {
            Auto { margin: Option<Seconds> },
        }
        // `Auto` is a word, a time is a number or a text.
        match word_or(deserializer)? {
            Either::Word(Auto::Auto { margin }) => Ok(Stop::Auto(margin.map_or(0.5, |margin| margin.0))),
            Either::Other(Seconds(time)) => Ok(Stop::At(time)),
        }
    }
}

#[derive(Deserialize)]
pub(super) enum Output {
    Steps,
    Every(Seconds),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) enum Method {
    Ode1 { step: Seconds },
    Ode2 { step: Seconds },
    Ode3 { step: Seconds },
    Ode4 { step: Seconds },
    Ode5 { step: Seconds },
    Auto { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
    Dop853 { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
    Ode23t { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
    Ode23tb { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
    Ode15s { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
    Ode23 { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
    Ode45 { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
    Radau5 { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
    Rodas4 { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
    RosW3 { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
}
