//! The text of a diagram while it is written.

use super::variants::Variant;

/// Blocks and connections, one a line.
#[derive(Debug, Default)]
pub(super) struct Sheet {
    blocks: Vec<String>,
    wires: Vec<String>,
}

impl Sheet {
    /// A block by its name, its kind and parameters.
    pub fn block(&mut self, name: &str, text: &str) {
        self.blocks.push(format!("        \"{name}\": {text},\n"));
    }

    /// A connection of any kind.
    pub fn wire(&mut self, wire: &str) {
        self.wires.push(format!("        \"{wire}\",\n"));
    }

    /// A signal from an output to an input.
    pub fn signal(&mut self, from: &str, to: &str) {
        self.wire(&format!("{from} -> {to}"));
    }

    /// A block behind a signal; returns its output.
    pub fn behind(&mut self, from: &str, name: &str, text: &str) -> String {
        self.block(name, text);
        self.signal(from, &format!("{name}.u"));
        format!("{name}.y")
    }

    /// A sum of two signals; returns its output.
    pub fn sum(&mut self, name: &str, signs: &str, from: [&str; 2]) -> String {
        self.block(name, &format!("Sum(signs: \"{signs}\")"));
        from.iter().zip(["u1", "u2"]).for_each(|(from, port)| self.signal(from, &format!("{name}.{port}")));
        format!("{name}.y")
    }

    /// A scope over outputs, each with the name of its input.
    pub fn scope(&mut self, name: &str, outputs: &[(String, String)]) {
        let inputs: Vec<String> = outputs.iter().map(|(input, _)| format!("\"{input}\"")).collect();
        self.block(name, &format!("Scope(inputs: [{}])", inputs.join(", ")));
        outputs.iter().for_each(|(input, from)| self.signal(from, &format!("{name}.{input}")));
    }

    /// The diagram of a run to `stop`, put as the variant says.
    pub fn finish(mut self, stop: f64, variant: &Variant) -> String {
        if variant.bystander {
            self.block("bystander_source", "Sine(frequency: \"0.37 Hz\")");
            let through = self.behind("bystander_source.y", "bystander", "LowPass(tau: \"0.3 s\")");
            self.block("bystander_end", "Terminator");
            self.signal(&through, "bystander_end.u");
        }
        if variant.reversed {
            self.blocks.reverse();
            self.wires.reverse();
        }
        format!(
            "Diagram(\n    simulation: (stop_time: \"{stop:?} s\"{}),\n    blocks: {{\n{}    }},\n    connections: [\n{}    ],\n)\n",
            variant.settings,
            self.blocks.concat(),
            self.wires.concat()
        )
    }
}
