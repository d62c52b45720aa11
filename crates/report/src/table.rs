//! Tables of a page.

use diagnostic::{Language, say};
use maud::{Markup, html};

use crate::text::{longest, shown};

/// A heading beside a cell: a short one stays on its line.
fn unbroken(label: &str) -> String {
    const SHORT: usize = 12;
    if label.chars().count() > SHORT {
        return label.to_owned();
    }
    label.replace('-', "\u{2011}").replace(' ', "\u{a0}")
}

/// Characters of the widest words of a row for which a telephone has room.
const PHONE: usize = 42;

/// True where a telephone, 390 px wide, has no room for the words of a row side by side.
fn is_wide(header: &[&str], rows: &[Vec<String>]) -> bool {
    let column = |at: usize| {
        let cells = rows.iter().filter_map(|row| row.get(at)).map(|cell| longest(cell));
        cells.chain([longest(header[at])]).max().unwrap_or_default()
    };
    // What stands between two columns is as wide as a character.
    (0..header.len()).map(|at| column(at) + 1).sum::<usize>() > PHONE
}

/// A table of texts; the columns named in `numbers` are set as numbers.
///
/// Where a telephone has no room for a row, it shows every row as a list of headings and cells. Styles that do so make a
/// browser forget that it is a table: its parts say it themselves.
pub(crate) fn table(language: Language, header: &[&str], numbers: &[usize], rows: &[Vec<String>]) -> Markup {
    let is_wide = is_wide(header, rows);
    let role = |role: &'static str| is_wide.then_some(role);
    html! {
        // A group, not a region: a page has many of them, and readers who jump between regions want its parts.
        div.scroll tabindex="0" role="group" aria-label=(say!(language, "Table", "Таблица")) {
            table.wide[is_wide] role=[role("table")] {
                thead role=[role("rowgroup")] {
                    tr role=[role("row")] {
                        @for (at, cell) in header.iter().enumerate() {
                            // Nothing is no heading: it would be read out as an empty one.
                            @if cell.is_empty() { td role=[role("cell")] {} }
                            @else { th.n[numbers.contains(&at)] scope="col" role=[role("columnheader")] { (cell) } }
                        }
                    }
                }
                tbody role=[role("rowgroup")] {
                    @for row in rows {
                        tr role=[role("row")] {
                            @for (at, cell) in row.iter().enumerate() {
                                td.n[numbers.contains(&at)] role=[role("cell")] data-label=[header.get(at).filter(|_| is_wide).map(|label| unbroken(label))] { (shown(cell)) }
                            }
                        }
                    }
                }
            }
        }
    }
}
