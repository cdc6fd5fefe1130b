//! What `export_plugin!` expands to; not for use by hand.

pub use crate::abi::{ABI_MAJOR, ABI_MINOR, BlockTable, MAGIC, PluginTable, Quantity, Text};
pub use crate::border::{check, derivatives, outputs, reset, sample_time, update};
pub use crate::describe::rows;
pub use crate::entry::Registered;
pub use inventory;

/// Makes the crate a plug-in: `export_plugin!("name", [Controller, ...]);`, once, at the top of the crate.
///
/// Writes `pub fn table()`, the table of the plug-in for callers in the same program, and hands it to the
/// exported function `blocksim_plugin_v1`. The version is that of the crate.
#[macro_export]
macro_rules! export_plugin {
    ($name:expr, [$($controller:ty),+ $(,)?]) => {
        /// The table of this plug-in, as a host sees it.
        pub fn table() -> &'static $crate::macro_parts::PluginTable {
            use $crate::macro_parts as parts;
            static BLOCKS: &[parts::BlockTable] = &[$($crate::block_table!($controller)),+];
            static TABLE: parts::PluginTable = parts::PluginTable {
                size: ::core::mem::size_of::<parts::PluginTable>() as u32,
                abi_major: parts::ABI_MAJOR,
                abi_minor: parts::ABI_MINOR,
                magic: parts::MAGIC,
                name: parts::Text::new($name),
                version: parts::Text::new(env!("CARGO_PKG_VERSION")),
                blocks: BLOCKS.as_ptr(),
                block_count: BLOCKS.len() as u32,
                reserved: 0,
            };
            $crate::macro_parts::inventory::submit! { parts::Registered(&TABLE) }
            &TABLE
        }
    };
}

/// The table of one controller.
#[doc(hidden)]
#[macro_export]
macro_rules! block_table {
    ($controller:ty) => {{
        use $crate::{Controller, macro_parts as parts};
        $crate::rows!($controller, PARAMETERS, INPUTS, OUTPUTS, DISCRETE, CONTINUOUS);
        parts::BlockTable {
            size: ::core::mem::size_of::<parts::BlockTable>() as u32,
            parameter_count: PARAMETERS.len() as u32,
            input_count: INPUTS.len() as u32,
            output_count: OUTPUTS.len() as u32,
            continuous_count: CONTINUOUS.len() as u32,
            discrete_count: DISCRETE.len() as u32,
            kind: parts::Text::new(<$controller as Controller>::KIND),
            doc: parts::Text::new(<$controller as Controller>::DOC),
            parameters: PARAMETERS.as_ptr(),
            input_ports: INPUTS.as_ptr(),
            output_ports: OUTPUTS.as_ptr(),
            continuous_states: CONTINUOUS.as_ptr(),
            discrete_states: DISCRETE.as_ptr(),
            check: Some(parts::check::<$controller>),
            sample_time: Some(parts::sample_time::<$controller>),
            reset: Some(parts::reset::<$controller>),
            outputs: Some(parts::outputs::<$controller>),
            update: Some(parts::update::<$controller>),
            derivatives: Some(parts::derivatives::<$controller>),
        }
    }};
}

/// A static array for each list of a controller, under the name of the list.
#[doc(hidden)]
#[macro_export]
macro_rules! rows {
    ($controller:ty, $($list:ident),+) => { $(
        static $list: [parts::Quantity; <$controller as Controller>::$list.len()] =
            parts::rows(<$controller as Controller>::$list, <$controller as Controller>::INPUTS);
    )+ };
}
