//! Checks what a library says of itself. Nothing here is trusted: a table may be of a C program with a slip.

use blocksim_abi::read::{elements, is_plugin, read};
use blocksim_abi::{ABI_MAJOR, BlockTable, MAX_INPUTS, PluginTable, Quantity as Row, Text};
use blocksim_block::LoadError;
use blocksim_signal::{Dimension, Unit};

use crate::fault::{self, ABI, SYMBOL};
use crate::kind::{Calls, Kind, Quantity, Sizes, numbers};

/// More blocks, or more quantities in a list, are taken for a count that was never set.
pub(crate) const MOST_ELEMENTS: u32 = 4096;
/// So are more numbers in one buffer.
pub(crate) const MOST_NUMBERS: usize = 1 << 20;

/// Name, version and blocks of a plug-in.
#[derive(Debug)]
pub struct Contents {
    pub name: &'static str,
    pub version: &'static str,
    pub blocks: Vec<Kind>,
}

/// Which functions a block has, of those that it may need.
#[derive(Debug, Clone, Copy)]
pub struct Functions {
    pub outputs: bool,
    pub derivatives: bool,
}

/// Finds them by the number of the block and its table.
pub type FindFunctions<'a> = &'a dyn Fn(usize, &BlockTable) -> Functions;

/// Those that stand in the table itself.
pub fn in_table(_block: usize, table: &BlockTable) -> Functions {
    Functions { outputs: table.outputs.is_some(), derivatives: table.derivatives.is_some() }
}

/// Reads the table at `at`; `shown` is the library in messages.
///
/// # Errors
/// No table, another version, or a table that breaks the rules of its version.
///
/// # Safety
/// `at` is NULL or what the exported function of a plug-in returned; the library stays loaded.
pub unsafe fn contents(
    at: *const PluginTable,
    shown: &str,
    functions: FindFunctions,
) -> Result<Contents, LoadError> {
    if at.is_null() {
        let error = fault::library(SYMBOL, format!("`{shown}` holds no plug-in, or more than one"));
        return Err(fault::help(error, "put what plug-ins share into a crate without `export_plugin!`"));
    }
    // SAFETY: the caller vouches for `at`.
    let table = unsafe { read(at) }
        .ok_or_else(|| broken(shown, "the table of the plug-in has a size that no version has".into()))?;
    if !is_plugin(&table) {
        return Err(fault::library(
            SYMBOL,
            format!("`{shown}` is not a blocksim plug-in: its table is of something else"),
        ));
    }
    if table.abi_major != ABI_MAJOR {
        return Err(other_major(shown, table.abi_major));
    }
    // SAFETY: as above; magic and version say that the table keeps the contract.
    unsafe { kinds(&table, functions) }.map_err(|reason| broken(shown, reason))
}

/// A plug-in of another major version.
pub fn other_major(shown: &str, major: u16) -> LoadError {
    let error = fault::library(
        ABI,
        format!(
            "`{shown}` was built for version {major} of the plug-in ABI, but this blocksim has version {ABI_MAJOR}"
        ),
    );
    let remedy = if major < ABI_MAJOR {
        "build the plug-in again with the `blocksim-controller` or header of this blocksim"
    } else {
        "use a newer blocksim, or build the plug-in with the `blocksim-controller` or header of this one"
    };
    fault::help(error, remedy)
}

pub fn broken(shown: &str, reason: String) -> LoadError {
    let error = fault::library(ABI, format!("`{shown}` breaks the rules of plug-ins: {reason}"));
    fault::help(error, "fix the plug-in; `blocksim_plugin.h` states the rules")
}

/// # Safety
/// The table keeps the contract.
unsafe fn kinds(table: &PluginTable, functions: FindFunctions) -> Result<Contents, String> {
    if table.block_count == 0 || table.block_count > MOST_ELEMENTS {
        return Err(format!("it claims to have {} blocks", table.block_count));
    }
    let name = text(&table.name, "the name of the plug-in")?;
    let mut blocks: Vec<Kind> = Vec::new();
    // SAFETY: the caller vouches for the table.
    for (i, block) in unsafe { elements(table.blocks, table.block_count) }.enumerate() {
        let block = block.ok_or_else(|| format!("block {i} is NULL or has a size that no version has"))?;
        // SAFETY: as above.
        let kind = unsafe { kind(block, i, functions) }?;
        if blocks.iter().any(|known| known.name == kind.name) {
            return Err(format!("it has two blocks `{}`", kind.name));
        }
        blocks.push(kind);
    }
    Ok(Contents { name, version: text(&table.version, "the version of the plug-in")?, blocks })
}

/// # Safety
/// The table keeps the contract.
unsafe fn kind(table: BlockTable, i: usize, functions: FindFunctions) -> Result<Kind, String> {
    let name = text(&table.kind, &format!("the name of block {i}"))?;
    if !is_name(name) {
        return Err(format!("`{name}` is not a valid name for a block"));
    }
    let list = |first, count, what| {
        // SAFETY: the caller vouches for the table.
        unsafe { quantities(first, count) }.map_err(|reason| format!("{what} of `{name}`: {reason}"))
    };
    let parameters = list(table.parameters, table.parameter_count, "the parameters")?;
    let inputs = list(table.input_ports, table.input_count, "the inputs")?;
    let outputs = list(table.output_ports, table.output_count, "the outputs")?;
    let continuous = list(table.continuous_states, table.continuous_count, "the continuous states")?;
    let discrete = list(table.discrete_states, table.discrete_count, "the discrete states")?;
    let sizes = Sizes {
        params: numbers(&parameters),
        u: numbers(&inputs),
        y: numbers(&outputs),
        x: numbers(&continuous),
        xd: numbers(&discrete),
    };
    let doc = text(&table.doc, &format!("the page of `{name}`"))?;
    let calls = Calls::Table(table);
    let functions = functions(i, &table);
    let kind = Kind { name, doc, parameters, inputs, outputs, continuous, discrete, calls, sizes };
    complete(&kind, functions).map_err(|reason| format!("`{name}` {reason}"))?;
    whole(&kind).map_err(|reason| format!("`{name}` {reason}"))?;
    Ok(kind)
}

/// Whether there are the functions that the lists need.
fn complete(kind: &Kind, functions: Functions) -> Result<(), String> {
    if !functions.outputs && !kind.outputs.is_empty() {
        return Err("has outputs, but no function `outputs`".into());
    }
    if !functions.derivatives && !kind.continuous.is_empty() {
        return Err("has continuous states, but no function `derivatives`".into());
    }
    Ok(())
}

/// Whether the lists fit together.
pub(crate) fn whole(kind: &Kind) -> Result<(), String> {
    if kind.inputs.len() > MAX_INPUTS as usize {
        return Err(format!("has {} inputs, more than {MAX_INPUTS}", kind.inputs.len()));
    }
    let ports = || kind.inputs.iter().chain(&kind.outputs);
    for (i, port) in ports().enumerate() {
        if ports().skip(i + 1).any(|other| other.name == port.name) {
            return Err(format!("has two ports `{}`", port.name));
        }
    }
    for output in &kind.outputs {
        if output.reads.iter().any(|&input| input >= kind.inputs.len()) {
            return Err(format!(
                "declares that output `{}` reads an input that it does not have",
                output.name
            ));
        }
    }
    for input in &kind.inputs {
        if let Some(default) = input.default
            && default.iter().any(|value| value.to_bits() != default[0].to_bits())
        {
            return Err(format!(
                "gives the elements of input `{}` different defaults, which blocksim cannot use",
                input.name
            ));
        }
    }
    Ok(())
}

/// # Safety
/// `first` is NULL or points to `count` quantities that keep the contract.
unsafe fn quantities(first: *const Row, count: u32) -> Result<Vec<Quantity>, String> {
    if count > MOST_ELEMENTS {
        return Err(format!("there are {count} of them"));
    }
    let mut list: Vec<Quantity> = Vec::new();
    // SAFETY: the caller vouches for the array.
    for (i, row) in unsafe { elements(first, count) }.enumerate() {
        let row = row.ok_or_else(|| format!("number {i} is NULL or has a size that no version has"))?;
        // SAFETY: as above.
        let quantity = unsafe { quantity(&row, i) }?;
        if list.iter().any(|known| known.name == quantity.name) {
            return Err(format!("`{}` is there twice", quantity.name));
        }
        list.push(quantity);
    }
    if numbers(&list) > MOST_NUMBERS {
        return Err(format!("they hold {} numbers", numbers(&list)));
    }
    Ok(list)
}

/// # Safety
/// The row keeps the contract.
unsafe fn quantity(row: &Row, i: usize) -> Result<Quantity, String> {
    let name = text(&row.name, &format!("the name of number {i}"))?;
    if !is_name(name) {
        return Err(format!("`{name}` (number {i}) is not a valid name"));
    }
    let length = row.length as usize;
    if length == 0 || length > MOST_NUMBERS {
        return Err(format!("`{name}` has {length} numbers"));
    }
    let unit = text(&row.unit, &format!("the unit of `{name}`"))?;
    let default = row.default_value;
    if !default.is_null() && !default.is_aligned() {
        return Err(format!("the default of `{name}` is not an address of numbers"));
    }
    Ok(Quantity {
        name,
        unit,
        dimension: dimension(name, unit)?,
        length,
        doc: text(&row.doc, &format!("the description of `{name}`"))?,
        // SAFETY: not NULL and aligned; the caller vouches for `length` constant numbers.
        default: (!default.is_null()).then(|| kept(unsafe { std::slice::from_raw_parts(default, length) })),
        reads: (0..u64::BITS as usize).filter(|bit| row.reads >> bit & 1 == 1).collect(),
    })
}

/// The dimension of an SI unit; `None` where any is taken.
pub(crate) fn dimension(name: &str, unit: &str) -> Result<Option<Dimension>, String> {
    if unit.is_empty() {
        return Ok(None);
    }
    let parsed = Unit::parse(unit).map_err(|e| format!("the unit `{unit}` of `{name}`: {}", e.message))?;
    if parsed.scale != 1.0 || parsed.offset != 0.0 {
        let si = parsed.dimension;
        return Err(format!("the unit `{unit}` of `{name}` is not SI; numbers cross the border in `{si}`"));
    }
    Ok(Some(parsed.dimension))
}

fn text(text: &Text, what: &str) -> Result<&'static str, String> {
    // SAFETY: part of a table that keeps the contract, and libraries are never unloaded.
    let text = unsafe { text.as_str() }.ok_or_else(|| format!("{what} is not UTF-8 text"))?;
    Ok(Box::leak(Box::from(text)))
}

/// A copy that is there for the life of the process. It is read now, while a crash still names the plug-in: the address may be
/// wrong, and a plug-in can change its memory later.
fn kept(numbers: &[f64]) -> &'static [f64] {
    Box::leak(Box::from(numbers))
}

pub(crate) fn is_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}
