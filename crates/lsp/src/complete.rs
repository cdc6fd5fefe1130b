//! What may follow at the cursor, as the protocol writes it.

use blocksim_edit::{Completion, CompletionKind};
use lsp_types::{
    CompletionItem, CompletionItemKind, Documentation, InsertTextFormat, MarkupContent, MarkupKind,
};

/// An item of the list of the editor.
pub fn item(completion: Completion) -> CompletionItem {
    let Completion { label, kind, detail, doc, insert, has_places } = completion;
    let markdown = |value| Documentation::MarkupContent(MarkupContent { kind: MarkupKind::Markdown, value });
    CompletionItem {
        label,
        kind: Some(match kind {
            CompletionKind::Section => CompletionItemKind::MODULE,
            CompletionKind::Kind => CompletionItemKind::CLASS,
            CompletionKind::Member => CompletionItemKind::FIELD,
            CompletionKind::Word => CompletionItemKind::ENUM_MEMBER,
            CompletionKind::Name => CompletionItemKind::VARIABLE,
            CompletionKind::File => CompletionItemKind::FILE,
            CompletionKind::Folder => CompletionItemKind::FOLDER,
        }),
        detail: (!detail.is_empty()).then_some(detail),
        documentation: (!doc.is_empty()).then(|| markdown(doc)),
        insert_text: Some(insert),
        insert_text_format: has_places.then_some(InsertTextFormat::SNIPPET),
        ..CompletionItem::default()
    }
}
