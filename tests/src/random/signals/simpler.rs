//! Models that are a little simpler.

use super::super::dice::rounded;
use super::model::{Law, Model, Node};

/// Models that are a little simpler, the much simpler ones first.
pub(super) fn simpler(model: &Model) -> Vec<Model> {
    let n = model.nodes.len();
    let mut all = Vec::new();
    // What one node alone depends on.
    for node in 0..n {
        let mut one = model.only(&[node]);
        if one.nodes.len() < n {
            all.push(Model { probes: Vec::new(), ..one.clone() });
            one.probes = vec![one.nodes.len() - 1];
            all.push(one);
        }
    }
    all.sort_by_key(|model| model.nodes.len());
    for i in 0..model.probes.len() {
        let mut fewer = model.clone();
        fewer.probes.remove(i);
        all.push(fewer);
    }
    for node in 0..n {
        all.extend(bypassed(model, node));
    }
    for node in 0..n {
        let law = &model.nodes[node].law;
        if law.inputs() > 0 && !model.nodes[node].boolean {
            all.push(replaced(model, node, Law::Constant(1.0)));
        }
    }
    for stop in [0.5 * model.stop, 0.8 * model.stop] {
        all.push(Model { stop: rounded(stop), ..model.clone() });
    }
    all.retain(Model::is_causal);
    all
}

/// A model in which whoever takes the output of a node takes one of its inputs instead.
fn bypassed(model: &Model, node: usize) -> Vec<Model> {
    let Node { inputs, boolean, .. } = &model.nodes[node];
    let mut all = Vec::new();
    for &instead in inputs {
        if instead == node || model.nodes[instead].boolean != *boolean {
            continue;
        }
        let mut shorter = model.clone();
        for other in &mut shorter.nodes {
            other.inputs.iter_mut().filter(|u| **u == node).for_each(|u| *u = instead);
        }
        let mut wanted: Vec<usize> = (0..model.nodes.len()).filter(|n| *n != node).collect();
        shorter.probes.retain(|probe| *probe != node);
        wanted.retain(|n| *n != node);
        all.push(shorter.only(&wanted));
    }
    all
}

fn replaced(model: &Model, node: usize, law: Law) -> Model {
    let mut simpler = model.clone();
    simpler.nodes[node] = Node { law, inputs: Vec::new(), boolean: false };
    simpler
}
