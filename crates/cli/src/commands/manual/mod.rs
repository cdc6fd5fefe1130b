//! `blocksim manual`: the guides of `docs/`, in the program.

#[cfg(feature = "site")]
mod site;

use blocksim_signal::closest;

use crate::args::manual::ManualArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::search::Query;
use crate::terminal::console::Console;
use crate::terminal::prose::prose;

include!(concat!(env!("OUT_DIR"), "/manual_pages.rs"));

/// A heading of a page with what stands below it, up to the next heading.
pub struct Section {
    pub page: &'static str,
    /// Number of signs `#`.
    level: usize,
    pub heading: &'static str,
    pub text: &'static str,
}

/// Prints a page, the sections of it that some words are about, or which pages there are.
///
/// # Errors
/// If there is no such page or section.
pub fn manual(args: &ManualArgs, console: Console) -> Outcome {
    if let Some(folder) = &args.site {
        return write_site(folder, args.yes, console);
    }
    let Some(name) = &args.page else {
        console.data(&list())?;
        return Ok(Exit::Done);
    };
    // People copy the names of files, too.
    let name = name.trim_start_matches("docs/").trim_end_matches(".md");
    let Some((page, text)) = MANUAL_PAGES.iter().find(|(page, _)| *page == name) else {
        return Err(unknown(name));
    };
    if args.section.is_empty() {
        console.data(&readable(text))?;
        return Ok(Exit::Done);
    }
    let words = args.section.join(" ");
    let found = chosen(&sections(page, text), &words);
    if found.is_empty() {
        let headings: Vec<String> =
            sections(page, text).iter().skip(1).map(|section| format!("`{}`", section.heading)).collect();
        let help = match headings.is_empty() {
            true => format!("`blocksim manual {page}` prints all of it"),
            false => format!("its sections are {}", headings.join(", ")),
        };
        return Err(Failure::usage(format!("no section of `{page}` is about `{words}`")).help(help));
    }
    console.data(&found.join("\n"))?;
    Ok(Exit::Done)
}

#[cfg(feature = "site")]
fn write_site(folder: &std::path::Path, replace: bool, console: Console) -> Outcome {
    site::write(folder, replace, console)
}

#[cfg(not(feature = "site"))]
fn write_site(_folder: &std::path::Path, _replace: bool, _console: Console) -> Outcome {
    Err(crate::left_out::failure("cannot write the manual as a site", "that part", "site"))
}

fn list() -> String {
    let pages = || MANUAL_PAGES.iter().filter(|(page, _)| !page.ends_with("README"));
    let width = pages().map(|(page, _)| page.len()).max().unwrap_or_default();
    let line = |(page, text): &(&'static str, &'static str)| {
        let title = sections(page, text).first().map_or("", |section| section.heading);
        format!("{page:width$}  {title}\n")
    };
    let lines: String = pages().map(line).collect();
    format!(
        "{lines}\n`blocksim manual PAGE` prints a page, `blocksim manual PAGE WORDS` the sections about some words,\n\
         `blocksim help WORDS` finds pages, commands, options and blocks, `blocksim explain` has a page for each error.\n"
    )
}

fn unknown(name: &str) -> Failure {
    let pages = || MANUAL_PAGES.iter().map(|(page, _)| *page);
    let help = match closest(name, pages()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => format!("`blocksim manual` lists all pages, `blocksim help {name}` finds what is about it"),
    };
    Failure::usage(format!("the manual has no page `{name}`")).help(help)
}

/// All sections of the manual.
pub fn all_sections() -> Vec<Section> {
    MANUAL_PAGES
        .iter()
        .filter(|(page, _)| !page.ends_with("README"))
        .flat_map(|(page, text)| sections(page, text))
        .collect()
}

/// The sections of a page; the first one has the title of the page as its heading.
fn sections(page: &'static str, text: &'static str) -> Vec<Section> {
    let mut starts = Vec::new();
    let (mut at, mut is_code) = (0, false);
    for line in text.split_inclusive('\n') {
        is_code ^= line.starts_with("```");
        let level = line.bytes().take_while(|byte| *byte == b'#').count();
        if !is_code && level > 0 && line[level..].starts_with(' ') {
            starts.push((at, at + line.len(), level, line[level..].trim()));
        }
        at += line.len();
    }
    let ends = starts.iter().skip(1).map(|(start, ..)| *start).chain([text.len()]);
    starts
        .iter()
        .zip(ends)
        .map(|((_, from, level, heading), end)| Section {
            page,
            level: *level,
            heading,
            text: &text[*from..end],
        })
        .collect()
}

/// The sections whose headings have these words, with those below them; if there are none, those whose texts have them.
fn chosen(all: &[Section], words: &str) -> Vec<String> {
    let query = Query::new(words);
    let by = |fits: &dyn Fn(&Section) -> bool| -> Vec<String> {
        let (mut found, mut above) = (Vec::new(), usize::MAX);
        for section in all {
            let is_below = section.level > above;
            if is_below || fits(section) {
                above = if is_below { above } else { section.level };
                let sign = "#".repeat(section.level);
                found.push(readable(&format!("{sign} {}\n{}", section.heading, section.text)));
            } else {
                above = usize::MAX;
            }
        }
        found
    };
    // The whole page hangs below its title.
    let headed = by(&|section| section.level > 1 && query.score(&[(section.heading, 1)]) > 0);
    if headed.is_empty() {
        by(&|section| section.level > 1 && query.score(&[(section.text, 1)]) > 0)
    } else {
        headed
    }
}

/// A page for the terminal: links to pages are named by the command that prints them, pictures are left out.
fn readable(markdown: &str) -> String {
    let parts = markdown.split("```").enumerate();
    let text: Vec<String> =
        parts.map(|(n, part)| if n % 2 == 0 { without_links(part) } else { part.to_owned() }).collect();
    prose(&text.join("```"))
}

fn without_links(text: &str) -> String {
    let (mut out, mut rest) = (String::new(), text);
    while let Some((start, middle, end)) = link(rest) {
        let (words, address) = (&rest[start + 1..middle], &rest[middle + 2..end]);
        let before = &rest[..start];
        let is_picture = before.ends_with('!');
        out += before.strip_suffix('!').unwrap_or(before);
        let file = address.split('#').next().unwrap_or_default().trim_end_matches(".md");
        if !is_picture {
            out += words;
            if file != words && MANUAL_PAGES.iter().any(|(page, _)| *page == file) {
                out += &format!(" (`blocksim manual {file}`)");
            } else if address.starts_with("http") {
                out += &format!(" <{address}>");
            }
        }
        rest = &rest[end + 1..];
    }
    out + rest
}

/// Where the next `[words](address)` begins, where `](` stands and where it ends.
fn link(text: &str) -> Option<(usize, usize, usize)> {
    let mut from = 0;
    while let Some(middle) = text[from..].find("](").map(|at| from + at) {
        let start = text[..middle].rfind('[');
        let end = text[middle..].find(')').map(|at| middle + at);
        if let (Some(start), Some(end)) = (start, end)
            && !text[middle + 2..end].contains(char::is_whitespace)
        {
            return Some((start, middle, end));
        }
        from = middle + 2;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "# Title\n\nFirst.\n\n## Units\n\nSI.\n\n```ron\n# no heading\n```\n\n### Angles\n\nPlain.\n\n## Names\n\nUnits too.\n";

    #[test]
    fn sections_are_found_by_heading_with_what_is_below_them() {
        let all = sections("page", PAGE);
        let headings: Vec<&str> = all.iter().map(|section| section.heading).collect();
        assert_eq!(headings, ["Title", "Units", "Angles", "Names"]);
        let units = chosen(&all, "unit");
        assert_eq!(units, ["## Units\n\nSI.\n\n    # no heading\n", "### Angles\n\nPlain.\n"]);
        assert_eq!(chosen(&all, "plain"), ["### Angles\n\nPlain.\n"]);
        assert!(chosen(&all, "voltage").is_empty());
    }

    #[test]
    fn links_name_the_command_that_prints_the_page() {
        assert_eq!(
            without_links(
                "See [the language](language.md#units), [language](language.md), [RON](https://a.b) and ![p](x.svg)[1]."
            ),
            "See the language (`blocksim manual language`), language, RON <https://a.b> and [1]."
        );
    }

    #[test]
    fn every_guide_of_the_project_is_in_the_program() {
        let names: Vec<&str> = MANUAL_PAGES.iter().map(|(page, _)| *page).collect();
        for name in ["README", "language", "start", "plugins", "irb2600"] {
            assert!(names.contains(&name), "{names:?}");
        }
        let listed = list();
        assert!(
            MANUAL_PAGES.iter().all(|(page, _)| page.ends_with("README") || listed.contains(page)),
            "{listed}"
        );
    }
}
