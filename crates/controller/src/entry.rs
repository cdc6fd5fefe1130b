//! The exported symbol.
//!
//! It is defined here, once, and not by the macro in each plug-in: two plug-ins linked into one program
//! would define it twice. The macro enters the table of its plug-in into a registry instead; in a cdylib
//! that registry holds exactly the one table.

use crate::abi::PluginTable;

/// A table that `export_plugin!` entered.
#[doc(hidden)]
pub struct Registered(pub &'static PluginTable);

inventory::collect!(Registered);

/// The tables of all plug-ins that are linked into this program or library, in no particular order.
pub fn linked() -> impl Iterator<Item = &'static PluginTable> {
    inventory::iter::<Registered>().map(|registered| registered.0)
}

/// What a host calls after it has opened a library: the table of its plug-in.
///
/// NULL if there is none or more than one; the latter when a plug-in uses another one as a crate.
#[unsafe(no_mangle)]
pub extern "C" fn blocksim_plugin_v1() -> *const PluginTable {
    let mut tables = linked();
    match (tables.next(), tables.next()) {
        (Some(table), None) => table,
        _ => std::ptr::null(),
    }
}
