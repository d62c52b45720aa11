//! Text to cells with places: comments, separators, quotes.

use std::borrow::Cow;
use std::ops::Range;

use diagnostic::{Code, Diagnostic, Text, both};

use crate::number::{Mark, Shape};
use crate::refusal::{Codes, error};

/// What may stand between cells, the likeliest first where nothing else decides.
const SEPARATORS: [u8; 3] = [b'\t', b';', b','];

/// One cell: its content without spaces around it and without quotes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cell {
    pub(crate) span: Range<usize>,
    quoted: bool,
}

/// One row that says something.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Record {
    /// From 1.
    pub(crate) line: u64,
    pub(crate) cells: Vec<Cell>,
}

impl Record {
    /// From the first cell to the last.
    pub(crate) fn span(&self) -> Range<usize> {
        match (self.cells.first(), self.cells.last()) {
            (Some(first), Some(last)) => first.span.start..last.span.end,
            _ => 0..0,
        }
    }
}

/// A header and rows of as many cells.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    pub(crate) header: Record,
    pub(crate) records: Vec<Record>,
    /// Lines that begin with `#`.
    pub(crate) comments: Vec<String>,
    separator: u8,
}

impl Table {
    /// Reads a text; `is_known` tells the headers that a file of its kind may have, `expected` what to say where there is none.
    pub(crate) fn read(
        text: &str,
        codes: Codes,
        expected: &Text,
        is_known: impl Fn(&str) -> bool,
    ) -> Result<Self, Diagnostic> {
        let Some(Split { mut header, mut rows, .. }) = split(text, codes, is_known)? else {
            return Err(Diagnostic::error(codes.unreadable, both!("the file is empty", "файл пуст"))
                .help(expected.clone()));
        };
        let span = header.span();
        if let Some(at) = text[span.clone()].find('\0').map(|at| span.start + at) {
            let help = both!(
                "save it as CSV: UTF-8, or as Excel's Unicode text",
                "сохраните его как CSV в UTF-8 или как «Текст Юникод» из Excel"
            );
            let message = both!("the file is no text", "файл — не текст");
            let label = both!("a NUL byte", "байт NUL");
            return Err(error(codes.unreadable, message, &(at..at + 1), label, help));
        }
        while header.cells.last().is_some_and(|cell| cell.span.is_empty()) {
            header.cells.pop();
        }
        let width = header.cells.len();
        let mut records = Vec::new();
        while let Some(mut record) = rows.next()? {
            // A spreadsheet ends rows with the separators of columns that were once used.
            while record.cells.len() > width && record.cells.last().is_some_and(|cell| cell.span.is_empty()) {
                record.cells.pop();
            }
            if record.cells.len() != width {
                let message = both!(
                    "the row has {} cells, the header {width}",
                    "в строке ячеек {}, а в заголовке {width}",
                    record.cells.len()
                );
                let more = match (record.cells.len() < width, rows.separator) {
                    (true, _) => {
                        both!(", empty ones where nothing was measured", ", пустых — где ничего не измерено")
                    }
                    (false, b',') => both!(
                        "; write 0.5, not 0,5, or put ; between the cells",
                        "; пишите 0.5, а не 0,5, или разделяйте ячейки знаком ;"
                    ),
                    (false, _) => Text::EMPTY,
                };
                let help = both!(
                    "give every row as many cells as the header{more}",
                    "дайте каждой строке столько ячеек, сколько в заголовке{more:#}"
                );
                return Err(error(
                    codes.cell,
                    message,
                    &record.span(),
                    both!("this row", "эта строка"),
                    help,
                ));
            }
            records.push(record);
        }
        Ok(Self { header, records, comments: rows.comments, separator: rows.separator })
    }

    /// The decimal mark of these cells.
    pub(crate) fn mark<'t>(
        &self,
        text: &str,
        code: Code,
        cells: impl Iterator<Item = &'t Cell>,
    ) -> Result<Mark, Diagnostic> {
        if self.separator == b',' && !text.contains('"') {
            // A comma inside a cell needs quotes.
            return Ok(Mark::Point);
        }
        let (mut point, mut comma, mut either): (Option<&Cell>, Option<&Cell>, Option<&Cell>) =
            (None, None, None);
        for cell in cells {
            let found = match Shape::of(&value(text, cell)) {
                Shape::Silent => continue,
                Shape::Point => &mut point,
                Shape::Comma => &mut comma,
                Shape::Either => &mut either,
                Shape::Thousands => {
                    let message = both!(
                        "`{}` has marks between its thousands",
                        "в `{}` стоит знак тысяч",
                        value(text, cell)
                    );
                    let help = both!(
                        "format the cells without them: 1234.5 or 1234,5",
                        "уберите его в формате ячеек: 1234.5 или 1234,5"
                    );
                    return Err(error(code, message, &cell.span, both!("this number", "это число"), help));
                }
            };
            found.get_or_insert(cell);
        }
        let Some(cell) = comma.or(either) else { return Ok(Mark::Point) };
        let written = value(text, cell);
        let (message, label, help) = match (point, comma) {
            (Some(point), _) => (
                both!(
                    "`{written}` has a comma where `{}` has a point",
                    "в `{written}` запятая, а в `{}` точка",
                    value(text, point)
                ),
                both!("a comma here", "здесь запятая"),
                both!(
                    "write all numbers of a file with a point, or all with a comma",
                    "пишите все числа файла с точкой или все с запятой"
                ),
            ),
            (None, None) => (
                both!(
                    "`{written}` is {} or {}, and no other number tells which",
                    "`{written}` — это {} или {}, и по другим числам не узнать",
                    written.replace(',', "."),
                    written.replace(',', "")
                ),
                both!("a decimal comma, or a mark between thousands", "десятичная запятая или знак тысяч"),
                both!(
                    "write numbers with a point, or one of them with other than three decimals",
                    "пишите числа с точкой или хотя бы одно не с тремя знаками"
                ),
            ),
            (None, Some(_)) => return Ok(Mark::Comma),
        };
        Err(error(code, message, &cell.span, label, help))
    }
}

/// Cuts a text where its header says; `None` where it has none.
fn split(text: &str, codes: Codes, is_known: impl Fn(&str) -> bool) -> Result<Option<Split<'_>>, Diagnostic> {
    let mut rows =
        Rows { text, separator: b',', at: 0, line: 1, comments: Vec::new(), code: codes.unreadable };
    let said = match text.as_bytes() {
        [b's' | b'S', b'e' | b'E', b'p' | b'P', b'=', separator, ..] => Some(*separator),
        _ => None,
    };
    let said = said.filter(|separator| SEPARATORS.contains(separator));
    if said.is_some() {
        rows.at = text.find(['\n', '\r']).unwrap_or(text.len());
        rows.end_line();
    }
    let (mut found, mut fault): (Vec<Split<'_>>, _) = (Vec::new(), None);
    for separator in SEPARATORS.into_iter().filter(|one| said.is_none_or(|said| said == *one)) {
        let mut rows = Rows { separator, ..rows.clone() };
        match rows.header() {
            Ok(Some(header)) => {
                let known = header.cells.iter().filter(|cell| is_known(&value(text, cell))).count();
                found.push(Split { known, header, rows });
            }
            Ok(None) => {}
            // Quotes end elsewhere where the separator is another.
            Err(error) => fault = fault.or(Some(error)),
        }
    }
    // What is not cut at all is no split, where something else is.
    let is_cut = |split: &Split<'_>| split.header.cells.len() > 1;
    let most = found.iter().map(|split| (split.known, is_cut(split))).max();
    found.retain(|split| Some((split.known, is_cut(split))) == most);
    match (most, fault) {
        (Some((0, _)) | None, Some(fault)) => Err(fault),
        (Some((1.., true)), _) if found.len() > 1 => {
            let [a, b] = [0, 1].map(|k| found[k].header.cells.len());
            let message = both!(
                "the header can be read as {a} columns and as {b}",
                "заголовок читается и как {a} столбцов, и как {b}"
            );
            let label = both!("is {} the separator?", "разделитель — {:#}?", shown(found[0].rows.separator));
            let help = both!(
                "put one sign between all cells, and names that contain it into quotes",
                "разделяйте все ячейки одним знаком, а имена с ним берите в кавычки"
            );
            Err(error(codes.unreadable, message, &found[0].header.span(), label, help))
        }
        // Where nothing is known, what cuts oftenest; the refusal of a column names it then.
        _ => Ok(found.into_iter().max_by_key(|split| split.header.cells.len())),
    }
}

/// What stands in a cell.
pub(crate) fn value<'t>(text: &'t str, cell: &Cell) -> Cow<'t, str> {
    let content = &text[cell.span.clone()];
    if cell.quoted && content.contains("\"\"") {
        Cow::Owned(content.replace("\"\"", "\""))
    } else {
        Cow::Borrowed(content)
    }
}

fn shown(separator: u8) -> Text {
    match separator {
        b'\t' => both!("a tab", "табуляция"),
        b';' => Text::same("`;`"),
        _ => Text::same("`,`"),
    }
}

/// A text cut at one of the separators: the header, how many of its cells are known, and the rows below.
struct Split<'t> {
    known: usize,
    header: Record,
    rows: Rows<'t>,
}

/// The rows of a text, from a place on.
#[derive(Clone)]
struct Rows<'t> {
    text: &'t str,
    separator: u8,
    at: usize,
    line: u64,
    comments: Vec<String>,
    /// Of messages about quotes.
    code: Code,
}

impl Rows<'_> {
    /// The first row that is no comment; a spreadsheet puts a comment with a separator in it into quotes.
    fn header(&mut self) -> Result<Option<Record>, Diagnostic> {
        while let Some(record) = self.next()? {
            match record.cells.first() {
                Some(cell) if cell.quoted && value(self.text, cell).starts_with('#') => {
                    self.comments.push(value(self.text, cell).into_owned());
                }
                _ => return Ok(Some(record)),
            }
        }
        Ok(None)
    }

    /// The next row that says something.
    fn next(&mut self) -> Result<Option<Record>, Diagnostic> {
        while self.at < self.text.len() {
            let line = self.line;
            if self.text.as_bytes()[self.at] == b'#' {
                let rest = &self.text[self.at..];
                let length = rest.find(['\n', '\r']).unwrap_or(rest.len());
                self.comments.push(rest[..length].trim_end_matches([';', ',', '\t', ' ']).to_owned());
                self.at += length;
                self.end_line();
                continue;
            }
            let mut cells = Vec::new();
            loop {
                cells.push(self.cell()?);
                if self.text.as_bytes().get(self.at) != Some(&self.separator) {
                    break;
                }
                self.at += 1;
            }
            self.end_line();
            if cells.iter().any(|cell| !cell.span.is_empty()) {
                return Ok(Some(Record { line, cells }));
            }
        }
        Ok(None)
    }

    /// Goes beyond a line end: `\n`, `\r\n` or `\r`.
    fn end_line(&mut self) {
        let bytes = self.text.as_bytes();
        self.at += match (bytes.get(self.at), bytes.get(self.at + 1)) {
            (Some(b'\r'), Some(b'\n')) => 2,
            (Some(_), _) => 1,
            (None, _) => 0,
        };
        self.line += 1;
    }

    /// One cell, up to its separator or the line's end.
    fn cell(&mut self) -> Result<Cell, Diagnostic> {
        let bytes = self.text.as_bytes();
        let (separator, start) = (self.separator, self.at);
        let ends = |byte: u8| byte == separator || matches!(byte, b'\n' | b'\r');
        let until = |from: usize| {
            bytes[from..].iter().position(|byte| ends(*byte)).map_or(bytes.len(), |at| from + at)
        };
        let blank =
            bytes[start..].iter().take_while(|byte| byte.is_ascii_whitespace() && !ends(**byte)).count();
        if bytes.get(start + blank) != Some(&b'"') {
            self.at = until(start);
            let content = &self.text[start..self.at];
            let from = start + (content.len() - content.trim_start().len());
            return Ok(Cell { span: from..from + content.trim().len(), quoted: false });
        }
        let from = start + blank + 1;
        let mut to = from;
        loop {
            match bytes[to..].iter().position(|byte| *byte == b'"') {
                Some(length) if bytes.get(to + length + 1) == Some(&b'"') => to += length + 2,
                Some(length) => break to += length,
                None => {
                    let (message, help) = (
                        both!("a quote is opened and never closed", "кавычка открыта и не закрыта"),
                        both!(
                            "close it, or write the cell without quotes",
                            "закройте её или пишите ячейку без кавычек"
                        ),
                    );
                    let label = both!("opened here", "открыта здесь");
                    return Err(error(self.code, message, &(from - 1..from), label, help));
                }
            }
        }
        self.line += bytes[from..to].iter().filter(|byte| **byte == b'\n').count() as u64;
        self.at = until(to + 1);
        if !self.text[to + 1..self.at].trim().is_empty() {
            let help = both!(
                "put the whole cell into quotes, and write a quote within as two",
                "возьмите в кавычки всю ячейку, а кавычку внутри удвойте"
            );
            let message = both!("text behind a closing quote", "текст после закрывающей кавычки");
            return Err(error(
                self.code,
                message,
                &(to + 1..self.at),
                both!("this text", "этот текст"),
                help,
            ));
        }
        let content = &self.text[from..to];
        let lead = content.len() - content.trim_start().len();
        Ok(Cell { span: from + lead..from + lead + content.trim().len(), quoted: true })
    }
}
