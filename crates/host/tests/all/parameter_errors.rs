//! What users read when a plug-in does not take a block or its parameters. Each text stands here as it is shown.

use std::collections::BTreeMap;

use crate::common::{bare, built, compile, fresh, here, refused, set, with_unit};
use blocksim_block::ParamValue;
use blocksim_signal::Value;
use expect_test::{Expect, expect};

fn list(values: &[f64]) -> ParamValue {
    ParamValue(Value::List(values.iter().map(|value| (*value).into()).collect()))
}

#[test]
fn blocks_and_parameters_that_the_plugin_does_not_have() {
    let (cascade, here) = (built("blocksim_plugin_cascade"), here());
    let check = |block: &str, parameters: BTreeMap<String, ParamValue>, expected: Expect| {
        refused(&here, &cascade, block, parameters, expected);
    };
    let w1 = || ("w1", bare(4.0));
    check(
        "Cascda",
        set([]),
        expect![[r#"
            [plugin_parameter] block: the plug-in `cascade` has no block `Cascda`
            help: did you mean `Cascade`? Its blocks are: `Cascade`
        "#]],
    );
    check(
        "Pid",
        set([]),
        expect![[r#"
            [plugin_parameter] block: the plug-in `cascade` has no block `Pid`
            help: its blocks are: `Cascade`
        "#]],
    );
    check(
        "Cascade",
        set([w1(), ("slip_limt", bare(0.1))]),
        expect![[r#"
            [plugin_parameter] parameters: `Cascade` has no parameter `slip_limt`
            help: did you mean `slip_limit`? Its parameters are: `kv`, `kp`, `ki`, `kd`, `w1`, `slip_limit`, `ts`, `u_start`
        "#]],
    );
    check(
        "Cascade",
        set([w1(), ("temperature", bare(0.1))]),
        expect![[r#"
            [plugin_parameter] parameters: `Cascade` has no parameter `temperature`
            help: its parameters are: `kv`, `kp`, `ki`, `kd`, `w1`, `slip_limit`, `ts`, `u_start`
        "#]],
    );
    check(
        "Cascade",
        set([("kp", bare(1.0))]),
        expect![[r#"
        [plugin_parameter] parameters: `Cascade` needs the parameter `w1`
        help: give a number in rad/s: Joint speed at u = 1.
    "#]],
    );
    check(
        "Cascade",
        set([w1(), ("kp", ParamValue(Value::Text("40".into())))]),
        expect![[r#"
        [plugin_parameter] parameters: `kp` is a text, but must be a number
        help: write the number itself, or an expression such as "20 1/s"
    "#]],
    );
    check(
        "Cascade",
        set([w1(), ("kp", ParamValue(Value::Bool(true)))]),
        expect![[r#"
        [plugin_parameter] parameters: `kp` is true or false, but must be a number
    "#]],
    );
    check(
        "Cascade",
        set([w1(), ("kp", list(&[1.0]))]),
        expect![[r#"
        [plugin_parameter] parameters: `kp` is a list of 1, but must be a number
    "#]],
    );
    check(
        "Cascade",
        set([w1(), ("kv", with_unit(20.0, "m/s"))]),
        expect![[r#"
        [plugin_parameter] parameters: `kv` is 20 m/s, but must be in 1/s
        help: a number without a unit is taken to be in 1/s
    "#]],
    );
    check(
        "Cascade",
        set([w1(), ("kp", with_unit(20.0, "N*m"))]),
        expect![[r#"
            [plugin_parameter] parameters: `kp` is 20 N*m, but must be a number without unit
        "#]],
    );
    check(
        "Cascade",
        set([("w1", with_unit(2.0, "Hz"))]),
        expect![[r#"
        [plugin_parameter] parameters: `w1` is 2 Hz, but must be in rad/s
        help: a number without a unit is taken to be in rad/s
    "#]],
    );
    check(
        "Cascade",
        set([("w1", bare(0.0))]),
        expect![[r#"
        [plugin_parameter] parameters: `w1` is 0 rad/s, it must be positive
    "#]],
    );
}

#[test]
fn what_the_plugin_itself_refuses() {
    let folder = fresh("refused");
    compile(&folder, "libprobe.so", "probe.c", &[]);
    let check = |block: &str, parameters: BTreeMap<String, ParamValue>, expected: Expect| {
        refused(&folder, "libprobe.so", block, parameters, expected);
    };
    check(
        "Oscillator",
        set([]),
        expect![[r#"
            [plugin_parameter] parameters: `Oscillator` needs the parameter `x0`
            help: give a list of 2 numbers in m
        "#]],
    );
    check(
        "Oscillator",
        set([("x0", bare(1.0))]),
        expect![[r#"
        [plugin_parameter] parameters: `x0` is a number, but must be a list of 2 numbers
    "#]],
    );
    check(
        "Oscillator",
        set([("x0", list(&[1.0, 2.0, 3.0]))]),
        expect![[r#"
        [plugin_parameter] parameters: `x0` is a list of 3, but must be a list of 2 numbers
    "#]],
    );
    let mixed = Value::List(vec![1.0.into(), with_unit(1.0, "s").0]);
    check(
        "Oscillator",
        set([("x0", ParamValue(mixed))]),
        expect![[r#"
        [plugin_parameter] parameters: `x0[1]` is 1 s, but must be in m
        help: a number without a unit is taken to be in m
    "#]],
    );
    check(
        "Faulty",
        set([("how", bare(8.0))]),
        expect![[r#"
        [plugin_parameter] parameters: `how` is 8, which nobody wants
    "#]],
    );
    check(
        "Faulty",
        set([("how", bare(9.0))]),
        expect![[r#"
        [plugin_panic] parameters: the plug-in panicked: index 3 of 2
        help: this is a mistake in the plug-in; parameters that make no sense are to be refused by its `check`
    "#]],
    );
    check(
        "Faulty",
        set([("how", bare(10.0))]),
        expect![[r#"
        [plugin_parameter] parameters: `Faulty` asks for a sample time of -1 s, but it must be positive, or 0 for continuous
    "#]],
    );
    check(
        "Hybrid",
        set([("x0", list(&[1.0, 0.0]))]),
        expect![[r#"
        [plugin_abi] block: `Hybrid` asks for a sample time of 0.1 s, but has continuous states; a block has one or the other
    "#]],
    );
}
