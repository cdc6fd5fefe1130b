//! `simulation: (...)`: stop time, method, tolerances, output.

use std::rc::Rc;

use blocksim_block::problem::Problem;
use blocksim_block::schedule::{FixedMethod, OutputTimes, Settings, Solver, VariableMethod};
use blocksim_block::{BlockInfo, ParameterInfo};
use serde::Deserialize;

use crate::ast::Ast;
use crate::de::{Reading, Written};
use crate::problems::Problems;
use crate::scope::Scope;

/// Units of the numbers in `simulation`, for the checks that parameters of blocks have.
static INFO: BlockInfo = BlockInfo {
    kind: "simulation",
    category: "",
    doc: "",
    parameters: &[ParameterInfo { name: "seed", rust_type: "u64", unit: "1", default: Some("0"), doc: "" }],
    file: file!(),
    line: line!(),
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Simulation {
    stop_time: Option<Stop>,
    solver: Option<Method>,
    output: Option<Output>,
    #[serde(default)]
    seed: u64,
}

/// A time in s with its unit checked.
struct Seconds(f64);

impl<'de> Deserialize<'de> for Seconds {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        quantity(deserializer, "s").map(Seconds)
    }
}

/// A number without unit.
struct Plain(f64);

impl<'de> Deserialize<'de> for Plain {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        quantity(deserializer, "1").map(Plain)
    }
}

fn quantity<'de, D: serde::Deserializer<'de>>(deserializer: D, unit: &str) -> Result<f64, D::Error> {
    use blocksim_signal::{Dimension, Unit, Value};
    let value = blocksim_block::ParamValue::deserialize(deserializer)?.0;
    let Value::Number(quantity) = value else {
        return Err(serde::de::Error::custom(format!("expected a number, found {}", value.describe())));
    };
    let wanted = Unit::parse(unit).map_or(Dimension::NONE, |unit| unit.dimension);
    if quantity.dimension != Dimension::NONE && !wanted.compatible(quantity.dimension) {
        return Err(serde::de::Error::custom(format!(
            "expected a value in {wanted}, found one in {}",
            quantity.dimension
        )));
    }
    Ok(quantity.value)
}

enum Stop {
    At(f64),
    Auto(f64),
}

impl<'de> Deserialize<'de> for Stop {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        enum Auto {
            Auto { margin: Option<Seconds> },
        }
        // `Auto` is a word, a time is a number or a text.
        match crate::de::word_or(deserializer)? {
            crate::de::Either::Word(Auto::Auto { margin }) => {
                Ok(Stop::Auto(margin.map_or(0.5, |margin| margin.0)))
            }
            crate::de::Either::Other(Seconds(time)) => Ok(Stop::At(time)),
        }
    }
}

#[derive(Deserialize)]
enum Output {
    Steps,
    Every(Seconds),
}

#[derive(Deserialize)]
enum Method {
    Ode1 { step: Seconds },
    Ode2 { step: Seconds },
    Ode3 { step: Seconds },
    Ode4 { step: Seconds },
    Ode5 { step: Seconds },
    Ode23 { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
    Ode45 { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
    Rodas4 { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
    RosW3 { rtol: Option<Plain>, atol: Option<Plain>, max_step: Option<Seconds> },
}

/// Relative tolerance where the diagram says none.
const RTOL: f64 = 1e-6;

/// Stop time where the diagram says none, s.
const STOP_TIME: f64 = 10.0;

/// Reads how to run a diagram. `end` is when the last move ends, for `stop_time: Auto`.
pub(crate) fn settings<'a>(
    ast: &Ast,
    scope: &Rc<Scope<'a>>,
    end: Option<f64>,
    problems: &mut Problems,
) -> Settings {
    let default = Settings {
        stop_time: STOP_TIME,
        solver: variable(VariableMethod::Ode45, None, None, None),
        output: OutputTimes::Steps,
        seed: 0,
    };
    let Some(node) = &ast.simulation else { return default };
    let place = ast.place(&node.span);
    let reading = Reading::new(scope.clone(), ast.file, Some(&INFO));
    let read = match Simulation::deserialize(Written::new(&reading, node)) {
        Ok(read) => read,
        Err(noted) => {
            let problem =
                reading.problem.take().unwrap_or_else(|| Problem::error("parameter", noted.0).at(&place, ""));
            problems.push(problem);
            return default;
        }
    };
    let at = |name: &str| {
        let member = node.members().unwrap_or_default().iter().find(|(known, _)| known.text == name);
        ast.place(member.map_or(&node.span, |(_, node)| &node.span))
    };
    let stop_time = match read.stop_time {
        None => STOP_TIME,
        Some(Stop::At(time)) => time,
        Some(Stop::Auto(margin)) => match end {
            Some(end) => end + margin,
            None => {
                problems.push(
                    Problem::error("no_end", "nothing in this diagram says when it is over")
                        .at(&at("stop_time"), "asks for the end of the last move")
                        .help("write a time such as `stop_time: \"2 s\"`; Auto needs a move"),
                );
                STOP_TIME
            }
        },
    };
    if !(stop_time.is_finite() && stop_time > 0.0) {
        problems.push(
            Problem::error("parameter", format!("the stop time is {stop_time} s, but must be positive"))
                .at(&at("stop_time"), ""),
        );
    }
    if let Some(end) = end
        && stop_time < end
    {
        problems.push(
            Problem::warning(
                "stop_time",
                format!("the run stops at {stop_time} s, before the move ends at {end:.4} s"),
            )
            .at(&at("stop_time"), "ends too early")
            .help("write `stop_time: Auto(margin: \"0.5 s\")` to see the whole move"),
        );
    }
    let solver = read.solver.map_or(default.solver, solver);
    let bad = match solver {
        Solver::Fixed { step, .. } => {
            (!(step.is_finite() && step > 0.0)).then(|| format!("the step is {step} s"))
        }
        Solver::Variable { rtol, atol, max_step, .. } => {
            if !(rtol.is_finite() && rtol > 0.0) {
                Some(format!("`rtol` is {rtol}"))
            } else if !(atol.is_finite() && atol > 0.0) {
                Some(format!("`atol` is {atol}"))
            } else {
                (max_step.is_nan() || max_step <= 0.0).then(|| format!("`max_step` is {max_step} s"))
            }
        }
    };
    if let Some(bad) = bad {
        problems
            .push(Problem::error("parameter", format!("{bad}, but must be positive")).at(&at("solver"), ""));
    }
    let output = match read.output {
        None | Some(Output::Steps) => OutputTimes::Steps,
        Some(Output::Every(Seconds(time))) => {
            if !(time.is_finite() && time > 0.0) {
                problems.push(
                    Problem::error(
                        "parameter",
                        format!("the output interval is {time} s, but must be positive"),
                    )
                    .at(&at("output"), ""),
                );
            }
            OutputTimes::Every(time)
        }
    };
    Settings { stop_time, solver, output, seed: read.seed }
}

fn solver(method: Method) -> Solver {
    let fixed = |method, Seconds(step)| Solver::Fixed { method, step };
    match method {
        Method::Ode1 { step } => fixed(FixedMethod::Ode1, step),
        Method::Ode2 { step } => fixed(FixedMethod::Ode2, step),
        Method::Ode3 { step } => fixed(FixedMethod::Ode3, step),
        Method::Ode4 { step } => fixed(FixedMethod::Ode4, step),
        Method::Ode5 { step } => fixed(FixedMethod::Ode5, step),
        Method::Ode23 { rtol, atol, max_step } => variable(VariableMethod::Ode23, rtol, atol, max_step),
        Method::Ode45 { rtol, atol, max_step } => variable(VariableMethod::Ode45, rtol, atol, max_step),
        Method::Rodas4 { rtol, atol, max_step } => variable(VariableMethod::Rodas4, rtol, atol, max_step),
        Method::RosW3 { rtol, atol, max_step } => variable(VariableMethod::RosW3, rtol, atol, max_step),
    }
}

fn variable(
    method: VariableMethod,
    rtol: Option<Plain>,
    atol: Option<Plain>,
    max_step: Option<Seconds>,
) -> Solver {
    let rtol = rtol.map_or(RTOL, |rtol| rtol.0);
    // States are in SI units of machines and robots: below `rtol` of one unit nothing is of interest by default.
    let atol = atol.map_or(rtol, |atol| atol.0);
    Solver::Variable { method, rtol, atol, max_step: max_step.map_or(f64::INFINITY, |step| step.0) }
}
