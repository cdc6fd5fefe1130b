//! The page.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::assets::{DIAGRAM, MAIN, SCRIPTS, SPACE, STYLES};
use crate::body::body;
use crate::data::Report;
use crate::escape::{escape, json as safe_json};
use crate::numbers::{movement, picture};
use crate::pack::{Pack, compressed};
use crate::{BUDGET, diagram, other_signals};

/// Stretches of time that each picture is thinned to at first; fewer where the page would be too large.
const COLUMNS: usize = 1200;
/// Fewer are never made.
const FEWEST: usize = 75;
/// Stretches of time for each point of a signal that no picture shows.
const COARSER: usize = 4;

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
    let unseen = other_signals::courses(&report.unseen, most, &mut pack);
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
        "v": 1, "panels": panels, "space": space, "overlays": overlays, "thinned": thinned, "full": report.full, "compared": compared,
        "unseen": unseen,
    });
    let scripts: Vec<&str> = SCRIPTS
        .into_iter()
        .chain(SPACE.into_iter().filter(|_| report.animation.is_some()))
        .chain(DIAGRAM.into_iter().filter(|_| !texts.is_empty()))
        .chain([MAIN])
        .map(|(_, text)| text)
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
    for (_, style) in STYLES {
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
