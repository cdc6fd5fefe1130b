//! Descriptions of other programs, sound and damaged.

mod assemblies;
mod damaged;
mod data_files;
mod structure;
