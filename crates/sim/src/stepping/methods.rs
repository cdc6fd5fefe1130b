//! The stepper that a diagram asks for.

use blocksim_block::Interface;
use blocksim_block::schedule::{
    FixedMethod, Instance, LATEST, OutputTimes, Schedule, Solver, Step, VariableMethod,
};
use blocksim_solve::{
    Auto, Dop853, FixedStep, Ode15s, Ode23, Ode23t, Ode23tb, Ode45, Radau5, Rodas4, Ros34pw2, StepLimits,
    Stepper, Tolerances, Weights,
};

use crate::SimError;

/// The stepper of the settings; none without states. Blocks may ask for a shorter maximum step, which a fixed step
/// ignores.
pub(crate) fn stepper(schedule: &Schedule) -> Option<Box<dyn Stepper>> {
    let n = schedule.states;
    (n > 0).then(|| match schedule.settings.solver {
        Solver::Fixed { method, step } => Box::new(fixed(method, n, step)),
        Solver::Variable { method, rtol, atol, .. } => {
            let limits = StepLimits { max: longest(schedule), ..StepLimits::default() };
            let mut tolerances = match atol {
                Some(atol) => Tolerances::uniform(n, rtol, atol),
                None => Tolerances::automatic(n, rtol),
            };
            for block in &schedule.blocks {
                for (i, state) in block.interface.states.iter().enumerate() {
                    let x = block.x + i;
                    tolerances.nominal[x] = state.nominal.unwrap_or(0.0);
                    if tolerances.automatic {
                        tolerances.absolute[x] = tolerances.absolute[x].max(rtol * state.negligible);
                    }
                }
                let kin = block.interface.kin.iter();
                tolerances.kin.extend(kin.map(|own| own.iter().map(|i| block.x + i).collect()));
            }
            for given in &schedule.settings.atol {
                given.states.iter().for_each(|&state| tolerances.fix(state, given.value));
            }
            variable(method, tolerances, limits)
        }
    })
}

/// A method of fixed step for so many states.
pub(crate) fn fixed(method: FixedMethod, n: usize, step: f64) -> FixedStep {
    match method {
        FixedMethod::Ode1 => FixedStep::ode1(n, step),
        FixedMethod::Ode2 => FixedStep::ode2(n, step),
        FixedMethod::Ode3 => FixedStep::ode3(n, step),
        FixedMethod::Ode4 => FixedStep::ode4(n, step),
        FixedMethod::Ode5 => FixedStep::ode5(n, step),
    }
}

/// What a method of fixed step says.
pub(crate) fn weights(solver: Solver) -> Option<Weights> {
    let Solver::Fixed { method, step } = solver else { return None };
    Some(fixed(method, 0, step).weights())
}

/// Whether a method asks how derivatives change along directions of the states.
pub(crate) fn takes_slopes(solver: Solver) -> bool {
    use VariableMethod as Method;
    match solver {
        Solver::Fixed { .. } => false,
        Solver::Variable { method, .. } => match method {
            // Uses only what blocks say of their stiffness, or nothing.
            Method::RosW3 | Method::Ode23 | Method::Ode45 | Method::Dop853 => false,
            Method::Auto | Method::Ode23t | Method::Ode23tb => true,
            Method::Ode15s | Method::Radau5 | Method::Rodas4 => true,
        },
    }
}

fn variable(method: VariableMethod, tolerances: Tolerances, limits: StepLimits) -> Box<dyn Stepper> {
    match method {
        VariableMethod::Auto => Box::new(Auto::new(tolerances, limits)),
        VariableMethod::Dop853 => Box::new(Dop853::new(tolerances, limits)),
        VariableMethod::Ode23t => Box::new(Ode23t::new(tolerances, limits)),
        VariableMethod::Ode23tb => Box::new(Ode23tb::new(tolerances, limits)),
        VariableMethod::Ode15s => Box::new(Ode15s::new(tolerances, limits)),
        VariableMethod::Ode23 => Box::new(Ode23::new(tolerances, limits)),
        VariableMethod::Ode45 => Box::new(Ode45::new(tolerances, limits)),
        VariableMethod::Radau5 => Box::new(Radau5::new(tolerances, limits)),
        VariableMethod::Rodas4 => Box::new(Rodas4::new(tolerances, limits)),
        VariableMethod::RosW3 => Box::new(Ros34pw2::new(tolerances, limits)),
    }
}

/// Steps of a run, at least, where nobody says how long a step may be.
const FEWEST: f64 = 50.0;

/// Steps in a period of what swings with time alone, at least.
pub(crate) const PER_PERIOD: f64 = 8.0;

/// Blocks that swing with time alone and that a derivative, a guard or a memory depends on, or a row where there are no states; with
/// their periods, s.
pub(crate) fn swinging(schedule: &Schedule) -> impl Iterator<Item = (&Instance, f64)> {
    let seen = schedule.steps.iter().filter(|step| step.minor || schedule.states == 0);
    let block = |step: &Step| &schedule.blocks[step.block as usize];
    seen.filter_map(move |step| Some((block(step), block(step).interface.period?)))
}

/// Longest step of a method that chooses its step, s.
///
/// An error estimate sees nothing of a condition that depends on time alone, and little of a short pulse between long steps.
/// So no step is longer than a fiftieth of the run, and none longer than an eighth of the period of a source
/// that a derivative, a guard or a memory depends on.
fn longest(schedule: &Schedule) -> f64 {
    let Solver::Variable { max_step, .. } = schedule.settings.solver else { return f64::INFINITY };
    let bounds = schedule.blocks.iter().flat_map(|block| {
        let Interface { max_step, remembers, .. } = block.interface;
        [max_step, remembers.map(|shortest| WITHIN * shortest)].into_iter().flatten()
    });
    let shortest = swinging(schedule).map(|(_, period)| period).fold(f64::INFINITY, f64::min);
    let longest = if max_step.is_finite() { max_step } else { default_longest(schedule.settings.stop_time) };
    bounds.fold(longest, f64::min).min(shortest / PER_PERIOD)
}

/// Longest step as a share of the shortest delay: a jump at the beginning of a step is to come out behind its end, as
/// nobody knows of it before.
const WITHIN: f64 = 0.999;

/// The longest step of a run that ends at `stop_time`, s, where the settings give none.
fn default_longest(stop_time: f64) -> f64 {
    if stop_time > 0.0 { stop_time / FEWEST } else { f64::INFINITY }
}

/// The spacing of the steps, s, unless a solver chooses them.
pub(crate) fn grid(schedule: &Schedule) -> Option<f64> {
    match schedule.settings.solver {
        Solver::Fixed { step, .. } => Some(step),
        Solver::Variable { .. } if schedule.states > 0 || schedule.settings.stop_time == 0.0 => None,
        Solver::Variable { .. } => Some(longest(schedule)),
    }
}

/// Whether the settings make sense.
pub(crate) fn check(schedule: &Schedule) -> Result<(), SimError> {
    let refuse = |what: &str, value: f64, rule: &str| {
        Err(SimError::new("settings", 0.0, format!("{what} is {value}"))
            .help(format!("{what} must be a number {rule}")))
    };
    let settings = &schedule.settings;
    if !not_below_zero(settings.stop_time) {
        return refuse("the stop time", settings.stop_time, "of seconds, zero or more");
    }
    match settings.solver {
        Solver::Fixed { step, .. } if !above_zero(step) => {
            return refuse("the fixed step", step, "of seconds above zero");
        }
        // No limit is a limit that is infinite.
        Solver::Variable { max_step, .. } if max_step.is_nan() || max_step <= 0.0 => {
            return refuse("the maximum step", max_step, "of seconds above zero");
        }
        Solver::Variable { rtol, .. } if !not_below_zero(rtol) => {
            return refuse("the relative tolerance", rtol, "not below zero");
        }
        Solver::Variable { rtol, atol: Some(atol), .. } if !not_below_zero(atol) || rtol + atol == 0.0 => {
            return refuse("the absolute tolerance", atol, "above zero");
        }
        Solver::Variable { rtol, atol: None, .. } if rtol == 0.0 => {
            return refuse("the relative tolerance", rtol, "above zero");
        }
        _ => {}
    }
    match settings.output {
        OutputTimes::Every(spacing) if !above_zero(spacing) => {
            refuse("the spacing of the output", spacing, "of seconds above zero")
        }
        _ => resolution(schedule).and_then(|()| block_steps(schedule)).and_then(|()| delays(schedule)),
    }
}

/// Times that cannot be told apart are no steps.
fn resolution(schedule: &Schedule) -> Result<(), SimError> {
    let settings = &schedule.settings;
    let (stop, finest) = (settings.stop_time, settings.resolution());
    if stop > LATEST {
        return Err(SimError::new(
            "settings",
            0.0,
            format!("the stop time of {stop:e} s is beyond the clock"),
        )
        .help(format!(
            "times have sixteen digits, which end before {LATEST:e} s; choose an earlier stop time"
        )));
    }
    let step = match settings.solver {
        Solver::Fixed { step, .. } => Some((step, "the fixed step".to_owned(), None)),
        Solver::Variable { max_step, .. } => Some((max_step, "the maximum step".to_owned(), None)),
    };
    let rows = match settings.output {
        OutputTimes::Every(spacing) => Some((spacing, "the spacing of the output".to_owned(), None)),
        OutputTimes::Steps => None,
    };
    let sampled = schedule.blocks.iter().filter_map(|block| {
        let period = schedule.clock.time(schedule.clock.rates.get(block.rate?)?.period);
        Some((period, format!("the sample time of `{}`", block.path), Some(&block.path)))
    });
    let short = step.into_iter().chain(rows).chain(sampled).find(|(length, ..)| *length < finest);
    short.map_or(Ok(()), |(length, what, path)| {
        let message = format!("{what}, {length:e} s, is shorter than the resolution of time at {stop} s");
        let error = SimError::new("settings", 0.0, message).help(format!(
            "times have sixteen digits: take at least {finest:.1e} s, or an earlier stop time"
        ));
        Err(path.map_or(error.clone(), |path| error.at(path)))
    })
}

/// A step that is longer than a delay needs what it computes itself: its end follows from an equation that would have to be
/// solved in each step, which methods of fixed step do not do.
fn delays(schedule: &Schedule) -> Result<(), SimError> {
    let Solver::Fixed { step, .. } = schedule.settings.solver else { return Ok(()) };
    let shorter = schedule.blocks.iter().find_map(|block| {
        let shortest = block.interface.remembers.filter(|shortest| *shortest < step * (1.0 - 1e-9))?;
        Some((&block.path, shortest))
    });
    shorter.map_or(Ok(()), |(path, shortest)| {
        let message =
            format!("the fixed step of {step} s is longer than the delay of `{path}`, {shortest} s: what comes out within a step \
                     would depend on its own end, an equation that methods of fixed step do not solve");
        Err(SimError::new("settings", 0.0, message).at(path).help(format!(
            "take a step of at most {shortest} s, a method that chooses its steps such as Auto, or a delay of a whole number of \
             steps"
        )))
    })
}

fn above_zero(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}

fn not_below_zero(value: f64) -> bool {
    value >= 0.0 && value.is_finite()
}

fn block_steps(schedule: &Schedule) -> Result<(), SimError> {
    let wrong = schedule.blocks.iter().find_map(|block| {
        let Interface { max_step, period, .. } = block.interface;
        let step = [max_step, period].into_iter().flatten().find(|step| step.is_nan() || *step <= 0.0)?;
        Some((&block.path, step))
    });
    wrong.map_or(Ok(()), |(path, step)| {
        Err(SimError::new("settings", 0.0, format!("`{path}` asks for steps of at most {step} s")).at(path))
    })
}
