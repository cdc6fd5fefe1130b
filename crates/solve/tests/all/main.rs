//! Solvers of differential equations: order, limits, work.

mod convergence;
mod limits;
mod work;
