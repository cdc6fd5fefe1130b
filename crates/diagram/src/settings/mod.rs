//! `simulation: (...)`: stop time, method, tolerances, output.

mod written;

use std::rc::Rc;

use blocksim_block::problem::Problem;
use blocksim_block::schedule::{FixedMethod, OutputTimes, Settings, Solver, VariableMethod};
use blocksim_block::{BlockInfo, ParameterInfo};
use serde::Deserialize;

use crate::ast::Ast;
use crate::de::{Reading, Written};
use crate::problems::Problems;
use crate::scope::Scope;
use written::{Method, Output, Plain, Seconds, Simulation, Stop};

/// Units of the numbers in `simulation`, for the checks that parameters of blocks have.
static INFO: BlockInfo = BlockInfo {
    kind: "simulation",
    category: "",
    doc: "",
    parameters: &[ParameterInfo { name: "seed", rust_type: "u64", unit: "1", default: Some("0"), doc: "" }],
    file: file!(),
    line: line!(),
};

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
