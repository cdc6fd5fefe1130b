//! The diagrams of motors that are started, fed by inverters and controlled, against closed forms, equivalent circuits and
//! integrations written here.

use std::f64::consts::{PI, TAU};

use blocksim_block::schedule::{OutputTimes, Schedule, Solver, VariableMethod};
use blocksim_tests::{Run, close, compile_file, run};

/// A diagram with some values set, at a tolerance and with rows at distances of its own.
fn run_with(path: &str, set: &[&str], tolerance: f64, stop: f64, every: f64) -> Run {
    let (compiled, problems) = compile_file(path, set);
    let mut schedule: Schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    schedule.settings.solver = Solver::Variable {
        method: VariableMethod::Ode45,
        rtol: tolerance,
        atol: Some(tolerance),
        max_step: f64::INFINITY,
    };
    schedule.settings.stop_time = stop;
    schedule.settings.output = OutputTimes::Every(every);
    let run = run(schedule);
    assert!(run.error.is_none(), "{:?}", run.error);
    run
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

/// Where a column of booleans changes, upwards or downwards: both rows of the event have the same time.
fn changes(run: &Run, name: &str, up: bool) -> Vec<f64> {
    let y = run.column(name);
    let changed = (1..y.len()).filter(|n| if up { y[*n] > y[*n - 1] } else { y[*n] < y[*n - 1] });
    changed
        .map(|n| {
            assert_eq!(run.time[n], run.time[n - 1], "an edge between two rows");
            run.time[n]
        })
        .collect()
}

/// Amplitude of the fundamental and mean over the last tenth of a second, by the rule of trapezoids between rows, which
/// lie on both sides of every edge.
fn fundamental(run: &Run, name: &str, f: f64) -> f64 {
    let (t, y) = (&run.time, run.column(name));
    let first =
        t.iter().position(|at| *at >= t[t.len() - 1] - 0.1 - 1e-9).expect("rows of a tenth of a second");
    let part = |angle: f64| -> f64 {
        let g = |n: usize| y[n] * (TAU * f * t[n] + angle).cos();
        (first + 1..t.len()).map(|n| 0.5 * (g(n) + g(n - 1)) * (t[n] - t[n - 1])).sum::<f64>() / 0.1
    };
    if f == 0.0 { part(0.0) } else { 2.0 * part(0.0).hypot(part(PI / 2.0)) }
}

#[test]
fn a_converter_switches_at_the_instants_that_its_references_say() {
    let run = run_with("diagrams/inverter_fed_machine.ron", &[], 1e-6, 0.4, 1e-3);
    let period = 1.0 / 2e3;
    // What holds from the beginning of each period of the carrier: the last row of that instant.
    let at = |name: &str, t: f64| run.column(name)[run.time.partition_point(|time| *time <= t + 1e-12) - 1];
    for leg in 0..3 {
        let gate = |k: usize| format!("modulator.gates[{}]", 2 * leg + k);
        let (rises, falls) = (changes(&run, &gate(0), true), changes(&run, &gate(0), false));
        assert_eq!(changes(&run, &gate(1), true), falls, "the lower switch turns with the upper one");
        let mut ends = (rises.iter(), falls.iter());
        for k in 0..800_u32 {
            let start = f64::from(k) * period;
            let v = [0, 1, 2].map(|leg| at(&format!("modulator.reference[{leg}]"), start));
            let common = -0.5
                * (v.iter().fold(f64::MIN, |a, b| a.max(*b)) + v.iter().fold(f64::MAX, |a, b| a.min(*b)));
            let duty = 0.5 + (v[leg] + common) / at("voltage.link", start);
            let rise = start + 0.5 * (1.0 - duty) * period;
            let fall = start + 0.5 * (1.0 + duty) * period;
            // Rounding of times below 1 s, and of what was recorded.
            close(*ends.0.next().expect("a rise"), rise, 1e-14, &format!("rise of leg {leg} in period {k}"));
            close(*ends.1.next().expect("a fall"), fall, 1e-14, &format!("fall of leg {leg} in period {k}"));
        }
        assert!(ends.0.next().is_none() && ends.1.next().is_none(), "leg {leg} has more edges");
    }
}

#[test]
fn the_fundamental_of_a_converter_is_its_reference_less_what_its_valves_take() {
    let path = "diagrams/inverter_fed_machine.ron";
    let reference = f64::sqrt(2.0) * 220.0 * (0.02 + 0.98 * 50.0 / 60.0);
    let line = |run: &Run| fundamental(run, "voltage.line[0]", 50.0);
    let good = run_with(path, &["inverter.v_f=0", "inverter.r_on=1 mOhm"], 1e-6, 1.4, 1e-3);
    // The link gives some tenths of a volt less than the voltage of its capacitor, by which the duties are worked out,
    // and its ripple within a period is not seen: 2e-3 of 260 V. Sampling once in a period of 2 kHz costs 2e-4.
    close(line(&good), reference, 2e-3 * reference, "fundamental with nearly ideal valves");

    let run = run_with(path, &[], 1e-6, 1.4, 1e-3);
    let current = fundamental(&run, "current.i[0]", 50.0);
    let load = 20.0 * (fundamental(&run, "speed.w", 0.0) / 310.0).powi(2);
    // The voltage over a valve has the sign of the current: a square wave of 0.8 V, of which the part in phase with the
    // voltage counts.
    let power = load * TAU * 50.0 + 3.0 * 0.25 * (current / f64::sqrt(3.0)).powi(2) / 2.0;
    let factor = power / (3.0 / 2.0 * line(&run) / f64::sqrt(3.0) * current);
    let less = f64::sqrt(3.0) * (4.0 / PI * 0.8 + 9e-3 * current) * factor;
    // The ripple of the current takes its zeros away from those of its fundamental.
    close(line(&good) - line(&run), less, 0.1 * less, "what the valves take");
}

#[test]
fn a_machine_behind_a_converter_turns_as_the_equivalent_circuit_at_its_fundamental() {
    let run = run_with("diagrams/inverter_fed_machine.ron", &[], 1e-6, 1.4, 1e-3);
    let rms = fundamental(&run, "voltage.line[0]", 50.0) / f64::sqrt(2.0);
    let circuit = Circuit { line: 0.0 };
    let fan = |w: f64| 20.0 * (w / 310.0).powi(2);
    let speed = circuit.speed(rms, 50.0, fan);
    let slip = 1.0 - speed / (100.0 * PI);
    let found = fundamental(&run, "speed.w", 0.0);
    // The harmonics at 2 kHz and above turn no field that the rotor could follow: a thousandth of the torque.
    close(found, speed, 2e-3 * slip * 100.0 * PI, "mean speed");
    close(fundamental(&run, "torque.tau", 0.0), fan(found), 1e-3 * fan(found), "mean torque against the fan");
    let (winding, torque) = circuit.steady(rms, 50.0, slip);
    close(fundamental(&run, "torque.tau", 0.0), torque, 1e-3 * torque, "mean torque");
    close(fundamental(&run, "current.i[0]", 50.0), f64::sqrt(6.0) * winding, 2e-3 * 43.0, "current");
}

#[test]
fn a_controlled_current_answers_as_the_optimum_of_magnitude_says() {
    let run = run_with("diagrams/dc_motor_current_control.ron", &[], 1e-10, 0.1, 10e-6);
    let lag = 0.2e-3;
    let actual = run.column("current.actual");
    let rows = || run.time.iter().zip(actual).filter(|(t, _)| **t < 20e-3);
    for (t, i) in rows() {
        let x = (t - 5e-3).max(0.0) / (2.0 * lag);
        close(*i, 5.0 * (1.0 - (-x).exp() * (x.cos() + x.sin())), 1e-7, &format!("current at {t} s"));
    }
    let peak = rows().map(|(_, i)| *i).fold(0.0, f64::max);
    // Rows every 10 us: off by less than (5 us)^2 / (8 lag^2) of the peak.
    close(peak / 5.0 - 1.0, (-PI).exp(), 1e-4, "overshoot");
}

/// Current and voltage of the amplifier while the controller stays at its limit, some time after that has begun.
fn at_limit(s: f64) -> [f64; 2] {
    let (r, winding, lag, limit) = (0.6, 2e-3, 0.2e-3, 48.0);
    let (i0, v0): (f64, f64) = (5.0, 3.0);
    let fast = (v0 - limit) / r * lag / (lag - winding);
    let current = limit / r + fast * (-s / lag).exp() + (i0 - limit / r - fast) * (-s / winding).exp();
    [current, limit + (v0 - limit) * (-s / lag).exp()]
}

#[test]
fn at_its_limit_the_current_rises_as_the_voltage_lets_it_and_goes_on_without_windup() {
    let run = run_with("diagrams/dc_motor_current_control.ron", &[], 1e-10, 0.1, 10e-6);
    let (r, l, lag, kp, ki) = (0.6, 1.2e-3, 0.2e-3, 3.0, 1500.0);
    // The integral part waits at 3 V from 20 ms until the voltage is a thousandth of its range below the limit.
    let asked = |[i, _]: [f64; 2]| kp * (25.0 - i) + 3.0;
    let (mut early, mut late) = (0.0, 1e-3);
    for _ in 0..100 {
        let middle = 0.5 * (early + late);
        if asked(at_limit(middle)) > 48.0 { early = middle } else { late = middle }
    }
    let leaves = late;
    for (n, t) in run.time.iter().enumerate().filter(|(_, t)| **t > 20e-3 && **t < 20e-3 + leaves) {
        let [i, v] = at_limit(t - 20e-3);
        close(run.column("current.actual")[n], i, 1e-6, &format!("current at {t} s"));
        close(run.column("volts.amplifier")[n], v, 1e-6, &format!("voltage at {t} s"));
        assert_eq!(run.column("volts.control")[n], 48.0, "the limit");
    }
    // Then without limit, first with the integral part still waiting.
    let slope = |[i, v, x]: [f64; 3], integral: f64| {
        let u = kp * (25.0 - i) + x;
        [(v - r * i) / l, (u - v) / lag, integral * ki * (25.0 - i)]
    };
    let [i, v] = at_limit(leaves);
    let (mut t, mut x) = (20e-3 + leaves, [i, v, 3.0]);
    while asked([x[0], x[1]]) > 48.0 - 0.096 {
        x = step(x, 1e-11, |x| slope(x, 0.0));
        t += 1e-11;
    }
    let mut seen = 0;
    let first = run.time.partition_point(|row| *row <= t);
    for (n, row) in run.time.iter().enumerate().skip(first).take_while(|(_, row)| **row < 40e-3) {
        let steps = ((row - t) / 1e-6).ceil().max(1.0);
        for _ in 0..steps as u32 {
            x = step(x, (row - t) / steps, |x| slope(x, 1.0));
        }
        t = *row;
        close(run.column("current.actual")[n], x[0], 1e-6, &format!("current at {t} s"));
        seen += 1;
    }
    assert!(seen > 1_900, "only {seen} rows lie behind the limit");
    // Released at 40 ms: k^2 / (j ki) of the current is the error against a voltage that grows evenly.
    let error = 0.05 * 0.05 / (2e-4 * ki);
    close(run.last("current.actual"), 25.0 / (1.0 + error), 1e-6, "current while it gathers speed");
}

/// A controller with `Clamping`, between limits of the same size.
struct Clamped {
    kp: f64,
    ki: f64,
    limit: f64,
    /// Whether the integral part waits.
    waits: bool,
}

impl Clamped {
    fn asks(&self, e: f64, x: f64) -> f64 {
        self.kp * e + x
    }

    fn gives(&self, e: f64, x: f64) -> f64 {
        self.asks(e, x).clamp(-self.limit, self.limit)
    }

    fn slope(&self, e: f64) -> f64 {
        if self.waits { 0.0 } else { self.ki * e }
    }

    fn choose(&mut self, e: f64, x: f64) {
        let asks = self.asks(e, x);
        let outward = asks * e > 0.0;
        let inside = if self.waits { 0.998 * self.limit } else { self.limit };
        self.waits = outward && asks.abs() > inside;
    }
}

#[test]
fn a_cascade_controls_the_speed_as_its_equations_integrated_by_hand() {
    let run = run_with("diagrams/dc_motor_speed_control.ron", &[], 1e-9, 0.7, 1e-3);
    let rpm = PI / 30.0;
    let (l, j, voltage, bandwidth) = (1.2e-3, 6e-4, 48.0, 100.0);
    let k = voltage / (3400.0 * rpm);
    let r = k * (voltage - k * 3000.0 * rpm) / (200.0 / (3000.0 * rpm));
    let gain = bandwidth * j / k;
    let mut outer = Clamped { kp: gain, ki: gain * bandwidth / 4.0, limit: 15.0, waits: false };
    let mut inner = Clamped { kp: l / 1e-3, ki: r / 1e-3, limit: voltage, waits: false };
    // Smoothed set value, integral parts, current, speed.
    let mut x = [0.0; 5];
    let h = 1e-6;
    let (mut waited, mut worst) = ([0, 0], [0.0_f64; 2]);
    for n in 0..700_000_u32 {
        let set = if n >= 20_000 { 2000.0 * rpm } else { 0.0 };
        let load = if n >= 400_000 { 0.6 } else { 0.0 };
        outer.choose(x[0] - x[4], x[1]);
        inner.choose(outer.gives(x[0] - x[4], x[1]) - x[3], x[2]);
        waited[0] += u32::from(outer.waits);
        waited[1] += u32::from(inner.waits);
        x = step(x, h, |[smooth, xs, xc, i, w]| {
            let error = outer.gives(smooth - w, xs) - i;
            let v = inner.gives(error, xc);
            let winding = (v - r * i - k * w) / l;
            [(set - smooth) / 20e-3, outer.slope(smooth - w), inner.slope(error), winding, (k * i - load) / j]
        });
        if n % 1_000 == 999 {
            let t = f64::from(n + 1) * h;
            worst[0] = worst[0].max((run.at("speeds.actual", t) - x[4]).abs());
            worst[1] = worst[1].max((run.at("currents.actual", t) - x[3]).abs());
        }
    }
    // Here the integral parts stop and go on at whole steps of 1 us, up to 1 us late: 3e-5 of what they grow by.
    assert!(worst[0] < 1e-4 && worst[1] < 1e-3, "speed and current are off by {worst:?}");
    assert!(waited[0] > 10_000, "{waited:?}");
    // In the end the integral part bears the load.
    close(run.last("currents.actual"), 0.6 / k, 1e-3, "current under load");
}
