//! The page: head, styles, sections, data block.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::text::{json_block, shown};

/// One part of a page.
#[derive(Clone, Debug)]
pub struct Section {
    /// For links to it.
    pub id: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// What it holds.
    pub body: Markup,
}

/// A whole page as bytes of HTML.
#[derive(Clone, Debug)]
pub struct Page<'a> {
    /// Title of the window and of a printed page.
    pub title: &'a str,
    /// What stands above the first section.
    pub head: Markup,
    /// The sections in order.
    pub sections: Vec<Section>,
    /// The results as JSON, kept in the page for programs.
    pub json: &'a str,
    /// One line at the end: what made the page.
    pub foot: &'a str,
}

/// What a page says by itself, in the language of its texts.
///
/// ```
/// use report::page::Furniture;
///
/// let numbers = maud::html! { "1" };
/// assert!(Furniture::RUSSIAN.folded(&numbers).into_string().contains("Числа"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Furniture {
    lang: &'static str,
    skip: &'static str,
    sections: &'static str,
    table: &'static str,
    drawing: &'static str,
    numbers: &'static str,
}

impl Furniture {
    /// English.
    pub const ENGLISH: Self = Self {
        lang: "en",
        skip: "Skip to the content",
        sections: "Sections",
        table: "Table",
        drawing: "Drawing",
        numbers: "Numbers",
    };

    /// Russian.
    pub const RUSSIAN: Self = Self {
        lang: "ru",
        skip: "К содержанию",
        sections: "Разделы",
        table: "Таблица",
        drawing: "Чертёж",
        numbers: "Числа",
    };

    /// A table of texts; the columns named in `numbers` are set as numbers.
    #[must_use]
    pub fn table(&self, header: &[&str], numbers: &[usize], rows: &[Vec<String>]) -> Markup {
        html! {
            div.scroll tabindex="0" role="region" aria-label=(self.table) {
                table {
                    thead { tr { @for cell in header { th scope="col" { (cell) } } } }
                    tbody {
                        @for row in rows {
                            tr {
                                @for (at, cell) in row.iter().enumerate() {
                                    td.n[numbers.contains(&at)] { (shown(cell)) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    /// A drawing with its words, and its numbers behind a fold.
    #[must_use]
    pub fn figure(&self, drawing: &Markup, caption: &str, numbers: Option<Markup>) -> Markup {
        html! {
            figure {
                div.scroll tabindex="0" role="region" aria-label=(self.drawing) { (drawing) }
                figcaption { (shown(caption)) }
                @if let Some(numbers) = numbers { (self.folded(&numbers)) }
            }
        }
    }

    /// The numbers of drawings, behind a fold.
    #[must_use]
    pub fn folded(&self, numbers: &Markup) -> Markup {
        html! { details { summary { (self.numbers) } (numbers) } }
    }
}

/// Nothing may be loaded and nothing may run, whatever stands in the page.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";

/// Styles: one palette for light, dark and paper. The colours are Okabe and Ito's, which every kind of colour vision
/// tells apart, and for the heat maps a series of rising lightness.
const STYLE: &str = include_str!("page.css");

impl Page<'_> {
    /// The file, in English.
    #[must_use]
    pub fn into_html(self) -> String {
        self.furnished(&Furniture::ENGLISH)
    }

    /// The file.
    #[must_use]
    pub fn furnished(self, furniture: &Furniture) -> String {
        let mut text = html! {
            (DOCTYPE)
            html lang=(furniture.lang) {
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
                    a.skip href="#content" { (furniture.skip) }
                    header { (self.head) }
                    nav aria-label=(furniture.sections) {
                        ol { @for section in &self.sections { li { a href={ "#" (section.id) } { (section.title) } } } }
                    }
                    main #content tabindex="-1" {
                        @for section in &self.sections {
                            section id=(section.id) aria-labelledby={ (section.id) "-title" } {
                                h2 id={ (section.id) "-title" } { (section.title) }
                                (section.body)
                            }
                        }
                    }
                    footer { (shown(self.foot)) }
                    script #data type="application/json" { (json_block(self.json)) }
                }
            }
        }
        .into_string();
        text.push('\n');
        text
    }
}

/// [`Furniture::table`] in English.
#[must_use]
pub fn table(header: &[&str], numbers: &[usize], rows: &[Vec<String>]) -> Markup {
    Furniture::ENGLISH.table(header, numbers, rows)
}

/// [`Furniture::figure`] in English.
#[must_use]
pub fn figure(drawing: &Markup, caption: &str, numbers: Option<Markup>) -> Markup {
    Furniture::ENGLISH.figure(drawing, caption, numbers)
}

/// [`Furniture::folded`] in English.
#[must_use]
pub fn folded(numbers: &Markup) -> Markup {
    Furniture::ENGLISH.folded(numbers)
}
