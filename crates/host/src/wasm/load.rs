//! From a file to blocks, and calls of these.

use std::cell::RefCell;
use std::fmt;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use blocksim_abi::OK;
use blocksim_block::LoadError;
use wasmi::Module as Code;

use super::instance::{Instance, Unfit, engine};
use super::layout::{Indices, translate};
use crate::call::Failure;
use crate::fault::{self, MISSING, SYMBOL};
use crate::guard::{Given, Wanted, framed, most_words};
use crate::isolate::Op;
use crate::kind::{Calls, Kind};
use crate::open::Library;
use crate::table::{Functions, broken, contents};

/// Larger files are not read: controllers that are built with optimisation have a hundredth of this.
const MOST_BYTES: u64 = 16 << 20;

/// A module that was loaded, for the life of the process.
struct Module {
    code: Code,
    path: PathBuf,
    /// Where its table is, in every instance.
    address: u32,
    names: Vec<&'static str>,
    functions: Vec<Indices>,
    /// The most words of a call.
    words: usize,
}

impl Module {
    /// An instance for this thread.
    fn instance(&self) -> Result<Instance, Unfit> {
        let mut instance = Instance::start(&self.code)?;
        if instance.address() != self.address {
            return Err(Unfit::Broken("its table is at another address in each instance".to_owned()));
        }
        instance.prepare(&self.names, &self.functions, self.words)?;
        Ok(instance)
    }
}

thread_local! {
    /// Instances of this thread. Of a file that has changed, the earlier one goes.
    static INSTANCES: RefCell<Vec<(&'static Module, Instance)>> = const { RefCell::new(Vec::new()) };
}

fn keep(module: &'static Module, instance: Instance) {
    INSTANCES.with_borrow_mut(|instances| {
        instances.retain(|(known, _)| known.path != module.path);
        instances.push((module, instance));
    });
}

/// A block of a module.
#[derive(Clone, Copy)]
pub struct Boxed {
    module: &'static Module,
    block: usize,
}

impl fmt::Debug for Boxed {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "block {} of {}", self.block, self.module.path.display())
    }
}

impl Boxed {
    /// Calls a function of the block in the instance of this thread, which is made by the first call.
    ///
    /// # Errors
    /// What the function reported, which rule it broke, or why it did not return.
    pub fn call(&self, op: Op, t: f64, given: &[Given], wanted: &mut [Wanted]) -> Result<(), Failure> {
        let find = || {
            INSTANCES.with_borrow(|instances| {
                instances.iter().position(|(module, _)| std::ptr::eq(*module, self.module))
            })
        };
        let at = match find() {
            Some(at) => at,
            None => {
                let instance = self.module.instance().map_err(|unfit| {
                    let (Unfit::Foreign(reason, _) | Unfit::Broken(reason)) = unfit;
                    Failure { status: OK, text: format!("the plug-in cannot be started once more: {reason}") }
                })?;
                keep(self.module, instance);
                find().unwrap_or_default()
            }
        };
        INSTANCES.with_borrow_mut(|instances| {
            let instance = &mut instances[at].1;
            let outcome = framed(given, wanted, |frame| instance.perform(self.block, op, t, frame));
            if instance.is_spent() {
                instances.remove(at);
            }
            outcome
        })
    }
}

/// Loads a module.
///
/// # Errors
/// `plugin_missing`, `plugin_symbol` or `plugin_abi`, for the parameter `library`.
pub fn load(path: &Path) -> Result<Library, LoadError> {
    let shown = fault::shown(path);
    let bytes = bytes(path, &shown)?;
    let unfit = |unfit: Unfit| match unfit {
        Unfit::Broken(reason) => broken(&shown, reason),
        Unfit::Foreign(reason, help) => {
            let message = format!("`{shown}` is not a blocksim plug-in: {reason}");
            fault::help(fault::library(SYMBOL, message), help)
        }
    };
    let code = code(&bytes).map_err(|reason| {
        let message = format!("`{shown}` is not a WebAssembly module that can be run: {reason}");
        fault::help(
            fault::library(SYMBOL, message),
            "build it for `wasm32-unknown-unknown`; vectors (SIMD), threads and 64-bit memories are not supported",
        )
    })?;
    let mut instance = Instance::start(&code).map_err(unfit)?;
    let table = translate(instance.memory(), instance.address()).map_err(|reason| broken(&shown, reason))?;
    let there =
        |block: usize, op: Op| table.functions.get(block).is_some_and(|indices| indices[op as usize] != 0);
    let functions = |block, _: &_| Functions {
        outputs: there(block, Op::Outputs),
        derivatives: there(block, Op::Derivatives),
    };
    // SAFETY: NULL, or a table of this process whose pointers lead to parts of `table`; these are kept below for as long as
    // anything that is made of them.
    let contents = unsafe { contents(table.table, &shown, &functions) }?;
    let names: Vec<&'static str> = contents.blocks.iter().map(|kind| kind.name).collect();
    let words = contents.blocks.iter().map(|kind| most_words(kind.sizes.in_all())).max().unwrap_or_default();
    instance.prepare(&names, &table.functions, words).map_err(unfit)?;
    let address = instance.address();
    let functions = table.keep();
    let module: &'static Module =
        Box::leak(Box::new(Module { code, path: path.to_owned(), address, names, functions, words }));
    keep(module, instance);
    let boxed = |(block, kind): (usize, Kind)| Kind { calls: Calls::Boxed(Boxed { module, block }), ..kind };
    Ok(Library {
        path: path.to_owned(),
        name: contents.name,
        version: contents.version,
        blocks: contents.blocks.into_iter().enumerate().map(boxed).collect(),
        periods: Mutex::default(),
    })
}

/// Checks and translates a module.
fn code(bytes: &[u8]) -> Result<Code, String> {
    /// What every file begins with, and the version of modules behind it.
    const BEGINNING: (&[u8], &[u8]) = (b"\0asm", &[1, 0, 0, 0]);
    match bytes.strip_prefix(BEGINNING.0) {
        None => return Err("it begins in another way than WebAssembly".to_owned()),
        Some(rest) if rest.len() >= 4 && !rest.starts_with(BEGINNING.1) => {
            return Err("it is a component, or of another version of WebAssembly".to_owned());
        }
        Some(_) => {}
    }
    Code::new(engine(), bytes).map_err(|error| error.to_string())
}

/// Whether a crate may be built as a module: this program runs them.
///
/// # Errors
/// None.
#[expect(clippy::unnecessary_wraps, reason = "as where modules cannot be run")]
pub fn usable(_named: &str) -> Result<(), LoadError> {
    Ok(())
}

/// The bytes of a file.
fn bytes(path: &Path, shown: &str) -> Result<Vec<u8>, LoadError> {
    let cannot = |reason: String| fault::library(MISSING, format!("`{shown}` cannot be read: {reason}"));
    let file = std::fs::File::open(path).map_err(|error| cannot(error.to_string()))?;
    let mut bytes = Vec::new();
    file.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(|error| cannot(error.to_string()))?;
    if bytes.len() as u64 > MOST_BYTES {
        let error = cannot(format!("it is larger than {} MB", MOST_BYTES >> 20));
        return Err(fault::help(
            error,
            "build it with optimisation and without debug information, as `--release` does",
        ));
    }
    Ok(bytes)
}
