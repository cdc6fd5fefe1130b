//! Markdown pages as a static site: one folder that is opened from the disk or served by anything, with search, in light, dark and
//! in print. Knows nothing of blocks, diagrams and files.
//!
//! ```text
//! Page (Markdown, drawings) -markdown-> HTML and headings -page-> files of the site
//!                                                  -search-> index
//! ```
//!
//! Nothing on a page asks for anything outside of the site, and every link within it leads somewhere: [`Site::render`] lists
//! those that do not.

mod markdown;
mod page;
mod search;
mod slug;

use std::collections::BTreeMap;

pub use pulldown_cmark_escape::escape_html;

/// A page.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Page {
    /// Its path without ending: `language`, `blocks/Gain`.
    pub path: String,
    /// The group that it stands in: `Guides`.
    pub group: String,
    /// Its name in the list of pages; the first heading where it is empty.
    pub name: String,
    /// What stands on it, one below the other.
    pub parts: Vec<Part>,
}

/// A part of a page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Part {
    /// Text in Markdown, with formulas between dollar signs. HTML in it is shown as text.
    Markdown(String),
    /// Finished HTML, such as a drawing.
    Html(String),
}

/// A site.
#[derive(Debug, Clone, Default)]
pub struct Site {
    /// Name of the whole.
    pub title: String,
    /// Pages in the order of the list.
    pub pages: Vec<Page>,
    /// Pictures and the like by path, as they are.
    pub files: BTreeMap<String, Vec<u8>>,
    /// Declarations of style beside those of the site.
    pub style: String,
    /// Words that are links wherever they stand alone as code, such as names of kinds, with their pages.
    pub words: BTreeMap<String, String>,
}

/// A link that leads nowhere.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct DeadLink {
    /// The page that it stands on.
    pub page: String,
    /// What it names.
    pub target: String,
}

/// A site as files.
#[derive(Debug, Clone, Default)]
pub struct Rendered {
    /// Files by path.
    pub files: BTreeMap<String, Vec<u8>>,
    /// Links that lead nowhere.
    pub dead: Vec<DeadLink>,
    /// Formulas that could not be read, as they are written; they are shown so.
    pub formulas: Vec<String>,
}

impl Site {
    /// All files of the site.
    pub fn render(&self) -> Rendered {
        let mut rendered = Rendered { files: self.files.clone(), ..Rendered::default() };
        let texts: Vec<markdown::Text> = self.pages.iter().map(|page| markdown::text(page, self)).collect();
        let anchors: BTreeMap<&str, Vec<&str>> = self
            .pages
            .iter()
            .zip(&texts)
            .map(|(page, text)| {
                (page.path.as_str(), text.headings.iter().map(|h| h.anchor.as_str()).collect())
            })
            .collect();
        for (page, text) in self.pages.iter().zip(&texts) {
            for link in &text.links {
                if !self.leads(link, &anchors) {
                    rendered.dead.push(DeadLink { page: page.path.clone(), target: link.written.clone() });
                }
            }
            rendered.formulas.extend(text.formulas.iter().cloned());
            let html = page::page(self, page, text, &texts);
            rendered.files.insert(format!("{}.html", page.path), html.into_bytes());
        }
        let index = search::index(&self.pages, &texts);
        rendered.files.insert("search-index.js".to_owned(), index.into_bytes());
        rendered.files.insert("search.js".to_owned(), include_bytes!("../assets/search.js").to_vec());
        let style = format!("{}{}", include_str!("../assets/site.css"), self.style);
        rendered.files.insert("site.css".to_owned(), style.into_bytes());
        rendered
    }

    fn leads(&self, link: &markdown::Link, anchors: &BTreeMap<&str, Vec<&str>>) -> bool {
        match &link.page {
            None => link.file.as_ref().is_some_and(|file| self.files.contains_key(file)),
            Some(page) => anchors
                .get(page.as_str())
                .is_some_and(|known| link.anchor.is_empty() || known.contains(&link.anchor.as_str())),
        }
    }
}
