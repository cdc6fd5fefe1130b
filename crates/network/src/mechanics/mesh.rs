//! Losses of gear meshes.
//!
//! The torque into a mesh at the base is the torque that passes through plus the loss, `T_B = T + T_f(T_B, w_B)`,
//! and what passes through depends on the accelerations, which depend on the loss: the one relation of a network
//! that is solved by iteration. It starts from the lossless torque, never from an earlier result, so a result
//! does not depend on rejected steps.
//!
//! A mesh with stiction has its loss from the torque `T` that passes, which holds for meshes that lock themselves, too.
//! While it is stuck the loss is the multiplier of a constraint and none of the business of this iteration.

use blocksim_block::physical::{DryMesh, LossModel, MeshLoss};
use blocksim_solve::linear::{lu_factor, lu_solve};

/// Meshes of the arms that most robots have.
pub(crate) const ARM: usize = 6;

/// How far the loss of the dissipative law has set in, from -1 to 1: all that it needs a hyperbolic tangent for.
fn onset(mesh: &MeshLoss, speed: f64) -> f64 {
    match mesh.model {
        LossModel::Dissipative { threshold } => (speed / threshold).tanh(),
        LossModel::Published { .. } | LossModel::Stiction => 0.0,
    }
}

/// Shares of the torque that a mesh loses: with `FL = 1 - eta(base to follower)` and `BL = 1/eta(follower to base) - 1`, far above the
/// threshold the follower gets `eta` of the torque in either direction.
#[derive(Debug, Clone, Copy, Default)]
struct Shares {
    forward: f64,
    backward: f64,
}

impl Shares {
    fn of(mesh: &MeshLoss) -> Self {
        Self { forward: 1.0 - mesh.forward, backward: 1.0 / mesh.backward - 1.0 }
    }
}

/// Loss torque and its derivatives with respect to the torque into the base and the speed of the base, whose [`onset`] is known: no
/// torque changes it.
#[inline(always)]
fn loss(
    mesh: &MeshLoss,
    Shares { forward, backward }: Shares,
    torque: f64,
    speed: f64,
    onset: f64,
) -> (f64, f64, f64) {
    match mesh.model {
        LossModel::Dissipative { threshold } => {
            let share = if torque * speed > 0.0 { forward } else { backward };
            let d_onset = (1.0 - onset * onset) / threshold;
            (torque.abs() * share * onset, torque.signum() * share * onset, torque.abs() * share * d_onset)
        }
        LossModel::Published { threshold } => {
            let onset = (4.0 * torque * speed / threshold).tanh();
            let d_onset = (1.0 - onset * onset) * 4.0 / threshold;
            let (sum, difference) = (forward + backward, forward - backward);
            let value = 0.5 * torque * (sum * onset + difference);
            let by_torque = 0.5 * (sum * onset + difference) + 0.5 * torque * sum * d_onset * speed;
            (value, by_torque, 0.5 * torque * sum * d_onset * torque)
        }
        LossModel::Stiction => (0.0, 0.0, 0.0),
    }
}

/// Work space of [`solve`].
#[derive(Debug, Clone, Default)]
pub(crate) struct MeshScratch {
    /// Torque into the base of each mesh, N*m; of meshes with stiction, that which passes on to the follower.
    pub torque: Vec<f64>,
    /// Loss of each mesh, N*m.
    pub loss: Vec<f64>,
    /// Derivative of each loss with respect to the speed of its base.
    pub by_speed: Vec<f64>,
    /// Of meshes with stiction: what they lose, and in which direction they slide; 0 when they are stuck.
    pub dry: Vec<(DryMesh, f64)>,
    shares: Vec<Shares>,
    /// Of dissipative meshes, for the iteration at hand.
    onset: Vec<f64>,
    by_torque: Vec<f64>,
    residual: Vec<f64>,
    trial: Vec<f64>,
    direction: Vec<f64>,
    jacobian: Vec<f64>,
    pivots: Vec<usize>,
}

impl MeshScratch {
    pub(crate) fn new(meshes: &[MeshLoss]) -> Self {
        let n = meshes.len();
        Self {
            torque: vec![0.0; n],
            loss: vec![0.0; n],
            by_speed: vec![0.0; n],
            dry: vec![(DryMesh::default(), 0.0); n],
            shares: meshes.iter().map(Shares::of).collect(),
            onset: vec![0.0; n],
            by_torque: vec![0.0; n],
            residual: vec![0.0; n],
            trial: vec![0.0; n],
            direction: vec![0.0; n],
            jacobian: vec![0.0; n * n],
            pivots: vec![0; n],
        }
    }

    /// `F(z) = z - phi(z) + K phi(z) - c`, with stiction `F(z) = z + K phi(z) - c`; leaves losses and their derivatives behind. Returns its largest element.
    #[inline(always)]
    fn residual(&mut self, law: &Coupled, at_trial: bool, n: usize) -> f64 {
        let z = if at_trial { &self.trial[..n] } else { &self.torque[..n] };
        let (meshes, speed) = (&law.meshes[..n], &law.speed[..n]);
        let (onset, shares, dry) = (&self.onset[..n], &self.shares[..n], &self.dry[..n]);
        let (losses, residual) = (&mut self.loss[..n], &mut self.residual[..n]);
        let (by_torque, by_speed) = (&mut self.by_torque[..n], &mut self.by_speed[..n]);
        for i in 0..n {
            (losses[i], by_torque[i], by_speed[i]) = match (meshes[i].model, &dry[i]) {
                (LossModel::Stiction, (_, 0.0)) => (0.0, 0.0, 0.0),
                (LossModel::Stiction, (law, sense)) => law.loss(z[i], *sense),
                _ => loss(&meshes[i], shares[i], z[i], speed[i], onset[i]),
            };
        }
        let mut largest = 0.0_f64;
        for (i, k) in law.k[..n * n].chunks_exact(n).enumerate() {
            let coupled: f64 = k.iter().zip(&*losses).map(|(k, loss)| k * loss).sum();
            residual[i] = z[i] - own(&meshes[i]) * losses[i] + coupled - law.c[..n][i];
            largest = largest.max(residual[i].abs());
        }
        largest
    }
}

/// What couples meshes: `z - phi(z) + K phi(z) = c`, with the speeds of their bases.
struct Coupled<'k> {
    meshes: &'k [MeshLoss],
    speed: &'k [f64],
    k: &'k [f64],
    c: &'k [f64],
}

/// Whether the loss follows from the torque into the base, its own part included (1), or from the rest (0).
fn own(mesh: &MeshLoss) -> f64 {
    if mesh.model == LossModel::Stiction { 0.0 } else { 1.0 }
}

/// More iterations than any law with efficiencies above 0.3 ever needed.
const ITERATIONS: usize = 60;

/// Solves `z - phi(z) + K phi(z) = c` for the torques into the bases of all meshes by Newton's method with
/// halving. Returns `false` when no solution was found, which happens in the self-locking regime that the law
/// does not model.
pub(crate) fn solve(s: &mut MeshScratch, meshes: &[MeshLoss], speed: &[f64], k: &[f64], c: &[f64]) -> bool {
    let law = Coupled { meshes, speed, k, c };
    // The arms that most robots have are told to the compiler, which unrolls them.
    match meshes.len() {
        ARM => iterate(s, &law, ARM),
        n => iterate(s, &law, n),
    }
}

#[inline(always)]
fn iterate(s: &mut MeshScratch, law: &Coupled, n: usize) -> bool {
    let (meshes, speed, c) = (&law.meshes[..n], &law.speed[..n], &law.c[..n]);
    s.torque.copy_from_slice(c);
    let onsets = s.onset[..n].iter_mut().zip(meshes.iter().zip(speed));
    onsets.for_each(|(to, (mesh, speed))| *to = onset(mesh, *speed));
    // Bearings take their torque even where nothing passes.
    let bearings = s.dry[..n].iter().filter(|(_, sense)| *sense != 0.0);
    let bearings = bearings.map(|(law, sense)| law.loss(0.0, *sense).0.abs());
    let scale = c.iter().map(|value| value.abs()).chain(bearings).fold(1e-9_f64, f64::max);
    let mut error = s.residual(law, false, n);
    for _ in 0..ITERATIONS {
        if error <= 1e-13 * scale {
            return true;
        }
        let by_torque = &s.by_torque[..n];
        let rows = s.jacobian[..n * n].chunks_exact_mut(n).zip(law.k[..n * n].chunks_exact(n));
        for (i, (row, k)) in rows.enumerate() {
            row.iter_mut().zip(k.iter().zip(by_torque)).for_each(|(to, (k, by_torque))| *to = k * by_torque);
            row[i] = 1.0 + (k[i] - own(&meshes[i])) * by_torque[i];
        }
        s.direction[..n].copy_from_slice(&s.residual[..n]);
        if lu_factor(&mut s.jacobian, &mut s.pivots).is_err() {
            return false;
        }
        lu_solve(&s.jacobian, &s.pivots, &mut s.direction);
        let before = error;
        let mut step = 1.0;
        loop {
            let (torque, direction) = (&s.torque[..n], &s.direction[..n]);
            let trials = s.trial[..n].iter_mut().zip(torque.iter().zip(direction));
            trials.for_each(|(to, (z, d))| *to = z - step * d);
            error = s.residual(law, true, n);
            if error < before || step < 1e-3 {
                break;
            }
            step *= 0.5;
        }
        std::mem::swap(&mut s.torque, &mut s.trial);
        // Rounding limits what can be reached; two equal residuals in a row are the floor.
        if error >= before && error <= 1e-10 * scale {
            return true;
        }
    }
    error <= 1e-10 * scale
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loss_at(mesh: &MeshLoss, torque: f64, speed: f64) -> (f64, f64, f64) {
        loss(mesh, Shares::of(mesh), torque, speed, onset(mesh, speed))
    }

    fn published(forward: f64, backward: f64) -> MeshLoss {
        MeshLoss { forward, backward, model: LossModel::Published { threshold: 1e-3 } }
    }

    #[test]
    fn the_published_law_gives_its_reference_values() {
        // Torque 1 N*m, efficiencies 0.8 and 0.7, threshold 1 mW; the power is varied through the speed.
        let expected = [
            (-1.0, -0.428_571_4),
            (-1e-3, -0.428_360_6),
            (-1e-4, -0.233_698_2),
            (0.0, -0.114_285_7),
            (1e-4, 0.005_126_8),
            (2.5e-4, 0.125_072_4),
            (1e-3, 0.199_789_2),
            (1.0, 0.2),
        ];
        for (power, value) in expected {
            let (found, _, _) = loss_at(&published(0.8, 0.7), 1.0, power);
            assert!((found - value).abs() < 1e-7, "p = {power}: {found} != {value}");
        }
    }

    #[test]
    fn the_dissipative_law_never_delivers_power_and_has_the_same_limits() {
        let mesh = MeshLoss { forward: 0.8, backward: 0.7, model: LossModel::Dissipative { threshold: 1.0 } };
        for torque in [-3.0, -0.1, 0.0, 0.1, 3.0] {
            for speed in [-100.0, -0.5, 0.0, 0.5, 100.0] {
                let (found, _, _) = loss_at(&mesh, torque, speed);
                assert!(found * speed >= 0.0, "torque {torque}, speed {speed}: {found}");
                if f64::abs(speed) == 100.0 && torque != 0.0 {
                    let (limit, _, _) = loss_at(&published(0.8, 0.7), torque, speed);
                    assert!(
                        (found - limit).abs() < 1e-12,
                        "torque {torque}, speed {speed}: {found} != {limit}"
                    );
                }
            }
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        for model in [LossModel::Dissipative { threshold: 1.0 }, LossModel::Published { threshold: 1e-3 }] {
            let mesh = MeshLoss { forward: 0.75, backward: 0.7, model };
            for (torque, speed) in [(1.0, 2e-4), (-2.0, 1e-4), (0.5, -3e-4), (-0.7, -2e-4)] {
                let (_, by_torque, by_speed) = loss_at(&mesh, torque, speed);
                let h = 1e-9;
                let dt =
                    (loss_at(&mesh, torque + h, speed).0 - loss_at(&mesh, torque - h, speed).0) / (2.0 * h);
                let dw =
                    (loss_at(&mesh, torque, speed + h).0 - loss_at(&mesh, torque, speed - h).0) / (2.0 * h);
                assert!((by_torque - dt).abs() < 1e-4 * (1.0 + dt.abs()), "{by_torque} != {dt}");
                assert!((by_speed - dw).abs() < 1e-4 * (1.0 + dw.abs()), "{by_speed} != {dw}");
            }
        }
    }

    #[test]
    fn losses_from_the_torque_that_passes_are_those_of_the_efficiencies() {
        let smooth =
            [MeshLoss { forward: 0.8, backward: 0.7, model: LossModel::Dissipative { threshold: 1e-9 } }];
        let stiff = [MeshLoss { model: LossModel::Stiction, ..smooth[0] }];
        let law = DryMesh { share: [1.0 / 0.8 - 1.0, 1.0 - 0.7], ..DryMesh::default() };
        for (c, sense, k) in [(4.0, 1.0, 0.0), (4.0, -1.0, 0.3), (-2.0, 1.0, 0.9), (-2.0, -1.0, 0.5)] {
            let (mut a, mut b) = (MeshScratch::new(&smooth), MeshScratch::new(&stiff));
            assert!(solve(&mut a, &smooth, &[sense], &[k], &[c]));
            b.dry[0] = (law, sense);
            assert!(solve(&mut b, &stiff, &[sense], &[k], &[c]));
            assert!((a.loss[0] - b.loss[0]).abs() < 1e-12, "{c}, {sense}: {} != {}", a.loss[0], b.loss[0]);
        }
    }

    #[test]
    fn an_isolated_mesh_passes_the_efficiency() {
        // K = 0: what passes through (c) is given, z - phi(z) = c, so z = c / eta when the base drives.
        let meshes =
            [MeshLoss { forward: 0.8, backward: 0.7, model: LossModel::Dissipative { threshold: 1.0 } }];
        let mut s = MeshScratch::new(&meshes);
        assert!(solve(&mut s, &meshes, &[100.0], &[0.0], &[4.0]));
        assert!((s.torque[0] - 5.0).abs() < 1e-12, "{}", s.torque[0]);
        assert!(solve(&mut s, &meshes, &[-100.0], &[0.0], &[4.0]));
        assert!((s.torque[0] - 2.8).abs() < 1e-12, "{}", s.torque[0]);
    }
}
