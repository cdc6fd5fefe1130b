//! What can be wrong with a network.

/// A fault of a network, with the members it concerns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NetworkProblem {
    /// A word for the manual: `missing_reference`, `no_inertia` ...
    pub code: &'static str,
    /// Members that the fault concerns and what each has to do with it, most guilty first.
    pub members: Vec<(usize, String)>,
    /// The fact, in one sentence.
    pub message: String,
    /// What to do.
    pub help: String,
}

impl NetworkProblem {
    /// A fault that concerns members.
    pub(crate) fn new(code: &'static str, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { code, members: Vec::new(), message: message.into(), help: help.into() }
    }

    /// Adds a member.
    pub(crate) fn with(mut self, member: usize, role: impl Into<String>) -> Self {
        self.members.push((member, role.into()));
        self
    }
}
