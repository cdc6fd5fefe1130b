//! The same model put differently, which must not change what comes out.

/// How a model is put.
#[derive(Debug, Clone, PartialEq)]
pub struct Variant {
    /// What it is called.
    pub name: &'static str,
    /// The method with its tolerances; the default without.
    pub solver: Option<&'static str>,
    /// Spacing of the rows; all steps without.
    pub every: Option<&'static str>,
    /// Blocks and connections in reverse order, with names that sort the other way.
    pub reversed: bool,
    /// A low-pass of a sine beside the model.
    pub bystander: bool,
}

/// As a user puts it who says nothing.
pub const DEFAULT: Variant =
    Variant { name: "default", solver: None, every: None, reversed: false, bystander: false };

/// Steps so short that nothing is passed over.
pub const FINE: Variant =
    Variant { name: "fine", solver: Some("Ode45(rtol: 1e-9, max_step: \"1 ms\")"), ..DEFAULT };

/// All variants; the first is the default.
pub fn vary() -> Vec<Variant> {
    let solver = |name, solver| Variant { name, solver: Some(solver), ..DEFAULT };
    vec![
        DEFAULT,
        solver("half the tolerance", "Ode45(rtol: 5e-7)"),
        solver("tight", "Ode45(rtol: 1e-9)"),
        solver("Ode23", "Ode23()"),
        solver("Rodas4", "Rodas4()"),
        solver("RosW3", "RosW3()"),
        Variant { name: "rows", every: Some("0.0731 s"), ..DEFAULT },
        Variant { name: "reversed", reversed: true, ..DEFAULT },
        Variant { name: "bystander", bystander: true, ..DEFAULT },
    ]
}

impl Variant {
    /// The default.
    pub fn plain() -> Variant {
        DEFAULT
    }

    /// With steps of a millisecond at most.
    pub fn fine() -> Variant {
        FINE
    }

    /// The name of a block.
    pub(crate) fn name(&self, kind: &str, node: usize) -> String {
        let number = if self.reversed { 99 - node.min(99) } else { node };
        let kind = kind.to_lowercase();
        if self.reversed { format!("b{number:02}_{kind}_{node}") } else { format!("{kind}_{node}") }
    }

    /// What follows the stop time in the settings.
    pub(crate) fn settings(&self) -> String {
        let solver = self.solver.map_or(String::new(), |solver| format!(", solver: {solver}"));
        let every = self.every.map_or(String::new(), |every| format!(", output: Every(\"{every}\")"));
        solver + &every
    }
}
