//! What users read when the library of a plug-in does not load. Each text stands here as it is shown.

use crate::common::{compile, fresh, load, refused, set};
use expect_test::{Expect, expect};

#[test]
fn what_is_not_there() {
    let folder = fresh("missing");
    std::fs::write(folder.0.join("libcascade.so"), "").unwrap();
    std::fs::create_dir(folder.0.join("empty")).unwrap();
    refused(
        &folder,
        "../nowhere/x.so",
        "B",
        set([]),
        expect![[r#"
        [plugin_missing] library: there is no plug-in `../nowhere/x.so`
        help: looked for `[folder]/../nowhere/x.so`
    "#]],
    );
    refused(
        &folder,
        "libcascad.so",
        "B",
        set([]),
        expect![[r#"
        [plugin_missing] library: there is no plug-in `libcascad.so`
        help: looked for `[folder]/libcascad.so`; did you mean `libcascade.so` there?
    "#]],
    );
    refused(
        &folder,
        "empty",
        "B",
        set([]),
        expect![[r#"
        [plugin_missing] library: the folder `empty` holds no `Cargo.toml`, `plugin.toml`, C or C++ sources
        help: name a built library, or a folder with the sources of one
    "#]],
    );
}

#[cfg(target_os = "linux")]
#[test]
fn what_is_no_library() {
    let folder = fresh("text");
    std::fs::write(
        folder.0.join("notes.so"),
        "this is a text, and long enough to be looked at as a library\n",
    )
    .unwrap();
    refused(
        &folder,
        "notes.so",
        "B",
        set([]),
        expect![[r#"
        [plugin_symbol] library: `[folder]/notes.so` is not a library that can be loaded: file too short
    "#]],
    );
}

#[test]
fn libraries_that_are_no_plugin_or_of_another_version() {
    let folder = fresh("version");
    let check = |definition: &str, expected: Expect| {
        compile(&folder, "lib.so", "table.c", &[definition]);
        refused(&folder, "lib.so", "Factor", set([]), expected);
    };
    check(
        "ENTRY=another_symbol",
        expect![[r#"
        [plugin_symbol] library: `[folder]/lib.so` is not a blocksim plug-in: it does not export `blocksim_plugin_v1`
        help: in Rust, write `export_plugin!("name", [Controller]);` and build a `cdylib`; in C, define `blocksim_plugin_v1`
    "#]],
    );
    check(
        "ENTRY=blocksim_plugin_v2",
        expect![[r#"
            [plugin_abi] library: `[folder]/lib.so` was built for version 2 of the plug-in ABI, but this blocksim has version 1
            help: use a newer blocksim, or build the plug-in with the `blocksim-controller` or header of this one
        "#]],
    );
    check(
        "MAJOR=2",
        expect![[r#"
            [plugin_abi] library: `[folder]/lib.so` was built for version 2 of the plug-in ABI, but this blocksim has version 1
            help: use a newer blocksim, or build the plug-in with the `blocksim-controller` or header of this one
        "#]],
    );
    check(
        "MAJOR=0",
        expect![[r#"
            [plugin_abi] library: `[folder]/lib.so` was built for version 0 of the plug-in ABI, but this blocksim has version 1
            help: build the plug-in again with the `blocksim-controller` or header of this blocksim
        "#]],
    );
    check(
        "MAGIC={\"other\"}",
        expect![[r#"
        [plugin_symbol] library: `[folder]/lib.so` is not a blocksim plug-in: its table is of something else
    "#]],
    );
    check(
        "TABLE=0",
        expect![[r#"
        [plugin_symbol] library: `[folder]/lib.so` holds no plug-in, or more than one
        help: put what plug-ins share into a crate without `export_plugin!`
    "#]],
    );
}

#[test]
fn tables_that_break_the_rules() {
    let folder = fresh("broken");
    let check = |definitions: &[&str], expected: Expect| {
        compile(&folder, "lib.so", "table.c", definitions);
        refused(&folder, "lib.so", "Factor", set([]), expected);
    };
    check(
        &["PLUGIN_SIZE=8"],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: the table of the plug-in has a size that no version has
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
    check(
        &["BLOCK_SIZE=16"],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: block 0 is NULL or has a size that no version has
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
    check(
        &["BLOCK_COUNT=4000000000"],
        expect![[r#"
            [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: it claims to have 4000000000 blocks
            help: fix the plug-in; `blocksim_plugin.h` states the rules
        "#]],
    );
    check(
        &["BLOCKS=0"],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: block 0 is NULL or has a size that no version has
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
    check(
        &["INPUT_COUNT=4000000000"],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: the inputs of `Factor`: there are 4000000000 of them
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
    check(
        &["INPUTS=0"],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: the inputs of `Factor`: number 0 is NULL or has a size that no version has
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
    check(
        &["KIND=\"two words\""],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: `two words` is not a valid name for a block
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
    check(
        &["KIND=\"\\xff\""],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: the name of block 0 is not UTF-8 text
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
    check(
        &["INPUT_NAME=\"\""],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: the inputs of `Factor`: `` (number 0) is not a valid name
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
    check(
        &["INPUT_NAME=\"y\""],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: `Factor` has two ports `y`
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
    check(
        &["OUTPUT_LENGTH=0"],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: the outputs of `Factor`: `y` has 0 numbers
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
    check(
        &["UNIT=\"furlong\""],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: the outputs of `Factor`: the unit `furlong` of `y`: unknown unit `furlong`
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
    check(
        &["UNIT=\"mm\""],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: the outputs of `Factor`: the unit `mm` of `y` is not SI; numbers cross the border in `m`
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
    check(
        &["READS=4"],
        expect![[r#"
            [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: `Factor` declares that output `y` reads an input that it does not have
            help: fix the plug-in; `blocksim_plugin.h` states the rules
        "#]],
    );
    check(
        &["OUTPUTS=0"],
        expect![[r#"
        [plugin_abi] library: `[folder]/lib.so` breaks the rules of plug-ins: `Factor` has outputs, but no function `outputs`
        help: fix the plug-in; `blocksim_plugin.h` states the rules
    "#]],
    );
}

#[test]
fn crates_that_do_not_build() {
    let folder = fresh("crates");
    let write = |name: &str, lib: &str, code: &str| {
        let root = folder.0.join(name);
        std::fs::create_dir_all(root.join("src")).unwrap();
        let package = name.replace(' ', "-");
        let manifest = format!("[package]\nname = \"{package}\"\nedition = \"2024\"\n{lib}\n[workspace]\n");
        std::fs::write(root.join("Cargo.toml"), manifest).unwrap();
        std::fs::write(root.join("src/lib.rs"), code).unwrap();
    };
    let cdylib = "[lib]\ncrate-type = [\"cdylib\"]\n";
    write("quite wrong", cdylib, "compile_error!(\"no law yet\");\n");
    write("rlib", "", "");
    write("silent", cdylib, "");
    refused(
        &folder,
        "quite wrong",
        "B",
        set([]),
        expect![[r#"
            [plugin_build] library: the plug-in `quite wrong` does not build:
            error: no law yet
             --> src/lib.rs:1:1
              |
            1 | compile_error!("no law yet");
              | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^

            error: could not compile `quite-wrong` (lib) due to 1 previous error
            help: see `cargo build --release --manifest-path '[folder]/quite wrong/Cargo.toml'`
        "#]],
    );
    refused(
        &folder,
        "rlib",
        "B",
        set([]),
        expect![[r#"
        [plugin_build] library: the crate `rlib` builds no library that can be loaded
        help: write `[lib]` and `crate-type = ["cdylib", "rlib"]` into its `Cargo.toml`
    "#]],
    );
    let error = load(&folder, "silent", "B", set([])).unwrap_err();
    assert_eq!(error.code, "plugin_symbol", "it builds, but it is not a plug-in: {error:?}");
}
