//! What must hold before a network can run.

use blocksim_block::{Context, Fault};

use crate::network::Network;
use crate::problem::NetworkProblem;
use crate::work::Work;

impl Network {
    /// At the start pose every independent speed must move something.
    pub(crate) fn mass_matrix_is_definite(&self) -> Result<(), Vec<NetworkProblem>> {
        let mut work = Work::new(self);
        let n = self.rotation.free;
        self.mass(&self.frames.position, &mut work);
        if !self.frames.loops.is_empty() {
            self.close_loops(&self.frames.position, &mut work);
        }
        work.factor.copy_from_slice(&work.mass);
        if self.envelope.factor(&mut work.factor).is_ok() {
            return Ok(());
        }
        let weak = (0..n).min_by(|i, j| work.mass[i * n + i].total_cmp(&work.mass[j * n + j])).unwrap_or(0);
        let problem = NetworkProblem::new(
            "no_inertia",
            format!(
                "the mass matrix is not positive definite: `{}` moves {} kg*m^2",
                self.rotation.names[weak],
                work.mass[weak * n + weak]
            ),
            "give the bodies behind it mass, or couple an Inertia to its drive side",
        );
        let joint = self.frames.speeds.get(weak);
        Err(vec![
            joint.into_iter().fold(problem, |problem, joint| problem.with(joint.member, "moves too little")),
        ])
    }

    /// Currents that are states must obey Kirchhoff's law from the start. Where valves may open a path, the first
    /// instant tells.
    pub(crate) fn currents_fit(&self) -> Result<(), Vec<NetworkProblem>> {
        let mut work = Work::new(self);
        let x: Vec<f64> = self.interface.states.iter().map(|state| state.initial).collect();
        let d: Vec<f64> = self.interface.discrete.iter().map(|state| state.initial).collect();
        let inputs = self.seats.last().map_or(0, |seat| seat.u.end);
        let u = vec![0.0; inputs];
        let fault = Fault::default();
        let c =
            Context { t: 0.0, x: &x, d: &d, u: &u, inputs: &[], outputs: &[], evaluation: 0, fault: &fault };
        self.state_phase(&c, &mut work);
        let mut problems = Vec::new();
        for (index, island) in self.electrics.islands.iter().enumerate() {
            if !island.valves.is_empty() || self.circuit(index, &c, &mut work).is_err() {
                continue;
            }
            problems.extend(self.misfit(index, &work));
        }
        if problems.is_empty() { Ok(()) } else { Err(problems) }
    }
}
