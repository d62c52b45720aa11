//! A program as an editor has it: text that changes under the hand, places as lines and UTF-16 columns.

use std::ops::Range;

use lsp_types::{Position, Range as Places, TextDocumentContentChangeEvent};

/// The text of an open document.
///
/// ```
/// use editor::Document;
///
/// let mut document = Document::new("G1 X1\r\n(ø 5)\r\n".to_owned());
/// let second = document.range(&(7..13));
/// assert_eq!((second.start.line, second.end.character), (1, 5));
/// ```
#[derive(Debug, Default)]
pub struct Document {
    text: String,
    /// Where each line starts, bytes.
    lines: Vec<usize>,
}

impl Document {
    /// Of a text.
    #[must_use]
    pub fn new(text: String) -> Self {
        let mut lines = vec![0];
        lines.extend(starts(&text, 0..text.len()));
        Self { text, lines }
    }

    /// The text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Takes in a change; what lies beyond a line or the text means its end.
    pub fn change(&mut self, change: TextDocumentContentChangeEvent) {
        let Some(range) = change.range else {
            *self = Self::new(change.text);
            return;
        };
        let [start, end] = [range.start, range.end].map(|place| self.offset(place));
        let span = start..end.max(start);
        let (came, gone) = (change.text.len(), span.len());
        self.text.replace_range(span.clone(), &change.text);
        // A line end may come to be, or cease, where the change begins and ends: `\r` beside `\n`.
        let around = start.saturating_sub(1)..(start + came + 1).min(self.text.len());
        let first = self.lines.partition_point(|line| *line <= around.start).max(1);
        let behind = self.lines.partition_point(|line| *line <= span.end + 1).max(first);
        for line in &mut self.lines[behind..] {
            *line = *line - gone + came;
        }
        self.lines.splice(first..behind, starts(&self.text, around));
    }

    /// The byte of a place.
    #[must_use]
    pub fn offset(&self, place: Position) -> usize {
        let line = place.line as usize;
        let Some(&start) = self.lines.get(line) else { return self.text.len() };
        let text = self.line(line);
        let mut column = 0;
        for (at, letter) in text.char_indices() {
            if column + letter.len_utf16() as u32 > place.character {
                return start + at;
            }
            column += letter.len_utf16() as u32;
        }
        start + text.len()
    }

    /// The places of bytes.
    #[must_use]
    pub fn range(&self, span: &Range<u64>) -> Places {
        let [start, end] = [span.start, span.end].map(|at| self.place(at as usize));
        Places { start, end: end.max(start) }
    }

    /// The whole of a line, from 1.
    #[must_use]
    pub fn whole_line(&self, line: u64) -> Places {
        let line = (line.max(1) - 1).min(self.lines.len() as u64 - 1) as usize;
        let start = self.lines[line] as u64;
        self.range(&(start..start + self.line(line).len() as u64))
    }

    fn place(&self, at: usize) -> Position {
        let at = at.min(self.text.len());
        let line = self.lines.partition_point(|start| *start <= at) - 1;
        let before: u32 = self
            .line(line)
            .char_indices()
            .take_while(|(byte, _)| self.lines[line] + byte < at)
            .map(|(_, letter)| letter.len_utf16() as u32)
            .sum();
        Position::new(line as u32, before)
    }

    /// A line without its end.
    fn line(&self, line: usize) -> &str {
        let end = self.lines.get(line + 1).copied().unwrap_or(self.text.len());
        self.text[self.lines[line]..end].trim_end_matches(['\r', '\n'])
    }
}

/// Where lines start in a stretch of a text, its first byte apart: behind `\n`, `\r\n`, `\r`.
fn starts(text: &str, span: Range<usize>) -> impl Iterator<Item = usize> + use<> {
    let bytes = text.as_bytes();
    let ends = |at: &usize| match bytes[*at] {
        b'\n' => true,
        b'\r' => bytes.get(at + 1) != Some(&b'\n'),
        _ => false,
    };
    span.filter(ends).map(|at| at + 1).collect::<Vec<_>>().into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(range: [[u32; 2]; 2], text: &str) -> TextDocumentContentChangeEvent {
        let [start, end] = range.map(|[line, character]| Position { line, character });
        TextDocumentContentChangeEvent {
            range: Some(Places { start, end }),
            range_length: None,
            text: text.to_owned(),
        }
    }

    /// Whatever is typed, lines are those of the text read anew.
    #[test]
    fn lines_follow_every_change() {
        let pieces = ["\r", "\n", "\r\n", "G1", "", "ø\u{1F600}", "X1\nY2\r\nZ3\r"];
        let mut document = Document::new("G0\r\nG1 X1\n\nM30\r".to_owned());
        let mut seed = 1u32;
        let mut next = |below: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 16) % below
        };
        for _ in 0..5000 {
            let [a, b] = [[next(6), next(5)], [next(6), next(5)]];
            let text = pieces[next(7) as usize];
            document.change(change([a.min(b), a.max(b)], text));
            let anew = Document::new(document.text.clone());
            assert_eq!(document.lines, anew.lines, "{:?}", document.text);
            if document.text.len() > 200 {
                document.change(change([[1, 0], [90, 0]], ""));
            }
        }
    }

    #[test]
    fn columns_are_utf_16() {
        let document = Document::new("(\u{1F600}ø) X1\nG0".to_owned());
        assert_eq!(document.offset(Position::new(0, 3)), 5);
        // Inside a pair: in front of its letter.
        assert_eq!(document.offset(Position::new(0, 2)), 1);
        assert_eq!(document.offset(Position::new(0, 99)), 11);
        assert_eq!(document.offset(Position::new(9, 0)), document.text.len());
        assert_eq!(document.range(&(9..11)), Places::new(Position::new(0, 6), Position::new(0, 8)));
    }
}
