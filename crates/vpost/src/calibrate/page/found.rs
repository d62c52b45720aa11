//! What every calibration's page is made of.

use diagnostic::Language;
use maud::Markup;
use report::page::Section;
use serde_json::Value;

use super::facts::Facts;

/// A calibration that can be shown.
pub(in super::super) trait Found {
    /// `positioning`, `ball bar`: title of the page.
    fn title(&self, language: Language) -> String;
    /// The first screen: what is wrong, how bad, what to do, what correction will bring.
    fn head(&self, facts: &Facts, language: Language) -> Markup;
    /// What the drawings show.
    fn sections(&self, language: Language) -> Vec<Section>;
    /// The figures.
    fn json(&self) -> Value;
    /// What is drawn.
    fn csv(&self) -> String;
}
