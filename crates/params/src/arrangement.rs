//! Which quantity stands in which sheet: as a file beside the set says, or one sheet for each group.

use std::collections::{BTreeMap, BTreeSet};

use blocksim_signal::closest;
use blocksim_syntax::{Name, Node, Shape};

use crate::key::{numbered, words};
use crate::quantity::{Quantity, SetError};

/// The hidden sheet that remembers what was exported.
pub const MEMORY: &str = "blocksim";

/// Longest name of a sheet in spreadsheet programs, in characters, and what it must not have.
const LONGEST: usize = 31;
const FORBIDDEN: [char; 7] = ['[', ']', ':', '*', '?', '/', '\\'];

/// The sheets of a workbook and what stands in them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Arrangement {
    /// Names of the sheets, in their order.
    pub sheets: Vec<String>,
    /// The sheet of each quantity, from 0.
    pub(crate) of: Vec<usize>,
    /// Words such as `axis` whose numbers are columns.
    pub(crate) columns: BTreeSet<String>,
    /// What words of paths are called.
    pub(crate) labels: BTreeMap<String, String>,
}

impl Arrangement {
    /// One sheet for each name, in the order of the quantities.
    pub fn by_name(quantities: &[Quantity], name: impl Fn(&Quantity) -> String) -> Arrangement {
        let mut known: Vec<String> = Vec::new();
        let mut found = Arrangement::default();
        for quantity in quantities {
            let name = name(quantity);
            let at = known.iter().position(|other| *other == name).unwrap_or_else(|| {
                found.sheets.push(free_name(&name, &found.sheets));
                known.push(name);
                known.len() - 1
            });
            found.of.push(at);
        }
        found
    }

    /// One sheet for each group of a set: `axis1`, `axis2` ... are one group with a column each, and numbers that stand
    /// in no group have a sheet of their own.
    pub fn by_group(quantities: &[Quantity]) -> Arrangement {
        let mut numbers: BTreeMap<&str, BTreeSet<usize>> = BTreeMap::new();
        for (word, number, _) in quantities.iter().filter_map(|quantity| numbered(&quantity.path)) {
            numbers.entry(word).or_default().insert(number);
        }
        let columns: BTreeSet<String> = numbers
            .into_iter()
            .filter(|(_, numbers)| numbers.len() > 1)
            .map(|(word, _)| word.to_owned())
            .collect();
        let name = |quantity: &Quantity| match numbered(&quantity.path) {
            Some((word, ..)) if columns.contains(word) => word.to_owned(),
            _ => match quantity.path.split_once(['.', '[']) {
                Some((group, _)) if quantity.path.contains('.') => group.to_owned(),
                _ => "Parameters".to_owned(),
            },
        };
        Arrangement { columns: columns.clone(), ..Arrangement::by_name(quantities, name) }
    }

    /// The sheet of a quantity, by the place of both in their lists.
    pub fn sheet_of(&self, quantity: usize) -> Option<&str> {
        self.sheets.get(*self.of.get(quantity)?).map(String::as_str)
    }

    /// Reads the file that says which sheets a set has.
    ///
    /// # Errors
    /// What is wrong in the file, or in what it says about these quantities.
    pub fn read(text: &str, quantities: &[Quantity]) -> Result<Arrangement, SetError> {
        let root = blocksim_syntax::read(text)
            .map_err(|error| SetError::new(error.message, error.help.as_deref(), error.span))?;
        let mut found = Arrangement::default();
        let mut rules: Vec<Rule> = Vec::new();
        for (name, node) in members(&root, "sheets, columns and labels", SHAPE)? {
            match name.text.as_str() {
                "sheets" => {
                    for item in list(node)? {
                        sheet(item, &mut found.sheets, &mut rules)?;
                    }
                }
                "columns" => {
                    for item in list(node)? {
                        found.columns.insert(word(item)?.to_owned());
                    }
                }
                "labels" => {
                    for (name, node) in
                        members(node, "words and what they are called", "{ \"k\": \"gain\" }")?
                    {
                        found.labels.insert(name.text.clone(), word(node)?.to_owned());
                    }
                }
                other => return Err(unknown(other, &["sheets", "columns", "labels"], name)),
            }
        }
        if found.sheets.is_empty() {
            return Err(SetError::new("no sheet is named", Some(SHAPE), root.span));
        }
        for quantity in quantities {
            let path = generic(&quantity.path, &found.columns);
            let fitting = rules.iter_mut().filter(|rule| rule.fits(&path));
            let Some(best) = fitting.max_by_key(|rule| rule.weight()) else {
                let help =
                    "add its group to one of the sheets, or `holds: [\"*\"]` to the sheet of everything else";
                return Err(SetError::new(
                    format!("no sheet holds `{}`", quantity.path),
                    Some(help),
                    root.span,
                ));
            };
            best.is_used = true;
            found.of.push(best.sheet);
        }
        let Some(idle) = rules.iter().find(|rule| !rule.is_used) else { return Ok(found) };
        let paths: BTreeSet<String> =
            quantities.iter().map(|quantity| generic(&quantity.path, &found.columns)).collect();
        let heads = paths.iter().flat_map(|path| heads(path));
        let help = match closest(&idle.text, heads.collect::<BTreeSet<_>>()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "take it out".to_owned(),
        };
        let message = format!("`{}` holds no number of the set that another entry does not hold", idle.text);
        Err(SetError::new(message, Some(&help), idle.place.clone()))
    }
}

const SHAPE: &str = "write `(sheets: [(name: \"Motor\", holds: [\"motor\", \"gear.inertia\"]), (name: \"Other\", holds: [\"*\"])])`";

/// What an entry of `holds` says.
struct Rule {
    text: String,
    sheet: usize,
    place: std::ops::Range<usize>,
    is_used: bool,
}

impl Rule {
    /// Whether it is the path or one of its groups.
    fn fits(&self, path: &str) -> bool {
        let below = |rest: &str| rest.is_empty() || rest.starts_with(['.', '[']);
        self.text == "*" || path.strip_prefix(self.text.as_str()).is_some_and(below)
    }

    /// The longest one decides.
    fn weight(&self) -> usize {
        if self.text == "*" { 0 } else { self.text.len() }
    }
}

/// `axis3.limits.lower` as `axis*.limits.lower`.
fn generic(path: &str, columns: &BTreeSet<String>) -> String {
    match numbered(path) {
        Some((word, _, rest)) if columns.contains(word) => format!("{word}*.{rest}"),
        _ => path.to_owned(),
    }
}

/// A path and all groups that hold it.
fn heads(path: &str) -> Vec<&str> {
    let ends = path.char_indices().filter(|(_, c)| ['.', '['].contains(c)).map(|(at, _)| at);
    ends.chain([path.len()]).map(|end| &path[..end]).collect()
}

fn sheet(node: &Node, sheets: &mut Vec<String>, rules: &mut Vec<Rule>) -> Result<(), SetError> {
    let (mut name, mut holds) = (None, None);
    for (member, node) in members(node, "a sheet", SHAPE)? {
        match member.text.as_str() {
            "name" => name = Some(node),
            "holds" => holds = Some(node),
            other => return Err(unknown(other, &["name", "holds"], member)),
        }
    }
    let (Some(name), Some(holds)) = (name, holds) else {
        return Err(SetError::new(
            "a sheet needs a `name` and what it `holds`",
            Some(SHAPE),
            node.span.clone(),
        ));
    };
    let text = word(name)?;
    let refuse = |message: String, help: &str| Err(SetError::new(message, Some(help), name.span.clone()));
    if text.trim().is_empty()
        || text.chars().count() > LONGEST
        || text.contains(FORBIDDEN)
        || text.contains('\'')
    {
        let help = "a sheet has 1 to 31 characters, and none of [ ] : * ? / \\ '";
        return refuse(format!("`{text}` is not a valid name of a sheet"), help);
    }
    if is_taken(text, sheets) {
        return refuse(format!("the name `{text}` is taken"), "each sheet has a name of its own");
    }
    for item in list(holds)? {
        let text = word(item)?.to_owned();
        if let Some(first) = rules.iter().find(|rule| rule.text == text) {
            let message = format!(
                "`{text}` stands in the sheet `{}` already",
                sheets.get(first.sheet).map_or("", String::as_str)
            );
            return Err(SetError::new(message, Some("remove one of them"), item.span.clone()));
        }
        rules.push(Rule { text, sheet: sheets.len(), place: item.span.clone(), is_used: false });
    }
    sheets.push(text.to_owned());
    Ok(())
}

fn is_taken(name: &str, sheets: &[String]) -> bool {
    let same = |other: &str| other.trim().to_lowercase() == name.trim().to_lowercase();
    same(MEMORY) || sheets.iter().any(|other| same(other))
}

/// A name that spreadsheet programs accept and that no other sheet has.
fn free_name(name: &str, sheets: &[String]) -> String {
    let plain: String = name
        .chars()
        .map(|c| match c {
            '/' => '.',
            c if FORBIDDEN.contains(&c) || c == '\'' || c.is_control() => '_',
            c => c,
        })
        .collect();
    // The end of a long path tells more than its beginning.
    let fitted = |ending: &str| {
        let room = LONGEST - ending.chars().count();
        let skipped = plain.chars().count().saturating_sub(room);
        plain.chars().skip(skipped).collect::<String>() + ending
    };
    let mut names =
        std::iter::once(String::new()).chain((2..).map(|n| format!(" {n}"))).map(|ending| fitted(&ending));
    names.find(|name| !is_taken(name, sheets)).unwrap_or_default()
}

fn members<'a>(node: &'a Node, what: &str, help: &str) -> Result<&'a [(Name, Node)], SetError> {
    node.members().ok_or_else(|| {
        let message = format!("{what} are expected here, this is {}", node.describe());
        SetError::new(message, Some(help), node.span.clone())
    })
}

fn list(node: &Node) -> Result<&[Node], SetError> {
    match &node.value {
        Shape::List(items) => Ok(items),
        _ => {
            let message = format!("a list is expected, this is {}", node.describe());
            Err(SetError::new(message, Some("write it in brackets: `[...]`"), node.span.clone()))
        }
    }
}

fn word(node: &Node) -> Result<&str, SetError> {
    match &node.value {
        Shape::Text(text) => Ok(text),
        _ => {
            let message = format!("a text is expected, this is {}", node.describe());
            Err(SetError::new(message, Some("write it in quotes: `\"...\"`"), node.span.clone()))
        }
    }
}

fn unknown(found: &str, known: &[&str], name: &Name) -> SetError {
    let help = match closest(found, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("members are {}", known.join(", ")),
    };
    SetError::new(format!("there is no member `{found}`"), Some(&help), name.span.clone())
}

/// The words of keys whose columns have numbers, of the quantities of a sheet.
pub(crate) fn key_words(keys: &[(u32, &str)]) -> BTreeSet<String> {
    words(keys.iter().map(|(_, key)| *key))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::quantities;

    const SET: &str = "(m: 1, axis1: (lower: 1, gear: (k: 2)), axis2: (lower: 1, gear: (k: 2)), tool: (tcp: [1, 2, 3], m: 4))";

    fn refused(text: &str) -> (String, String, String) {
        let found = quantities(SET).expect("a set");
        let error = Arrangement::read(text, &found).expect_err(text);
        (error.message, error.help.unwrap_or_default(), text[error.place].to_owned())
    }

    #[test]
    fn groups_make_sheets_and_numbered_groups_columns() {
        let found = quantities(SET).expect("a set");
        let sheets = Arrangement::by_group(&found);
        assert_eq!(sheets.sheets, ["Parameters", "axis", "tool"]);
        assert_eq!(sheets.of, [0, 1, 1, 1, 1, 2, 2, 2, 2]);
    }

    #[test]
    fn the_longest_entry_decides() {
        let text = r#"(columns: ["axis"], labels: { "k": "gain" }, sheets: [
            (name: "A", holds: ["*"]), (name: "B", holds: ["axis*"]), (name: "C", holds: ["axis*.gear"])])"#;
        let found = quantities(SET).expect("a set");
        assert_eq!(Arrangement::read(text, &found).expect("sheets").of, [0, 1, 2, 1, 2, 0, 0, 0, 0]);
    }

    #[test]
    fn slips_are_named_with_place_and_remedy() {
        let one = |holds: &str| format!("(columns: [\"axis\"], sheets: [(name: \"A\", holds: [{holds}])])");
        for (text, message, help, place) in [
            (one("\"axis*\""), "no sheet holds `m`", "holds: [\"*\"]", ""),
            (one("\"*\", \"tol\""), "`tol` holds no number", "did you mean `tool`?", "\"tol\""),
            (one("\"*\", \"*\""), "stands in the sheet", "remove", "\"*\""),
            (one("\"*\", 3"), "a text is expected, this is a number", "quotes", "3"),
            ("(sheet: [])".to_owned(), "no member `sheet`", "did you mean `sheets`?", "sheet"),
            ("(sheets: (a: 1))".to_owned(), "a list is expected", "brackets", "(a: 1)"),
            ("(sheets: [(name: \"A\")])".to_owned(), "needs a `name`", "holds", "(name: \"A\")"),
            ("(sheets: [(name: \"A/B\", holds: [])])".to_owned(), "not a valid name", "31", "\"A/B\""),
            ("(sheets: [(name: \"Blocksim\", holds: [])])".to_owned(), "is taken", "own", "\"Blocksim\""),
            ("()".to_owned(), "no sheet is named", "sheets", "()"),
            ("3".to_owned(), "expected here, this is a number", "sheets", "3"),
        ] {
            let (said, remedy, at) = refused(&text);
            assert!(said.contains(message) && remedy.contains(help), "{text}: {said} / {remedy}");
            assert!(place.is_empty() || at == place, "{text}: {at}");
        }
        assert!(Arrangement::read("(sheets: [", &[]).is_err());
    }

    #[test]
    fn names_of_sheets_fit_into_spreadsheets_and_differ() {
        let text = "(a: 1, b: 2, c: 3)";
        let found = quantities(text).expect("a set");
        let long = |quantity: &Quantity| format!("arm/{}/{}/drive", "x".repeat(40), quantity.path);
        let sheets = Arrangement::by_name(&found, long).sheets;
        assert_eq!(sheets.len(), 3);
        assert!(
            sheets.iter().all(|name| name.chars().count() == LONGEST && name.ends_with(".drive")),
            "{sheets:?}"
        );
        let same = Arrangement::by_name(&found, |quantity| {
            if quantity.path == "a" { "x/y" } else { "x.y" }.to_owned()
        });
        assert_eq!(same.sheets, ["x.y", "x.y 2"]);
    }
}
