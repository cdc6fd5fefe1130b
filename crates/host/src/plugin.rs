use std::collections::BTreeMap;
use std::sync::Arc;

use blocksim_abi::{OK, PANICKED};
use blocksim_block::Decision;
use blocksim_block::prelude::*;

use crate::call::{Failure, with_numbers};
use crate::fault;
use crate::finite::{all_finite, culprit, element, values};
use crate::guard;
use crate::kind::{At, Kind as PluginKind, Quantity};
use crate::locate::Target;
use crate::offer::{Period, note_period, offer, period, recalled};
use crate::open::{Library, open};
use crate::parameters::numbers;
use crate::watch::{Tag, calling, tag};

/// A controller from a plug-in: a block from another source, in Rust, C, or anything that speaks C.
///
/// `library` is the folder of a crate or of C or C++ sources, which is built first when these are newer, a built
/// library (`.so`, `.dylib`, `.dll`), or a WebAssembly module (`.wasm`). The plug-in declares the ports, parameters and states of its blocks. A parameter
/// without a unit is SI; a number with a unit is checked against the unit that the plug-in states; a vector is a
/// list.
///
/// A failure of the plug-in, a panic included, ends the run with its message, and so does a result that is not a
/// finite number. Plug-ins are code: they may do whatever the user who runs them may do. `blocksim run` builds and loads them;
/// commands that only look at a diagram do so where `blocksim trust` lists the plug-in. A module cannot leave its memory, and needs no
/// trust.
///
/// ```ron
/// Plugin(library: "../../plugins/cascade", block: "Cascade", parameters: { "w1": 4.0, "kv": "20 1/s" })
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Plug-ins", symbol = Plugin)]
pub struct Plugin {
    /// Folder of a crate or of C or C++ sources, built library, or WebAssembly module, relative to the diagram.
    pub library: String,
    /// Which block of the plug-in.
    pub block: String,
    /// Parameters of that block by name: numbers, numbers with units, lists of them.
    #[block(default = BTreeMap::new())]
    pub parameters: BTreeMap<String, ParamValue>,
    /// What a crate is built for: a library (`Native`), or a WebAssembly module (`Wasm`), which is confined to its memory.
    #[block(default = Target::Native)]
    pub target: Target,
    #[block(skip)]
    loaded: Option<Arc<Loaded>>,
}

/// What `load` found out; the same for all copies of the block.
#[derive(Debug)]
struct Loaded {
    kind: &'static PluginKind,
    /// Parameters in SI, as the plug-in sees them.
    params: Vec<f64>,
    interface: Interface,
    tag: &'static Tag,
}

impl Plugin {
    /// A block of a plug-in with these parameters; `load` comes next.
    pub fn new(library: &str, block: &str, parameters: BTreeMap<String, ParamValue>) -> Self {
        Self {
            library: library.to_owned(),
            block: block.to_owned(),
            parameters,
            target: Target::Native,
            loaded: None,
        }
    }

    /// The kind of block, once it is loaded.
    pub fn kind(&self) -> Option<&'static PluginKind> {
        self.loaded.as_ref().map(|loaded| loaded.kind)
    }

    /// Takes the block out of a loaded library.
    fn take(&mut self, library: &'static Library) -> Result<(), LoadError> {
        let kind = find(library, &self.block)?;
        let params = numbers(kind, &self.parameters)?;
        let calling = calling(tag(&self.library, kind.name), 0, f64::NAN);
        kind.check(&params).map_err(refused)?;
        let period = kind.sample_time(&params).map_err(refused)?;
        drop(calling);
        if !(period.is_finite() && period >= 0.0) {
            return Err(fault::parameter(format!(
                "`{}` asks for a sample time of {period} s, but it must be positive, or 0 for continuous",
                kind.name
            )));
        }
        if period > 0.0 && !kind.continuous.is_empty() {
            let message = format!(
                "`{}` asks for a sample time of {period} s, but has continuous states; a block has one or the other",
                kind.name
            );
            return Err(LoadError { param: "block", ..fault::library(fault::ABI, message) });
        }
        note_period(library, Period::new(kind.name, &params, period));
        self.loaded = Some(Arc::new(Loaded {
            kind,
            params,
            interface: interface(kind, period),
            tag: tag(&self.library, kind.name),
        }));
        Ok(())
    }

    /// Takes the block from what a plug-in offered when it was loaded last; `refusal` says why it is not loaded now.
    fn recall(&mut self, offer: &str, refusal: LoadError) -> Result<(), LoadError> {
        // A memory that makes no sense counts as none.
        let Ok(library) = recalled(&self.library, offer) else { return Err(refusal) };
        let kind = find(library, &self.block)?;
        let params = numbers(kind, &self.parameters)?;
        let Some(period) = period(library, kind.name, &params) else {
            let message = format!("{}; its sample time with these parameters is not known", refusal.message);
            return Err(LoadError { message, ..refusal });
        };
        self.loaded = Some(Arc::new(Loaded {
            kind,
            params,
            interface: interface(kind, period),
            tag: tag(&self.library, kind.name),
        }));
        Ok(())
    }

    /// A reason with the name of the library, where it has none yet.
    fn named(&self, reason: &str) -> String {
        let who = format!("the plug-in `{}`", self.library);
        match reason.strip_prefix("the plug-in ") {
            _ if reason.starts_with(&who) => reason.to_owned(),
            Some(deed) => format!("{who} {deed}"),
            None => format!("{who}: {reason}"),
        }
    }

    /// Runs `body` on what is loaded, and stops the run with the reason if it fails.
    fn run(&self, c: &Context, body: impl FnOnce(&Loaded) -> Result<(), String>) {
        let result = match &self.loaded {
            Some(loaded) => {
                let _calling = calling(loaded.tag, std::ptr::from_ref(self) as usize, c.t);
                body(loaded)
            }
            None => Err("the plug-in was never loaded".to_owned()),
        };
        if let Err(reason) = result {
            c.fail(self.named(&reason));
        }
    }
}

impl Block for Plugin {
    fn load(&mut self, files: &dyn Files) -> Result<(), LoadError> {
        let (folder, code) = (files.folder(), files.code());
        match code.decide(folder, &self.library) {
            Decision::Load => {
                let library = open(folder, &self.library, self.target)?;
                let taken = self.take(library);
                code.remember(folder, &self.library, &offer(library));
                taken
            }
            Decision::Recall { offer, warning, refusal } => {
                self.recall(&offer, refusal)?;
                warning.into_iter().for_each(|warning| files.warn(warning));
                Ok(())
            }
            Decision::Refuse(error) => Err(error),
        }
    }

    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        match &self.loaded {
            Some(loaded) => Ok(loaded.interface.clone()),
            None => Err(InterfaceError {
                code: fault::MISSING,
                ports: Vec::new(),
                message: "the ports are unknown until the plug-in is loaded".to_owned(),
                help: None,
            }),
        }
    }

    fn scratch(&self) -> Scratch {
        let room = self.loaded.as_ref().and_then(|loaded| loaded.kind.room());
        room.map_or_else(Scratch::default, Scratch::new)
    }

    fn initialize(&self, c: &Context, x: &mut [f64], d: &mut [f64]) {
        self.run(c, |Loaded { kind, params, .. }| {
            // Grows the buffers of this thread now, so that the run itself allocates nothing.
            with_numbers(kind.sizes.y.max(kind.sizes.xd), |_| ());
            guard::reserve(kind.sizes.in_all());
            kind.reset(params, x, d).map_err(|failure| failure.to_string())?;
            match culprit("state", &kind.continuous, x).or_else(|| culprit("state", &kind.discrete, d)) {
                Some(culprit) => Err(format!("at the start {culprit}")),
                None => Ok(()),
            }
        });
    }

    fn outputs(&self, group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        self.run(c, |Loaded { kind, params, interface, .. }| {
            let at = At { params, t: c.t, x: c.x, xd: c.d, u: c.u };
            if interface.groups.len() == 1 {
                kind.outputs(w.get(), &at, y).map_err(|failure| failure.to_string())?;
                return if all_finite(y) {
                    Ok(())
                } else {
                    Err(no_number("output", &kind.outputs, y, kind, c))
                };
            }
            with_numbers(y.len(), |all| {
                kind.outputs(w.get(), &at, all).map_err(|failure| failure.to_string())?;
                // Inputs that the group does not read may be stale: outputs of other groups mean nothing yet.
                for (port, output) in kind.outputs.iter().enumerate() {
                    if interface.group_of[port] != group {
                        continue;
                    }
                    let range = c.output(port);
                    y[range.clone()].copy_from_slice(&all[range.clone()]);
                    if !all_finite(&y[range.clone()]) {
                        return Err(no_number("output", std::slice::from_ref(output), &y[range], kind, c));
                    }
                }
                Ok(())
            })
        });
    }

    fn derivatives(&self, c: &Context, w: &mut Scratch, dx: &mut [f64]) {
        self.run(c, |Loaded { kind, params, .. }| {
            let at = At { params, t: c.t, x: c.x, xd: c.d, u: c.u };
            kind.derivatives(w.get(), &at, dx).map_err(|failure| failure.to_string())?;
            if all_finite(dx) {
                return Ok(());
            }
            Err(no_number("the derivative of state", &kind.continuous, dx, kind, c))
        });
    }

    fn update(&self, c: &Context, w: &mut Scratch, d: &mut [f64]) {
        self.run(c, |Loaded { kind, params, .. }| {
            with_numbers(d.len(), |before| {
                before.copy_from_slice(d);
                let at = At { params, t: c.t, x: c.x, xd: before, u: c.u };
                let mut result = kind.update(w.get(), &at, d).map_err(|failure| failure.to_string());
                if result.is_ok() && !all_finite(d) {
                    result = Err(no_number("the next value of state", &kind.discrete, d, kind, c));
                }
                if result.is_err() {
                    d.copy_from_slice(before);
                }
                result
            })
        });
    }
}

fn find(library: &'static Library, block: &str) -> Result<&'static PluginKind, LoadError> {
    if let Some(kind) = library.blocks.iter().find(|kind| kind.name == block) {
        return Ok(kind);
    }
    Err(unknown_block(library, block))
}

/// A name that no block has.
pub(crate) fn unknown_block(library: &Library, block: &str) -> LoadError {
    LoadError {
        param: "block",
        code: fault::PARAMETER,
        message: format!("the plug-in `{}` has no block `{block}`", library.name),
        help: Some(fault::meant(block, "blocks", library.blocks.iter().map(|kind| kind.name))),
    }
}

/// Parameters that the plug-in itself did not take.
fn refused(failure: Failure) -> LoadError {
    let error = fault::parameter(failure.to_string());
    match failure.status {
        PANICKED => fault::help(
            LoadError { code: fault::PANIC, ..error },
            "this is a mistake in the plug-in; parameters that make no sense are to be refused by its `check`",
        ),
        // It reported nothing: it broke a rule, or died.
        OK => LoadError { code: fault::CRASH, ..error },
        _ => error,
    }
}

fn interface(kind: &PluginKind, period: f64) -> Interface {
    let mut interface = Interface::new();
    for port in &kind.inputs {
        let input = Input::real(port.name).shape(shape(port)).dimension(port.dimension).doc(port.doc);
        interface = interface.input(match port.default {
            Some(default) => input.default(default[0]),
            None => input,
        });
    }
    for port in &kind.outputs {
        let output = Output::real(port.name).shape(shape(port)).dimension(port.dimension).doc(port.doc);
        interface = interface.output_reading(&port.reads, output);
    }
    for state in &kind.continuous {
        for (i, start) in starts(state).enumerate() {
            interface = interface.state(element(state, i), start);
        }
    }
    for state in &kind.discrete {
        for (i, start) in starts(state).enumerate() {
            interface = interface.discrete(element(state, i), start);
        }
    }
    // A continuous controller is handed the time and may use it.
    if period > 0.0 { interface.sampled(period) } else { interface.uses_time() }
}

fn shape(port: &Quantity) -> Shape {
    if port.length == 1 { Shape::Scalar } else { Shape::Vector(port.length) }
}

fn starts(state: &Quantity) -> impl Iterator<Item = f64> {
    (0..state.length).map(|i| state.default.map_or(0.0, |default| default[i]))
}

fn no_number(what: &str, list: &[Quantity], numbers: &[f64], kind: &PluginKind, c: &Context) -> String {
    let culprit = culprit(what, list, numbers).unwrap_or_else(|| format!("{what} is not a number"));
    format!("{culprit}; inputs: {}", values(&kind.inputs, c.u))
}
