//! The frame of a page: list of pages, search, contents.

use crate::markdown::{Text, escaped, title};
use crate::{Page, Site};

/// A page as a document.
pub fn page(site: &Site, page: &Page, text: &Text, all: &[Text]) -> String {
    let up = "../".repeat(page.path.matches('/').count());
    let name = escaped(name(page, text));
    let site_title = escaped(&site.title);
    let list = list(site, page, all, &up);
    let contents = contents(text);
    format!(
        r##"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="blocksim manual">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; script-src 'self'">
<title>{name} – {site_title}</title>
<link rel="stylesheet" href="{up}site.css">
<script src="{up}search.js" data-top="{up}" defer></script>
</head>
<body>
<a class="skip" href="#content">To the text</a>
<header>
<a class="home" href="{up}index.html">{site_title}</a>
<div class="find"><input id="find" type="search" placeholder="Search" aria-label="Search the manual" aria-controls="found" autocomplete="off" disabled>
<ol id="found" hidden></ol></div>
<button id="theme" type="button" title="Light or dark" aria-label="Light or dark" disabled>◐</button>
</header>
<div class="body">
<nav class="pages" aria-label="Pages"><details class="menu"><summary>Pages</summary>
{list}</details></nav>
<main id="content">
{}
</main>
{contents}</div>
</body>
</html>
"##,
        text.html
    )
}

fn name<'a>(page: &'a Page, text: &'a Text) -> &'a str {
    if page.name.is_empty() { title(text) } else { &page.name }
}

/// All pages below the names of their groups; the group at hand is open.
fn list(site: &Site, page: &Page, all: &[Text], up: &str) -> String {
    let mut out = String::new();
    let mut groups: Vec<&str> = Vec::new();
    for other in &site.pages {
        if !groups.contains(&other.group.as_str()) {
            groups.push(&other.group);
        }
    }
    for group in groups {
        let open = if group == page.group { " open" } else { "" };
        out.push_str(&format!("<details class=\"group\"{open}><summary>{}</summary><ul>\n", escaped(group)));
        for (other, text) in site.pages.iter().zip(all).filter(|(other, _)| other.group == group) {
            let here = if other.path == page.path { " aria-current=\"page\"" } else { "" };
            let name = escaped(name(other, text));
            out.push_str(&format!("<li><a href=\"{up}{}.html\"{here}>{name}</a></li>\n", other.path));
        }
        out.push_str("</ul></details>\n");
    }
    out
}

/// The headings of a page, where there are several.
fn contents(text: &Text) -> String {
    let below: Vec<_> = text.headings.iter().filter(|heading| matches!(heading.level, 2 | 3)).collect();
    if below.len() < 2 {
        return String::new();
    }
    let entry = |heading: &&crate::markdown::Heading| {
        let (level, anchor, name) = (heading.level, &heading.anchor, escaped(&heading.text));
        format!("<li class=\"level{level}\"><a href=\"#{anchor}\">{name}</a></li>\n")
    };
    let entries: String = below.iter().map(entry).collect();
    format!("<aside aria-label=\"On this page\"><p>On this page</p><ul>\n{entries}</ul></aside>\n")
}
