//! Markdown as HTML with links of the site, anchors and formulas.

use pulldown_cmark::{BrokenLink, CodeBlockKind, CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd};
use pulldown_cmark_escape::escape_html;
use pulldown_latex::{RenderConfig, Storage, config::DisplayMode, push_mathml};

use crate::slug::Slugs;
use crate::{Page, Part, Site};

/// A page as HTML, and what is known of it.
#[derive(Debug, Clone, Default)]
pub struct Text {
    pub html: String,
    pub headings: Vec<Heading>,
    pub links: Vec<Link>,
    pub formulas: Vec<String>,
}

/// A heading with the plain text below it.
#[derive(Debug, Clone, Default)]
pub struct Heading {
    pub level: usize,
    pub text: String,
    pub anchor: String,
    pub below: String,
}

/// A link within the site.
#[derive(Debug, Clone, Default)]
pub struct Link {
    /// As it stands in the text.
    pub written: String,
    /// The page that is meant.
    pub page: Option<String>,
    pub anchor: String,
    /// The file that is meant, where it is no page.
    pub file: Option<String>,
}

/// The title of a page: its first heading of the first level.
pub fn title(text: &Text) -> &str {
    text.headings.first().map_or("", |heading| heading.text.as_str())
}

/// A page as HTML.
pub fn text(page: &Page, site: &Site) -> Text {
    let mut reader =
        Reader { page, site, out: Text::default(), slugs: Slugs::default(), code: None, heading: None };
    for part in &page.parts {
        match part {
            Part::Html(html) => {
                reader.out.html.push_str(html);
                reader.out.html.push('\n');
            }
            Part::Markdown(markdown) => reader.markdown(markdown),
        }
    }
    reader.out
}

struct Reader<'a> {
    page: &'a Page,
    site: &'a Site,
    out: Text,
    slugs: Slugs,
    /// The language of the code block at hand.
    code: Option<String>,
    /// The heading at hand: its text so far.
    heading: Option<String>,
}

impl<'a> Reader<'a> {
    fn markdown(&mut self, markdown: &str) {
        let options = Options::ENABLE_TABLES | Options::ENABLE_MATH | Options::ENABLE_STRIKETHROUGH;
        let words = &self.site.words;
        // A name in brackets alone, `[Gain]`, is a link where there is a page of it.
        let broken = |link: BrokenLink<'_>| {
            let word = link.reference.trim_matches('`').to_owned();
            words.get(&word).map(|page| (CowStr::from(format!("{WORD}{page}")), CowStr::from(String::new())))
        };
        let markdown = plain_stars(markdown);
        let parser = Parser::new_with_broken_link_callback(&markdown, options, Some(broken));
        let mut events: Vec<Event> = Vec::new();
        // Whether each open link is one, or was left out because nothing is there.
        let mut open: Vec<bool> = Vec::new();
        for event in parser {
            match event {
                Event::Start(Tag::Heading { level, .. }) => {
                    self.flush(&mut events);
                    self.heading = Some(String::new());
                    self.out.headings.push(Heading { level: level as usize, ..Heading::default() });
                }
                Event::End(TagEnd::Heading(level)) => self.end_heading(level, &mut events),
                Event::Start(Tag::CodeBlock(kind)) => {
                    self.flush(&mut events);
                    let language = match &kind {
                        CodeBlockKind::Fenced(language) => language.to_string(),
                        CodeBlockKind::Indented => String::new(),
                    };
                    self.code = Some(language);
                }
                Event::End(TagEnd::CodeBlock) => self.code = None,
                Event::Text(text) if self.code.is_some() => {
                    let language = self.code.clone().unwrap_or_default();
                    self.words(&text);
                    self.code_block(&language, &text);
                }
                Event::Start(Tag::Table(alignments)) => {
                    events.push(Event::Html("<div class=\"table\">".into()));
                    events.push(Event::Start(Tag::Table(alignments)));
                }
                Event::End(TagEnd::Table) => {
                    events.push(Event::End(TagEnd::Table));
                    events.push(Event::Html("</div>\n".into()));
                }
                Event::Start(Tag::Link { link_type, dest_url, title, id }) => match self.target(&dest_url) {
                    Some(target) => {
                        open.push(true);
                        let dest_url = target.into();
                        events.push(Event::Start(Tag::Link { link_type, dest_url, title, id }));
                    }
                    None => open.push(false),
                },
                Event::End(TagEnd::Link) => {
                    if open.pop().unwrap_or_default() {
                        events.push(Event::End(TagEnd::Link));
                    }
                }
                Event::Start(Tag::Image { link_type, dest_url, title, id }) => {
                    let dest_url = self.target(&dest_url).unwrap_or_default().into();
                    events.push(Event::Start(Tag::Image { link_type, dest_url, title, id }));
                }
                Event::InlineMath(formula) => {
                    self.words(&formula);
                    events.push(Event::InlineHtml(self.formula(&formula, DisplayMode::Inline).into()));
                }
                Event::DisplayMath(formula) => {
                    self.words(&formula);
                    events.push(Event::InlineHtml(self.formula(&formula, DisplayMode::Block).into()));
                }
                // HTML of a text is text.
                Event::Html(html) | Event::InlineHtml(html) => events.push(Event::Text(html)),
                Event::Text(text) => {
                    self.words(&text);
                    events.push(Event::Text(text));
                }
                Event::Code(code) => {
                    self.words(&code);
                    let page = words.get(&*code).filter(|page| open.is_empty() && **page != self.page.path);
                    match page.and_then(|page| self.target(&format!("{WORD}{page}"))) {
                        Some(target) if self.heading.is_none() => {
                            let link = format!("<a href=\"{target}\"><code>{}</code></a>", escaped(&code));
                            events.push(Event::InlineHtml(link.into()));
                        }
                        _ => events.push(Event::Code(code)),
                    }
                }
                Event::SoftBreak => {
                    self.words(" ");
                    events.push(Event::SoftBreak);
                }
                other => {
                    if matches!(other, Event::End(TagEnd::Paragraph | TagEnd::Item | TagEnd::TableCell)) {
                        self.words(" ");
                    }
                    events.push(other);
                }
            }
        }
        self.flush(&mut events);
    }

    fn flush(&mut self, events: &mut Vec<Event>) {
        pulldown_cmark::html::push_html(&mut self.out.html, events.drain(..));
    }

    /// Plain text of a heading, or below one.
    fn words(&mut self, text: &str) {
        if let Some(heading) = &mut self.heading {
            heading.push_str(text);
        } else if let Some(last) = self.out.headings.last_mut() {
            last.below.push_str(text);
        }
    }

    fn end_heading(&mut self, level: HeadingLevel, events: &mut Vec<Event>) {
        let text = self.heading.take().unwrap_or_default();
        let anchor = self.slugs.of(&text);
        let mut inner = String::new();
        pulldown_cmark::html::push_html(&mut inner, events.drain(..));
        let sign =
            format!("<a class=\"anchor\" href=\"#{anchor}\" aria-label=\"Link to this section\">#</a>");
        let sign = if level == HeadingLevel::H1 { String::new() } else { sign };
        self.out.html.push_str(&format!("<{level} id=\"{anchor}\">{inner}{sign}</{level}>\n"));
        if let Some(last) = self.out.headings.last_mut() {
            (last.text, last.anchor) = (text, anchor);
        }
    }

    fn code_block(&mut self, language: &str, code: &str) {
        let mut name = String::new();
        let _ = escape_html(&mut name, language);
        let body = if language == "ron" { coloured(code) } else { escaped(code) };
        let class = if name.is_empty() { String::new() } else { format!(" class=\"language-{name}\"") };
        self.out.html.push_str(&format!("<pre tabindex=\"0\"><code{class}>{body}</code></pre>\n"));
    }

    /// A formula in MathML; as it is written where it cannot be read.
    fn formula(&mut self, formula: &str, display_mode: DisplayMode) -> String {
        let storage = Storage::new();
        let braced = braced(formula);
        let events: Vec<_> = pulldown_latex::Parser::new(&braced, &storage).collect();
        let mut html = String::new();
        let config = RenderConfig { display_mode, ..RenderConfig::default() };
        if events.iter().all(Result::is_ok) && push_mathml(&mut html, events.into_iter(), config).is_ok() {
            return html;
        }
        self.out.formulas.push(formula.to_owned());
        format!("<code>{}</code>", escaped(formula))
    }

    /// Where a link leads on the site; nothing for files that are not on it.
    fn target(&mut self, written: &str) -> Option<String> {
        if written.is_empty() {
            return None;
        }
        if ["http://", "https://", "mailto:"].iter().any(|outside| written.starts_with(outside)) {
            return Some(written.to_owned());
        }
        let up = "../".repeat(self.page.path.matches('/').count());
        let (path, anchor) = written.split_once('#').unwrap_or((written, ""));
        let anchored = |page: &str| {
            let sign = if anchor.is_empty() { "" } else { "#" };
            format!("{up}{page}.html{sign}{anchor}")
        };
        let mut link = Link { written: written.to_owned(), anchor: anchor.to_owned(), ..Link::default() };
        if let Some(word) = path.strip_prefix(WORD) {
            link.page = Some(word.to_owned());
            self.out.links.push(link);
            return Some(anchored(word));
        }
        let full = match path {
            "" => self.page.path.clone(),
            path => joined(&self.page.path, path)?,
        };
        let page = full.trim_end_matches('/').trim_end_matches(".md");
        // A folder is its first page.
        let known = |path: &str| self.site.pages.iter().any(|page| page.path == path);
        let names = [page.to_owned(), format!("{page}/index"), page.replace("README", "index")];
        if let Some(page) = names.into_iter().find(|name| known(name)) {
            let target = anchored(&page);
            link.page = Some(page);
            self.out.links.push(link);
            return Some(target);
        }
        link.file = Some(full.clone());
        self.out.links.push(link);
        Some(format!("{up}{full}"))
    }
}

/// A text in which a star between two letters or digits is a sign of multiplication, as in `N*m`, and not the begin of something
/// emphasised. Code and formulas stay as they are.
fn plain_stars(markdown: &str) -> String {
    let mut out = String::with_capacity(markdown.len());
    let (mut fence, mut code, mut formula) = (false, false, false);
    for line in markdown.split_inclusive('\n') {
        if line.trim_start().starts_with("```") {
            fence = !fence;
            out.push_str(line);
            continue;
        }
        let mut before = ' ';
        let mut signs = line.chars().peekable();
        while let Some(sign) = signs.next() {
            match sign {
                '`' if !fence => code = !code,
                '$' if !fence && !code => formula = !formula,
                '*' if !(fence || code || formula)
                    && before.is_alphanumeric()
                    && signs.peek().is_some_and(|next| next.is_alphanumeric()) =>
                {
                    out.push('\\');
                }
                _ => {}
            }
            out.push(sign);
            before = sign;
        }
    }
    out
}

/// A formula in which fractions of two digits, `\frac12`, have braces, as the parser of formulas wants them.
fn braced(formula: &str) -> String {
    let mut out = String::with_capacity(formula.len());
    let mut rest = formula;
    while let Some(at) = rest.find("frac") {
        let (before, after) = rest.split_at(at + "frac".len());
        out.push_str(before);
        rest = after;
        let mut digits = rest.chars();
        if let (Some(above @ '0'..='9'), Some(below @ '0'..='9')) = (digits.next(), digits.next()) {
            out.push_str(&format!("{{{above}}}{{{below}}}"));
            rest = digits.as_str();
        }
    }
    out + rest
}

/// What stands before the page of a word in brackets.
const WORD: &str = "word:";

/// A path relative to the folder of a page, from the top of the site; nothing where it leads out of it.
fn joined(page: &str, path: &str) -> Option<String> {
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in path.split('/') {
        match part {
            "." => {}
            ".." => drop(parts.pop()?),
            part => parts.push(part),
        }
    }
    Some(parts.join("/"))
}

/// A text as content of HTML.
pub fn escaped(text: &str) -> String {
    let mut out = String::new();
    // A string takes everything.
    let _ = escape_html(&mut out, text);
    out
}

/// A diagram with comments, texts, kinds and numbers marked.
fn coloured(code: &str) -> String {
    let mut out = String::new();
    let mut rest = code;
    while let Some(sign) = rest.chars().next() {
        let (length, class) = match sign {
            '/' if rest.starts_with("//") => (rest.find('\n').unwrap_or(rest.len()), "c"),
            '"' => {
                let end = rest[1..].find(['"', '\n']).map_or(rest.len(), |end| end + 2);
                let is_key = rest[end..].trim_start().starts_with(':');
                (end, if is_key { "k" } else { "s" })
            }
            _ if sign.is_ascii_digit() => {
                (rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '.').unwrap_or(rest.len()), "n")
            }
            _ if sign.is_alphabetic() || sign == '_' => {
                let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
                (end, if sign.is_uppercase() { "t" } else { "" })
            }
            _ => (sign.len_utf8(), ""),
        };
        let (piece, after) = rest.split_at(length);
        match class {
            "" => out.push_str(&escaped(piece)),
            class => out.push_str(&format!("<span class=\"{class}\">{}</span>", escaped(piece))),
        }
        rest = after;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn read(path: &str, markdown: &str) -> Text {
        let page = |path: &str| Page { path: path.to_owned(), ..Page::default() };
        let site = Site {
            pages: vec![page("index"), page("guide"), page("errors/index"), page("blocks/Gain")],
            words: BTreeMap::from([("Gain".to_owned(), "blocks/Gain".to_owned())]),
            ..Site::default()
        };
        text(&Page { parts: vec![Part::Markdown(markdown.to_owned())], ..page(path) }, &site)
    }

    #[test]
    fn links_lead_to_pages_of_the_site_from_any_folder() {
        for (path, written, html) in [
            ("index", "[g](guide.md#a-b)", "<a href=\"guide.html#a-b\">g</a>"),
            ("blocks/Gain", "[g](../guide.md)", "<a href=\"../guide.html\">g</a>"),
            ("index", "[e](errors)", "<a href=\"errors/index.html\">e</a>"),
            ("guide", "[`Gain`]", "<a href=\"blocks/Gain.html\"><code>Gain</code></a>"),
            ("guide", "[`Loss`] [s]", "[<code>Loss</code>] [s]"),
            ("guide", "N*m*s and V*s, *so*, `a*b`", "N*m*s and V*s, <em>so</em>, <code>a*b</code>"),
            ("guide", "`Gain` x", "<a href=\"blocks/Gain.html\"><code>Gain</code></a> x"),
            ("blocks/Gain", "`Gain` x", "<code>Gain</code> x"),
            ("guide", "[here](#x)", "<a href=\"guide.html#x\">here</a>"),
            ("guide", "[out](../crates/a.md)", "out"),
            ("guide", "[w](https://a.b)", "<a href=\"https://a.b\">w</a>"),
        ] {
            assert_eq!(read(path, written).html, format!("<p>{html}</p>\n"), "{written}");
        }
    }

    #[test]
    fn html_of_a_text_is_text_and_formulas_are_mathml() {
        let text = read(
            "guide",
            "# A\n\nA <script>alert(1)</script> and $k_p e$\n\n```ron\nGain(k: \"<b>\") // x\n```\n",
        );
        assert!(!text.html.contains("<script"), "{}", text.html);
        assert!(text.html.contains("<math") && text.formulas.is_empty(), "{}", text.html);
        assert!(
            text.html.contains("<span class=\"t\">Gain</span>(k: <span class=\"s\">\"&lt;b&gt;\"</span>)")
                || text.html.contains("&quot;&lt;b&gt;&quot;"),
            "{}",
            text.html
        );
        assert!(text.headings[0].below.contains("alert") && text.headings[0].anchor == "a");
        assert_eq!(read("guide", "$\\frac{a}$").formulas, ["\\frac{a}"]);
        assert!(read("guide", "$\\tfrac23 x + \\frac12$").formulas.is_empty());
    }
}
