//! The page: head, styles, sections, data block.

use diagnostic::{Language, Text, say};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::text::{Numbers, json_block, longest, shown, unparted};

/// One part of a page.
#[derive(Clone, Debug)]
pub struct Section {
    /// For links to it.
    pub id: &'static str,
    /// Its heading.
    pub title: Text,
    /// What it holds.
    pub body: Markup,
}

/// A whole page as bytes of HTML.
#[derive(Clone, Debug)]
pub struct Page<'a> {
    /// The language that it is written in.
    pub language: Language,
    /// Title of the window and of a printed page.
    pub title: &'a str,
    /// What stands above the first section.
    pub head: Markup,
    /// The sections in order.
    pub sections: Vec<Section>,
    /// The results as JSON, kept in the page for programs.
    pub json: &'a str,
    /// The command that made the page, without its files.
    pub command: &'a str,
    /// What describes the JSON, with its version.
    pub schema: &'a str,
}

/// Nothing may be loaded and nothing may run, whatever stands in the page.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";

/// Styles: one palette for light, dark and paper. The colours are Okabe and Ito's, which every kind of colour vision
/// tells apart, and for the heat maps a series of rising lightness.
const STYLE: &str = include_str!("page.css");

impl Page<'_> {
    /// The file.
    #[must_use]
    pub fn into_html(self) -> String {
        let language = self.language;
        let mut text = html! {
            (DOCTYPE)
            html lang=(language.name()) {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content=(POLICY);
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="color-scheme" content="light dark";
                    link rel="icon" href="data:,";
                    title { (shown(self.title)) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    a.skip href="#content" { (say!(language, "Skip to the content", "К содержанию")) }
                    header { (self.head) }
                    nav aria-label=(say!(language, "Sections", "Разделы")) {
                        ol { @for section in &self.sections { li { a href={ "#" (section.id) } { (section.title.in_language(language)) } } } }
                    }
                    main #content tabindex="-1" {
                        @for section in &self.sections {
                            section id=(section.id) aria-labelledby={ (section.id) "-title" } {
                                h2 id={ (section.id) "-title" } { (section.title.in_language(language)) }
                                (section.body)
                            }
                        }
                    }
                    footer { (shown(&self.foot())) }
                    script #data type="application/json" { (json_block(self.json)) }
                }
            }
        }
        .into_string();
        text.push('\n');
        unparted(&text)
    }

    /// One line at the end: what made the page, and what it is.
    fn foot(&self) -> String {
        let Self { language, command, schema, .. } = self;
        say!(
            *language,
            "vpost {} {command}. This page needs no network, holds no script and is the same for the same files. Its numbers are in it as JSON ({schema}).",
            "vpost {} {command}. Странице не нужна сеть, сценариев в ней нет, для тех же файлов она та же. Её числа хранятся в ней как JSON ({schema}).",
            env!("CARGO_PKG_VERSION")
        )
    }
}

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
#[must_use]
pub fn table(language: Language, header: &[&str], numbers: &[usize], rows: &[Vec<String>]) -> Markup {
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

/// [`table`] with headings in every language, and numbers that were written with a point.
#[must_use]
pub fn table_of(language: Language, header: &[Text], numbers: &[usize], rows: &[Vec<String>]) -> Markup {
    let header: Vec<&str> = header.iter().map(|text| text.in_language(language)).collect();
    let cell = |(at, cell): (usize, &String)| {
        if numbers.contains(&at) { language.figures(cell.clone()) } else { cell.clone() }
    };
    let rows: Vec<Vec<String>> = rows.iter().map(|row| row.iter().enumerate().map(cell).collect()).collect();
    table(language, &header, numbers, &rows)
}

/// A drawing with its words, and its numbers behind a fold.
#[must_use]
pub fn figure(language: Language, drawing: &Markup, caption: &str, numbers: Option<Markup>) -> Markup {
    html! {
        figure {
            div.scroll tabindex="0" role="group" aria-label=(say!(language, "Drawing", "Рисунок")) { (drawing) }
            figcaption { (shown(caption)) }
            @if let Some(numbers) = numbers { (folded(language, &numbers)) }
        }
    }
}

/// The numbers of drawings, behind a fold.
#[must_use]
pub fn folded(language: Language, numbers: &Markup) -> Markup {
    html! { details { summary { (say!(language, "Numbers", "Числа")) } (numbers) } }
}
