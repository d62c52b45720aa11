//! The file: what is seen without the script, and what the script draws from.

use std::collections::BTreeMap;

use diagnostic::{Language, Text};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::encode::{DISPLACED_UM, PLACE_UM, encoded};
use super::policy::policy;
use super::scene::{AFTER, BEFORE, CAUSES, Place, Scene};
use super::words::{WORDS, say, word};
use crate::chart::solid::{Solid, Way, ways};
use crate::numbers::{digits, number};
use crate::text::{json_block, json_string, shown};

/// What runs in it.
pub const SCRIPT: &str = include_str!("viewer.js");
const STYLE: &str = include_str!("viewer.css");

/// What the places are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A program's path, as posted and as corrected.
    Check,
    /// Nodes of a machine's volume.
    Map,
    /// Rows that were measured.
    Diagnosis,
}

impl Kind {
    const fn name(self) -> &'static str {
        match self {
            Self::Check => "check",
            Self::Map => "map",
            Self::Diagnosis => "diagnosis",
        }
    }
}

/// What stands in the braces of `words.rs`.
#[derive(Clone, Debug, Default)]
pub struct Figures<'a> {
    /// Texts.
    pub names: Vec<(&'static str, &'a str)>,
    /// Numbers, µm.
    pub numbers: Vec<(&'static str, f64)>,
}

/// A page in which the error moves.
#[derive(Clone, Debug)]
pub struct Viewer<'a> {
    /// What the places are.
    pub kind: Kind,
    /// The language it begins with; the reader switches to the other.
    pub language: Language,
    /// What is drawn.
    pub scene: &'a Scene,
    /// The second displacement is something.
    pub has_after: bool,
    /// Texts of lines, cut where they are long: by number of the file and line, as [`line_of`] puts them together.
    pub blocks: &'a BTreeMap<u64, String>,
    /// Names of the files behind the first.
    pub files: &'a [String],
    /// What the headings say.
    pub figures: Figures<'a>,
    /// Where it comes from: keys of the words, and values.
    pub facts: &'a [(&'static str, String)],
}

/// The number of a line in a file, 0 being the first: [`Place::line`].
#[must_use]
pub const fn line_of(file: usize, line: u64) -> u64 {
    /// The script knows it, too.
    const LINES: u64 = 1 << 32;
    file as u64 * LINES + line
}

/// Places of the drawing that is seen without the script.
const STILL_PLACES: usize = 1500;

impl Viewer<'_> {
    /// The bytes of the page.
    #[must_use]
    pub fn into_html(self) -> String {
        let language = self.language;
        let kind = self.kind.name();
        let of_kind = |what: &str| format!("{what}_{kind}");
        let mut values: Vec<(&str, String)> =
            self.figures.names.iter().map(|(name, value)| (*name, shown(value))).collect();
        values.extend(
            self.figures
                .numbers
                .iter()
                .map(|(name, um)| (*name, number(*um).in_language(language).to_owned())),
        );
        let t = |key: &str| html! { span data-t=(key) { (say(key, language, &values)) } };
        let encoded = encoded(&self.scene.places, CAUSES + self.scene.causes.len());
        let mut text = html! {
            (DOCTYPE)
            html lang=(language.name()) {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content=(policy(SCRIPT, STYLE));
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="color-scheme" content="light dark";
                    link rel="icon" href="data:,";
                    title { (say(&of_kind("title"), language, &values)) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    a.skip href="#picked" { (t("skip")) }
                    header {
                        p.muted { (t(&of_kind("kind"))) }
                        div.tongues.needs-script role="group" data-label="languages" {
                            button #en type="button" lang="en" aria-label="EN, English" { "EN" }
                            button #ru type="button" lang="ru" aria-label="RU, русский" { "RU" }
                        }
                        h1 { (t(&of_kind("head"))) }
                        p #seen.muted.needs-script {}
                    }
                    main {
                        div.stage {
                            (self.still(language))
                            (self.live(language, &t))
                        }
                        aside {
                            (self.picked(&t))
                            (self.causes(&t))
                            (self.more(&t))
                        }
                    }
                    p #spoken.heard aria-live="polite" {}
                    footer { (t("foot")) }
                    script #data type="application/json" { (json_block(&self.json(&encoded.rows))) }
                    script #places type="text/plain" { (PreEscaped(&encoded.text)) }
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        }
        .into_string();
        text.push('\n');
        text
    }

    /// Canvas, legend, sliders, buttons.
    fn live(&self, language: Language, t: &dyn Fn(&str) -> Markup) -> Markup {
        let kind = self.kind.name();
        let button = |id: &str, key: &str, sign: &str| {
            html! { button type="button" id=(id) data-label=(key) aria-label=(word(key, language)) title=(word(key, language)) { (sign) } }
        };
        html! {
            div.frame.needs-script {
                div #view tabindex="0" role="application" data-label="view" aria-label=(word("view", language)) {
                    canvas #canvas aria-hidden="true" {}
                    svg #overlay xmlns="http://www.w3.org/2000/svg" aria-hidden="true" {
                        @for id in ["x", "x0", "x1", "y", "y0", "y1", "z", "z0", "z1"] { text id=(id) {} }
                        path #whole {}
                        g #arms {}
                        circle #foot r="3.5" visibility="hidden" {}
                        circle #left r="5" visibility="hidden" {}
                        circle #tip r="7" visibility="hidden" {}
                    }
                }
                div.corner.views role="group" data-label="views" aria-label=(word("views", language)) {
                    @for view in ["view_corner", "view_top", "view_front", "view_side"] {
                        button type="button" id=(view) { (t(view)) }
                    }
                }
                div.corner.zooms {
                    (button("out", "out", "\u{2212}"))
                    (button("in", "in", "+"))
                }
            }
            fieldset.legend.needs-script data-label="shown" aria-label=(word("shown", language)) {
                label { input #show_commanded type="checkbox" checked; span.dash.k-commanded {} (t(&format!("commanded_{kind}"))) }
                label {
                    input #show_real type="checkbox" checked;
                    span.ramp {}
                    (t(&format!("real_{kind}")))
                    span #real_most.muted {}
                    span #key_most hidden {}
                }
                label hidden[!self.has_after] {
                    input #show_corrected type="checkbox" checked;
                    span.dash.k-corrected {}
                    (t(&format!("corrected_{kind}")))
                    span #after_most.muted {}
                }
            }
            div.sliders.needs-script {
                div {
                    label for="mag" { (t("magnification")) }
                    input #mag type="range" min="0" max="1000" step="any" value="0";
                    output #mag_now for="mag" {}
                }
                div {
                    label for="at" { (t(&format!("along_{kind}"))) }
                    input #at type="range" min="0" max="0" step="1" value="0";
                    output #at_now for="at" {}
                }
            }
            div.buttons.needs-script {
                button #play type="button" aria-pressed="false" { (t("play")) }
                button #swing type="button" aria-pressed="false" { (t("swing")) }
                (button("previous", "previous", "\u{2039}"))
                (button("next", "next", "\u{203a}"))
                button #worst type="button" { (t("worst")) }
                label { input #cut type="checkbox"; (t("cut")) }
            }
        }
    }

    /// The place that is looked at.
    fn picked(&self, t: &dyn Fn(&str) -> Markup) -> Markup {
        let kind = self.kind.name();
        let row = |id: &str, class: &str, key: String| {
            html! {
                tr hidden[id == "a" && !self.has_after] {
                    th scope="row" { span class={ "swatch " (class) } {} (t(&key)) }
                    @for k in 0..4 { td.whole[k == 3] id={ (id) (k) } {} }
                }
            }
        };
        html! {
            section.card.needs-script aria-labelledby="line" {
                h2 #line {}
                pre #block tabindex="0" {}
                p #place.muted {}
                table #picked tabindex="-1" {
                    caption { (t("displaced")) }
                    thead { tr { td {} th scope="col" { "X" } th scope="col" { "Y" } th scope="col" { "Z" } th scope="col" { (t("size")) } } }
                    tbody {
                        (row("r", "k-real", format!("real_{kind}")))
                        (row("a", "k-corrected", format!("corrected_{kind}")))
                    }
                }
                p #makers {}
                p #off.muted {}
            }
        }
    }

    fn causes(&self, t: &dyn Fn(&str) -> Markup) -> Markup {
        html! {
            @if self.scene.causes.is_empty() { p.card.small { (t("undivided")) } }
            section #causes_part.card.needs-script aria-labelledby="causes_title" {
                h2 #causes_title { (t("causes")) }
                ul #causes {}
                div.buttons {
                    button #all type="button" { (t("all")) }
                    button #none type="button" { (t("none")) }
                }
                p.muted.small { (t("causes_how")) }
            }
        }
    }

    /// Keys, bounds, provenance.
    fn more(&self, t: &dyn Fn(&str) -> Markup) -> Markup {
        let remainder = if self.kind == Kind::Diagnosis { "remainder_diagnosis" } else { "remainder" };
        html! {
            details.card.small.keys {
                summary { (t("keys")) }
                p.needs-script { (t("keys_how")) }
                p #thinned { (t(if self.is_whole() { "whole" } else { "thinned" })) }
                @if !self.scene.causes.is_empty() { p { (t(remainder)) } }
            }
            details #origin.card.small {
                summary { (t("where_from")) }
                dl {
                    @for (key, value) in self.facts {
                        dt { (t(key)) } dd { (shown(value)) }
                    }
                }
            }
        }
    }

    fn is_whole(&self) -> bool {
        self.scene.places.len() == self.scene.of
    }

    /// The drawing that needs no script.
    fn still(&self, language: Language) -> Markup {
        let Scene { places, .. } = self.scene;
        let kind = self.kind.name();
        let magnification = self.scene.magnification();
        let ranges = self.scene.ranges_mm();
        let stride = places.len().div_ceil(STILL_PLACES).max(1);
        let way = |class, words: &str, of: &dyn Fn(&Place) -> Option<[f64; 3]>| {
            let mut pieces: Vec<Vec<[f64; 3]>> = Vec::new();
            for (at, place) in places.iter().enumerate() {
                let found = of(place);
                let ends = places.get(at + 1).is_none_or(|next| next.begins);
                if place.begins || pieces.is_empty() || found.is_none() {
                    pieces.push(Vec::new());
                } else if at % stride != 0 && !ends {
                    continue;
                }
                if let (Some(found), Some(piece)) = (found, pieces.last_mut()) {
                    piece.push(found);
                }
            }
            pieces.retain(|piece| piece.len() > 1);
            Way { class, words: Text::same(word(&format!("{words}_{kind}"), language)), pieces }
        };
        let displaced = |place: &Place, which: usize| {
            let by = place.displaced_um[which].map(|um| f64::from(um) * 1e-3 * magnification);
            [0, 1, 2].map(|axis| place.at_mm[axis] + by[axis])
        };
        let mut all = vec![
            way(("k3", "commanded"), "commanded", &|place| Some(place.at_mm)),
            way(("k1", "real"), "real", &|place| Some(displaced(place, BEFORE))),
        ];
        if self.has_after {
            all.push(way(("k0", "corrected"), "corrected", &|place| {
                (!place.unknown_after).then(|| displaced(place, AFTER))
            }));
        }
        let said =
            say("still", language, &[("times", digits(magnification, 0).in_language(language).to_owned())]);
        html! { figure.still { (ways(language, &Text::same(said.as_str()), Solid { ranges }, &all)) figcaption.muted { (said) } } }
    }

    /// What the script reads, but for the places.
    fn json(&self, rows: &str) -> String {
        let scene = self.scene;
        let object = |entries: Vec<(&str, String)>| {
            let all: Vec<String> =
                entries.into_iter().map(|(key, value)| format!("{}:{value}", json_string(key))).collect();
            format!("{{{}}}", all.join(","))
        };
        let array = |entries: Vec<String>| format!("[{}]", entries.join(","));
        let words = |pick: fn(&(&'static str, &'static str, &'static str)) -> &'static str| {
            object(WORDS.iter().map(|row| (row.0, json_string(pick(row)))).collect())
        };
        let plain = |value: f64| if value.is_finite() { format!("{value}") } else { "null".to_owned() };
        let mut values: Vec<(&str, String)> =
            self.figures.names.iter().map(|(name, value)| (*name, json_string(&shown(value)))).collect();
        values.extend(self.figures.numbers.iter().map(|(name, um)| (*name, plain(*um))));
        let mut before = 0;
        let steps = self.blocks.keys().map(|line| {
            let step = line - before;
            before = *line;
            step.to_string()
        });
        object(vec![
            ("schema", json_string("vpost.viewer/1")),
            ("version", json_string(env!("CARGO_PKG_VERSION"))),
            ("kind", json_string(self.kind.name())),
            ("language", json_string(self.language.name())),
            ("values", object(values)),
            ("magnification", plain(scene.magnification())),
            ("has_after", self.has_after.to_string()),
            ("place_um", plain(PLACE_UM)),
            ("displaced_um", plain(DISPLACED_UM)),
            ("places", scene.places.len().to_string()),
            ("rows", json_string(rows)),
            (
                "causes",
                array(
                    scene
                        .causes
                        .iter()
                        .map(|cause| {
                            let mut entries = vec![
                                ("kind", json_string(cause.kind)),
                                ("symbol", json_string(&shown(&cause.symbol))),
                            ];
                            entries
                                .extend(cause.russian.as_ref().map(|name| ("ru", json_string(&shown(name)))));
                            object(entries)
                        })
                        .collect(),
                ),
            ),
            ("files", array(self.files.iter().map(|name| json_string(&shown(name))).collect())),
            ("lines", array(steps.collect())),
            ("blocks", array(self.blocks.values().map(|text| json_string(&shown(text))).collect())),
            ("words", object(vec![("en", words(|row| row.1)), ("ru", words(|row| row.2))])),
        ])
    }
}
