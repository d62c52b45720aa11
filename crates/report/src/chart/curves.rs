//! Curves over a variable, and how often an amount occurs.

use diagnostic::{Language, Text, both};
use maud::{Markup, html};

use super::{WIDTH, before_and_after, legend, line, rect, svg, text, ticks_below, ticks_left};
use crate::numbers::{count, number};
use crate::scale::{Scale, px};
use crate::text::MICROMETRES;

/// Values over a variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// What runs along it, with its unit.
    pub label: Text,
    /// Places along it, ascending.
    pub at: Vec<f64>,
    /// For each series its values at these places.
    pub values: Vec<Vec<f64>>,
}

/// How many of the values lie in each of equally wide classes.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Upper end of the last class; the first begins at 0.
    pub largest: f64,
    /// Counts before.
    pub before: Vec<u64>,
    /// Counts after.
    pub after: Vec<u64>,
}

const HEIGHT: f64 = 130.0;
const STEP: f64 = HEIGHT + 46.0;
const TOP: f64 = 30.0;
const LEFT: f64 = 52.0;
const RIGHT: f64 = WIDTH - 16.0;

/// Panels below each other, all on one vertical scale, so that sizes can be compared.
///
/// * `series` – classes and names of the series, as many as every panel has
#[must_use]
pub fn curves(language: Language, title: &Text, panels: &[Curves], series: &[(&str, Text)]) -> Markup {
    let (low, high) = reach(panels);
    let [low, high] = [low, high].map(number);
    let described = both!(
        "from {low} to {high} {MICROMETRES}, one scale for all",
        "от {low:#} до {high:#} {MICROMETRES:#}, общая шкала"
    );
    curves_with(language, title, &described, panels, series)
}

/// Least and largest value, zero among them.
fn reach(panels: &[Curves]) -> (f64, f64) {
    let all = || panels.iter().flat_map(|p| p.values.iter().flatten()).copied().filter(|v| v.is_finite());
    (all().fold(0.0, f64::min), all().fold(0.0, f64::max))
}

/// [`curves`] with a description of one's own.
#[must_use]
pub fn curves_with(
    language: Language,
    title: &Text,
    described: &Text,
    panels: &[Curves],
    series: &[(&str, Text)],
) -> Markup {
    let (low, high) = reach(panels);
    let margin = 0.06 * (high - low);
    let classes: Vec<String> = series.iter().map(|(class, _)| class.replace('s', "k")).collect();
    let keys: Vec<(&str, Text)> =
        classes.iter().zip(series).map(|(class, (_, words))| (class.as_str(), words.clone())).collect();
    let body = html! {
        (legend(language, LEFT, 14.0, &keys))
        @for (row, panel) in panels.iter().enumerate() {
            @let top = TOP + STEP * row as f64;
            @let ends = (panel.at.first().copied().unwrap_or(0.0), panel.at.last().copied().unwrap_or(1.0));
            @let x = Scale::new(ends, (LEFT + 4.0, RIGHT - 4.0));
            @let y = Scale::new((low - margin, high + margin), (top + HEIGHT, top));
            (rect("frame", (LEFT, top), RIGHT - LEFT, HEIGHT))
            (ticks_left(language, &y, 5, LEFT, RIGHT))
            (ticks_below(language, &x, 8, top, top + HEIGHT))
            (line("zero", (LEFT, y.at(0.0)), (RIGHT, y.at(0.0))))
            @for ((class, _), values) in series.iter().zip(&panel.values) {
                path class={ "line " (class) } d=(path(&panel.at, values, &x, &y)) {}
            }
            (text(0.5 * (LEFT + RIGHT), top + HEIGHT + 30.0, "m c", panel.label.in_language(language)))
        }
    };
    svg(language, TOP + STEP * panels.len() as f64, title, described, &body)
}

/// A line through the values; where one is not known it is broken.
fn path(at: &[f64], values: &[f64], x: &Scale, y: &Scale) -> String {
    let (mut path, mut joined) = (String::new(), false);
    for (k, (at, value)) in at.iter().zip(values).enumerate() {
        if value.is_finite() {
            path.push(if joined { 'L' } else { 'M' });
            path.push_str(&format!("{} {}", px(x.at(*at)), px(y.at(*value))));
            // A place without neighbours would be no line: a dash as wide as a dot.
            if !joined && values.get(k + 1).is_none_or(|next| !next.is_finite()) {
                path.push_str("m-2 0h4");
            }
        }
        joined = value.is_finite();
    }
    path
}

/// Columns: filled before, outlined after.
#[must_use]
pub fn histogram(
    language: Language,
    title: &Text,
    h: &Histogram,
    limit: Option<(f64, &Text)>,
    [label, counted]: [&Text; 2],
) -> Markup {
    let (top, bottom) = (36.0, 226.0);
    let most = h.before.iter().chain(&h.after).copied().max().unwrap_or(0).max(1);
    let x = Scale::new((0.0, h.largest), (LEFT, RIGHT));
    let y = Scale::new((0.0, most as f64 * 1.05), (bottom, top));
    let width = (RIGHT - LEFT) / h.before.len().max(1) as f64;
    let outline = h.after.iter().enumerate().fold(format!("M{} {}", px(LEFT), px(bottom)), |path, (k, n)| {
        path + &format!("V{}H{}", px(y.at(*n as f64)), px(LEFT + width * (k + 1) as f64))
    });
    let body = html! {
        (before_and_after(language, LEFT))
        (text(LEFT - 5.0, top - 8.0, "m e", counted.in_language(language)))
        (rect("frame", (LEFT, top), RIGHT - LEFT, bottom - top))
        (ticks_left(language, &y, 5, LEFT, RIGHT))
        (ticks_below(language, &x, 10, top, bottom))
        @for (k, n) in h.before.iter().enumerate().filter(|(_, n)| **n > 0) {
            @let up = y.at(*n as f64);
            (rect("gone", (LEFT + width * k as f64 + 0.5, up), width - 1.0, bottom - up))
        }
        path class="line s0" style="stroke-width:2" d={ (outline) "V" (px(bottom)) } {}
        @if let Some((value, name)) = limit.filter(|(value, _)| *value <= h.largest) {
            @let words = Text::join([name, &number(value), &MICROMETRES], " ");
            (line("limit", (x.at(value), top), (x.at(value), bottom)))
            (text(x.at(value) + 4.0, top - 6.0, "", words.in_language(language)))
        }
        (text(0.5 * (LEFT + RIGHT), bottom + 30.0, "m c", label.in_language(language)))
    };
    let [before, after] = [&h.before, &h.after].map(|counts| count(counts.iter().sum::<u64>()));
    let described =
        both!("{before} values before, {after} after", "значений до: {before:#}, после: {after:#}");
    svg(language, bottom + 38.0, title, &described, &body)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_not_bridged() {
        let scale = Scale::new((0.0, 10.0), (0.0, 10.0));
        let at: Vec<f64> = (0..6).map(f64::from).collect();
        let drawn = path(&at, &[1.0, 2.0, f64::NAN, f64::NAN, 3.0, 4.0], &scale, &scale);
        assert_eq!(drawn, "M0 1L1 2M4 3L5 4");
    }
}
