//! From the text of a diagram to a schedule.
//!
//! ```text
//! text -parse-> Ast -resolve-> Model -connect-> -flatten-> Flat -elaborate-> Flat -infer-> Typed -sort-> Schedule
//! ```
//!
//! Every arrow is a function from plain data to plain data that gathers problems instead of stopping at the
//! first, and every form can be printed ([`Stages::emit`]). Networks are assembled after flattening, because
//! they reach across subsystems. The library of blocks is found through the registry alone.

mod ast;
mod condition;
mod connect;
mod de;
mod elaborate;
mod emit;
mod example;
mod fingerprint;
mod flatten;
mod infer;
mod mentions;
mod model;
mod offers;
mod overrides;
mod panel;
mod parameter;
mod problems;
mod rates;
mod replacing;
mod resolve;
mod scope;
mod settings;
mod sort;
mod source;
mod targets;
#[cfg(test)]
mod toys;

use std::path::Path;
use std::rc::Rc;

use blocksim_block::problem::{Place, Problem};
use blocksim_block::schedule::{Schedule, Start};
use blocksim_scene::Scene;

pub use ast::{Ast, BlockAst, ConnectionAst, PanelAst, PanelWord, RATES, RecordAst, Reference};
pub use condition::{Condition, SetOutput, WhenEnabled};
pub use emit::{Stage, Stages};
pub use example::{example_block, example_interface};
pub use fingerprint::fingerprint;
pub use flatten::{Declared, Flat, FlatBlock, Source, origins};
pub use infer::Typed;
pub use mentions::{Meaning, Mention, Mentions, Symbol, mentions};
pub use model::{Content, Model, ModelBlock, PortKind, VariantChoice};
pub use offers::{SIMULATION, Step, members, words};
pub use overrides::Replaced;
pub use panel::{PanelAction, PanelItem};
pub use parameter::{has_parameter, parameter};
pub use problems::not_ron;
pub use rates::off_grid;
pub use replacing::WrittenUnit;
pub use resolve::HIERARCHY;
pub use source::{Reader, SourceFile, Sources, Trees};
pub use targets::{Found, Origin, Site, Spelling, Target, below, find, spelled, targets};

/// What became of a diagram.
#[derive(Debug, Clone, Default)]
pub struct Compiled {
    /// What the engine runs; `None` when there are errors.
    pub schedule: Option<Schedule>,
    /// All problems, errors first, in the order of files and places.
    pub problems: Vec<Problem>,
    /// Intermediate forms, as far as the compiler came, where [`Options::stages`] is set.
    pub stages: Stages,
    /// What is seen of the mechanisms, as far as the compiler came; the world alone where there are none.
    pub scene: Option<Scene>,
    /// Variants by path.
    pub variants: Vec<(String, VariantChoice)>,
    /// The values of `--set` as they were understood, as far as the compiler came.
    pub replaced: Vec<Replaced>,
    /// What the panel changes and shows while the model runs; what shows a signal only where there are no errors.
    pub panel: Vec<PanelItem>,
}

/// The hierarchy of a diagram, for those who look at it without running it, and the problems found on the way. Some
/// blocks may be [`Content::Unknown`]; connections are checked by name alone.
pub fn model(sources: &Sources, root: &Path, overrides: &[String]) -> (Option<Model>, Vec<Problem>) {
    let mut problems = problems::Problems::default();
    let model = top(sources, root, overrides, false, &mut problems).map(|top| top.model);
    if let Some(model) = &model {
        connect::check(model, &mut problems);
    }
    (model, problems.sorted())
}

/// Reads and resolves a diagram and all that it names.
fn top<'a>(
    sources: &'a Sources<'a>,
    root: &Path,
    overrides: &[String],
    strict: bool,
    problems: &mut problems::Problems,
) -> Option<Top<'a>> {
    let file = match sources.open(root) {
        Ok(file) => file,
        Err(reason) => {
            problems.push(
                Problem::error("missing_file", format!("cannot read `{}`: {reason}", root.display()))
                    .help("give the path of a diagram, such as diagrams/servo.ron"),
            );
            return None;
        }
    };
    let mut parsed = Vec::new();
    for text in overrides {
        match overrides::parse(sources, text) {
            Ok(over) => parsed.push(over),
            Err(problem) => problems.push(problem),
        }
    }
    let mut resolver = resolve::Resolver::new(sources, parsed);
    resolver.strict = strict;
    let top = resolver.top(file);
    problems.extend(resolver.problems.take().sorted());
    let replaced = resolver.overrides.iter().map(overrides::Override::replaced).collect();
    top.map(|(model, scope)| Top { model, scope, replaced, resolver })
}

/// A diagram and all below it, resolved.
struct Top<'a> {
    model: Model,
    scope: Rc<scope::Scope<'a>>,
    replaced: Vec<Replaced>,
    resolver: resolve::Resolver<'a>,
}

/// What a number without a unit means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Units {
    /// It is in SI where the place has a unit, and its unit is open elsewhere.
    #[default]
    Open,
    /// It is an error where the place has a unit, and has no unit elsewhere. Zero fits any unit.
    Strict,
}

/// How a diagram is compiled.
#[derive(Debug, Clone, Copy, Default)]
pub struct Options<'o> {
    /// `target=value` as of `--set`.
    pub overrides: &'o [String],
    /// Outputs that somebody looks at, as of [`compile_to_watch`].
    pub watched: &'o [String],
    /// Patterns of signals to record beside those that the diagram records.
    pub recorded: &'o [String],
    /// What a number without a unit means.
    pub units: Units,
    /// Whether the intermediate forms are kept as texts, which takes a twentieth of the time of a compilation.
    pub stages: bool,
}

/// What stands in the place of a file for patterns of signals from the command line.
const RECORD: &str = "--record";

/// Turns the text of a diagram into something that can run. `overrides` are `target=value` as of `--set`.
pub fn compile(sources: &Sources, root: &Path, overrides: &[String]) -> Compiled {
    compile_with(sources, root, &Options { overrides, ..Options::default() })
}

/// The same for somebody who will look at outputs that nothing in the diagram reads or records, by their names
/// (`circuit/l.v`, or one element of a vector, `arm.q[2]`). A physical network owes only those outputs a value that are read, recorded
/// or named here: where it cannot know one of these, as that needs the slope of a signal which nothing tells, it says so.
/// Names that fit no output are left alone.
pub fn compile_to_watch(
    sources: &Sources,
    root: &Path,
    overrides: &[String],
    watched: &[String],
) -> Compiled {
    compile_with(sources, root, &Options { overrides, watched, ..Options::default() })
}

/// Turns the text of a diagram into something that can run, as [`Options`] say.
pub fn compile_with(sources: &Sources, root: &Path, options: &Options) -> Compiled {
    compile_and_keep(sources, root, options).1
}

/// As [`compile_with`], with the hierarchy of the diagram as [`model`] returns it.
pub fn compile_and_keep(sources: &Sources, root: &Path, options: &Options) -> (Option<Model>, Compiled) {
    let mut problems = problems::Problems::default();
    let mut compiled = Compiled::default();
    let mut kept = None;
    let strict = options.units == Units::Strict;
    if let Some(top) = top(sources, root, options.overrides, strict, &mut problems) {
        let Top { model, scope, replaced, resolver } = top;
        compiled.replaced = replaced;
        if options.stages {
            compiled.stages.ast = Some(emit::ast(&model.ast));
            compiled.stages.model = Some(emit::model(&model));
        }
        collect_variants(&model, &mut compiled.variants);
        connect::check(&model, &mut problems);
        let held = |pattern: &String| {
            let file = sources.hold(Path::new(RECORD), pattern);
            (pattern.clone(), Place { file, span: 0..pattern.len() })
        };
        let also: Vec<(String, Place)> = options.recorded.iter().map(held).collect();
        let flat = flatten::flatten(&model, &also, &mut problems);
        let settings = settings::settings(&model.ast, &scope, sort::end_time(&flat), strict, &mut problems);
        let rates = rates::rates(&model.ast, &scope, &settings, &mut problems);
        let title = model.ast.title.clone().unwrap_or_else(|| {
            root.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
        });
        // A network that lacks a block would bring problems that are none.
        if !problems.any_error() {
            let held = match &settings.start {
                Start::Steady(steady) => steady.hold.as_slice(),
                _ => &[],
            };
            let watched = options.watched.iter().chain(held.iter().map(|held| &held.name));
            let (flat, scene) = elaborate::elaborate(flat, watched, &mut problems);
            if !problems.any_error() {
                compiled.scene = Some(scene);
                let typed = infer::infer(&flat, &mut problems);
                if options.stages {
                    compiled.stages.flat = Some(emit::flat(&flat));
                    compiled.stages.types = Some(emit::types(&flat, &typed));
                }
                if !problems.any_error() {
                    compiled.schedule = sort::sort(title, flat, typed, settings, &mut problems);
                    if let Some(schedule) = &mut compiled.schedule {
                        rates::assign(&model.ast, &rates, &mut schedule.recorded);
                        settings::start::resolve(&model.ast, schedule, &mut problems);
                        settings::atol::resolve(&model.ast, schedule, &mut problems);
                    }
                    if options.stages {
                        compiled.stages.schedule = compiled.schedule.as_ref().map(emit::schedule);
                    }
                }
            }
        } else {
            // Units and shapes can be wrong as well; blocks of networks are left as they are.
            infer::infer(&flat, &mut problems);
        }
        if !model.ast.panel.is_empty() {
            let all = targets::of_instances(sources, &resolver.instances.borrow(), &resolver.chosen.borrow());
            let schedule = compiled.schedule.as_ref();
            compiled.panel =
                panel::panel((&model.ast, &scope), &all, &compiled.replaced, schedule, &mut problems);
        }
        // What is wrong may hide who reads a parameter.
        if !problems.any_error() {
            problems.extend(resolver.unused());
        }
        kept = Some(model);
    }
    compiled.problems = problems.sorted();
    if problems.any_error() {
        compiled.schedule = None;
    }
    (kept, compiled)
}

fn collect_variants(model: &Model, out: &mut Vec<(String, VariantChoice)>) {
    for block in &model.blocks {
        if let Some(variant) = &block.variant {
            out.push((block.path.clone(), variant.clone()));
        }
        if let Content::Diagram(inside) = &block.content {
            collect_variants(inside, out);
        }
    }
}
