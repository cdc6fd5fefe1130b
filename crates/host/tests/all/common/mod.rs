//! Plug-ins for tests: compiled from C, or built beside the tests.
#![allow(dead_code, reason = "each test program uses a part")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use blocksim_block::{
    AnyCode, Block, CodePolicy, Context, Fault, Files, Given, LoadError, ParamValue, Scratch,
};
use blocksim_host::Plugin;
use blocksim_signal::{Quantity, Unit, Value};
use expect_test::Expect;

/// Files of a diagram in this folder.
pub struct Folder(
    pub PathBuf,
    /// Whether the folder was made for one test and goes with it.
    bool,
);

impl Files for Folder {
    fn read(&self, path: &str) -> Result<String, String> {
        std::fs::read_to_string(self.0.join(path)).map_err(|e| e.to_string())
    }

    fn folder(&self) -> &Path {
        &self.0
    }

    fn code(&self) -> &dyn CodePolicy {
        &AnyCode
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if self.1 {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }
}

/// The folder of this crate.
pub fn here() -> Folder {
    Folder(PathBuf::from(env!("CARGO_MANIFEST_DIR")), false)
}

/// An empty folder for one test, removed at its end.
pub fn fresh(name: &str) -> Folder {
    let folder = std::env::temp_dir().join(format!("host-test-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    Folder(folder, true)
}

/// Compiles `source` of `tests/c` to `file` in `folder`, with these definitions.
pub fn compile(folder: &Folder, file: &str, source: &str, definitions: &[&str]) {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut cc = Command::new("cc");
    cc.args(["-std=c99", "-O1", "-shared", "-fPIC", "-I"]).arg(here.join("../abi/include"));
    cc.args(definitions.iter().map(|definition| format!("-D{definition}")));
    cc.arg("-o").arg(folder.0.join(file)).arg(here.join("tests/c").join(source)).arg("-lm");
    assert!(cc.status().unwrap().success(), "{cc:?}");
}

/// The library of a plug-in crate, built beside this test.
pub fn built(crate_name: &str) -> String {
    let file = format!("{}{crate_name}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    std::env::current_exe().unwrap().with_file_name(file).display().to_string()
}

/// A bare number.
pub fn bare(value: f64) -> ParamValue {
    ParamValue(Value::from(value))
}

/// A number with a unit.
pub fn with_unit(value: f64, unit: &str) -> ParamValue {
    let unit = Unit::parse(unit).unwrap();
    ParamValue(Quantity::new(unit.to_si(value), unit.dimension).into())
}

/// Parameters by name.
pub fn set<const N: usize>(parameters: [(&str, ParamValue); N]) -> BTreeMap<String, ParamValue> {
    parameters.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

/// A loaded block.
pub fn load(
    folder: &Folder,
    library: &str,
    block: &str,
    parameters: BTreeMap<String, ParamValue>,
) -> Result<Plugin, LoadError> {
    let mut plugin = Plugin::new(library, block, parameters);
    plugin.load(folder)?;
    Ok(plugin)
}

/// Code, parameter, message and help, with the places of this machine taken out.
pub fn refused(
    folder: &Folder,
    library: &str,
    block: &str,
    parameters: BTreeMap<String, ParamValue>,
    expected: Expect,
) {
    let error = load(folder, library, block, parameters).unwrap_err();
    let help = error.help.map_or(String::new(), |help| format!("help: {help}\n"));
    let text = format!("[{}] {}: {}\n{help}", error.code, error.param, error.message);
    let place = folder.0.canonicalize().unwrap();
    expected.assert_eq(
        &text.replace(place.to_str().unwrap(), "[folder]").replace(folder.0.to_str().unwrap(), "[folder]"),
    );
}

/// What one evaluation of a block says when it fails; inputs and states as given, time 0.5 s.
pub fn failure(plugin: &Plugin, u: &[f64], d: &mut [f64], what: What) -> Option<String> {
    let interface = plugin.interface(&Given::nothing()).unwrap();
    let spans = |lengths: Vec<usize>| {
        let ends = lengths.iter().scan(0, |end, n| {
            *end += *n as u32;
            Some(*end)
        });
        ends.zip(&lengths).map(|(end, n)| (end - *n as u32, end)).collect::<Vec<_>>()
    };
    let inputs = spans(interface.inputs.iter().map(|input| input.shape.unwrap().len()).collect());
    let outputs = spans(interface.outputs.iter().map(|output| output.port_type.shape.len()).collect());
    let fault = Fault::default();
    let mut y = vec![0.0; outputs.last().map_or(0, |span| span.1 as usize)];
    let mut c = Context {
        t: 0.5,
        x: &[],
        d: &[],
        u,
        inputs: &inputs,
        outputs: &outputs,
        evaluation: 1,
        resolution: blocksim_block::Resolution::default(),
        seed: 0,
        fault: &fault,
    };
    let kept = d.to_vec();
    match what {
        What::Start => plugin.initialize(&c, &mut [], d),
        What::Update => plugin.update(&c, &mut Scratch::default(), d),
        What::Outputs => {
            c.d = &kept;
            plugin.outputs(0, &c, &mut Scratch::default(), &mut y);
        }
    }
    fault.take()
}

/// The functions that `failure` calls.
#[derive(Clone, Copy)]
pub enum What {
    Start,
    Outputs,
    Update,
}
