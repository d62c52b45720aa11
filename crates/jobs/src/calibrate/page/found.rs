//! What every calibration's page is made of.

use diagnostic::Text;
use report::body::Body;
use report::page::Page;
use serde_json::Value;

use super::facts::Facts;

/// A calibration that can be shown.
pub(in super::super) trait Found {
    /// `positioning`, `ball bar`: title of the page.
    fn title(&self) -> Text;
    /// The first screen: what is wrong, how bad, what to do, what correction will bring.
    fn head(&self, out: &mut Body, facts: &Facts);
    /// What the drawings show.
    fn sections(&self, page: &mut Page);
    /// The figures.
    fn json(&self) -> Value;
    /// What is drawn.
    fn csv(&self) -> String;
}
