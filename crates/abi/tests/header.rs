//! `include/blocksim_plugin.h` is `src/table.rs` in C: text for text, and in memory.
//!
//! After a change of `table.rs`: `UPDATE_HEADER=1 cargo test -p blocksim-abi --test header`.
#![cfg(unix)]

mod c_text;

use std::path::{Path, PathBuf};
use std::process::Command;

use blocksim_abi::read::{self, elements, read};
use blocksim_abi::*;

const TABLE_RS: &str = include_str!("../src/table.rs");

fn header_file() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("include/blocksim_plugin.h")
}

/// Calls the C compiler on `source` in the folder for test files; returns the product.
fn cc(source: &Path, product: &str, options: &[&str]) -> PathBuf {
    let product = Path::new(env!("CARGO_TARGET_TMPDIR")).join(product);
    let output = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"])
        .args(options)
        .arg("-I")
        .arg(header_file().parent().unwrap())
        .arg("-o")
        .arg(&product)
        .arg(source)
        .output()
        .expect("Rust on Unix links with `cc`, so it is there");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    product
}

#[test]
fn the_header_is_generated_from_the_table() {
    let generated = c_text::header(TABLE_RS);
    if std::env::var_os("UPDATE_HEADER").is_some() {
        std::fs::write(header_file(), &generated).unwrap();
    }
    let committed = std::fs::read_to_string(header_file()).unwrap();
    let differs = generated.lines().zip(committed.lines()).find(|(new, old)| new != old);
    assert!(generated == committed, "the header is not that of `table.rs`; first lines: {differs:#?}");
}

/// `struct.field offset` and `struct size` lines as Rust lays them out.
fn rust_layout() -> String {
    let mut lines = String::new();
    macro_rules! layout {
        ($($ty:ident { $($field:ident),* $(,)? })*) => { $(
            lines += &format!("{} {}\n", stringify!($ty), size_of::<$ty>());
            $( lines += &format!("{}.{} {}\n", stringify!($ty), stringify!($field),
                                 core::mem::offset_of!($ty, $field)); )*
        )* };
    }
    layout! {
        Text { data, length }
        Message { size, capacity, text }
        Quantity { size, length, name, unit, doc, default_value, reads }
        BlockTable { size, parameter_count, input_count, output_count, continuous_count, discrete_count, kind,
                     doc, parameters, input_ports, output_ports, continuous_states, discrete_states,
                     check, sample_time, reset, outputs, update, derivatives }
        PluginTable { size, abi_major, abi_minor, magic, name, version, blocks, block_count, reserved }
    }
    lines
}

#[test]
fn c_and_rust_lay_out_the_structs_alike() {
    let source = Path::new(env!("CARGO_TARGET_TMPDIR")).join("layout.c");
    std::fs::write(&source, c_text::layout_program(TABLE_RS)).unwrap();
    let program = cc(&source, "layout", &[]);
    let output = Command::new(program).output().unwrap();
    assert_eq!(String::from_utf8(output.stdout).unwrap(), rust_layout());
}

#[test]
fn a_plugin_in_c_is_read_and_called() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/c_gain.c");
    let library = cc(&source, "libc_gain.so", &["-shared", "-fPIC"]);
    // SAFETY: the library was compiled from the file above and keeps the contract of the table.
    unsafe {
        let library = libloading::Library::new(library).unwrap();
        let entry = library.get::<EntryFn>(SYMBOL).unwrap();
        let plugin = read(entry()).unwrap();
        assert!(read::is_plugin(&plugin));
        assert_eq!((plugin.abi_major, plugin.abi_minor), (ABI_MAJOR, ABI_MINOR));
        assert_eq!(plugin.name.as_str(), Some("c_gain"));

        let block = elements(plugin.blocks, plugin.block_count).next().unwrap().unwrap();
        assert_eq!(block.kind.as_str(), Some("Gain"));
        let k = elements(block.parameters, block.parameter_count).next().unwrap().unwrap();
        assert_eq!((k.name.as_str(), k.length, *k.default_value), (Some("k"), 1, 1.0));
        let y = elements(block.output_ports, block.output_count).next().unwrap().unwrap();
        assert_eq!(y.reads, 1);
        assert!(block.update.is_none() && block.sample_time.is_none());

        let mut buffer = [0; 64];
        let message = Message::new(&mut buffer);
        assert_eq!(block.check.unwrap()(&f64::NAN, &message), ERROR);
        assert_eq!(message::written(&buffer), "k is not a number");
        assert_eq!(block.check.unwrap()(&f64::NAN, std::ptr::null()), ERROR);

        let (none, mut out) = (std::ptr::null(), 0.0);
        let status = block.outputs.unwrap()(&2.5, 0.0, none, none, &-3.0, &mut out, &message);
        assert_eq!((status, out), (OK, -7.5));
    }
}
