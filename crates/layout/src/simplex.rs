//! Whole numbers with differences at least so large, such that a weighted sum of the differences is smallest.
//!
//! Both the layers and the rows of a drawing are such a problem; its answers are exact, so wires come out straight.
//! Method: network simplex (Gansner, Koutsofios, North, Vo: A technique for drawing directed graphs, 1993).

/// `x[head] - x[tail] >= length`, and the difference costs `weight` each unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Edge {
    pub tail: usize,
    pub head: usize,
    pub length: i64,
    pub weight: i64,
}

/// Numbers `x` for `n` variables: of all best answers the one with the least numbers, which is unique, so that a small
/// change of the problem does not change what it has nothing to do with. The edges must not contain a circle; what lies
/// on one keeps its start value.
pub(crate) fn solve(n: usize, edges: &[Edge]) -> Vec<i64> {
    // The pull is so weak that it decides between equals only.
    let scale = n as i64 + 1;
    let edges: Vec<Edge> = edges.iter().map(|edge| Edge { weight: edge.weight * scale, ..*edge }).collect();
    solve_pulled(&edges, &vec![1; n])
}

/// Numbers for as many variables as there are pulls: each is worth being small by its pull.
pub(crate) fn solve_pulled(edges: &[Edge], pull: &[i64]) -> Vec<i64> {
    let n = pull.len();
    // A root below all of them makes the graph connected.
    let root = n;
    let mut edges = edges.to_vec();
    edges.extend(pull.iter().enumerate().map(|(head, weight)| Edge {
        tail: root,
        head,
        length: 0,
        weight: *weight,
    }));
    let mut x = longest_paths(n + 1, &edges);
    let tree = tight_tree(n + 1, &edges, &mut x);
    let mut tree = Tree::new(root, &edges, &tree);
    // Every exchange but a degenerate one brings the sum down; the limit keeps those from going round for ever.
    for _ in 0..20 * n + 200 {
        if !tree.exchange(&mut x) {
            break;
        }
    }
    x.truncate(n);
    x
}

fn longest_paths(n: usize, edges: &[Edge]) -> Vec<i64> {
    let mut x = vec![0; n];
    let mut waiting = vec![0; n];
    let mut out = vec![Vec::new(); n];
    for (i, edge) in edges.iter().enumerate() {
        waiting[edge.head] += 1;
        out[edge.tail].push(i);
    }
    let mut ready: Vec<usize> = (0..n).rev().filter(|v| waiting[*v] == 0).collect();
    while let Some(v) = ready.pop() {
        for edge in out[v].iter().map(|i| edges[*i]) {
            x[edge.head] = x[edge.head].max(x[v] + edge.length);
            waiting[edge.head] -= 1;
            if waiting[edge.head] == 0 {
                ready.push(edge.head);
            }
        }
    }
    x
}

fn slack(edge: &Edge, x: &[i64]) -> i64 {
    x[edge.head] - x[edge.tail] - edge.length
}

/// Edges without slack that span all variables; moves the variables so that there are enough.
fn tight_tree(n: usize, edges: &[Edge], x: &mut [i64]) -> Vec<usize> {
    let mut near = vec![Vec::new(); n];
    for (i, edge) in edges.iter().enumerate() {
        near[edge.tail].push(i);
        near[edge.head].push(i);
    }
    let mut inside = vec![false; n];
    let mut tree = Vec::new();
    let mut stack = vec![n - 1];
    inside[n - 1] = true;
    loop {
        while let Some(v) = stack.pop() {
            for &i in &near[v] {
                let other = if edges[i].tail == v { edges[i].head } else { edges[i].tail };
                if !inside[other] && slack(&edges[i], x) == 0 {
                    inside[other] = true;
                    tree.push(i);
                    stack.push(other);
                }
            }
        }
        let leaving = edges.iter().filter(|edge| inside[edge.tail] != inside[edge.head]);
        let Some(next) = leaving.min_by_key(|edge| slack(edge, x)) else { return tree };
        let step = if inside[next.tail] { slack(next, x) } else { -slack(next, x) };
        for v in (0..n).filter(|v| inside[*v]) {
            x[v] += step;
        }
        stack.extend((0..n).filter(|v| inside[*v]));
    }
}

/// A spanning tree of tight edges. What an exchange changes lies on the circle that the new edge closes; nothing else is
/// looked at again.
struct Tree<'a> {
    edges: &'a [Edge],
    /// Edges at each variable: all of them, and those of the tree.
    all: Vec<Vec<usize>>,
    near: Vec<Vec<usize>>,
    /// The edge and the variable above each, seen from the root; none above the root.
    above: Vec<(usize, usize)>,
    /// Weights that leave less weights that enter, of all that hangs at each variable, itself included.
    balance: Vec<i64>,
    /// What the edge above each variable is worth to be kept; a negative one is to be replaced.
    worth: Vec<i64>,
    /// What hangs from the edge that leaves, as a list and as marks.
    hanging: Vec<usize>,
    side: Vec<bool>,
}

const NONE: usize = usize::MAX;

impl<'a> Tree<'a> {
    fn new(root: usize, edges: &'a [Edge], tree: &[usize]) -> Tree<'a> {
        let n = root + 1;
        let mut new = Tree {
            edges,
            all: vec![Vec::new(); n],
            near: vec![Vec::new(); n],
            above: vec![(NONE, NONE); n],
            balance: vec![0; n],
            worth: vec![0; n],
            hanging: Vec::with_capacity(n),
            side: vec![false; n],
        };
        for (i, edge) in edges.iter().enumerate() {
            new.balance[edge.tail] += edge.weight;
            new.balance[edge.head] -= edge.weight;
            new.all[edge.tail].push(i);
            new.all[edge.head].push(i);
        }
        tree.iter().for_each(|edge| new.join(*edge));
        new.hang(root);
        for i in (1..new.hanging.len()).rev() {
            let v = new.hanging[i];
            let above = new.above[v].1;
            new.balance[above] += new.balance[v];
            new.rate(v);
        }
        new
    }

    fn join(&mut self, edge: usize) {
        self.near[self.edges[edge].tail].push(edge);
        self.near[self.edges[edge].head].push(edge);
    }

    fn part(&mut self, edge: usize) {
        let Edge { tail, head, .. } = self.edges[edge];
        self.near[tail].retain(|known| *known != edge);
        self.near[head].retain(|known| *known != edge);
    }

    /// Lists all that hangs at a variable, it first, and notes what is above each.
    fn hang(&mut self, top: usize) {
        self.hanging.clear();
        self.hanging.push(top);
        let mut next = 0;
        while let Some(&v) = self.hanging.get(next) {
            next += 1;
            for &i in &self.near[v] {
                if i != self.above[v].0 {
                    let Edge { tail, head, .. } = self.edges[i];
                    let other = if tail == v { head } else { tail };
                    self.above[other] = (i, v);
                    self.hanging.push(other);
                }
            }
        }
    }

    fn rate(&mut self, v: usize) {
        let edge = self.above[v].0;
        self.worth[v] = match edge {
            NONE => 0,
            edge if self.edges[edge].tail == v => self.balance[v],
            _ => -self.balance[v],
        };
    }

    /// Replaces the edge that is worth least; `false` when all are worth to be kept.
    fn exchange(&mut self, x: &mut [i64]) -> bool {
        let least = self.worth.iter().enumerate().min_by_key(|(_, worth)| **worth);
        let Some((child, _)) = least.filter(|(_, worth)| **worth < 0) else { return false };
        let (leaves, parent) = self.above[child];
        self.hang(child);
        for v in &self.hanging {
            self.side[*v] = true;
        }
        let entering = self.entering(self.edges[leaves].head == child, x);
        if let Some(enters) = entering {
            let step = slack(&self.edges[enters], x);
            let step = if self.side[self.edges[enters].tail] { step } else { -step };
            for v in &self.hanging {
                x[*v] += step;
            }
            self.replace(leaves, enters, child, parent);
        }
        for v in &self.hanging {
            self.side[*v] = false;
        }
        entering.is_some()
    }

    /// The edge with the least slack that leads between the sides against the one that leaves; `out` of what hangs, or
    /// into it.
    fn entering(&self, out: bool, x: &[i64]) -> Option<usize> {
        let fits = |i: &usize| self.side[self.edges[*i].tail] == out && self.side[self.edges[*i].head] != out;
        let key = |i: &usize| (slack(&self.edges[*i], x), *i);
        if 2 * self.hanging.len() < x.len() {
            self.hanging.iter().flat_map(|v| &self.all[*v]).copied().filter(fits).min_by_key(key)
        } else {
            (0..self.edges.len()).filter(fits).min_by_key(key)
        }
    }

    /// Hangs what hung from one edge to another one.
    fn replace(&mut self, leaves: usize, enters: usize, child: usize, parent: usize) {
        let moved = self.balance[child];
        let Edge { tail, head, .. } = self.edges[enters];
        let (inner, outer) = if self.side[tail] { (tail, head) } else { (head, tail) };
        self.part(leaves);
        self.join(enters);
        for (start, change) in [(parent, -moved), (outer, moved)] {
            let mut v = start;
            while v != NONE {
                self.balance[v] += change;
                self.rate(v);
                v = self.above[v].1;
            }
        }
        // Between the inner end and the child, up and down change places.
        let (mut v, mut new_above, mut hung) = (inner, (enters, outer), 0);
        loop {
            let (edge, above) = self.above[v];
            let was = self.balance[v];
            self.above[v] = new_above;
            self.balance[v] = moved - hung;
            self.rate(v);
            if v == child {
                return;
            }
            (new_above, hung, v) = ((edge, v), was, above);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(tail: usize, head: usize, length: i64, weight: i64) -> Edge {
        Edge { tail, head, length, weight }
    }

    fn cost(edges: &[Edge], x: &[i64]) -> i64 {
        edges.iter().map(|edge| edge.weight * (x[edge.head] - x[edge.tail])).sum()
    }

    #[test]
    fn a_source_moves_next_to_what_it_feeds() {
        // 0 -> 1 -> 2 -> 3, and 4 feeds 3.
        let edges = [edge(0, 1, 1, 1), edge(1, 2, 1, 1), edge(2, 3, 1, 1), edge(4, 3, 1, 1)];
        let x = solve(5, &edges);
        assert_eq!([x[1] - x[0], x[2] - x[0], x[3] - x[0], x[4] - x[0]], [1, 2, 3, 2]);
    }

    #[test]
    fn the_answer_is_the_best_of_all() {
        // Small problems, against trying everything.
        let mut seed = 1_u64;
        let mut random = move |n: u64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) % n
        };
        for _ in 0..60 {
            let edges: Vec<Edge> = (0..7)
                .map(|_| {
                    let head = 1 + random(4) as usize;
                    let tail = random(head as u64) as usize;
                    edge(tail, head, random(3) as i64, random(5) as i64)
                })
                .collect();
            let x = solve(5, &edges);
            assert!(edges.iter().all(|edge| slack(edge, &x) >= 0), "{edges:?} {x:?}");
            let mut best = i64::MAX;
            for code in 0..9_i64.pow(5) {
                let y: Vec<i64> = (0..5).map(|i| code / 9_i64.pow(i) % 9).collect();
                if edges.iter().all(|edge| slack(edge, &y) >= 0) {
                    best = best.min(cost(&edges, &y));
                }
            }
            assert_eq!(cost(&edges, &x), best, "{edges:?} {x:?}");
        }
    }
}
