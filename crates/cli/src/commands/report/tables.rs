//! The parameters of a model as tables: names, values with units as written, sources, and where they are written.

use std::path::Path;

use blocksim_block::problem::{FileId, Place};
use blocksim_diagram::{Model, Sources};
use blocksim_report::Rows;
use blocksim_syntax::{Name, Node, Shape};

use super::source_text::{line, one_line, set_for};

/// Most rows of a table.
const MOST: usize = 3000;
/// Longest text of a value.
const LONGEST: usize = 160;
/// Files within files.
const DEEPEST: usize = 8;

/// Parameters of the top, a table for each that is a file or a set; the others in the first table.
pub fn of(model: &Model, sources: &Sources, overrides: &[String]) -> Vec<(String, Rows)> {
    let mut tables = vec![("of the diagram".to_owned(), Vec::new())];
    for (name, node) in &model.ast.parameters {
        let mut list = List { sources, overrides, rows: Vec::new() };
        list.add(&name.text, node, model.ast.file, 0);
        if list.rows.len() == 1 {
            tables[0].1.append(&mut list.rows);
        } else if !list.rows.is_empty() {
            tables.push((name.text.clone(), list.rows));
        }
    }
    let head = ["name", "value", "note", "written in"].map(str::to_owned).to_vec();
    tables.retain(|(_, rows)| !rows.is_empty());
    tables.into_iter().map(|(name, rows)| (name, Rows { head: head.clone(), rows })).collect()
}

struct List<'a> {
    sources: &'a Sources<'a>,
    overrides: &'a [String],
    rows: Vec<Vec<String>>,
}

impl List<'_> {
    fn add(&mut self, name: &str, node: &Node, file: FileId, depth: usize) {
        if self.rows.len() >= MOST {
            return;
        }
        match &node.value {
            Shape::Tuple(Some(word), items) if word.text == "File" => {
                if let Some(set) = set_for(self.overrides, name) {
                    self.row(name, node, file, format!("{set} (set for this run)"), String::new());
                } else if let [Node { value: Shape::Text(path), .. }] = items.as_slice() {
                    self.file(name, node, path, file, depth);
                }
            }
            Shape::Struct(None, members) | Shape::Map(members) => match described(members) {
                Some((value, note)) => {
                    let text = self.text(value, file);
                    self.row(name, node, file, text, note);
                }
                None => members
                    .iter()
                    .for_each(|(own, inside)| self.add(&format!("{name}.{}", own.text), inside, file, depth)),
            },
            Shape::List(items) if items.iter().any(is_set) => {
                let text = format!("{} entries", items.len());
                self.row(name, node, file, text, String::new());
            }
            Shape::List(items) if items.len() > 12 => {
                let text = format!("{} values, from {}", items.len(), self.text(&items[0], file));
                self.row(name, node, file, text, String::new());
            }
            _ => {
                let text = self.text(node, file);
                self.row(name, node, file, text, String::new());
            }
        }
    }

    fn file(&mut self, name: &str, node: &Node, path: &str, file: FileId, depth: usize) {
        let whole = self.sources.folder(file).join(Path::new(path));
        let opened = if depth < DEEPEST { self.sources.open(&whole).ok() } else { None };
        let tree = opened.and_then(|id| Some((id, blocksim_syntax::read(&self.sources.file(id).text).ok()?)));
        match tree {
            Some((id, tree)) => self.add(name, &tree, id, depth + 1),
            None => self.row(name, node, file, path.to_owned(), String::new()),
        }
    }

    fn text(&self, node: &Node, file: FileId) -> String {
        one_line(self.sources.file(file).text.get(node.span.clone()).unwrap_or_default(), LONGEST)
    }

    fn row(&mut self, name: &str, node: &Node, file: FileId, value: String, note: String) {
        let value = match set_for(self.overrides, name) {
            Some(set) if !value.ends_with("(set for this run)") => {
                format!("{set} (set for this run; written: {value})")
            }
            _ => value,
        };
        let place = line(self.sources, &Place { file, span: node.span.clone() });
        self.rows.push(vec![name.to_owned(), value, note, place]);
    }
}

fn is_set(node: &Node) -> bool {
    matches!(node.value, Shape::Struct(..) | Shape::Map(_) | Shape::List(_))
}

/// Value and note of a described number.
fn described(members: &[(Name, Node)]) -> Option<(&Node, String)> {
    let (_, value) = members.iter().find(|(name, _)| name.text == "value")?;
    let notes = ["note", "source", "tolerance"].into_iter().filter_map(|wanted| {
        let (_, node) = members.iter().find(|(name, _)| name.text == wanted)?;
        let Shape::Text(text) = &node.value else { return None };
        Some(if wanted == "tolerance" { format!("± {text}") } else { text.clone() })
    });
    Some((value, notes.collect::<Vec<_>>().join(", ")))
}
