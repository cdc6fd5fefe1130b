//! Expressions, with the parameters that they see.

use std::cell::RefCell;
use std::ops::Range;
use std::rc::Rc;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_signal::{ExprError, Lookup, Noted, Part, Scope as Names, Value, evaluate_noted};

use super::{Scope, segments};
use crate::mentions::Event;

/// The names that an expression sees, for `blocksim_signal::evaluate`; keeps the problem of a parameter that
/// could not be computed.
struct Visible<'s, 'a> {
    scope: &'s Rc<Scope<'a>>,
    failed: RefCell<Option<Problem>>,
}

impl Names for Visible<'_, '_> {
    fn lookup(&self, name: &str) -> Lookup {
        match self.scope.value(name) {
            None => Lookup::Unknown,
            Some(Ok(value)) => Lookup::Found(value),
            Some(Err(problem)) => {
                let reason = problem.message.clone();
                self.failed.borrow_mut().get_or_insert(problem);
                Lookup::Failed(reason)
            }
        }
    }

    fn select(&self, name: &str, path: &[Part]) -> Option<Value> {
        self.scope.select(name, path)
    }

    fn names(&self) -> Vec<String> {
        let mut names = Vec::new();
        let mut scope = Some(self.scope);
        while let Some(current) = scope {
            names.extend(current.own_names());
            scope = current.parent.as_ref();
        }
        names
    }
}

/// Evaluates an expression; problems are placed in the text that begins at `start` of `file`.
pub(crate) fn expression(
    scope: &Rc<Scope>,
    text: &str,
    file: FileId,
    start: usize,
    whole: &Range<usize>,
) -> Result<Value, Problem> {
    noted(scope, text, file, start, whole).map(|noted| noted.value)
}

/// As [`expression`], with the units and names that stand in it.
pub(crate) fn noted(
    scope: &Rc<Scope>,
    text: &str,
    file: FileId,
    start: usize,
    whole: &Range<usize>,
) -> Result<Noted, Problem> {
    let visible = Visible { scope, failed: RefCell::default() };
    // Signs are counted that may open a level; a parameter on the way costs as much stack as some brackets.
    let levels = 8 + text.matches(['(', '[', '^', '-', '+', '!']).count();
    let place = || Place { file, span: whole.clone() };
    let evaluated =
        || evaluate_noted(text, &visible).map_err(|error| located(error, text, &visible, file, start, whole));
    let noted = scope.deeper(levels, place, evaluated)?;
    noted.names.iter().for_each(|name| scope.note_read(name));
    // Without a place of its own the text has been read elsewhere.
    if !whole.is_empty() && scope.sources.log.is_on() {
        for (name, at) in noted.names.iter().zip(&noted.starts) {
            let name = segments(name).next().unwrap_or_default();
            let span = start + at..start + at + name.len();
            if let Some(declared) = scope.declared(name) {
                scope.sources.log.note(Event::Named { place: Place { file, span }, declared });
            }
        }
    }
    Ok(noted)
}

/// The problem of a parameter that could not be computed, or what is wrong with the text itself.
fn located(
    error: ExprError,
    text: &str,
    visible: &Visible,
    file: FileId,
    start: usize,
    whole: &Range<usize>,
) -> Problem {
    if let Some(problem) = visible.failed.take() {
        return problem;
    }
    // Texts with escapes are longer in the file than in memory: then the whole text is shown.
    let inside = start + error.span.end <= whole.end;
    let is_exact = inside && !error.span.is_empty();
    let span = if is_exact { start + error.span.start..start + error.span.end } else { whole.clone() };
    let mut problem = Problem::error("expression", error.message).at(&Place { file, span: span.clone() }, "");
    if let (Some(remedy), Some(old), true) = (error.remedy, text.get(error.span), is_exact) {
        problem = problem.edit(Place { file, span }, old, remedy);
    }
    match error.help {
        Some(help) => problem.help(help),
        None => problem,
    }
}
