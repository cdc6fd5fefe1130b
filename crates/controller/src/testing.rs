//! A small host for tests: one block of a plug-in in the same program, called through its table.

use crate::abi::read::elements;
use crate::abi::{BlockTable, Message, OK, PluginTable, Quantity, Status, message};
use crate::entry::linked;

/// What a function of the table reported.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// `ERROR` or `PANICKED`.
    pub status: Status,
    /// Reason.
    pub message: String,
}

/// One instance of a sampled or continuous controller with its buffers, as a simulator would hold it.
///
/// The example at the top of this crate ends with a use of it.
#[derive(Clone)]
pub struct Bench {
    block: BlockTable,
    params: Vec<f64>,
    period: f64,
    x: Vec<f64>,
    xd: Vec<f64>,
    y: Vec<f64>,
    inputs: usize,
}

impl std::fmt::Debug for Bench {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bench")
            .field("params", &self.params)
            .field("x", &self.x)
            .field("xd", &self.xd)
            .finish()
    }
}

impl Bench {
    /// The block `kind` of `table`, with `parameters` by name and defaults for the rest, checked and reset.
    /// For an element of a vector write its place: `("gains.2", 0.5)`.
    ///
    /// # Errors
    ///
    /// What `check`, `sample_time` or `reset` say, and a parameter without value.
    ///
    /// # Panics
    ///
    /// If `table` is not of a plug-in in this program, has no such block, or the block no such parameter.
    pub fn new(table: &'static PluginTable, kind: &str, parameters: &[(&str, f64)]) -> Result<Self, Failure> {
        assert!(
            linked().any(|linked| std::ptr::eq(linked, table)),
            "not a table that `export_plugin!` wrote"
        );
        // SAFETY: `export_plugin!` writes consistent tables.
        let block = unsafe {
            elements(table.blocks, table.block_count)
                .map(|block| block.expect("a table of this version"))
                .find(|block| block.kind.as_str() == Some(kind))
                .unwrap_or_else(|| panic!("the plug-in has no block `{kind}`"))
        };
        let params = values(block.parameters, block.parameter_count, parameters)?;
        let mut bench = Bench {
            params,
            period: 0.0,
            x: start(block.continuous_states, block.continuous_count),
            xd: start(block.discrete_states, block.discrete_count),
            y: start(block.output_ports, block.output_count),
            inputs: start(block.input_ports, block.input_count).len(),
            block,
        };
        let (p, x, xd) = (bench.params.as_ptr(), bench.x.as_mut_ptr(), bench.xd.as_mut_ptr());
        let (check, sample_time, reset) = (block.check, block.sample_time, block.reset);
        // SAFETY: buffers of the lengths that the table states.
        unsafe {
            call(|m| check.map_or(OK, |check| check(p, m)))?;
            call(|m| sample_time.map_or(OK, |sample_time| sample_time(p, &mut bench.period, m)))?;
            call(|m| reset.map_or(OK, |reset| reset(p, x, xd, m)))?;
        }
        Ok(bench)
    }

    /// Sample time in seconds, 0 if continuous.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Discrete states, as they are now.
    pub fn discrete(&self) -> &[f64] {
        &self.xd
    }

    /// Continuous states, as they are now; a test may move them.
    pub fn continuous(&mut self) -> &mut [f64] {
        &mut self.x
    }

    /// Outputs at time `t` for the inputs `u`.
    ///
    /// # Errors
    ///
    /// What the controller says.
    pub fn outputs(&mut self, t: f64, u: &[f64]) -> Result<Vec<f64>, Failure> {
        assert_eq!(u.len(), self.inputs, "numbers in `u`");
        let Some(outputs) = self.block.outputs else { return Ok(Vec::new()) };
        let (p, x, xd, y) = (self.params.as_ptr(), self.x.as_ptr(), self.xd.as_ptr(), self.y.as_mut_ptr());
        // SAFETY: buffers of the lengths that the table states.
        call(|m| unsafe { outputs(p, t, x, xd, u.as_ptr(), y, m) })?;
        Ok(self.y.clone())
    }

    /// A sample hit: outputs, then the update of the discrete states, which stay as they are on failure.
    ///
    /// # Errors
    ///
    /// What the controller says.
    pub fn sample(&mut self, t: f64, u: &[f64]) -> Result<Vec<f64>, Failure> {
        let y = self.outputs(t, u)?;
        if let Some(update) = self.block.update {
            let (p, x, xd) = (self.params.as_ptr(), self.x.as_ptr(), self.xd.as_ptr());
            let mut next = self.xd.clone();
            // SAFETY: buffers of the lengths that the table states.
            call(|m| unsafe { update(p, t, x, xd, u.as_ptr(), next.as_mut_ptr(), m) })?;
            self.xd = next;
        }
        Ok(y)
    }

    /// Time derivatives of the continuous states.
    ///
    /// # Errors
    ///
    /// What the controller says.
    pub fn derivatives(&self, t: f64, u: &[f64]) -> Result<Vec<f64>, Failure> {
        assert_eq!(u.len(), self.inputs, "numbers in `u`");
        let mut dx = vec![0.0; self.x.len()];
        if let Some(derivatives) = self.block.derivatives {
            let (p, x, xd) = (self.params.as_ptr(), self.x.as_ptr(), self.xd.as_ptr());
            // SAFETY: buffers of the lengths that the table states.
            call(|m| unsafe { derivatives(p, t, x, xd, u.as_ptr(), dx.as_mut_ptr(), m) })?;
        }
        Ok(dx)
    }
}

/// Calls with a message buffer and turns status and message into a result.
fn call(function: impl FnOnce(*const Message) -> Status) -> Result<(), Failure> {
    let mut buffer = [0; 512];
    let message = Message::new(&mut buffer);
    match function(&message) {
        OK => Ok(()),
        status => Err(Failure { status, message: message::written(&buffer).to_string() }),
    }
}

/// Length and default numbers of each quantity, with its name.
fn list(first: *const Quantity, count: u32) -> Vec<(&'static str, usize, Option<&'static [f64]>)> {
    // SAFETY: private to this file and called with lists of a table that `export_plugin!` wrote.
    unsafe {
        elements(first, count)
            .map(|quantity| {
                let quantity = quantity.expect("a quantity of this version");
                let length = quantity.length as usize;
                let default = quantity.default_value;
                let default = (!default.is_null()).then(|| std::slice::from_raw_parts(default, length));
                (quantity.name.as_str().expect("a name"), length, default)
            })
            .collect()
    }
}

/// Default values, zeros where there are none.
fn start(first: *const Quantity, count: u32) -> Vec<f64> {
    let list = list(first, count);
    list.iter().flat_map(|&(_, n, default)| default.map_or(vec![0.0; n], <[f64]>::to_vec)).collect()
}

fn values(first: *const Quantity, count: u32, given: &[(&str, f64)]) -> Result<Vec<f64>, Failure> {
    let mut values = Vec::new();
    let mut used = 0;
    for (name, length, default) in list(first, count) {
        for i in 0..length {
            let element = format!("{name}.{i}");
            let is_this = |key: &str| key == element || (length == 1 && key == name);
            used += given.iter().filter(|(key, _)| is_this(key)).count();
            let value = given.iter().find(|(key, _)| is_this(key)).map(|&(_, value)| value);
            values.push(value.or(default.map(|d| d[i])).ok_or_else(|| Failure {
                status: crate::abi::ERROR,
                message: format!("`{name}` must be given"),
            })?);
        }
    }
    assert_eq!(used, given.len(), "each given parameter is one of the block, and given once");
    Ok(values)
}
