//! What one evaluation of the dynamics of a six-axis arm costs.
//!
//! `cargo bench -p blocksim-multibody`; read the column "fastest". Goals: inverse dynamics 0.8 us, mass
//! matrix with bias and solution 1.0 us, forward dynamics at most 2.5 times inverse dynamics.

#[allow(dead_code, reason = "the tests use more of the arm")]
#[path = "../tests/dynamics/arm.rs"]
mod arm;

use blocksim_multibody::{self as multibody, Data, Model};
use divan::{AllocProfiler, Bencher, black_box};
use nalgebra::{Matrix6, Vector6};
use std::time::{Duration, Instant};

/// Adds rows of allocation counts to the table where there are any: there must be none.
#[global_allocator]
static ALLOCATIONS: AllocProfiler = AllocProfiler::system();

const Q: [f64; 6] = [0.3, -0.4, 0.5, 0.6, -0.7, 0.8];
const V: [f64; 6] = [1.0, -0.9, 0.8, 2.0, -1.5, 3.0];
const A: [f64; 6] = [2.0, 1.0, -3.0, 4.0, 5.0, -6.0];

fn main() {
    print_ratios();
    divan::main();
}

fn torch_arm() -> (Model, Data) {
    let model = arm::with_torch().expect("the arm is sound");
    let data = model.data();
    (model, data)
}

fn inverse(model: &Model, data: &mut Data) -> [f64; 6] {
    let mut tau = [0.0; 6];
    multibody::rnea(model, data, black_box(&Q), black_box(&V), black_box(&A), &mut tau);
    tau
}

/// `(M + armature) a = tau - h` by Cholesky factorisation.
fn forward_by_mass(model: &Model, data: &mut Data) -> Option<Vector6<f64>> {
    let (mut m, mut h) = ([0.0; 36], [0.0; 6]);
    multibody::mass_and_bias(model, data, black_box(&Q), black_box(&V), &mut m, &mut h);
    let mut mass = Matrix6::from_column_slice(&m);
    for i in 0..6 {
        mass[(i, i)] += arm::REFLECTED[i];
    }
    let rest = Vector6::from(*black_box(&A)) - Vector6::from(h);
    Some(mass.cholesky()?.solve(&rest))
}

fn forward_by_bodies(model: &Model, data: &mut Data) -> [f64; 6] {
    let mut a = [0.0; 6];
    multibody::aba(model, data, black_box(&Q), black_box(&V), black_box(&A), &arm::REFLECTED, &mut a);
    a
}

#[divan::bench]
fn rnea(bencher: Bencher) {
    let (model, mut data) = torch_arm();
    bencher.bench_local(|| inverse(&model, &mut data));
}

#[divan::bench]
fn crba(bencher: Bencher) {
    let (model, mut data) = torch_arm();
    bencher.bench_local(|| {
        let mut m = [0.0; 36];
        multibody::crba(&model, &mut data, black_box(&Q), &mut m);
        m
    });
}

#[divan::bench]
fn mass_and_bias(bencher: Bencher) {
    let (model, mut data) = torch_arm();
    bencher.bench_local(|| {
        let (mut m, mut h) = ([0.0; 36], [0.0; 6]);
        multibody::mass_and_bias(&model, &mut data, black_box(&Q), black_box(&V), &mut m, &mut h);
        (m, h)
    });
}

#[divan::bench]
fn mass_and_bias_and_cholesky(bencher: Bencher) {
    let (model, mut data) = torch_arm();
    bencher.bench_local(|| forward_by_mass(&model, &mut data));
}

#[divan::bench]
fn aba(bencher: Bencher) {
    let (model, mut data) = torch_arm();
    bencher.bench_local(|| forward_by_bodies(&model, &mut data));
}

#[divan::bench]
fn forward_kinematics(bencher: Bencher) {
    let (model, mut data) = torch_arm();
    bencher.bench_local(|| multibody::forward_kinematics(&model, &mut data, black_box(&Q)));
}

#[allow(clippy::print_stdout, reason = "a bench reports on standard output")]
fn print_ratios() {
    let (model, mut data) = torch_arm();
    let inverse = fastest(|| {
        black_box(inverse(&model, &mut data));
    });
    let by_mass = fastest(|| {
        black_box(forward_by_mass(&model, &mut data));
    });
    let by_bodies = fastest(|| {
        black_box(forward_by_bodies(&model, &mut data));
    });
    println!("rnea {inverse:.0} ns");
    println!("mass_and_bias + Cholesky {by_mass:.0} ns, {:.2} x rnea", by_mass / inverse);
    println!("aba {by_bodies:.0} ns, {:.2} x rnea", by_bodies / inverse);
}

/// Shortest mean time of a call over batches, ns: other work on the machine only ever adds.
fn fastest(mut call: impl FnMut()) -> f64 {
    const BATCH: u32 = 1000;
    let batch = |_| {
        let start = Instant::now();
        (0..BATCH).for_each(|_| call());
        start.elapsed() / BATCH
    };
    // a duration holds whole nanoseconds, which is fine enough here
    (0..500).map(batch).min().unwrap_or(Duration::ZERO).as_nanos() as f64
}
