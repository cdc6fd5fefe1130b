//! Places in texts as people count them: lines and columns from 1.

use std::cell::OnceCell;
use std::ops::Range;

use blocksim_block::problem::Place;
use blocksim_diagram::SourceFile;

/// The texts that places refer to. Where their lines start is found once, however many places are asked for.
pub struct Texts<'a> {
    files: &'a [SourceFile],
    starts: Vec<OnceCell<Vec<usize>>>,
}

impl<'a> Texts<'a> {
    /// Of these files, which places name by number.
    pub fn of(files: &'a [SourceFile]) -> Texts<'a> {
        Texts { files, starts: files.iter().map(|_| OnceCell::new()).collect() }
    }

    /// The file of this number.
    pub fn file(&self, number: u32) -> Option<&'a SourceFile> {
        self.files.get(number as usize)
    }

    /// File, line and column, in characters, of a place.
    pub fn located(&self, place: &Place) -> Option<(&'a SourceFile, usize, usize)> {
        let file = self.file(place.file.0)?;
        let at = within(&file.text, &place.span).start;
        let starts = self.starts[place.file.0 as usize].get_or_init(|| {
            [0].into_iter().chain(file.text.match_indices('\n').map(|(end, _)| end + 1)).collect()
        });
        let line = starts.partition_point(|start| *start <= at);
        let column = file.text[starts[line - 1]..at].chars().count() + 1;
        Some((file, line, column))
    }
}

/// The span, moved to where the text has whole characters.
pub fn within(text: &str, span: &Range<usize>) -> Range<usize> {
    let whole = |at: usize| (0..=at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
    let start = whole(span.start);
    start..whole(span.end).max(start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::problem::FileId;

    #[test]
    fn lines_and_columns_are_those_that_counting_finds() {
        let text = "ä\n\nbc\u{1F600}d\n";
        let files = [SourceFile { path: "a.ron".into(), text: text.into() }];
        let texts = Texts::of(&files);
        for (at, _) in text.char_indices().chain([(text.len(), ' ')]) {
            let before = &text[..at];
            let line = before.matches('\n').count() + 1;
            let column = before.rsplit('\n').next().map_or(0, |last| last.chars().count()) + 1;
            let place = Place { file: FileId(0), span: at..at };
            let (_, found, beside) = texts.located(&place).expect("a place");
            assert_eq!((found, beside), (line, column), "at {at}");
        }
        assert!(texts.located(&Place { file: FileId(1), span: 0..0 }).is_none());
    }
}
