//! Valves against a slow reference and closed forms, with every method of variable step.

mod known;
mod latched;
mod rows;
mod waiting;

use blocksim_tests::random::{Branch, Circuit, Finding, Kind, Puzzle, Source, Valve, Variant, contradiction};
use blocksim_tests::{Run, compile_text, run};

/// Methods that look for events.
pub use blocksim_tests::METHODS;

/// Runs a diagram to its end, or says why it does not.
pub fn try_run(text: &str) -> Result<Run, String> {
    let (compiled, problems) = compile_text(text);
    let run = run(compiled.schedule.ok_or(problems)?);
    match &run.error {
        Some(error) => Err(format!("{error:?}")),
        None => Ok(run),
    }
}

/// A bridge of six diodes behind a coil in each phase, on a capacitor and a load.
fn three_phase_bridge() -> Circuit {
    let mut branches = Vec::new();
    let mut add = |p, n, kind| branches.push(Branch { p, n, kind });
    let valve = Valve { v_f: 0.8, r_on: 0.01, g_off: 0.0 };
    // Nodes: 1-3 sources, 4-6 behind the coils, 7 star point, 8 plus; minus is ground.
    for k in 0..3 {
        let phase = -std::f64::consts::TAU / 3.0 * k as f64;
        add(1 + k, 7, Kind::Voltage(Source::Sine(325.0, 50.0, phase), 1e-3));
        add(1 + k, 4 + k, Kind::Coil(0.5e-3));
        add(4 + k, 8, Kind::Diode(valve));
        add(0, 4 + k, Kind::Diode(valve));
    }
    add(8, 0, Kind::Capacitor(2e-3, 0.0));
    add(8, 0, Kind::Resistor(20.0));
    Circuit { nodes: 8, branches, stop: 0.06, every: Some(1e-4), integrals: false }
}

#[test]
fn a_three_phase_bridge_agrees_with_the_reference_by_every_method() {
    let bridge = three_phase_bridge();
    for method in METHODS {
        let variant = Variant::with(&format!(", solver: {method}"));
        assert_eq!(bridge.judge(&variant), Finding::Right, "{method}");
        let run = try_run(&bridge.text(&variant)).unwrap();
        let wrong = contradiction(&run, &bridge);
        assert!(wrong < 1e-8, "{method}: {wrong:e}");
    }
}
