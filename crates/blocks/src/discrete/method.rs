//! How an integral over one sample time is approximated.

use blocksim_block::prelude::*;

/// What stands for $1/s$ in a sampled system with sample time $T_s$.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Method {
    /// The value at the start of each sample time: $T_s / (z - 1)$.
    ForwardEuler,
    /// The value at its end: $T_s z / (z - 1)$.
    BackwardEuler,
    /// The mean of both: $T_s/2 \cdot (z + 1) / (z - 1)$.
    Trapezoidal,
}

impl Method {
    /// The share $\alpha$ of $T_s u_k$ that shows in the output at once: with the state $x$,
    /// $y_k = x_k + \alpha T_s u_k$ and $x_{k+1} = x_k + T_s u_k = y_k + (1 - \alpha) T_s u_k$.
    pub(crate) fn share(self) -> f64 {
        match self {
            Self::ForwardEuler => 0.0,
            Self::BackwardEuler => 1.0,
            Self::Trapezoidal => 0.5,
        }
    }
}
