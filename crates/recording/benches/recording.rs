//! What recording a thousand signals at 10 kHz costs a run, and how fast one of them is read from a large recording.
//!
//! `cargo bench -p blocksim-recording --bench recording`; words behind ` -- ` choose cases: `-- loops`. Writes below the folder for
//! temporary files (`TMPDIR`), up to 1.5 GB, and removes it again. Goals: at most 10 % more time than without recording; one
//! signal of 1 GB in less than 1 s.

#[path = "../../sim/tests/engine/toys/mod.rs"]
mod toys;

use std::hint::black_box;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use blocksim_block::schedule::{OutputTimes, Schedule};
use blocksim_recording::{ALWAYS, Layout, Rate, Run, SignalInfo, Store, Stream};
use blocksim_sim::{Control, Counts, Observer, Simulation};
use toys::{Constant, Function2, Gain, Integrator, Lag, Time, Toy, ode4};

/// Pairs of runs with and without; the fastest of each count, because the others were disturbed.
const PAIRS: usize = 7;
/// Signals of the cases.
const SIGNALS: usize = 1000;

/// A hundred small control loops with ten signals each, at 10 kHz; with and without their recording.
fn loops(seconds: f64) -> [Arc<Schedule>; 2] {
    let mut toy = Toy::new().with("t", Time, &[]);
    let mut names = Vec::new();
    for i in 0..SIGNALS / 10 {
        let [frequency, set, x, error, effort, motor, friction, force, power, seen] =
            ["frequency", "set", "x", "error", "effort", "motor", "friction", "force", "power", "seen"]
                .map(|name| format!("{name}{i}"));
        toy = toy
            .with(&frequency, Constant(2.0 + 0.4 * i as f64), &[])
            .with(&set, Function2(|t, w| (w * t).sin()), &["t", &frequency])
            .with(&x, Integrator(0.1), &[&force])
            .with(&error, Function2(|set, actual| set - actual), &[&set, &x])
            .with(&effort, Gain(40.0), &[&error])
            .with(&motor, Lag(50.0), &[&effort])
            .with(&friction, Gain(-0.3), &[&motor])
            .with(&force, Function2(|motor, friction| motor + friction), &[&motor, &friction])
            .with(&power, Function2(|force, speed| force * speed), &[&force, &friction])
            .with(&seen, Lag(200.0), &[&x]);
        names.extend([frequency, set, x, error, effort, motor, friction, force, power, seen]);
    }
    let recorded: Vec<&str> = names.iter().map(String::as_str).collect();
    let with = toy.schedule(&recorded, seconds, ode4(1e-4), OutputTimes::Steps);
    let mut without = Schedule::clone(&with);
    without.recorded.clear();
    [with, Arc::new(without)]
}

/// Takes no rows.
struct Nobody;

impl Observer for Nobody {
    fn row(&mut self, _t: f64, values: &[f64]) {
        black_box(values);
    }
}

/// Hands the rows to the disk, as the program does.
struct Disk(Stream);

impl Observer for Disk {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.0.row(t, values).expect("rows in order");
    }

    fn progress(&mut self, _t: f64, _counts: &Counts) -> Control {
        self.0.tend();
        Control::Go
    }
}

/// Seconds on the wall, of this thread on a processor, and of all threads.
#[derive(Clone, Copy)]
struct Spent {
    wall: f64,
    thread: f64,
    cpu: f64,
}

impl Spent {
    const ALL: Spent = Spent { wall: f64::INFINITY, thread: f64::INFINITY, cpu: f64::INFINITY };

    fn least(self, other: Spent) -> Spent {
        Spent {
            wall: self.wall.min(other.wall),
            thread: self.thread.min(other.thread),
            cpu: self.cpu.min(other.cpu),
        }
    }
}

/// Seconds that the threads of this program have worked; Linux tells it, in hundredths.
fn cpu() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = text.rsplit_once(')').map_or("", |(_, rest)| rest).split_whitespace();
    fields.skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// Seconds that this thread has worked, whatever else the machine does.
fn thread() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split_whitespace().next().and_then(|ns| ns.parse::<f64>().ok()).map_or(f64::NAN, |ns| ns * 1e-9)
}

fn spent<T>(work: impl FnOnce() -> T) -> (Spent, T) {
    let (start, worked, before) = (Instant::now(), thread(), cpu());
    let made = work();
    let wall = start.elapsed().as_secs_f64();
    (Spent { wall, thread: thread() - worked, cpu: cpu() - before }, made)
}

/// Most memory that this program has had, MB; Linux tells it.
fn peak_memory() -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok())
        .map_or(f64::NAN, |kb| kb / 1024.0)
}

/// A file that goes away.
struct Scratch(PathBuf);

impl Scratch {
    fn new() -> Scratch {
        Scratch(std::env::temp_dir().join(format!("blocksim-bench-{}.rec", std::process::id())))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn layout(signals: usize) -> Layout {
    let signal =
        |n: usize| SignalInfo { path: format!("s{n}"), unit: "1".to_owned(), ..SignalInfo::default() };
    Layout { rates: vec![Rate::All], signals: (0..signals).map(signal).collect() }
}

fn begin(scratch: &Scratch, signals: usize) -> Stream {
    let sources: Vec<usize> = (0..signals).collect();
    Stream::begin(&scratch.0, &layout(signals), &sources, signals).expect("a place to write")
}

/// Runs a diagram with and without recording in turn.
#[expect(clippy::print_stdout, reason = "a benchmark shows its figures")]
fn compare([with, without]: [Arc<Schedule>; 2]) {
    let (mut bare, mut run, mut whole) = (Spent::ALL, Spent::ALL, Spent::ALL);
    let (mut rows, mut bytes) = (0, 0);
    for _ in 0..PAIRS {
        let mut simulation = Simulation::new(without.clone()).expect("a schedule that runs");
        bare = bare.least(spent(|| simulation.run(&mut Nobody).expect("a run")).0);
        let scratch = Scratch::new();
        let mut simulation = Simulation::new(with.clone()).expect("a schedule that runs");
        let (until_closed, until_end) = spent(|| {
            let (until_end, disk) = spent(|| {
                let mut disk = Disk(begin(&scratch, SIGNALS));
                simulation.run(&mut disk).expect("a run");
                disk
            });
            rows = disk.0.rows();
            let (_, failure) = disk.0.finish();
            assert!(failure.is_none(), "{failure:?}");
            until_end
        });
        (run, whole) = (run.least(until_end), whole.least(until_closed));
        bytes = std::fs::metadata(&scratch.0).map_or(0, |about| about.len());
    }
    let more = |with: f64, without: f64| 100.0 * (with / without - 1.0);
    let values = (rows * (SIGNALS as u64 + 1)) as f64;
    println!("{SIGNALS} signals, {rows} rows: {:.3} s without recording; with it", bare.thread);
    println!("  thread of the simulation {:+.1} %", more(run.thread, bare.thread));
    println!(
        "  on the wall {:+.1} %, until all is on the disk {:+.1} %",
        more(run.wall, bare.wall),
        more(whole.wall, bare.wall)
    );
    println!(
        "  all threads {:+.1} %, {:.1} ns a value",
        more(whole.cpu, bare.cpu),
        (whole.cpu - bare.cpu) / values * 1e9
    );
    println!("  {:.2} bytes a value", bytes as f64 / values);
    println!("time recording/{SIGNALS}_signals {:.4e} s", whole.wall);
}

/// Writes more than 1 GB and reads one signal of it.
#[expect(clippy::print_stdout, reason = "a benchmark shows its figures")]
fn large() {
    let scratch = Scratch::new();
    let mut stream = begin(&scratch, SIGNALS);
    let mut values = vec![0.0; SIGNALS];
    let mut bits = 1_u64;
    let (writing, stream) = spent(|| {
        for k in 0..135_000_u32 {
            for value in &mut values {
                // Noise: nothing can be left out.
                bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                *value = (bits >> 11) as f64 - 4.5e15;
            }
            stream.row(f64::from(k) * 1e-4, &values).expect("rows in order");
        }
        stream
    });
    assert!(stream.finish().1.is_none());
    let bytes = std::fs::metadata(&scratch.0).map_or(0, |about| about.len());
    let (reading, rows) = spent(|| {
        let run = Run::of(Store::open(&scratch.0).expect("a recording"));
        run.read(SIGNALS / 2, &ALWAYS).expect("a signal").values.len()
    });
    println!(
        "{:.2} GB of noise ({:.2e} values, {:.0} MB of memory): written in {:.2} s, one signal of {rows} rows read in {:.3} s",
        bytes as f64 * 1e-9,
        (rows * (SIGNALS + 1)) as f64,
        peak_memory(),
        writing.wall,
        reading.wall
    );
    println!("time recording/large/written {:.4e} s", writing.wall);
    println!("time recording/large/read {:.4e} s", reading.wall);
}

fn main() {
    // Cargo adds an option of its own.
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| word == name);
    if is_wanted("loops") {
        compare(loops(3.0));
    }
    if is_wanted("large") {
        large();
    }
}
