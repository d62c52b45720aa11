//! What stands in a section: texts of every language go in, those of the page's language come out.

use diagnostic::{Language, Text, both};
use maud::{Markup, PreEscaped, html};

use crate::table::table;
use crate::text::{shown, typed};

/// Parts one below the other.
#[derive(Clone, Debug)]
pub struct Body {
    language: Language,
    html: String,
}

impl Body {
    /// Nothing yet.
    #[must_use]
    pub const fn new(language: Language) -> Self {
        Self { language, html: String::new() }
    }

    /// The language that it is written in.
    #[must_use]
    pub const fn language(&self) -> Language {
        self.language
    }

    /// Nothing was said.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.html.is_empty()
    }

    /// All of it.
    #[must_use]
    pub fn into_markup(self) -> Markup {
        PreEscaped(self.html)
    }

    fn say(&self, text: &Text) -> String {
        shown(text.in_language(self.language))
    }

    /// What no other part is.
    pub fn add(&mut self, part: &Markup) {
        self.html.push_str(&part.0);
    }

    /// A paragraph.
    pub fn p(&mut self, text: &Text) {
        self.add(&html! { p { (self.say(text)) } });
    }

    /// A paragraph in which what is typed stands between backticks.
    pub fn typed(&mut self, text: &Text) {
        self.add(&html! { p { (typed(text.in_language(self.language))) } });
    }

    /// A remark.
    pub fn muted(&mut self, text: &Text) {
        self.add(&html! { p.muted { (self.say(text)) } });
    }

    /// A paragraph that begins with a word of warning.
    pub fn warning(&mut self, word: &Text, text: &Text) {
        self.add(&html! { p { strong { (self.say(word)) } (self.say(text)) } });
    }

    /// A verdict, and what it says in a sentence.
    pub fn verdict(&mut self, word: &Text, sentence: &Text) {
        self.verdict_alone(word);
        self.headline(sentence);
    }

    /// A verdict.
    pub fn verdict_alone(&mut self, word: &Text) {
        self.add(&html! { p { span.verdict { (self.say(word)) } } });
    }

    /// The sentence of the first screen.
    pub fn headline(&mut self, text: &Text) {
        self.add(&html! { h1 { (self.say(text)) } });
    }

    /// A heading within the section.
    pub fn heading(&mut self, text: &Text) {
        self.add(&html! { h3 { (self.say(text)) } });
    }

    /// What a terminal would show, line by line.
    pub fn lines(&mut self, text: &str) {
        self.add(&html! { div.scroll tabindex="0" { pre { (text) } } });
    }

    /// Points one below the other.
    pub fn list(&mut self, texts: &[Text]) {
        self.add(&html! { ul { @for text in texts { li { (self.say(text)) } } } });
    }

    /// Names with their values.
    pub fn facts(&mut self, facts: impl IntoIterator<Item = Fact>) {
        let one =
            |fact: Fact| html! { dt { (self.say(&fact.name)) } dd { (fact.value.markup(self.language)) } };
        let all = html! { dl { @for fact in facts { (one(fact)) } } };
        self.add(&all);
    }

    /// A table.
    pub fn table<R>(&mut self, table: &Table<R>) {
        self.add(&table.markup(self.language));
    }

    /// The numbers of drawings, behind a fold.
    pub fn numbers<R>(&mut self, table: &Table<R>) {
        self.add(&table.folded(self.language));
    }

    /// A drawing with its words.
    pub fn figure(&mut self, drawing: &Markup, caption: &Text) {
        self.drawn(drawing, caption, &html! {});
    }

    /// A drawing with its words, and its numbers behind a fold.
    pub fn figure_of<R>(&mut self, drawing: &Markup, caption: &Text, numbers: &Table<R>) {
        self.drawn(drawing, caption, &numbers.folded(self.language));
    }

    fn drawn(&mut self, drawing: &Markup, caption: &Text, numbers: &Markup) {
        let group = both!("Drawing", "Рисунок");
        self.add(&html! {
            figure {
                div.scroll tabindex="0" role="group" aria-label=(self.say(&group)) { (drawing) }
                figcaption { (self.say(caption)) }
                (numbers)
            }
        });
    }

    /// Parts behind a fold.
    pub fn details(&mut self, summary: &Text, inside: impl FnOnce(&mut Self)) {
        let inner = self.within(inside);
        self.add(&html! { details { summary { (self.say(summary)) } (inner) } });
    }

    /// Parts side by side, where there is room.
    pub fn side(&mut self, inside: impl FnOnce(&mut Self)) {
        let inner = self.within(inside);
        self.add(&html! { div.side { (inner) } });
    }

    /// Parts that stay together.
    pub fn together(&mut self, inside: impl FnOnce(&mut Self)) {
        let inner = self.within(inside);
        self.add(&html! { div { (inner) } });
    }

    fn within(&self, inside: impl FnOnce(&mut Self)) -> Markup {
        let mut inner = Self::new(self.language);
        inside(&mut inner);
        inner.into_markup()
    }
}

/// A name with its value.
#[derive(Clone, Debug)]
pub struct Fact {
    name: Text,
    value: Value,
}

#[derive(Clone, Debug)]
enum Value {
    Said(Text),
    Unknown(Text),
    Typed(String),
    /// Its name, its BLAKE3, remarks in it.
    File(String, Option<String>, Vec<String>),
}

impl Value {
    fn markup(&self, language: Language) -> Markup {
        html! {
            @match self {
                Self::Said(text) => (shown(text.in_language(language))),
                Self::Unknown(text) => span.muted { (text.in_language(language)) },
                Self::Typed(text) => code { (shown(text)) },
                Self::File(name, hash, remarks) => {
                    (shown(name))
                    @if let Some(hash) = hash { " " span.muted { "BLAKE3 " (hash) } }
                    @for remark in remarks { br; span.muted { (shown(remark)) } }
                }
            }
        }
    }
}

impl Fact {
    /// What is known.
    #[must_use]
    pub fn new(name: Text, value: &Text) -> Self {
        Self { name, value: Value::Said(value.clone()) }
    }
    /// What reads alike in every language.
    #[must_use]
    pub fn same(name: Text, value: impl Into<String>) -> Self {
        Self { name, value: Value::Said(Text::same(value)) }
    }
    /// What nobody said.
    #[must_use]
    pub const fn unknown(name: Text, why: Text) -> Self {
        Self { name, value: Value::Unknown(why) }
    }
    /// What was typed.
    #[must_use]
    pub const fn typed(name: Text, words: String) -> Self {
        Self { name, value: Value::Typed(words) }
    }
    /// A file with its BLAKE3, where it has one.
    #[must_use]
    pub fn file(name: Text, file: &str, hash: Option<String>) -> Self {
        Self::remarked(name, file, hash, Vec::new())
    }
    /// A file with what is remarked in it.
    #[must_use]
    pub fn remarked(name: Text, file: &str, hash: Option<String>, remarks: Vec<String>) -> Self {
        Self { name, value: Value::File(file.to_owned(), hash, remarks) }
    }
}

/// Things, and what is said of each: a column by a column.
#[derive(Clone, Debug)]
pub struct Table<R> {
    rows: Vec<R>,
    header: Vec<Text>,
    numbers: Vec<usize>,
    columns: Vec<Vec<Text>>,
}

impl<R> Table<R> {
    /// A row for each of these things.
    #[must_use]
    pub fn of(rows: impl IntoIterator<Item = R>) -> Self {
        let rows = rows.into_iter().collect();
        Self { rows, header: Vec::new(), numbers: Vec::new(), columns: Vec::new() }
    }

    /// A column of words below its heading.
    #[must_use]
    pub fn words(mut self, title: Text, cell: impl Fn(&R) -> Text) -> Self {
        self.header.push(title);
        self.columns.push(self.rows.iter().map(cell).collect());
        self
    }

    /// A column of numbers below its heading.
    #[must_use]
    pub fn numbers(mut self, title: Text, cell: impl Fn(&R) -> Text) -> Self {
        self.numbers.push(self.header.len());
        self.words(title, cell)
    }

    fn markup(&self, language: Language) -> Markup {
        let header: Vec<&str> = self.header.iter().map(|text| text.in_language(language)).collect();
        let cell = |row: usize| move |column: &Vec<Text>| column[row].in_language(language).to_owned();
        let rows: Vec<Vec<String>> =
            (0..self.rows.len()).map(|row| self.columns.iter().map(cell(row)).collect()).collect();
        table(language, &header, &self.numbers, &rows)
    }

    fn folded(&self, language: Language) -> Markup {
        let summary = both!("Numbers", "Числа");
        html! { details { summary { (summary.in_language(language)) } (self.markup(language)) } }
    }
}
