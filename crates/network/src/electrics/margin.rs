//! How far a valve is from having to change. The verdict after an event and the guard of the step that follows are the
//! same number, so that a guard never starts on the wrong side of zero.

use blocksim_block::Context;
use blocksim_block::physical::ValveKind;

use crate::network::Network;
use crate::work::Work;

/// What rounding leaves of voltages and of currents, relative to the largest that the circuit has had. A voltage across a
/// valve of little resistance means a large current, so less is left of it.
const ROUNDING: [f64; 2] = [1e-12, 1e-10];

/// Voltages and currents below this, V and A, are nothing even where there has been nothing else.
pub(crate) const NOTHING: f64 = 1e-30;

/// The margin of a guard that cannot be used up as long as its gate is off.
const CLOSED: f64 = 1.0;

/// Current over that at which a valve lets go, A, or voltage below that at which it begins, V.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Margin {
    pub value: f64,
    /// What rounding may have made of it.
    pub noise: f64,
    /// Size of voltages or currents of the circuit.
    pub scale: f64,
}

impl Margin {
    /// Positive as long as the valve does right.
    #[inline]
    pub(crate) fn guard(&self) -> f64 {
        self.value + self.noise
    }

    pub(crate) fn holds(&self) -> bool {
        self.guard() > 0.0
    }

    /// Whether nothing is left of it but rounding.
    pub(crate) fn is_over(&self) -> bool {
        self.value <= self.noise
    }

    /// Whether rounding decides what the value is.
    pub(crate) fn is_open(&self) -> bool {
        self.value.abs() <= self.noise
    }
}

impl Network {
    /// The margin of a valve of an island, `None` if it does not change by itself now: its gate is off, or no current can flow
    /// anyway. Gates are known, and the solution is that of the set at hand.
    pub(crate) fn margin(
        &self,
        island: usize,
        bit: usize,
        on: bool,
        size: [f64; 2],
        w: &Work,
    ) -> Option<Margin> {
        let index = self.electrics.islands[island].valves[bit];
        let valve = &self.electrics.valves[index];
        let may = match valve.kind {
            ValveKind::Switch => false,
            ValveKind::Diode => true,
            ValveKind::GatedDiode => w.gates[index],
            ValveKind::Thyristor => on || w.gates[index],
        };
        let may = may && !(on && w.circuits[island].now().idle >> bit & 1 == 1);
        let (value, scale, rounding) = if on {
            (w.current[valve.two_pin] - valve.holding_current, size[1], ROUNDING[1])
        } else {
            (valve.forward_voltage - w.voltage[valve.two_pin], size[0], ROUNDING[0])
        };
        let rest = if on { valve.rounding_current } else { 0.0 };
        let noise = rounding * scale + rest + NOTHING;
        may.then_some(Margin { value, noise, scale: scale + NOTHING })
    }

    /// Margins of all valves that conduct by themselves: their guards.
    pub(crate) fn valve_guards(&self, c: &Context, w: &mut Work, g: &mut [f64]) {
        let mut place = 0;
        for island in 0..self.electrics.islands.len() {
            let circuit = &self.electrics.islands[island];
            if circuit.valves.is_empty() || circuit.separate.is_some() {
                continue;
            }
            let conducting = self.conducting(island, c, w);
            let size = self.size_so_far(island, c.d);
            for (bit, index) in circuit.valves.iter().enumerate() {
                if self.is_natural(*index) {
                    let margin = self.margin(island, bit, conducting >> bit & 1 == 1, size, w);
                    g[place] = margin.map_or(CLOSED, |margin| margin.guard());
                    place += 1;
                }
            }
        }
    }

    /// Largest voltage and current of an island now.
    pub(crate) fn size(&self, island: usize, w: &Work) -> [f64; 2] {
        let pins = &self.electrics.islands[island].two_pins;
        let largest = |values: &[f64]| pins.iter().fold(0.0, |m: f64, p| m.max(values[p.index].abs()));
        [largest(&w.voltage), largest(&w.current)]
    }

    /// Largest voltage and current of an island at the events so far: where all currents have ended, they tell what
    /// rounding has left of them.
    pub(crate) fn size_so_far(&self, island: usize, d: &[f64]) -> [f64; 2] {
        let known = self.electrics.islands[island].size.and_then(|at| d.get(at..at + 2));
        known.map_or([0.0; 2], |size| [size[0], size[1]])
    }

    /// The largest so far and now.
    pub(crate) fn size_with(&self, island: usize, d: &[f64], w: &Work) -> [f64; 2] {
        let (so_far, now) = (self.size_so_far(island, d), self.size(island, w));
        [so_far[0].max(now[0]), so_far[1].max(now[1])]
    }

    /// Remembers how large voltages and currents are.
    pub(crate) fn note_size(&self, island: usize, w: &Work, d: &mut [f64]) {
        let size = self.size(island, w);
        let known = self.electrics.islands[island].size.and_then(|at| d.get_mut(at..at + 2));
        known.into_iter().flatten().zip(size).for_each(|(so_far, now)| *so_far = so_far.max(now));
    }
}
