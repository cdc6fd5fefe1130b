//! Whether the controllers of a plug-in keep the contract: they are called in processes of their own, over and over, and what they
//! answer is compared.

use std::collections::BTreeMap;
use std::path::Path;

use blocksim_block::{LoadError, ParamValue};

use crate::finite::all_finite;
use crate::isolate;
use crate::kind::{At, Kind};
use crate::locate::Target;
use crate::open::{Binary, Library, built};
use crate::parameters;
use crate::plugin::unknown_block;

/// Steps of one experiment.
const STEPS: usize = 500;
/// Step of a continuous controller, s.
const STEP: f64 = 1e-3;

/// How an examination ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The rule is kept as far as was seen.
    Passed,
    /// It is broken.
    Failed,
    /// It could not be looked at, as something before it failed.
    Skipped,
}

/// A rule and what was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The rule in a word: `loads`, `parameters`, `reset`, `runs`, `finite`, `repeatable`, `stateless`, `pointers`.
    pub rule: &'static str,
    /// How it ended.
    pub verdict: Verdict,
    /// What was seen, where it is worth a sentence.
    pub said: String,
}

/// A controller that was examined.
#[derive(Debug)]
pub struct Examined {
    /// Its name in diagrams.
    pub kind: &'static str,
    /// A finding for each rule, in a fixed order.
    pub findings: Vec<Finding>,
    /// Mean and longest time that a step took, s; without the way to the other process.
    pub times: Option<(f64, f64)>,
}

impl Examined {
    /// Whether no rule is broken.
    pub fn is_good(&self) -> bool {
        self.findings.iter().all(|finding| finding.verdict == Verdict::Passed)
    }
}

/// Inputs and answers of one run through all steps.
#[derive(Debug, Clone, PartialEq)]
struct Trace {
    /// Bits of all numbers that the functions wrote.
    bits: Vec<u64>,
    /// Mean and longest time of a step, s.
    times: (f64, f64),
}

/// Builds a plug-in for a target if it needs to be, and examines each of its controllers, or the one of this name, with these parameters.
///
/// # Errors
/// It does not build or load, or has no such controller.
pub fn examine(
    folder: &Path,
    named: &str,
    target: Target,
    block: Option<&str>,
    given: &BTreeMap<String, ParamValue>,
) -> Result<Vec<Examined>, LoadError> {
    let binary = built(folder, named, target)?;
    let first = isolate::open(&binary, named, false)?;
    let wanted = |kind: &&Kind| block.is_none_or(|block| kind.name == block);
    let kinds: Vec<&Kind> = first.blocks.iter().filter(wanted).collect();
    if let (Some(block), true) = (block, kinds.is_empty()) {
        return Err(unknown_block(&first, block));
    }
    let is_known =
        |name: &str| kinds.iter().any(|kind| kind.parameters.iter().any(|known| known.name == name));
    if let Some(kind) = kinds.first()
        && !given.keys().all(|name| is_known(name))
    {
        parameters::numbers(kind, given)?;
    }
    kinds.iter().map(|kind| examined(&first, kind, &binary, named, given)).collect()
}

fn examined(
    library: &Library,
    kind: &Kind,
    binary: &Binary,
    named: &str,
    given: &BTreeMap<String, ParamValue>,
) -> Result<Examined, LoadError> {
    let mut book = Book { findings: Vec::new() };
    book.note("loads", Ok(format!("{} {}", library.name, library.version)));
    let mut times = None;
    if let Some((params, period)) = book.note_value("parameters", settings(kind, given)) {
        let starts = start(kind, &params).and_then(|first| {
            let again = start(kind, &params)?;
            if bits(&first.0).eq(bits(&again.0)) && bits(&first.1).eq(bits(&again.1)) {
                Ok(first)
            } else {
                Err("two starts with the same parameters differ".to_owned())
            }
        });
        if let Some(begin) = book.note_value("reset", starts) {
            let run = |kind: &Kind, seed| trace(kind, &params, period, &begin, seed, false);
            if let Some(trace) = book.note_value("runs", run(kind, 1)) {
                times = Some(trace.times);
                book.note("finite", finite(&trace));
                // Another process that has called nothing before.
                let other = isolate::open(binary, named, false)?;
                let same = |library: &Library| -> Result<Trace, String> {
                    let other = library.blocks.iter().find(|other| other.name == kind.name);
                    run(other.ok_or("the controller is gone")?, 1)
                };
                book.note(
                    "repeatable",
                    same(&other).and_then(|again| equal(&trace, &again, "a new process")),
                );
                // The same process, which has meanwhile seen something else, and forward and back in time.
                let stateless = run(kind, 2)
                    .and_then(|_| run(kind, 1))
                    .and_then(|again| equal(&trace, &again, "the same calls after others"));
                let back = trace_back(kind, &params, period, &begin);
                book.note("stateless", stateless.and(back));
                // One in which every call has buffers of its own, and the old ones hold no numbers.
                let moving = isolate::open(binary, named, true)?;
                book.note(
                    "pointers",
                    same(&moving).and_then(|again| {
                        equal(
                            &trace,
                            &again,
                            "buffers at other places: it keeps a pointer to those of an earlier call",
                        )
                    }),
                );
            }
        }
    }
    book.rest();
    Ok(Examined { kind: kind.name, findings: book.findings, times })
}

/// What was found so far.
struct Book {
    findings: Vec<Finding>,
}

/// All rules, in their order.
const RULES: [&str; 8] =
    ["loads", "parameters", "reset", "runs", "finite", "repeatable", "stateless", "pointers"];

impl Book {
    fn note(&mut self, rule: &'static str, outcome: Result<String, String>) {
        let (verdict, said) = match outcome {
            Ok(said) => (Verdict::Passed, said),
            Err(said) => (Verdict::Failed, said),
        };
        self.findings.push(Finding { rule, verdict, said });
    }

    fn note_value<T>(&mut self, rule: &'static str, outcome: Result<T, String>) -> Option<T> {
        match outcome {
            Ok(value) => {
                self.note(rule, Ok(String::new()));
                Some(value)
            }
            Err(said) => {
                self.note(rule, Err(said));
                None
            }
        }
    }

    /// Rules that were not come to.
    fn rest(&mut self) {
        for rule in RULES.into_iter().skip(self.findings.len()) {
            self.findings.push(Finding { rule, verdict: Verdict::Skipped, said: String::new() });
        }
    }
}

/// Parameters in SI and the sample time.
fn settings(kind: &Kind, given: &BTreeMap<String, ParamValue>) -> Result<(Vec<f64>, f64), String> {
    let known =
        given.iter().filter(|(name, _)| kind.parameters.iter().any(|known| known.name == name.as_str()));
    let known = known.map(|(name, value)| (name.clone(), value.clone())).collect();
    let params = parameters::numbers(kind, &known).map_err(|error| error.message)?;
    kind.check(&params).map_err(|failure| failure.to_string())?;
    let period = kind.sample_time(&params).map_err(|failure| failure.to_string())?;
    if !(period.is_finite() && period >= 0.0) {
        return Err(format!("it asks for a sample time of {period} s"));
    }
    if period > 0.0 && !kind.continuous.is_empty() {
        return Err("it has a sample time and continuous states".to_owned());
    }
    Ok((params, period))
}

type Start = (Vec<f64>, Vec<f64>);

/// States at the start.
fn start(kind: &Kind, params: &[f64]) -> Result<Start, String> {
    let defaults = |list: &[crate::kind::Quantity]| -> Vec<f64> {
        list.iter().flat_map(|q| q.default.map_or_else(|| vec![0.0; q.length], <[f64]>::to_vec)).collect()
    };
    let (mut x, mut xd) = (defaults(&kind.continuous), defaults(&kind.discrete));
    kind.reset(params, &mut x, &mut xd).map_err(|failure| failure.to_string())?;
    if all_finite(&x) && all_finite(&xd) {
        Ok((x, xd))
    } else {
        Err("a state is not finite at the start".to_owned())
    }
}

/// Inputs at a step: swings and steps of ordinary size, the same for the same seed.
fn inputs(step: usize, seed: u64, u: &mut [f64]) {
    for (i, u) in u.iter_mut().enumerate() {
        let mixed = (seed ^ ((i as u64 + 1) << 32) ^ (step as u64 / 50)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let level = (mixed >> 40) as f64 / (1_u64 << 23) as f64 - 1.0;
        *u = level + 0.3 * (0.05 * step as f64 + i as f64).sin();
    }
}

/// Calls a controller through all steps; backwards, with the states of the start and its outputs alone.
fn trace(
    kind: &Kind,
    params: &[f64],
    period: f64,
    begin: &Start,
    seed: u64,
    is_backwards: bool,
) -> Result<Trace, String> {
    let (mut x, mut xd) = begin.clone();
    let (mut u, mut y, mut dx) = (vec![0.0; kind.sizes.u], vec![0.0; kind.sizes.y], vec![0.0; x.len()]);
    let mut bits = Vec::new();
    let mut times = (0.0, 0.0_f64);
    for step in 0..STEPS {
        let step = if is_backwards { STEPS - 1 - step } else { step };
        let t = step as f64 * if period > 0.0 { period } else { STEP };
        inputs(step, seed, &mut u);
        let failed = |failure: crate::call::Failure| format!("{failure} at t = {t} s");
        let mut spent = 0.0;
        kind.outputs(None, &At { params, t, x: &x, xd: &xd, u: &u }, &mut y).map_err(failed)?;
        spent += isolate::last_duration();
        bits.extend(y.iter().map(|y| y.to_bits()));
        if is_backwards {
            continue;
        }
        if period > 0.0 {
            let mut next = xd.clone();
            kind.update(None, &At { params, t, x: &x, xd: &xd, u: &u }, &mut next).map_err(failed)?;
            spent += isolate::last_duration();
            xd = next;
        } else if !x.is_empty() {
            kind.derivatives(None, &At { params, t, x: &x, xd: &xd, u: &u }, &mut dx).map_err(failed)?;
            spent += isolate::last_duration();
            x.iter_mut().zip(&dx).for_each(|(x, dx)| *x += STEP * dx);
        }
        bits.extend(x.iter().chain(&xd).map(|x| x.to_bits()));
        times = (times.0 + spent / STEPS as f64, times.1.max(spent));
        if !y.iter().chain(&x).chain(&xd).all(|number| number.is_finite()) {
            // What follows says nothing.
            break;
        }
    }
    Ok(Trace { bits, times })
}

/// Outputs with the states of the start, in the order of time and against it: they depend on the arguments alone.
fn trace_back(kind: &Kind, params: &[f64], period: f64, begin: &Start) -> Result<String, String> {
    let back = trace(kind, params, period, begin, 1, true)?;
    let again = trace(kind, params, period, begin, 1, true)?;
    equal(&back, &again, "calls against the order of time")
}

fn finite(trace: &Trace) -> Result<String, String> {
    match trace.bits.iter().position(|bits| !f64::from_bits(*bits).is_finite()) {
        None => Ok(String::new()),
        Some(at) => Err(format!("finite inputs of ordinary size give {}", f64::from_bits(trace.bits[at]))),
    }
}

fn equal(first: &Trace, second: &Trace, what: &str) -> Result<String, String> {
    if first.bits == second.bits {
        return Ok(String::new());
    }
    let differ = first.bits.iter().zip(&second.bits).position(|(a, b)| a != b);
    let (a, b) = differ
        .map_or((f64::NAN, f64::NAN), |at| (f64::from_bits(first.bits[at]), f64::from_bits(second.bits[at])));
    Err(format!("other results ({a} and {b}) with {what}"))
}

fn bits(numbers: &[f64]) -> impl Iterator<Item = u64> + '_ {
    numbers.iter().map(|number| number.to_bits())
}
