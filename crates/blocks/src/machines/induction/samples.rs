//! Machines for tests.

pub(crate) use super::complex::complex;
use super::{Base, Cages, Circuit, Machine, Magnetisation};

/// 15 kVA, 220 V, 60 Hz, one pair of poles; 0.25, 0.9, 0.14, 0.41 and 17 ohm.
pub(crate) fn single() -> Circuit {
    let z = 9.68;
    Circuit {
        r_s: 0.25 / z,
        l_ls: 0.9 / z,
        magnetisation: Magnetisation::linear(17.0 / z),
        cages: Cages::Single { r: 0.14 / z, l: 0.41 / z },
        l_0: Some(0.9 / z),
    }
}

/// Base values of [`single`].
pub(crate) fn base() -> Base {
    Base::of(15e3, 220.0, 60.0, 1)
}

/// A machine with a starting cage.
pub(crate) fn double() -> Circuit {
    Circuit {
        r_s: 0.02,
        l_ls: 0.08,
        magnetisation: Magnetisation::linear(2.8),
        cages: Cages::Double { r: [0.018, 0.11], l: [0.16, 0.05], common: 0.0 },
        l_0: None,
    }
}

/// The same whose bars lie below each other in one slot.
pub(crate) fn coupled() -> Circuit {
    let cages = Cages::Double { r: [0.018, 0.11], l: [0.12, 0.01], common: 0.04 };
    Circuit { cages, ..double() }
}

/// Open-circuit curve, current and voltage in per unit.
pub(crate) const CURVE: ([f64; 6], [f64; 6]) =
    ([0.0, 0.2, 0.3, 0.42, 0.6, 1.0], [0.0, 0.6, 0.85, 1.0, 1.12, 1.25]);

/// A circuit with the curve instead of a constant inductance.
pub(crate) fn saturated(circuit: Circuit) -> Circuit {
    let magnetisation = Magnetisation::from_open_circuit(&CURVE.0, &CURVE.1, circuit.l_ls).unwrap();
    Circuit { magnetisation, ..circuit }
}

/// Machines of all sorts, also with circuits that have no leakage.
pub(crate) fn all() -> Vec<Machine> {
    let without = |circuit: Circuit, l_ls: f64, cages: Cages| Circuit { l_ls, cages, ..circuit };
    let stiff_stator = without(single(), 0.0, single().cages);
    let stiff_rotor = without(single(), 0.1, Cages::Single { r: 0.02, l: 0.0 });
    let stiff_cage = without(double(), 0.1, Cages::Double { r: [0.02, 0.1], l: [0.1, 0.0], common: 0.0 });
    let stiff_first = without(double(), 0.1, Cages::Double { r: [0.1, 0.02], l: [0.0, 0.1], common: 0.0 });
    [single(), double(), coupled(), stiff_stator, stiff_rotor, stiff_cage, stiff_first]
        .into_iter()
        .flat_map(|circuit| [saturated(circuit.clone()), circuit])
        .map(|circuit| Machine::new(circuit, base().w))
        .collect()
}

/// Integrates the fluxes in a frame of speed `w` over `steps` steps of `h` with the method of Runge and Kutta (order 4)
/// and hands every state to `each`, which gives voltage, zero sequence and speed of the rotor.
pub(crate) fn integrate(
    machine: &Machine,
    psi: &mut [f64],
    w: f64,
    (h, steps): (f64, usize),
    mut each: impl FnMut(f64, &[f64]) -> (super::Complex, f64, f64),
) {
    let n = psi.len();
    for step in 0..steps {
        let t = h * step as f64;
        let mut total = vec![0.0; n];
        let mut slope = vec![0.0; n];
        for (share, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            let at: Vec<f64> = psi.iter().zip(&slope).map(|(psi, slope)| psi + share * h * slope).collect();
            let (v, v_0, w_r) = each(t + share * h, &at);
            machine.derivatives(&at, v, v_0, w, w_r, &mut slope);
            total.iter_mut().zip(&slope).for_each(|(total, slope)| *total += weight * slope);
        }
        psi.iter_mut().zip(&total).for_each(|(psi, total)| *psi += h / 6.0 * total);
    }
}
