//! Motion in short equal steps. Friction that slides has a sign that stands still during a step; friction that sticks is what
//! keeps its joint from moving, and both change where bisection says.

use super::super::changes::{certain, doubt};
use super::super::dice::Dice;
use super::super::puzzle::Undecided;
use super::plant::{MOST, Point, Values};
use super::{Drive, Mechanism};

/// Steps of the coarse run at the least effort, and by how much there are more at the next.
const STEPS: usize = 2_500;
const FINER: usize = 4;
/// Long steps are believed where both runs differ by no more than this part of the slack. Shorter ones may widen it.
const AGREES: f64 = 0.05;
/// Forces and speeds at the start are changed by this part to see what depends on them.
const CHANGE: f64 = 1e-5;

/// A joint is on the other side of zero, or has turned round, from this part of the largest value on, and where it stays there for this
/// part of the run.
const BAND: f64 = 0.02;
const MOMENT: f64 = 1e-3;

/// Places and speeds of the joints in the end.
#[derive(Clone)]
pub struct Ends {
    pub values: Vec<f64>,
    /// By how much they may be off.
    pub slack: Vec<f64>,
    /// How often the sign of each changes; `None` where that is not known.
    pub changes: Vec<Option<u32>>,
    sizes: Vec<f64>,
    stop: f64,
}

impl Ends {
    /// How far beyond zero value `k` must be to count, and for how long, s.
    pub fn least(&self, k: usize) -> (f64, f64) {
        (BAND * self.sizes[k], MOMENT * self.stop)
    }

    /// The same with more slack, as part of the size of the motion.
    pub fn at_least(mut self, slack: f64) -> Ends {
        self.slack.iter_mut().zip(&self.sizes).for_each(|(own, size)| *own = own.max(slack * (size + 1e-3)));
        self
    }
}

/// What comes out, or why nobody knows.
pub(super) fn refer(
    one: &Mechanism,
    stop: f64,
    slack: f64,
    effort: u32,
    change: f64,
) -> Result<Ends, Undecided> {
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
    let mut sharp = fine.clone();
    widen(&mut sharp, &fine, &coarse, 2.0);
    doubt(&mut sharp.changes, &coarse.changes);
    let mut differences = fine.values.iter().zip(&coarse.values).map(|(a, b)| (a - b).abs());
    let agrees = differences.by_ref().zip(&fine.slack).all(|(off, slack)| off <= AGREES * slack);
    if !known(&sharp) || effort == 0 && !agrees {
        return Err(Undecided::Coarse);
    }
    for seed in [1, 2] {
        let mut dice = Dice::new(seed);
        let changes = std::array::from_fn(|_| 1.0 + change * CHANGE * (2.0 * dice.unit() - 1.0));
        let other = Walk::new(one, changes).finish(stop, steps).map_err(|_| Undecided::Sensitive)?;
        widen(&mut sharp, &coarse, &other, 5.0);
        doubt(&mut sharp.changes, &other.changes);
    }
    if known(&sharp) { Ok(sharp) } else { Err(Undecided::Sensitive) }
}

struct Walk<'a> {
    one: &'a Mechanism,
    /// Numbers of coordinates and of joints.
    n: usize,
    joints: usize,
    frictions: Values,
    /// Changes of forces other than friction, of frictions, of speeds at the start.
    changes: [f64; 3],
    /// Sign of the sliding of each joint; zero sticks.
    signs: Values,
    /// What a controller holds, and the number of its next sample.
    held: f64,
    samples: u32,
    t: f64,
    q: Values,
    w: Values,
}

fn padded(values: &[f64]) -> Values {
    std::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0))
}

fn dot(a: &Values, b: &Values) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl<'a> Walk<'a> {
    fn new(one: &'a Mechanism, changes: [f64; 3]) -> Self {
        let (q, w) = one.start();
        let frictions = one.frictions();
        let mut walk = Walk {
            one,
            n: q.len(),
            joints: frictions.len(),
            signs: [0.0; MOST],
            frictions: padded(&frictions).map(|force| changes[1] * force),
            changes,
            held: 0.0,
            samples: 0,
            t: 0.0,
            q: padded(&q),
            w: padded(&w).map(|w| changes[2] * w),
        };
        walk.signs = walk.speeds(&walk.here(), &walk.w).map(|w| if w == 0.0 { 0.0 } else { w.signum() });
        walk.plan();
        walk.choose();
        walk
    }

    /// Takes a sample where one is due; returns when the torque jumps next.
    fn plan(&mut self) -> f64 {
        match self.one.driven() {
            Drive::Step { time, .. } if time > self.t + 1e-12 => time,
            Drive::Sampled { ts, target, kp, kd, limit } => {
                if f64::from(self.samples) * ts <= self.t + 1e-12 {
                    self.held = (kp * (target - self.q[0]) - kd * self.w[0]).clamp(-limit, limit);
                    self.samples += 1;
                }
                f64::from(self.samples) * ts
            }
            _ => f64::INFINITY,
        }
    }

    fn finish(mut self, stop: f64, steps: usize) -> Result<Ends, Undecided> {
        let h = stop / steps as f64;
        let mut sizes = vec![0.0_f64; self.shown().len()];
        let (mut times, mut way) = (Vec::new(), vec![Vec::new(); sizes.len()]);
        let mut changes = 0;
        let mut jump = self.plan();
        while self.t < stop - 1e-9 * h {
            let grid = ((self.t / h + 1e-6).floor() + 1.0) * h;
            let end = grid.min(jump);
            let (q, w) = self.moved(end - self.t);
            if !self.contradicts(end, &q, &w) {
                (self.t, self.q, self.w) = (end, q, w);
                if end == jump {
                    jump = self.plan();
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
                let before = self.speeds(&self.here(), &self.w);
                (self.t, self.q, self.w) = (self.t + far, q, w);
                let now = self.speeds(&self.here(), &self.w);
                for (k, sign) in self.signs.iter_mut().enumerate() {
                    // What has turned round may stick.
                    if *sign != 0.0 && *sign * now[k] <= 0.0 && (*sign * before[k] > 0.0 || now[k] == 0.0) {
                        *sign = 0.0;
                    }
                }
                if self.t >= jump {
                    jump = self.plan();
                }
                self.choose();
            }
            let shown = self.shown();
            times.push(self.t);
            for ((size, way), value) in sizes.iter_mut().zip(&mut way).zip(&shown) {
                *size = size.max(value.abs());
                way.push(*value);
            }
            if !shown.iter().all(|value| value.abs() < 1e4) {
                return Err(Undecided::Grows);
            }
        }
        // A place is known no better than what a speed does to it.
        let mut ends =
            Ends { values: self.shown(), slack: vec![0.0; sizes.len()], changes: Vec::new(), sizes, stop };
        for (k, way) in way.iter().enumerate() {
            ends.changes.push(certain(&times, way, ends.least(k)));
        }
        Ok(ends)
    }

    fn shown(&self) -> Vec<f64> {
        self.one.shown(&self.q[..self.n], &self.w[..self.n])
    }

    /// Speeds of the joints with friction.
    fn speeds(&self, point: &Point, w: &Values) -> Values {
        std::array::from_fn(|k| if k < self.joints { dot(&point.rows[k], w) } else { 0.0 })
    }

    fn here(&self) -> Point {
        self.point(self.t, &self.q, &self.w)
    }

    fn point(&self, t: f64, q: &Values, w: &Values) -> Point {
        let mut point = self.one.point(t, self.held, &q[..self.n], &w[..self.n]);
        point.force.iter_mut().for_each(|force| *force *= self.changes[0]);
        point
    }

    /// Accelerations, and what friction each joint bears. What sticks stays as it is, within `bounds` if those are asked for.
    fn solve(&self, point: &Point, bounded: bool) -> (Values, Values) {
        let factor = Factor::of(&point.mass, self.n);
        let columns = point.rows.map(|row| factor.solve(&row));
        let mut borne: Values = std::array::from_fn(|k| self.signs[k] * self.frictions[k]);
        let mut a = factor.solve(&point.force);
        let push = |a: &mut Values, k: usize, force: f64| {
            a.iter_mut().zip(&columns[k]).for_each(|(a, c)| *a -= force * c);
        };
        (0..self.joints).for_each(|k| push(&mut a, k, borne[k]));
        let sticks = |k: usize| k < self.joints && self.signs[k] == 0.0 && self.frictions[k] != 0.0;
        if !(0..self.joints).any(sticks) {
            return (a, borne);
        }
        // Where each can hold what it has to, that is all; where some cannot, they share what there is within their bounds.
        let moves = |a: &Values, k: usize| dot(&point.rows[k], a) + point.drift[k];
        let held = hold(point, &columns, std::array::from_fn(|k| sticks(k).then(|| moves(&a, k))));
        if !bounded || (0..self.joints).all(|k| !sticks(k) || held[k].abs() < self.frictions[k]) {
            for k in (0..self.joints).filter(|k| sticks(*k)) {
                borne[k] = held[k];
                push(&mut a, k, held[k]);
            }
            return (a, borne);
        }
        for _ in 0..5000 {
            let mut most = 0.0_f64;
            for k in (0..self.joints).filter(|k| sticks(*k)) {
                let ease = dot(&point.rows[k], &columns[k]);
                let limit = self.frictions[k];
                let next = (borne[k] + moves(&a, k) / ease.max(1e-12)).clamp(-limit, limit);
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
        let point = self.here();
        let (a, borne) = self.solve(&point, true);
        for (k, borne) in borne.iter().enumerate().take(self.joints) {
            let moves = dot(&point.rows[k], &a) + point.drift[k];
            // Of several that hold the same, one may bear all that it can and not move.
            if self.signs[k] == 0.0 && (self.frictions[k] == 0.0 || self.yields(k, *borne, moves)) {
                self.signs[k] = if moves == 0.0 { borne.signum() } else { moves.signum() };
            }
        }
    }

    /// Whether at a point a joint slides against its sign, or one that sticks bears too much.
    fn contradicts(&self, t: f64, q: &Values, w: &Values) -> bool {
        if self.frictions.iter().all(|force| *force == 0.0) {
            return false;
        }
        let point = self.point(t, q, w);
        let speeds = self.speeds(&point, w);
        let turned = (0..self.joints).any(|k| self.frictions[k] != 0.0 && self.signs[k] * speeds[k] < 0.0);
        let sticks = (0..self.joints).any(|k| self.signs[k] == 0.0 && self.frictions[k] > 0.0);
        if turned || !sticks {
            return turned;
        }
        // Where several hold the same, they share within their bounds; too much is what then still moves.
        let (a, borne) = self.solve(&point, true);
        (0..self.joints).any(|k| {
            let moves = dot(&point.rows[k], &a) + point.drift[k];
            self.signs[k] == 0.0 && self.yields(k, borne[k], moves)
        })
    }

    /// Whether a joint moves though it bears all that it can.
    fn yields(&self, k: usize, borne: f64, moves: f64) -> bool {
        borne.abs() >= self.frictions[k] && borne * moves > 1e-9
    }

    /// Places and speeds a little later, by the classical Runge-Kutta method.
    fn moved(&self, h: f64) -> (Values, Values) {
        let slope = |share: f64, before: Option<&(Values, Values)>| -> (Values, Values) {
            let at = |from: &Values, k: Option<&Values>| -> Values {
                std::array::from_fn(|i| from[i] + k.map_or(0.0, |k| share * h * k[i]))
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
        let sum = |from: &Values, k: [&Values; 4]| -> Values {
            std::array::from_fn(|i| from[i] + h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]))
        };
        (sum(&self.q, [&k1.0, &k2.0, &k3.0, &k4.0]), sum(&self.w, [&k1.1, &k2.1, &k3.1, &k4.1]))
    }
}

/// The frictions that keep joints from moving, from what they would accelerate with without; nothing of the others. Where one holds
/// what others hold already, it bears nothing.
fn hold(point: &Point, columns: &[Values; MOST], moves: [Option<f64>; MOST]) -> Values {
    let sticks: Vec<usize> = (0..MOST).filter(|k| moves[*k].is_some()).collect();
    let mut rows: Vec<(usize, Values, f64)> = Vec::new();
    for &k in &sticks {
        // Row k of the effect of all on all, less what the rows before it say.
        let mut row: Values = std::array::from_fn(|j| dot(&point.rows[k], &columns[j]));
        let (mut right, whole) = (moves[k].unwrap_or(0.0), row[k]);
        for (pivot, above, value) in &rows {
            let factor = row[*pivot] / above[*pivot];
            row.iter_mut().zip(above).for_each(|(row, above)| *row -= factor * above);
            right -= factor * value;
        }
        if row[k] > 1e-10 * whole {
            rows.push((k, row, right));
        }
    }
    let mut borne = [0.0; MOST];
    for (pivot, row, right) in rows.iter().rev() {
        let later: f64 = rows.iter().filter(|(k, ..)| k > pivot).map(|(k, ..)| row[*k] * borne[*k]).sum();
        borne[*pivot] = (right - later) / row[*pivot];
    }
    borne
}

/// A positive definite matrix as L D L'.
struct Factor {
    n: usize,
    lower: [Values; MOST],
}

impl Factor {
    fn of(matrix: &[Values; MOST], n: usize) -> Factor {
        let mut lower = *matrix;
        for j in 0..n {
            for k in 0..j {
                lower[j][j] -= lower[j][k] * lower[j][k] * lower[k][k];
            }
            for i in j + 1..n {
                for k in 0..j {
                    lower[i][j] -= lower[i][k] * lower[j][k] * lower[k][k];
                }
                lower[i][j] /= lower[j][j];
            }
        }
        Factor { n, lower }
    }

    fn solve(&self, right: &Values) -> Values {
        let mut x = *right;
        for i in 0..self.n {
            for k in 0..i {
                x[i] -= self.lower[i][k] * x[k];
            }
        }
        for i in (0..self.n).rev() {
            x[i] /= self.lower[i][i];
            for k in i + 1..self.n {
                x[i] -= self.lower[k][i] * x[k];
            }
        }
        x
    }
}
