//! Repeated runs over an axis, with their means and what the scatter adds to them: the diagram of ISO 230-2.

use diagnostic::{Language, Text, both};
use maud::{Markup, html};

use super::{WIDTH, joined, legend, line, rect, spotted, svg, text, ticks_below, ticks_left};
use crate::numbers::number;
use crate::scale::Scale;
use crate::text::MICROMETRES;

/// One direction: what it was at each place.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Band {
    /// What the legend calls it; single runs take the same colour.
    pub name: Text,
    /// Single runs, each with a value for every place.
    pub runs: Vec<Vec<f64>>,
    /// Mean at each place.
    pub mean: Vec<f64>,
    /// Lower and upper limit at each place; none where one run says nothing of the scatter.
    pub limits: Option<[Vec<f64>; 2]>,
}

/// Everything in one drawing.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Bands {
    /// What runs along it, with its unit.
    pub label: Text,
    /// Places along it, ascending.
    pub at: Vec<f64>,
    /// One for each direction, two at most.
    pub bands: Vec<Band>,
    /// What the distance between the outermost limits is called: `A 12.3 µm`.
    pub span: Option<Text>,
}

const HEIGHT: f64 = 300.0;
const TOP: f64 = 34.0;
const LEFT: f64 = 56.0;
const RIGHT: f64 = WIDTH - 96.0;

/// Thin lines for runs, strong ones for means, shaded bands for the limits.
#[must_use]
pub fn bands(language: Language, title: &Text, d: &Bands) -> Markup {
    let of_band = |b: &Band| -> Vec<f64> {
        let limits = b.limits.iter().flatten().flatten();
        b.runs.iter().flatten().chain(&b.mean).chain(limits).copied().filter(|v| v.is_finite()).collect()
    };
    let all: Vec<f64> = d.bands.iter().flat_map(of_band).collect();
    let (low, high) = (all.iter().copied().fold(0.0, f64::min), all.iter().copied().fold(0.0, f64::max));
    let margin = 0.06 * (high - low);
    let ends = (d.at.first().copied().unwrap_or(0.0), d.at.last().copied().unwrap_or(1.0));
    let x = Scale::new(ends, (LEFT + 12.0, RIGHT - 12.0));
    let y = Scale::new((low - margin, high + margin), (TOP + HEIGHT, TOP));
    let keys: Vec<(&str, Text)> =
        d.bands.iter().enumerate().map(|(k, b)| (["k0", "k1"][k % 2], b.name.clone())).collect();
    let body = html! {
        (legend(language, LEFT, 14.0, &keys))
        (rect("frame", (LEFT, TOP), RIGHT - LEFT, HEIGHT))
        (ticks_left(language, &y, 7, LEFT, RIGHT))
        (ticks_below(language, &x, 8, TOP, TOP + HEIGHT))
        (line("zero", (LEFT, y.at(0.0)), (RIGHT, y.at(0.0))))
        @for (k, band) in d.bands.iter().enumerate() {
            @if let Some(limits) = &band.limits {
                path class={ "shade k" (k % 2) } d=(outline(&d.at, limits, &x, &y)) {}
            }
        }
        @for (k, band) in d.bands.iter().enumerate() {
            @for run in &band.runs { path class={ "run s" (k % 2) } d=(joined(known(&d.at, run, &x, &y))) {} }
        }
        @for (k, band) in d.bands.iter().enumerate() {
            path class={ "mean s" (k % 2) } d=(joined(known(&d.at, &band.mean, &x, &y))) {}
            path class={ "dots s" (k % 2) } style="stroke-width:6" d=(spotted(known(&d.at, &band.mean, &x, &y))) {}
        }
        (span(language, d, &y))
        (text(4.0, TOP - 6.0, "m", MICROMETRES.in_language(language)))
        (text(0.5 * (LEFT + RIGHT), TOP + HEIGHT + 31.0, "m c", d.label.in_language(language)))
    };
    let [low, high] = [low, high].map(number);
    let described = both!("from {low} to {high} {MICROMETRES}", "от {low:#} до {high:#} {MICROMETRES:#}");
    svg(language, TOP + HEIGHT + 40.0, title, &described, &body)
}

/// A bracket beside the frame, from the lowest limit to the highest.
fn span(language: Language, d: &Bands, y: &Scale) -> Markup {
    let limits = |which: usize| {
        let of = move |b: &'_ Band| b.limits.as_ref().map_or(&b.mean, |l| &l[which]).clone();
        d.bands.iter().flat_map(of)
    };
    let (low, high) = (limits(0).fold(f64::INFINITY, f64::min), limits(1).fold(f64::NEG_INFINITY, f64::max));
    html! {
        @if let Some(words) = d.span.as_ref().filter(|_| high >= low) {
            (line("limit", (LEFT, y.at(high)), (RIGHT + 16.0, y.at(high))))
            (line("limit", (LEFT, y.at(low)), (RIGHT + 16.0, y.at(low))))
            (line("whisker", (RIGHT + 10.0, y.at(low)), (RIGHT + 10.0, y.at(high))))
            (text(RIGHT + 16.0, 0.5 * (y.at(low) + y.at(high)) + 4.0, "", words.in_language(language)))
        }
    }
}

/// The places of what is known.
fn known<'a>(
    at: &'a [f64],
    values: &'a [f64],
    x: &'a Scale,
    y: &'a Scale,
) -> impl Iterator<Item = (f64, f64)> + 'a {
    at.iter().zip(values).filter(|(_, v)| v.is_finite()).map(|(at, value)| (x.at(*at), y.at(*value)))
}

/// Along the upper limit and back along the lower.
fn outline(at: &[f64], [low, high]: &[Vec<f64>; 2], x: &Scale, y: &Scale) -> String {
    let there = known(at, high, x, y);
    let back: Vec<(f64, f64)> = known(at, low, x, y).collect();
    format!("{}Z", joined(there.chain(back.into_iter().rev())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_run_and_every_limit_is_drawn() {
        let band = Band {
            name: Text::same("up"),
            runs: vec![vec![0.0, 1.0], vec![0.0, 3.0]],
            mean: vec![0.0, 2.0],
            limits: Some([vec![0.0, -1.0], vec![0.0, 5.0]]),
        };
        let d = Bands {
            at: vec![0.0, 10.0],
            bands: vec![band],
            span: Some(Text::same("A 6")),
            ..Bands::default()
        };
        let drawing = bands(Language::English, &Text::same("t"), &d).into_string();
        assert_eq!(drawing.matches("class=\"run s0\"").count(), 2);
        assert_eq!(drawing.matches("class=\"shade k0\"").count(), 1);
        assert!(drawing.contains("A 6"));
        let once = Bands { bands: vec![Band { limits: None, ..d.bands[0].clone() }], span: None, ..d };
        let drawing = bands(Language::English, &Text::same("t"), &once).into_string();
        assert!(!drawing.contains("shade") && !drawing.contains("whisker"), "one run has no limits");
    }
}
