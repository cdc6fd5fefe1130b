//! From written diagrams to blocks: kinds are looked up, parameters computed, subsystems and variants built.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

use blocksim_block::problem::{FileId, Problem};
use blocksim_block::{BlockInfo, BlockKind, Given, ParamUnits, kinds};
use blocksim_signal::{Value, closest};
use serde::Deserialize;

use crate::ast::{Ast, BlockAst, list, parse};
use crate::de::{Reading, Tagged, Written};
use crate::model::{Content, Model, ModelBlock, VariantChoice};
use crate::overrides::{Override, replace};
use crate::problems::Problems;
use crate::scope::{Evaluation, Scope, choices, missing_file, read_tree};
use crate::source::{BlockFiles, Sources};
use crate::tree::{Name, Node, Shape};

/// Kinds that build hierarchy; they are no blocks of the library.
pub const HIERARCHY: [BlockInfo; 2] = [
    BlockInfo {
        kind: "Subsystem",
        category: "Hierarchy",
        doc: "Puts one diagram into another.\n\n```ron\nSubsystem(file: \"joint.ron\", with: { \"axis\": \"robot.axis1\" })\n```",
        parameters: &[
            blocksim_block::ParameterInfo {
                name: "file",
                rust_type: "String",
                unit: "",
                default: None,
                doc: "The diagram, relative to the file that names it.",
            },
            blocksim_block::ParameterInfo {
                name: "with",
                rust_type: "set",
                unit: "",
                default: Some("{}"),
                doc: "Values for the parameters of the diagram: numbers, texts, lists, sets.",
            },
        ],
        file: file!(),
        line: line!(),
    },
    BlockInfo {
        kind: "Variant",
        category: "Hierarchy",
        doc: "Holds alternatives with the same ports; a parameter chooses which one is built.\n\n```ron\nVariant(choice: \"drive\", of: { \"asm\": Subsystem(file: \"asm.ron\"), \"dc\": Subsystem(file: \"dc.ron\") })\n```",
        parameters: &[
            blocksim_block::ParameterInfo {
                name: "choice",
                rust_type: "expression",
                unit: "",
                default: None,
                doc: "The parameter that names the alternative.",
            },
            blocksim_block::ParameterInfo {
                name: "of",
                rust_type: "set",
                unit: "",
                default: None,
                doc: "The alternatives: blocks, usually subsystems.",
            },
        ],
        file: file!(),
        line: line!(),
    },
];

/// Resolves the top diagram and everything below it.
pub(crate) struct Resolver<'a> {
    pub sources: &'a Sources<'a>,
    pub overrides: Vec<Override>,
    pub problems: RefCell<Problems>,
    asts: RefCell<HashMap<FileId, Option<Rc<Ast>>>>,
}

impl<'a> Resolver<'a> {
    pub(crate) fn new(sources: &'a Sources<'a>, overrides: Vec<Override>) -> Self {
        Self { sources, overrides, problems: RefCell::default(), asts: RefCell::default() }
    }

    fn report(&self, problem: Problem) {
        self.problems.borrow_mut().push(problem);
    }

    /// Reads a diagram once.
    pub(crate) fn ast(&self, file: FileId) -> Option<Rc<Ast>> {
        if let Some(known) = self.asts.borrow().get(&file) {
            return known.clone();
        }
        let ast = match read_tree(self.sources, file) {
            Ok(root) => parse(file, &root, &mut self.problems.borrow_mut()).map(Rc::new),
            Err(problem) => {
                self.report(problem);
                None
            }
        };
        self.asts.borrow_mut().insert(file, ast.clone());
        ast
    }

    /// The top diagram with its scope.
    pub(crate) fn top(&self, file: FileId) -> Option<(Model, Rc<Scope<'a>>)> {
        let ast = self.ast(file)?;
        let scope = Rc::new(Scope::new(self.sources, None));
        ast.parameters.iter().for_each(|(name, node)| scope.declare(name, file, node));
        self.override_parameters(&ast, &scope, "");
        let model = self.model(&ast, &scope, "", &[file]);
        for unused in self.overrides.iter().filter(|o| !o.used.get()) {
            self.report(self.unknown_override(unused, &model));
        }
        Some((model, scope))
    }

    /// The blocks of a diagram whose parameters are known.
    fn model(&self, ast: &Rc<Ast>, scope: &Rc<Scope<'a>>, path: &str, stack: &[FileId]) -> Model {
        for (name, _) in &ast.parameters {
            if let Some(Err(problem)) = scope.value(&name.text) {
                self.report(problem);
            }
        }
        let blocks = ast
            .blocks
            .iter()
            .map(|block| {
                let path = if path.is_empty() {
                    block.name.text.clone()
                } else {
                    format!("{path}/{}", block.name.text)
                };
                self.block(ast, block, scope, path, stack)
            })
            .collect();
        Model { path: path.to_owned(), ast: ast.clone(), blocks }
    }

    fn block(
        &self,
        ast: &Ast,
        block: &BlockAst,
        scope: &Rc<Scope<'a>>,
        path: String,
        stack: &[FileId],
    ) -> ModelBlock {
        let mut variant = None;
        let content = match block.kind.text.as_str() {
            "Subsystem" => self.subsystem(ast, block, scope, &path, stack),
            "Variant" => {
                let (choice, content) = self.variant(ast, block, scope, &path, stack);
                variant = choice;
                content
            }
            _ => self.primitive(ast, block, scope, &path),
        };
        ModelBlock {
            name: block.name.text.clone(),
            path,
            kind: block.kind.text.clone(),
            label: block.label.clone(),
            place: ast.place(&block.name.span),
            variant,
            content,
        }
    }

    // ---- blocks of the library ----

    fn primitive(&self, ast: &Ast, block: &BlockAst, scope: &Rc<Scope<'a>>, path: &str) -> Content {
        let Some(info) = BlockInfo::find(&block.kind.text) else {
            self.unknown_kind(ast, &block.kind);
            return Content::Unknown;
        };
        let parameters = self.block_overrides(block, info, path);
        if !self.names_fit(ast, block, info, &parameters) {
            return Content::Unknown;
        }
        let node =
            Node { span: block.span.clone(), value: Shape::Struct(Some(block.kind.clone()), parameters) };
        let reading = Reading::new(scope.clone(), ast.file, Some(info));
        let body = Written::new(&reading, &node);
        let kind = match Box::<dyn BlockKind>::deserialize(Tagged { kind: &block.kind.text, body }) {
            Ok(kind) => kind,
            Err(noted) => {
                let problem = reading
                    .problem
                    .take()
                    .unwrap_or_else(|| Problem::error("parameter", noted.0).at(&ast.place(&block.span), ""));
                self.report(self.about_override(problem, path));
                return Content::Unknown;
            }
        };
        let mut built = kind.into_block();
        let units = reading.units.take();
        let place_of = |param: &str| {
            let name = param.split(['.', '[']).next().unwrap_or(param);
            let parameter = block.parameters.iter().find(|(known, _)| known.text == name);
            ast.place(parameter.map_or(&block.span, |(_, node)| &node.span))
        };
        let files = BlockFiles { sources: self.sources, folder: self.sources.folder(ast.file) };
        if let Err(error) = built.load(&files) {
            let problem = Problem::error(error.code, error.message).at(&place_of(error.param), "");
            self.report(with_help(problem, error.help));
            return Content::Unknown;
        }
        if let Err(error) = built.check() {
            let problem = Problem::error("parameter", error.message)
                .at(&place_of(&error.param), "")
                .note(format!("in block `{path}` ({})", block.kind.text));
            self.report(with_help(problem, error.help));
            return Content::Unknown;
        }
        self.interface(ast, block, Arc::from(built), units)
    }

    fn interface(
        &self,
        ast: &Ast,
        block: &BlockAst,
        built: Arc<dyn blocksim_block::Block>,
        units: ParamUnits,
    ) -> Content {
        match built.interface(&Given::new(Vec::new(), units.clone())) {
            Ok(interface) => Content::Block { block: built, units, interface: Box::new(interface) },
            Err(error) => {
                let problem = Problem::error(error.code, error.message).at(&ast.place(&block.span), "");
                self.report(with_help(problem, error.help));
                Content::Unknown
            }
        }
    }

    fn unknown_kind(&self, ast: &Ast, kind: &Name) {
        let mut known: Vec<&str> = kinds().iter().map(|info| info.kind).collect();
        known.extend(HIERARCHY.iter().map(|info| info.kind));
        let problem = Problem::error("unknown_block", format!("there is no block kind `{}`", kind.text))
            .at(&ast.place(&kind.span), "unknown kind");
        self.report(match closest(&kind.text, known.iter().copied()) {
            Some(close) => {
                problem.help(format!("did you mean `{close}`? `blocksim blocks {close}` describes it"))
            }
            None => problem.help("`blocksim blocks` lists all kinds"),
        });
    }

    /// Reports unknown and missing parameters, all at once.
    fn names_fit(&self, ast: &Ast, block: &BlockAst, info: &BlockInfo, parameters: &[(Name, Node)]) -> bool {
        let known: Vec<&str> = info.parameters.iter().map(|parameter| parameter.name).collect();
        let mut fits = true;
        for (name, _) in parameters.iter().filter(|(name, _)| !known.contains(&name.text.as_str())) {
            fits = false;
            let problem = Problem::error(
                "unknown_parameter",
                format!("`{}` has no parameter `{}`", info.kind, name.text),
            )
            .at(&ast.place(&name.span), "unknown parameter");
            self.report(match (closest(&name.text, known.iter().copied()), known.as_slice()) {
                (_, []) => problem.help(format!("`{}` has no parameters", info.kind)),
                (Some(close), _) => {
                    problem.help(format!("did you mean `{close}`? The parameters are {}", list(&known)))
                }
                (None, _) => problem.help(format!("the parameters are {}", list(&known))),
            });
        }
        let missing: Vec<&str> = info
            .parameters
            .iter()
            .filter(|parameter| parameter.default.is_none())
            .map(|parameter| parameter.name)
            .filter(|name| !parameters.iter().any(|(given, _)| given.text == *name))
            .collect();
        if !missing.is_empty() {
            fits = false;
            self.report(
                Problem::error("missing_parameter", format!("`{}` needs {}", info.kind, list(&missing)))
                    .at(&ast.place(&block.kind.span), "not given")
                    .help(format!("`blocksim blocks {}` describes its parameters", info.kind)),
            );
        }
        fits
    }

    /// Parameters with those replaced that the command line names.
    fn block_overrides(&self, block: &BlockAst, info: &BlockInfo, path: &str) -> Vec<(Name, Node)> {
        let mut parameters = block.parameters.clone();
        for (over, names) in self.overrides_of(path) {
            let Some((first, rest)) = names.split_first() else { continue };
            let Some(parameter) = info.parameters.iter().find(|parameter| parameter.name == *first) else {
                // The parameters of a plug-in stand in a set of their own.
                let inner = parameters.iter_mut().find(|(name, _)| name.text == "parameters");
                if let (Some((_, node)), []) = (inner, rest)
                    && let Shape::Map(members) | Shape::Struct(None, members) = &mut node.value
                {
                    over.used.set(true);
                    put(members, first, value_node(over, true), &node.span);
                }
                continue;
            };
            if rest.is_empty() {
                over.used.set(true);
                let text = ["f64", "String", "usize", "u32", "ParamValue"]
                    .iter()
                    .any(|t| parameter.rust_type.contains(t));
                put(&mut parameters, first, value_node(over, text), &block.span);
            }
        }
        parameters
    }

    /// What the command line sets in the block at a path, with the names below it.
    fn overrides_of<'s>(&'s self, path: &'s str) -> impl Iterator<Item = (&'s Override, &'s [String])> {
        self.overrides.iter().filter_map(move |over| {
            // At the top a block and a parameter look alike: `pid.kp`.
            let top = over.path.is_empty() && over.names.len() > 1 && over.names[0] == path;
            match over.path == path {
                true if !over.path.is_empty() => Some((over, over.names.as_slice())),
                _ if top => Some((over, &over.names[1..])),
                _ => None,
            }
        })
    }

    /// A value from the command line has no place in the file.
    fn about_override(&self, problem: Problem, path: &str) -> Problem {
        match self.overrides_of(path).next() {
            Some((over, _)) => problem.note(format!("with `--set {}`", over.text)),
            None => problem,
        }
    }

    // ---- subsystems ----

    fn subsystem(
        &self,
        ast: &Ast,
        block: &BlockAst,
        scope: &Rc<Scope<'a>>,
        path: &str,
        stack: &[FileId],
    ) -> Content {
        if !self.names_fit(ast, block, &HIERARCHY[0], &block.parameters) {
            return Content::Unknown;
        }
        let parameter =
            |name: &str| block.parameters.iter().find(|(n, _)| n.text == name).map(|(_, node)| node);
        let Some(Node { value: Shape::Text(name), span }) = parameter("file") else {
            self.report(
                Problem::error("parameter", "the file of a subsystem is a text")
                    .at(&ast.place(&block.span), "")
                    .help("write `file: \"name.ron\"`"),
            );
            return Content::Unknown;
        };
        let place = ast.place(span);
        let file = match self.sources.open(&self.sources.folder(ast.file).join(name)) {
            Ok(file) => file,
            Err(reason) => {
                self.report(missing_file(name, &reason, &place));
                return Content::Unknown;
            }
        };
        if stack.contains(&file) {
            self.report(
                Problem::error("recursive_file", format!("`{name}` contains itself"))
                    .at(&place, "is being built already")
                    .help("a diagram cannot be part of itself"),
            );
            return Content::Unknown;
        }
        let Some(inside) = self.ast(file) else { return Content::Unknown };
        let inner = Rc::new(Scope::new(self.sources, Some(scope.clone())));
        inside.parameters.iter().for_each(|(name, node)| inner.declare(name, file, node));
        let mut fits = true;
        if let Some(with) = parameter("with") {
            for (given, node) in with.members().unwrap_or_default() {
                if inner.has(&given.text) {
                    inner.give(given, ast.file, node, scope);
                } else {
                    fits = false;
                    self.unknown_with(ast, given, name, &inner.own_names());
                }
            }
        }
        self.override_parameters(&inside, &inner, path);
        for (parameter, node) in &inside.parameters {
            let required = matches!(&node.value, Shape::Word(word) if word == "Required");
            let given = !required
                || !matches!(inner.value(&parameter.text), Some(Err(p)) if p.code == "missing_parameter");
            if !given {
                fits = false;
                self.report(
                    Problem::error(
                        "missing_parameter",
                        format!("`{name}` needs the parameter `{}`", parameter.text),
                    )
                    .at(&ast.place(&block.span), "not given")
                    .at(&inside.place(&parameter.span), "required here")
                    .help(format!("add it to `with: {{ \"{}\": ... }}`", parameter.text)),
                );
            }
        }
        if !fits {
            return Content::Unknown;
        }
        let mut stack = stack.to_vec();
        stack.push(file);
        Content::Diagram(Box::new(self.model(&inside, &inner, path, &stack)))
    }

    fn unknown_with(&self, ast: &Ast, given: &Name, file: &str, known: &[String]) {
        let problem =
            Problem::error("unknown_parameter", format!("`{file}` has no parameter `{}`", given.text))
                .at(&ast.place(&given.span), "unknown parameter");
        self.report(match closest(&given.text, known.iter().map(String::as_str)) {
            Some(close) => problem.help(format!("did you mean `{close}`?")),
            None if known.is_empty() => problem.help("the file declares no parameters"),
            None => problem.help(format!("its parameters are {}", list(known))),
        });
    }

    /// Parameters of a diagram that the command line replaces.
    fn override_parameters(&self, ast: &Ast, scope: &Rc<Scope<'a>>, path: &str) {
        for over in self.overrides.iter().filter(|over| over.path == path && scope.has(&over.names[0])) {
            // A block may bear the name of a parameter; what the parameter does not have is meant for the block.
            let is_block = ast.blocks.iter().any(|block| block.name.text == over.names[0]);
            let member = over.names.get(1);
            let has_member = |value: Value| member.is_none_or(|member| value.get(member).is_some());
            if is_block && !scope.value(&over.names[0]).and_then(Result::ok).is_some_and(has_member) {
                continue;
            }
            over.used.set(true);
            let declared =
                ast.parameters.iter().find(|(name, _)| name.text == over.names[0]).map(|(_, node)| node);
            match self.overridden(over, declared, scope) {
                Ok(value) => scope.set(&over.names[0], value),
                Err(problem) => self.report(problem),
            }
        }
    }

    fn overridden(
        &self,
        over: &Override,
        declared: Option<&Node>,
        scope: &Rc<Scope<'a>>,
    ) -> Result<Value, Problem> {
        let alternatives = declared.map(choices).unwrap_or_default();
        let fail = |message: String| Problem::error("unknown_override", message).at(&over.place(), "");
        if over.names.len() == 1 && !alternatives.is_empty() {
            let (Shape::Word(word) | Shape::Text(word)) = &over.node.value else {
                return Err(fail(format!("`{}` is one of {}", over.names[0], list(&alternatives))));
            };
            if alternatives.contains(word) {
                return Ok(Value::Text(word.clone()));
            }
            let problem = fail(format!("`{}` has no alternative `{word}`", over.names[0]));
            return Err(match closest(word, alternatives.iter().map(String::as_str)) {
                Some(close) => problem
                    .help(format!("did you mean `{close}`? The alternatives are {}", list(&alternatives))),
                None => problem.help(format!("the alternatives are {}", list(&alternatives))),
            });
        }
        let required =
            matches!(declared.map(|node| &node.value), Some(Shape::Word(word)) if word == "Required");
        let mut value = match scope.value(&over.names[0]) {
            Some(Ok(value)) => value,
            Some(Err(_)) if required && over.names.len() == 1 => Value::Bool(false),
            Some(Err(problem)) => return Err(problem),
            None => return Err(fail(format!("there is no parameter `{}`", over.names[0]))),
        };
        let old_is_text = matches!(value, Value::Text(_)) && over.names.len() == 1;
        let new = match &over.node.value {
            Shape::Word(word) | Shape::Text(word) if old_is_text => Value::Text(word.clone()),
            _ => {
                let stack = Vec::new();
                Evaluation { scope, file: over.file, stack: &stack }.value(&value_node(over, true))?
            }
        };
        replace(&mut value, &over.names[1..], new).map_err(fail)?;
        Ok(value)
    }

    fn unknown_override(&self, over: &Override, model: &Model) -> Problem {
        let target = over.text.split('=').next().unwrap_or_default().trim();
        let problem = Problem::error("unknown_override", format!("there is no `{target}` to set"))
            .at(&over.place(), "");
        let mut known: Vec<String> = model.ast.parameters.iter().map(|(name, _)| name.text.clone()).collect();
        collect_parameters(model, &mut known);
        match closest(target, known.iter().map(String::as_str)) {
            Some(close) => problem.help(format!("did you mean `{close}`?")),
            None => problem.help(format!(
                "parameters of the diagram are {}; `path/to/block.parameter` names one of a block",
                list(&model.ast.parameters.iter().map(|(name, _)| name.text.clone()).collect::<Vec<_>>())
            )),
        }
    }

    // ---- variants ----

    fn variant(
        &self,
        ast: &Ast,
        block: &BlockAst,
        scope: &Rc<Scope<'a>>,
        path: &str,
        stack: &[FileId],
    ) -> (Option<VariantChoice>, Content) {
        if !self.names_fit(ast, block, &HIERARCHY[1], &block.parameters) {
            return (None, Content::Unknown);
        }
        let parameter =
            |name: &str| block.parameters.iter().find(|(n, _)| n.text == name).map(|(_, node)| node);
        let (Some(choice), Some(of)) = (parameter("choice"), parameter("of")) else {
            return (None, Content::Unknown);
        };
        let alternatives = self.alternatives(ast, of);
        let names: Vec<String> = alternatives.iter().map(|block| block.name.text.clone()).collect();
        let stack_of_files = Vec::new();
        let chosen = Evaluation { scope, file: ast.file, stack: &stack_of_files }.value(choice);
        let chosen = match chosen {
            Ok(Value::Text(chosen)) => chosen,
            Ok(other) => {
                self.report(
                    Problem::error(
                        "parameter",
                        format!("the choice of a variant is a text, found {}", other.describe()),
                    )
                    .at(&ast.place(&choice.span), "")
                    .help("name a parameter whose value is Text(\"...\") or a Choice"),
                );
                return (None, Content::Unknown);
            }
            Err(problem) => {
                self.report(problem);
                return (None, Content::Unknown);
            }
        };
        if !names.contains(&chosen) {
            let problem = Problem::error("unknown_variant", format!("there is no alternative `{chosen}`"))
                .at(&ast.place(&choice.span), "chosen here")
                .at(&ast.place(&of.span), "the alternatives");
            self.report(match closest(&chosen, names.iter().map(String::as_str)) {
                Some(close) => problem.help(format!("did you mean `{close}`?")),
                None => problem.help(format!("the alternatives are {}", list(&names))),
            });
            return (None, Content::Unknown);
        }
        // All alternatives are read and checked; one is kept.
        let built: Vec<ModelBlock> =
            alternatives.iter().map(|block| self.block(ast, block, scope, path.to_owned(), stack)).collect();
        for (model, block) in built.iter().zip(&alternatives) {
            if let Content::Diagram(model) = &model.content
                && block.name.text != chosen
            {
                crate::connect::check(model, &mut self.problems.borrow_mut());
            }
        }
        self.same_ports(ast, &alternatives, &built);
        let by = if let Shape::Text(text) = &choice.value { text.clone() } else { String::new() };
        let kept = built
            .into_iter()
            .find(|block| block.name == chosen)
            .map_or(Content::Unknown, |block| block.content);
        (Some(VariantChoice { by, chosen, of: names }), kept)
    }

    fn alternatives(&self, ast: &Ast, of: &Node) -> Vec<BlockAst> {
        let members = of.members().unwrap_or_default();
        let wrapped = Node {
            span: of.span.clone(),
            value: Shape::Struct(
                None,
                vec![(
                    Name { text: "blocks".to_owned(), span: of.span.clone() },
                    Node { span: of.span.clone(), value: Shape::Map(members.to_vec()) },
                )],
            ),
        };
        parse(ast.file, &wrapped, &mut self.problems.borrow_mut()).map(|ast| ast.blocks).unwrap_or_default()
    }

    /// Alternatives must be exchangeable.
    fn same_ports(&self, ast: &Ast, alternatives: &[BlockAst], built: &[ModelBlock]) {
        let known: Vec<(&ModelBlock, &BlockAst)> = built
            .iter()
            .zip(alternatives)
            .filter(|(block, _)| !matches!(block.content, Content::Unknown))
            .collect();
        let Some(((first, first_ast), others)) = known.split_first() else { return };
        for (other, other_ast) in others {
            let sides: [(&str, Vec<String>, Vec<String>); 3] = [
                ("input", first.inputs(), other.inputs()),
                ("output", first.outputs(), other.outputs()),
                ("conserving port", first.ports(), other.ports()),
            ];
            for (what, a, b) in sides {
                let place = |span: &Range<usize>| ast.place(span);
                let lacks =
                    |names: &[String], others: &[String]| names.iter().find(|n| !others.contains(n)).cloned();
                let (port, has, has_not) = match (lacks(&a, &b), lacks(&b, &a)) {
                    (Some(port), _) => (port, first_ast, other_ast),
                    (None, Some(port)) => (port, other_ast, first_ast),
                    (None, None) => continue,
                };
                self.report(
                    Problem::error(
                        "variant_ports",
                        format!("alternative `{}` has no {what} `{port}`", has_not.name.text),
                    )
                    .at(&place(&has_not.name.span), format!("no {what} `{port}`"))
                    .at(&place(&has.name.span), "has it")
                    .help("all alternatives of a variant offer the same ports"),
                );
            }
        }
    }
}

/// Replaces or adds a member.
fn put(members: &mut Vec<(Name, Node)>, name: &str, node: Node, span: &Range<usize>) {
    // The value stands on the command line; in the file the whole block is its place.
    let node = Node { span: span.clone(), ..node };
    match members.iter_mut().find(|(known, _)| known.text == name) {
        Some((_, old)) => *old = Node { span: old.span.clone(), ..node },
        None => members.push((Name { text: name.to_owned(), span: span.clone() }, node)),
    }
}

/// A word from the command line is an expression or a text where one of them is asked for.
fn value_node(over: &Override, text: bool) -> Node {
    match &over.node.value {
        Shape::Word(word) if text && word != "None" => {
            Node { span: over.node.span.clone(), value: Shape::Text(word.clone()) }
        }
        _ => over.node.clone(),
    }
}

fn with_help(problem: Problem, help: Option<String>) -> Problem {
    match help {
        Some(help) => problem.help(help),
        None => problem,
    }
}

/// What `--set` could have meant.
fn collect_parameters(model: &Model, known: &mut Vec<String>) {
    for block in &model.blocks {
        match &block.content {
            Content::Diagram(inside) => {
                known.extend(
                    inside.ast.parameters.iter().map(|(name, _)| format!("{}.{}", block.path, name.text)),
                );
                collect_parameters(inside, known);
            }
            Content::Block { .. } => {
                if let Some(info) = BlockInfo::find(&block.kind) {
                    known.extend(info.parameters.iter().map(|p| format!("{}.{}", block.path, p.name)));
                }
            }
            Content::Unknown => {}
        }
    }
}
