//! The block diagram as data of the page.

use std::collections::HashMap;

use serde_json::{Value, json};

use crate::data::{Inspected, Report};
use crate::other_signals;

/// Drawings, levels, tables and names of signals as JSON, as the scripts of the page take it.
pub fn texts(report: &Report) -> Value {
    let Report { diagram, tables, .. } = report;
    let drawings = diagram.drawings.iter().map(|drawing| {
        let nets = drawing.nets.iter().map(|net| json!([net.title, net.nodes, u8::from(net.directed)]));
        json!({ "svg": drawing.svg, "nets": nets.collect::<Vec<_>>() })
    });
    let places = places(report);
    let levels = diagram.levels.iter().map(|level| {
        let probes = level.probes.iter().map(|net| {
            let known = net.iter().filter_map(|probe| {
                let (panel, series) = places.get(probe.path.as_str())?;
                Some(json!([probe.element, panel, series]))
            });
            known.collect::<Vec<_>>()
        });
        let mut data = json!({
            "path": level.path, "title": level.title, "drawing": level.drawing,
            "blocks": level.blocks.iter().map(|block| block.as_ref().map(inspected)).collect::<Vec<_>>(),
            "probes": probes.collect::<Vec<_>>(), "signals": level.signals,
        });
        if !level.layers.is_null() {
            data["layers"] = level.layers.clone();
        }
        data
    });
    let kinds: serde_json::Map<String, Value> = diagram
        .kinds
        .iter()
        .map(|kind| (kind.name.clone(), json!({ "does": kind.does, "parameters": kind.parameters })))
        .collect();
    let tables =
        tables.iter().map(|(title, rows)| json!({ "title": title, "head": rows.head, "rows": rows.rows }));
    json!({
        "drawings": drawings.collect::<Vec<_>>(), "levels": levels.collect::<Vec<_>>(), "kinds": kinds,
        "tables": tables.collect::<Vec<_>>(), "unseen": other_signals::names(&report.unseen),
    })
}

/// Picture and place in it of each signal; −1 and the place among the others for those that no picture shows.
fn places(report: &Report) -> HashMap<&str, (i64, usize)> {
    let mut places = HashMap::new();
    for (panel, at) in report.panels.iter().zip(0..) {
        for (place, series) in panel.series.iter().enumerate() {
            places.entry(series.path.as_str()).or_insert((at, place));
        }
    }
    for (place, signal) in report.unseen.iter().enumerate() {
        places.entry(signal.path.as_str()).or_insert((-1, place));
    }
    places
}

fn inspected(block: &Inspected) -> Value {
    json!([block.name, block.kind, block.place, block.variant, block.parameters])
}
