//! A memory of the past of a signal, jumps included, in a fixed number of cells.

use super::units::element;

/// Number of cells; each holds the signal at one instant.
pub(crate) const CELLS: usize = 3072;

/// How many cells at most are taken in a time of one spacing: one, and two more for a jump.
pub(crate) const CELLS_PER_SPACING: usize = 3;

/// Discrete states before the cells.
const HEAD: usize = 0;
const COUNT: usize = 1;
const START: usize = 2;
const LAST_JUMP: usize = 3;
const BEFORE: usize = 4;

/// How many discrete states the memory of `n` elements takes. All are zero while nothing is known.
pub(crate) const fn size(n: usize) -> usize {
    BEFORE + CELLS * (1 + n)
}

/// A view of discrete states as a ring: next cell to write, number of cells in use, time of the first instant, time of
/// the last jump; then the cells, each with its time and `n` values. Times do not fall; two cells of the same time are a
/// jump.
#[derive(Clone, Copy)]
pub(crate) struct Ring<'a> {
    d: &'a [f64],
    n: usize,
}

impl<'a> Ring<'a> {
    pub(crate) fn new(d: &'a [f64], n: usize) -> Self {
        Self { d, n }
    }

    fn count(&self) -> usize {
        self.d[COUNT] as usize
    }

    /// Place in `d` of the `age`-th cell, oldest first.
    fn place(&self, age: usize) -> usize {
        let cell = (self.d[HEAD] as usize + CELLS - self.count() + age) % CELLS;
        BEFORE + cell * (1 + self.n)
    }

    fn time(&self, age: usize) -> f64 {
        self.d[self.place(age)]
    }

    fn values(&self, age: usize) -> &'a [f64] {
        let place = self.place(age);
        &self.d[place + 1..=place + self.n]
    }

    /// Whether this cell is the later one of a jump.
    fn is_jump(&self, age: usize) -> bool {
        age > 0 && self.time(age) == self.time(age - 1)
    }

    /// How many cells, moved by `delay`, lie at or before `t`.
    fn passed(&self, t: f64, delay: f64) -> usize {
        let (mut low, mut high) = (0, self.count());
        while low < high {
            let middle = (low + high) / 2;
            if self.time(middle) + delay <= t { low = middle + 1 } else { high = middle }
        }
        low
    }

    /// When the moved signal jumps for the first time after `t`; its start counts as a jump.
    pub(crate) fn next_jump(&self, t: f64, delay: f64) -> f64 {
        if self.count() == 0 {
            return f64::INFINITY;
        }
        if self.d[START] + delay > t {
            return self.d[START] + delay;
        }
        if self.d[LAST_JUMP] + delay <= t {
            return f64::INFINITY;
        }
        let jump = (self.passed(t, delay)..self.count()).find(|age| self.is_jump(*age));
        jump.map_or(f64::INFINITY, |age| self.time(age) + delay)
    }

    /// The signal, moved by `delay`, at `t`: linearly between cells, constant after the last. At a jump that lies after
    /// `known` it is the value before. False if there is nothing yet.
    pub(crate) fn read(&self, t: f64, delay: f64, known: f64, y: &mut [f64]) -> bool {
        let passed = self.passed(t, delay);
        if passed == 0 || self.d[START] + delay > known {
            return false;
        }
        let before = passed - 1;
        if self.is_jump(before) && self.time(before) + delay > known {
            y.copy_from_slice(self.values(before - 1));
            return true;
        }
        let after = passed.min(self.count() - 1);
        let (t0, t1) = (self.time(before), self.time(after));
        let share = if t1 > t0 { ((t - (t0 + delay)) / (t1 - t0)).clamp(0.0, 1.0) } else { 0.0 };
        for ((y, from), to) in y.iter_mut().zip(self.values(before)).zip(self.values(after)) {
            *y = from + share * (to - from);
        }
        true
    }
}

/// Notes the signal at an instant; twice at the same instant with another value is a jump.
///
/// However small the steps are, the ring covers `CELLS / CELLS_PER_SPACING` spacings but for a few: instants closer
/// than `spacing` to the one before the newest replace the newest, and jumps closer than that to the last jump are
/// noted with their later value alone.
pub(crate) fn note(d: &mut [f64], t: f64, u: &[f64], n: usize, spacing: f64) {
    let ring = Ring::new(d, n);
    let count = ring.count();
    let newest = count.checked_sub(1).map(|age| (ring.place(age), ring.time(age)));
    let mut jumps = false;
    let replaced = match newest {
        None => None,
        Some((place, time)) if time >= t => {
            let same = (0..n).all(|i| d[place + 1 + i] == element(u, i));
            let first = count == 1;
            jumps = !same && !first && !ring.is_jump(count - 1) && t - d[LAST_JUMP] >= spacing;
            (!jumps).then_some(place)
        }
        Some((place, time)) => {
            let provisional = count > 1 && time - ring.time(count - 2) < spacing && d[LAST_JUMP] != time;
            provisional.then_some(place)
        }
    };
    if count == 0 {
        d[START] = t;
        d[LAST_JUMP] = t;
    }
    if jumps {
        d[LAST_JUMP] = t;
    }
    let place = replaced.unwrap_or(BEFORE + d[HEAD] as usize * (1 + n));
    if replaced.is_none() {
        d[HEAD] = ((d[HEAD] as usize + 1) % CELLS) as f64;
        d[COUNT] = (count + 1).min(CELLS) as f64;
    }
    d[place] = t;
    for (i, value) in d[place + 1..=place + n].iter_mut().enumerate() {
        *value = element(u, i);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(d: &[f64], t: f64, known: f64) -> f64 {
        let mut y = [f64::NAN];
        Ring::new(d, 1).read(t, 0.0, known, &mut y);
        y[0]
    }

    #[test]
    fn the_ring_covers_a_thousand_spacings_however_small_the_steps_and_however_many_the_jumps() {
        for step in [1e-5, 3.3e-4, 1e-3, 1.7e-3] {
            for jump in [0.0, 1e-3] {
                let mut d = vec![0.0; size(1)];
                let mut t = 0.0;
                while t < 2.5 {
                    note(&mut d, t, &[t], 1, 1e-3);
                    note(&mut d, t, &[t + jump], 1, 1e-3);
                    t += step;
                }
                let ring = Ring::new(&d, 1);
                let (oldest, newest) = (ring.time(0), ring.time(ring.count() - 1));
                assert!(newest - oldest >= 1.0, "step {step}: {}", newest - oldest);
                assert!((read(&d, newest - 1.0, newest) - (newest - 1.0)).abs() <= jump + 1e-12);
            }
        }
    }

    #[test]
    fn a_jump_is_kept_with_both_values() {
        let mut d = vec![0.0; size(1)];
        for (t, u) in [(0.0, 0.0), (1.0, 1.0), (1.0, 5.0), (2.0, 5.0)] {
            note(&mut d, t, &[u], 1, 0.1);
        }
        assert_eq!(read(&d, 0.75, 9.0), 0.75);
        assert_eq!(read(&d, 1.0, 0.75), 1.0);
        assert_eq!(read(&d, 1.0, 1.0), 5.0);
        assert_eq!(read(&d, 1.5, 1.0), 5.0);
        let ring = Ring::new(&d, 1);
        let jumps = [-1.0, 0.0, 1.0].map(|t| ring.next_jump(t, 0.0));
        assert_eq!(jumps, [0.0, 1.0, f64::INFINITY]);
    }

    #[test]
    fn the_first_instant_keeps_its_last_value() {
        let mut d = vec![0.0; size(2)];
        note(&mut d, 1.0, &[1.0, 2.0], 2, 0.1);
        note(&mut d, 1.0, &[3.0, 4.0], 2, 0.1);
        let mut y = [0.0; 2];
        assert!(Ring::new(&d, 2).read(1.0, 0.0, 1.0, &mut y));
        assert_eq!((y, Ring::new(&d, 2).count()), ([3.0, 4.0], 1));
    }
}
