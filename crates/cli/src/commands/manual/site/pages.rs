//! Guides, tutorials and pages about errors, as they are in the program.

use blocksim_site::{Page, Part};

use super::super::{MANUAL_PAGES, sections};
use crate::commands::explain::error_pages;
use crate::terminal::prose::first_sentence;

/// Guides and tutorials: the first page, then in the order in which that lists them.
pub fn guides() -> Vec<Page> {
    let text = |name: &str| MANUAL_PAGES.iter().find(|(page, _)| *page == name).map_or("", |(_, text)| *text);
    let mut names = vec!["README"];
    names.extend(listed(text("README")));
    names.push("tutorials/README");
    names.extend(listed(text("tutorials/README")));
    let rest = MANUAL_PAGES.iter().map(|(name, _)| *name);
    let mut pages: Vec<Page> = Vec::new();
    for name in names.into_iter().chain(rest) {
        let path = name.replace("README", "index");
        let found = MANUAL_PAGES.iter().find(|(page, _)| *page == name);
        if let (Some((_, text)), false) = (found, pages.iter().any(|page| page.path == path)) {
            let group = if name.starts_with("tutorials/") { "Tutorials" } else { "Guides" };
            let parts = vec![Part::Markdown((*text).to_owned())];
            pages.push(Page { path, group: group.to_owned(), name: String::new(), parts });
        }
    }
    pages.sort_by_key(|page| page.group == "Tutorials");
    pages
}

/// The pages that a list of pages links to, in its order.
fn listed(text: &'static str) -> Vec<&'static str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let names = targets.filter_map(|target| target.split('#').next()?.strip_suffix(".md"));
    let known = |name: &str| {
        MANUAL_PAGES.iter().find(|(page, _)| *page == name || *page == format!("tutorials/{name}"))
    };
    names.filter_map(|name| known(name).map(|(page, _)| *page)).collect()
}

/// A page for each error, and the list of them.
pub fn errors() -> Vec<Page> {
    let group = "Errors".to_owned();
    let mut list = "# Errors\n\nA page for each code that stands in brackets behind `error` or `warning`. `blocksim explain CODE` prints it.\n\n| code | |\n|---|---|\n".to_owned();
    let mut pages = Vec::new();
    for (code, text) in error_pages() {
        let body = sections(code, text).first().map_or("", |section| section.text);
        list.push_str(&format!("| [`{code}`]({code}.md) | {} |\n", first_sentence(body).replace('|', "\\|")));
        let parts = vec![Part::Markdown(text.to_owned())];
        pages.push(Page {
            path: format!("errors/{code}"),
            group: group.clone(),
            name: code.to_owned(),
            parts,
        });
    }
    let overview = Page {
        path: "errors/index".to_owned(),
        group,
        name: "All errors".to_owned(),
        parts: vec![Part::Markdown(list)],
    };
    std::iter::once(overview).chain(pages).collect()
}
