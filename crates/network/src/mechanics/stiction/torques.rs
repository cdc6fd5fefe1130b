//! What dry friction does in a mode: torques of what slides, constraints of what is stuck.

use blocksim_block::Context;
use blocksim_block::physical::Torque;

use super::OPEN;
use super::parts::Place;
use crate::network::Network;
use crate::work::Work;

impl Network {
    /// Torques of what slides.
    pub(crate) fn sliding_torques(&self, c: &Context, w: &mut Work) {
        if self.stiction.frictions == 0 {
            return;
        }
        let mut grip = std::mem::take(&mut w.grip);
        for seat in self.active.frictions.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.component() {
                component.grips(&self.flowing_law(c, seat, w), &mut grip[seat.frictions.clone()]);
            }
        }
        let torques = w.torque[self.stiction.first..].iter_mut();
        let modes = self.stiction.of(c.d);
        for (((torque, grip), mode), beside) in torques.zip(&grip).zip(modes).zip(&self.stiction.beside) {
            // A mesh that stands keeps it from sliding: it bears all that it can hold, and the mesh the rest.
            let stands = beside.iter().any(|mesh| modes[*mesh] == 0.0);
            let side = usize::from(*mode < 0.0);
            *torque = match *mode {
                OPEN => Torque::default(),
                m if stands && m.abs() == 1.0 && grip.hold[side].is_finite() => {
                    Torque { value: m * grip.hold[side], slope: 0.0 }
                }
                m if m > 0.0 => grip.slide[0],
                m if m < 0.0 => Torque { value: -grip.slide[1].value, slope: grip.slide[1].slope },
                _ => Torque::default(),
            };
        }
        w.grip = grip;
    }

    /// The speed of what is stuck is zero, not nearly zero.
    pub(crate) fn still_pins(&self, c: &Context, w: &mut Work) {
        for (place, mode) in self.stiction.parts.iter().zip(self.stiction.of(c.d)) {
            if let (Place::Pin(pin), 0.0) = (place, mode) {
                w.pin_speed[*pin] = 0.0;
            }
        }
    }

    /// Constraints of what is stuck, behind those that are there.
    pub(crate) fn stuck_rows(&self, c: &Context, w: &mut Work) {
        w.first_stuck = w.rows.len();
        w.rows.yielding = w.first_stuck;
        w.stuck.clear();
        for (i, mode) in self.stiction.of(c.d).iter().enumerate() {
            if *mode == 0.0 {
                let (form, prescribed) = self.sticky(i);
                // What a mesh can hold is not known yet: brakes beside it come first.
                let weight = match self.stiction.parts[i] {
                    Place::Pin(_) => w.grip[i].hold[0].max(w.grip[i].hold[1]).clamp(1e-12, 1e12),
                    Place::Gear(_) => 1e-9,
                };
                form.add_to(1.0, w.rows.push(-prescribed.of(&w.ds), weight));
                w.stuck.push(i);
            }
            if i + 1 == self.stiction.frictions {
                w.rows.last = w.rows.len();
            }
        }
        if self.stiction.frictions == 0 {
            w.rows.last = w.first_stuck;
        }
        w.lock.prepare(&w.stuck, |i| self.sticky(i));
    }

    /// Torques of what is stuck, from the multipliers of its constraints.
    pub(crate) fn holding_torques(&self, w: &mut Work) {
        for (i, lambda) in w.stuck.iter().zip(&w.lambda[w.first_stuck..]) {
            match self.stiction.parts[*i] {
                Place::Pin(_) => w.torque[self.stiction.first + i].value = -lambda,
                Place::Gear(gear) => w.mesh.loss[gear] = -lambda,
            }
        }
    }
}
