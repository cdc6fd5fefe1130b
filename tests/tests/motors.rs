//! The diagrams of motors that are started, fed by inverters and controlled, against closed forms, equivalent circuits and
//! integrations written here.

use std::f64::consts::{PI, TAU};

use blocksim_block::schedule::{OutputTimes, Schedule, Solver, VariableMethod};
use blocksim_tests::{Run, compile_file, run};

/// A diagram with some values set, at a tolerance and with rows at distances of its own.
fn run_with(path: &str, set: &[&str], tolerance: f64, stop: f64, every: f64) -> Run {
    let (compiled, problems) = compile_file(path, set);
    let mut schedule: Schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    schedule.settings.solver = Solver::Variable {
        method: VariableMethod::Ode45,
        rtol: tolerance,
        atol: tolerance,
        max_step: f64::INFINITY,
    };
    schedule.settings.stop_time = stop;
    schedule.settings.output = OutputTimes::Every(every);
    let run = run(schedule);
    assert!(run.error.is_none(), "{:?}", run.error);
    run
}

fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{what}: {found} instead of {expected}, allowed are {tolerance}"
    );
}

/// The classical method of order four.
fn step<const N: usize>(x: [f64; N], h: f64, slope: impl Fn([f64; N]) -> [f64; N]) -> [f64; N] {
    let ahead = |k: [f64; N], c: f64| std::array::from_fn(|i| x[i] + c * h * k[i]);
    let k1 = slope(x);
    let k2 = slope(ahead(k1, 0.5));
    let k3 = slope(ahead(k2, 0.5));
    let k4 = slope(ahead(k3, 1.0));
    std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

#[test]
fn a_dc_motor_starts_through_its_resistors_as_its_equations_integrated_by_hand() {
    let run = run_with("diagrams/dc_motor_start_resistors.ron", &[], 1e-10, 3.0, 5e-3);
    let (r, l, k, j, d, v) = (0.5_f64, 5e-3, 1.3, 0.5, 0.1, 220.0_f64);
    let ratio = (v / 60.0 / r).cbrt();
    // Resistance of the whole circuit before 0.8 s, 1.26 s, 1.52 s and behind.
    let resistance = |stage: i32| r * ratio.powi(3 - stage);
    let h = 2e-5;
    let mut x = [0.0, 0.0];
    let mut peaks = [0.0_f64; 4];
    for n in 0..150_000_u32 {
        let stage = [40_000, 63_000, 76_000].iter().filter(|at| n >= **at).count();
        let whole = resistance(stage as i32);
        x = step(x, h, |[i, w]| [(v - whole * i - k * w) / l, (k * i - d * w) / j]);
        peaks[stage] = peaks[stage].max(x[0]);
        if n % 2_500 == 2_499 {
            let t = f64::from(n + 1) * h;
            // A tolerance of 1e-10 along some hundred steps, of values up to 165.
            close(run.at("current.i", t), x[0], 1e-6, &format!("current at {t} s"));
            close(run.at("speed.w", t), x[1], 1e-6, &format!("speed at {t} s"));
        }
    }
    // The design: each stage comes near to 60 A and stays below.
    assert!(peaks.iter().all(|i| *i > 53.0 && *i < 60.0), "{peaks:?}");
    for at in [0.8, 1.26, 1.52] {
        assert!(run.time.contains(&at), "the contact at {at} s is hit exactly");
    }
}

/// Complex numbers, as far as they are needed.
type Complex = (f64, f64);

fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn over(a: Complex, b: Complex) -> Complex {
    let square = b.0 * b.0 + b.1 * b.1;
    ((a.0 * b.0 + a.1 * b.1) / square, (a.1 * b.0 - a.0 * b.1) / square)
}

fn size(a: Complex) -> f64 {
    a.0.hypot(a.1)
}

/// The induction machine of these diagrams, by one phase of its equivalent circuit; with a resistance in each line.
struct Circuit {
    line: f64,
}

impl Circuit {
    /// RMS current of the stator and torque, at the RMS voltage of a winding and a frequency in Hz.
    fn steady(&self, v: f64, f: f64, slip: f64) -> (f64, f64) {
        let x = f / 60.0;
        let (main, rotor) = ((0.0, 17.0 * x), (0.14 / slip, 0.41 * x));
        let both = over(times(main, rotor), (rotor.0, rotor.1 + main.1));
        let stator = over((v, 0.0), (0.25 + self.line + both.0, 0.9 * x + both.1));
        let current = size(over(times(stator, main), (rotor.0, rotor.1 + main.1)));
        (size(stator), 3.0 * current * current * rotor.0 / (TAU * f))
    }

    /// Speed at which a load that grows with its square takes the torque.
    fn speed(&self, v: f64, f: f64, load: impl Fn(f64) -> f64) -> f64 {
        // Left of the pull-out slip the torque falls with the speed.
        let (mut low, mut high) = (0.9 * TAU * f, TAU * f);
        for _ in 0..100 {
            let w = 0.5 * (low + high);
            let torque = self.steady(v, f, 1.0 - w / (TAU * f)).1;
            if torque > load(w) { low = w } else { high = w }
        }
        low
    }
}

/// RMS of three balanced currents, from their values at the end.
fn line_current(run: &Run) -> f64 {
    ((0..3).map(|k| run.last(&format!("current.i[{k}]")).powi(2)).sum::<f64>() / 3.0).sqrt()
}

#[test]
fn at_standstill_star_takes_a_third_of_the_current_and_of_the_torque_of_delta() {
    let path = "diagrams/star_delta_start.ron";
    let held = "rotor.j=1e10";
    // The slowest transient, that of the flux at standstill, falls to a third in 0.5 s.
    let star = run_with(path, &[held, "star_until.time=20 s", "delta_from.time=20 s"], 1e-9, 12.0, 0.5);
    let delta = run_with(path, &[held, "star_until.time=0", "delta_from.time=0"], 1e-9, 12.0, 0.5);
    // A contact has 10 mOhm.
    let circuit = Circuit { line: 0.01 };
    let (winding, torque) = circuit.steady(220.0, 60.0, 1.0);
    close(line_current(&delta), f64::sqrt(3.0) * winding, 1e-5, "current in delta");
    close(delta.last("torque.tau"), torque, 1e-5, "torque in delta");
    close(line_current(&star), winding / f64::sqrt(3.0), 1e-5, "current in star");
    close(star.last("torque.tau"), torque / 3.0, 1e-5, "torque in star");
    close(line_current(&delta) / line_current(&star), 3.0, 1e-6, "ratio of the currents");
}

#[test]
fn star_and_delta_end_where_the_equivalent_circuit_meets_the_fan() {
    let path = "diagrams/star_delta_start.ron";
    let fan = |w: f64| 10.0 * (w / 370.0).powi(2);
    let circuit = Circuit { line: 0.01 };
    let run = run_with(path, &[], 1e-10, 4.5, 1e-3);
    let synchronous = 120.0 * PI;

    let speed = circuit.speed(220.0 / f64::sqrt(3.0), 60.0, fan);
    // The run-up has been over for a while when the star opens.
    close(run.at("speed.w", 3.0), speed, 1e-4, "speed in star");

    let speed = circuit.speed(220.0, 60.0, fan);
    let (winding, torque) = circuit.steady(220.0, 60.0, 1.0 - speed / synchronous);
    close(run.last("speed.w"), speed, 1e-6, "speed in delta");
    close(run.last("torque.tau"), torque, 1e-6, "torque in delta");
    close(line_current(&run), f64::sqrt(3.0) * winding, 1e-6, "current in delta");

    // Opened phase after phase: the first current ends at a zero within half a period, the others a quarter later.
    let open = |k: usize| {
        let i = run.column(&format!("current.i[{k}]"));
        let last = (0..run.time.len()).filter(|n| run.time[*n] < 3.04 && i[*n].abs() > 1e-6).max();
        run.time[last.expect("a current before")]
    };
    let mut ends = [open(0), open(1), open(2)];
    ends.sort_by(f64::total_cmp);
    assert!(ends[0] >= 3.0 && ends[2] < 3.0 + 0.75 / 60.0, "{ends:?}");
    assert!(ends[1] > ends[0] + 1e-3 && ends[2] - ends[1] < 1e-3, "{ends:?}");
    let between = (0..run.time.len()).filter(|n| run.time[*n] > 3.02 && run.time[*n] < 3.05);
    for n in between {
        // What is left when both phases end at once is rounding.
        assert!(run.column("current.i[0]")[n].abs() < 1e-9 && run.column("torque.tau")[n].abs() < 1e-9);
    }
}
