//! No valve is ever on the wrong side: looked at on arrival at every major step, before anything is chosen anew, and where
//! the instant has settled.

use std::path::Path;
use std::sync::{Arc, Mutex};

use blocksim_block::schedule::Schedule;
use blocksim_block::{Block, Context, Given, Interface, InterfaceError, Piece, Scratch};
use blocksim_sim::{Observer, Simulation};
use blocksim_tests::random::{Circuit, Puzzle, Variant, contradiction};
use blocksim_tests::{compile_file, compile_text, root};

use super::{METHODS, try_run};

/// What the guards of the valves of a network have been.
#[derive(Debug, Default)]
struct Seen {
    /// Instants that have been looked at.
    instants: usize,
    /// Largest magnitude of each guard so far.
    scale: Vec<f64>,
    inputs: Vec<f64>,
    settled: bool,
    /// Guard, time and value relative to its largest, of the worst on arrival and where the instant had settled.
    worst: [Option<(String, f64, f64)>; 2],
}

/// A network whose valves are watched.
#[derive(Debug)]
struct Watched {
    network: Arc<dyn Block>,
    /// Names of all guards.
    guards: Vec<String>,
    seen: Arc<Mutex<Seen>>,
}

impl Watched {
    fn look(&self, c: &Context, w: &mut Scratch, when: usize) {
        let mut g = vec![0.0; self.guards.len()];
        self.network.guards(c, w, &mut g);
        let mut seen = self.seen.lock().unwrap();
        seen.instants += 1;
        seen.scale.resize(g.len(), 0.0);
        for (i, (name, g)) in self.guards.iter().zip(&g).enumerate() {
            seen.scale[i] = seen.scale[i].max(g.abs());
            let share = g / seen.scale[i].max(1e-6);
            if name.ends_with(".conducts")
                && seen.worst[when].as_ref().is_none_or(|(_, _, most)| share < *most)
            {
                seen.worst[when] = Some((name.clone(), c.t, share));
            }
        }
    }
}

impl Block for Watched {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        self.network.interface(given)
    }

    fn scratch(&self) -> Scratch {
        self.network.scratch()
    }

    fn initialize(&self, c: &Context, x: &mut [f64], d: &mut [f64]) {
        self.network.initialize(c, x, d);
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        self.network.settle(c, d);
    }

    fn outputs(&self, group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        self.network.outputs(group, c, w, y);
    }

    fn derivatives(&self, c: &Context, w: &mut Scratch, dx: &mut [f64]) {
        self.network.derivatives(c, w, dx);
    }

    fn update(&self, c: &Context, w: &mut Scratch, d: &mut [f64]) {
        self.network.update(c, w, d);
    }

    fn jump(&self, c: &Context, w: &mut Scratch, x: &mut [f64], d: &mut [f64]) -> bool {
        // A gate or a source that has just jumped puts valves on the wrong side, rightly.
        let arrives = {
            let mut seen = self.seen.lock().unwrap();
            let same = seen.inputs == c.u;
            seen.inputs = c.u.to_vec();
            same && std::mem::replace(&mut seen.settled, false)
        };
        if arrives {
            self.look(&Context { x: &*x, d: &*d, ..*c }, w, 0);
        }
        let jumped = self.network.jump(c, w, x, d);
        if !jumped {
            self.look(&Context { x: &*x, d: &*d, ..*c }, w, 1);
            self.seen.lock().unwrap().settled = true;
        }
        jumped
    }

    fn guards(&self, c: &Context, w: &mut Scratch, g: &mut [f64]) {
        self.network.guards(c, w, g);
    }

    fn next_event(&self, c: &Context) -> f64 {
        self.network.next_event(c)
    }

    fn accept(&self, c: &Context, d: &mut [f64]) -> bool {
        self.network.accept(c, d)
    }

    fn remember(&self, c: &Context, piece: &Piece, d: &mut [f64]) {
        self.network.remember(c, piece, d);
    }

    fn reach(&self, c: &Context, d: &mut [f64]) {
        self.network.reach(c, d);
    }

    fn next_kink(&self, c: &Context) -> f64 {
        self.network.next_kink(c)
    }

    fn prepare(&self, c: &Context, hg: f64, w: &mut Scratch) {
        self.network.prepare(c, hg, w);
    }

    fn solve(&self, w: &mut Scratch, r: &mut [f64]) {
        self.network.solve(w, r);
    }
}

struct Nobody;

impl Observer for Nobody {
    fn row(&mut self, _t: f64, _values: &[f64]) {}
}

/// Watches the networks with valves of a schedule.
fn watch(schedule: &mut Schedule) -> Vec<Arc<Mutex<Seen>>> {
    let mut all = Vec::new();
    for instance in &mut schedule.blocks {
        let guards: Vec<String> = instance.interface.guards.iter().map(|guard| guard.name.clone()).collect();
        if !instance.parts.is_empty() && guards.iter().any(|name| name.ends_with(".conducts")) {
            let seen = Arc::new(Mutex::new(Seen::default()));
            instance.block =
                Arc::new(Watched { network: Arc::clone(&instance.block), guards, seen: Arc::clone(&seen) });
            all.push(seen);
        }
    }
    all
}

/// Where steps end behind an event by what its location leaves, valves are on the wrong side by this part of their largest
/// voltage or current; behind the choice of modes by rounding alone.
const ALLOWED: [f64; 2] = [-1e-6, -1e-12];

fn faults(name: &str, seen: &[Arc<Mutex<Seen>>]) -> Vec<String> {
    let mut faults = Vec::new();
    for seen in seen {
        let seen = seen.lock().unwrap();
        for (when, allowed) in ALLOWED.into_iter().enumerate() {
            if let Some((guard, t, share)) = seen.worst[when].as_ref().filter(|worst| worst.2 < allowed) {
                let which = ["on arrival", "settled"][when];
                faults.push(format!("{name}: {guard} is {share:e} {which} at {t}"));
            }
        }
    }
    faults
}

fn collect(folder: &Path, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "ron") {
            found.push(path.strip_prefix(root()).expect("below the root").display().to_string());
        }
    }
}

#[test]
fn in_no_shipped_diagram_does_a_valve_contradict_itself() {
    let mut names = Vec::new();
    collect(&root().join("diagrams"), &mut names);
    names.sort();
    let (mut watched, mut instants, mut wrong) = (0, 0, Vec::new());
    for name in &names {
        let Some(mut schedule) = compile_file(name, &[]).0.schedule else { continue };
        let seen = watch(&mut schedule);
        if seen.is_empty() {
            continue;
        }
        // The robot alone makes thousands of steps in a second.
        let end = if name.contains("irb2600") { 0.3 } else { f64::INFINITY };
        let end = end.min(schedule.settings.stop_time);
        let mut simulation = Simulation::new(Arc::new(schedule)).expect("a start");
        if let Err(error) = simulation.run_until(end, &mut Nobody) {
            wrong.push(format!("{name}: {error}"));
        }
        wrong.extend(faults(name, &seen));
        watched += seen.len();
        instants += seen.iter().map(|seen| seen.lock().unwrap().instants).sum::<usize>();
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(watched >= 4 && instants > 10_000, "{watched} networks at {instants} instants");
}

#[test]
fn in_no_random_circuit_does_a_valve_contradict_itself() {
    let (mut instants, mut wrong) = (0, Vec::new());
    for seed in 2000..2200 {
        let circuit = Circuit::of(seed);
        let text = circuit.text(&Variant::plain());
        let mut schedule = compile_text(&text).0.schedule.expect("a schedule");
        let seen = watch(&mut schedule);
        let run = blocksim_tests::run(schedule);
        wrong.extend(run.error.as_ref().map(|error| format!("seed {seed}: {error}")));
        wrong.extend(faults(&format!("seed {seed}"), &seen));
        let beyond = contradiction(&run, &circuit);
        if beyond > 1e-4 {
            wrong.push(format!("seed {seed}: a row is wrong by {beyond:e}"));
        }
        instants += seen.iter().map(|seen| seen.lock().unwrap().instants).sum::<usize>();
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
    assert!(instants > 50_000, "{instants}");
}

/// A source that jumps makes a diode block: the rows around the jump are each whole, and there is none with the new voltage
/// and the old path.
#[test]
fn rows_around_a_jump_of_a_source_are_each_whole() {
    let text = r#"Diagram(
    simulation: (stop_time: "20 ms"),
    blocks: {
        "u": Step(time: "5 ms", before: "10 V", after: "-10 V"), "src": ControlledVoltageSource,
        "d": Diode(v_f: "0.7 V", r_on: "10 mOhm"), "r": Resistor(r: "10 ohm"), "g": ElectricalReference,
        "rc": Resistor(r: "1 ohm"), "c": Capacitor(c: "1 mF"), "s": Scope(inputs: ["u", "v", "i"]),
    },
    connections: [
        "u.y -> src.v", "src.p <-> d.p", "d.n <-> r.p <-> rc.p", "rc.n <-> c.p", "r.n <-> c.n <-> src.n <-> g.p",
        "u.y -> s.u", "d.v -> s.v", "d.i -> s.i",
    ],
)"#;
    for method in METHODS {
        let run = try_run(&text.replace("\"20 ms\"", &format!("\"20 ms\", solver: {method}"))).unwrap();
        let rows = |t: f64| run.time.iter().filter(|time| (**time - t).abs() < 1e-12).count();
        assert_eq!(rows(5e-3), 2, "{method}");
        for (v, i) in run.column("s.v").iter().zip(run.column("s.i")) {
            assert!(*i >= 0.0 && *v <= 0.7 + 0.01 * i + 1e-9, "{method}: {v} V, {i} A");
        }
    }
}
