//! Equations of motion in least coordinates.

use super::jet::Jet;
use super::{Bar, Drive, GRAVITY, Joint, Limit, Mechanism};

/// A value for each coordinate, or each joint: the first of them count.
pub(super) type Values = [f64; MOST];
/// Coordinates and joints of a mechanism, at most.
pub(super) const MOST: usize = 4;

/// What holds at a point of the motion: M q'' = f - G' r, where the joints j move with G_j q' and accelerate with
/// G_j q'' + g_j, and r are the dry frictions.
#[derive(Default)]
pub(super) struct Point {
    pub mass: [Values; MOST],
    pub force: Values,
    pub rows: [Values; MOST],
    pub drift: Values,
}

impl Drive {
    /// The torque, of which a controller holds the last one.
    fn at(self, t: f64, held: f64) -> f64 {
        match self {
            Drive::None => 0.0,
            Drive::Sampled { .. } => held,
            Drive::Constant(torque) => torque,
            Drive::Step { time, after } => after * f64::from(t >= time),
            Drive::Sine { amplitude, frequency } => amplitude * (std::f64::consts::TAU * frequency * t).sin(),
        }
    }
}

impl Limit {
    /// Force that pushes back below zero penetration nothing.
    fn push(self, depth: f64, rate: f64) -> f64 {
        if depth <= 0.0 {
            return 0.0;
        }
        let x = (depth / self.width).min(1.0);
        (x * x * (3.0 - 2.0 * x) * (self.stiffness * depth + self.damping * rate)).max(0.0)
    }
}

impl Joint {
    /// Everything but dry friction, at a place and a speed.
    fn force(self, q: f64, w: f64) -> f64 {
        let free = -self.stiffness * (q - self.relaxed) - self.damping * w;
        free + self.limit.map_or(0.0, |limit| limit.push(-limit.at - q, -w) - limit.push(q - limit.at, w))
    }
}

impl Mechanism {
    /// Coordinates and speeds at the start: absolute angles of a chain, the angle of a crank, along and above a plane.
    pub(super) fn start(&self) -> (Vec<f64>, Vec<f64>) {
        match self {
            Mechanism::Chain { start, .. } => {
                let (mut q, mut w) = (Vec::new(), Vec::new());
                let (mut angle, mut speed) = (0.0, 0.0);
                for (a, b) in start {
                    angle += a;
                    speed += b;
                    q.push(angle);
                    w.push(speed);
                }
                (q, w)
            }
            Mechanism::Slider { start, .. } | Mechanism::FourBar { start, .. } => {
                (vec![start.0], vec![start.1])
            }
            Mechanism::Ball { start: [height, along, up], .. } => (vec![0.0, *height], vec![*along, *up]),
        }
    }

    /// Dry frictions of the joints.
    pub(super) fn frictions(&self) -> Vec<f64> {
        let of = |joints: &[Joint]| joints.iter().map(|joint| joint.friction).collect();
        match self {
            Mechanism::Chain { joints, .. } => of(joints),
            Mechanism::Slider { joints, .. } | Mechanism::FourBar { joints, .. } => of(joints),
            Mechanism::Ball { .. } => Vec::new(),
        }
    }

    /// The drive of the first joint.
    pub(super) fn driven(&self) -> Drive {
        match self {
            Mechanism::Chain { drive, .. }
            | Mechanism::Slider { drive, .. }
            | Mechanism::FourBar { drive, .. } => *drive,
            Mechanism::Ball { .. } => Drive::None,
        }
    }

    /// What the joints show: place and speed of each.
    pub(super) fn shown(&self, q: &[f64], w: &[f64]) -> Vec<f64> {
        match self {
            Mechanism::Chain { .. } => {
                let ago = |values: &[f64], i: usize| if i > 0 { values[i - 1] } else { 0.0 };
                (0..q.len()).flat_map(|i| [q[i] - ago(q, i), w[i] - ago(w, i)]).collect()
            }
            Mechanism::Slider { crank, rod, .. } => {
                let x = place(crank, rod, q[0]);
                vec![q[0], w[0], x.0, x.1 * w[0]]
            }
            Mechanism::FourBar { bars, ground, .. } => {
                let (_, rocker) = linkage(bars, *ground, q[0]);
                vec![q[0], w[0], rocker.0, rocker.1 * w[0]]
            }
            Mechanism::Ball { tilt, .. } => {
                let (s, c) = tilt.sin_cos();
                let turned = |v: &[f64]| [c * v[0] + s * v[1], -s * v[0] + c * v[1]];
                let ([x, z], [vx, vz]) = (turned(q), turned(w));
                vec![x, vx, z, vz]
            }
        }
    }

    /// The equations at a time and a place, with what a controller holds.
    pub(super) fn point(&self, t: f64, held: f64, q: &[f64], w: &[f64]) -> Point {
        let torque = self.driven().at(t, held);
        match self {
            Mechanism::Chain { bars, joints, .. } => chain(bars, joints, torque, q, w),
            Mechanism::Slider { crank, rod, piston, joints, .. } => {
                let at = Jet(q[0], 1.0, 0.0);
                let x = place(crank, rod, q[0]);
                let r = Jet::constant(crank.length);
                let (ax, az) = (r * at.cos(), r * at.sin());
                let turn = Jet::angle(-az, x - ax);
                let share = Jet::constant(rod.centre / rod.length);
                let centre = (ax + share * (x - ax), az - share * az);
                let near = Jet::constant(crank.centre);
                let parts = [
                    (crank.mass, crank.inertia, near * at.cos(), near * at.sin(), at),
                    (rod.mass, rod.inertia, centre.0, centre.1, turn),
                    (*piston, 0.0, x, Jet::constant(0.0), Jet::constant(0.0)),
                ];
                turned(&parts, joints, [at, x], torque, w[0])
            }
            Mechanism::FourBar { bars, ground, joints, .. } => {
                let [crank, coupler, rocker] = bars;
                let at = Jet(q[0], 1.0, 0.0);
                let (coupled, swung) = linkage(bars, *ground, q[0]);
                let r = Jet::constant(crank.length);
                let along = |bar: &Bar, turn: Jet| {
                    let far = Jet::constant(bar.centre);
                    (far * turn.cos(), far * turn.sin())
                };
                let (near, far, side) = (along(crank, at), along(coupler, coupled), along(rocker, swung));
                let parts = [
                    (crank.mass, crank.inertia, near.0, near.1, at),
                    (coupler.mass, coupler.inertia, r * at.cos() + far.0, r * at.sin() + far.1, coupled),
                    (rocker.mass, rocker.inertia, Jet::constant(*ground) + side.0, side.1, swung),
                ];
                turned(&parts, joints, [at, swung], torque, w[0])
            }
            Mechanism::Ball { mass, tilt, stiffness, damping, width, friction, slow, .. } => {
                let contact = Limit { at: 0.0, stiffness: *stiffness, damping: *damping, width: *width };
                let push = contact.push(-q[1], -w[1]);
                let (s, c) = tilt.sin_cos();
                let rub = friction * push * (w[0] / slow).tanh();
                let mut point = Point::default();
                (point.mass[0][0], point.mass[1][1]) = (*mass, *mass);
                (point.force[0], point.force[1]) = (mass * GRAVITY * s - rub, push - mass * GRAVITY * c);
                point
            }
        }
    }
}

/// Place of the slider.
fn place(crank: &Bar, rod: &Bar, q: f64) -> Jet {
    let (at, r, l) = (Jet(q, 1.0, 0.0), Jet::constant(crank.length), Jet::constant(rod.length));
    let high = r * at.sin();
    r * at.cos() + (l * l - high * high).sqrt()
}

/// Angles of coupler and rocker, with the knee above.
fn linkage(bars: &[Bar; 3], ground: f64, q: f64) -> (Jet, Jet) {
    let at = Jet(q, 1.0, 0.0);
    let [r, l, p] = bars.map(|bar| Jet::constant(bar.length));
    let (ax, az) = (r * at.cos(), r * at.sin());
    let (dx, dz) = (Jet::constant(ground) - ax, -az);
    let square = dx * dx + dz * dz;
    let along = (l * l - p * p + square).over(Jet::constant(2.0) * square);
    let across = ((l * l).over(square) - along * along).sqrt();
    // From the end of the crank to the knee.
    let (kx, kz) = (along * dx - across * dz, along * dz + across * dx);
    (Jet::angle(kz, kx), Jet::angle(az + kz, ax + kx - Jet::constant(ground)))
}

/// One degree of freedom, from the energies of bodies (mass, inertia, place, angle) as functions of it.
fn turned(
    parts: &[(f64, f64, Jet, Jet, Jet)],
    joints: &[Joint; 2],
    places: [Jet; 2],
    torque: f64,
    w: f64,
) -> Point {
    let (mut inertia, mut slope, mut force) = (0.0, 0.0, torque);
    for (mass, moment, x, z, angle) in parts {
        inertia += mass * (x.1 * x.1 + z.1 * z.1) + moment * angle.1 * angle.1;
        slope += mass * (x.1 * x.2 + z.1 * z.2) + moment * angle.1 * angle.2;
        force -= mass * GRAVITY * z.1;
    }
    for (joint, place) in joints.iter().zip(places) {
        force += place.1 * joint.force(place.0, place.1 * w);
    }
    let mut point = Point::default();
    point.mass[0][0] = inertia;
    point.force[0] = force - slope * w * w;
    for (k, place) in places.iter().enumerate() {
        (point.rows[k][0], point.drift[k]) = (place.1, place.2 * w * w);
    }
    point
}

/// Bars on each other, with absolute angles from straight down.
fn chain(bars: &[Bar], joints: &[Joint], torque: f64, q: &[f64], w: &[f64]) -> Point {
    let n = bars.len();
    let arm = |k: usize, i: usize| if i < k { bars[i].length } else { bars[i].centre };
    let turns: Vec<(f64, f64)> = q.iter().map(|q| q.sin_cos()).collect();
    let Point { mut mass, mut force, mut rows, drift } = Point::default();
    for i in 0..n {
        let (si, ci) = turns[i];
        for (j, (sj, cj)) in turns.iter().enumerate() {
            let moved: f64 = (i.max(j)..n).map(|k| bars[k].mass * arm(k, i) * arm(k, j)).sum();
            mass[i][j] = moved * (ci * cj + si * sj);
            force[i] -= moved * (si * cj - ci * sj) * w[j] * w[j];
        }
        mass[i][i] += bars[i].inertia;
        force[i] -= GRAVITY * si * (i..n).map(|k| bars[k].mass * arm(k, i)).sum::<f64>();
    }
    for i in 0..n {
        rows[i][i] = 1.0;
        let (mut angle, mut speed) = (q[i], w[i]);
        if i > 0 {
            rows[i][i - 1] = -1.0;
            angle -= q[i - 1];
            speed -= w[i - 1];
        }
        let acts = joints[i].force(angle, speed) + if i == 0 { torque } else { 0.0 };
        force[i] += acts;
        if i > 0 {
            force[i - 1] -= acts;
        }
    }
    Point { mass, force, rows, drift }
}
