//! What stuck parts say of the speeds, solved exactly.
//!
//! The constraints of stuck parts have constant coefficients, so some speeds follow from the others. Accelerations
//! that obey up to rounding are made to obey in every bit where the coefficients are ones and zeros: what is stuck does
//! not creep.

use crate::assembly::eliminate::Form;

/// Coefficients below this, relative to the largest of their row, count as zero.
const ZERO: f64 = 1e-11;

/// Speeds that follow from others while some parts are stuck: `z_p = sum over k of c_pk z_k + sum of e_pj s_j`.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lock {
    speeds: usize,
    width: usize,
    /// The stuck parts that it was made for.
    stuck: Vec<usize>,
    pivots: Vec<usize>,
    rows: Vec<f64>,
}

impl Lock {
    /// Room for `capacity` stuck parts.
    pub(crate) fn new(speeds: usize, sources: usize, capacity: usize) -> Self {
        let width = speeds + sources;
        Self {
            speeds,
            width,
            stuck: Vec::with_capacity(capacity),
            pivots: Vec::with_capacity(capacity),
            rows: Vec::with_capacity(capacity * width),
        }
    }

    /// Solves the relations `form(v) + prescribed(s) = 0` of the stuck parts, unless that is done already.
    pub(crate) fn prepare<'a>(&mut self, stuck: &[usize], relation: impl Fn(usize) -> (&'a Form, &'a Form)) {
        if self.stuck == stuck {
            return;
        }
        self.stuck.clear();
        self.stuck.extend_from_slice(stuck);
        self.pivots.clear();
        self.rows.clear();
        for part in stuck {
            let (form, prescribed) = relation(*part);
            self.add(form, prescribed);
        }
    }

    /// Gauss-Jordan elimination, one relation more; the pivot is the largest coefficient, of equals the first.
    fn add(&mut self, form: &Form, prescribed: &Form) {
        let (n, width) = (self.speeds, self.width);
        let start = self.rows.len();
        self.rows.resize(start + width, 0.0);
        let (done, row) = self.rows.split_at_mut(start);
        form.add_to(-1.0, &mut row[..n]);
        prescribed.add_to(-1.0, &mut row[n..]);
        let scale = row[..n].iter().fold(0.0_f64, |max, value| max.max(value.abs()));
        for (pivot, other) in self.pivots.iter().zip(done.chunks_exact(width.max(1))) {
            let factor = std::mem::take(&mut row[*pivot]);
            row.iter_mut().zip(other).for_each(|(to, from)| *to += factor * from);
        }
        row[..n].iter_mut().filter(|value| value.abs() <= ZERO * scale).for_each(|value| *value = 0.0);
        let mut pivot = 0;
        for k in 0..n {
            if row[k].abs() > row[pivot].abs() {
                pivot = k;
            }
        }
        if n == 0 || row[pivot] == 0.0 {
            self.rows.truncate(start);
            return;
        }
        let inverse = -1.0 / std::mem::take(&mut row[pivot]);
        row.iter_mut().for_each(|value| *value *= inverse);
        for other in done.chunks_exact_mut(width.max(1)) {
            let factor = std::mem::take(&mut other[pivot]);
            other.iter_mut().zip(row.iter()).for_each(|(to, from)| *to += factor * from);
        }
        self.pivots.push(pivot);
    }

    /// Overwrites the speeds (or accelerations) that follow from the others and from those that are prescribed.
    pub(crate) fn settle(&self, value: &mut [f64], prescribed: &[f64]) {
        for (pivot, row) in self.relations() {
            let (over, given) = row.split_at(self.speeds);
            let own: f64 = over.iter().zip(value.iter()).map(|(c, z)| c * z).sum();
            let given: f64 = given.iter().zip(prescribed).map(|(c, s)| c * s).sum();
            value[pivot] = own + given;
        }
    }

    /// Makes `value` miss the relations by as much as `like` does.
    pub(crate) fn settle_like(&self, value: &mut [f64], like: &[f64]) {
        for (pivot, row) in self.relations() {
            let of = |z: &[f64]| -> f64 { row[..self.speeds].iter().zip(z).map(|(c, z)| c * z).sum() };
            value[pivot] = of(value) + (like[pivot] - of(like));
        }
    }

    fn relations(&self) -> impl Iterator<Item = (usize, &[f64])> {
        self.pivots.iter().copied().zip(self.rows.chunks_exact(self.width.max(1)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_two_brakes_on_a_differential_hold_stands_still_in_every_bit() {
        let forms = [Form::from_dense(&[1.0, 1.0, 0.0]), Form::from_dense(&[1.0, -1.0, 0.0])];
        let none = Form::default();
        let mut lock = Lock::new(3, 0, 2);
        lock.prepare(&[0, 1], |i| (&forms[i], &none));
        let mut v = [1e-17, -3e-18, 2.5];
        lock.settle(&mut v, &[]);
        assert_eq!(v, [0.0, 0.0, 2.5]);
        lock.prepare(&[1], |i| (&forms[i], &none));
        let mut v = [0.3, 0.1 + 0.2, 2.5];
        lock.settle(&mut v, &[]);
        assert_eq!(v[0], v[1]);
    }

    #[test]
    fn a_prescribed_speed_is_followed_and_a_repeated_relation_changes_nothing() {
        let forms = [Form::from_dense(&[2.0, 0.0]), Form::from_dense(&[4.0, 0.0])];
        let given = [Form::from_dense(&[-1.0]), Form::from_dense(&[-2.0])];
        let mut lock = Lock::new(2, 1, 2);
        lock.prepare(&[0, 1], |i| (&forms[i], &given[i]));
        let mut v = [9.0, 7.0];
        lock.settle(&mut v, &[3.0]);
        assert_eq!(v, [1.5, 7.0]);
    }
}
