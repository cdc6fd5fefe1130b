//! What inverse kinematics of a six-axis arm cost.
//!
//! `cargo bench -p blocksim-kinematics`; read the column "fastest". Goal of the closed form: 2 us for all solutions; of the
//! general solver: a median of 100 us.

#[allow(dead_code, reason = "the tests use more of the arms")]
#[path = "../tests/all/inverse/arms.rs"]
mod arms;

use blocksim_multibody::{Frame, Placement};
use blocksim_robotics::kinematics::{ClosedForm, Constraint, Options, Solver};
use divan::{AllocProfiler, Bencher, black_box};

/// Adds rows of allocation counts to the table where there are any.
#[global_allocator]
static ALLOCATIONS: AllocProfiler = AllocProfiler::system();

fn main() {
    divan::main();
}

fn closed_form() -> (ClosedForm, Vec<Placement>) {
    let (model, last) = arms::irb2600().expect("the arm is sound");
    let arm = ClosedForm::of(&model, &arms::flange(last).at(arms::torch())).expect("the arm is of the class");
    let (mut random, ranges) = (arms::Random(1), arms::ranges());
    let targets = (0..1000).map(|_| arm.forward(&random.pose(&ranges))).collect();
    (arm, targets)
}

#[divan::bench]
fn all_solutions(bencher: Bencher) {
    let (arm, targets) = closed_form();
    let mut next = targets.iter().cycle();
    bencher.bench_local(|| arm.inverse(black_box(next.next().expect("targets")), &[0.0; 6]));
}

#[divan::bench]
fn nearest_solution(bencher: Bencher) {
    let (arm, targets) = closed_form();
    let (mut next, ranges) = (targets.iter().cycle(), arms::ranges());
    bencher.bench_local(|| arm.nearest(black_box(next.next().expect("targets")), &[0.0; 6], &ranges));
}

/// From a random position to a random reachable pose, with restarts.
#[divan::bench(sample_count = 1000)]
fn general_solver(bencher: Bencher) {
    let (model, last) = arms::irb2600().expect("the arm is sound");
    let (arm, ranges) = (closed_form().0, arms::ranges());
    let tool = arms::flange(last).at(arms::torch());
    let mut random = arms::Random(1);
    let mut solver = Solver::new(&model, &ranges).expect("the ranges are sound");
    bencher
        .with_inputs(|| {
            let target = arm.forward(&random.pose(&ranges));
            ([Constraint::pose(tool, Frame::ground(), target)], random.pose(&ranges))
        })
        .bench_local_values(|(wish, seed)| solver.solve(&wish, &seed, &Options::default()));
}
