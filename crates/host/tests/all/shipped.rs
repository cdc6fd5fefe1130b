//! The plug-ins of the repository: built in, loaded from their folder, and loaded from a built library.

use crate::common::{bare, built, here, load, set, with_unit};
use blocksim_block::testing::Bench;
use blocksim_block::{Block, Draft, Given, Interface};
use blocksim_controller::testing::Bench as BuiltIn;
use blocksim_host::{Target, open};
use expect_test::expect;

fn signal(k: usize, inputs: usize) -> Vec<f64> {
    (0..inputs).map(|i| (0.05 * k as f64 * (1.0 + 0.3 * i as f64)).sin() * 2.0).collect()
}

/// Bits of outputs and states of 300 samples with inputs that reach all limits.
pub fn bits_of_block(block: impl Block, inputs: usize, ts: f64) -> Vec<u64> {
    let mut bench = Bench::of(block);
    let mut bits = Vec::new();
    for k in 0..300 {
        bench.t = ts * k as f64;
        signal(k, inputs).iter().enumerate().for_each(|(port, u)| {
            bench.set(port, &[*u]);
        });
        bits.extend(bench.hit().iter().map(|y| y.to_bits()));
        bits.extend(bench.d.iter().map(|d| d.to_bits()));
    }
    bits
}

pub fn bits_built_in(mut bench: BuiltIn, inputs: usize, ts: f64) -> Vec<u64> {
    let mut bits = Vec::new();
    for k in 0..300 {
        let y = bench.sample(ts * k as f64, &signal(k, inputs)).unwrap();
        bits.extend(y.iter().map(|y| y.to_bits()));
        bits.extend(bench.discrete().iter().map(|d| d.to_bits()));
    }
    bits
}

#[test]
fn cascade_gives_the_same_bits_built_in_and_loaded() {
    let parameters = || {
        set([
            ("w1", with_unit(4.0, "rad/s")),
            ("kd", bare(0.005)),
            ("slip_limit", with_unit(12.0, "%")),
            ("ts", with_unit(2.0, "ms")),
            ("u_start", bare(0.2)),
        ])
    };
    let numbers = [("w1", 4.0), ("kd", 0.005), ("slip_limit", 0.12), ("ts", 0.002), ("u_start", 0.2)];
    let table = blocksim_plugin_cascade::table();
    let expected = bits_built_in(BuiltIn::new(table, "Cascade", &numbers).unwrap(), 6, 0.002);
    for library in ["../../plugins/cascade", &built("blocksim_plugin_cascade")] {
        let block = load(&here(), library, "Cascade", parameters()).unwrap();
        assert!(bits_of_block(block, 6, 0.002) == expected, "{library}");
    }
}

#[test]
fn pid_gives_the_same_bits_built_in_and_loaded() {
    let numbers = [("kp", 2.0), ("ki", 30.0), ("kd", 0.05), ("n", 50.0), ("ts", 1e-3), ("theta", 0.5)];
    let limits = [("lower", -3.0), ("upper", 3.0), ("i0", 0.1)];
    let all: Vec<_> = numbers.into_iter().chain(limits).collect();
    let expected = bits_built_in(BuiltIn::new(blocksim_plugin_pid::table(), "Pid", &all).unwrap(), 1, 1e-3);
    for library in ["../../plugins/pid", &built("blocksim_plugin_pid")] {
        let parameters = all.iter().map(|(name, value)| (name.to_string(), bare(*value))).collect();
        let block = load(&here(), library, "Pid", parameters).unwrap();
        assert!(bits_of_block(block, 1, 1e-3) == expected, "{library}");
    }
}

/// Ports, states and sample time as text.
fn described(interface: &Interface) -> String {
    let mut text = String::new();
    let unit = |dimension: Option<blocksim_signal::Dimension>| {
        dimension.map_or("any unit".to_owned(), |dimension| dimension.to_string())
    };
    for input in &interface.inputs {
        let shape = input.shape.unwrap();
        let default = input.default.map_or(String::new(), |value| format!(", default {value}"));
        text += &format!("in {}: {shape}, {}{default}: {}\n", input.name, unit(input.dimension), input.doc);
    }
    for (output, group) in interface.outputs.iter().zip(&interface.group_of) {
        let reads = interface.groups[*group].as_ref().unwrap();
        let reads: Vec<_> = reads.iter().map(|&input| interface.inputs[input].name.as_str()).collect();
        let (shape, unit) = (output.port_type.shape, unit(output.port_type.dimension));
        text += &format!("out {}: {shape}, {unit}, reads {}\n", output.name, reads.join(" "));
    }
    interface.states.iter().for_each(|state| text += &format!("x {} = {}\n", state.name, state.initial));
    interface.discrete.iter().for_each(|state| text += &format!("xd {} = {}\n", state.name(), state.initial));
    text + &format!("{:?}, uses time: {}\n", interface.sample_time, interface.uses_time)
}

#[test]
fn the_interface_shows_ports_and_units_of_the_plugin() {
    let library = built("blocksim_plugin_cascade");
    let block = load(&here(), &library, "Cascade", set([("w1", bare(4.0))])).unwrap();
    expect![[r#"
        in q_set: scalar, rad: Set position.
        in qd_set: scalar, rad/s: Set speed.
        in qdd_set: scalar, rad/s^2: Set acceleration.
        in q: scalar, rad: Position.
        in w: scalar, rad/s: Speed.
        in u_ff: scalar, 1, default 0: Part of u that is known beforehand.
        out u: scalar, 1, reads q_set qd_set qdd_set q w u_ff
        xd integral = 0
        xd w_previous = 0
        xd started = 0
        Some(Discrete { period: 0.001, offset: 0.0 }), uses time: false
    "#]]
    .assert_eq(&described(&block.interface(&Given::nothing()).unwrap()));
}

#[test]
fn vectors_groups_and_defaults_reach_the_interface() {
    let folder = crate::common::fresh("interface");
    crate::common::compile(&folder, "libprobe.so", "probe.c", &[]);
    let groups = load(&folder, "libprobe.so", "Groups", set([])).unwrap();
    expect![[r#"
        in a: scalar, V: 
        in b: vector of 2, any unit, default 3: 
        out twice: scalar, V, reads a
        out same: vector of 2, any unit, reads b
        out hits: scalar, 1, reads 
        xd n = 0
        Some(Discrete { period: 0.1, offset: 0.0 }), uses time: false
    "#]]
    .assert_eq(&described(&groups.interface(&Given::nothing()).unwrap()));
    let x0 = blocksim_block::ParamValue(blocksim_signal::Value::List(vec![1.0.into(), 0.0.into()]));
    let oscillator = load(&folder, "libprobe.so", "Oscillator", set([("x0", x0)])).unwrap();
    expect![[r#"
        out x: vector of 2, m, reads 
        x x[0] = 0
        x x[1] = 0
        None, uses time: true
    "#]]
    .assert_eq(&described(&oscillator.interface(&Given::nothing()).unwrap()));
}

#[test]
fn a_diagram_names_a_plugin_by_library_block_and_parameters() {
    let read =
        |text: &str| serde_json::from_str::<Draft>(text).map(|draft| draft.finish(&|_| None).0.unwrap());
    let library = built("blocksim_plugin_cascade");
    let text = format!(
        r#"{{"Plugin": {{"library": {library:?}, "block": "Cascade", "parameters": {{
            "w1": {{"Number": [4.0, []]}}, "kv": {{"Number": [20.0, [0, 0, -1]]}} }} }} }}"#
    );
    let mut block = read(&text).unwrap();
    block.load(&here()).unwrap();
    assert_eq!(block.interface(&Given::nothing()).unwrap().inputs.len(), 6);

    let mut block = read(r#"{"Plugin": {"library": "nowhere", "block": "B"}}"#).unwrap();
    assert_eq!(block.load(&here()).unwrap_err().code, "plugin_missing");
    assert!(read(r#"{"Plugin": {"library": "nowhere", "block": "B", "loaded": null}}"#).is_err());
}

#[test]
fn blocks_that_name_one_library_share_it() {
    let threads: Vec<_> = (0..6)
        .map(|_| {
            std::thread::spawn(|| {
                std::ptr::from_ref(open(&here().0, "../../plugins/cascade", Target::Native).unwrap()).addr()
            })
        })
        .collect();
    let mut addresses: Vec<_> = threads.into_iter().map(|thread| thread.join().unwrap()).collect();
    addresses.dedup();
    assert_eq!(addresses.len(), 1);
    let library = open(&here().0, "../../plugins/cascade/../cascade", Target::Native).unwrap();
    assert_eq!(std::ptr::from_ref(library).addr(), addresses[0], "two ways to one folder");
    assert_eq!((library.name, library.version), ("cascade", env!("CARGO_PKG_VERSION")));
}
