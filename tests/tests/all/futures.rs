//! A run that is left at an instant and goes on from a snapshot there: the same bits as if nobody had ever stopped, also behind a change of
//! a parameter, and from every instant at which it may be stopped.

use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_sim::{Counts, Ended, Observer, Simulation, Snapshot};
use blocksim_tests::{SMALL_DIAGRAMS, compile_text, root, schedule};

/// Keeps the bits of all rows, and stops a run at the first step at or behind each of some times.
#[derive(Default)]
struct Tape {
    bits: Vec<Vec<u64>>,
    stops: Vec<f64>,
}

impl Observer for Tape {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.bits.push(std::iter::once(&t).chain(values).map(|value| value.to_bits()).collect());
    }

    fn is_waiting(&self, t: f64) -> bool {
        self.stops.first().is_some_and(|stop| t >= *stop)
    }
}

fn straight(schedule: &Arc<Schedule>) -> Vec<Vec<u64>> {
    let mut tape = Tape::default();
    let mut simulation = Simulation::new(schedule.clone()).expect("a sound diagram");
    assert_ne!(simulation.run(&mut tape).expect("a run"), Ended::Interrupted);
    tape.bits
}

/// A snapshot, the work and the rows until then.
type Moment = (Snapshot, Counts, usize);

/// The bits of a run that is stopped at parts of its time, and snapshots of these instants.
fn stopped(schedule: &Arc<Schedule>, parts: &[f64]) -> (Vec<Vec<u64>>, Vec<Moment>) {
    let stop = schedule.settings.stop_time;
    let mut tape = Tape { stops: parts.iter().map(|part| part * stop).collect(), ..Tape::default() };
    let mut simulation = Simulation::new(schedule.clone()).expect("a sound diagram");
    let mut moments = Vec::new();
    while simulation.run(&mut tape).expect("a run") == Ended::Interrupted {
        while tape.stops.first().is_some_and(|stop| simulation.time() >= *stop) {
            tape.stops.remove(0);
        }
        moments.push((simulation.snapshot(), simulation.counts(), tape.bits.len()));
    }
    (tape.bits, moments)
}

/// That neither stops nor snapshots show.
fn check(schedule: &Arc<Schedule>, what: &str) {
    let whole = straight(schedule);
    let (bits, moments) = stopped(schedule, &[0.0, 0.13, 0.31, 0.311, 0.64, 0.97]);
    assert!(bits == whole, "{what}: a stop shows");
    assert!(moments.len() >= 2, "{what}: {} snapshots", moments.len());
    // The last one first: whoever goes back goes from a later state to an earlier one.
    for (snapshot, counts, rows) in moments.iter().rev() {
        let mut tape = Tape::default();
        let mut again = Simulation::resume(schedule.clone(), snapshot, *counts).expect("the same diagram");
        assert_eq!((again.time(), again.counts().accepted), (snapshot.time(), counts.accepted));
        again.run(&mut tape).expect("a run");
        assert!(tape.bits == whole[*rows..], "{what}: from {} s", snapshot.time());
    }
}

#[test]
fn a_snapshot_at_any_step_goes_on_as_if_nobody_had_stopped() {
    for path in SMALL_DIAGRAMS {
        check(&Arc::new(schedule(path, &[])), path);
    }
    for path in ["diagrams/servo_panel.ron", "diagrams/emergency_stop.ron"] {
        let mut short = schedule(path, &[]);
        short.settings.stop_time = 3.0;
        check(&Arc::new(short), path);
    }
    // With plug-ins, gears and switched circuits.
    for drive in ["drive=dc", "drive=asm", "drive=torque"] {
        let mut short = schedule("diagrams/irb2600/irb2600.ron", &[drive]);
        short.settings.stop_time = 0.03;
        check(&Arc::new(short), drive);
    }
}

#[test]
fn a_snapshot_has_delays_samples_noise_and_loops() {
    for (what, blocks, connections) in [
        (
            "a delay and a random source",
            r#""noise": Noise(ts: "10 ms", std: 1), "late": TransportDelay(delay: "73 ms"), "x": LowPass(tau: "50 ms")"#,
            r#""noise.y -> late.u", "late.y -> x.u, s.late", "x.y -> s.x""#,
        ),
        (
            "a sampled loop",
            r#""one": Constant(value: 1), "e": Sum(signs: "+-"), "i": DiscreteIntegrator(ts: "30 ms"), "x": LowPass(tau: "90 ms")"#,
            r#""one.y -> e.u1", "e.y -> i.u", "i.y -> x.u, s.late", "x.y -> e.u2, s.x""#,
        ),
        (
            "a loop that is solved by iteration",
            r#""t": Ramp(slope: "1 1/s"), "cos": Function(function: Cos), "p": Product(inputs: 2), "x": Integrator"#,
            r#""t.y -> p.u1", "cos.y -> p.u2", "p.y -> cos.u, x.u, s.late", "x.y -> s.x""#,
        ),
        (
            "a relay that switches",
            r#""wave": Sine(frequency: "3 Hz"), "relay": Relay(on_at: 0.5, off_at: -0.5), "x": LowPass(tau: "90 ms")"#,
            r#""wave.y -> relay.u", "relay.y -> x.u, s.late", "x.y -> s.x""#,
        ),
    ] {
        for solver in [
            "Ode45(rtol: 1e-7)",
            "Ode15s(rtol: 1e-6)",
            "Rodas4(rtol: 1e-5)",
            "Auto()",
            "Ode4(step: \"1 ms\")",
        ] {
            let text = format!(
                r#"Diagram(simulation: (stop_time: "2 s", solver: {solver}), blocks: {{ {blocks}, "s": Scope(inputs: ["late", "x"]) }},
                    connections: [{connections}])"#
            );
            let (compiled, problems) = compile_text(&text);
            let schedule = compiled.schedule.unwrap_or_else(|| panic!("{what}: {problems}"));
            check(&Arc::new(schedule), &format!("{what}, {solver}"));
        }
    }
}

#[test]
fn a_run_goes_on_from_a_snapshot_behind_a_change_of_a_parameter() {
    let text = std::fs::read_to_string(root().join("diagrams/servo.ron")).expect("a diagram");
    let before = Arc::new(schedule("diagrams/servo.ron", &[]));
    let after = Arc::new(schedule("diagrams/servo.ron", &["pid.kp=20"]));
    assert!(text.contains("kp: 8.0"));
    let mut simulation = Simulation::new(before).expect("a sound diagram");
    let mut tape = Tape { stops: vec![0.4], ..Tape::default() };
    assert_eq!(simulation.run(&mut tape).expect("a run"), Ended::Interrupted);
    simulation.tune(after, &mut tape).expect("another gain");
    tape.stops = vec![0.9];
    assert_eq!(simulation.run(&mut tape).expect("a run"), Ended::Interrupted);
    let (snapshot, counts, schedule) =
        (simulation.snapshot(), simulation.counts(), simulation.shared_schedule());
    tape.stops.clear();
    let rows = tape.bits.len();
    simulation.run(&mut tape).expect("a run");
    let mut again = Tape::default();
    let mut other = Simulation::resume(schedule, &snapshot, counts).expect("the same diagram");
    other.run(&mut again).expect("a run");
    assert!(again.bits == tape.bits[rows..]);
    assert_eq!(other.counts().accepted, simulation.counts().accepted);
}

#[test]
fn a_snapshot_of_another_diagram_is_refused() {
    let one = Arc::new(schedule("diagrams/servo.ron", &[]));
    let other = Arc::new(schedule("diagrams/pendulum.ron", &[]));
    let snapshot = Simulation::new(one).expect("a sound diagram").snapshot();
    let error = Simulation::resume(other, &snapshot, Counts::default()).expect_err("another diagram");
    assert_eq!((error.code, error.message.as_str()), ("settings", "the snapshot is of another diagram"));
}
