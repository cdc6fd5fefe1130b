//! Where what stands under the cursor is declared.

use std::ops::Range;
use std::path::{Path, PathBuf};

use blocksim_edit::{Context, context, is_of_reference};
use blocksim_edit::{Section, declared};
use blocksim_syntax::{is_word, run_at};

/// A place: in this text, or the beginning of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Target {
    /// Bytes of the same text.
    Here(Range<usize>),
    /// Another file.
    File(PathBuf),
}

/// Where what stands at a place of a text, whose file lies in `folder`, is declared.
pub fn definition(text: &str, at: usize, folder: &Path) -> Option<Target> {
    let of = |section, name: &str| {
        let found = declared(text).into_iter().find(|d| d.section == section && d.name == name)?;
        Some(Target::Here(found.place))
    };
    match context(text, at) {
        Context::Connection { .. } => {
            let reference = &text[run_at(text, at, is_of_reference)];
            let (block, port) = reference.split_once('.').unwrap_or((reference, ""));
            let input = port.split(['.', '[']).next().unwrap_or_default();
            if block == "in" { of(Section::Input, input) } else { of(Section::Block, block) }
        }
        Context::File => {
            let from = text[..at].rfind('"')? + 1;
            let to = text[from..].find('"')? + from;
            let file = folder.join(&text[from..to]);
            // The folder of a plug-in is shown by its source.
            let source = file.join("src/lib.rs");
            let file = if source.is_file() { source } else { file };
            file.is_file().then_some(Target::File(file))
        }
        Context::Expression => of(Section::Parameter, &text[run_at(text, at, is_word)]),
        _ => None,
    }
}
