//! Solvers of differential equations: order, limits, work.

mod convergence;
mod limits;
mod matrices;
mod order_eight;
mod stiff;
mod tolerances;
mod trapezoidal;
mod within;
mod work;
