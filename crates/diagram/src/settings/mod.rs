//! `simulation: (...)`: stop time, method, tolerances, output.

pub(crate) mod atol;
pub(crate) mod start;
pub(crate) mod written;

use std::rc::Rc;

use blocksim_block::problem::Problem;
use blocksim_block::schedule::{
    FixedMethod, Free, Held, LATEST, LoopPolicy, OutputTimes, Settings, Solver, Start, Steady, VariableMethod,
};
use blocksim_block::{BlockInfo, ParamValue, ParameterInfo, Symbol};
use blocksim_signal::Value;
use serde::Deserialize;

use crate::ast::Ast;
use crate::de::{Reading, Written, bare_number};
use crate::problems::Problems;
use crate::scope::Scope;
use blocksim_syntax::{Node, Shape};
use written::{Begin, Method, Output, Plain, Seconds, Simulation, Stop};

/// Units of the numbers in `simulation`, for the checks that parameters of blocks have.
static INFO: BlockInfo = BlockInfo {
    kind: "simulation",
    category: "",
    symbol: Symbol::Plain,
    doc: "",
    parameters: &[
        ParameterInfo {
            name: "seed",
            rust_type: "u64",
            unit: "1",
            default: Some("0"),
            ..ParameterInfo::NONE
        },
        // Tolerances are differences.
        ParameterInfo { name: "atol", is_difference: true, ..ParameterInfo::NONE },
    ],
    file: file!(),
    line: line!(),
};

/// Relative tolerances that make sense: from what numbers resolve to what is still a solution.
const MOST_EXACT: f64 = 1e-14;
const LEAST_EXACT: f64 = 0.1;

/// What an absolute tolerance is.
const ATOL: &str = "it is an error that does not matter, in the unit of the state; without it each state has its own, which follows \
                    its size";

/// Relative tolerance where the diagram says none.
const RTOL: f64 = 1e-6;

/// Stop time where the diagram says none, s.
const STOP_TIME: f64 = 10.0;

/// Members of `simulation` that are times.
const TIMES: [&str; 5] = ["stop_time", "margin", "max_step", "step", "every"];

/// The problem of a time without a unit.
fn bare_time(ast: &Ast, scope: &Scope, field: &str, node: &Node) -> Option<Problem> {
    let Shape::Number(value) = node.value else { return None };
    let place = ast.place(&node.span);
    let old = scope.sources.file(ast.file).text.get(node.span.clone())?.to_owned();
    let problem = bare_number(field, value, "s").at(&place, "has no unit");
    let new = format!("\"{old} s\"");
    (value != 0.0).then(|| problem.edit(place, old, new))
}

/// Times without a unit, anywhere below a node.
fn bare_times(ast: &Ast, scope: &Scope, node: &Node, problems: &mut Problems) {
    match &node.value {
        Shape::Tuple(Some(name), items) if name.text == "Every" => {
            items.iter().for_each(|item| problems.extend(bare_time(ast, scope, "output", item)))
        }
        Shape::Struct(_, members) | Shape::Map(members) => {
            for (name, value) in members {
                if TIMES.contains(&name.text.as_str()) {
                    problems.extend(bare_time(ast, scope, &name.text, value));
                }
                bare_times(ast, scope, value, problems);
            }
        }
        Shape::Tuple(Some(_), items) => items.iter().for_each(|item| bare_times(ast, scope, item, problems)),
        _ => {}
    }
}

/// Reads settings for what they note on the way.
pub(crate) fn ask(written: Written) {
    drop(Simulation::deserialize(written));
}

/// Reads how to run a diagram. `end` is when the last move ends, for `stop_time: Auto`.
pub(crate) fn settings<'a>(
    ast: &Ast,
    scope: &Rc<Scope<'a>>,
    end: Option<f64>,
    strict: bool,
    problems: &mut Problems,
) -> Settings {
    let default = Settings {
        stop_time: STOP_TIME,
        solver: variable(VariableMethod::Auto, None, None, None),
        output: OutputTimes::Steps,
        seed: 0,
        start: Start::Given,
        atol: Vec::new(),
        algebraic_loops: LoopPolicy::default(),
    };
    let Some(node) = &ast.simulation else { return default };
    let place = ast.place(&node.span);
    if strict {
        bare_times(ast, scope, node, problems);
    }
    let reading = Reading::new(scope.clone(), ast.file, Some(&INFO));
    let read = match Simulation::deserialize(Written::new(&reading, node)) {
        Ok(read) => read,
        Err(noted) => {
            problems.extend(reading.problems(noted, &place));
            // One setting does not hide what is wrong with another. What is found twice is reported once.
            for member in node.members().unwrap_or_default() {
                let alone =
                    Node { span: node.span.clone(), value: Shape::Struct(None, vec![member.clone()]) };
                let reading = Reading::new(scope.clone(), ast.file, Some(&INFO));
                if let Err(noted) = Simulation::deserialize(Written::new(&reading, &alone)) {
                    problems.extend(reading.problems(noted, &place));
                }
            }
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
            // Whatever else is wrong may be the move that is missed.
            None if problems.any_error() => STOP_TIME,
            None => {
                problems.push(
                    Problem::error("no_end", "nothing in this diagram has an end")
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
            (!(step.is_finite() && step > 0.0)).then(|| (format!("the step is {step} s"), None))
        }
        Solver::Variable { atol, max_step, .. } => {
            let atol = atol.filter(|atol| !(atol.is_finite() && *atol > 0.0));
            let max_step = (max_step.is_nan() || max_step <= 0.0).then_some(max_step);
            let atol = atol.map(|atol| (format!("`atol` is {atol}"), Some(ATOL)));
            atol.or(max_step.map(|step| (format!("`max_step` is {step} s"), None)))
        }
    };
    if let Solver::Variable { rtol, .. } = solver
        && !(MOST_EXACT..=LEAST_EXACT).contains(&rtol)
    {
        problems.push(
            Problem::error(
                "parameter",
                format!("`rtol` is {rtol:e}, but must be between {MOST_EXACT:e} and {LEAST_EXACT:e}"),
            )
            .at(&at("solver"), "")
            .help("1e-3 is enough for a picture, 1e-6 is the default, 1e-9 is for references"),
        );
    }
    if let Some((bad, help)) = bad {
        let mut problem = Problem::error("parameter", format!("{bad}, but must be positive"));
        problem.help = help.map(str::to_owned);
        problems.push(problem.at(&at("solver"), ""));
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
    let start = match read.start.map_or(Ok(Start::Given), begin) {
        Ok(start) => start,
        Err(message) => {
            problems.push(Problem::error("parameter", message).at(&at("start"), ""));
            Start::Given
        }
    };
    let atol = match atol::read(read.atol, &solver) {
        Ok(atol) => atol,
        Err(problem) => {
            problems.push(problem.at(&at("atol"), ""));
            Vec::new()
        }
    };
    let algebraic_loops = read.algebraic_loops;
    let settings = Settings { stop_time, solver, output, seed: read.seed, start, atol, algebraic_loops };
    if stop_time.is_finite() && stop_time > LATEST {
        problems.push(
            Problem::error("parameter", format!("the stop time of {stop_time:e} s is beyond the clock"))
                .at(&at("stop_time"), "")
                .help(format!("times have sixteen digits, which end before {LATEST:e} s")),
        );
    } else if let Some((step, what)) = too_short(&settings) {
        problems.push(
            Problem::error(
                "parameter",
                format!("the {what} of {step:e} s is shorter than the resolution of time at {stop_time} s"),
            )
            .at(&at(if what == "output interval" { "output" } else { "solver" }), "")
            .help(format!("times have sixteen digits: write at least {:.1e} s", settings.resolution())),
        );
    }
    settings
}

/// A step that could not be made near the end of the run.
fn too_short(settings: &Settings) -> Option<(f64, &'static str)> {
    let step = match settings.solver {
        Solver::Fixed { step, .. } => (step, "step"),
        Solver::Variable { max_step, .. } => (max_step, "maximum step"),
    };
    let rows = match settings.output {
        OutputTimes::Every(spacing) => (spacing, "output interval"),
        OutputTimes::Steps => (f64::INFINITY, ""),
    };
    [step, rows].into_iter().find(|(length, _)| *length > 0.0 && *length < settings.resolution())
}

/// What a start asks for, by name; where it lies is found once there is a schedule.
fn begin(written: Begin) -> Result<Start, String> {
    let Begin::Steady { hold, free, drift } = written else { return Ok(Start::Given) };
    let held = |(name, ParamValue(value)): (String, ParamValue)| match value {
        Value::Number(number) if number.value.is_finite() => {
            Ok(Held { name, cell: 0, value: number.value, dimension: Some(number.dimension) })
        }
        Value::Number(number) => Err(format!("`{name}` cannot be held at {}", number.value)),
        other => Err(format!("`{name}` is to be held at a number, not at {}", other.describe())),
    };
    Ok(Start::Steady(Steady {
        hold: hold.into_iter().map(held).collect::<Result<_, _>>()?,
        free: free.into_iter().map(|name| Free { name, block: 0, cell: 0, dimension: None }).collect(),
        drift,
    }))
}

fn solver(method: Method) -> Solver {
    let fixed = |method, Seconds(step)| Solver::Fixed { method, step };
    match method {
        Method::Ode1 { step } => fixed(FixedMethod::Ode1, step),
        Method::Ode2 { step } => fixed(FixedMethod::Ode2, step),
        Method::Ode3 { step } => fixed(FixedMethod::Ode3, step),
        Method::Ode4 { step } => fixed(FixedMethod::Ode4, step),
        Method::Ode5 { step } => fixed(FixedMethod::Ode5, step),
        Method::Auto { rtol, atol, max_step } => variable(VariableMethod::Auto, rtol, atol, max_step),
        Method::Dop853 { rtol, atol, max_step } => variable(VariableMethod::Dop853, rtol, atol, max_step),
        Method::Ode23t { rtol, atol, max_step } => variable(VariableMethod::Ode23t, rtol, atol, max_step),
        Method::Ode23tb { rtol, atol, max_step } => variable(VariableMethod::Ode23tb, rtol, atol, max_step),
        Method::Ode15s { rtol, atol, max_step } => variable(VariableMethod::Ode15s, rtol, atol, max_step),
        Method::Ode23 { rtol, atol, max_step } => variable(VariableMethod::Ode23, rtol, atol, max_step),
        Method::Ode45 { rtol, atol, max_step } => variable(VariableMethod::Ode45, rtol, atol, max_step),
        Method::Radau5 { rtol, atol, max_step } => variable(VariableMethod::Radau5, rtol, atol, max_step),
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
    let atol = atol.map(|atol| atol.0);
    Solver::Variable { method, rtol, atol, max_step: max_step.map_or(f64::INFINITY, |step| step.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ast::parse;
    use crate::source::Sources;
    use crate::toys::{NoFiles, messages};
    use blocksim_block::methods::METHODS;
    use blocksim_block::problem::FileId;
    use blocksim_syntax::read;

    /// Settings and messages of `simulation: (...)` where the last move ends at `end`.
    fn read_settings(simulation: &str, end: Option<f64>) -> (Settings, Vec<String>) {
        let root = read(&format!("Diagram(simulation: {simulation})")).expect("RON");
        let mut problems = Problems::default();
        let ast = parse(FileId(0), &root, &mut problems).expect("a diagram");
        let sources = Sources::new(&NoFiles);
        let scope = Rc::new(Scope::new(&sources, None));
        let settings = settings(&ast, &scope, end, false, &mut problems);
        (settings, messages(&problems))
    }

    fn message(simulation: &str) -> String {
        read_settings(simulation, None).1.join("; ")
    }

    #[test]
    fn every_setting_is_read() {
        let text = "(stop_time: \"2 s\", solver: Ode4(step: \"1 ms\"), output: Every(\"10 ms\"), seed: 7, algebraic_loops: Refuse)";
        let solver = Solver::Fixed { method: FixedMethod::Ode4, step: 1e-3 };
        let wanted = Settings {
            stop_time: 2.0,
            solver,
            output: OutputTimes::Every(0.01),
            seed: 7,
            start: Start::Given,
            atol: Vec::new(),
            algebraic_loops: LoopPolicy::Refuse,
        };
        assert_eq!(read_settings(text, None), (wanted, Vec::new()));
    }

    #[test]
    fn a_steady_start_is_a_word_or_says_what_is_held_and_free() {
        assert_eq!(read_settings("(start: Steady)", None).0.start, Start::Steady(Steady::default()));
        assert_eq!(read_settings("(start: Given)", None).0.start, Start::Given);
        let text = "(start: Steady(hold: {\"motor.w\": \"30 rpm\"}, free: [\"u.value\"], drift: [\"path\"]))";
        let (settings, messages) = read_settings(text, None);
        let Start::Steady(Steady { hold, free, drift }) = settings.start else { panic!("{messages:?}") };
        assert_eq!((hold[0].name.as_str(), hold[0].value), ("motor.w", std::f64::consts::PI));
        assert_eq!((free[0].name.as_str(), drift), ("u.value", vec!["path".to_owned()]));
        assert!(message("(start: Stedy)").contains("`Stedy` is not a choice for `start`"));
        assert!(message("(start: Steady(hold: {\"a.y\": [1, 2]}))").contains("not at a list of 2"));
        assert!(message("(start: Steady(fre: []))").contains("`fre` is not known here"));
    }

    #[test]
    fn auto_stops_after_the_last_move() {
        assert_eq!(read_settings("(stop_time: Auto())", Some(2.0)).0.stop_time, 2.5);
        assert_eq!(read_settings("(stop_time: Auto(margin: \"1 s\"))", Some(2.0)).0.stop_time, 3.0);
        assert_eq!(message("(stop_time: Auto())"), "nothing in this diagram has an end");
    }

    #[test]
    fn a_stop_before_the_end_of_the_last_move_is_a_warning() {
        let (_, messages) = read_settings("(stop_time: 1)", Some(2.0));
        assert_eq!(messages, ["the run stops at 1 s, before the move ends at 2.0000 s"]);
    }

    #[test]
    fn a_number_that_must_be_positive_is_refused_otherwise() {
        assert_eq!(message("(stop_time: 0)"), "the stop time is 0 s, but must be positive");
        assert_eq!(message("(stop_time: inf)"), "the stop time is inf s, but must be positive");
        assert_eq!(message("(solver: Ode1(step: -1))"), "the step is -1 s, but must be positive");
        for rtol in ["0", "-1", "NaN", "inf"] {
            let message = message(&format!("(solver: Ode45(rtol: {rtol}))"));
            assert!(message.ends_with(", but must be between 1e-14 and 1e-1"), "{message}");
        }
        assert_eq!(
            message("(solver: Ode45(rtol: 0.5))"),
            "`rtol` is 5e-1, but must be between 1e-14 and 1e-1"
        );
        assert_eq!(message("(solver: Ode45(atol: 0))"), "`atol` is 0, but must be positive");
        assert_eq!(message("(solver: Ode23(max_step: 0))"), "`max_step` is 0 s, but must be positive");
        assert_eq!(message("(output: Every(0))"), "the output interval is 0 s, but must be positive");
    }

    #[test]
    fn every_method_of_the_list_is_read() {
        for info in METHODS {
            let (text, wanted) = match info.method {
                blocksim_block::methods::Method::Fixed(method) => {
                    (format!("(solver: {}(step: 0.5))", info.name), Solver::Fixed { method, step: 0.5 })
                }
                blocksim_block::methods::Method::Variable(method) => (
                    format!("(solver: {}(rtol: 1e-3))", info.name),
                    Solver::Variable { method, rtol: 1e-3, atol: None, max_step: f64::INFINITY },
                ),
            };
            let (settings, messages) = read_settings(&text, None);
            assert_eq!((settings.solver, messages), (wanted, Vec::new()));
        }
    }

    #[test]
    fn times_that_cannot_be_told_apart_are_refused() {
        assert_eq!(message("(stop_time: 1e300)"), "the stop time of 1e300 s is beyond the clock");
        let steps = "is shorter than the resolution of time at 10 s";
        assert_eq!(message("(solver: Ode4(step: 1e-20))"), format!("the step of 1e-20 s {steps}"));
        assert_eq!(
            message("(solver: Ode45(max_step: 1e-15))"),
            format!("the maximum step of 1e-15 s {steps}")
        );
        assert_eq!(message("(output: Every(1e-18))"), format!("the output interval of 1e-18 s {steps}"));
        assert_eq!(message("(solver: Ode4(step: 1e-12))"), "");
    }

    #[test]
    fn a_misspelt_word_or_a_wrong_unit_is_named() {
        assert!(message("(stop: 1)").contains("`stop` is not known here"));
        assert!(message("(solver: Ode113())").contains("`Ode113` is not a choice for `solver`"));
        assert!(message("(solver: Ode46())").contains("`Ode46` is not a choice for `solver`"));
        assert!(message("(solver: Ode45(rtoll: 1e-9))").contains("`rtoll` is not known here"));
        assert!(message("(stop_time: Auto(marg: 1))").contains("`marg` is not known here"));
        assert!(message("(solver: Ode4())").contains("`step` is missing"));
        assert!(message("(stop_time: \"2 m\")").contains("expected a value in s"));
        assert!(message("(seed: -1)").contains("seed"));
    }
}
