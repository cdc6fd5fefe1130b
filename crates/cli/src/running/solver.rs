//! The method of a run: what the diagram says and what the command line changes.

use blocksim_block::methods::{METHODS, Method, instead_of};
use blocksim_block::schedule::{Settings, Solver};
use blocksim_recording::SolverUsed;
use blocksim_signal::closest;

use crate::args::model::SolverArgs;
use crate::failure::Failure;

/// Relative tolerance where neither the diagram nor the command line says one.
const RTOL: f64 = 1e-6;

/// Changes the settings of a diagram as the command line says.
///
/// # Errors
/// If the options do not fit together.
pub fn apply(args: &SolverArgs, settings: &mut Settings) -> Result<(), Failure> {
    if let Some(until) = args.until {
        settings.stop_time = until;
    }
    if let Some(name) = &args.solver {
        settings.solver = changed(named(name)?, settings.solver, args.step)?;
    }
    match &mut settings.solver {
        Solver::Fixed { step, .. } => {
            if args.rtol.is_some() || args.atol.is_some() {
                let option = if args.rtol.is_some() { "--rtol" } else { "--atol" };
                let said = format!("{option} makes no sense with a method of fixed step");
                return Err(Failure::usage(said)
                    .help("use --step, or a method of variable step such as --solver auto"));
            }
            *step = args.step.unwrap_or(*step);
        }
        Solver::Variable { rtol, atol, max_step, .. } => {
            if let Some(asked) = args.rtol {
                if !(1e-14..=0.1).contains(&asked) {
                    let said = format!("--rtol is {asked:e}, but must be between 1e-14 and 1e-1");
                    return Err(Failure::usage(said)
                        .help("1e-3 is enough for a picture, 1e-6 is the default, 1e-9 is for references"));
                }
                // A given absolute tolerance keeps its ratio to the relative one.
                *atol = atol.map(|atol| atol * asked / *rtol);
                settings.atol.iter_mut().for_each(|state| state.value *= asked / *rtol);
                *rtol = asked;
            }
            *atol = args.atol.or(*atol);
            *max_step = args.step.unwrap_or(*max_step);
        }
    }
    Ok(())
}

fn named(name: &str) -> Result<Method, Failure> {
    Method::named(name).ok_or_else(|| {
        let names = METHODS.map(|info| info.name.to_lowercase());
        let meant = match instead_of(name) {
            Some(here) => format!("`{}` is for the same here; ", here.to_lowercase()),
            None => closest(name, names.iter().map(String::as_str))
                .map_or_else(String::new, |meant| format!("did you mean `{meant}`? ")),
        };
        Failure::usage(format!("there is no solver `{name}`"))
            .help(format!("{meant}the solvers are {}", names.join(", ")))
    })
}

/// Another method with as much as possible of what was said for the present one.
fn changed(method: Method, present: Solver, step: Option<f64>) -> Result<Solver, Failure> {
    match (method, present) {
        (Method::Fixed(method), Solver::Fixed { step: present, .. }) => {
            Ok(Solver::Fixed { method, step: step.unwrap_or(present) })
        }
        (Method::Fixed(method), Solver::Variable { .. }) => match step {
            Some(step) => Ok(Solver::Fixed { method, step }),
            None => {
                Err(Failure::usage("a method of fixed step needs --step").help("add one, such as --step 1ms"))
            }
        },
        (Method::Variable(method), Solver::Variable { rtol, atol, max_step, .. }) => {
            Ok(Solver::Variable { method, rtol, atol, max_step })
        }
        (Method::Variable(method), Solver::Fixed { .. }) => {
            Ok(Solver::Variable { method, rtol: RTOL, atol: None, max_step: f64::INFINITY })
        }
    }
}

/// For the manifest.
pub fn used(solver: Solver) -> SolverUsed {
    match solver {
        Solver::Fixed { method, step } => SolverUsed {
            name: Method::Fixed(method).name().to_owned(),
            rtol: None,
            atol: None,
            step: Some(step),
        },
        Solver::Variable { method, rtol, atol, max_step } => SolverUsed {
            name: Method::Variable(method).name().to_owned(),
            rtol: Some(rtol),
            atol,
            step: max_step.is_finite().then_some(max_step),
        },
    }
}

/// In words: `Ode45, rtol 1e-6, atol 1e-6`.
pub fn described(used: &SolverUsed) -> String {
    let parts = [("rtol", used.rtol, ""), ("atol", used.atol, "")];
    let mut text = used.name.clone();
    for (name, value, unit) in parts {
        if let Some(value) = value {
            text.push_str(&format!(", {name} {value:e}{unit}"));
        }
    }
    match (used.step, used.rtol) {
        (Some(step), None) => text.push_str(&format!(", step {step} s")),
        (Some(step), Some(_)) => text.push_str(&format!(", steps up to {step} s")),
        (None, _) => {}
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::{Args, Command};
    use blocksim_block::schedule::{FixedMethod, LoopPolicy, OutputTimes, Start, VariableMethod};
    use clap::Parser;

    const ODE45: Solver = Solver::Variable {
        method: VariableMethod::Ode45,
        rtol: 1e-6,
        atol: Some(1e-8),
        max_step: f64::INFINITY,
    };
    const ODE4: Solver = Solver::Fixed { method: FixedMethod::Ode4, step: 1e-3 };

    fn with(solver: Solver, options: &[&str]) -> Result<Settings, String> {
        let args = Args::parse_from([&["blocksim", "run", "m.ron"], options].concat());
        let Some(Command::Run(args)) = args.command else { panic!("run was asked for") };
        let mut settings = Settings {
            stop_time: 1.0,
            solver,
            output: OutputTimes::Steps,
            seed: 0,
            start: Start::Given,
            atol: Vec::new(),
            algebraic_loops: LoopPolicy::default(),
        };
        apply(&args.solver, &mut settings).map(|()| settings).map_err(|failure| failure.text())
    }

    #[test]
    fn options_change_what_they_name_and_nothing_else() {
        assert_eq!(with(ODE45, &["--until", "2s"]).unwrap().stop_time, 2.0);
        assert_eq!(with(ODE45, &[]).unwrap().solver, ODE45);
        let tight = with(ODE45, &["--rtol", "1e-9", "--solver", "rosw3"]).unwrap().solver;
        let Solver::Variable { method: VariableMethod::RosW3, rtol, atol, .. } = tight else {
            panic!("{tight:?}")
        };
        assert!(rtol == 1e-9 && (atol.unwrap() / 1e-11 - 1.0).abs() < 1e-12);
        let loose = with(ODE45, &["--rtol", "1e-3", "--atol", "1e-2"]).unwrap().solver;
        assert!(matches!(loose, Solver::Variable { rtol: 1e-3, atol: Some(1e-2), .. }), "{loose:?}");
        let fixed = with(ODE45, &["--solver", "ode2", "--step", "2ms"]).unwrap().solver;
        assert_eq!(fixed, Solver::Fixed { method: FixedMethod::Ode2, step: 2e-3 });
        let kept = with(ODE4, &["--solver", "Ode1"]).unwrap().solver;
        assert_eq!(kept, Solver::Fixed { method: FixedMethod::Ode1, step: 1e-3 });
    }

    #[test]
    fn options_that_do_not_fit_together_are_refused() {
        assert!(with(ODE45, &["--solver", "ode4"]).unwrap_err().contains("--step"));
        assert!(with(ODE4, &["--rtol", "1e-3"]).unwrap_err().contains("fixed step"));
        let unknown = with(ODE45, &["--solver", "ode54"]).unwrap_err();
        assert!(unknown.contains("did you mean `ode"), "{unknown}");
        let elsewhere = with(ODE45, &["--solver", "ode89"]).unwrap_err();
        assert!(elsewhere.contains("`dop853` is for the same here"), "{elsewhere}");
        assert!(with(ODE45, &["--rtol", "0.5"]).unwrap_err().contains("between 1e-14 and 1e-1"));
    }

    #[test]
    fn a_method_is_described_as_it_was_used() {
        assert_eq!(described(&used(ODE45)), "Ode45, rtol 1e-6, atol 1e-8");
        assert_eq!(described(&used(ODE4)), "Ode4, step 0.001 s");
    }
}
