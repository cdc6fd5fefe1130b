//! Descriptions of the kinds that build hierarchy.

use blocksim_block::{BlockInfo, ParameterInfo, Symbol};

const SUBSYSTEM: &str = r#"Puts one diagram into another.

```ron
Subsystem(file: "joint.ron", with: { "axis": "robot.axis1" })
```

With `enable`, `trigger` or `reset` the subsystem is **conditional** and has an input of that name. While it does not run,

* continuous states stand still, and sample hits, triggers, resets and events inside do not count;
* outputs hold what they gave last, exactly at the time at which it was disabled; those of `when_disabled` give the values written there;
* before it has run for the first time, an output that shows states alone gives what these are at the start, and every other one 0.

Time itself goes on: a `Sine` inside gives what it would give without the condition. The times of enabling and disabling, of triggers and
of resets are located as those of all events, and a sample hit at the time of enabling counts, one at the time of disabling does not.
What changes while the subsystem around is disabled is seen when that runs again. Subsystems within subsystems run only
while those around them do.

With `trigger`, sampled blocks inside are updated at each trigger, whatever their sample times are; these still are the times that
DiscreteIntegrator and others calculate with. Blocks with continuous states are refused there.

A reset, or `enable: Reset`, sets continuous and discrete states; what a sampled block makes of it is seen at its next sample hit.

Blocks of physical networks, and blocks that remember a signal over time such as TransportDelay, cannot be inside.

```ron
Subsystem(file: "speed_loop.ron", enable: Reset, when_disabled: { "torque": "0 N*m" })
```"#;

/// Kinds that build hierarchy; they are no blocks of the library.
pub const HIERARCHY: [BlockInfo; 2] = [
    BlockInfo {
        kind: "Subsystem",
        category: "Hierarchy",
        symbol: Symbol::Plain,
        doc: SUBSYSTEM,
        parameters: &[
            ParameterInfo {
                name: "file",
                rust_type: "String",
                unit: "",
                default: None,
                doc: "The diagram, relative to the file that names it.",
                ..ParameterInfo::NONE
            },
            ParameterInfo {
                name: "with",
                rust_type: "set",
                unit: "",
                default: Some("{}"),
                doc: "Values for the parameters of the diagram: numbers, texts, lists, sets.",
                ..ParameterInfo::NONE
            },
            ParameterInfo {
                name: "enable",
                rust_type: "WhenEnabled",
                unit: "",
                default: Some("always enabled"),
                doc: "Adds the input `enable`, Bool or Real: the subsystem runs while it is true, or positive. `Held`: its states go on from where they were when it is enabled again. `Reset`: they begin anew.",
                ..ParameterInfo::NONE
            },
            ParameterInfo {
                name: "trigger",
                rust_type: "Crossing",
                unit: "",
                default: Some("no trigger"),
                doc: "Adds the input `trigger`, Bool or Real: the subsystem runs at the instants alone at which it becomes true or rises through zero (`Rising`), becomes false or falls through zero (`Falling`), or either (`Either`).",
                ..ParameterInfo::NONE
            },
            ParameterInfo {
                name: "reset",
                rust_type: "Crossing",
                unit: "",
                default: Some("no reset"),
                doc: "Adds the input `reset`, Bool or Real: all states inside take their initial values when it becomes true (`Rising`), false (`Falling`), or either (`Either`).",
                ..ParameterInfo::NONE
            },
            ParameterInfo {
                name: "when_disabled",
                rust_type: "set",
                unit: "",
                default: Some("{}"),
                doc: "Values of outputs while the subsystem is disabled, by their names; the other outputs hold what they gave last.",
                ..ParameterInfo::NONE
            },
        ],
        file: file!(),
        line: line!(),
    },
    BlockInfo {
        kind: "Variant",
        category: "Hierarchy",
        symbol: Symbol::Plain,
        doc: "Holds alternatives with the same ports; a parameter chooses which one is built.\n\n```ron\nVariant(choice: \"drive\", of: { \"asm\": Subsystem(file: \"asm.ron\"), \"dc\": Subsystem(file: \"dc.ron\") })\n```",
        parameters: &[
            ParameterInfo {
                name: "choice",
                rust_type: "expression",
                unit: "",
                default: None,
                doc: "The parameter that names the alternative.",
                ..ParameterInfo::NONE
            },
            ParameterInfo {
                name: "of",
                rust_type: "set",
                unit: "",
                default: None,
                doc: "The alternatives: blocks, usually subsystems.",
                ..ParameterInfo::NONE
            },
        ],
        file: file!(),
        line: line!(),
    },
];
