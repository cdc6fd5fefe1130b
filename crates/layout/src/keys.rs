//! The order of a level after the heights in its skeleton.

use crate::graph::{End, Graph, Side};
use crate::heights::rows::{CHAIN, Chains};
use crate::order::crossings::block_of;
use crate::order::insert::run_together;
use crate::order::lanes::{Item, Plan};
use crate::structure::sides::Sides;
use crate::structure::skeleton::{Skeleton, beyond};

/// A level with a place for everything.
pub(crate) struct Arranged {
    pub plan: Plan,
    pub sides: Sides,
    /// Upper edges of all items.
    pub y: Vec<f64>,
    pub chains: Chains,
}

/// The skeleton of a level, arranged.
pub(crate) struct Drawn {
    pub skeleton: Skeleton,
    pub all: Arranged,
}

impl Drawn {
    /// Sorts the rows of a plan of the level after the heights in the skeleton.
    pub fn sort(&self, plan: &mut Plan) {
        let keys: Vec<f64> = (0..plan.items.len()).map(|item| self.key(plan, item)).collect();
        let rank = self.ranks();
        let rank_of = |plan: &Plan, unit: &[usize]| {
            block_of(plan, unit).and_then(|v| Some(rank[self.skeleton.node[v]?]))
        };
        for at in 0..plan.rows.len() {
            let mut row = std::mem::take(&mut plan.rows[at]);
            let main = |unit: &[usize]| block_of(plan, unit).unwrap_or(unit[0]);
            row.sort_by(|a, b| {
                let (a, b) = (main(a), main(b));
                keys[a].total_cmp(&keys[b]).then(plan.back[a].cmp(&plan.back[b])).then(a.cmp(&b))
            });
            // Blocks that the skeleton has beside each other have the order of the text.
            let places: Vec<usize> =
                (0..row.len()).filter(|place| rank_of(plan, &row[*place]).is_some()).collect();
            let mut blocks: Vec<Vec<usize>> = places.iter().map(|place| row[*place].clone()).collect();
            blocks.sort_by_key(|unit| rank_of(plan, unit));
            for (place, block) in places.into_iter().zip(blocks) {
                row[place] = block;
            }
            plan.rows[at] = row;
        }
    }

    /// Brings each loose unit to the place in its row that it has in the skeleton.
    pub fn insert(&self, plan: &mut Plan, sides: &Sides) {
        let keys: Vec<f64> = (0..plan.items.len()).map(|item| self.key(plan, item)).collect();
        let main = |plan: &Plan, unit: &[usize]| block_of(plan, unit).unwrap_or(unit[0]);
        for at in 0..plan.rows.len() {
            let row = std::mem::take(&mut plan.rows[at]);
            let (mut loose, mut row): (Vec<_>, Vec<_>) =
                row.into_iter().partition(|unit| plan.loose[unit[0]]);
            loose.sort_by(|a, b| {
                let (a, b) = (main(plan, a), main(plan, b));
                keys[a].total_cmp(&keys[b]).then(a.cmp(&b))
            });
            for unit in loose {
                let key = keys[main(plan, &unit)];
                // How many stand on the wrong side, for each place.
                let wrong = |place: usize| {
                    let key_of = |unit: &Vec<usize>| keys[main(plan, unit)];
                    row[..place].iter().filter(|other| key_of(other) > key).count()
                        + row[place..].iter().filter(|other| key_of(other) <= key).count()
                };
                let place = (0..=row.len()).min_by_key(|place| wrong(*place)).unwrap_or(0);
                row.insert(place, unit);
            }
            plan.rows[at] = row;
        }
        run_together(plan, sides);
    }

    /// Places of the blocks of the skeleton from top to bottom; those that are neither above nor below each other keep
    /// the order of the text.
    fn ranks(&self) -> Vec<usize> {
        let n = self.skeleton.graph.nodes.len();
        let above = |a: usize, b: usize| self.all.y[a] + self.all.sides.height[a] <= self.all.y[b];
        let mut rank = vec![usize::MAX; n];
        for place in 0..n {
            let open = |v: &usize| rank[*v] == usize::MAX;
            let next = (0..n).filter(open).find(|v| !(0..n).filter(open).any(|other| above(other, *v)));
            if let Some(next) = next {
                rank[next] = place;
            }
        }
        rank
    }

    /// The height that an item of the level has in the skeleton.
    fn key(&self, plan: &Plan, item: usize) -> f64 {
        let at = plan.layer_of[item];
        match plan.items[item] {
            Item::Node(v) => match (self.skeleton.node[v], self.skeleton.behind[v]) {
                (Some(kept), _) => self.all.y[kept] + self.all.sides.height[kept] / 2.0,
                (None, Some(net)) => self.height(plan, net, at),
                (None, None) => 0.0,
            },
            Item::Lane(net) => self.height(plan, net, at),
        }
    }

    /// Height of a net of the level, as far as the skeleton knows it, in a layer of the level.
    fn height(&self, plan: &Plan, net: usize, at: usize) -> f64 {
        let directed = self.skeleton.directed[net];
        let reach = &self.skeleton.reach[net];
        let place = |end: &&End| {
            Some((plan.layer_of[end.node], self.all.plan.layer_of[self.skeleton.node[end.node]?]))
        };
        let ends = || reach.from.iter().chain(&reach.to).filter_map(|end| place(&end));
        let left = ends().filter(|(here, _)| *here <= at).max();
        let right = ends().filter(|(here, _)| *here >= at).min();
        let x = match (left, right) {
            (Some((a, there)), Some((b, other))) if b > a => {
                there as f64 + (at - a) as f64 / (b - a) as f64 * (other as f64 - there as f64)
            }
            (Some((a, there)), _) => there as f64 + (at - a) as f64,
            (None, Some((b, there))) => there as f64 - (b - at) as f64,
            (None, None) => return 0.0,
        };
        let known = |end: &End| Some(End { node: self.skeleton.node[end.node]?, ..*end });
        let known = |ends: &[End]| ends.iter().filter_map(known).collect::<Vec<End>>();
        // A branch of a net is where it alone leads.
        let ends = match (known(&reach.from), known(&reach.to)) {
            (from, to) if !directed && from.len() > 1 && to.len() == 1 => to,
            (from, to) if !directed && from.len() == 1 && to.len() > 1 => from,
            (mut from, to) => {
                from.extend(to);
                from
            }
        };
        let mut points: Vec<(f64, f64)> = Vec::new();
        for end in &ends {
            let layer = self.all.plan.layer_of[end.node] as f64;
            let across = match self.all.sides.side[end.node][end.port] {
                Side::West => -0.5,
                Side::East => 0.5,
                Side::North | Side::South => 0.0,
            };
            points.push((layer + across, self.all.y[end.node] + self.all.sides.offset(end.node, end.port)));
        }
        // The wires of the skeleton between these ends.
        for (n, net) in self.skeleton.graph.nets.iter().enumerate() {
            let joined = if net.directed {
                ends.contains(&net.ends[0])
                    && (reach.to.is_empty() || net.ends[1..].iter().any(|end| ends.contains(end)))
            } else {
                net.ends.iter().any(|end| ends.contains(end))
            };
            if joined {
                points.extend(
                    self.all.plan.lanes[n].iter().map(|(layer, lane)| (*layer as f64, self.all.y[*lane])),
                );
            }
        }
        let near = |point: &&(f64, f64)| (point.0 - x).abs();
        points.iter().min_by(|a, b| near(a).total_cmp(&near(b))).map_or(0.0, |point| point.1)
    }

    /// The straight paths of the skeleton, through what stands in its wires.
    pub fn chains_of(&self, graph: &Graph) -> Chains {
        let kept = &self.skeleton.node;
        let mut chains = Chains::new();
        for (n, net) in graph.nets.iter().enumerate() {
            let behind: Vec<Vec<usize>> = net
                .ends
                .iter()
                .map(|end| {
                    let mut found = Vec::new();
                    beyond(graph, kept, *end, n, &mut found);
                    found.iter().filter_map(|end| kept[end.node]).collect()
                })
                .collect();
            for (i, a) in net.ends.iter().enumerate() {
                for (j, b) in net.ends.iter().enumerate().skip(i + 1) {
                    let pairs =
                        behind[i].iter().flat_map(|a| behind[j].iter().map(move |b| (*a.min(b), *a.max(b))));
                    let alone = behind[i].is_empty() || behind[j].is_empty();
                    let weight =
                        pairs.filter_map(|pair| self.all.chains.get(&pair)).max().or(alone.then_some(&CHAIN));
                    if let Some(weight) = weight {
                        chains.insert((a.node.min(b.node), a.node.max(b.node)), *weight);
                    }
                }
            }
        }
        chains
    }
}
