//! The plug-ins of the repository, called as a trait, through the table, and out of a loaded library:
//! the same bits. Two of them are linked into this program, which must not clash.

use std::path::PathBuf;

use blocksim_controller::abi::read::{elements, is_plugin, read};
use blocksim_controller::abi::{BlockTable, EntryFn, OK, PluginTable, SYMBOL};
use blocksim_controller::{Context, Controller, Values, linked};
use blocksim_plugin_cascade::Cascade;
use blocksim_plugin_pid::Pid;

/// The library beside this test's binary, built with it.
fn library(crate_name: &str) -> PathBuf {
    let file = format!("{}{crate_name}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    std::env::current_exe().unwrap().with_file_name(file)
}

/// Loads a plug-in for the rest of the process.
fn load(crate_name: &str) -> &'static PluginTable {
    // SAFETY: a plug-in of this repository.
    unsafe {
        let library = Box::leak(Box::new(libloading::Library::new(library(crate_name)).unwrap()));
        let entry = library.get::<EntryFn>(SYMBOL).unwrap();
        entry().as_ref().expect("a library of one plug-in has a table")
    }
}

fn first_block(table: &'static PluginTable) -> BlockTable {
    // SAFETY: tables of `export_plugin!`.
    unsafe { elements(table.blocks, table.block_count).next().unwrap().unwrap() }
}

/// Outputs and states of 200 samples with inputs that reach all limits.
fn through_table(block: &BlockTable, params: &[f64], inputs: usize) -> Vec<u64> {
    let mut xd = vec![0.0; block.discrete_count as usize];
    let mut bits = Vec::new();
    // SAFETY: all quantities of these blocks are numbers, so counts are lengths.
    unsafe {
        let (none, no_state, m) = (std::ptr::null(), std::ptr::null_mut(), std::ptr::null());
        assert_eq!(block.check.unwrap()(params.as_ptr(), m), OK);
        assert_eq!(block.reset.unwrap()(params.as_ptr(), no_state, xd.as_mut_ptr(), m), OK);
        for k in 0..200 {
            let (t, u, mut y) = (1e-3 * k as f64, signal(k, inputs), 0.0);
            let mut next = xd.clone();
            let p = params.as_ptr();
            assert_eq!(block.outputs.unwrap()(p, t, none, xd.as_ptr(), u.as_ptr(), &mut y, m), OK);
            let status = block.update.unwrap()(p, t, none, xd.as_ptr(), u.as_ptr(), next.as_mut_ptr(), m);
            assert_eq!(status, OK);
            xd = next;
            bits.push(y.to_bits());
            bits.extend(xd.iter().map(|x| x.to_bits()));
        }
    }
    bits
}

fn through_trait<T: Controller>(params: &[f64], inputs: usize) -> Vec<u64> {
    let mut xd = vec![0.0; T::DISCRETE.len()];
    let mut bits = Vec::new();
    T::reset(Values::of(params), Values::of_mut(&mut []), Values::of_mut(&mut xd)).unwrap();
    for k in 0..200 {
        let u = signal(k, inputs);
        let c = Context::new(1e-3 * k as f64, params, &[], &xd, &u);
        let (mut y, mut next) = ([0.0], xd.clone());
        T::outputs(&c, Values::of_mut(&mut y)).unwrap();
        T::update(&c, Values::of_mut(&mut next)).unwrap();
        xd = next;
        bits.push(y[0].to_bits());
        bits.extend(xd.iter().map(|x| x.to_bits()));
    }
    bits
}

fn signal(k: usize, inputs: usize) -> Vec<f64> {
    (0..inputs).map(|i| (0.05 * k as f64 * (1.0 + 0.3 * i as f64)).sin() * 2.0).collect()
}

const PID: [f64; 9] = [2.0, 30.0, 0.05, 50.0, 1e-3, -3.0, 3.0, 0.5, 0.1];
const CASCADE: [f64; 8] = [20.0, 1.0, 20.0, 0.005, 4.0, 0.12, 1e-3, 0.2];

#[test]
fn pid_gives_the_same_bits_built_in_and_loaded() {
    let expected = through_trait::<Pid>(&PID, 1);
    assert_eq!(through_table(&first_block(blocksim_plugin_pid::table()), &PID, 1), expected);
    assert_eq!(through_table(&first_block(load("blocksim_plugin_pid")), &PID, 1), expected);
}

#[test]
fn cascade_gives_the_same_bits_built_in_and_loaded() {
    let expected = through_trait::<Cascade>(&CASCADE, 6);
    assert_eq!(through_table(&first_block(blocksim_plugin_cascade::table()), &CASCADE, 6), expected);
    assert_eq!(through_table(&first_block(load("blocksim_plugin_cascade")), &CASCADE, 6), expected);
}

#[test]
fn a_loaded_library_holds_its_own_table_only() {
    for (crate_name, name) in [("blocksim_plugin_pid", "pid"), ("blocksim_plugin_cascade", "cascade")] {
        // SAFETY: tables of `export_plugin!`.
        let table = unsafe { read(load(crate_name)).unwrap() };
        assert!(is_plugin(&table));
        // SAFETY: as above.
        assert_eq!(unsafe { table.name.as_str() }, Some(name));
    }
}

#[test]
fn both_plugins_are_registered_in_a_program_that_links_them() {
    for table in [blocksim_plugin_pid::table(), blocksim_plugin_cascade::table()] {
        assert!(linked().any(|linked| std::ptr::eq(linked, table)));
    }
    assert!(blocksim_controller::blocksim_plugin_v1().is_null(), "two plug-ins are not one");
}
