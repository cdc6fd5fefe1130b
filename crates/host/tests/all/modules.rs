//! Controllers as WebAssembly: the same bits as a library, and every way in which a module can be wrong.
#![allow(clippy::print_stderr, reason = "a test that cannot run here names the reason")]

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use blocksim_block::testing::Bench;
use blocksim_block::{Block, LoadError};
use blocksim_controller::testing::Bench as BuiltIn;
use blocksim_host::{Plugin, Target};
use expect_test::{Expect, expect};

use crate::common::{Folder, What, bare, failure, fresh, load, set};
use crate::shipped::{bits_built_in, bits_of_block};

/// Addresses of the parts of a table.
const PLUGIN: usize = 1024;
const BLOCK: usize = 1072;
const PARAMETER: usize = 1160;
const INPUT: usize = 1208;
const OUTPUT: usize = 1256;
const STATE: usize = 1304;
const TEXTS: usize = 1400;

/// The parts of a module in the text format. The good one is `Gain`, y = k u + n at every 0.1 s, where n counts samples.
struct Parts {
    first: String,
    memory: String,
    table: String,
    entry: String,
    check: String,
    outputs: String,
    update: String,
    more: String,
    /// What the memory holds from [`PLUGIN`] on.
    image: Vec<u8>,
}

impl Parts {
    fn put(&mut self, address: usize, words: &[u32]) {
        for (i, word) in words.iter().enumerate() {
            let at = address - PLUGIN + 4 * i;
            self.image[at..at + 4].copy_from_slice(&word.to_le_bytes());
        }
    }

    /// Writes a text and gives its address and length.
    fn text(&mut self, text: &str) -> [u32; 2] {
        let address = self.image.len() + PLUGIN;
        self.image.extend(text.as_bytes());
        [address as u32, text.len() as u32]
    }

    fn quantity(&mut self, address: usize, name: &str, reads: u32) {
        let [data, length] = self.text(name);
        self.put(address, &[48, 1, data, length, 0, 0, 0, 0, 0, 0, reads, 0]);
    }

    fn good() -> Parts {
        let mut parts = Parts {
            first: String::new(),
            memory: r#"(memory (export "memory") 1)"#.to_owned(),
            table: r#"(table (export "__indirect_function_table") 6 funcref)"#.to_owned(),
            entry: format!(r#"(func (export "blocksim_plugin_v1") (result i32) i32.const {PLUGIN})"#),
            check: "i32.const 0".to_owned(),
            outputs: "local.get 5 local.get 0 f64.load local.get 4 f64.load f64.mul
                      local.get 3 f64.load f64.add f64.store i32.const 0"
                .to_owned(),
            update: "local.get 5 local.get 3 f64.load f64.const 1 f64.add f64.store i32.const 0".to_owned(),
            more: String::new(),
            image: vec![0; TEXTS - PLUGIN],
        };
        let [name, length] = parts.text("module");
        let magic = [u32::from_le_bytes(*b"BLKS"), u32::from_le_bytes(*b"IMP1")];
        parts.put(PLUGIN, &[44, 1, magic[0], magic[1], name, length, 0, 0, BLOCK as u32, 1, 0]);
        let [name, length] = parts.text("Gain");
        let lists = [PARAMETER, INPUT, OUTPUT, 0, STATE].map(|at| at as u32);
        parts.put(BLOCK, &[84, 1, 1, 1, 0, 1, name, length, 0, 0]);
        parts.put(BLOCK + 40, &lists);
        parts.put(BLOCK + 60, &[1, 2, 0, 3, 4, 0]);
        parts.quantity(PARAMETER, "k", 0);
        parts.quantity(INPUT, "u", 0);
        parts.quantity(OUTPUT, "y", 1);
        parts.quantity(STATE, "n", 0);
        parts
    }

    fn write(&self, file: &Path) {
        let mut image = String::new();
        self.image.iter().for_each(|byte| write!(image, "\\{byte:02x}").unwrap());
        let evaluation = "(param i32 f64 i32 i32 i32 i32 i32) (result i32)";
        let Parts { first, memory, table, entry, check, outputs, update, more, .. } = self;
        let text = format!(
            r#"(module {first} {memory} {table} {entry} {more}
                (func $check (param i32 i32) (result i32) {check})
                (func $sample_time (param i32 i32 i32) (result i32)
                    local.get 1 f64.const 0.1 f64.store i32.const 0)
                (func $outputs {evaluation} {outputs})
                (func $update {evaluation} {update})
                (func $other)
                (elem (i32.const 1) $check $sample_time $outputs $update $other)
                (data (i32.const {PLUGIN}) "{image}"))"#
        );
        std::fs::write(file, wat::parse_str(&text).unwrap_or_else(|error| panic!("{error}\n{text}")))
            .unwrap();
    }
}

type Change = fn(&mut Parts);

/// What becomes of each changed module, a line or two for each.
fn outcomes(name: &str, cases: &[(&str, Change)], outcome: impl Fn(&Folder) -> String, expected: Expect) {
    let mut text = String::new();
    for (case, change) in cases {
        let folder = fresh(&format!("{name}-{}", case.replace(' ', "-")));
        let mut parts = Parts::good();
        change(&mut parts);
        parts.write(&folder.0.join("law.wasm"));
        let place = folder.0.canonicalize().unwrap();
        let outcome = outcome(&folder).replace(place.to_str().unwrap(), "[folder]");
        writeln!(text, "{case}: {outcome}").unwrap();
    }
    expected.assert_eq(&text);
}

fn gain(folder: &Folder) -> Result<blocksim_host::Plugin, blocksim_block::LoadError> {
    load(folder, "law.wasm", "Gain", set([("k", bare(3.0))]))
}

fn refusal(folder: &Folder) -> String {
    match gain(folder) {
        Ok(_) => "fine".to_owned(),
        Err(error) => {
            let help = error.help.map_or(String::new(), |help| format!("\n  help: {help}"));
            format!("[{}] {}: {}{help}", error.code, error.param, error.message)
        }
    }
}

#[test]
fn a_module_is_a_block_like_any_other() {
    let folder = fresh("module");
    Parts::good().write(&folder.0.join("law.wasm"));
    let mut bench = Bench::new(gain(&folder).unwrap());
    let outputs = [0.5, 0.5, -1.0].map(|u| {
        bench.set(0, &[u]);
        bench.hit()[0]
    });
    assert_eq!(outputs, [1.5, 2.5, -1.0]);
    assert_eq!(bench.d, [3.0]);
}

#[test]
fn each_thread_has_an_instance_of_its_own() {
    let folder = fresh("module-threads");
    let mut parts = Parts::good();
    // Counts its calls in its memory, against the contract.
    parts.outputs = "i32.const 512 i32.const 512 f64.load f64.const 1 f64.add f64.store
                     local.get 5 i32.const 512 f64.load f64.store i32.const 0"
        .to_owned();
    parts.write(&folder.0.join("law.wasm"));
    let plugin = gain(&folder).unwrap();
    let first = |plugin: blocksim_host::Plugin| {
        let mut bench = Bench::new(plugin);
        bench.set(0, &[1.0]);
        (bench.hit()[0], bench.hit()[0])
    };
    let others: Vec<_> = (0..3)
        .map(|_| {
            let plugin = plugin.clone();
            std::thread::spawn(move || first(plugin))
        })
        .collect();
    for other in others {
        assert_eq!(other.join().unwrap(), (1.0, 2.0));
    }
    assert_eq!(first(plugin), (1.0, 2.0));
}

#[test]
fn a_module_that_makes_no_sense_is_refused() {
    let cases: &[(&str, Change)] = &[
        ("good", |_| ()),
        ("import", |m| m.first = r#"(import "env" "sin" (func (param f64) (result f64)))"#.to_owned()),
        ("no symbol", |m| m.entry.clear()),
        ("symbol with arguments", |m| {
            m.entry =
                r#"(func (export "blocksim_plugin_v1") (param i32) (result i32) i32.const 0)"#.to_owned();
        }),
        ("no memory", |m| m.memory = "(memory 1)".to_owned()),
        ("no table of functions", |m| m.table = "(table 6 funcref)".to_owned()),
        ("null", |m| m.entry = m.entry.replace("1024", "0")),
        ("table outside", |m| m.entry = m.entry.replace("1024", "70000")),
        ("table at odd address", |m| m.entry = m.entry.replace("1024", "1025")),
        ("small table", |m| m.put(PLUGIN, &[40])),
        ("wrong magic", |m| m.put(PLUGIN + 8, &[7])),
        ("other version", |m| m.put(PLUGIN + 4, &[2])),
        ("no blocks", |m| m.put(PLUGIN + 36, &[0])),
        ("blocks NULL", |m| m.put(PLUGIN + 32, &[0])),
        ("many blocks", |m| m.put(PLUGIN + 36, &[5000])),
        ("blocks outside", |m| m.put(PLUGIN + 36, &[1000])),
        ("small block", |m| m.put(BLOCK, &[80])),
        ("text outside", |m| m.put(BLOCK + 32, &[65_530, 100])),
        ("text beyond all", |m| m.put(BLOCK + 32, &[u32::MAX, u32::MAX])),
        ("text not UTF-8", |m| {
            m.image.extend([0xff, 0xfe]);
            let at = PLUGIN + m.image.len() - 2;
            m.put(BLOCK + 24, &[at as u32, 2]);
        }),
        ("list outside", |m| m.put(BLOCK + 40, &[65_528])),
        ("default outside", |m| m.put(PARAMETER + 32, &[65_530])),
        ("many numbers", |m| m.put(PARAMETER + 4, &[u32::MAX])),
        ("unit", |m| {
            let unit = m.text("parsec");
            m.put(INPUT + 16, &unit);
        }),
        ("function outside", |m| m.put(BLOCK + 60, &[6])),
        ("function far outside", |m| m.put(BLOCK + 60, &[u32::MAX])),
        ("function absent", |m| {
            m.table = m.table.replace('6', "7");
            m.put(BLOCK + 60, &[6]);
        }),
        ("function of another type", |m| m.put(BLOCK + 60, &[5])),
        ("no outputs", |m| m.put(BLOCK + 72, &[0])),
        ("large memory", |m| m.memory = r#"(memory (export "memory") 1025)"#.to_owned()),
        ("large table", |m| m.table = m.table.replace('6', "70000")),
        ("fixed memory", |m| m.memory = r#"(memory (export "memory") 1 1)"#.to_owned()),
        ("many tables", |m| m.more = "(table 1 funcref) ".repeat(9)),
        ("loop at start", |m| m.more = "(func $start (loop br 0)) (start $start)".to_owned()),
        ("loop in symbol", |m| {
            m.entry =
                r#"(func (export "blocksim_plugin_v1") (result i32) (loop br 0) i32.const 0)"#.to_owned();
        }),
        ("trap at start", |m| m.more = r#"(func (export "__wasm_call_ctors") unreachable)"#.to_owned()),
        ("data outside", |m| m.more = r#"(data (i32.const 65535) "abc")"#.to_owned()),
        ("loop in check", |m| m.check = "(loop br 0) i32.const 0".to_owned()),
        ("trap in check", |m| m.check = "unreachable".to_owned()),
        ("check refuses", |m| {
            m.check = "local.get 1 i32.load offset=8 i32.const 107 i32.store i32.const 1".to_owned();
        }),
        ("check writes", |m| m.check = "local.get 0 f64.const 1 f64.store i32.const 0".to_owned()),
    ];
    outcomes(
        "refused",
        cases,
        refusal,
        expect![[r#"
            good: fine
            import: [plugin_symbol] library: `[folder]/law.wasm` is not a blocksim plug-in: it wants the import `env.sin`, but modules are given none
              help: build it for `wasm32-unknown-unknown`, and link what it calls into it
            no symbol: [plugin_symbol] library: `[folder]/law.wasm` is not a blocksim plug-in: it does not export `blocksim_plugin_v1`
              help: in Rust, write `export_plugin!("name", [Controller]);` and build a `cdylib`; in C, define `blocksim_plugin_v1`
            symbol with arguments: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: `blocksim_plugin_v1` takes arguments, or does not return an address
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            no memory: [plugin_symbol] library: `[folder]/law.wasm` is not a blocksim plug-in: it does not export its memory as `memory`
              help: export it
            no table of functions: [plugin_symbol] library: `[folder]/law.wasm` is not a blocksim plug-in: it does not export its table of functions as `__indirect_function_table`
              help: link it with `--export-table`, in Rust: `cargo rustc --release --target wasm32-unknown-unknown -- -C link-arg=--export-table`
            null: [plugin_symbol] library: `[folder]/law.wasm` holds no plug-in, or more than one
              help: put what plug-ins share into a crate without `export_plugin!`
            table outside: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: its table leads to 4 bytes at address 70000, but its memory has 65536 bytes
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            table at odd address: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: the table of the plug-in has a size that no version has
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            small table: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: the table of the plug-in has a size that no version has
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            wrong magic: [plugin_symbol] library: `[folder]/law.wasm` is not a blocksim plug-in: its table is of something else
            other version: [plugin_abi] library: `[folder]/law.wasm` was built for version 2 of the plug-in ABI, but this blocksim has version 1
              help: use a newer blocksim, or build the plug-in with the `blocksim-controller` or header of this one
            no blocks: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: it claims to have 0 blocks
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            blocks NULL: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: block 0 is NULL or has a size that no version has
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            many blocks: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: it claims to have 5000 blocks
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            blocks outside: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: its table leads to 4 bytes at address 65584, but its memory has 65536 bytes
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            small block: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: block 0 is NULL or has a size that no version has
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            text outside: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: its table leads to 100 bytes at address 65530, but its memory has 65536 bytes
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            text beyond all: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: its table describes more than 8 MB
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            text not UTF-8: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: the name of block 0 is not UTF-8 text
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            list outside: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: the parameters of `Gain`: number 0 is NULL or has a size that no version has
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            default outside: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: its table leads to 8 bytes at address 65530, but its memory has 65536 bytes
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            many numbers: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: the parameters of `Gain`: `k` has 4294967295 numbers
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            unit: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: the inputs of `Gain`: the unit `parsec` of `u`: unknown unit `parsec`
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            function outside: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: `check` of `Gain` is function 6, but there are 6
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            function far outside: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: `check` of `Gain` is function 4294967295, but there are 6
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            function absent: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: `check` of `Gain` is function 6, which is NULL
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            function of another type: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: `check` of `Gain` is function 5, which has other arguments or results than it must
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            no outputs: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: `Gain` has outputs, but no function `outputs`
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            large memory: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: its start requested more memory than the 64 MB that a module may have
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            large table: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: its start requested a table of more than the 65536 functions that a module may have
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            fixed memory: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: its memory cannot grow from 65536 bytes by 2032 bytes for buffers; link it without a maximum, modules may have 64 MB
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            many tables: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: its start failed: tried to instantiate too many tables
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            loop at start: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: its start did not return within 50 million instructions: a loop without end?
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            loop in symbol: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: `blocksim_plugin_v1` did not return within 50 million instructions: a loop without end?
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            trap at start: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: `__wasm_call_ctors` reached an `unreachable` instruction: a panic, or `abort`
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            data outside: [plugin_abi] library: `[folder]/law.wasm` breaks the rules of plug-ins: its start touched an address outside of its memory
              help: fix the plug-in; `blocksim_plugin.h` states the rules
            loop in check: [plugin_crash] parameters: the plug-in stopped: `check` did not return within 50 million instructions: a loop without end?
            trap in check: [plugin_crash] parameters: the plug-in stopped: `check` reached an `unreachable` instruction: a panic, or `abort`
            check refuses: [plugin_parameter] parameters: k
            check writes: [plugin_crash] parameters: the plug-in broke a rule: it changed its parameter `k`, which it may only read
        "#]],
    );
}

#[test]
fn a_file_that_is_no_module_is_refused() {
    let folder = fresh("no-module");
    let mut text = String::new();
    let simd = r#"(module (func (result v128) v128.const i32x4 1 2 3 4))"#;
    let simd = wat::parse_str(simd).unwrap();
    let whole = wat::parse_str("(module)").unwrap();
    for (case, bytes) in [
        ("empty", &b""[..]),
        ("text", b"(module)"),
        ("ELF", b"\x7fELF\x02\x01\x01\0"),
        ("cut", &whole[..6]),
        ("component", b"\0asm\x0d\0\x01\0"),
        ("SIMD", &simd),
    ] {
        std::fs::write(folder.0.join("law.wasm"), bytes).unwrap();
        let place = folder.0.canonicalize().unwrap();
        writeln!(text, "{case}: {}", refusal(&folder).replace(place.to_str().unwrap(), "[folder]")).unwrap();
    }
    std::fs::remove_file(folder.0.join("law.wasm")).unwrap();
    assert!(refusal(&folder).starts_with("[plugin_missing] library: there is no plug-in `law.wasm`"));
    expect![[r#"
        empty: [plugin_symbol] library: `[folder]/law.wasm` is not a WebAssembly module that can be run: it begins in another way than WebAssembly
          help: build it for `wasm32-unknown-unknown`; vectors (SIMD), threads and 64-bit memories are not supported
        text: [plugin_symbol] library: `[folder]/law.wasm` is not a WebAssembly module that can be run: it begins in another way than WebAssembly
          help: build it for `wasm32-unknown-unknown`; vectors (SIMD), threads and 64-bit memories are not supported
        ELF: [plugin_symbol] library: `[folder]/law.wasm` is not a WebAssembly module that can be run: it begins in another way than WebAssembly
          help: build it for `wasm32-unknown-unknown`; vectors (SIMD), threads and 64-bit memories are not supported
        cut: [plugin_symbol] library: `[folder]/law.wasm` is not a WebAssembly module that can be run: unexpected end-of-file (at offset 0x4)
          help: build it for `wasm32-unknown-unknown`; vectors (SIMD), threads and 64-bit memories are not supported
        component: [plugin_symbol] library: `[folder]/law.wasm` is not a WebAssembly module that can be run: it is a component, or of another version of WebAssembly
          help: build it for `wasm32-unknown-unknown`; vectors (SIMD), threads and 64-bit memories are not supported
        SIMD: [plugin_symbol] library: `[folder]/law.wasm` is not a WebAssembly module that can be run: SIMD support is not enabled (at offset 0xb)
          help: build it for `wasm32-unknown-unknown`; vectors (SIMD), threads and 64-bit memories are not supported
    "#]].assert_eq(&text);
}

#[test]
fn a_module_that_fails_in_a_run_is_named_with_its_deed() {
    // The work of a module is limited, and on a busy computer that much takes longer than a call may.
    blocksim_host::set_call_limit(std::time::Duration::from_secs(600));
    let cases: &[(&str, Change)] = &[
        ("good", |_| ()),
        ("endless loop", |m| m.outputs = "(loop br 0) i32.const 0".to_owned()),
        ("unreachable", |m| m.outputs = "unreachable".to_owned()),
        ("panic with a text", |m| {
            m.outputs = "local.get 6 i32.load offset=8 i32.const 0x706f6f i32.store unreachable".to_owned();
        }),
        ("foreign memory", |m| m.outputs = "i32.const -8 f64.const 1 f64.store i32.const 0".to_owned()),
        ("division", |m| m.outputs = "i32.const 1 i32.const 0 i32.div_s".to_owned()),
        ("overflow", |m| m.outputs = "i32.const 0x80000000 i32.const -1 i32.div_s".to_owned()),
        ("conversion", |m| m.outputs = "f64.const 1e300 i32.trunc_f64_s".to_owned()),
        ("recursion", |m| {
            m.more = "(func $deep (result i32) call $deep i32.const 1 i32.add)".to_owned();
            m.outputs = "call $deep".to_owned();
        }),
        ("NULL function", |m| m.outputs = "i32.const 0 call_indirect (result i32)".to_owned()),
        ("function outside", |m| m.outputs = "i32.const 99 call_indirect (result i32)".to_owned()),
        ("function of another type", |m| m.outputs = "i32.const 5 call_indirect (result i32)".to_owned()),
        ("memory", |m| m.outputs = "i32.const 2000 memory.grow drop i32.const 0".to_owned()),
        ("unwritten", |m| m.outputs = "i32.const 0".to_owned()),
        ("behind its outputs", |m| {
            m.outputs = m.outputs.replace("f64.store", "f64.store offset=8");
        }),
        ("changes an input", |m| {
            m.outputs = format!("local.get 4 f64.const 9 f64.store {}", m.outputs);
        }),
        ("behind its message", |m| {
            m.outputs =
                format!("local.get 6 i32.load offset=8 i32.const 1 i32.store offset=1030 {}", m.outputs);
        }),
        ("not a number", |m| m.outputs = "local.get 5 f64.const nan f64.store i32.const 0".to_owned()),
        ("unknown status", |m| m.outputs = m.outputs.replace("i32.const 0", "i32.const 77")),
    ];
    let run = |folder: &Folder| {
        let plugin = gain(folder).unwrap();
        let outcome =
            failure(&plugin, &[2.0], &mut [1.0], What::Outputs).unwrap_or_else(|| "fine".to_owned());
        // The next call has an instance that is whole.
        let again = failure(&plugin, &[2.0], &mut [1.0], What::Outputs).unwrap_or_else(|| "fine".to_owned());
        assert_eq!(outcome, again);
        assert_eq!(failure(&plugin, &[2.0], &mut [1.0], What::Update), None);
        outcome
    };
    outcomes(
        "failing",
        cases,
        run,
        expect![[r#"
            good: fine
            endless loop: the plug-in `law.wasm` stopped: `outputs` did not return within 1000 million instructions: a loop without end?
            unreachable: the plug-in `law.wasm` stopped: `outputs` reached an `unreachable` instruction: a panic, or `abort`
            panic with a text: the plug-in `law.wasm` panicked: oop
            foreign memory: the plug-in `law.wasm` stopped: `outputs` touched an address outside of its memory
            division: the plug-in `law.wasm` stopped: `outputs` divided an integer by zero
            overflow: the plug-in `law.wasm` stopped: `outputs` overflowed in a division of integers or a conversion to an integer
            conversion: the plug-in `law.wasm` stopped: `outputs` overflowed in a division of integers or a conversion to an integer
            recursion: the plug-in `law.wasm` stopped: `outputs` overflowed its stack: a recursion without end?
            NULL function: the plug-in `law.wasm` stopped: `outputs` called a NULL function pointer
            function outside: the plug-in `law.wasm` stopped: `outputs` called a function pointer outside of its table of functions
            function of another type: the plug-in `law.wasm` stopped: `outputs` called a function pointer of another type
            memory: the plug-in `law.wasm` stopped: `outputs` requested more memory than the 64 MB that a module may have
            unwritten: the plug-in `law.wasm` broke a rule: it did not write its output `y`
            behind its outputs: the plug-in `law.wasm` broke a rule: it wrote behind the end of its outputs, which hold 1 number
            changes an input: the plug-in `law.wasm` broke a rule: it changed its input `u`, which it may only read
            behind its message: the plug-in `law.wasm` broke a rule: it wrote behind the 1024 bytes of its message
            not a number: the plug-in `law.wasm`: output `y` is NaN; inputs: u = 2
            unknown status: the plug-in `law.wasm` reported the unknown status 77
        "#]],
    );
}

const TARGET: &str = "wasm32-unknown-unknown";

/// Whether Rust has the target; where not, the tests of crates end.
fn has_target() -> bool {
    let rustc = Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]).output();
    let is_there =
        rustc.is_ok_and(|output| Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir());
    if !is_there {
        eprintln!("not tested: the target {TARGET} is not installed");
    }
    is_there
}

/// Builds the crate in a folder as a module, with the crates that this computer has; `None` where the target is not installed.
fn module(folder: &Path, file: &str) -> Option<String> {
    if !has_target() {
        return None;
    }
    let products = Path::new(env!("CARGO_TARGET_TMPDIR")).join("modules");
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["rustc", "--quiet", "--offline", "--release", "--target", TARGET, "--target-dir"]);
    cargo.arg(&products).args(["--", "-C", "link-arg=--export-table"]).current_dir(folder);
    let output = cargo.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() && said.contains("offline") {
        eprintln!("not tested: crates for {TARGET} are not on this computer: {said}");
        return None;
    }
    assert!(output.status.success(), "{cargo:?}: {said}");
    Some(products.join(TARGET).join("release").join(file).to_str().unwrap().to_owned())
}

fn shipped(name: &str) -> Option<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../plugins").join(name);
    module(&folder, &format!("blocksim_plugin_{name}.wasm"))
}

/// Writes the crate of a controller `Gain` that wants inputs below 1.
fn write_crate(folder: &Path) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let manifest = format!(
        "[package]\nname = \"law\"\nedition = \"2024\"\n[lib]\ncrate-type = [\"cdylib\"]\n[dependencies]\n\
         blocksim-controller = {{ path = {:?} }}\n[workspace]\n",
        root.join("crates/controller")
    );
    let law = r#"
        use blocksim_controller::prelude::*;
        pub struct Gain;
        const K: Parameter = Parameter::new(0, "k", "1", "");
        const U: Input = Input::new(0, "u", "", "");
        const Y: Output = Output::new(0, "y", "", "").reads(&[U]);
        impl Controller for Gain {
            const KIND: &'static str = "Gain";
            const DOC: &'static str = "";
            const PARAMETERS: &'static [Parameter] = &[K];
            const INPUTS: &'static [Input] = &[U];
            const OUTPUTS: &'static [Output] = &[Y];
            fn outputs(c: &Context, y: &mut Outputs) -> Outcome {
                assert!(c[U] < 1.0, "u is {}", c[U]);
                y[Y] = c[K] * c[U];
                Ok(())
            }
        }
        export_plugin!("law", [Gain]);
    "#;
    std::fs::create_dir(folder.join("src")).unwrap();
    std::fs::write(folder.join("Cargo.toml"), manifest).unwrap();
    std::fs::write(folder.join("src/lib.rs"), law).unwrap();
    // The versions that are on this computer.
    std::fs::copy(root.join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
}

#[test]
fn a_panic_in_rust_arrives_with_its_text() {
    let folder = fresh("module-panic");
    write_crate(&folder.0);
    let Some(file) = module(&folder.0, "law.wasm") else { return };
    std::fs::copy(file, folder.0.join("law.wasm")).unwrap();
    let plugin = gain(&folder).unwrap();
    let outcome = |u: f64| failure(&plugin, &[u], &mut [], What::Outputs);
    assert_eq!(outcome(0.5), None);
    assert_eq!(outcome(7.0).unwrap(), "the plug-in `law.wasm` panicked: u is 7");
    assert_eq!(outcome(0.5), None);
    assert_eq!(outcome(8.0).unwrap(), "the plug-in `law.wasm` panicked: u is 8");
}

/// A block of what `library` names, built as a module.
fn built_as_module(folder: &Folder, library: &str) -> Result<Plugin, LoadError> {
    let mut plugin = Plugin::new(library, "Gain", set([("k", bare(3.0))]));
    plugin.target = Target::Wasm;
    plugin.load(folder).map(|()| plugin)
}

#[test]
fn a_crate_is_built_as_a_module_where_the_diagram_says_so() {
    if !has_target() {
        return;
    }
    let folder = fresh("module-crate");
    let law = folder.0.join("law");
    std::fs::create_dir(&law).unwrap();
    write_crate(&law);
    let plugin = built_as_module(&folder, "law").unwrap();
    let outcome = |plugin: &Plugin, u: f64| failure(plugin, &[u], &mut [], What::Outputs);
    assert_eq!(outcome(&plugin, 0.5), None);
    assert_eq!(outcome(&plugin, 7.0).unwrap(), "the plug-in `law` panicked: u is 7");
    let file = law.join("target").join(TARGET).join("release/law.wasm");
    let built = std::fs::metadata(&file).unwrap().modified().unwrap();
    // What has not changed is not built once more; what has is.
    built_as_module(&folder, "law").unwrap();
    assert_eq!(std::fs::metadata(&file).unwrap().modified().unwrap(), built);
    let source = law.join("src/lib.rs");
    let text = std::fs::read_to_string(&source).unwrap();
    std::fs::write(&source, text.replace("c[U] < 1.0", "c[U] < 9.0")).unwrap();
    // Blocks of one diagram share an answer for so long.
    std::thread::sleep(std::time::Duration::from_millis(2100));
    assert_eq!(outcome(&built_as_module(&folder, "law").unwrap(), 7.0), None);
}

#[test]
fn what_cannot_be_built_as_a_module_is_refused_with_a_remedy() {
    let folder = fresh("module-of-others");
    std::fs::write(folder.0.join("law.so"), "").unwrap();
    std::fs::create_dir(folder.0.join("law")).unwrap();
    std::fs::write(folder.0.join("law/law.c"), "").unwrap();
    let said = |library: &str| {
        let error = built_as_module(&folder, library).unwrap_err();
        format!("[{}] {}: {}\nhelp: {}\n", error.code, error.param, error.message, error.help.unwrap())
    };
    expect![[r#"
        [plugin_build] library: the plug-in `law.so` is a built library and cannot become a module
        help: name the folder of its crate, or a module (`.wasm`), or leave out `target: Wasm`
        [plugin_build] library: the plug-in `law` is written in C or C++, which blocksim does not build as a module
        help: leave out `target: Wasm`, or build it with clang as in `blocksim manual plugins` and name the module: `library: "law.wasm"`
    "#]]
    .assert_eq(&[said("law.so"), said("law")].concat());
}

#[test]
fn the_shipped_controllers_give_the_same_bits_as_modules() {
    let (Some(pid), Some(cascade)) = (shipped("pid"), shipped("cascade")) else { return };
    let numbers = [("kp", 2.0), ("ki", 30.0), ("kd", 0.05), ("n", 50.0), ("ts", 1e-3), ("theta", 0.5)];
    let limits = [("lower", -3.0), ("upper", 3.0), ("i0", 0.1)];
    let all: Vec<_> = numbers.into_iter().chain(limits).collect();
    let native = bits_built_in(BuiltIn::new(blocksim_plugin_pid::table(), "Pid", &all).unwrap(), 1, 1e-3);
    let parameters = all.iter().map(|(name, value)| ((*name).to_owned(), bare(*value))).collect();
    let block = load(&crate::common::here(), &pid, "Pid", parameters).unwrap();
    assert!(bits_of_block(block, 1, 1e-3) == native, "pid");

    let numbers = [("w1", 4.0), ("kd", 0.005), ("slip_limit", 0.12), ("ts", 0.002), ("u_start", 0.2)];
    let table = blocksim_plugin_cascade::table();
    let native = bits_built_in(BuiltIn::new(table, "Cascade", &numbers).unwrap(), 6, 0.002);
    let block =
        load(&crate::common::here(), &cascade, "Cascade", set(numbers.map(|(n, v)| (n, bare(v))))).unwrap();
    assert!(bits_of_block(block, 6, 0.002) == native, "cascade");

    // What a controller refuses, it refuses in the same words.
    let wrong = set([("kp", bare(1.0)), ("lower", bare(2.0)), ("upper", bare(1.0))]);
    let native = load(&crate::common::here(), "../../plugins/pid", "Pid", wrong.clone()).unwrap_err();
    let boxed = load(&crate::common::here(), &pid, "Pid", wrong).unwrap_err();
    assert_eq!((native.code, native.message), (boxed.code, boxed.message));
}
