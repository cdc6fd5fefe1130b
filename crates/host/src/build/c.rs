//! Builds the C and C++ sources of a folder with the compilers of the system, into `target/blocksim` below the folder.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::SystemTime;

use blocksim_abi::HEADER;
use blocksim_block::LoadError;

use super::settings::{self, SETTINGS};
use super::text::text;
use super::{Answer, SHOWN_LINES, fresh, notify};
use crate::fault::{self, BUILD, MISSING};

/// Endings of sources in C++.
const CPP: [&str; 3] = ["cc", "cpp", "cxx"];
/// The header of the contract, which is written beside what is built.
const HEADER_NAME: &str = "blocksim_plugin.h";
/// Arguments for every source. Without contraction a product and a sum round as they are written, on every computer.
const COMMON: [&str; 4] = ["-Wall", "-Wextra", "-O2", "-ffp-contract=off"];
/// For C: the standard, and no function that nobody has declared, which would return an `int`.
const C: [&str; 2] = ["-std=c99", "-Werror=implicit-function-declaration"];
/// For C++: the first standard in which tables can be written with the names of their fields.
const CXX: [&str; 1] = ["-std=c++20"];

/// Whether a file is compiled because it stands in the folder of a plug-in.
pub fn is_source(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "c") || is_cpp(path)
}

fn is_cpp(path: &Path) -> bool {
    path.extension().and_then(OsStr::to_str).is_some_and(|ending| CPP.contains(&ending))
}

/// Compilers with arguments that come with their names, as in `CC="ccache gcc"`.
#[derive(Debug, Clone)]
pub struct Compilers {
    c: Vec<String>,
    cpp: Vec<String>,
}

impl Compilers {
    /// Those of `CC` and `CXX`, or else `cc` and `c++`.
    pub fn of_environment() -> Compilers {
        let named = |variable: &str, default: &str| {
            let words = std::env::var(variable).unwrap_or_default();
            let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
            if words.is_empty() { vec![default.to_owned()] } else { words }
        };
        Compilers { c: named("CC", "cc"), cpp: named("CXX", "c++") }
    }

    /// The one for C++, or for C.
    pub fn of(&self, is_cpp: bool) -> &[String] {
        if is_cpp { &self.cpp } else { &self.c }
    }
}

/// What is built of what, and how.
struct Recipe {
    /// Sources relative to the folder, sorted.
    sources: Vec<PathBuf>,
    /// Arguments for each source behind those of its language.
    flags: Vec<String>,
    /// Arguments of the linker behind its input.
    libraries: Vec<String>,
    library: PathBuf,
}

impl Recipe {
    fn of(folder: &Path, named: &str) -> Result<Recipe, LoadError> {
        let settings = settings::read(folder).map_err(|reason| {
            fault::library(BUILD, format!("the plug-in `{named}` cannot be built: {reason}"))
        })?;
        let sources = match &settings.sources {
            Some(listed) => listed.iter().map(PathBuf::from).collect(),
            None => sources(folder).unwrap_or_default(),
        };
        if let Some(absent) = sources.iter().find(|source| !folder.join(source).is_file()) {
            let said = format!("{SETTINGS} lists `{}`, which is not there", absent.display());
            return Err(fault::library(BUILD, format!("the plug-in `{named}` cannot be built: {said}")));
        }
        if sources.is_empty() {
            let error = fault::library(BUILD, format!("the plug-in `{named}` has no sources"));
            return Err(fault::help(error, "put a `.c` or `.cpp` file into its folder"));
        }
        let name = settings.name.unwrap_or_else(|| {
            folder.file_name().map_or_else(|| "plugin".to_owned(), |name| name.to_string_lossy().into_owned())
        });
        let name: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        let file = format!("{}{name}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
        let mut flags: Vec<String> = COMMON.map(str::to_owned).into();
        if cfg!(unix) {
            flags.push("-fPIC".to_owned());
        }
        flags.extend(settings.include.iter().map(|folder| format!("-I{folder}")));
        flags.extend(settings.flags);
        let libraries = settings.libraries.iter().map(|name| format!("-l{name}")).collect();
        Ok(Recipe { sources, flags, libraries, library: target(folder).join(file) })
    }

    /// In a line, for the stamp: another one gives another library.
    fn line(&self, compilers: &Compilers) -> String {
        let header = HEADER.bytes().fold(0_u64, |sum, byte| sum.wrapping_mul(31).wrapping_add(byte.into()));
        let Recipe { sources, flags, libraries, .. } = self;
        format!("{compilers:?} {sources:?} {flags:?} {libraries:?} {C:?} {CXX:?} {header:x}")
            .replace('\n', " ")
    }
}

/// Where everything is built.
fn target(folder: &Path) -> PathBuf {
    folder.join("target").join("blocksim")
}

/// Sources that stand in a folder, sorted, without the folder.
fn sources(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut sources = Vec::new();
    for entry in fs::read_dir(folder)? {
        let name = PathBuf::from(entry?.file_name());
        let is_hidden = name.to_string_lossy().starts_with('.');
        if is_source(&name) && !is_hidden {
            sources.push(name);
        }
    }
    sources.sort();
    Ok(sources)
}

/// The library of the sources in `folder`, built unless nothing has changed.
pub fn built(compilers: &Compilers, folder: &Path, named: &str) -> Answer {
    let recipe = Recipe::of(folder, named)?;
    let line = recipe.line(compilers);
    if fresh::is_fresh(&recipe.library, &line) {
        return Ok(recipe.library);
    }
    let asked = SystemTime::now();
    // Whoever else builds the same has a folder of its own; the library appears whole.
    let place = target(folder).join(format!("build-{}", std::process::id()));
    let made = compile(compilers, &recipe, folder, named, &place);
    let _ = fs::remove_dir_all(&place);
    if let Some(files) = made? {
        fresh::remember(&recipe.library, &line, &files, asked);
    }
    Ok(recipe.library)
}

/// Compiles and links; gives all files that were read, if they are known.
fn compile(
    compilers: &Compilers,
    recipe: &Recipe,
    folder: &Path,
    named: &str,
    place: &Path,
) -> Result<Option<BTreeSet<PathBuf>>, LoadError> {
    let disk = |e: io::Error| {
        let error = fault::library(BUILD, format!("the plug-in `{named}` cannot be built: {e}"));
        fault::help(error, format!("it is built in `{}`", fault::shown(place)))
    };
    fs::create_dir_all(place).map_err(disk)?;
    fs::write(place.join(HEADER_NAME), HEADER).map_err(disk)?;
    let mut files = Some(BTreeSet::from([folder.join(SETTINGS)]));
    let (mut objects, mut warnings) = (Vec::new(), String::new());
    for (at, source) in recipe.sources.iter().enumerate() {
        let compiler = compilers.of(is_cpp(source));
        if at == 0 {
            notify(&format!("building the plug-in `{named}` with {}", compiler.join(" ")));
        }
        let (object, rule) = (place.join(format!("{at}.o")), place.join(format!("{at}.d")));
        let mut command = command(compiler, folder);
        command.args(if is_cpp(source) { &CXX[..] } else { &C[..] }).args(&recipe.flags).arg("-I").arg(place);
        command.arg("-MD").arg("-MF").arg(&rule).arg("-c").arg(source).arg("-o").arg(&object);
        let output = run(&mut command, is_cpp(source), named)?;
        if !output.status.success() {
            return Err(refused(&output, named, &format!("`{}` does not compile", source.display())));
        }
        warnings += &String::from_utf8_lossy(&output.stderr);
        let read = text(&rule).ok().as_deref().and_then(fresh::rule_files);
        let read = read.map(|read| read.into_iter().map(|file| folder.join(file)).collect::<Vec<_>>());
        // A name that a rule writes in another way is a file that is not found: nothing is known then.
        files = match (files, read) {
            (Some(mut files), Some(read)) if read.iter().all(|file| file.is_file()) => {
                files.extend(read.into_iter().filter(|file| !file.starts_with(place)));
                Some(files)
            }
            _ => None,
        };
        objects.push(object);
    }
    let is_cpp = recipe.sources.iter().any(|source| is_cpp(source));
    let file = place.join(recipe.library.file_name().unwrap_or_default());
    let mut command = command(compilers.of(is_cpp), folder);
    command.arg("-shared").arg("-o").arg(&file).args(&objects).args(&recipe.libraries);
    if cfg!(target_os = "linux") {
        // What is missing is told now instead of when the library is loaded; elsewhere linkers do so anyway.
        command.arg("-Wl,-z,defs");
    }
    if cfg!(unix) {
        command.arg("-lm");
    }
    let output = run(&mut command, is_cpp, named)?;
    if !output.status.success() {
        return Err(refused(&output, named, "it cannot be linked"));
    }
    if !warnings.trim().is_empty() {
        first_lines(&warnings).lines().for_each(notify);
    }
    fs::rename(&file, &recipe.library).map_err(disk)?;
    Ok(files)
}

/// A compiler that reports places relative to the folder of the plug-in.
fn command(compiler: &[String], folder: &Path) -> Command {
    let mut command = Command::new(&compiler[0]);
    command.args(&compiler[1..]).current_dir(folder).stdin(Stdio::null());
    command
}

fn run(command: &mut Command, is_cpp: bool, named: &str) -> Result<Output, LoadError> {
    command.output().map_err(|e| {
        let (language, variable) = if is_cpp { ("C++", "CXX") } else { ("C", "CC") };
        let program = command.get_program().to_string_lossy();
        let message = format!("the plug-in `{named}` needs a {language} compiler, and `{program}` cannot be run: {e}");
        let remedy = format!(
            "install gcc or clang, such as with `apt-get install g++`, or name a compiler in the variable {variable}"
        );
        fault::help(fault::library(MISSING, message), remedy)
    })
}

fn refused(output: &Output, named: &str, what: &str) -> LoadError {
    let said = String::from_utf8_lossy(&output.stderr);
    let error =
        fault::library(BUILD, format!("the plug-in `{named}` does not build:\n{}", first_lines(&said)));
    fault::help(error, format!("{what}; places are relative to the folder of the plug-in"))
}

/// The first error of a C compiler is the one that counts.
fn first_lines(text: &str) -> String {
    let lines: Vec<&str> = text.trim_end().lines().collect();
    let shown = lines[..lines.len().min(SHOWN_LINES)].join("\n");
    if lines.len() > SHOWN_LINES { format!("{shown}\n...") } else { shown }
}
