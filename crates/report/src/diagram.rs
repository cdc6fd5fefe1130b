//! The block diagram as data of the page.

use serde_json::{Value, json};

use crate::data::{Diagram, Inspected, Panel, Rows};

/// Drawings, levels and tables as JSON, which is compressed with the page's numbers.
pub(crate) fn texts(diagram: &Diagram, tables: &[(String, Rows)], panels: &[Panel]) -> Value {
    let drawings = diagram.drawings.iter().map(|drawing| {
        let nets = drawing.nets.iter().map(|net| json!([net.title, net.nodes, u8::from(net.directed)]));
        json!({ "svg": drawing.svg, "nets": nets.collect::<Vec<_>>() })
    });
    let places = places(panels);
    let levels = diagram.levels.iter().map(|level| {
        let probes = level.probes.iter().map(|net| {
            let known = net.iter().filter_map(|probe| {
                let (panel, series) = places.get(probe.path.as_str())?;
                Some(json!([probe.element, panel, series]))
            });
            known.collect::<Vec<_>>()
        });
        json!({
            "path": level.path, "title": level.title, "drawing": level.drawing,
            "blocks": level.blocks.iter().map(|block| block.as_ref().map(inspected)).collect::<Vec<_>>(),
            "probes": probes.collect::<Vec<_>>(),
        })
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
        "tables": tables.collect::<Vec<_>>(),
    })
}

/// Picture and place in it of each signal.
fn places(panels: &[Panel]) -> std::collections::HashMap<&str, (usize, usize)> {
    let mut places = std::collections::HashMap::new();
    for (at, panel) in panels.iter().enumerate() {
        for (place, series) in panel.series.iter().enumerate() {
            places.entry(series.path.as_str()).or_insert((at, place));
        }
    }
    places
}

fn inspected(block: &Inspected) -> Value {
    json!([block.name, block.kind, block.place, block.variant, block.parameters])
}
