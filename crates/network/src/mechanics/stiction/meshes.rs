//! Meshes of gears that stick: what they hold follows from the torque that passes, and some lock themselves.

use blocksim_block::Context;
use blocksim_block::physical::{Grip, Torque};

use super::FAR;
use super::parts::Place;
use crate::network::Network;
use crate::work::Work;

/// Largest product of the share of a loss and its effect on the torque that passes; at 1 there would be no solution.
const STEEPEST: f64 = 0.99;

impl Network {
    /// Laws and directions of the meshes that stick.
    pub(crate) fn dry_meshes(&self, c: &Context, w: &mut Work) {
        if self.stiction.meshes() == 0 {
            return;
        }
        let first = self.stiction.frictions;
        let (mut dry, mut speed) = (std::mem::take(&mut w.dry), std::mem::take(&mut w.dry_speed));
        let modes = &self.stiction.of(c.d)[first..];
        for (k, (speed, mode)) in speed.iter_mut().zip(modes).enumerate() {
            *speed = mode * self.slip(first + k, c.x, &w.s).0;
        }
        for seat in self.active.dry.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                let range = seat.dry.clone();
                component.mesh_losses(&self.flowing_law(c, seat, w), &speed[range.clone()], &mut dry[range]);
            }
        }
        for ((place, law), mode) in self.stiction.parts[first..].iter().zip(&dry).zip(modes) {
            if let Place::Gear(gear) = place {
                w.mesh.dry[*gear] = (*law, *mode);
            }
        }
        (w.dry, w.dry_speed) = (dry, speed);
    }

    /// Constraint and index of each mesh that is stuck.
    pub(crate) fn stuck_meshes<'a>(&'a self, w: &'a Work) -> impl Iterator<Item = (usize, usize)> + 'a {
        let rows = w.stuck.iter().enumerate();
        rows.filter_map(move |(k, i)| match self.stiction.parts[*i] {
            Place::Gear(gear) => Some((w.first_stuck + k, gear)),
            Place::Pin(_) => None,
        })
    }

    /// What is stuck, by its constraint, and what its torque adds to that through a gear.
    pub(crate) fn stuck_shares<'a>(
        &'a self,
        gear: usize,
        w: &'a Work,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        let gear = &self.rotation.gears[gear];
        w.stuck.iter().enumerate().map(move |(k, i)| {
            let by = match self.stiction.parts[*i] {
                Place::Pin(_) => gear.by_torque.at(self.stiction.first + i),
                Place::Gear(other) => gear.by_loss[other],
            };
            (w.first_stuck + k, by)
        })
    }

    /// What the meshes hold, which depends on the torque that passes.
    pub(crate) fn mesh_grips(&self, w: &mut Work) {
        let first = self.stiction.frictions;
        for (k, (place, law)) in self.stiction.parts[first..].iter().zip(&w.dry).enumerate() {
            if let Place::Gear(gear) = place {
                let torque = w.mesh.torque[*gear];
                let [forward, backward] = [1.0, -1.0].map(|sense| law.loss(torque, sense).0.abs());
                w.grip[first + k] = Grip {
                    hold: [forward, backward],
                    slide: [forward, backward].map(|value| Torque { value, slope: 0.0 }),
                    stop: None,
                };
            }
        }
    }

    /// Finds the meshes that would lock themselves while they slide. Where the share of the loss is so large that no
    /// torque fits once the load overruns the base, the loss goes on from that while the base drives, up to the event
    /// at which the mesh jams.
    pub(crate) fn find_jams(&self, w: &mut Work) {
        let g = self.meshes.len();
        for (i, (law, sense)) in w.mesh.dry.iter_mut().enumerate() {
            w.may_jam[i] = *sense != 0.0 && w.coupling[i * g + i] * law.share[1] > STEEPEST;
            if w.may_jam[i] {
                law.share[1] = -law.share[0];
                law.bearing[1] = law.bearing[0];
            }
        }
    }

    /// What is to be said where no torques fit the laws and gears lock themselves: what drives them backward is the most
    /// likely cause.
    pub(crate) fn self_locking(&self, w: &Work) -> Option<String> {
        let locks = |gear: &usize| w.may_jam[*gear] || w.mesh.dry[*gear].0.share[1] >= 1.0;
        let path_of = |gear: usize| self.seats.iter().find(|seat| seat.gears.contains(&gear));
        let mut paths: Vec<String> = (0..self.meshes.len())
            .filter(locks)
            .filter_map(path_of)
            .map(|seat| format!("`{}`", seat.member.path))
            .collect();
        paths.dedup();
        (!paths.is_empty()).then(|| {
            format!(
                "a speed or a load behind {} drives it backward, but it locks itself and no torque turns it: drive it \
                 from its base, or let it give way by a softer coupling or an efficiency backward above 0",
                paths.join(" and ")
            )
        })
    }

    /// How far a mesh that slides is from jamming: the torque that passes, N*m.
    pub(super) fn jam(&self, i: usize, mode: f64, w: &Work) -> f64 {
        match self.stiction.parts[i] {
            Place::Gear(gear) if w.may_jam[gear] => mode * w.mesh.torque[gear],
            _ => FAR,
        }
    }
}
