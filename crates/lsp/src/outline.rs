//! What a file declares, for the outline of the editor.

use lsp_types::{DocumentSymbol, SymbolKind};

use crate::position::span;
use blocksim_edit::{Declared, Section, declared};

/// All names that a file declares.
#[expect(deprecated, reason = "the protocol keeps a member that it no longer wants")]
pub fn outline(text: &str) -> Vec<DocumentSymbol> {
    let symbol = |declared: Declared| {
        let (kind, detail) = match declared.section {
            Section::Parameter => (SymbolKind::CONSTANT, "parameter"),
            Section::Input | Section::Output | Section::Port => (SymbolKind::INTERFACE, "port"),
            Section::Block => (SymbolKind::OBJECT, declared.kind),
        };
        let range = span(text, &declared.place);
        DocumentSymbol {
            // Editors refuse a symbol without a name, which may be while one is being written.
            name: if declared.name.is_empty() { "?".to_owned() } else { declared.name.to_owned() },
            detail: Some(detail.to_owned()),
            kind,
            tags: None,
            deprecated: None,
            range,
            selection_range: range,
            children: None,
        }
    };
    declared(text).into_iter().map(symbol).collect()
}
