//! What a program is made of: its programs, their tools, the operations that comments name.

use lsp_types::{DocumentSymbol, FoldingRange, SymbolKind};
use nc_dialect::Dialect;
use nc_syntax::{Block, ItemKind, Reader};

use crate::document::Document;

/// Longest name that is shown, letters.
const LONGEST: usize = 80;

/// Programs hold tools, tools hold operations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Program,
    Tool,
    Operation,
}

struct Found {
    level: Level,
    name: String,
    line: u64,
}

/// The outline of a program.
pub(crate) fn symbols(document: &Document, dialect: &Dialect) -> Vec<DocumentSymbol> {
    let (found, last) = found(document.text().as_bytes(), dialect);
    nested(document, &found, last)
}

/// What can be folded: all of the outline that is longer than a line.
pub(crate) fn folds(symbols: &[DocumentSymbol]) -> Vec<FoldingRange> {
    let own = |symbol: &DocumentSymbol| FoldingRange {
        start_line: symbol.range.start.line,
        end_line: symbol.range.end.line,
        ..FoldingRange::default()
    };
    let mut all = Vec::new();
    for symbol in symbols {
        if symbol.range.start.line < symbol.range.end.line {
            all.push(own(symbol));
        }
        all.extend(folds(symbol.children.as_deref().unwrap_or_default()));
    }
    all
}

/// What begins where, and the last line.
fn found(text: &[u8], dialect: &Dialect) -> (Vec<Found>, u64) {
    let (mut reader, mut block) = (Reader::new(text, dialect), Block::default());
    let (mut found, mut tool, mut last) = (Vec::<Found>::new(), None, 1);
    let mut comment_before = false;
    while reader.next(&mut block) {
        last = block.line;
        let comments: Vec<&[u8]> = comments(&block).collect();
        if let Some(word) = block.words().find(|word| word.letter == b'T') {
            tool = Some(shown(block.text(word.span)));
        }
        let level = if begins_program(&block) {
            Some(Level::Program)
        } else if rewrite::changes_tool(dialect, &block) {
            Some(Level::Tool)
        } else if !block.acts() && !comments.is_empty() && !comment_before {
            Some(Level::Operation)
        } else {
            None
        };
        comment_before = !block.acts() && !comments.is_empty();
        let Some(level) = level else { continue };
        let mut name = match level {
            Level::Program => shown(block.bytes),
            Level::Tool => tool.clone().unwrap_or_else(|| shown(block.bytes)),
            Level::Operation => String::new(),
        };
        for comment in comments.iter().filter(|_| level != Level::Program) {
            name = format!("{name} {}", shown(comment));
        }
        let name = name.trim().to_owned();
        if !name.is_empty() {
            found.push(Found { level, name, line: block.line });
        }
    }
    (found, last)
}

/// The remarks of a block without their marks.
fn comments<'b>(block: &'b Block<'_>) -> impl Iterator<Item = &'b [u8]> {
    let comments = block.items.iter().filter(|item| item.kind == ItemKind::Comment);
    comments.map(|item| {
        let text = block.text(item.span).trim_ascii();
        let text = text.strip_prefix(b"(").or(text.strip_prefix(b";")).unwrap_or(text);
        text.strip_suffix(b")").unwrap_or(text)
    })
}

/// A program, or a subprogram, begins.
fn begins_program(block: &Block<'_>) -> bool {
    block.items.iter().any(|item| match item.kind {
        ItemKind::Name | ItemKind::Word { letter: b'O', .. } => true,
        ItemKind::Flow => {
            let text = block.text(item.span).to_ascii_uppercase();
            text.starts_with(b"O") && text.ends_with(b"SUB") && !text.ends_with(b"ENDSUB")
        }
        _ => false,
    })
}

fn shown(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).trim().chars().take(LONGEST).collect()
}

/// What was found, each with what it holds, up to a line.
fn nested(document: &Document, found: &[Found], last: u64) -> Vec<DocumentSymbol> {
    let mut symbols = Vec::new();
    let mut rest = found;
    while let [first, others @ ..] = rest {
        let inner = others.iter().position(|other| other.level <= first.level).unwrap_or(others.len());
        let end = others.get(inner).map_or(last, |next| next.line - 1).max(first.line);
        let own = document.whole_line(first.line);
        let mut range = own;
        range.end = document.whole_line(end).end;
        let children = nested(document, &others[..inner], end);
        symbols.push(symbol(first, [range, own], children));
        rest = &others[inner..];
    }
    symbols
}

fn symbol(
    found: &Found,
    [range, selection_range]: [lsp_types::Range; 2],
    children: Vec<DocumentSymbol>,
) -> DocumentSymbol {
    #[expect(deprecated, reason = "the field stands in the type of the protocol")]
    DocumentSymbol {
        name: found.name.clone(),
        detail: None,
        kind: match found.level {
            Level::Program => SymbolKind::MODULE,
            Level::Tool => SymbolKind::CLASS,
            Level::Operation => SymbolKind::METHOD,
        },
        tags: None,
        deprecated: None,
        range,
        selection_range,
        children: Some(children).filter(|children| !children.is_empty()),
    }
}
