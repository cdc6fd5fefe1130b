//! Plug-ins as the host finds, loads and calls them.

mod common;
mod library_errors;
mod modules;
mod parameter_errors;
mod reload;
mod running;
mod shipped;
