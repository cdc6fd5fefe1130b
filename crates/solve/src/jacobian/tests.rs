use super::*;
use crate::problems::function;
use crate::{Counts, System, Tolerances};

/// Evaluates f and J.
fn evaluate(jacobian: &mut Jacobian, system: &mut dyn System, x: &[f64]) -> u64 {
    let (mut counts, n) = (Counts::default(), x.len());
    let mut weights = Weights::new(Tolerances::automatic(n, 1e-6));
    weights.note(0.0, x);
    let mut work = Work { system, counts: &mut counts, weights: &weights };
    let mut f0 = vec![0.0; n];
    assert!(work.derivatives(0.0, x, &mut f0).is_ok());
    assert!(jacobian.evaluate(&mut work, 0.0, x, &f0, 1e-3).is_ok());
    counts.evaluations - 1
}

fn chain(n: usize) -> impl System {
    function(n, move |_, x, dx| {
        for i in 0..n {
            let left = if i > 0 { x[i - 1] } else { 1.0 };
            let right = if i + 1 < n { x[i + 1] } else { 0.0 };
            // The last cell feels the first one by a product.
            let far = if i + 1 == n { x[0] * x[i] } else { 0.0 };
            dx[i] = left - 2.0 * x[i] + right + far;
        }
    })
}

#[test]
fn a_chain_takes_as_many_evaluations_as_it_has_groups() {
    let mut jacobian = Jacobian::new(100);
    let mut x: Vec<f64> = (0..100).map(|i| 1.0 / (1.0 + i as f64)).collect();
    // Once to see which entries there are; three groups and one for the entry far off; one to compare.
    assert_eq!(evaluate(&mut jacobian, &mut chain(100), &x), 100 + 4 + 1);
    x[0] = 0.5;
    assert_eq!(evaluate(&mut jacobian, &mut chain(100), &x), 4 + 1);
    assert!(matches!(jacobian.factors, Factors::Sparse(_)));
}

#[test]
fn a_long_chain_is_seen_by_halves_as_it_is_one_by_one() {
    // The last cell feels the first one by a product, from far off.
    let n = 1000;
    let mut jacobian = Jacobian::new(n);
    let x: Vec<f64> = (0..n).map(|i| 1.0 + 1e-3 * i as f64).collect();
    let spent = evaluate(&mut jacobian, &mut chain(n), &x);
    assert!(spent < 90, "{spent}");
    assert!(*jacobian.pattern.as_ref().unwrap() == Pattern::of(neighbours(n)));
    // The same where the system speaks of more than there is.
    let more = |j: usize| (j.saturating_sub(300)..(j + 300).min(n)).chain([n - 1]).collect();
    let mut jacobian = Jacobian::new(n);
    let spent = evaluate(&mut jacobian, &mut Known(chain(n), (0..n).map(more).collect()), &x);
    assert!(spent < 90, "{spent}");
    assert!(*jacobian.pattern.as_ref().unwrap() == Pattern::of(neighbours(n)));
}

#[test]
fn where_halves_act_on_the_same_for_long_columns_are_looked_at_one_by_one() {
    // Each cell acts on two that lie anywhere.
    let n = 600;
    let mut system = function(n, move |_, x, dx| {
        (0..n).for_each(|i| dx[i] = x[(7 * i + 3) % n] - 2.0 * x[(389 * i + 11) % n] - 4.5 * x[i]);
    });
    let mut jacobian = Jacobian::new(n);
    let spent = evaluate(&mut jacobian, &mut system, &vec![1.0; n]);
    assert!((600..600 + 150 + 20).contains(&spent), "{spent}");
    let mut seen = vec![Vec::new(); n];
    (0..n).for_each(|i| [(7 * i + 3) % n, (389 * i + 11) % n].into_iter().for_each(|j| seen[j].push(i)));
    assert!(*jacobian.pattern.as_ref().unwrap() == Pattern::of(seen));
}

#[test]
fn an_entry_that_was_zero_at_first_is_found_when_it_matters() {
    let mut jacobian = Jacobian::new(100);
    // At x = 0 the product has no slope.
    let mut x = vec![0.0; 100];
    evaluate(&mut jacobian, &mut chain(100), &x);
    let seen = jacobian.pattern.as_ref().unwrap().len();
    assert!(seen < 299);
    x.fill(0.5);
    assert!(evaluate(&mut jacobian, &mut chain(100), &x) > 100);
    assert_eq!(jacobian.pattern.as_ref().unwrap().len(), 299);
}

#[test]
fn a_few_entries_that_are_missing_are_found_by_halving() {
    let n = 400;
    let mut system = function(n, move |_, x, dx| {
        (0..n).for_each(|i| dx[i] = -x[i]);
        dx[n - 1] += x[7] * x[300];
    });
    let mut jacobian = Jacobian::new(n);
    let mut x = vec![1.0; n];
    (x[7], x[300]) = (0.0, 0.0);
    evaluate(&mut jacobian, &mut system, &x);
    assert_eq!(jacobian.pattern.as_ref().unwrap().len(), n);
    (x[7], x[300]) = (1.0, 1.0);
    // Two of 400 columns, by nine halvings each, of which each looks at both halves.
    let spent = evaluate(&mut jacobian, &mut system, &x);
    assert!(spent < 2 * 3 * 9 + 10, "{spent}");
    assert_eq!(jacobian.pattern.as_ref().unwrap().len(), n + 2);
}

/// A system that says of its states what they act on.
struct Known<S: System>(S, Vec<Vec<usize>>);

impl<S: System> System for Known<S> {
    fn dimension(&self) -> usize {
        self.0.dimension()
    }

    fn derivatives(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<(), crate::Failed> {
        self.0.derivatives(t, x, dx)
    }

    fn influence(&self) -> Option<Vec<Vec<usize>>> {
        Some(self.1.clone())
    }
}

fn neighbours(n: usize) -> Vec<Vec<usize>> {
    let around = |j: usize| (j.saturating_sub(1)..=(j + 1).min(n - 1)).collect::<Vec<_>>();
    let mut columns: Vec<Vec<usize>> = (0..n).map(around).collect();
    columns[0].push(n - 1);
    columns
}

#[test]
fn what_a_system_says_of_its_states_is_not_looked_for() {
    for n in [10, 100] {
        let (mut plain, mut told) = (Jacobian::new(n), Jacobian::new(n));
        // At x = 0 the product has no slope, and its entry is there all the same.
        for x in [vec![0.0; n], vec![0.5; n]] {
            evaluate(&mut plain, &mut chain(n), &x);
            assert_eq!(evaluate(&mut told, &mut Known(chain(n), neighbours(n)), &x), 4, "{n}");
            let (mut b, mut c) = (vec![1.0; n], vec![1.0; n]);
            let (mut counts, weights) = (Counts::default(), Weights::new(Tolerances::automatic(n, 1e-6)));
            let mut work = Work { system: &mut chain(n), counts: &mut counts, weights: &weights };
            assert!(plain.factor(&mut work, 0.1).is_ok() && told.factor(&mut work, 0.1).is_ok());
            plain.solve(&mut b);
            told.solve(&mut c);
            assert!(b.iter().zip(&c).all(|(b, c)| (b - c).abs() < 1e-7 * b.abs()), "{n}: {b:?} {c:?}");
        }
    }
}

#[test]
fn where_that_allows_few_states_at_a_time_it_is_looked_once() {
    // Each of the first 30 states may act on all of the last 100, but does so on one.
    let n = 130;
    let mut columns: Vec<Vec<usize>> = (0..30).map(|_| (30..n).collect()).collect();
    columns.extend((30..n).map(|j| vec![j]));
    let mut system = Known(
        function(n, |_, x, dx| {
            (0..30).for_each(|i| dx[i] = -x[i]);
            (30..130).for_each(|i| dx[i] = x[i % 30] - 2.0 * x[i]);
        }),
        columns,
    );
    let mut jacobian = Jacobian::new(n);
    let x = vec![1.0; n];
    // 31 sets show it; one is varied with all that acts elsewhere.
    assert_eq!(evaluate(&mut jacobian, &mut system, &x), 31 + 2 + 1);
    assert_eq!(evaluate(&mut jacobian, &mut system, &x), 2 + 1);
}

#[test]
fn a_look_that_fails_leaves_what_is_known() {
    let (mut jacobian, left) = (Jacobian::new(100), std::cell::Cell::new(u32::MAX));
    let mut plain = chain(100);
    let mut system = function(100, |t, x, dx| {
        left.set(left.get().saturating_sub(1));
        if left.get() == 0 {
            dx.fill(f64::NAN);
        } else {
            plain.derivatives(t, x, dx).unwrap();
        }
    });
    evaluate(&mut jacobian, &mut system, &[0.0; 100]);
    // The product is found to be missing, and the domain ends amid the look for it.
    left.set(20);
    let (mut counts, mut weights) = (Counts::default(), Weights::new(Tolerances::automatic(100, 1e-6)));
    weights.note(0.0, &[0.5; 100]);
    let mut work = Work { system: &mut system, counts: &mut counts, weights: &weights };
    let mut f0 = vec![0.0; 100];
    assert!(work.derivatives(0.0, &[0.5; 100], &mut f0).is_ok());
    assert!(jacobian.evaluate(&mut work, 0.0, &[0.5; 100], &f0, 1e-3).is_err());
    left.set(u32::MAX);
    evaluate(&mut jacobian, &mut system, &[0.5; 100]);
    assert_eq!(jacobian.pattern.as_ref().unwrap().len(), 299);
}

#[test]
fn what_is_crowded_is_dense_and_solves_as_well() {
    for n in [10, 40] {
        let mut jacobian = Jacobian::new(n);
        let mut system = function(n, move |_, x, dx| {
            let sum: f64 = x.iter().sum();
            dx.iter_mut().zip(x).for_each(|(dx, x)| *dx = sum - 100.0 * x);
        });
        evaluate(&mut jacobian, &mut system, &vec![1.0; n]);
        assert!(matches!(jacobian.factors, Factors::Dense { .. }));
        let (mut counts, weights) = (Counts::default(), Weights::new(Tolerances::automatic(n, 1e-6)));
        let mut work = Work { system: &mut system, counts: &mut counts, weights: &weights };
        assert!(jacobian.factor(&mut work, 0.1).is_ok());
        let mut b = vec![1.0; n];
        jacobian.solve(&mut b);
        // All alike: (1 + 10 - 0.1 n) x = 1.
        assert!(b.iter().all(|b| (b * (11.0 - 0.1 * n as f64) - 1.0).abs() < 1e-6), "{b:?}");
    }
}
