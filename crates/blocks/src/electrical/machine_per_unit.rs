//! The equations of a squirrel-cage machine in per unit.

use std::f64::consts::{SQRT_2, TAU};

use super::asynchronous_machine::{AsynchronousMachine, Connection};

/// Base values and constants of one machine; everything that does not change while it runs.
///
/// The base is that of a machine in delta: `V_base = sqrt(2) V_n` and `I_base = sqrt(2) S_n / (3 V_n)` are
/// peak values of a winding, `Z_base = 3 V_n^2 / S_n`, `T_base = S_n N / w_base`. Fluxes are in units of
/// `V_base / w_base`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerUnit {
    /// Rated angular frequency, rad/s.
    pub w_base: f64,
    /// Peak winding voltage, V.
    pub v_base: f64,
    /// Peak winding current, A.
    pub i_base: f64,
    /// Torque, N*m.
    pub t_base: f64,
    /// Impedance, ohm.
    pub z_base: f64,
    /// Speed in per unit for a speed of the shaft of 1 rad/s.
    pub speed: f64,
    /// Winding voltage in per unit for a peak phase voltage of 1 V.
    pub voltage: f64,
    /// Line current, A, for a winding current of 1 in per unit.
    pub line: f64,
    r_s: f64,
    r_r: f64,
    l_s: f64,
    l_r: f64,
    l_m: f64,
    /// Elements of the inverse inductance matrix: `i_s = g_s psi_s - g_m psi_r`, `i_r = g_r psi_r - g_m
    /// psi_s`.
    g_s: f64,
    g_r: f64,
    g_m: f64,
}

/// A space vector: direct and quadrature component.
pub(super) type Vector = [f64; 2];

impl PerUnit {
    /// From the data of a machine.
    pub(super) fn of(machine: &AsynchronousMachine) -> Self {
        let z_base = 3.0 * machine.rated_voltage.powi(2) / machine.rated_power;
        let w_base = TAU * machine.rated_frequency;
        let v_base = SQRT_2 * machine.rated_voltage;
        let i_base = SQRT_2 * machine.rated_power / (3.0 * machine.rated_voltage);
        let pole_pairs = f64::from(machine.pole_pairs);
        let l_m = machine.x_m / z_base;
        let (l_s, l_r) = (machine.x_ls / z_base + l_m, machine.x_lr / z_base + l_m);
        let determinant = l_s * l_r - l_m * l_m;
        // In delta a winding lies between two lines: its voltage is larger than that of a phase, and a line
        // feeds two.
        let delta = match machine.connection {
            Connection::Delta => 3.0_f64.sqrt(),
            Connection::Wye => 1.0,
        };
        Self {
            w_base,
            v_base,
            i_base,
            t_base: machine.rated_power * pole_pairs / w_base,
            z_base,
            speed: pole_pairs / w_base,
            voltage: delta / v_base,
            line: delta * i_base,
            r_s: machine.r_s / z_base,
            r_r: machine.r_r / z_base,
            l_s,
            l_r,
            l_m,
            g_s: l_r / determinant,
            g_r: l_s / determinant,
            g_m: l_m / determinant,
        }
    }

    /// Stator current for fluxes `psi_ds, psi_qs, psi_dr, psi_qr`.
    #[inline]
    pub(super) fn stator_current(&self, psi: &[f64]) -> Vector {
        [self.g_s * psi[0] - self.g_m * psi[2], self.g_s * psi[1] - self.g_m * psi[3]]
    }

    #[inline]
    fn rotor_current(&self, psi: &[f64]) -> Vector {
        [self.g_r * psi[2] - self.g_m * psi[0], self.g_r * psi[3] - self.g_m * psi[1]]
    }

    /// `T = psi_ds i_qs - psi_qs i_ds`, which is `g_m (psi_qs psi_dr - psi_ds psi_qr)`.
    #[inline]
    pub(super) fn torque(&self, psi: &[f64]) -> f64 {
        self.g_m * (psi[1] * psi[2] - psi[0] * psi[3])
    }

    /// Derivatives of the fluxes, 1/s, in a frame of speed `w`, at a winding voltage and a rotor speed `w_r`.
    ///
    /// `psi_s' = w_base (v - r_s i_s - j w psi_s)`, `psi_r' = -w_base (r_r i_r + j (w - w_r) psi_r)`.
    #[inline]
    pub(super) fn derivatives(&self, psi: &[f64], v: Vector, w: f64, w_r: f64, d_psi: &mut [f64]) {
        let (i_s, i_r) = (self.stator_current(psi), self.rotor_current(psi));
        let slip = w - w_r;
        d_psi[0] = self.w_base * (v[0] - self.r_s * i_s[0] + w * psi[1]);
        d_psi[1] = self.w_base * (v[1] - self.r_s * i_s[1] - w * psi[0]);
        d_psi[2] = self.w_base * (slip * psi[3] - self.r_r * i_r[0]);
        d_psi[3] = self.w_base * (-slip * psi[2] - self.r_r * i_r[1]);
    }

    /// How the stator current changes with the stator voltage: `di_s/dt = w_base inverse (v - internal)`; the internal
    /// voltage and the inverse of the transient inductance.
    #[inline]
    pub(super) fn reluctance(&self, psi: &[f64], w: f64, w_r: f64) -> (Vector, f64) {
        let mut without = [0.0; 4];
        self.derivatives(psi, [0.0; 2], w, w_r, &mut without);
        let [d, q] = self.stator_current(&without).map(|slope| -slope / (self.w_base * self.g_s));
        ([d, q], self.g_s)
    }

    /// Fluxes of the steady state at a winding voltage on the direct axis, in a frame of speed `w`, at a slip
    /// against it: `(r_s + j w l_s) i_s + j w l_m i_r = v`, `j s w l_m i_s + (r_r + j s w l_r) i_r = 0`.
    pub(super) fn steady_state(&self, v: f64, w: f64, slip: f64) -> [f64; 4] {
        let induced = [0.0, slip * w * self.l_m];
        let rotor = [self.r_r, slip * w * self.l_r];
        let back = over(times([0.0, w * self.l_m], induced), rotor);
        let i_s = over([v, 0.0], [self.r_s - back[0], w * self.l_s - back[1]]);
        // Without slip nothing is induced, even if the rotor has no resistance.
        let i_r = if induced[1] == 0.0 { [0.0; 2] } else { over(times([0.0, -induced[1]], i_s), rotor) };
        [
            self.l_s * i_s[0] + self.l_m * i_r[0],
            self.l_s * i_s[1] + self.l_m * i_r[1],
            self.l_r * i_r[0] + self.l_m * i_s[0],
            self.l_r * i_r[1] + self.l_m * i_s[1],
        ]
    }
}

/// Product of two complex numbers.
fn times(a: Vector, b: Vector) -> Vector {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// Quotient of two complex numbers.
fn over(a: Vector, b: Vector) -> Vector {
    let square = b[0] * b[0] + b[1] * b[1];
    let product = times(a, [b[0], -b[1]]);
    [product[0] / square, product[1] / square]
}

/// A space vector turned by an angle, rad.
pub(super) fn turned(v: Vector, angle: f64) -> Vector {
    let (sin, cos) = angle.sin_cos();
    times(v, [cos, sin])
}
