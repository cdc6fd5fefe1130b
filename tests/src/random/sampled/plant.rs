//! Exact motion of a plant: linear between instants, by its exponential series in short pieces.

use super::{Loop, Signal, Stage};

/// States of the surroundings behind those of the plant: integral of the output, what the actuator gives and its slope, a
/// disturbing step, sine and cosine, one.
const AROUND: usize = 7;
const SUM: usize = 0;
const GIVEN: usize = 1;
const SLOPE: usize = 2;
const STEP: usize = 3;
const SINE: usize = 4;
const COSINE: usize = 5;
const ONE: usize = 6;

pub(super) struct Plant<'a> {
    one: &'a Loop,
    pub t: f64,
    z: Vec<f64>,
    /// Where the states of the surroundings begin.
    around: usize,
    /// Matrix of each mode: below, within and above the limits.
    rows: [Vec<Vec<f64>>; 3],
    mode: usize,
    piece: f64,
    /// What a slow actuator goes to.
    target: f64,
    /// Largest absolute values of both outputs.
    pub sizes: [f64; 2],
}

fn states(stages: &[Stage]) -> usize {
    stages.iter().map(|stage| if matches!(stage, Stage::Swing(..)) { 2 } else { 1 }).sum()
}

impl<'a> Plant<'a> {
    pub fn new(one: &'a Loop) -> Self {
        let around = states(&one.first) + states(&one.second);
        let mut z = vec![0.0; around + AROUND];
        z[around + ONE] = 1.0;
        match one.disturbance {
            Signal::Sine { amplitude, .. } => z[around + COSINE] = amplitude,
            Signal::Constant(value) => z[around + STEP] = value,
            Signal::Step { time, after } if time <= 0.0 => z[around + STEP] = after,
            _ => {}
        }
        let rows = [-1.0, 0.0, 1.0].map(|side| matrix(one, side));
        let norm = rows[1].iter().map(|row| row.iter().map(|a| a.abs()).sum::<f64>()).fold(0.0, f64::max);
        let piece = (0.25 / norm).min(0.1 * one.ts);
        Self { one, t: 0.0, z, around, rows, mode: 1, piece, target: 0.0, sizes: [0.0; 2] }
    }

    /// What is measured behind the first half and behind all.
    pub fn outputs(&self) -> [f64; 2] {
        let inner = self.z[last(&self.one.first, 0)];
        let before = states(&self.one.first);
        [inner, if self.one.second.is_empty() { inner } else { self.z[last(&self.one.second, before)] }]
    }

    /// Integral of the output.
    pub fn integral(&self) -> f64 {
        self.z[self.around + SUM]
    }

    /// What the actuator gives.
    pub fn given(&self) -> f64 {
        self.z[self.around + GIVEN]
    }

    /// Lets the actuator give another value, or go there.
    pub fn give(&mut self, value: f64) {
        self.target = value;
        match self.one.rate {
            None => self.z[self.around + GIVEN] = value,
            Some(rate) => {
                let way = value - self.given();
                self.z[self.around + SLOPE] = if way == 0.0 { 0.0 } else { rate * way.signum() };
            }
        }
    }

    /// Goes on to `end`.
    pub fn go(&mut self, end: f64) {
        while self.t < end {
            let mut until = (self.t + self.piece).min(end);
            let (mut arrives, mut steps) = (false, None);
            let slope = self.z[self.around + SLOPE];
            if slope != 0.0 {
                let there = self.t + (self.target - self.given()) / slope;
                if there <= until {
                    (until, arrives) = (there, true);
                }
            }
            if let Signal::Step { time, after } = self.one.disturbance
                && self.t < time
                && time <= until
            {
                (until, steps) = (time, Some(after));
                arrives = arrives && until >= time;
            }
            let moved = self.moved(until - self.t);
            if self.is_in_mode(&moved) {
                self.z = moved;
                self.t = until;
                if arrives {
                    (self.z[self.around + GIVEN], self.z[self.around + SLOPE]) = (self.target, 0.0);
                }
                if let Some(after) = steps {
                    self.z[self.around + STEP] = after;
                }
            } else {
                self.switch(until - self.t);
            }
            let outputs = self.outputs();
            for (size, output) in self.sizes.iter_mut().zip(outputs) {
                *size = size.max(output.abs());
            }
        }
    }

    /// Goes to where the limits are passed and takes the other mode.
    fn switch(&mut self, piece: f64) {
        let (mut before, mut behind) = (0.0, piece);
        while behind - before > 1e-15 * piece.max(self.t) {
            let middle = 0.5 * (before + behind);
            if middle <= before || middle >= behind {
                break;
            }
            if self.is_in_mode(&self.moved(middle)) { before = middle } else { behind = middle }
        }
        self.z = self.moved(behind);
        self.t += behind;
        self.mode = self.fitting(&self.z);
    }

    fn is_in_mode(&self, z: &[f64]) -> bool {
        self.fitting(z) == self.mode
    }

    fn fitting(&self, z: &[f64]) -> usize {
        let Some(limit) = self.one.limit else { return 1 };
        let inner = z[last(&self.one.first, 0)];
        match () {
            () if inner > limit => 2,
            () if inner < -limit => 0,
            () => 1,
        }
    }

    /// The states a little later, by the series of the exponential.
    fn moved(&self, h: f64) -> Vec<f64> {
        let rows = &self.rows[self.mode];
        let (mut sum, mut term) = (self.z.clone(), self.z.clone());
        for k in 1..20 {
            let next = rows.iter().map(|row| row.iter().zip(&term).map(|(a, z)| a * z).sum::<f64>());
            term = next.map(|value| value * h / f64::from(k)).collect();
            sum.iter_mut().zip(&term).for_each(|(sum, term)| *sum += term);
        }
        sum
    }
}

/// Place of the output of a chain of stages that begins at `from`.
fn last(stages: &[Stage], from: usize) -> usize {
    let behind = matches!(stages.last(), Some(Stage::Swing(..)));
    from + states(stages) - if behind { 2 } else { 1 }
}

fn matrix(one: &Loop, side: f64) -> Vec<Vec<f64>> {
    let before = states(&one.first);
    let around = before + states(&one.second);
    let n = around + AROUND;
    let mut a = vec![vec![0.0; n]; n];
    // What goes into a stage is a sum of states.
    let mut input = vec![0.0; n];
    for part in [GIVEN, STEP, SINE] {
        input[around + part] = 1.0;
    }
    chain(&mut a, &one.first, 0, input);
    let mut passed = vec![0.0; n];
    match one.limit.filter(|_| side != 0.0) {
        Some(limit) => passed[around + ONE] = side * limit,
        None => passed[last(&one.first, 0)] = 1.0,
    }
    chain(&mut a, &one.second, before, passed);
    let output = if one.second.is_empty() { last(&one.first, 0) } else { last(&one.second, before) };
    a[around + SUM][output] = 1.0;
    a[around + GIVEN][around + SLOPE] = 1.0;
    if let Signal::Sine { frequency, .. } = one.disturbance {
        let w = std::f64::consts::TAU * frequency;
        (a[around + SINE][around + COSINE], a[around + COSINE][around + SINE]) = (w, -w);
    }
    a
}

fn chain(a: &mut [Vec<f64>], stages: &[Stage], from: usize, mut input: Vec<f64>) {
    let mut at = from;
    for stage in stages {
        match *stage {
            Stage::Integrator(k) => a[at] = input.iter().map(|u| k * u).collect(),
            Stage::Lag(tau) => {
                a[at] = input.iter().map(|u| u / tau).collect();
                a[at][at] -= 1.0 / tau;
            }
            // The second state is the speed over the frequency.
            Stage::Swing(w, d) => {
                a[at][at + 1] = w;
                a[at + 1] = input.iter().map(|u| w * u).collect();
                a[at + 1][at] -= w;
                a[at + 1][at + 1] -= 2.0 * d * w;
            }
        }
        input.fill(0.0);
        input[at] = 1.0;
        at += if matches!(stage, Stage::Swing(..)) { 2 } else { 1 };
    }
}
