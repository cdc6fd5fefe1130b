//! How well a run can tell instants apart.

/// How far apart times of a run may be and still be meant to be equal, as a sum of periods and the product of the same are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// Times below this are off by as much as it is, s: they may be differences of others.
    least: f64,
}

impl Resolution {
    /// That of a run until `stop_time`, s.
    pub fn new(stop_time: f64) -> Self {
        Self { least: stop_time.min(1.0) }
    }

    /// How large a time near `t` is for this, s.
    pub fn size(self, t: f64) -> f64 {
        t.abs().max(self.least)
    }

    /// Times closer to `t` than this are the same time, s.
    pub fn same(self, t: f64) -> f64 {
        1e-12 * self.size(t)
    }
}

impl Default for Resolution {
    /// That of runs of a second and more.
    fn default() -> Self {
        Self { least: 1.0 }
    }
}
