//! `panel: [...]`: what a model shows of itself while it runs, and what of it can be turned meanwhile; each element is compared
//! with the parameter or the signal that it names.

mod range;
#[cfg(test)]
mod tests;
mod values;

use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;

use blocksim_block::problem::{Place, Problem};
use blocksim_block::schedule::{Instance, Recorded, Schedule};
use blocksim_signal::Unit;

use crate::ast::{Ast, PanelAst, PanelWord};
use crate::flatten::record::matches;
use crate::overrides::Replaced;
use crate::problems::{Problems, mended};
use crate::scope::Scope;
use crate::settings::start::split_element;
use crate::targets::{Found, Target, find};
use range::Scale;
use values::Now;

/// An element of the panel of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct PanelItem {
    /// What it is.
    pub word: PanelWord,
    /// What it does.
    pub action: PanelAction,
    /// The parameter, as `--set` names it, or the signal, as it is recorded.
    pub name: String,
    /// A name for people, if it has one.
    pub label: Option<String>,
    /// Where it names that.
    pub place: Place,
}

/// What an element does.
#[derive(Debug, Clone, PartialEq)]
pub enum PanelAction {
    /// Changes a number within a range.
    Number {
        /// Ends of the range, in its unit.
        range: [f64; 2],
        /// The value that the text has, in the same unit.
        value: f64,
        /// The value that it has with what is set.
        now: f64,
        /// The unit as it stands behind a number; empty for a bare one.
        unit: String,
    },
    /// Changes between two values, as `--set` takes them.
    Two {
        /// The first.
        off: String,
        /// The second.
        on: String,
        /// Whether the text has the second.
        is_on: bool,
        /// Whether it has the second with what is set.
        is_on_now: bool,
    },
    /// Shows a recorded signal.
    Shows {
        /// Its position among what is recorded.
        recorded: usize,
        /// Whether it is recorded for the panel alone: no scope shows it, and the diagram does not ask for it.
        alone: bool,
        /// Ends of the scale in the unit.
        range: Option<[f64; 2]>,
        /// The unit that it is shown in, if the panel says one.
        unit: Option<Unit>,
    },
}

/// Compares the elements of the panel with a model and with what is set for it. Without a schedule nothing is known of signals.
pub(crate) fn panel<'a>(
    (ast, scope): (&Ast, &Rc<Scope<'a>>),
    targets: &[Target],
    replaced: &[Replaced],
    schedule: Option<&Schedule>,
    problems: &mut Problems,
) -> Vec<PanelItem> {
    let faulty = problems.error_places();
    let set = set(targets, replaced);
    let panel = Panel { ast, scope, targets, set, schedule, faulty };
    let mut items = Vec::new();
    for element in &ast.panel {
        match panel.item(element) {
            Ok(Some((item, warning))) => {
                problems.extend(warning);
                items.push(item);
            }
            Ok(None) => {}
            Err(problem) => problems.push(problem),
        }
    }
    items
}

/// What was set last of each target, by its name.
fn set<'p>(targets: &'p [Target], replaced: &'p [Replaced]) -> HashMap<&'p str, &'p Replaced> {
    // A parameter that is turned is set again and again.
    let last: HashMap<&str, &Replaced> = replaced.iter().map(|one| (one.target.as_str(), one)).collect();
    let named = |(name, one)| match find(targets, name) {
        Found::One(target) => Some((target.name.as_str(), one)),
        _ => None,
    };
    last.into_iter().filter_map(named).collect()
}

struct Panel<'p, 'a> {
    ast: &'p Ast,
    scope: &'p Rc<Scope<'a>>,
    targets: &'p [Target],
    set: HashMap<&'p str, &'p Replaced>,
    schedule: Option<&'p Schedule>,
    /// Where errors have been found already.
    faulty: Vec<Place>,
}

/// What is done, with a warning.
type Acts = (PanelAction, Option<Problem>);

impl<'a> Panel<'_, 'a> {
    fn place(&self, span: &Range<usize>) -> Place {
        self.ast.place(span)
    }

    fn item(&self, element: &PanelAst) -> Result<Option<(PanelItem, Option<Problem>)>, Problem> {
        let Some((name, at)) = element.about() else { return Ok(None) };
        let place = self.place(at);
        let (action, warning) = match element.kind {
            PanelWord::Gauge | PanelWord::Lamp => match self.shows(element, name, &place)? {
                Some(action) => (action, None),
                None => return Ok(None),
            },
            PanelWord::Slider | PanelWord::Knob | PanelWord::Switch | PanelWord::Button => {
                let target = self.target(name, &place)?;
                // That the panel cannot turn a value with a fault follows from the fault.
                if self.is_faulty(target) {
                    return Ok(None);
                }
                match element.kind {
                    PanelWord::Slider | PanelWord::Knob => self.number(element, target, &place)?,
                    _ => self.two(element, target, &place)?,
                }
            }
        };
        let label = element.text("label").map(|(text, _)| text.to_owned());
        Ok(Some((PanelItem { word: element.kind, action, name: name.to_owned(), label, place }, warning)))
    }

    /// Whether an error is known of what is written for a parameter.
    fn is_faulty(&self, target: &Target) -> bool {
        let Place { file, span } = &target.site.place;
        let is_within = |place: &Place| {
            place.file == *file && span.start <= place.span.start && place.span.end <= span.end
        };
        self.faulty.iter().any(is_within)
    }

    fn target(&self, name: &str, place: &Place) -> Result<&Target, Problem> {
        match find(self.targets, name) {
            Found::One(target) => Ok(target),
            Found::Several(below) => {
                let some: Vec<String> = below.iter().take(3).map(|one| format!("`{}`", one.name)).collect();
                let told = format!("`{name}` is not one parameter, but has {} below it", below.len());
                let help = format!("name one of them, such as {}", some.join(", "));
                Err(Problem::error("panel", told).at(place, "several parameters").help(help))
            }
            Found::Nothing(advice) => {
                let problem = Problem::error("unknown_parameter", format!("there is no parameter `{name}`"));
                let known = self.targets.iter().map(|target| target.name.as_str());
                let problem = mended(problem, place.clone(), name, known);
                Err(problem.at(place, "names no parameter").help(advice))
            }
        }
    }

    /// What a parameter is worth with what is set.
    fn now(&self, target: &Target) -> Now {
        self.set.get(target.name.as_str()).map_or_else(|| Now::of(target), |replaced| Now::set(replaced))
    }

    /// A slider or a knob.
    fn number(&self, element: &PanelAst, target: &Target, place: &Place) -> Result<Acts, Problem> {
        let now = Now::of(target);
        let Now::Number(quantity) = now else {
            let told = format!("`{}` is {}, not a number", target.name, now.described(target));
            let help = match now {
                Now::Truth(_) => format!("write Switch(\"{}\")", target.name),
                _ => "sliders and knobs change numbers; of a list they change one item, `name[0]`".to_owned(),
            };
            return Err(Problem::error("panel", told).at(place, "not a number").help(help));
        };
        // Without a range it has been refused where it was read.
        let (text, at) = element.text("range").unwrap_or(("", &element.span));
        let scale = Scale::of_target(target, quantity);
        let (range, scale) = range::read(self.scope, self.ast, text, at, &scale)?;
        let value = scale.shown(quantity.value);
        let now = match self.now(target) {
            Now::Number(quantity) => scale.shown(quantity.value),
            _ => value,
        };
        let unit = scale.text().to_owned();
        let warning = (!(range[0]..=range[1]).contains(&value)).then(|| {
            let told = format!("`{}` is {}, which is not within the range", target.name, scale.told(value));
            let help = "widen the range; it ends where the parameter makes no sense any more";
            Problem::warning("panel", told).at(&self.place(at), "does not contain the value").help(help)
        });
        Ok((PanelAction::Number { range, value, now, unit }, warning))
    }

    /// A switch or a button.
    fn two(&self, element: &PanelAst, target: &Target, place: &Place) -> Result<Acts, Problem> {
        let now = Now::of(target);
        if !now.changes(target) {
            let told =
                format!("`{}` is {}, which cannot change in a run", target.name, now.described(target));
            let help = "switches and buttons change truth values, numbers and words; what a model consists of is chosen when it starts";
            return Err(Problem::error("panel", told).at(place, "cannot change in a run").help(help));
        }
        let word = element.kind.name();
        let (off, on) = match (element.member("off"), element.member("on"), &now) {
            (Some(off), Some(on), _) => (off, on),
            (None, None, Now::Truth(is_on)) => {
                let [off, on] = ["false", "true"].map(str::to_owned);
                let is_on_now = self.now(target) == Now::Truth(true);
                return Ok((PanelAction::Two { off, on, is_on: *is_on, is_on_now }, None));
            }
            _ => {
                let told = format!(
                    "`{}` is {}: a {word} of it needs two values",
                    target.name,
                    now.described(target)
                );
                let example = now.example(target);
                let help = format!("write {word}(\"{}\", {example})", target.name);
                return Err(Problem::error("panel", told).at(place, "off and on are missing").help(help));
            }
        };
        let [off, on] = [off, on].map(|node| values::read(self.scope, self.ast, node, target, &now));
        let (off, on) = (off?, on?);
        if off.is_same(&on) {
            let told = format!("off and on of the {word} are the same");
            return Err(Problem::error("panel", told).at(&self.place(&element.span), "does nothing"));
        }
        let (is_on, is_on_now) = (on.is(&now), on.is(&self.now(target)));
        let warning = (!is_on && !off.is(&now)).then(|| {
            let told = format!("`{}` is {}, neither off nor on", target.name, now.described(target));
            let help = format!("the {word} is shown as off until it is used");
            Problem::warning("panel", told).at(place, "").help(help)
        });
        Ok((PanelAction::Two { off: off.text, on: on.text, is_on, is_on_now }, warning))
    }

    /// A gauge or a lamp; nothing as long as signals are not known.
    fn shows(&self, element: &PanelAst, name: &str, place: &Place) -> Result<Option<PanelAction>, Problem> {
        let Some(schedule) = self.schedule else { return Ok(None) };
        let Some(at) = schedule.recorded.iter().position(|recorded| recorded.path == name) else {
            let of_it = |recorded: &&Recorded| {
                recorded.path.strip_prefix(name).is_some_and(|rest| rest.starts_with(['[', '.']))
            };
            let Some(first) = schedule.recorded.iter().find(of_it) else {
                // What it names is not there, or nothing that can be recorded.
                let told = format!("there is no signal `{name}` that could be shown");
                let help = "name an output, block and port, such as `motor.w`";
                return Err(Problem::error("unknown_signal", told).at(place, "").help(help));
            };
            let told = format!("`{name}` is not one number");
            let help = format!("name one of them, such as `{}`", first.path);
            return Err(Problem::error("panel", told).at(place, "several numbers").help(help));
        };
        let recorded = &schedule.recorded[at];
        let (block, _) = name.rsplit_once('.').unwrap_or((name, ""));
        let is_scope = |known: &Instance| known.path == block && known.interface.recorded.is_some();
        let mut patterns = self.ast.record.iter().flat_map(|entry| &entry.signals);
        let alone = !schedule.blocks.iter().any(is_scope)
            && !patterns.any(|pattern| matches(&pattern.text, split_element(name).0));
        let Some((text, span)) = element.text("range") else {
            return Ok(Some(PanelAction::Shows { recorded: at, alone, range: None, unit: None }));
        };
        let scale = Scale::of_signal(recorded);
        let (range, scale) = range::read(self.scope, self.ast, text, span, &scale)?;
        Ok(Some(PanelAction::Shows { recorded: at, alone, range: Some(range), unit: scale.unit() }))
    }
}
