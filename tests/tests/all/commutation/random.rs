//! Random circuits of sources, coils, capacitors, diodes and switches.

use super::reference::{Branch, Kind, diagram};
use super::{METHODS, difference, slow, try_run, violation};

/// Numbers from a seed (the generator SplitMix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Evenly spread over the orders of magnitude.
    fn between(&mut self, least: f64, most: f64) -> f64 {
        least * (most / least).powf(self.share())
    }
}

/// A connected circuit in which every node has a way to ground that is no valve.
pub fn circuit(seed: u64) -> (usize, Vec<Branch>) {
    use Kind::*;
    let mut r = Numbers(seed);
    let nodes = 3 + r.below(4);
    let mut branches = Vec::new();
    let mut add = |p, n, kind| branches.push(Branch { p, n, kind });
    for k in 0..1 + r.below(2) {
        let node = 1 + k * r.below(nodes);
        let series = r.between(0.05, 2.0);
        let amplitude = r.between(10.0, 300.0);
        match r.below(3) {
            0 => add(node, 0, Battery(amplitude, series)),
            _ => add(node, 0, Sine(amplitude, [50.0, 100.0, 400.0][r.below(3)], 6.0 * r.share(), series)),
        }
    }
    for node in 2..=nodes {
        let other = r.below(node);
        match r.below(4) {
            0 => add(node, other, Coil(r.between(1e-3, 2e-2))),
            1 => add(other, node, Coil(r.between(1e-3, 2e-2))),
            _ => add(node, other, Resistor(r.between(0.5, 200.0))),
        }
        if r.below(3) > 0 {
            add(node, 0, Resistor(r.between(5.0, 500.0)));
        } else {
            add(node, 0, Capacitor(r.between(2e-5, 1e-3), 0.0));
        }
    }
    add(1, 0, Resistor(r.between(5.0, 500.0)));
    for _ in 0..2 + r.below(4) {
        let p = r.below(nodes + 1);
        let n = (p + 1 + r.below(nodes)) % (nodes + 1);
        let v_f = [0.0, 0.6, 0.8][r.below(3)];
        add(p, n, Diode(v_f, r.between(0.02, 0.1), [0.0, 1e-4, 1e-3][r.below(3)]));
    }
    for _ in 0..r.below(2) {
        let p = r.below(nodes + 1);
        let n = (p + 1 + r.below(nodes)) % (nodes + 1);
        add(
            p,
            n,
            Switch([1e-3, 2e-3, 5e-3][r.below(3)], 0.5, r.between(0.02, 0.5), [1e-3, 1e-4][r.below(2)]),
        );
    }
    (nodes, branches)
}

const STOP: f64 = 0.04;
const EVERY: f64 = 2e-4;
const STEP: f64 = 4e-6;

/// What is wrong with a circuit by one method, if anything.
fn fault(nodes: usize, branches: &[Branch], reference: &[Vec<f64>], solver: &str) -> Option<String> {
    let run = match try_run(&diagram(nodes, branches, STOP, EVERY, solver)) {
        Ok(run) => run,
        Err(error) => return Some(error),
    };
    let wrong = violation(&run, branches);
    // What the solver is allowed.
    if wrong > 1e-4 {
        return Some(format!("a valve is wrong by {wrong:e}"));
    }
    let (off, at) = difference(&run, branches, reference, EVERY);
    (off > 1e-2).then(|| format!("off by {off:e}, {at}"))
}

/// The same with capacitors between any nodes, which close loops with the others.
fn circuit_with_loops(seed: u64) -> (usize, Vec<Branch>) {
    let (nodes, mut branches) = circuit(seed);
    let mut r = Numbers(seed ^ 0x5eed);
    for _ in 0..2 + r.below(3) {
        let p = r.below(nodes + 1);
        let n = (p + 1 + r.below(nodes)) % (nodes + 1);
        branches.push(Branch { p, n, kind: Kind::Capacitor(r.between(2e-6, 1e-3), 0.0) });
    }
    (nodes, branches)
}

fn check(seeds: std::ops::Range<u64>, circuit: impl Fn(u64) -> (usize, Vec<Branch>)) {
    let mut faults = Vec::new();
    for seed in seeds {
        let (nodes, branches) = circuit(seed);
        let mut reference = slow(nodes, &branches, STEP, STOP, EVERY);
        let mut fine = false;
        for solver in METHODS {
            let mut found = fault(nodes, &branches, &reference, solver);
            if found.is_some() && !fine {
                // The reference may be too coarse.
                reference = slow(nodes, &branches, STEP / 8.0, STOP, EVERY);
                fine = true;
                found = fault(nodes, &branches, &reference, solver);
            }
            faults.extend(found.map(|fault| format!("seed {seed}, {solver}: {fault}")));
        }
    }
    assert!(faults.is_empty(), "{} wrong:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn random_circuits_agree_with_the_reference() {
    check(0..12, circuit);
}

#[test]
fn random_circuits_with_loops_of_capacitors_agree_with_the_reference() {
    check(0..12, circuit_with_loops);
}

/// `BLOCKSIM_SEEDS=0..2000 cargo test -p blocksim-tests --test all many -- --ignored`
#[test]
#[ignore = "long"]
fn many_random_circuits_agree_with_the_reference() {
    let range = std::env::var("BLOCKSIM_SEEDS").unwrap_or_else(|_| "0..300".to_owned());
    let (from, to) = range.split_once("..").expect("FROM..TO");
    let range = from.parse().expect("a number")..to.parse().expect("a number");
    check(range.clone(), circuit);
    check(range, circuit_with_loops);
}
