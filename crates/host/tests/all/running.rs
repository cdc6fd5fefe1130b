//! Blocks of a plug-in in C while they run.

use crate::common::{Folder, What, bare, compile, failure, fresh, load, set, with_unit};
use blocksim_block::testing::Bench;
use blocksim_block::{Block, Context, Fault, ParamValue, PortType, Scratch};
use blocksim_host::Plugin;
use blocksim_signal::{Unit, Value};
use expect_test::{Expect, expect};

fn probe(test: &str) -> Folder {
    let folder = fresh(test);
    compile(&folder, "libprobe.so", "probe.c", &[]);
    folder
}

#[test]
fn a_continuous_block_is_integrated() {
    let folder = probe("continuous");
    let x0 = ParamValue(Value::List(vec![0.5.into(), 0.0.into()]));
    let parameters = set([("x0", x0), ("w", with_unit(2.0, "rad/s"))]);
    let mut bench = Bench::new(load(&folder, "libprobe.so", "Oscillator", parameters).unwrap());
    assert_eq!(bench.x, [0.5, 0.0], "`reset` sets the start from the parameters");
    let x = bench.integrate(1.0, 1000).major();
    // Closed form x = x0 cos wt; classical Runge-Kutta with w h = 0.002 errs by about 1e-13.
    assert!((x[0] - 0.5 * 2.0_f64.cos()).abs() < 1e-12 && (x[1] + 2.0_f64.sin()).abs() < 1e-12, "{x:?}");
}

#[test]
fn a_sampled_block_counts_its_hits_and_takes_vectors() {
    let folder = probe("sampled");
    let block = load(&folder, "libprobe.so", "Groups", set([])).unwrap();
    let volt = PortType::scalar().of(Some(Unit::parse("V").unwrap().dimension));
    let given = vec![("a".to_owned(), volt), ("b".to_owned(), PortType::vector(2))];
    let mut bench = Bench::with_inputs(block, given);
    assert_eq!(bench.set(0, &[1.5]).hit(), [3.0, 3.0, 3.0, 0.0], "`b` has its default");
    assert_eq!(bench.set(1, &[7.0, 8.0]).hit(), [3.0, 7.0, 8.0, 1.0]);
    assert_eq!(bench.d, [2.0]);
}

/// Evaluates one group of `Groups` with these inputs; outputs begin as -1.
fn group(block: &Plugin, group: usize, u: [f64; 3]) -> (Vec<f64>, Option<String>) {
    let (fault, mut y) = (Fault::default(), vec![-1.0; 4]);
    let (inputs, outputs) = ([(0, 1), (1, 3)], [(0, 1), (1, 3), (3, 4)]);
    let c = Context {
        t: 0.0,
        x: &[],
        d: &[4.0],
        u: &u,
        inputs: &inputs,
        outputs: &outputs,
        evaluation: 1,
        resolution: blocksim_block::Resolution::default(),
        seed: 0,
        fault: &fault,
    };
    block.outputs(group, &c, &mut Scratch::default(), &mut y);
    (y, fault.take())
}

#[test]
fn a_group_writes_its_own_outputs_and_ignores_inputs_that_it_does_not_read() {
    let folder = probe("groups");
    let block = load(&folder, "libprobe.so", "Groups", set([])).unwrap();
    let stale = f64::NAN;
    assert_eq!(group(&block, 0, [1.0, stale, stale]), (vec![2.0, -1.0, -1.0, -1.0], None));
    assert_eq!(group(&block, 1, [stale, 5.0, 6.0]), (vec![-1.0, 5.0, 6.0, -1.0], None));
    assert_eq!(group(&block, 2, [stale; 3]), (vec![-1.0, -1.0, -1.0, 4.0], None));
    let (_, reason) = group(&block, 1, [1.0, 5.0, stale]);
    expect!["the plug-in `libprobe.so`: output `same[1]` is NaN; inputs: a = 1 V, b = [5, NaN]"]
        .assert_eq(&reason.unwrap());
}

#[test]
fn every_failure_of_a_run_is_a_sentence() {
    let folder = probe("failures");
    let say = |how: f64, what: What, expected: Expect| {
        let block = load(&folder, "libprobe.so", "Faulty", set([("how", bare(how))])).unwrap();
        let mut d = [1.0, 2.0];
        let reason = failure(&block, &[0.25, 1.0, -3.5], &mut d, what);
        expected.assert_eq(reason.as_deref().unwrap_or("-"));
        d
    };
    say(0.0, What::Outputs, expect!["-"]);
    say(1.0, What::Outputs, expect!["the plug-in `libprobe.so`: the winding is too hot"]);
    say(2.0, What::Outputs, expect!["the plug-in `libprobe.so` failed and gave no reason"]);
    say(3.0, What::Outputs, expect!["the plug-in `libprobe.so` panicked: attempt to divide by zero"]);
    say(4.0, What::Outputs, expect!["the plug-in `libprobe.so` reported the unknown status 77"]);
    say(
        5.0,
        What::Outputs,
        expect!["the plug-in `libprobe.so`: output `y` is NaN; inputs: speed = 0.25 rad/s, v = [1, -3.5]"],
    );
    say(11.0, What::Start, expect!["the plug-in `libprobe.so`: no start"]);
    assert_eq!(say(0.0, What::Update, expect!["-"]), [5.0, 2.0]);
    assert_eq!(
        say(
            6.0,
            What::Update,
            expect![
                "the plug-in `libprobe.so`: the next value of state `s[1]` is inf; inputs: speed = 0.25 rad/s, v = [1, -3.5]"
            ]
        ),
        [1.0, 2.0],
        "a failed update changes nothing"
    );
    assert_eq!(
        say(7.0, What::Update, expect!["the plug-in `libprobe.so`: no next state"]),
        [1.0, 2.0],
        "a failed update changes nothing"
    );
}

#[test]
fn a_block_that_was_not_loaded_says_so() {
    let plugin = Plugin::new("libprobe.so", "Groups", set([]));
    assert!(plugin.interface(&blocksim_block::Given::nothing()).is_err());
    assert!(plugin.kind().is_none());
    let (y, reason) = group(&plugin, 0, [1.0; 3]);
    assert_eq!((y, reason.as_deref()), (vec![-1.0; 4], Some("the plug-in `libprobe.so` was never loaded")));
}
