//! The program as users call it.

mod bad_plugins;
mod bad_runs;
mod collisions;
mod commands;
mod data;
mod desk;
mod edit;
#[cfg(unix)]
mod export_c;
mod faults;
mod fix;
mod fmt;
#[cfg(unix)]
mod grade;
mod held_signals;
mod help;
mod identify;
mod identify_parameters;
mod import;
mod layers;
mod licences;
#[cfg(unix)]
mod limits;
mod linearise;
mod linearise_charts;
mod linearise_dead_times;
mod linearise_sampled;
mod loops;
mod modules;
mod mutants;
#[cfg(unix)]
mod native;
mod pages_of_errors;
mod params;
mod plan;
mod plots;
mod plugin;
mod plugin_check;
mod printed_commands;
mod recording;
mod report;
mod report_faults;
mod set;
mod start;
#[cfg(unix)]
mod studio;
mod support;
mod sweep;
mod tables;
#[cfg(unix)]
mod trim;
#[cfg(unix)]
mod trust;
mod tuning;
mod tutorials;
mod units;
mod verify;
mod watch;
mod wording;
