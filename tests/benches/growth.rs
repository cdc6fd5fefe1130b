//! How compiling and running grow with a model: lines of 100 and of 1000 sections, rods, shafts, at default settings. Goal: at most
//! twelve times the time for ten times the model.
//!
//! `cargo bench -p blocksim-tests --bench growth`.

use std::fmt::Write;
use std::hint::black_box;
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};

use blocksim_sim::{Observer, Simulation};
use blocksim_tests::compile_text;

/// Runs of each model; the fastest counts, because the others were disturbed.
const RUNS: usize = 7;

/// Time that this thread has computed, where the system tells it; others that run at the same time then count little. Elsewhere the time
/// that has passed.
fn computed() -> Duration {
    static BEGIN: LazyLock<Instant> = LazyLock::new(Instant::now);
    // Nanoseconds on a processor, those spent waiting for one, and how often.
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split(' ').next()?.parse().ok());
    nanoseconds.map_or_else(|| BEGIN.elapsed(), Duration::from_nanos)
}

struct Forget;

impl Observer for Forget {
    fn row(&mut self, _t: f64, values: &[f64]) {
        black_box(values);
    }
}

/// Resistors of 1 ohm and capacitors of 1 uF, fed by 1 V.
fn line(n: usize) -> String {
    let (mut blocks, mut wires) = (String::new(), String::from(r#""u.n <-> g.p", "u.p <-> r0.p""#));
    for k in 0..n {
        let next = if k + 1 < n { format!(" <-> r{}.p", k + 1) } else { String::new() };
        write!(blocks, r#""r{k}": Resistor(r: 1), "c{k}": Capacitor(c: 1e-6), "#).expect("text");
        write!(wires, r#", "r{k}.n <-> c{k}.p{next}", "c{k}.n <-> g.p""#).expect("text");
    }
    let last = n - 1;
    format!(
        r#"Diagram(simulation: (stop_time: "1 s"), blocks: {{ "g": ElectricalReference, "u": VoltageSource(v: 1), {blocks}
           "s": Scope(inputs: ["far"]) }}, connections: [{wires}, "c{last}.v -> s.far"])"#
    )
}

/// Cells of a rod of unit length whose one end becomes hot, drawn with integrators, sums and gains.
fn rod(n: usize) -> String {
    let (mut blocks, mut wires, rate) = (String::new(), String::new(), n * n);
    for i in 0..n {
        let left = if i == 0 { "hot.y".to_owned() } else { format!("x{}.y", i - 1) };
        let right = (i + 1).min(n - 1);
        write!(blocks, r#""x{i}": Integrator, "d{i}": Sum(signs: "+--+"), "k{i}": Gain(k: "{rate} 1/s"), "#)
            .expect("text");
        write!(
            wires,
            r#""{left} -> d{i}.u1", "x{i}.y -> d{i}.u2", "x{i}.y -> d{i}.u3", "x{right}.y -> d{i}.u4", "d{i}.y -> k{i}.u", "k{i}.y -> x{i}.u", "#
        )
        .expect("text");
    }
    let (middle, end) = (n / 2 - 1, n - 1);
    format!(
        r#"Diagram(simulation: (stop_time: "1 s"), blocks: {{ {blocks} "hot": Constant(value: 1), "s": Scope(inputs: ["middle", "end"]) }},
           connections: [{wires} "x{middle}.y -> s.middle", "x{end}.y -> s.end"])"#
    )
}

/// Discs joined by springs and dampers, driven at one end.
fn shaft(n: usize) -> String {
    let (mut blocks, mut wires) = (String::new(), String::new());
    for i in 0..n {
        write!(blocks, r#""disc{i}": Inertia(j: 0.01), "#).expect("text");
        if let Some(before) = i.checked_sub(1) {
            write!(blocks, r#""spring{i}": RotationalSpringDamper(k: 100.0, d: 0.01), "#).expect("text");
            write!(wires, r#""disc{before}.r <-> spring{i}.r", "spring{i}.c <-> disc{i}.r", "#)
                .expect("text");
        }
    }
    format!(
        r#"Diagram(simulation: (stop_time: "0.5 s"), blocks: {{ {blocks} "push": IdealTorqueSource,
           "swing": Sine(amplitude: "1 N*m", frequency: "2 Hz"), "frame": RotationalReference, "sensor": MotionSensor,
           "s": Scope(inputs: ["w"]) }}, connections: [{wires} "swing.y -> push.tau", "push.r <-> disc0.r <-> sensor.r",
           "push.c <-> sensor.c <-> frame.r", "sensor.w -> s.w"])"#
    )
}

/// Fastest times of compiling and of running, and the evaluations of a run.
fn measure(text: &str) -> (Duration, Duration, u64) {
    let mut fastest = (Duration::MAX, Duration::MAX, 0);
    for _ in 0..RUNS {
        let start = computed();
        let (compiled, problems) = compile_text(text);
        let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
        let compiled = computed() - start;
        let start = computed();
        let mut simulation = Simulation::new(Arc::new(schedule)).expect("a start");
        simulation.run(&mut Forget).expect("a run");
        let counts = simulation.counts();
        fastest = (fastest.0.min(compiled), fastest.1.min(computed() - start), counts.evaluations);
    }
    fastest
}

#[expect(clippy::print_stdout, reason = "a benchmark shows its figures")]
fn main() {
    let models = [("line", line as fn(usize) -> String), ("rod", rod), ("shaft", shaft)];
    println!("{:8}{:>8}{:>14}{:>12}{:>14}", "", "size", "compile [ms]", "run [ms]", "evaluations");
    for (name, text) in models {
        let sizes = [100, 1000].map(|n| (n, measure(&text(n))));
        for (n, (compile, run, evaluations)) in sizes {
            let [compile, run] = [compile, run].map(|time| time.as_secs_f64() * 1e3);
            println!("{name:8}{n:8}{compile:14.2}{run:12.2}{evaluations:14}");
            println!("time growth/{name}/{n}/compile {compile:.4} ms");
            println!("time growth/{name}/{n}/run {run:.4} ms");
        }
        let [(_, few), (_, many)] = sizes;
        let ratio = |a: Duration, b: Duration| b.as_secs_f64() / a.as_secs_f64();
        let all = ratio(few.0 + few.1, many.0 + many.1);
        println!(
            "{name:8}{:>8}{:14.1}{:12.1}{:14.2}  both {all:.1}",
            "growth",
            ratio(few.0, many.0),
            ratio(few.1, many.1),
            many.2 as f64 / few.2 as f64
        );
    }
}
