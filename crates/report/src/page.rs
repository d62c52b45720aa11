//! The page: head, styles, sections, data block.

use diagnostic::{Language, Text, both, say};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::body::{Body, Fact};
use crate::text::{json_block, shown, unparted};

/// A whole page as bytes of HTML.
#[derive(Clone, Debug)]
pub struct Page {
    /// Title of the window and of a printed page.
    title: Text,
    /// The command that made the page, without its files.
    command: &'static str,
    /// What describes the JSON, with its version.
    schema: &'static str,
    /// What stands above the first section.
    pub head: Body,
    /// For links to each, its heading, and what it holds.
    sections: Vec<(&'static str, Text, Body)>,
}

/// Nothing may be loaded and nothing may run, whatever stands in the page.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";

/// Styles: one palette for light, dark and paper. The colours are Okabe and Ito's, which every kind of colour vision
/// tells apart, and for the heat maps a series of rising lightness.
pub const STYLE: &str = include_str!("page.css");

impl Page {
    /// Nothing but its title.
    #[must_use]
    pub const fn new(language: Language, title: Text, command: &'static str, schema: &'static str) -> Self {
        Self { title, command, schema, head: Body::new(language), sections: Vec::new() }
    }

    /// The next section; one in which nothing is said is left out.
    pub fn section(&mut self, id: &'static str, title: Text) -> &mut Body {
        self.sections.push((id, title, Body::new(self.head.language())));
        let (_, _, body) = self.sections.last_mut().expect("it was pushed just now");
        body
    }

    /// The last section: files, machine, options, and what made the page.
    pub fn provenance(&mut self, facts: impl IntoIterator<Item = Fact>) -> &mut Body {
        let made = format!("vpost {}, {}", env!("CARGO_PKG_VERSION"), self.schema);
        let made = Fact::same(both!("made by", "создано"), made);
        let body = self.section("provenance", both!("Where this comes from", "Откуда эти данные"));
        body.facts(facts.into_iter().chain([made]));
        body
    }

    /// The file.
    ///
    /// * `json` – the results, kept in the page for programs
    #[must_use]
    pub fn into_html(self, json: &str) -> String {
        let language = self.head.language();
        let foot = self.foot(language);
        let said: Vec<(&str, &str, Markup)> = self
            .sections
            .iter()
            .filter(|(.., body)| !body.is_empty())
            .map(|(id, title, body)| (*id, title.in_language(language), body.clone().into_markup()))
            .collect();
        let mut text = html! {
            (DOCTYPE)
            html lang=(language.name()) {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content=(POLICY);
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="color-scheme" content="light dark";
                    link rel="icon" href="data:,";
                    title { (shown(self.title.in_language(language))) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    a.skip href="#content" { (say!(language, "Skip to the content", "К содержанию")) }
                    header { (self.head.into_markup()) }
                    nav aria-label=(say!(language, "Sections", "Разделы")) {
                        ol { @for (id, title, _) in &said { li { a href={ "#" (id) } { (title) } } } }
                    }
                    main #content tabindex="-1" {
                        @for (id, title, body) in &said {
                            section id=(id) aria-labelledby={ (id) "-title" } {
                                h2 id={ (id) "-title" } { (title) }
                                (body)
                            }
                        }
                    }
                    footer { (shown(&foot)) }
                    script #data type="application/json" { (json_block(json)) }
                }
            }
        }
        .into_string();
        text.push('\n');
        unparted(&text)
    }

    /// One line at the end: what made the page, and what it is.
    fn foot(&self, language: Language) -> String {
        let Self { command, schema, .. } = self;
        let version = env!("CARGO_PKG_VERSION");
        say!(
            language,
            "vpost {version} {command}. This page needs no network, holds no script and is the same for the same files. Its numbers are in it as JSON ({schema}).",
            "vpost {version} {command}. Странице не нужна сеть, сценариев в ней нет, для тех же файлов она та же. Её числа хранятся в ней как JSON ({schema})."
        )
    }
}
