//! Compiles diagrams, exports parts of them, and compiles and runs what comes out.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use blocksim_block::problem::Problem;
use blocksim_block::schedule::Schedule;
// Blocks register themselves when they are linked, and linked is only what is named.
use blocksim_blocks as _;
use blocksim_codegen::{Generated, Part, Target, generate};
use blocksim_diagram::{Model, Options, Reader, Sources, compile_and_keep, origins};

/// Files of a diagram.
struct Texts(BTreeMap<PathBuf, String>);

impl Reader for Texts {
    fn read(&self, path: &Path) -> Result<String, String> {
        self.0.get(path).cloned().ok_or_else(|| "no such file".to_owned())
    }
}

/// A diagram whose subsystem `control` is a diagram of its own.
pub struct Loop {
    pub schedule: Schedule,
    pub model: Model,
}

impl Loop {
    /// A diagram `main.ron` that may name `control.ron`.
    pub fn new(main: &str, control: &str) -> Self {
        let texts = [("main.ron", main), ("control.ron", control)];
        let texts = Texts(texts.map(|(name, text)| (PathBuf::from(name), text.to_owned())).into());
        let sources = Sources::new(&texts);
        let (model, compiled) = compile_and_keep(&sources, Path::new("main.ron"), &Options::default());
        let schedule = compiled.schedule.unwrap_or_else(|| panic!("{:#?}", compiled.problems));
        Self { schedule, model: model.expect("a model") }
    }

    /// The subsystem `control` as a part.
    pub fn control(&self) -> Part {
        let block = self.model.block("control").expect("a subsystem");
        Part::subsystem(&self.schedule, "control", &block.inputs(), &block.outputs(), &origins(&self.model))
    }

    pub fn export(&self, target: &Target) -> Result<Generated, Vec<Problem>> {
        generate(&self.schedule, &self.control(), target)
    }
}

/// A target of this step.
pub fn every(step: f64) -> Target {
    Target { name: "control".to_owned(), step, method: None, float: false, test_steps: 5000 }
}

/// Messages and remedies.
pub fn told(problems: &[Problem]) -> String {
    problems
        .iter()
        .map(|problem| format!("{}\n  {}\n", problem.message, problem.help.as_deref().unwrap_or("")))
        .collect()
}

static FOLDERS: AtomicUsize = AtomicUsize::new(0);

/// Compiles the code with all warnings as errors, runs its test and returns what that prints.
pub fn run(generated: &Generated) -> String {
    let number = FOLDERS.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("blocksim-codegen-{}-{number}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    for (name, text) in &generated.files {
        std::fs::write(folder.join(name), text).expect("a file");
    }
    let name = &generated.name;
    for optimised in ["-O0", "-O2"] {
        let compiled = Command::new("cc")
            .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-ffp-contract=off", optimised])
            .args([format!("{name}.c"), format!("{name}_test.c")])
            .args(["-lm", "-o", "checked"])
            .current_dir(&folder)
            .output()
            .expect("a compiler of C named cc");
        assert!(
            compiled.status.success(),
            "{}\n{}",
            text_of(generated, ".c"),
            String::from_utf8_lossy(&compiled.stderr)
        );
        let ran = Command::new(folder.join("checked")).output().expect("a program");
        let printed = String::from_utf8_lossy(&ran.stdout).into_owned();
        if !ran.status.success() || optimised == "-O2" {
            std::fs::remove_dir_all(&folder).expect("a folder of its own");
            return printed;
        }
    }
    unreachable!("the last round returns")
}

/// The file whose name ends so.
pub fn text_of(generated: &Generated, ending: &str) -> String {
    let file = generated
        .files
        .iter()
        .find(|(name, _)| name.ends_with(ending) && !name.ends_with(&format!("_test{ending}")));
    file.map(|(_, text)| text.clone()).expect("a file")
}
