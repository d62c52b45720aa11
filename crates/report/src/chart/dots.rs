//! Dots over a variable, in panels side by side.

use diagnostic::{Language, Text, both};
use maud::{Markup, html};

use super::{WIDTH, legend, line, rect, spotted, svg, text, ticks_below, ticks_left};
use crate::numbers::number;
use crate::scale::Scale;
use crate::text::MICROMETRES;

/// Dots of one colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// 0 to 3: which colour.
    pub series: usize,
    /// Places.
    pub at: Vec<(f64, f64)>,
}

/// One panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// What runs along it, with its unit.
    pub label: Text,
    /// Range of that.
    pub range: (f64, f64),
    /// The dots.
    pub points: Vec<Points>,
}

const HEIGHT: f64 = 96.0;
const STEP: f64 = HEIGHT + 40.0;
const TOP: f64 = 44.0;
const LEFT: f64 = 44.0;
const GAP: f64 = 40.0;

/// Panels in rows of columns, all on one vertical scale of `reach` above and below zero, so that sizes can be compared.
#[must_use]
pub fn panels(
    language: Language,
    title: &Text,
    columns: &[Text],
    rows: &[Vec<Panel>],
    reach: f64,
    series: &[(&str, Text)],
) -> Markup {
    let count = columns.len().max(1) as f64;
    let width = (WIDTH - LEFT - 18.0 - GAP * (count - 1.0)) / count;
    let left = |column: usize| LEFT + column as f64 * (width + GAP);
    let names = |and: &str| columns.iter().map(Text::english).collect::<Vec<_>>().join(and);
    let russian: Vec<&str> = columns.iter().map(|name| name.in_language(Language::Russian)).collect();
    let names = Text::new(names(" and "), russian.join(" и "));
    let reach_said = number(reach);
    let described = both!(
        "{names}; vertical scale \u{b1}{reach_said} {MICROMETRES}",
        "{names:#}; вертикальная шкала \u{b1}{reach_said:#} {MICROMETRES:#}"
    );
    let body = html! {
        (legend(language, LEFT, 14.0, series))
        @for (column, name) in columns.iter().enumerate() {
            (text(left(column), TOP - 8.0, "", Text::join([name, &MICROMETRES], ", ").in_language(language)))
        }
        @for (row, panels) in rows.iter().enumerate() {
            @let top = TOP + STEP * row as f64;
            @for (column, panel) in panels.iter().enumerate() {
                @let x = Scale::new(panel.range, (left(column) + 4.0, left(column) + width - 4.0));
                @let y = Scale::new((-reach, reach), (top + HEIGHT, top));
                (rect("frame", (left(column), top), width, HEIGHT))
                (ticks_left(language, &y, 4, left(column), left(column) + width))
                (ticks_below(language, &x, 5, top, top + HEIGHT))
                (line("zero", (left(column), y.at(0.0)), (left(column) + width, y.at(0.0))))
                @for points in &panel.points {
                    path class={ "dots s" (points.series) } d=(dots(&points.at, &x, &y)) {}
                }
                (text(left(column) + 0.5 * width, top + HEIGHT + 27.0, "m c", panel.label.in_language(language)))
            }
        }
    };
    svg(language, TOP + STEP * rows.len() as f64, title, &described, &body)
}

/// Dots as one path: strokes of no length with round ends.
pub(super) fn dots(at: &[(f64, f64)], x: &Scale, y: &Scale) -> String {
    let known = at.iter().filter(|(a, b)| a.is_finite() && b.is_finite());
    spotted(known.map(|(a, b)| (x.at(*a), y.at(*b))))
}
