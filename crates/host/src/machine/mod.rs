//! Machine code of what a simulation runs: compiled by the C compiler of the system, kept, loaded and called.
//!
//! The sources are made here of tapes (`source`), so nothing of what guards plug-ins stands around the calls.

mod source;

use std::ffi::c_int;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use blocksim_block::law::{Machine, Ran, Tape};
use libloading::Library;

use crate::build::Compilers;
use crate::fault::shown;
use crate::machine::source::Source;

/// Arguments of the compiler: nothing that rounds otherwise than the interpreter, which calls the functions of the library, and
/// nothing that takes longer than it saves with thousands of statements that write one array.
const FLAGS: [&str; 10] = [
    "-std=c99",
    "-O1",
    "-w",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fno-builtin",
    "-fno-inline-functions-called-once",
    "-fno-tree-dse",
    "-fno-dse",
    "-shared",
];

/// What one function leaves, as the source declares it.
#[repr(C)]
#[derive(Debug)]
struct Left {
    about: f64,
    failed: std::ffi::c_long,
    changed: c_int,
}

type Function = unsafe extern "C" fn(*mut f64, *mut f64, *mut Left);

/// Machine code that is loaded.
#[derive(Debug)]
pub struct Machines {
    /// A machine for each tape.
    pub machines: Vec<Arc<dyn Machine>>,
    /// Whether it has been compiled before.
    pub was_kept: bool,
    /// Why it was not kept for the next time, if it was not.
    pub not_kept: Option<String>,
}

/// Why there is no machine code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NoMachines {
    /// What is wrong.
    pub message: String,
    /// What helps.
    pub help: String,
}

/// A function of a library that was compiled from a source of this program.
#[derive(Debug)]
struct Compiled {
    function: Function,
    cells: usize,
    held: usize,
    /// The function lives as long as this.
    _library: Arc<Library>,
}

impl Machine for Compiled {
    fn run(&self, cells: &mut [f64], held: &mut [f64]) -> Ran {
        assert!(cells.len() >= self.cells && held.len() >= self.held, "a tape needs more cells");
        let mut left = Left { about: 0.0, failed: -1, changed: 0 };
        // SAFETY: the function was made of a tape with these extents, so it reads and writes no more than `self.cells` numbers from
        // the first pointer, `self.held` from the second and the struct behind the third; the assertion has compared the lengths.
        unsafe { (self.function)(cells.as_mut_ptr(), held.as_mut_ptr(), &raw mut left) };
        let failed = usize::try_from(left.failed).ok().map(|word| (word, left.about));
        Ran { failed, changed: left.changed != 0 }
    }
}

/// Compiles tapes, or takes what was compiled of the same ones by the same compiler before, and loads that. Gives a machine for each
/// tape, which is to be compared with it. `cache` is where libraries are kept.
///
/// # Errors
/// There is no compiler, it refuses the source, or what it makes cannot be loaded.
pub fn machines(tapes: &[&Tape], cache: Option<&Path>) -> Result<Machines, NoMachines> {
    let source = &Source::new(tapes).whole();
    let extents: &[(usize, usize)] = &tapes.iter().map(|tape| tape.extent()).collect::<Vec<_>>();
    let compilers = Compilers::of_environment();
    let compiler = compilers.of(false);
    let version = version(compiler)?;
    let line =
        format!("{} {} {version} {compiler:?} {FLAGS:?}", env!("CARGO_PKG_VERSION"), std::env::consts::ARCH);
    let key = format!("{:016x}", checksum(source.bytes().chain(line.bytes())));
    let kept = cache.map(|folder| Kept { folder: folder.to_owned(), key });
    if let Some(library) = kept.as_ref().and_then(|kept| kept.library(source, &line))
        && let Ok(machines) = loaded(&library, extents)
    {
        return Ok(Machines { machines, was_kept: true, not_kept: None });
    }
    let place = Temporary::new().map_err(|error| NoMachines {
        message: format!("there is no place to compile the model: {error}"),
        help: "make room in the folder for temporary files, or name another one in TMPDIR".to_owned(),
    })?;
    let library = compile(compiler, source, &place.0)?;
    let machines = loaded(&library, extents)?;
    let not_kept = kept.and_then(|kept| {
        let error = kept.keep(&library, source, &line).err()?;
        Some(format!("`{}`: {error}", shown(&kept.folder)))
    });
    Ok(Machines { machines, was_kept: false, not_kept })
}

/// The first line of what a compiler answers to `--version`.
fn version(compiler: &[String]) -> Result<String, NoMachines> {
    let output =
        Command::new(&compiler[0]).args(&compiler[1..]).arg("--version").stdin(Stdio::null()).output();
    let output = output.map_err(|error| NoMachines {
        message: format!("machine code needs a C compiler, and `{}` cannot be run: {error}", compiler[0]),
        help:
            "install gcc or clang, such as with `apt-get install gcc`, or name a compiler in the variable CC"
                .to_owned(),
    })?;
    Ok(String::from_utf8_lossy(&output.stdout).lines().next().unwrap_or_default().to_owned())
}

fn compile(compiler: &[String], source: &str, place: &Path) -> Result<PathBuf, NoMachines> {
    let (text, library) =
        (place.join("model.c"), place.join(format!("model{}", std::env::consts::DLL_SUFFIX)));
    fs::write(&text, source).map_err(|error| NoMachines {
        message: format!("`{}` cannot be written: {error}", shown(&text)),
        help: "make room in the folder for temporary files, or name another one in TMPDIR".to_owned(),
    })?;
    let mut command = Command::new(&compiler[0]);
    command.args(&compiler[1..]).args(FLAGS).stdin(Stdio::null());
    if cfg!(unix) {
        command.arg("-fPIC");
    }
    command.arg(&text).arg("-o").arg(&library);
    if cfg!(unix) {
        command.arg("-lm");
    }
    let output = command.output();
    let refused = |said: String| NoMachines {
        message: format!("`{}` does not compile the model to machine code: {said}", compiler.join(" ")),
        help: "name another compiler in the variable CC, such as `CC=gcc`; without --native none is needed"
            .to_owned(),
    };
    match output {
        Err(error) => Err(refused(error.to_string())),
        Ok(output) if !output.status.success() => {
            let said = String::from_utf8_lossy(&output.stderr);
            let first = said.lines().find(|line| line.contains("error")).or_else(|| said.lines().next());
            Err(refused(first.map_or_else(|| output.status.to_string(), str::to_owned)))
        }
        Ok(_) => Ok(library),
    }
}

fn loaded(library: &Path, extents: &[(usize, usize)]) -> Result<Vec<Arc<dyn Machine>>, NoMachines> {
    let refused = |error: libloading::Error| NoMachines {
        message: format!("machine code cannot be loaded: {error}"),
        help: "name another compiler in the variable CC, such as `CC=gcc`; without --native none is needed"
            .to_owned(),
    };
    // SAFETY: a library that was compiled from a source of this program has no initialisers.
    let library = Arc::new(unsafe { Library::new(library) }.map_err(refused)?);
    let machines = extents.iter().enumerate().map(|(number, &(cells, held))| {
        // SAFETY: the source defines functions of these names with this signature.
        let function =
            unsafe { library.get::<Function>(format!("{}{number}\0", source::FUNCTION).as_bytes()) };
        let function = *function.map_err(refused)?;
        let machine: Arc<dyn Machine> =
            Arc::new(Compiled { function, cells, held, _library: Arc::clone(&library) });
        Ok(machine)
    });
    machines.collect()
}

/// A library in the cache, with its source and a line that says how it was made beside it.
struct Kept {
    folder: PathBuf,
    key: String,
}

impl Kept {
    fn file(&self, ending: &str) -> PathBuf {
        self.folder.join(format!("{}{ending}", self.key))
    }

    /// The library, if it is the one of this source and as whole as it was.
    fn library(&self, source: &str, line: &str) -> Option<PathBuf> {
        let library = self.file(std::env::consts::DLL_SUFFIX);
        let sum = checksum(fs::read(&library).ok()?.into_iter());
        let is_same = fs::read_to_string(self.file(".stamp")).ok()? == stamp(line, sum)
            && fs::read_to_string(self.file(".c")).ok()? == source;
        is_same.then_some(library)
    }

    /// Keeps a library. Each file appears whole, the stamp as the last.
    fn keep(&self, library: &Path, source: &str, line: &str) -> io::Result<()> {
        fs::create_dir_all(&self.folder)?;
        let library = fs::read(library)?;
        let stamp = stamp(line, checksum(library.iter().copied()));
        let files = [
            (std::env::consts::DLL_SUFFIX, &library[..]),
            (".c", source.as_bytes()),
            (".stamp", stamp.as_bytes()),
        ];
        for (ending, bytes) in files {
            let new = self.file(&format!("{ending}.{}", std::process::id()));
            let written = fs::write(&new, bytes).and_then(|()| fs::rename(&new, self.file(ending)));
            if written.is_err() {
                let _ = fs::remove_file(&new);
            }
            written?;
        }
        Ok(())
    }
}

fn stamp(line: &str, sum: u64) -> String {
    format!("{line}\n{sum:016x}\n")
}

/// The checksum of Fowler, Noll and Vo (FNV-1a, 64 bits), against damage and for names; sources are compared whole.
fn checksum(bytes: impl Iterator<Item = u8>) -> u64 {
    bytes.fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// A folder of its own, which is removed at the end; a library that is loaded from it stays.
struct Temporary(PathBuf);

impl Temporary {
    fn new() -> io::Result<Self> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("blocksim-native-{}-{number}", std::process::id()));
        // Nobody else's: what stands there would be loaded.
        fs::create_dir(&folder)?;
        Ok(Self(folder))
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
