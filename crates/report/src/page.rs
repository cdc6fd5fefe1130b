//! The page.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::assets::{DIAGRAM, MAIN, SCRIPTS, SPACE, STYLES};
use crate::data::{Animation, Contact, Panel, Report, Role, Rows, Series};
use crate::escape::{escape, json as safe_json};
use crate::pack::{Pack, compressed};
use crate::{BUDGET, diagram, thin, unseen};

/// Stretches of time that each picture is thinned to at first; fewer where the page would be too large.
const COLUMNS: usize = 1200;
/// Fewer are never made.
const FEWEST: usize = 75;
/// Stretches of time for each point of a signal that no picture shows.
const COARSER: usize = 4;
/// Instants of the movement.
const FRAMES: usize = 1200;
/// Share of its range that the mean of a signal may be off before the page says so.
const ROUGH: f64 = 0.005;
/// Events that are listed.
const EVENTS: usize = 200;

/// The page of a run. Its size stays within [`BUDGET`] bytes unless `full` is asked for, drawings and texts alone are
/// larger, or there are very many pictures.
pub fn html(report: &Report) -> String {
    let mut columns = COLUMNS;
    let has_texts =
        !report.diagram.levels.is_empty() || !report.tables.is_empty() || !report.unseen.is_empty();
    let texts =
        if has_texts { compressed(diagram::texts(report).to_string().as_bytes()) } else { String::new() };
    loop {
        let page = with_columns(report, columns, &texts);
        if report.full || page.len() <= BUDGET || columns <= FEWEST {
            return page;
        }
        columns /= 2;
    }
}

fn with_columns(report: &Report, columns: usize, texts: &str) -> String {
    let mut pack = Pack::default();
    let panels: Vec<Value> =
        report.panels.iter().map(|panel| picture(panel, report.full, columns, &mut pack)).collect();
    let thinned = !report.full && report.panels.iter().any(|panel| panel.time.len() > columns);
    let most = (!report.full).then_some(columns / COARSER);
    let unseen = unseen::courses(&report.unseen, most, &mut pack);
    let space = report.animation.as_ref().map(|animation| movement(animation, &mut pack));
    let overlays: Vec<Value> = report
        .overlays
        .iter()
        .map(|overlay| {
            let columns: Vec<Value> = overlay
                .columns
                .iter()
                .map(|(name, unit, values)| json!({ "name": name, "unit": unit, "values": pack.narrow(values) }))
                .collect();
            json!({ "name": overlay.name, "time": pack.wide(&overlay.time), "columns": columns })
        })
        .collect();
    let compared = report.compared.as_ref().map(|other| json!({ "name": other.name, "marks": other.marks }));
    let data = json!({
        "v": 1, "panels": panels, "space": space, "overlays": overlays, "thinned": thinned, "compared": compared,
        "unseen": unseen,
    });
    let scripts: Vec<&str> = SCRIPTS
        .into_iter()
        .chain(SPACE.into_iter().filter(|_| report.animation.is_some()))
        .chain(DIAGRAM.into_iter().filter(|_| !texts.is_empty()))
        .chain([MAIN])
        .collect();
    let hashes: Vec<String> = scripts
        .iter()
        .map(|script| format!("'sha256-{}'", STANDARD.encode(Sha256::digest(script))))
        .collect();
    let mut page = String::new();
    page.push_str("<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    page.push_str(&format!(
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src {}; style-src \
         'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'\">\n",
        hashes.join(" ")
    ));
    page.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    page.push_str("<meta name=\"color-scheme\" content=\"light dark\">\n");
    page.push_str(&format!("<title>{}</title>\n", escape(&report.title)));
    for style in STYLES {
        page.push_str(&format!("<style>\n{style}</style>\n"));
    }
    if !report.diagram.style.is_empty() {
        page.push_str(&format!("<style>\n{}</style>\n", report.diagram.style.replace('<', "")));
    }
    page.push_str("</head>\n<body>\n");
    page.push_str(&body(report, thinned));
    page.push_str(&format!(
        "<script type=\"application/json\" id=\"report-data\">{}</script>\n",
        safe_json(&data)
    ));
    page.push_str(&format!("<script type=\"text/plain\" id=\"report-numbers\">{}</script>\n", pack.finish()));
    if !texts.is_empty() {
        page.push_str(&format!("<script type=\"text/plain\" id=\"report-texts\">{texts}</script>\n"));
    }
    for script in scripts {
        page.push_str(&format!("<script>{script}</script>\n"));
    }
    page.push_str("</body>\n</html>\n");
    page
}

/// Data of a picture. Where there are a set and an actual value, the difference is kept instead of the actual value:
/// so it keeps all its digits.
fn picture(panel: &Panel, full: bool, columns: usize, pack: &mut Pack) -> Value {
    let own = panel.series.iter().map(|series| series.values.as_slice());
    let others = panel.series.iter().filter_map(|series| series.other.as_deref());
    let signals: Vec<&[f64]> = own.chain(others).collect();
    let rows: Vec<usize> =
        if full { (0..panel.time.len()).collect() } else { thin::rows(&panel.time, &signals, columns) };
    let pick = |values: &[f64]| rows.iter().map(|&row| values[row]).collect::<Vec<f64>>();
    let find = |role: Role| panel.series.iter().position(|series| series.role == role);
    let pair = find(Role::Set).zip(find(Role::Actual));
    let series: Vec<Value> = panel
        .series
        .iter()
        .enumerate()
        .map(|(at, series)| {
            let role = match series.role {
                Role::Plain => "plain",
                Role::Set => "set",
                Role::Actual => "actual",
            };
            let mut entry =
                json!({ "name": series.name, "path": series.path, "role": role, "held": series.held });
            match pair {
                Some((set, actual)) if actual == at => {
                    let off = panel.series[set].values.iter().zip(&series.values).map(|(s, a)| s - a);
                    entry["error"] = pack.narrow(&pick(&off.collect::<Vec<f64>>()));
                }
                _ => entry["values"] = pack.narrow(&pick(&series.values)),
            }
            if is_rough(panel, series, &rows) {
                entry["rough"] = true.into();
            }
            if let Some(other) = &series.other {
                entry["other"] = pack.narrow(&pick(other));
            }
            entry
        })
        .collect();
    json!({
        "group": panel.group, "title": panel.title, "unit": panel.unit,
        "pair": pair.map(|(set, actual)| [set, actual]),
        "time": pack.wide(&pick(&panel.time)), "series": series,
    })
}

/// Whether mean or root mean square of the rows that are kept tell little of those of all.
fn is_rough(panel: &Panel, series: &Series, rows: &[usize]) -> bool {
    if rows.len() == panel.time.len() {
        return false;
    }
    let finite = || series.values.iter().copied().filter(|x| x.is_finite());
    let range = finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min);
    let all = thin::means(&panel.time, &series.values, series.held, 0..panel.time.len());
    let kept = thin::means(&panel.time, &series.values, series.held, rows.iter().copied());
    (all.0 - kept.0).abs().max((all.1 - kept.1).abs()) > ROUGH * range
}

fn movement(animation: &Animation, pack: &mut Pack) -> Value {
    let rows = frames(&animation.time);
    let pick = |values: &Vec<f64>| {
        rows.iter().map(|&row| values.get(row).copied().unwrap_or(0.0)).collect::<Vec<f64>>()
    };
    let time = pack.wide(&pick(&animation.time));
    let positions: Vec<Value> = animation.positions.iter().map(|values| pack.narrow(&pick(values))).collect();
    let set: Option<Vec<Value>> =
        animation.set.as_ref().map(|set| set.iter().map(|values| pack.narrow(&pick(values))).collect());
    let surfaces: Vec<Value> = animation.surfaces.iter().map(|surface| surface.data(pack)).collect();
    let contact = |contact: &Contact| json!([contact.from, contact.to, contact.names[0], contact.names[1]]);
    let contacts: Vec<Value> = animation.contacts.iter().map(contact).collect();
    json!({
        "scene": animation.scene, "contacts": contacts, "time": time, "positions": positions, "set": set, "surfaces": surfaces,
    })
}

/// Rows at about equal distances in time.
fn frames(time: &[f64]) -> Vec<usize> {
    let (Some(&begin), Some(&end)) = (time.first(), time.last()) else { return Vec::new() };
    if time.len() <= FRAMES {
        return (0..time.len()).collect();
    }
    let at = |frame: usize| begin + (end - begin) * frame as f64 / (FRAMES - 1) as f64;
    let mut rows: Vec<usize> =
        (0..FRAMES).map(|frame| time.partition_point(|&t| t < at(frame)).min(time.len() - 1)).collect();
    rows.dedup();
    rows
}

fn body(report: &Report, thinned: bool) -> String {
    let mut out = String::new();
    let sections = [
        ("summary", "Summary", true),
        ("space", "3D", report.animation.is_some()),
        ("scopes", "Scopes", !report.panels.is_empty()),
        ("diagram", "Diagram", !report.diagram.levels.is_empty()),
        ("compared", "Compared", report.compared.is_some()),
        ("numbers", "Following", !report.metrics.rows.is_empty()),
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
        out.push_str(&format!("<div><dt>{}</dt><dd>{}</dd></div>", escape(name), escape(value)));
    }
    out.push_str("</dl></section>\n");
    out.push_str("<noscript><p class=\"warning\">Scopes and movement need JavaScript.</p></noscript>\n");
    out.push_str("<div id=\"trouble\" role=\"alert\"></div>\n");
    if report.animation.is_some() {
        out.push_str("<section id=\"space\"><h2>3D</h2><div id=\"space-view\"></div></section>\n");
    }
    if report.panels.is_empty() {
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
    out.push_str(&section("numbers", "Following", &report.metrics));
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
    out.push_str("</main>\n<footer id=\"timeline\"></footer>\n<dialog id=\"keys\" aria-label=\"Keys\"></dialog>\n<div id=\"said\" class=\"unseen\" aria-live=\"polite\"></div>\n");
    out
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
