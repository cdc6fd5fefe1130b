//! What stands in the page: sections, texts and tables; scripts fill in the rest.

use crate::assets::VENDORED;
use crate::data::{PlanePicture, Report, Rows};
use crate::escape::escape;

/// Events that are listed.
const EVENTS: usize = 200;

/// The content of the page; `thinned` says whether values were left away.
pub fn body(report: &Report, thinned: bool) -> String {
    let mut out = String::new();
    let sections = [
        ("summary", "Summary", true),
        ("space", "3D", report.animation.is_some()),
        ("scopes", "Scopes", !report.panels.is_empty()),
        ("planes", "Planes", !report.planes.is_empty()),
        ("diagram", "Diagram", !report.diagram.levels.is_empty()),
        ("compared", "Compared", report.compared.is_some()),
        ("numbers", "Tracking", !report.metrics.rows.is_empty()),
        ("parameters", "Parameters", !report.parameters.rows.is_empty() || !report.tables.is_empty()),
        ("events", "Events", !report.events.is_empty()),
    ];
    out.push_str("<a class=\"skip\" href=\"#summary\">To the content</a>\n<header class=\"bar\"><strong class=\"brand\">blocksim</strong><nav aria-label=\"Sections\">");
    for (id, name, _) in sections.iter().filter(|section| section.2) {
        out.push_str(&format!("<a href=\"#{id}\">{name}</a>"));
    }
    out.push_str(
        "</nav><span class=\"tools\"><button id=\"find\" hidden title=\"Find a block, a signal, a parameter (/)\">Find</button><button id=\"theme\" title=\"Light or dark (D)\">Theme</button>\
         <button id=\"help\" title=\"All keys (?)\">Keys</button></span></header>\n<main>\n",
    );
    out.push_str(&format!("<section id=\"summary\"><h1>{}</h1>\n", escape(&report.title)));
    for warning in &report.warnings {
        out.push_str(&format!("<p class=\"warning\"><b>Warning.</b> {}</p>\n", escape(warning)));
    }
    out.push_str("<dl class=\"facts\">");
    for (name, value) in &report.facts {
        // Paths are best broken behind their folders.
        let value = escape(value).replace('/', "/<wbr>");
        out.push_str(&format!("<div><dt>{}</dt><dd>{value}</dd></div>", escape(name)));
    }
    out.push_str("</dl></section>\n");
    out.push_str("<noscript><p class=\"warning\">Scopes and movement need JavaScript.</p></noscript>\n");
    out.push_str("<div id=\"trouble\" role=\"alert\"></div>\n");
    if report.animation.is_some() {
        out.push_str("<section id=\"space\"><h2>3D</h2><div id=\"space-view\"></div></section>\n");
    }
    if report.has_no_scopes {
        // Nobody misses them.
    } else if report.panels.is_empty() {
        out.push_str("<p class=\"note\">The run has no signals to show.</p>\n");
    } else {
        out.push_str("<section id=\"scopes\"><h2>Scopes</h2>\n");
        let note = if thinned {
            "Thinned to what a screen shows; no peak is lost. <code>blocksim report RUN --full</code> keeps all values."
        } else {
            "All recorded values."
        };
        out.push_str(&format!("<p class=\"note screen\">{note} Drag to zoom, double click for all, drag with Shift to move.</p>\n"));
        out.push_str("<div id=\"overlay-bar\"></div><div id=\"plots\"></div></section>\n");
    }
    if !report.planes.is_empty() {
        out.push_str("<section id=\"planes\"><h2>One signal over another</h2>\n");
        for PlanePicture { title, light, dark } in &report.planes {
            out.push_str(&format!(
                "<figure class=\"plane\"><figcaption>{}</figcaption><div class=\"on-light\">{light}</div><div class=\"on-dark\">{dark}</div></figure>\n",
                escape(title)
            ));
        }
        out.push_str("</section>\n");
    }
    if !report.diagram.levels.is_empty() {
        out.push_str("<section id=\"diagram\"><h2>Diagram</h2>\n");
        if !report.diagram.note.is_empty() {
            out.push_str(&format!("<p class=\"note\">{}</p>\n", escape(&report.diagram.note)));
        }
        out.push_str("<div id=\"diagram-view\"></div></section>\n");
    }
    let section = |id: &str, title: &str, rows: &Rows| {
        if rows.rows.is_empty() {
            return String::new();
        }
        format!("<section id=\"{id}\"><h2>{title}</h2>{}</section>\n", table(rows))
    };
    if let Some(other) = &report.compared {
        out.push_str(&format!(
            "<section id=\"compared\"><h2>Compared with {}</h2><p>{}</p>{}</section>\n",
            escape(&other.name),
            escape(&other.summary),
            table(&other.rows)
        ));
    }
    out.push_str(&section("numbers", "Tracking", &report.metrics));
    if !report.parameters.rows.is_empty() || !report.tables.is_empty() {
        out.push_str("<section id=\"parameters\"><h2>Parameters</h2>");
        if report.parameters.rows.is_empty() {
            out.push_str(
                "<p class=\"note\">Nothing was set for this run: all parameters are those of the files.</p>",
            );
        } else {
            out.push_str(&table(&report.parameters));
        }
        out.push_str("<div id=\"tables\"></div></section>\n");
    }
    let listed = report.events.iter().take(EVENTS);
    let rows = listed.map(|event| vec![format!("{:.6}", event.time), event.path.clone(), event.what.clone()]);
    let events =
        Rows { head: ["time [s]", "block", "event"].map(str::to_owned).to_vec(), rows: rows.collect() };
    out.push_str(&section("events", "Events", &events));
    if report.events.len() > EVENTS {
        out.push_str(&format!(
            "<p class=\"note\">{} more events are in events.csv.</p>\n",
            report.events.len() - EVENTS
        ));
    }
    out.push_str(&licences());
    out.push_str("</main>\n<footer id=\"timeline\"></footer>\n<dialog id=\"keys\" aria-label=\"Keys\"></dialog>\n<div id=\"announcement\" class=\"unseen\" aria-live=\"polite\"></div>\n");
    out
}

/// The terms of what the page contains of other projects, which must go with every copy.
fn licences() -> String {
    let texts = VENDORED.iter().filter(|vendored| vendored.file.ends_with(".LICENSE"));
    let texts: String = texts
        .map(|vendored| {
            let name = vendored.file.trim_end_matches(".LICENSE");
            format!("<h3>{}</h3><pre>{}</pre>\n", escape(name), escape(vendored.text.trim()))
        })
        .collect();
    format!(
        "<details id=\"licences\"><summary>Licences</summary>\n<p class=\"note\">Made by blocksim, which may be used under MIT or \
         Apache-2.0. The page contains scripts of others:</p>\n{texts}</details>\n"
    )
}

fn table(rows: &Rows) -> String {
    let mut out = String::from("<div class=\"wide\"><table><thead><tr>");
    let is_number = |cell: &str| cell.starts_with(|c: char| c.is_ascii_digit() || "-−–".contains(c));
    for (column, head) in rows.head.iter().enumerate() {
        let numbers =
            column > 0 && rows.rows.iter().all(|row| row.get(column).is_some_and(|cell| is_number(cell)));
        let class = if numbers { " class=\"n\"" } else { "" };
        out.push_str(&format!("<th scope=\"col\"{class}>{}</th>", escape(head)));
    }
    out.push_str("</tr></thead><tbody>");
    for row in &rows.rows {
        out.push_str("<tr>");
        for (column, cell) in row.iter().enumerate() {
            let number = column > 0 && is_number(cell);
            out.push_str(&format!("<td{}>{}</td>", if number { " class=\"n\"" } else { "" }, escape(cell)));
        }
        out.push_str("</tr>");
    }
    out.push_str("</tbody></table></div>");
    out
}
