//! Names of kinds and of parameters: those that do not exist, and those that are missing.

use blocksim_block::problem::Problem;
use blocksim_block::{BlockInfo, kinds, synonyms};
use blocksim_signal::closest;

use super::{HIERARCHY, Resolver};
use crate::ast::{Ast, BlockAst};
use crate::problems::{GUESSES, list, mended, mended_to};
use blocksim_syntax::{Name, Node};

/// The known name that means the same as one that is called otherwise elsewhere, unless the letters themselves say which is meant.
fn meaning<'a>(name: &str, known: impl Iterator<Item = &'a str> + Clone) -> Option<&'a str> {
    let plain = |text: &str| text.to_lowercase().replace('_', "");
    if known.clone().any(|known| plain(known) == plain(name)) {
        return None;
    }
    synonyms::parameter(name, |ours| known.clone().find(|known| *known == ours))
}

impl Resolver<'_> {
    pub(super) fn unknown_kind(&self, ast: &Ast, kind: &Name) {
        let mut known: Vec<&str> = kinds().iter().map(|info| info.kind).collect();
        known.extend(HIERARCHY.iter().map(|info| info.kind));
        let problem = Problem::error("unknown_block", format!("there is no block kind `{}`", kind.text))
            .at(&ast.place(&kind.span), "unknown kind");
        if !self.may_guess() {
            self.report(problem);
            return;
        }
        let problem = mended(problem, ast.place(&kind.span), &kind.text, known.iter().copied());
        self.report(match closest(&kind.text, known.iter().copied()) {
            Some(close) => {
                problem.help(format!("did you mean `{close}`? `blocksim blocks {close}` describes it"))
            }
            None => problem.help("`blocksim blocks` lists all kinds"),
        });
    }

    /// Whether one more unknown name is compared with all known ones.
    fn may_guess(&self) -> bool {
        self.unknown.set(self.unknown.get() + 1);
        self.unknown.get() <= GUESSES
    }

    /// Reports unknown and missing parameters, all at once.
    pub(super) fn names_fit(
        &self,
        ast: &Ast,
        block: &BlockAst,
        info: &BlockInfo,
        parameters: &[(Name, Node)],
    ) -> bool {
        let known: Vec<&str> = info.parameters.iter().map(|parameter| parameter.name).collect();
        let mut unknown = 0;
        for (name, _) in parameters.iter().filter(|(name, _)| !known.contains(&name.text.as_str())) {
            unknown += 1;
            let problem = Problem::error(
                "unknown_parameter",
                format!("`{}` has no parameter `{}`", info.kind, name.text),
            )
            .at(&ast.place(&name.span), "unknown parameter");
            if !self.may_guess() {
                self.report(problem);
                continue;
            }
            // One that is given already is not meant.
            let free =
                || known.iter().copied().filter(|known| !parameters.iter().any(|(n, _)| n.text == *known));
            let problem = match meaning(&name.text, free()) {
                Some(same) => {
                    let problem = mended_to(problem, ast.place(&name.span), &name.text, same);
                    problem.help(format!("here this is `{same}`; the parameters are {}", list(&known)))
                }
                None => {
                    let problem = mended(problem, ast.place(&name.span), &name.text, free());
                    match (closest(&name.text, known.iter().copied()), known.as_slice()) {
                        (_, []) => problem.help(format!("`{}` has no parameters", info.kind)),
                        (Some(close), _) => problem
                            .help(format!("did you mean `{close}`? The parameters are {}", list(&known))),
                        (None, _) => problem.help(format!("the parameters are {}", list(&known))),
                    }
                }
            };
            self.report(problem);
        }
        let missing: Vec<&str> = info
            .parameters
            .iter()
            .filter(|parameter| parameter.default.is_none())
            .map(|parameter| parameter.name)
            .filter(|name| !parameters.iter().any(|(given, _)| given.text == *name))
            .collect();
        // What is missing stands there under a wrong name.
        if missing.len() > unknown {
            self.report(
                Problem::error("missing_parameter", format!("`{}` needs {}", info.kind, list(&missing)))
                    .at(&ast.place(&block.kind.span), "not given")
                    .help(format!("`blocksim blocks {}` describes its parameters", info.kind)),
            );
        }
        unknown == 0 && missing.is_empty()
    }

    pub(super) fn unknown_with(&self, ast: &Ast, given: &Name, file: &str, known: &[String]) {
        let problem =
            Problem::error("unknown_parameter", format!("`{file}` has no parameter `{}`", given.text))
                .at(&ast.place(&given.span), "unknown parameter");
        let problem = mended(problem, ast.place(&given.span), &given.text, known.iter().map(String::as_str));
        self.report(match closest(&given.text, known.iter().map(String::as_str)) {
            Some(close) => problem.help(format!("did you mean `{close}`?")),
            None if known.is_empty() => problem.help("the file declares no parameters"),
            None => problem.help(format!("its parameters are {}", list(known))),
        });
    }
}
