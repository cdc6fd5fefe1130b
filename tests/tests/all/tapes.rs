//! Laws that run together on tapes give the bits of blocks that are called one by one: rows, events and work.

use std::sync::Arc;

use blocksim_block::law::{Machine, Ran};
use blocksim_block::schedule::{FixedMethod, OutputTimes, Schedule, Solver, Start, When};
use blocksim_host::machines;
use blocksim_sim::{Counts, Ended, Observer, SimError, Simulation};
use blocksim_tests::random::{Circuit, Mechanisms, Puzzle, Sampled, Shafts, Signals, Variant};
use blocksim_tests::{compile_file, compile_text, diagrams_below, root};

/// Runs end at this time, s, at the latest.
const LONGEST: f64 = 0.5;

/// All that a run says, bit by bit.
#[derive(Debug, Default, PartialEq)]
struct Heard {
    rows: Vec<u64>,
    events: Vec<String>,
}

impl Observer for Heard {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.rows.push(t.to_bits());
        self.rows.extend(values.iter().map(|value| value.to_bits()));
    }

    fn event(&mut self, t: f64, block: &str, what: &str) {
        self.events.push(format!("{t} {block} {what}"));
    }
}

fn run(simulation: Result<Simulation, SimError>, end: f64) -> (Heard, Option<Counts>, Option<String>) {
    let mut heard = Heard::default();
    let mut simulation = match simulation {
        Ok(simulation) => simulation,
        Err(error) => return (heard, None, Some(error.to_string())),
    };
    let error = simulation.run_until(end, &mut heard).err();
    (heard, Some(simulation.counts()), error.map(|error| error.to_string()))
}

/// Whether both agree, and how many blocks record their laws.
fn agree(name: &str, mut schedule: Schedule, wrong: &mut Vec<String>) -> usize {
    schedule.settings.start = Start::Given;
    let end = schedule.settings.stop_time.min(LONGEST);
    let laws = schedule.blocks.iter().filter(|block| block.law.is_some()).count();
    let schedule = Arc::new(schedule);
    let together = run(Simulation::new(Arc::clone(&schedule)), end);
    let one_by_one = run(Simulation::one_by_one(schedule), end);
    if together != one_by_one {
        let row = together.0.rows.iter().zip(&one_by_one.0.rows).position(|(a, b)| a != b);
        wrong.push(format!(
            "{name}: number {row:?} of the rows; {:?} {:?}, {:?} {:?}",
            together.1, together.2, one_by_one.1, one_by_one.2
        ));
    }
    laws
}

#[test]
fn shipped_diagrams_and_examples_of_blocks_give_the_bits_of_single_calls() {
    let paths = [diagrams_below("diagrams"), diagrams_below("docs/blocks")].concat();
    let (mut laws, mut wrong) = (0, Vec::new());
    for path in &paths {
        let name = path.strip_prefix(root()).expect("below the root").display().to_string();
        // Parts of models and files of moves are no runs.
        let Some(schedule) = compile_file(&name, &[]).0.schedule else { continue };
        laws += agree(&name, schedule, &mut wrong);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(laws > 150, "only {laws} blocks have laws");
}

#[test]
fn random_models_give_the_bits_of_single_calls() {
    fn random<P: Puzzle>(class: &str, wrong: &mut Vec<String>) -> usize {
        let of_seed = |seed: u64| {
            let (compiled, problems) = compile_text(&P::of(seed).text(&Variant::plain()));
            compiled.schedule.unwrap_or_else(|| panic!("{class} {seed}: {problems}"))
        };
        (1..81).map(|seed| agree(&format!("{class} {seed}"), of_seed(seed), wrong)).sum()
    }
    let mut wrong = Vec::new();
    let laws = random::<Signals>("signals", &mut wrong)
        + random::<Sampled>("sampled", &mut wrong)
        + random::<Mechanisms>("mechanisms", &mut wrong)
        + random::<Shafts>("shafts", &mut wrong)
        + random::<Circuit>("circuits", &mut wrong);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(laws > 300, "only {laws} blocks have laws");
}

/// The same model with a method of fixed step, of about a thousand steps.
fn fixed(mut schedule: Schedule, method: FixedMethod) -> Schedule {
    let step = schedule.settings.stop_time.min(LONGEST) / 999.7;
    schedule.settings.solver = Solver::Fixed { method, step };
    schedule
}

/// Steps of a fixed size at which nothing is due are made by the diagram itself, and only what somebody asks for is evaluated there.
#[test]
fn steps_of_a_fixed_size_give_the_bits_of_single_calls() {
    let paths = [diagrams_below("diagrams"), diagrams_below("docs/blocks")].concat();
    let files = paths.into_iter().filter_map(|path| {
        let name = path.strip_prefix(root()).expect("below the root").display().to_string();
        Some((name.clone(), compile_file(&name, &[]).0.schedule?))
    });
    let random = (1..81).flat_map(|seed| {
        let texts = [Signals::of(seed).text(&Variant::plain()), Sampled::of(seed).text(&Variant::plain())];
        texts.map(|text| (format!("random {seed}"), compile_text(&text).0.schedule.expect("a model")))
    });
    let methods = [FixedMethod::Ode4, FixedMethod::Ode1, FixedMethod::Ode5, FixedMethod::Ode3];
    let mut wrong = Vec::new();
    for ((name, schedule), method) in files.chain(random).zip(methods.into_iter().cycle()) {
        let mut schedule = fixed(schedule, method);
        agree(&format!("{name} by {method:?}"), schedule.clone(), &mut wrong);
        // Where each step is recorded, the diagram makes many in a row.
        schedule.settings.output = OutputTimes::Steps;
        agree(&format!("{name} by {method:?}, each step"), schedule, &mut wrong);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Hears the same, but wants the run to stop after each so many rows.
struct Halting {
    heard: Heard,
    every: usize,
    rows: usize,
}

impl Observer for Halting {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.rows += 1;
        self.heard.row(t, values);
    }

    fn event(&mut self, t: f64, block: &str, what: &str) {
        self.heard.event(t, block, what);
    }

    fn is_waiting(&self, _t: f64) -> bool {
        self.rows.is_multiple_of(self.every)
    }
}

/// Steps in a row come to an end where a mode changes, a law has no value, a number is not finite, a source jumps, or the observer
/// wants to be heard: with the rows, the events, the message and the work of single ones.
#[test]
fn steps_in_a_row_end_where_single_ones_do() {
    let models = [
        // A mode that changes forth and back.
        r#""s": Sine(amplitude: 2, frequency: "1 Hz"), "l": Relay(on_at: 1, off_at: -1, on: 1, off: -1), "x": Integrator, "w": Scope(inputs: ["y", "law"])"#,
        // A law without a value from 0.7 s on.
        r#""s": Ramp(slope: "-1 1/s", initial: 0.7), "l": Function(function: Sqrt), "x": Integrator, "w": Scope(inputs: ["y"])"#,
        // A recorded value that is not finite.
        r#""s": Ramp(slope: "1000 1/s"), "l": Function(function: Exp), "x": Integrator, "w": Scope(inputs: ["y", "law"])"#,
        // The same where no derivative depends on it.
        r#""s": Ramp(slope: "-1 1/s", initial: 0.7), "l": Function(function: Sqrt), "x": Integrator, "w": Scope(inputs: ["y", "law"]), "alone": Terminator"#,
        r#""s": Ramp(slope: "1000 1/s"), "l": Function(function: Exp), "x": Integrator, "w": Scope(inputs: ["y", "law"]), "alone": Terminator"#,
        // A jump between two steps, and one at a step.
        r#""s": Step(time: "0.50025 s", after: 3), "l": Gain(k: 2.0), "x": Integrator, "w": Scope(inputs: ["y"])"#,
        r#""s": Step(time: "0.5 s", after: 3), "l": Gain(k: 2.0), "x": Integrator, "w": Scope(inputs: ["y"])"#,
    ];
    let mut ends = Vec::new();
    for model in models {
        let law = if model.contains("law") { r#", "l.y -> w.law""# } else { "" };
        let fed =
            if model.contains("alone") { r#""s.y -> d.u", "l.y -> alone.u""# } else { r#""l.y -> d.u""# };
        let text = format!(
            r#"Diagram(simulation: (stop_time: "1 s", solver: Ode4(step: "1 ms")), blocks: {{ {model},
               "g": Gain(k: "-1 1/s"), "d": Gain(k: "1 1/s"), "e": Sum(signs: "++"), "more": Gain(k: 2.0), "most": Gain(k: 3.0) }},
               connections: ["s.y -> l.u", {fed}, "d.y -> e.u1", "x.y -> g.u", "g.y -> e.u2", "e.y -> x.u", "g.y -> more.u", "more.y -> most.u",
               "x.y -> w.y"{law}])"#
        );
        let (compiled, problems) = compile_text(&text);
        let schedule = Arc::new(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
        let in_a_row = run(Simulation::new(Arc::clone(&schedule)), 1.0);
        assert_eq!(in_a_row, run(Simulation::one_by_one(Arc::clone(&schedule)), 1.0), "{model}");
        for every in [1, 7, 400] {
            let mut simulation = Simulation::new(Arc::clone(&schedule)).expect("a start");
            let mut halting = Halting { heard: Heard::default(), every, rows: 0 };
            let mut halts = 0;
            let error = loop {
                match simulation.run_until(1.0, &mut halting) {
                    Ok(Ended::Interrupted) => halts += 1,
                    Ok(_) => break None,
                    Err(error) => break Some(error.to_string()),
                }
            };
            assert!(halts >= halting.rows / every - 1, "{halts} halts in {} rows", halting.rows);
            assert_eq!((halting.heard, Some(simulation.counts()), error), in_a_row, "{model}, {every}");
        }
        ends.push((in_a_row.0.events.len(), in_a_row.2));
    }
    let errors: Vec<&str> = ends.iter().filter_map(|(_, error)| error.as_deref()).collect();
    assert!(errors.len() == 4 && ends[0].0 == 2, "{ends:?}");
}

/// The same model, in which all that may change between major steps is evaluated at every stage of the solver, every condition is
/// watched, and what is constant is evaluated at each major step, unless that alone made steps major.
fn by_no_need(mut schedule: Schedule) -> Schedule {
    let has_major = schedule.steps.iter().any(|step| step.when == When::Major);
    for step in &mut schedule.steps {
        if step.when == When::Constant && has_major {
            step.when = When::Major;
        }
        step.minor = step.when == When::Continuous;
    }
    for block in &mut schedule.blocks {
        block.watched |= block.rate.is_none() && !block.interface.guards.is_empty();
    }
    schedule
}

/// What is not evaluated has not changed: with nothing left out, runs have the same bits.
#[test]
fn what_is_left_out_between_major_steps_is_needed_by_nobody() {
    fn random<P: Puzzle>(class: &str) -> impl Iterator<Item = (String, Schedule)> {
        let of_seed = |seed: u64| compile_text(&P::of(seed).text(&Variant::plain())).0.schedule;
        (1..41).filter_map(move |seed| Some((format!("{class} {seed}"), of_seed(seed)?)))
    }
    let files = [diagrams_below("diagrams"), diagrams_below("docs/blocks")].concat().into_iter();
    let files = files.filter_map(|path| {
        let name = path.strip_prefix(root()).expect("below the root").display().to_string();
        Some((compile_file(&name, &[]).0.schedule?, name))
    });
    let files = files.map(|(schedule, name)| (name, schedule));
    let models = files
        .chain(random::<Signals>("signals"))
        .chain(random::<Sampled>("sampled"))
        .chain(random::<Mechanisms>("mechanisms"))
        .chain(random::<Circuit>("circuits"));
    let (mut left_out, mut wrong) = (0, Vec::new());
    for (name, mut schedule) in models {
        schedule.settings.start = Start::Given;
        // How long steps may be follows from what is left out.
        for interface in schedule.blocks.iter_mut().map(|block| &mut block.interface) {
            interface.period = None;
            interface.turning_inputs.clear();
            interface.turning_states.clear();
        }
        let end = schedule.settings.stop_time.min(LONGEST);
        left_out += schedule.steps.iter().filter(|step| step.when != When::Major && !step.minor).count();
        let by_need = run(Simulation::new(Arc::new(schedule.clone())), end);
        let all = run(Simulation::new(Arc::new(by_no_need(schedule))), end);
        if (&by_need.0, &by_need.2) != (&all.0, &all.2) {
            let row = by_need.0.rows.iter().zip(&all.0.rows).position(|(a, b)| a != b);
            wrong.push(format!("{name}: number {row:?} of the rows, {:?} {:?}", by_need.2, all.2));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(left_out > 1000, "only {left_out} groups are left out");
}

/// One source holds the tapes of all models, so that the compiler is started once.
#[test]
fn machine_code_gives_the_bits_of_the_interpreter() {
    let examples = diagrams_below("docs/blocks").into_iter().filter_map(|path| {
        let name = path.strip_prefix(root()).expect("below the root").display().to_string();
        Some((compile_file(&name, &[]).0.schedule?, name))
    });
    let random = (1..21).flat_map(|seed| {
        let texts = [Signals::of(seed).text(&Variant::plain()), Sampled::of(seed).text(&Variant::plain())];
        let models = texts.map(|text| compile_text(&text).0.schedule.expect("a model"));
        let of_fixed_step = models.clone().map(|model| fixed(model, FixedMethod::Ode4));
        models.into_iter().chain(of_fixed_step).map(move |model| (model, format!("random {seed}")))
    });
    let mut models: Vec<_> = examples
        .chain(random)
        .filter_map(|(mut schedule, name)| {
            schedule.settings.start = Start::Given;
            let schedule = Arc::new(schedule);
            let native = Simulation::new(Arc::clone(&schedule)).ok()?;
            (!native.tapes().is_empty()).then_some((schedule, native, name))
        })
        .collect();
    let tapes: Vec<_> = models.iter().flat_map(|(_, native, _)| native.tapes()).cloned().collect();
    let made = machines(&tapes.iter().collect::<Vec<_>>(), None).expect("a compiler");
    assert!(models.len() > 100 && made.machines.len() == tapes.len(), "{} models", models.len());
    let mut next = 0;
    for (_, native, name) in &mut models {
        let count = native.tapes().len();
        assert_eq!(native.run_by(&made.machines[next..next + count]), Ok(()), "{name}");
        next += count;
    }
    for (schedule, native, name) in models {
        let end = schedule.settings.stop_time.min(LONGEST);
        assert!(run(Ok(native), end) == run(Simulation::new(schedule), end), "{name}");
    }
}

/// A run by machine code and one by the interpreter; returns how many words the tapes have that are compiled.
fn compiled_lengths(text: &str) -> Vec<usize> {
    let (compiled, problems) = compile_text(text);
    let schedule = Arc::new(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    let mut native = Simulation::new(Arc::clone(&schedule)).expect("a start");
    let lengths = native.tapes().iter().map(|tape| tape.len()).collect();
    let made = machines(&native.tapes(), None).expect("a compiler");
    assert_eq!(native.run_by(&made.machines), Ok(()));
    assert!(run(Ok(native), LONGEST) == run(Simulation::new(schedule), LONGEST));
    lengths
}

/// Between two blocks that are called there is one that records its law, so many times.
fn interrupted(times: usize) -> String {
    let points = (0..40).map(|i| format!("{}.0", i - 20)).collect::<Vec<_>>().join(", ");
    let blocks: String = (0..times)
        .map(|i| {
            format!(
                r#""g{i}": Gain(k: 1.{i:03}), "t{i}": LookupTable1D(breakpoints: [{points}], table: [{points}]), "#
            )
        })
        .collect();
    let wires: String =
        (1..times).map(|i| format!(r#""g{i}.y -> t{i}.u", "t{}.y -> g{i}.u", "#, i - 1)).collect();
    let terms: String = (0..times).map(|i| format!(r#""t{i}.y -> sum.u{}", "#, i + 1)).collect();
    let signs = "+".repeat(times);
    format!(
        r#"Diagram(simulation: (stop_time: "0.1 s"), blocks: {{ "x": Integrator(x0: 1), {blocks} "sum": Sum(signs: "{signs}"),
            "s": Scope(inputs: ["y"]) }},
          connections: ["x.y -> g0.u", "g0.y -> t0.u", {wires} {terms} "t0.y -> x.u", "sum.y -> s.y"])"#
    )
}

#[test]
fn short_tapes_are_left_to_the_interpreter_where_there_are_many() {
    let few = compiled_lengths(&interrupted(12));
    assert!(few.iter().filter(|length| **length == 1).count() >= 10, "{few:?}");
    let many = compiled_lengths(&interrupted(80));
    assert!(!many.is_empty() && many.iter().all(|length| *length >= 8), "{many:?}");
}

#[test]
fn exact_slopes_are_compiled_for_the_methods_that_take_them() {
    let lengths = |method: &str| {
        compiled_lengths(&format!(
            r#"Diagram(simulation: (stop_time: "0.1 s", solver: {method}), blocks: {{ "x": Integrator(x0: 1), "v": Integrator,
                "f": Function(function: Sin), "k": Gain(k: -9), "s": Scope(inputs: ["x"]) }},
              connections: ["v.y -> x.u", "x.y -> f.u, s.x", "f.y -> k.u", "k.y -> v.u"])"#
        ))
    };
    let [stiff, explicit] = ["Ode15s(rtol: 1e-6)", "Ode45(rtol: 1e-6)"].map(lengths);
    assert_eq!(stiff.len(), explicit.len() + 1, "{stiff:?} {explicit:?}");
}

/// A machine that is as good as its tape but for the last bit of one number.
#[derive(Debug)]
struct Inexact(Arc<dyn Machine>);

impl Machine for Inexact {
    fn run(&self, cells: &mut [f64], held: &mut [f64]) -> Ran {
        let ran = self.0.run(cells, held);
        cells[0] = f64::from_bits(cells[0].to_bits() ^ 1);
        ran
    }
}

#[test]
fn a_machine_that_leaves_another_bit_is_refused_and_its_tape_goes_on() {
    let (compiled, _) = compile_text(&Signals::of(3).text(&Variant::plain()));
    let schedule = Arc::new(compiled.schedule.expect("a model"));
    let mut simulation = Simulation::new(Arc::clone(&schedule)).expect("a start");
    let mut made = machines(&simulation.tapes(), None).expect("a compiler").machines;
    let last = made.len() - 1;
    made[last] = Arc::new(Inexact(Arc::clone(&made[last])));
    assert_eq!(simulation.run_by(&made), Err(last));
    assert!(run(Ok(simulation), LONGEST) == run(Simulation::new(schedule), LONGEST));
}
