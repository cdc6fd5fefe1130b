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
}

const fn variable(
    name: &'static str,
    method: VariableMethod,
    order: &'static str,
    purpose: &'static str,
) -> MethodInfo {
    MethodInfo { name, method: Method::Variable(method), order, purpose }
}

const fn fixed(
    name: &'static str,
    method: FixedMethod,
    order: &'static str,
    purpose: &'static str,
) -> MethodInfo {
    MethodInfo { name, method: Method::Fixed(method), order, purpose }
}

/// All methods, the default first.
pub const METHODS: [MethodInfo; 12] = [
    variable(
        "Auto",
        VariableMethod::Auto,
        "5, 1 to 5",
        "the default: `Ode45`, and `Ode15s` where stability limits the steps of that",
    ),
    variable("Ode45", VariableMethod::Ode45, "5", "Dormand-Prince 5(4): what is not stiff"),
    variable("Ode23", VariableMethod::Ode23, "3", "Bogacki-Shampine 3(2): loose tolerances, many events"),
    variable(
        "Ode15s",
        VariableMethod::Ode15s,
        "1 to 5",
        "differentiation formulas of variable order: stiff systems, large ones too",
    ),
    variable("Radau5", VariableMethod::Radau5, "5", "Radau IIA: stiff systems at tight tolerances, events"),
    variable(
        "Rodas4",
        VariableMethod::Rodas4,
        "4",
        "a Rosenbrock method with the whole Jacobian: small stiff systems, weakly damped ones too",
    ),
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

/// Names of methods elsewhere, and what does the same here.
const ELSEWHERE: [(&str, &str); 10] = [
    ("VariableStepAuto", "Auto"),
    ("Ode113", "Ode45"),
    ("Ode23s", "Rodas4"),
    ("Ode23t", "Rodas4"),
    ("Ode23tb", "Radau5"),
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
        assert_eq!(instead_of("ode23tb"), Some("Radau5"));
    }
}
