//! Amounts as colours, and the key to them.

use diagnostic::{Language, Text, both};
use maud::{Markup, html};

use super::{rect, text};
use crate::numbers::number;
use crate::text::MICROMETRES;

/// Steps of lightness in the palette.
pub(super) const SHADES: usize = 10;
/// Width of a step in the key.
const STEP: f64 = 24.0;
/// From the colour of what is within the limit to the others.
const APART: f64 = 100.0;

/// How the amounts of a drawing are coloured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amounts<'a> {
    /// The end of the palette.
    pub largest: f64,
    /// What is not above this has one colour, outside the palette; and how that is said.
    pub within: Option<(f64, &'a Text)>,
}

impl Amounts<'_> {
    /// The class of an amount's colour.
    pub(super) fn class(&self, value: f64) -> String {
        let low = self.low();
        match self.within {
            Some((limit, _)) if value <= limit => "ok".to_owned(),
            _ => format!("h{}", shade(value - low, self.largest - low)),
        }
    }

    /// Where the palette begins.
    fn low(&self) -> f64 {
        self.within.map_or(0.0, |(limit, _)| limit)
    }

    /// The largest amount with its unit.
    pub(super) fn largest_said(&self) -> Text {
        let largest = number(self.largest);
        both!("{largest} {MICROMETRES}", "{largest:#} {MICROMETRES:#}")
    }

    /// How wide the key is.
    pub(super) fn width(&self) -> f64 {
        STEP * SHADES as f64 + self.within.map_or(0.0, |_| APART)
    }

    /// The key, with its upper left corner there.
    pub(super) fn key(&self, language: Language, (x, y): (f64, f64)) -> Markup {
        let from = x + self.within.map_or(0.0, |_| APART);
        html! {
            @if let Some((_, said)) = self.within {
                (rect("ok", (x, y), STEP, 10.0))
                (text(x, y + 24.0, "m", said.in_language(language)))
            }
            @if self.largest > self.low() || self.within.is_none() {
                @for k in 0..SHADES { (rect(&format!("h{k}"), (from + STEP * k as f64, y), STEP, 10.0)) }
                (text(from, y + 24.0, "m", self.within.map_or(Text::pair("0", "0"), |(limit, _)| number(limit)).in_language(language)))
                (text(from + STEP * SHADES as f64, y + 24.0, "m e", self.largest_said().in_language(language)))
            }
        }
    }
}

/// The step of an amount.
pub(super) fn shade(value: f64, largest: f64) -> usize {
    if largest <= 0.0 || !value.is_finite() {
        return 0;
    }
    ((value / largest * SHADES as f64).floor().max(0.0) as usize).min(SHADES - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_within_the_limit_is_outside_the_palette() {
        let all = Amounts { largest: 120.0, within: None };
        assert_eq!([0.0, 20.0, 119.0, 500.0].map(|value| all.class(value)), ["h0", "h1", "h9", "h9"]);
        let within = Text::same("within 20 um");
        let limited = Amounts { within: Some((20.0, &within)), ..all };
        assert_eq!([0.0, 20.0, 20.1, 119.0].map(|value| limited.class(value)), ["ok", "ok", "h0", "h9"]);
        let key = limited.key(Language::English, (0.0, 0.0)).into_string();
        assert!(key.contains("within 20 um") && key.contains(">20.0<") && key.contains(">120 µm<"), "{key}");
        // All of it is.
        let key = Amounts { largest: 12.0, ..limited }.key(Language::English, (0.0, 0.0)).into_string();
        assert!(key.contains("within 20 um") && !key.contains("h9"), "{key}");
    }
}
