//! Readings over a variable, and the curve through them.

use diagnostic::{Language, Text};
use maud::{Markup, html};

use super::dots::{Points, dots};
use super::{WIDTH, joined, legend, line, rect, svg, text, ticks_below, ticks_left};
use crate::scale::Scale;

/// Readings with a curve.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Fitted {
    /// What runs along it, with its unit.
    pub label: Text,
    /// What was read: by colour, with what that colour means.
    pub points: Vec<(Points, Text)>,
    /// The curve, its places ascending, and what it is called.
    pub curve: (Vec<(f64, f64)>, Text),
}

const HEIGHT: f64 = 260.0;
const TOP: f64 = 30.0;
const LEFT: f64 = 52.0;
const RIGHT: f64 = WIDTH - 16.0;
/// Colours of dots in the legend; that of the curve is the fourth.
const KEYS: [&str; 4] = ["k0", "k1", "k2", "k3"];

/// Dots and a line through them, on a scale that has room for both and for zero.
#[must_use]
pub fn fitted(language: Language, title: &Text, described: &Text, f: &Fitted) -> Markup {
    let read = f.points.iter().flat_map(|(points, _)| &points.at);
    let all: Vec<(f64, f64)> =
        read.chain(&f.curve.0).copied().filter(|(a, b)| a.is_finite() && b.is_finite()).collect();
    let ends = |of: fn(&(f64, f64)) -> f64, from: (f64, f64)| {
        all.iter().map(of).fold(from, |(low, high), v| (low.min(v), high.max(v)))
    };
    let along = ends(|p| p.0, (f64::INFINITY, f64::NEG_INFINITY));
    let (low, high) = ends(|p| p.1, (0.0, 0.0));
    let margin = 0.06 * (high - low);
    let x = Scale::new(along, (LEFT + 10.0, RIGHT - 10.0));
    let y = Scale::new((low - margin, high + margin), (TOP + HEIGHT, TOP));
    let keys = f.points.iter().map(|(points, name)| (KEYS[points.series % KEYS.len()], name.clone()));
    let keys: Vec<(&str, Text)> = keys.chain([(KEYS[3], f.curve.1.clone())]).collect();
    let curve = joined(f.curve.0.iter().map(|(a, b)| (x.at(*a), y.at(*b))));
    let body = html! {
        (legend(language, LEFT, 14.0, &keys))
        (rect("frame", (LEFT, TOP), RIGHT - LEFT, HEIGHT))
        (ticks_left(language, &y, 7, LEFT, RIGHT))
        (ticks_below(language, &x, 8, TOP, TOP + HEIGHT))
        (line("zero", (LEFT, y.at(0.0)), (RIGHT, y.at(0.0))))
        path class="line s3" d=(curve) {}
        @for (points, _) in &f.points {
            path class={ "dots s" (points.series) } style="stroke-width:5" d=(dots(&points.at, &x, &y)) {}
        }
        (text(0.5 * (LEFT + RIGHT), TOP + HEIGHT + 30.0, "m c", f.label.in_language(language)))
    };
    svg(language, TOP + HEIGHT + 40.0, title, described, &body)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reading_is_a_dot_and_the_curve_one_line() {
        let points = Points { series: 1, at: vec![(0.0, 1.0), (1.0, 2.0), (2.0, f64::NAN)] };
        let f = Fitted {
            label: Text::same("Z"),
            points: vec![(points, Text::same("read"))],
            curve: (vec![(0.0, 1.0), (2.0, 3.0)], Text::same("fitted")),
        };
        let drawing = fitted(Language::English, &Text::same("t"), &Text::same("d"), &f).into_string();
        assert_eq!(drawing.matches("h0").count(), 2, "{drawing}");
        assert!(drawing.contains("class=\"line s3\" d=\"M62 ") && !drawing.contains("NaN"), "{drawing}");
    }
}
