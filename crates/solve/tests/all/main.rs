//! Solvers of differential equations: order, limits, work.

mod convergence;
mod limits;
mod stiff;
mod tolerances;
mod work;
