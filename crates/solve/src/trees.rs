//! Order conditions of one-step methods by rooted trees, for the tests of their tables.
//!
//! E. Hairer, S. P. Nørsett, G. Wanner: Solving Ordinary Differential Equations I, section II.2 (Runge-Kutta);
//! E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, section IV.7 (Rosenbrock and W-methods).

/// Which matrices stand at the nodes of a tree.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Family {
    /// alpha everywhere.
    RungeKutta,
    /// alpha + gamma at nodes with one child, alpha elsewhere: J is the exact Jacobian.
    Rosenbrock,
    /// As Runge-Kutta, and any tree with gamma at some nodes with one child must vanish: J is arbitrary.
    W,
}

#[derive(Clone)]
struct Tree {
    /// gamma instead of alpha stands at this node.
    fat: bool,
    children: Vec<Tree>,
}

impl Tree {
    fn order(&self) -> usize {
        1 + self.children.iter().map(Tree::order).sum::<usize>()
    }

    fn density(&self) -> f64 {
        self.order() as f64 * self.children.iter().map(Tree::density).product::<f64>()
    }

    fn any_fat(&self) -> bool {
        self.fat || self.children.iter().any(Tree::any_fat)
    }

    /// The elementary weight per stage.
    fn weight(&self, family: Family, alpha: &[Vec<f64>], gamma: &[Vec<f64>]) -> Vec<f64> {
        let mut weight = vec![1.0; alpha.len()];
        for child in &self.children {
            let below = child.weight(family, alpha, gamma);
            for (i, w) in weight.iter_mut().enumerate() {
                let entry = |j: usize| match family {
                    _ if self.fat => gamma[i][j],
                    Family::Rosenbrock if self.children.len() == 1 => alpha[i][j] + gamma[i][j],
                    _ => alpha[i][j],
                };
                *w *= (0..below.len()).map(|j| entry(j) * below[j]).sum::<f64>();
            }
        }
        weight
    }
}

/// All trees of up to `order` nodes.
fn trees(order: usize, family: Family) -> Vec<Tree> {
    let mut all: Vec<Tree> = Vec::new();
    for n in 1..=order {
        let mut forests = Vec::new();
        collect_forests(&all, n - 1, all.len(), &mut Vec::new(), &mut forests);
        for children in forests {
            if family == Family::W && children.len() == 1 {
                all.push(Tree { fat: true, children: children.clone() });
            }
            all.push(Tree { fat: false, children });
        }
    }
    all
}

/// All multisets of the first `end` trees with `nodes` nodes together.
fn collect_forests(
    all: &[Tree],
    nodes: usize,
    end: usize,
    chosen: &mut Vec<Tree>,
    forests: &mut Vec<Vec<Tree>>,
) {
    if nodes == 0 {
        forests.push(chosen.clone());
        return;
    }
    for i in 0..end {
        if all[i].order() <= nodes {
            chosen.push(all[i].clone());
            collect_forests(all, nodes - all[i].order(), i + 1, chosen, forests);
            chosen.pop();
        }
    }
}

/// The largest violation of the conditions up to `order`, for the solution at the fraction `theta` of a step with the
/// weights `b`.
pub(crate) fn largest_defect(
    family: Family,
    alpha: &[Vec<f64>],
    gamma: &[Vec<f64>],
    b: &[f64],
    theta: f64,
    order: usize,
) -> f64 {
    let mut largest: f64 = 0.0;
    for tree in trees(order, family) {
        let sum: f64 = tree.weight(family, alpha, gamma).iter().zip(b).map(|(w, b)| w * b).sum();
        let wanted = if tree.any_fat() { 0.0 } else { theta.powi(tree.order() as i32) / tree.density() };
        largest = largest.max((sum - wanted).abs());
    }
    largest
}

/// A square matrix from rows of any length, filled up with zeros.
pub(crate) fn square(rows: &[&[f64]]) -> Vec<Vec<f64>> {
    let filled = |row: &&[f64]| {
        let mut row = row.to_vec();
        row.resize(rows.len(), 0.0);
        row
    };
    rows.iter().map(filled).collect()
}

#[test]
fn the_numbers_of_trees_are_those_of_the_books() {
    for (order, plain, w) in [(1, 1, 1), (2, 2, 3), (3, 4, 8), (4, 8, 21), (5, 17, 58)] {
        assert_eq!(trees(order, Family::RungeKutta).len(), plain);
        assert_eq!(trees(order, Family::W).len(), w);
    }
}
