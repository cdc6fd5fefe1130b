//! Room for closed loops.

/// Rows of the loops.
#[derive(Debug, Default)]
pub(crate) struct LoopWork {
    /// Rows over the speeds of the joints and over the independent speeds.
    pub joint_rows: Vec<f64>,
    pub rows: Vec<f64>,
    /// What `D dv` and `D v` have to be.
    pub b: Vec<f64>,
    pub target: Vec<f64>,
    /// Whether gaps close by `b`; otherwise they stay as they are.
    pub drifts: bool,
    /// How fast the ends move apart.
    pub rate: Vec<f64>,
}

impl LoopWork {
    pub(crate) fn new(loops: usize, joints: usize, free: usize) -> Self {
        let m = 6 * loops;
        LoopWork {
            joint_rows: vec![0.0; m * joints],
            rows: vec![0.0; m * free],
            b: vec![0.0; m],
            target: vec![0.0; m],
            drifts: true,
            rate: vec![0.0; m],
        }
    }
}
