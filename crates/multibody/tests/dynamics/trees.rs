//! Random trees, the same ones in every run.

use blocksim_multibody::{Inertia, InertiaError, Joint, Model, ModelBuilder, Placement};
use std::error::Error;

/// SplitMix64 (Steele, Lea, Flood 2014): small, and good enough to draw test cases.
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform between -1 and 1.
    pub fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Uniform in 0..n.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    pub fn triple(&mut self) -> [f64; 3] {
        [self.signed(), self.signed(), self.signed()]
    }

    pub fn vector(&mut self, n: usize, scale: f64) -> Vec<f64> {
        (0..n).map(|_| scale * self.signed()).collect()
    }

    /// Positions of a model; the quaternions among them have any length.
    pub fn positions(&mut self, model: &Model) -> Vec<f64> {
        self.vector(model.nq(), 3.0)
    }

    pub fn placement(&mut self) -> Placement {
        let rpy = self.triple().map(|x| 3.0 * x);
        Placement::from_rpy(self.triple(), rpy)
    }

    /// A cloud of point masses: any such body is possible, and five points are never flat.
    pub fn inertia(&mut self) -> Result<Inertia, InertiaError> {
        let mut body = Inertia::zero();
        for _ in 0..5 {
            body = body + Inertia::point(1.5 + self.signed(), self.triple())?;
        }
        Ok(body)
    }

    fn joint(&mut self) -> Joint {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], self.triple()];
        let axis = axes[self.below(4)];
        match self.below(6) {
            0 | 1 => Joint::prismatic(axis),
            2 => Joint::Spherical,
            _ => Joint::revolute(axis),
        }
    }
}

/// A tree of `n` bodies; every body hangs on the ground or on any earlier one.
pub fn tree(random: &mut Random, n: usize) -> Result<Model, Box<dyn Error>> {
    let mut builder = ModelBuilder::new();
    let mut ids = Vec::new();
    for _ in 0..n {
        let parent = match random.below(ids.len() + 1) {
            0 => None,
            // favour recent bodies, so that trees are deep and branched
            k => Some(ids[(k - 1).max(ids.len().saturating_sub(1 + random.below(3)))]),
        };
        let (joint, placement) = (random.joint(), random.placement());
        ids.push(builder.add_body(parent, joint, placement, random.inertia()?)?);
    }
    Ok(builder.build())
}

/// Forty trees of one to twelve bodies, each with a generator for its states.
pub fn forest() -> impl Iterator<Item = (Model, Random)> {
    (0..40).map(|k| {
        let mut random = Random(1000 + k);
        let model = tree(&mut random, 1 + k as usize % 12).expect("random trees are sound");
        (model, random)
    })
}
