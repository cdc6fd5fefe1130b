//! The same model put differently, which must not change what comes out.

/// How a model is put.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Variant {
    /// What it is called.
    pub name: &'static str,
    /// What follows the stop time in the settings, such as `, solver: Ode23()`.
    pub settings: String,
    /// Blocks and connections in reverse order; where names follow from numbers, they sort the other way.
    pub reversed: bool,
    /// A low-pass of a sine beside the model.
    pub bystander: bool,
}

/// All variants; the first is the default.
pub fn vary() -> Vec<Variant> {
    let solver =
        |name, solver| Variant { name, settings: format!(", solver: {solver}"), ..Variant::default() };
    vec![
        Variant::plain(),
        solver("half the tolerance", "Ode45(rtol: 5e-7)"),
        solver("tight", "Ode45(rtol: 1e-9)"),
        solver("Ode23", "Ode23()"),
        solver("Rodas4", "Rodas4()"),
        solver("RosW3", "RosW3()"),
        Variant { name: "rows", settings: ", output: Every(\"0.0731 s\")".to_owned(), ..Variant::default() },
        Variant { name: "reversed", reversed: true, ..Variant::default() },
        Variant { name: "bystander", bystander: true, ..Variant::default() },
    ]
}

impl Variant {
    /// As a user puts it who says nothing.
    pub fn plain() -> Variant {
        Variant { name: "default", ..Variant::default() }
    }

    /// With tolerances a ten-thousandth of the usual ones, unless it names a method.
    pub(super) fn tight(&self) -> Option<Variant> {
        let settings = format!("{}, solver: Auto(rtol: 1e-10)", self.settings);
        (!self.settings.contains("solver")).then(|| Variant { name: "close", settings, ..self.clone() })
    }

    /// With settings behind the stop time.
    pub fn with(settings: &str) -> Variant {
        Variant { name: "given settings", settings: settings.to_owned(), ..Variant::default() }
    }

    /// The name of a block of this number.
    pub(super) fn name(&self, kind: &str, node: usize) -> String {
        let number = if self.reversed { 99 - node.min(99) } else { node };
        let kind = kind.to_lowercase();
        if self.reversed { format!("b{number:02}_{kind}_{node}") } else { format!("{kind}_{node}") }
    }
}
