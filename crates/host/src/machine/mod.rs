//! Machine code of what a simulation runs: compiled by the C compiler of the system, kept, loaded and called.
//!
//! The sources are made here of tapes (`source`), so nothing of what guards plug-ins stands around the calls.

mod source;

use std::ffi::c_int;
use std::fs;
use std::io;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use blocksim_block::law::{Machine, Ran, Tape};
use libloading::Library;

use crate::build::Compilers;
use crate::fault::shown;
use crate::machine::source::Source;

/// Arguments of every compiler: nothing that rounds otherwise than the interpreter, which calls the functions of the library.
const FLAGS: [&str; 6] = ["-std=c99", "-O1", "-w", "-ffp-contract=off", "-fno-math-errno", "-fno-builtin"];

/// Those of gcc, which others refuse: nothing that takes longer than it saves with thousands of statements over one array, in which
/// nothing is computed twice.
const FLAGS_OF_GCC: [&str; 5] = [
    "-fno-inline-functions-called-once",
    "-fno-tree-dse",
    "-fno-dse",
    "-fno-tree-fre",
    "-fno-tree-dominator-opts",
];

/// Instructions that another process of the compiler is started for: less than these take not much longer than its start.
const SHARE: usize = 2_000;

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
    let source = Source::new(tapes);
    let text = source.whole();
    let extents: &[(usize, usize)] = &tapes.iter().map(|tape| tape.extent()).collect::<Vec<_>>();
    let compilers = Compilers::of_environment();
    let compiler = compilers.of(false);
    let version = version(compiler)?;
    let flags = flags(&version);
    let line =
        format!("{} {} {version} {compiler:?} {flags:?}", env!("CARGO_PKG_VERSION"), std::env::consts::ARCH);
    let key = format!("{:016x}", checksum(text.bytes().chain(line.bytes())));
    let kept = cache.map(|folder| Kept { folder: folder.to_owned(), key });
    if let Some(library) = kept.as_ref().and_then(|kept| kept.library(&text, &line))
        && let Ok(machines) = loaded(&library, extents)
    {
        return Ok(Machines { machines, was_kept: true, not_kept: None });
    }
    let place = Temporary::new().map_err(|error| NoMachines {
        message: format!("there is no place to compile the model: {error}"),
        help: "make room in the folder for temporary files, or name another one in TMPDIR".to_owned(),
    })?;
    let processors = std::thread::available_parallelism().map_or(1, NonZero::get);
    let invocation = Invocation { compiler, flags: &flags };
    let library = compile(invocation, &source.files(processors.min(source.cost() / SHARE).max(1)), &place.0)?;
    let machines = loaded(&library, extents)?;
    let not_kept = kept.and_then(|kept| {
        let error = kept.keep(&library, &text, &line).err()?;
        Some(format!("`{}`: {error}", shown(&kept.folder)))
    });
    Ok(Machines { machines, was_kept: false, not_kept })
}

/// The arguments of the compiler that calls itself so.
fn flags(version: &str) -> Vec<&'static str> {
    let of_gcc = FLAGS_OF_GCC.iter().filter(|_| !version.contains("clang"));
    FLAGS.iter().chain(of_gcc).copied().collect()
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

/// A compiler and its arguments.
#[derive(Clone, Copy)]
struct Invocation<'a> {
    compiler: &'a [String],
    flags: &'a [&'static str],
}

/// Compiles files to one library: a single one at once, several of them at the same time.
fn compile(invocation: Invocation, files: &[String], place: &Path) -> Result<PathBuf, NoMachines> {
    let library = place.join(format!("model{}", std::env::consts::DLL_SUFFIX));
    let mut texts = Vec::new();
    for (number, file) in files.iter().enumerate() {
        let text = place.join(format!("model{number}.c"));
        fs::write(&text, file).map_err(|error| NoMachines {
            message: format!("`{}` cannot be written: {error}", shown(&text)),
            help: "make room in the folder for temporary files, or name another one in TMPDIR".to_owned(),
        })?;
        texts.push(text);
    }
    let Invocation { compiler, flags } = invocation;
    let command = |arguments: &[&str], inputs: &[PathBuf], output: &Path| {
        let mut command = Command::new(&compiler[0]);
        command.args(&compiler[1..]).args(flags).args(arguments);
        if cfg!(unix) {
            command.arg("-fPIC");
        }
        command.args(inputs).arg("-o").arg(output);
        command
    };
    let linked = |inputs: &[PathBuf]| {
        let mut command = command(&["-shared"], inputs, &library);
        if cfg!(unix) {
            command.arg("-lm");
        }
        command
    };
    if files.len() == 1 {
        return run(compiler, [linked(&texts)]).map(|()| library);
    }
    let objects: Vec<PathBuf> = texts.iter().map(|text| text.with_extension("o")).collect();
    let each = texts.iter().zip(&objects);
    run(compiler, each.map(|(text, object)| command(&["-c"], std::slice::from_ref(text), object)))?;
    run(compiler, [linked(&objects)]).map(|()| library)
}

/// Runs a compiler several times at once, and waits for all of it.
fn run(compiler: &[String], commands: impl IntoIterator<Item = Command>) -> Result<(), NoMachines> {
    let refused = |said: String| NoMachines {
        message: format!("`{}` does not compile the model to machine code: {said}", compiler.join(" ")),
        help: "name another compiler in the variable CC, such as `CC=gcc`; without --native none is needed"
            .to_owned(),
    };
    let started: Vec<io::Result<Child>> = commands
        .into_iter()
        .map(|mut command| command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn())
        .collect();
    // Each is waited for, also behind one that fails: none is to write into a folder that is removed.
    let ended: Vec<io::Result<Output>> =
        started.into_iter().map(|child| child.and_then(Child::wait_with_output)).collect();
    for output in ended {
        let output = output.map_err(|error| refused(error.to_string()))?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            let first = said.lines().find(|line| line.contains("error")).or_else(|| said.lines().next());
            return Err(refused(first.map_or_else(|| output.status.to_string(), str::to_owned)));
        }
    }
    Ok(())
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

#[cfg(test)]
mod tests {
    use blocksim_block::law::{Id, Leaf, Op, Root};

    use super::*;

    /// A tape of products and differences in a row, each of which is a result.
    fn row(length: u32, first: u32) -> Tape {
        let mut ops = vec![Op::Input(0), Op::Input(1)];
        let mut roots = Vec::new();
        for i in 0..length {
            let last = Id(i + 1);
            ops.push(if i % 3 == 0 { Op::Mul(last, Id(0)) } else { Op::Sub(last, Id(i / 2)) });
            roots.push(Root::Cell(Id(i + 2), first + i));
        }
        let leaf = |op: Op| match op {
            Op::Input(cell) => Leaf::Cell(cell),
            other => unreachable!("{other:?} is not in here"),
        };
        Tape::make(&ops, &roots, &leaf, 4_000).tape
    }

    fn with_compiler<T>(work: impl FnOnce(Invocation, &Path) -> T) -> T {
        let compilers = Compilers::of_environment();
        let compiler = compilers.of(false);
        let flags = flags(&version(compiler).expect("a compiler"));
        let place = Temporary::new().expect("a place");
        work(Invocation { compiler, flags: &flags }, &place.0)
    }

    #[test]
    fn several_files_give_the_bits_of_one() {
        // The first is longer than a function may be, and its parts need each other.
        let tapes = [row(1_000, 10), row(3, 1_500), row(300, 2_000), row(301, 3_000)];
        let tapes: Vec<&Tape> = tapes.iter().collect();
        let source = Source::new(&tapes);
        let extents: Vec<(usize, usize)> = tapes.iter().map(|tape| tape.extent()).collect();
        for count in [1, 2, 3, 100] {
            let files = source.files(count);
            assert!(files.len() <= count && files.len() >= count.min(3), "{} files", files.len());
            let machines = with_compiler(|invocation, place| {
                loaded(&compile(invocation, &files, place).expect("a library"), &extents).expect("machines")
            });
            for (tape, machine) in tapes.iter().zip(machines) {
                let begin: Vec<f64> = (0..5_000).map(|i| 0.3 + f64::from(i % 7)).collect();
                let (mut cells, mut other) = (begin.clone(), begin);
                tape.interpret(&mut cells, &mut []);
                let ran = machine.run(&mut other, &mut []);
                assert_eq!(ran, Ran::default());
                let results = |cells: &[f64]| cells[..4_000].iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                assert!(results(&cells) == results(&other), "{count} files");
            }
        }
    }

    #[test]
    fn files_share_the_work_and_leave_nothing_out() {
        let tapes: Vec<Tape> = (0..40).map(|i| row(1 + 37 * (i % 11), 10)).collect();
        let source = Source::new(&tapes.iter().collect::<Vec<_>>());
        let sizes: Vec<usize> = source.files(4).iter().map(String::len).collect();
        assert_eq!(sizes.len(), 4);
        let (least, most) = (sizes.iter().min().unwrap(), sizes.iter().max().unwrap());
        assert!(*most < least * 3 / 2, "{sizes:?}");
        let statements = |file: &String| file.matches("const double v").count();
        let words: usize = tapes.iter().map(Tape::len).sum();
        assert_eq!(source.files(4).iter().map(statements).sum::<usize>(), words);
        assert_eq!(statements(&source.whole()), words);
        assert_eq!(Source::new(&[]).files(4).len(), 1);
    }

    #[test]
    fn a_file_that_the_compiler_refuses_is_reported_whichever_it_is() {
        let tape = row(5, 10);
        let good = Source::new(&[&tape]).whole();
        for at in 0..3 {
            let mut files = vec![good.replace(source::FUNCTION, "other_"); 3];
            files[at] = "#error this one is wrong\n".to_owned();
            let refused = with_compiler(|invocation, place| compile(invocation, &files, place));
            let NoMachines { message, help } = refused.expect_err("no library");
            assert!(message.contains("does not compile the model to machine code: "), "{message}");
            assert!(message.contains(&format!("model{at}.c")), "{message}");
            assert!(message.contains("this one is wrong") && help.contains("CC=gcc"), "{message}");
        }
        // Functions that two files have are found when these are linked.
        let twice = with_compiler(|invocation, place| compile(invocation, &[good.clone(), good], place));
        assert!(twice.expect_err("no library").message.contains("does not compile"));
    }

    #[test]
    fn flags_that_clang_refuses_are_those_of_gcc_alone() {
        assert_eq!(flags("Apple clang version 16.0.0 (clang-1600.0.26.6)"), FLAGS);
        assert_eq!(flags("cc (Debian 12.2.0-14) 12.2.0").len(), FLAGS.len() + FLAGS_OF_GCC.len());
    }
}
