//! All that can be set, from the instances of diagrams that the resolver has built.

use std::path::Path;
use std::rc::Rc;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_block::{BlockInfo, ParameterInfo, Requirements};
use blocksim_signal::Value;
use foldhash::{HashSet, HashSetExt};

use super::site;
use super::{Origin, Site, Spelling, Target};
use crate::ast::BlockAst;
use crate::problems::Problems;
use crate::replacing::{Place as Where, WrittenUnit};
use crate::resolve::{Chosen, Instance, Resolver};
use crate::scope::{Evaluation, Scope, described, read_tree};
use crate::source::Sources;
use blocksim_syntax::{Name, Node, Shape};

/// Longest list whose items are targets, and how deep files may name each other.
const ITEMS: usize = 100;
const DEEPEST: usize = 20;

pub(super) fn targets(sources: &Sources, root: &Path) -> (Vec<Target>, Vec<Problem>) {
    let mut problems = Problems::default();
    let mut walk = Walk { sources, found: Vec::new() };
    let file = match sources.open(root) {
        Ok(file) => file,
        Err(reason) => {
            problems.push(
                Problem::error("missing_file", format!("cannot read `{}`: {reason}", root.display()))
                    .help("give the path of a diagram or of a file of values"),
            );
            return (walk.found, problems.sorted());
        }
    };
    let tree = match read_tree(sources, file) {
        Ok(tree) => tree,
        Err(problem) => {
            problems.push(problem);
            return (walk.found, problems.sorted());
        }
    };
    if !matches!(&tree.value, Shape::Struct(Some(kind), _) if kind.text == "Diagram") {
        let scope = Rc::new(Scope::new(sources, None));
        walk.members(&Stand { file, scope: &scope, sharers: 1, depth: 0 }, "", &tree);
        return (walk.found, problems.sorted());
    }
    let resolver = Resolver::new(sources, Vec::new());
    resolver.top(file);
    let found = of_instances(sources, &resolver.instances.take(), &resolver.chosen.take());
    problems.extend(resolver.problems.take().sorted());
    (found, problems.sorted())
}

pub(super) fn of_instances<'a>(
    sources: &'a Sources<'a>,
    instances: &[Instance<'a>],
    chosen: &[Chosen<'a>],
) -> Vec<Target> {
    let mut walk = Walk { sources, found: Vec::new() };
    for instance in instances {
        walk.instance(instance, instances);
    }
    for Chosen { path, block, file, scope } in chosen {
        let Some(info) = BlockInfo::find(&block.kind.text) else { continue };
        let stand = Stand { file: *file, scope, sharers: sharers(instances, *file), depth: 0 };
        walk.block(&stand, path, block, info);
    }
    // Where a block bears the name of a parameter, the parameter is meant first.
    let mut seen = HashSet::new();
    walk.found.retain(|target| seen.insert(target.name.clone()));
    walk.found
}

struct Walk<'a> {
    sources: &'a Sources<'a>,
    found: Vec<Target>,
}

/// How many diagrams are made of a file.
fn sharers(all: &[Instance], file: FileId) -> usize {
    all.iter().filter(|other| other.ast.file == file).count()
}

/// Where a value stands.
struct Stand<'w, 'a> {
    file: FileId,
    scope: &'w Rc<Scope<'a>>,
    sharers: usize,
    depth: usize,
}

impl<'a> Walk<'a> {
    fn instance(&mut self, instance: &Instance<'a>, all: &[Instance<'a>]) {
        let sharers = |file: FileId| sharers(all, file);
        let prefix = |name: &str| match instance.path.is_empty() {
            true => name.to_owned(),
            false => format!("{}.{name}", instance.path),
        };
        let file = instance.ast.file;
        for (name, node) in &instance.ast.parameters {
            let target = prefix(&name.text);
            let Some(giver) = &instance.giver else {
                let stand = Stand { file, scope: &instance.scope, sharers: sharers(file), depth: 0 };
                self.value(&stand, target, node, "");
                continue;
            };
            let sharers = sharers(giver.file);
            let given = giver.with().iter().find(|(given, _)| given.text == name.text);
            if let Some((_, node)) = given {
                self.value(
                    &Stand { file: giver.file, scope: &giver.scope, sharers, depth: 0 },
                    target,
                    node,
                    "",
                );
                continue;
            }
            // What the file of the subsystem says holds for all of its instances: another value is given to this one.
            let (node, spelling) = plain(node);
            let place = Place { file, span: node.span.clone() };
            let value = instance.scope.value(&name.text).and_then(Result::ok);
            let written_unit = written_unit(&instance.scope, file, node, value.as_ref());
            self.found.push(Target {
                name: target,
                written: self.text(&place),
                value,
                unit: String::new(),
                written_unit,
                origin: Origin::Declared(place),
                site: site::given(
                    &giver.block,
                    giver.file,
                    &self.sources.file(giver.file).text,
                    &name.text,
                    spelling,
                ),
                spelling,
                sharers,
                is_item: false,
                requires: Requirements::NONE,
            });
        }
        for block in &instance.ast.blocks {
            let Some(info) = BlockInfo::find(&block.kind.text) else { continue };
            let path = match instance.path.is_empty() {
                true => block.name.text.clone(),
                false => format!("{}/{}", instance.path, block.name.text),
            };
            let stand = Stand { file, scope: &instance.scope, sharers: sharers(file), depth: 0 };
            self.block(&stand, &path, block, info);
        }
    }

    fn block(&mut self, stand: &Stand<'_, 'a>, path: &str, block: &BlockAst, info: &BlockInfo) {
        for parameter in info.parameters {
            let name = format!("{path}.{}", parameter.name);
            let spelling = spelling_of(parameter);
            let Some((_, node)) = block.parameters.iter().find(|(given, _)| given.text == parameter.name)
            else {
                let Some(default) = parameter.default else { continue };
                let text = &self.sources.file(stand.file).text;
                self.found.push(Target {
                    name,
                    written: default.to_owned(),
                    value: None,
                    unit: parameter.unit.to_owned(),
                    written_unit: WrittenUnit::Si,
                    origin: Origin::Kind(info.kind.to_owned()),
                    site: site::parameter(block, stand.file, text, parameter.name),
                    spelling,
                    sharers: stand.sharers,
                    is_item: false,
                    requires: parameter.requires,
                });
                continue;
            };
            if let (true, Some(members)) = (parameter.name == "parameters", node.members()) {
                // The parameters of a plug-in stand in a set of their own.
                for (inner, node) in members {
                    self.leaf(stand, format!("{path}.{}", inner.text), node, "", Spelling::Expression, false);
                }
                continue;
            }
            self.leaf(stand, name, node, parameter.unit, spelling, false);
            if let Some(target) = self.found.last_mut() {
                target.requires = parameter.requires;
            }
        }
    }

    /// A value of any type, and what lies below it.
    fn value(&mut self, stand: &Stand<'_, 'a>, name: String, node: &Node, unit: &str) {
        let (inner, spelling) = plain(node);
        match &inner.value {
            Shape::Map(_) | Shape::Struct(None, _) => self.members(stand, &name, inner),
            Shape::List(items) => {
                self.leaf(stand, name.clone(), inner, unit, spelling, false);
                for (n, item) in items.iter().enumerate().take(ITEMS) {
                    let (item, spelling) = plain(item);
                    let name = format!("{name}[{n}]");
                    match &item.value {
                        Shape::Map(_) | Shape::Struct(None, _) => self.members(stand, &name, item),
                        _ => self.leaf(stand, name, item, unit, spelling, true),
                    }
                }
            }
            Shape::Tuple(Some(word), items) if word.text == "File" => {
                self.leaf(stand, name.clone(), inner, unit, spelling, false);
                let Some(Node { value: Shape::Text(path), .. }) = items.first() else { return };
                let full = self.sources.folder(stand.file).join(path);
                let Ok(file) = self.sources.open(&full) else { return };
                let Ok(tree) = read_tree(self.sources, file) else { return };
                if stand.depth < DEEPEST {
                    let within = Stand { file, depth: stand.depth + 1, ..*stand };
                    self.members(&within, &name, &tree);
                }
            }
            _ => self.leaf(stand, name, inner, unit, spelling, false),
        }
    }

    fn members(&mut self, stand: &Stand<'_, 'a>, name: &str, node: &Node) {
        let members = match &node.value {
            Shape::Map(members) | Shape::Struct(_, members) => members.as_slice(),
            _ => &[],
        };
        for (member, node) in members {
            let name = if name.is_empty() { member.text.clone() } else { format!("{name}.{}", member.text) };
            self.value(stand, name, node, "");
        }
    }

    fn leaf(
        &mut self,
        stand: &Stand<'_, 'a>,
        name: String,
        node: &Node,
        unit: &str,
        spelling: Spelling,
        is_item: bool,
    ) {
        let place = Place { file: stand.file, span: node.span.clone() };
        let stack = Vec::new();
        let evaluation = Evaluation { scope: stand.scope, file: stand.file, stack: &stack };
        // Files are told by their names, not by all that they hold.
        let is_file = matches!(&node.value, Shape::Tuple(Some(word), _) if word.text == "File");
        let value = match spelling {
            Spelling::Expression if !is_file => evaluation.value(node).ok(),
            _ => None,
        };
        let written_unit = written_unit(stand.scope, stand.file, node, value.as_ref());
        self.found.push(Target {
            name,
            written: self.text(&place),
            value,
            unit: unit.to_owned(),
            written_unit,
            origin: Origin::Text(place.clone()),
            site: Site { place, before: String::new(), after: String::new() },
            spelling,
            sharers: stand.sharers,
            is_item,
            requires: Requirements::NONE,
        });
    }

    fn text(&self, place: &Place) -> String {
        self.sources.file(place.file).text.get(place.span.clone()).unwrap_or_default().to_owned()
    }
}

/// The unit in which a number is written.
fn written_unit<'a>(scope: &Rc<Scope<'a>>, file: FileId, node: &Node, value: Option<&Value>) -> WrittenUnit {
    match value {
        Some(Value::Number(number)) => {
            let place = Where { scope: scope.clone(), file, node: Rc::new(node.clone()) };
            place.unit(number.dimension)
        }
        _ => WrittenUnit::Si,
    }
}

/// What is to be changed of a value that has something around it: the number of a described one, the text of
/// `Text("...")`, the default of a choice.
fn plain(node: &Node) -> (&Node, Spelling) {
    let default = |members: &'_ [(Name, Node)]| members.iter().position(|(name, _)| name.text == "default");
    match &node.value {
        Shape::Struct(None, members) => match described(members) {
            Some(value) => plain(value),
            None => (node, Spelling::Expression),
        },
        Shape::Struct(Some(word), members) if word.text == "Choice" => match default(members) {
            Some(at) => (&members[at].1, Spelling::Text),
            None => (node, Spelling::Expression),
        },
        Shape::Tuple(Some(word), items) if word.text == "Text" && items.len() == 1 => {
            (&items[0], Spelling::Text)
        }
        _ => (node, Spelling::Expression),
    }
}

/// How a value of a parameter of a block is written.
fn spelling_of(parameter: &ParameterInfo) -> Spelling {
    let is = |word: &str| parameter.rust_type.contains(word);
    if is("String") || is("PathBuf") {
        Spelling::Text
    } else if !parameter.unit.is_empty()
        || ["f64", "usize", "u32", "ParamValue", "Entries"].into_iter().any(is)
    {
        Spelling::Expression
    } else {
        Spelling::Word
    }
}
