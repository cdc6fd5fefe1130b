//! Motion in short equal steps. Friction that slides has a sign that stands still during a step; friction that sticks is what
//! keeps its joint from moving, and both change where bisection says.

use super::super::dice::Dice;
use super::super::puzzle::Undecided;
use super::Mechanism;
use super::plant::Point;

/// Steps of the coarse run at the least effort, and by how much there are more at the next.
const STEPS: usize = 10_000;
const FINER: usize = 4;
/// Forces and speeds at the start are changed by this part to see what depends on them.
const CHANGE: f64 = 1e-5;

/// Places and speeds of the joints in the end.
pub struct Ends {
    pub values: Vec<f64>,
    /// By how much they may be off.
    pub slack: Vec<f64>,
    sizes: Vec<f64>,
}

impl Ends {
    /// The same with more slack, as part of the size of the motion.
    pub fn at_least(mut self, slack: f64) -> Ends {
        self.slack.iter_mut().zip(&self.sizes).for_each(|(own, size)| *own = own.max(slack * (size + 1e-3)));
        self
    }
}

/// What comes out, or why nobody knows.
pub(super) fn refer(one: &Mechanism, stop: f64, slack: f64, effort: u32) -> Result<Ends, Undecided> {
    let steps = STEPS * FINER.pow(effort);
    let exact = [1.0; 3];
    let coarse = Walk::new(one, exact).finish(stop, steps)?;
    let mut fine = Walk::new(one, exact).finish(stop, 2 * steps)?;
    let widen = |fine: &mut Ends, a: &Ends, b: &Ends, factor: f64| {
        for k in 0..fine.slack.len() {
            fine.slack[k] = fine.slack[k].max(factor * (a.values[k] - b.values[k]).abs());
        }
    };
    fine.slack = fine.sizes.iter().map(|size| slack * (size + 1e-3)).collect();
    let allowed: Vec<f64> = fine.slack.iter().map(|slack| 5.0 * slack).collect();
    let known = |ends: &Ends| ends.slack.iter().zip(&allowed).all(|(slack, allowed)| slack <= allowed);
    let mut sharp =
        Ends { values: fine.values.clone(), slack: fine.slack.clone(), sizes: fine.sizes.clone() };
    widen(&mut sharp, &fine, &coarse, 2.0);
    if !known(&sharp) {
        return Err(Undecided::Coarse);
    }
    for seed in [1, 2] {
        let mut dice = Dice::new(seed);
        let changes = std::array::from_fn(|_| 1.0 + CHANGE * (2.0 * dice.unit() - 1.0));
        let other = Walk::new(one, changes).finish(stop, steps).map_err(|_| Undecided::Sensitive)?;
        widen(&mut sharp, &coarse, &other, 5.0);
    }
    if known(&sharp) { Ok(sharp) } else { Err(Undecided::Sensitive) }
}

struct Walk<'a> {
    one: &'a Mechanism,
    frictions: Vec<f64>,
    /// Changes of forces other than friction, of frictions, of speeds at the start.
    changes: [f64; 3],
    /// Sign of the sliding of each joint; zero sticks.
    signs: Vec<f64>,
    t: f64,
    q: Vec<f64>,
    w: Vec<f64>,
}

impl<'a> Walk<'a> {
    fn new(one: &'a Mechanism, changes: [f64; 3]) -> Self {
        let (q, mut w) = one.start();
        w.iter_mut().for_each(|w| *w *= changes[2]);
        let frictions: Vec<f64> = one.frictions().iter().map(|force| changes[1] * force).collect();
        let mut walk = Walk { one, signs: vec![0.0; frictions.len()], frictions, changes, t: 0.0, q, w };
        let speeds = walk.speeds();
        walk.signs = speeds.iter().map(|w| if *w == 0.0 { 0.0 } else { w.signum() }).collect();
        walk.choose();
        walk
    }

    fn finish(mut self, stop: f64, steps: usize) -> Result<Ends, Undecided> {
        let h = stop / steps as f64;
        let mut sizes = vec![0.0_f64; self.one.shown(&self.q, &self.w).len()];
        let mut changes = 0;
        let jump = self.one.jump().unwrap_or(f64::INFINITY);
        while self.t < stop - 1e-9 * h {
            let grid = ((self.t / h + 1e-6).floor() + 1.0) * h;
            let end = if jump > self.t + 1e-12 { grid.min(jump) } else { grid };
            let (q, w) = self.moved(end - self.t);
            if !self.contradicts(end, &q, &w) {
                (self.t, self.q, self.w) = (end, q, w);
                if end == jump {
                    self.choose();
                }
            } else {
                changes += 1;
                if changes > 2000 {
                    return Err(Undecided::Chatters);
                }
                let (mut near, mut far) = (0.0, end - self.t);
                while far - near > 1e-13 {
                    let middle = 0.5 * (near + far);
                    let (q, w) = self.moved(middle);
                    if self.contradicts(self.t + middle, &q, &w) { far = middle } else { near = middle }
                }
                let (q, w) = self.moved(far);
                let before = self.speeds();
                (self.t, self.q, self.w) = (self.t + far, q, w);
                let now = self.speeds();
                for (k, sign) in self.signs.iter_mut().enumerate() {
                    // What has turned round may stick.
                    if *sign != 0.0 && *sign * now[k] <= 0.0 && (*sign * before[k] > 0.0 || now[k] == 0.0) {
                        *sign = 0.0;
                    }
                }
                self.choose();
            }
            let shown = self.one.shown(&self.q, &self.w);
            for (size, value) in sizes.iter_mut().zip(&shown) {
                *size = size.max(value.abs());
            }
            if !shown.iter().all(|value| value.abs() < 1e4) {
                return Err(Undecided::Grows);
            }
        }
        // A place is known no better than what a speed does to it.
        Ok(Ends { values: self.one.shown(&self.q, &self.w), slack: vec![0.0; sizes.len()], sizes })
    }

    /// Speeds of the joints with friction.
    fn speeds(&self) -> Vec<f64> {
        let rows = self.one.point(self.t, &self.q, &self.w).rows;
        let speed = |row: &Vec<f64>| row.iter().zip(&self.w).map(|(a, w)| a * w).sum::<f64>();
        rows.iter().take(self.frictions.len()).map(speed).collect()
    }

    fn point(&self, t: f64, q: &[f64], w: &[f64]) -> Point {
        let mut point = self.one.point(t, q, w);
        point.force.iter_mut().for_each(|force| *force *= self.changes[0]);
        point
    }

    /// Accelerations, and what friction each joint bears. What sticks stays as it is, within `bounds` if those are asked for.
    fn solve(&self, point: &Point, bounded: bool) -> (Vec<f64>, Vec<f64>) {
        let mut borne: Vec<f64> = self.signs.iter().zip(&self.frictions).map(|(sign, f)| sign * f).collect();
        let columns: Vec<Vec<f64>> = point.rows.iter().map(|row| linear(&point.mass, row)).collect();
        let mut a = linear(&point.mass, &point.force);
        let push = |a: &mut Vec<f64>, k: usize, force: f64| {
            a.iter_mut().zip(&columns[k]).for_each(|(a, c)| *a -= force * c);
        };
        borne.iter().enumerate().for_each(|(k, force)| push(&mut a, k, *force));
        for _ in 0..5000 {
            let mut most = 0.0_f64;
            for k in 0..borne.len() {
                if self.signs[k] != 0.0 || self.frictions[k] == 0.0 {
                    continue;
                }
                let row = &point.rows[k];
                let dot = |b: &[f64]| row.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                let (moves, ease) = (dot(&a) + point.drift[k], dot(&columns[k]));
                let limit = if bounded { self.frictions[k] } else { 1e3 * self.frictions[k] };
                let next = (borne[k] + moves / ease.max(1e-12)).clamp(-limit, limit);
                let change = next - borne[k];
                borne[k] = next;
                push(&mut a, k, change);
                most = most.max(change.abs() / self.frictions[k]);
            }
            if most < 1e-13 {
                break;
            }
        }
        (a, borne)
    }

    /// Which of the joints that stand begin to slide.
    fn choose(&mut self) {
        let point = self.point(self.t, &self.q, &self.w);
        let (a, borne) = self.solve(&point, true);
        for (k, sign) in self.signs.iter_mut().enumerate() {
            if *sign == 0.0 && (self.frictions[k] == 0.0 || borne[k].abs() >= self.frictions[k]) {
                let moves = point.rows[k].iter().zip(&a).map(|(a, b)| a * b).sum::<f64>() + point.drift[k];
                *sign = if moves == 0.0 { borne[k].signum() } else { moves.signum() };
            }
        }
    }

    /// Whether at a point a joint slides against its sign, or one that sticks bears too much.
    fn contradicts(&self, t: f64, q: &[f64], w: &[f64]) -> bool {
        if self.frictions.iter().all(|force| *force == 0.0) {
            return false;
        }
        let point = self.point(t, q, w);
        let turned = (0..self.signs.len()).any(|k| {
            let speed: f64 = point.rows[k].iter().zip(w).map(|(a, w)| a * w).sum();
            self.frictions[k] != 0.0 && self.signs[k] * speed < 0.0
        });
        if turned || !self.sticks() {
            return turned;
        }
        // Where several hold the same, they share within their bounds; too much is what then still moves.
        let (a, borne) = self.solve(&point, true);
        (0..self.signs.len()).any(|k| {
            let moves = point.rows[k].iter().zip(&a).map(|(a, b)| a * b).sum::<f64>() + point.drift[k];
            self.signs[k] == 0.0 && borne[k].abs() >= self.frictions[k] && borne[k] * moves > 1e-9
        })
    }

    fn sticks(&self) -> bool {
        self.signs.iter().zip(&self.frictions).any(|(sign, force)| *sign == 0.0 && *force > 0.0)
    }

    /// Places and speeds a little later, by the classical Runge-Kutta method.
    fn moved(&self, h: f64) -> (Vec<f64>, Vec<f64>) {
        let n = self.q.len();
        let slope = |share: f64, before: Option<&(Vec<f64>, Vec<f64>)>| {
            let at = |from: &[f64], k: Option<&Vec<f64>>| -> Vec<f64> {
                (0..n).map(|i| from[i] + k.map_or(0.0, |k| share * h * k[i])).collect()
            };
            let q = at(&self.q, before.map(|k| &k.0));
            let w = at(&self.w, before.map(|k| &k.1));
            // At its very start and end a step sees what holds within.
            let t = self.t + (share * h).clamp(1e-9 * h, (1.0 - 1e-9) * h);
            let (a, _) = self.solve(&self.point(t, &q, &w), false);
            (w, a)
        };
        let k1 = slope(0.0, None);
        let k2 = slope(0.5, Some(&k1));
        let k3 = slope(0.5, Some(&k2));
        let k4 = slope(1.0, Some(&k3));
        let sum = |from: &[f64], k: [&Vec<f64>; 4]| -> Vec<f64> {
            (0..n).map(|i| from[i] + h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i])).collect()
        };
        (sum(&self.q, [&k1.0, &k2.0, &k3.0, &k4.0]), sum(&self.w, [&k1.1, &k2.1, &k3.1, &k4.1]))
    }
}

/// Solves a few linear equations by elimination; the matrix is positive definite.
fn linear(matrix: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let n = right.len();
    let (mut a, mut x) = (matrix.to_vec(), right.to_vec());
    for i in 0..n {
        for j in i + 1..n {
            let factor = a[j][i] / a[i][i];
            let upper = a[i].clone();
            a[j].iter_mut().zip(&upper).skip(i).for_each(|(below, above)| *below -= factor * above);
            x[j] -= factor * x[i];
        }
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            x[i] -= a[i][k] * x[k];
        }
        x[i] /= a[i][i];
    }
    x
}
