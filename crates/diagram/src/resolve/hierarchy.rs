//! Descriptions of the kinds that build hierarchy.

use blocksim_block::{BlockInfo, ParameterInfo, Symbol};

/// Kinds that build hierarchy; they are no blocks of the library.
pub const HIERARCHY: [BlockInfo; 2] = [
    BlockInfo {
        kind: "Subsystem",
        category: "Hierarchy",
        symbol: Symbol::Plain,
        doc: "Puts one diagram into another.\n\n```ron\nSubsystem(file: \"joint.ron\", with: { \"axis\": \"robot.axis1\" })\n```",
        parameters: &[
            ParameterInfo {
                name: "file",
                rust_type: "String",
                unit: "",
                default: None,
                doc: "The diagram, relative to the file that names it.",
            },
            ParameterInfo {
                name: "with",
                rust_type: "set",
                unit: "",
                default: Some("{}"),
                doc: "Values for the parameters of the diagram: numbers, texts, lists, sets.",
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
            },
            ParameterInfo {
                name: "of",
                rust_type: "set",
                unit: "",
                default: None,
                doc: "The alternatives: blocks, usually subsystems.",
            },
        ],
        file: file!(),
        line: line!(),
    },
];
