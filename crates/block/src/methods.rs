//! The methods of integration by their names: one list for diagrams, command lines, messages and manuals.

use crate::schedule::{FixedMethod, VariableMethod};

/// A method of either sort.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// With a fixed step.
    Fixed(FixedMethod),
    /// That chooses its step.
    Variable(VariableMethod),
}

/// What is told of a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MethodInfo {
    /// As it stands in diagrams: `Ode45`.
    pub name: &'static str,
    /// Which it is.
    pub method: Method,
    /// Order, in words.
    pub order: &'static str,
    /// What it is and what it is for, in a line of a table.
    pub purpose: &'static str,
    /// Whether stiffness of any kind does not limit its steps.
    pub stiff: bool,
}

impl MethodInfo {
    const fn for_stiff(self) -> Self {
        Self { stiff: true, ..self }
    }
}

const fn variable(
    name: &'static str,
    method: VariableMethod,
    order: &'static str,
    purpose: &'static str,
) -> MethodInfo {
    MethodInfo { name, method: Method::Variable(method), order, purpose, stiff: false }
}

const fn fixed(
    name: &'static str,
    method: FixedMethod,
    order: &'static str,
    purpose: &'static str,
) -> MethodInfo {
    MethodInfo { name, method: Method::Fixed(method), order, purpose, stiff: false }
}

/// All methods, the default first.
pub const METHODS: [MethodInfo; 15] = [
    variable(
        "Auto",
        VariableMethod::Auto,
        "5, 1 to 5",
        "the default: `Ode45`, and `Ode15s` where stability limits the steps of that",
    )
    .for_stiff(),
    variable("Ode45", VariableMethod::Ode45, "5", "Dormand-Prince 5(4): what is not stiff"),
    variable("Ode23", VariableMethod::Ode23, "3", "Bogacki-Shampine 3(2): loose tolerances, many events"),
    variable(
        "Dop853",
        VariableMethod::Dop853,
        "8",
        "Dormand-Prince 8(5,3): what is smooth and not stiff, at tight tolerances",
    ),
    variable(
        "Ode15s",
        VariableMethod::Ode15s,
        "1 to 5",
        "differentiation formulas of variable order: stiff systems, large ones too",
    )
    .for_stiff(),
    variable("Radau5", VariableMethod::Radau5, "5", "Radau IIA: stiff systems at tight tolerances, events")
        .for_stiff(),
    variable(
        "Rodas4",
        VariableMethod::Rodas4,
        "4",
        "a Rosenbrock method with the whole Jacobian: small stiff systems, weakly damped ones too",
    )
    .for_stiff(),
    variable(
        "Ode23tb",
        VariableMethod::Ode23tb,
        "2",
        "TR-BDF2: stiff systems at loose tolerances, events; damps what is fast",
    )
    .for_stiff(),
    variable(
        "Ode23t",
        VariableMethod::Ode23t,
        "2",
        "the trapezoidal rule: stiff systems at loose tolerances whose oscillations must not be damped",
    )
    .for_stiff(),
    variable(
        "RosW3",
        VariableMethod::RosW3,
        "3",
        "mechanisms with stiff friction: takes only the slopes of the friction implicitly",
    ),
    fixed("Ode1", FixedMethod::Ode1, "1", "fixed step: Euler"),
    fixed("Ode2", FixedMethod::Ode2, "2", "fixed step: Heun"),
    fixed("Ode3", FixedMethod::Ode3, "3", "fixed step: Bogacki-Shampine"),
    fixed("Ode4", FixedMethod::Ode4, "4", "fixed step: Runge-Kutta"),
    fixed("Ode5", FixedMethod::Ode5, "5", "fixed step: Dormand-Prince"),
];

/// The methods that choose their step, the default first.
pub const VARIABLE: [VariableMethod; 10] = {
    let mut methods = [VariableMethod::Auto; 10];
    let (mut from, mut to) = (0, 0);
    while from < METHODS.len() {
        if let Method::Variable(method) = METHODS[from].method {
            methods[to] = method;
            to += 1;
        }
        from += 1;
    }
    assert!(to == methods.len(), "as many as there are");
    methods
};

/// Names of methods elsewhere, and what does the same here.
const ELSEWHERE: [(&str, &str); 13] = [
    ("VariableStepAuto", "Auto"),
    ("Ode78", "Dop853"),
    ("Ode89", "Dop853"),
    ("Ode113", "Dop853"),
    ("Dop8", "Dop853"),
    ("Dopri5", "Ode45"),
    ("Vern8", "Dop853"),
    ("Ode23s", "Rodas4"),
    ("DaeSsc", "Ode15s"),
    ("Dassl", "Ode15s"),
    ("CVode", "Ode15s"),
    ("Ode8", "Ode5"),
    ("Ode14x", "Ode15s"),
];

impl Method {
    /// Its name, as it stands in diagrams.
    pub fn name(self) -> &'static str {
        METHODS.iter().find(|info| info.method == self).map_or("", |info| info.name)
    }

    /// The method of a name, in capitals or not.
    pub fn named(name: &str) -> Option<Method> {
        METHODS.iter().find(|info| info.name.eq_ignore_ascii_case(name)).map(|info| info.method)
    }
}

/// What does here what a method of another program does.
pub fn instead_of(name: &str) -> Option<&'static str> {
    ELSEWHERE.iter().find(|(other, _)| other.eq_ignore_ascii_case(name)).map(|(_, here)| *here)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_is_found_by_its_name_and_no_other() {
        for info in METHODS {
            assert_eq!(Method::named(&info.name.to_lowercase()), Some(info.method));
            assert_eq!(info.method.name(), info.name);
            assert_eq!(instead_of(info.name), None);
        }
        assert_eq!(Method::named("ode99"), None);
    }

    #[test]
    fn names_of_other_programs_lead_to_methods_that_there_are() {
        for (_, here) in ELSEWHERE {
            assert!(Method::named(here).is_some(), "{here}");
        }
        assert_eq!(instead_of("ode89"), Some("Dop853"));
    }
}
