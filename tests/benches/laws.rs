//! What an evaluation of simple blocks costs: rings of integrators and gains, a cascaded servo of 24 blocks beside the same loop
//! written by hand, and the oscillator of van der Pol.
//!
//! `cargo bench -p blocksim-tests --bench laws`; one of them alone with ` -- ring`, ` -- servo` or ` -- oscillator`.

use std::fmt::Write;
use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use blocksim_host::machines;
use blocksim_sim::{Observer, Simulation};
use blocksim_tests::compile_text;

/// Runs of each model; the fastest counts, because the others were disturbed.
const RUNS: usize = 9;
const STEPS: usize = 100_000;
/// Parts of a run of the servo, of which the fastest counts: hardly a whole run is undisturbed where others compute as well.
const PARTS: u32 = 20;

/// Keeps the last row.
#[derive(Default)]
struct Last(Vec<f64>);

impl Observer for Last {
    fn row(&mut self, _t: f64, values: &[f64]) {
        self.0.clear();
        self.0.extend_from_slice(values);
        black_box(&self.0);
    }
}

/// A ring of integrators and gains, the last of which turns the sign.
fn ring(n: usize, steps: usize) -> String {
    let (mut blocks, mut wires) = (String::new(), String::new());
    for i in 0..n {
        let (k, next) = (if i + 1 == n { -1 } else { 1 }, (i + 1) % n);
        let x0 = i32::from(i == 0);
        write!(blocks, r#""x{i}": Integrator(x0: {x0}), "k{i}": Gain(k: "{k} 1/s"), "#).expect("text");
        write!(wires, r#""x{i}.y -> k{i}.u", "k{i}.y -> x{next}.u", "#).expect("text");
    }
    let stop = steps as f64 * 1e-3;
    format!(
        r#"Diagram(simulation: (stop_time: "{stop} s", solver: Ode4(step: "1 ms")), blocks: {{ {blocks} }}, connections: [{wires}])"#
    )
}

/// Position, speed and current of a drive in cascade, with a limited voltage and a load that sets in.
const SERVO: &str = r#"Diagram(simulation: (stop_time: "10 s", solver: Ode4(step: "0.1 ms")), blocks: {
    "ref": Constant(value: 1), "ep": Sum(signs: "+-"), "kp": Gain(k: 60.0), "ew": Sum(signs: "+-"), "kv": Gain(k: 0.5),
    "u": Sum(signs: "++"), "sat": Saturation(lower: -24, upper: 24), "aw": Sum(signs: "+-"), "kaw": Gain(k: 20.0), "ki": Gain(k: 10.0),
    "dxi": Sum(signs: "++"), "xi": Integrator, "ri": Gain(k: 0.5), "ke": Gain(k: 0.05), "vl": Sum(signs: "+--"), "il": Gain(k: 1000.0),
    "i": Integrator, "kt": Gain(k: 0.05), "bw": Gain(k: 1e-4), "tl": Step(time: "9.98 s", after: 0.05), "tj": Sum(signs: "+--"),
    "ij": Gain(k: 1e4), "w": Integrator, "th": Integrator, "s": Scope(inputs: ["th"]) },
  connections: ["ref.y -> ep.u1", "th.y -> ep.u2", "ep.y -> kp.u", "kp.y -> ew.u1", "w.y -> ew.u2", "ew.y -> kv.u", "kv.y -> u.u1",
    "xi.y -> u.u2", "u.y -> sat.u", "sat.y -> aw.u1", "u.y -> aw.u2", "aw.y -> kaw.u", "ew.y -> ki.u", "ki.y -> dxi.u1", "kaw.y -> dxi.u2",
    "dxi.y -> xi.u", "i.y -> ri.u", "w.y -> ke.u", "sat.y -> vl.u1", "ri.y -> vl.u2", "ke.y -> vl.u3", "vl.y -> il.u", "il.y -> i.u",
    "i.y -> kt.u", "w.y -> bw.u", "kt.y -> tj.u1", "bw.y -> tj.u2", "tl.y -> tj.u3", "tj.y -> ij.u", "ij.y -> w.u", "w.y -> th.u",
    "th.y -> s.th"])"#;

/// The same loop by hand, with classical Runge-Kutta steps; each row is handed out.
fn by_hand(steps: usize, h: f64) -> f64 {
    let slope = |load: f64, [xi, i, w, th]: [f64; 4]| {
        let ew = 60.0 * (1.0 - th) - w;
        let u = 0.5 * ew + xi;
        let v = u.clamp(-24.0, 24.0);
        [10.0 * ew + 20.0 * (v - u), (v - 0.5 * i - 0.05 * w) * 1000.0, (0.05 * i - 1e-4 * w - load) * 1e4, w]
    };
    let along = |x: [f64; 4], d: [f64; 4], h: f64| -> [f64; 4] { std::array::from_fn(|i| x[i] + h * d[i]) };
    let mut x = [0.0; 4];
    let mut row = Last::default();
    for k in 0..steps {
        let t = k as f64 * h;
        // It sets in at a step and is held within.
        let load = if t < 9.98 { 0.0 } else { 0.05 };
        let a = slope(load, x);
        let b = slope(load, along(x, a, h / 2.0));
        let c = slope(load, along(x, b, h / 2.0));
        let d = slope(load, along(x, c, h));
        x = std::array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        row.row(t + h, &x[3..]);
    }
    x[3]
}

const OSCILLATOR: &str = r#"Diagram(simulation: (stop_time: "20 s", solver: Ode45(rtol: 1e-6, atol: 1e-9)), blocks: {
    "x": Integrator(x0: 2), "v": Integrator, "square": Product(inputs: 2), "one": Constant(value: 1), "less": Sum(signs: "+-"),
    "damp": Product(inputs: 2), "mu": Gain(k: 5.0), "a": Sum(signs: "+-"), "s": Scope(inputs: ["x"]) },
  connections: ["v.y -> x.u", "x.y -> square.u1", "x.y -> square.u2", "one.y -> less.u1", "square.y -> less.u2", "less.y -> damp.u1",
    "v.y -> damp.u2", "damp.y -> mu.u", "mu.y -> a.u1", "x.y -> a.u2", "a.y -> v.u", "x.y -> s.x"])"#;

/// Fastest time of a run, its evaluations and its last row; by the interpreter and by machine code. Of a run in several parts of the same
/// length the time is that of the fastest one, as many times.
fn run(text: &str, parts: u32) -> [(Duration, u64, Vec<f64>); 2] {
    let (compiled, problems) = compile_text(text);
    let schedule = Arc::new(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    let made = machines(&Simulation::new(Arc::clone(&schedule)).expect("a start").tapes(), None);
    let made = made.expect("a compiler").machines;
    [false, true].map(|is_native| {
        let mut best = (Duration::MAX, 0, Vec::new());
        for _ in 0..RUNS {
            let mut simulation = Simulation::new(Arc::clone(&schedule)).expect("a start");
            if is_native {
                simulation.run_by(&made).expect("the same bits");
            }
            let mut last = Last::default();
            for part in 1..=parts {
                let end = schedule.settings.stop_time * f64::from(part) / f64::from(parts);
                let start = Instant::now();
                simulation.run_until(end, &mut last).expect("a run");
                best.0 = best.0.min(start.elapsed() * parts);
            }
            (best.1, best.2) = (simulation.counts().evaluations, last.0);
        }
        best
    })
}

fn main() {
    let asked = std::env::args().skip(1).find(|word| !word.starts_with('-'));
    let is_asked = |name: &str| asked.as_deref().is_none_or(|asked| asked == name);
    let models: [(&str, fn()); 3] = [("ring", rings), ("servo", servo), ("oscillator", oscillator)];
    models.iter().filter(|(name, _)| is_asked(name)).for_each(|(_, model)| model());
}

#[expect(clippy::print_stdout, reason = "a benchmark shows its figures")]
fn rings() {
    for n in [50, 500, 5_000, 50_000] {
        let steps = (2_000_000 / n).max(20);
        let [each, native] = run(&ring(n, steps), 1)
            .map(|(time, evaluations, _)| time.as_secs_f64() * 1e9 / evaluations as f64 / (2 * n) as f64);
        println!("ring of {:6} blocks {each:10.2} ns a block and evaluation, native {native:.2} ns", 2 * n);
        println!("time laws/ring/{} {:.6} ms", 2 * n, each * 1e-6);
    }
}

#[expect(clippy::print_stdout, reason = "a benchmark shows its figures")]
fn servo() {
    let mut hand = Duration::MAX;
    for _ in 0..RUNS * PARTS as usize {
        let start = Instant::now();
        black_box(by_hand(black_box(STEPS / PARTS as usize), 1e-4));
        hand = hand.min(start.elapsed() * PARTS);
    }
    let end = by_hand(STEPS, 1e-4);
    let [(servo, _, last), (native, ..)] = run(SERVO, PARTS);
    assert!((last[0] - end).abs() < 1e-9, "{last:?} and {end}");
    let step = |time: Duration| time.as_secs_f64() * 1e9 / STEPS as f64;
    println!(
        "servo {:.0} ns a step, native {:.0} ns, by hand {:.0} ns, ratios {:.2} and {:.2}",
        step(servo),
        step(native),
        step(hand),
        step(servo) / step(hand),
        step(native) / step(hand)
    );
    println!("time laws/servo {:.4} ms", servo.as_secs_f64() * 1e3);
    println!("time laws/by_hand {:.4} ms", hand.as_secs_f64() * 1e3);
}

#[expect(clippy::print_stdout, reason = "a benchmark shows its figures")]
fn oscillator() {
    let [(oscillator, evaluations, _), (native, ..)] = run(OSCILLATOR, 1);
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    println!("van der Pol {:.3} ms, native {:.3} ms, {evaluations} evaluations", ms(oscillator), ms(native));
    println!("time laws/van_der_pol {:.4} ms", oscillator.as_secs_f64() * 1e3);
}
