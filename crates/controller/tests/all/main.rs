//! Controllers as hosts see them, built in and loaded.

mod border;
mod guide;
mod loaded;
