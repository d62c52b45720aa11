//! Error vectors over the machine, and how often an error is smaller than.

use diagnostic::{Language, Text, both};
use maud::{Markup, html};

use super::{
    WIDTH, before_and_after, line, rect, right_and_up, spotted, svg, text, ticks_below, ticks_left, with_head,
};
use crate::numbers::{number, percent};
use crate::scale::{Scale, px};
use crate::text::MICROMETRES;

/// A displacement at a place, in the plane drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrow {
    /// Where, mm.
    pub at: (f64, f64),
    /// How far before, mm, magnified.
    pub before: (f64, f64),
    /// How far after, mm, magnified.
    pub after: (f64, f64),
}

/// One view along an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Names of the axis to the right and the axis up.
    pub axes: [&'static str; 2],
    /// Ranges of both, mm.
    pub ranges: [(f64, f64); 2],
    /// What is drawn in it.
    pub arrows: Vec<Arrow>,
}

/// The unit of places.
static MILLIMETRES: Text = Text::pair("mm", "мм");

const SIDE: f64 = 190.0;
const TOP: f64 = 30.0;

/// Views side by side, each on its own scale, lengths along both of its axes equal.
#[must_use]
pub fn views(language: Language, title: &Text, all: &[View], magnification: f64) -> Markup {
    let left = |at: usize| 40.0 + at as f64 * (SIDE + 48.0);
    let body = html! {
        (before_and_after(language, 40.0))
        @for (at, view) in all.iter().enumerate() {
            @let spans = view.ranges.map(|(low, high)| high - low);
            @let half = 0.64 * spans[0].max(spans[1]).max(1.0);
            @let middle = view.ranges.map(|(low, high)| 0.5 * (low + high));
            @let x = Scale::new((middle[0] - half, middle[0] + half), (left(at), left(at) + SIDE));
            @let y = Scale::new((middle[1] - half, middle[1] + half), (TOP + SIDE, TOP));
            (rect("frame", (left(at), TOP), SIDE, SIDE))
            (ticks_below(language, &x, 4, TOP, TOP + SIDE))
            (ticks_left(language, &y, 4, left(at), left(at) + SIDE))
            (text(left(at) + 0.5 * SIDE, TOP + SIDE + 29.0, "m c", Text::join([&right_and_up(view.axes), &MILLIMETRES], ", ").in_language(language)))
            path class="line s1" d=(strokes(view, &x, &y, |a| a.before)) {}
            path class="line s0" d=(strokes(view, &x, &y, |a| a.after)) {}
            path class="dots s3" style="stroke-width:2" d=(feet(view, &x, &y)) {}
        }
    };
    let times = number(magnification);
    let described = both!(
        "errors drawn {times} times their size from the commanded point",
        "погрешности отложены от заданной точки, увеличение {times:#}\u{d7}"
    );
    svg(language, TOP + SIDE + 36.0, title, &described, &body)
}

fn strokes(view: &View, x: &Scale, y: &Scale, which: impl Fn(&Arrow) -> (f64, f64)) -> String {
    let mut path = String::new();
    for arrow in &view.arrows {
        let (right, up) = which(arrow);
        let end = (arrow.at.0 + right, arrow.at.1 + up);
        if end.0.is_finite() && end.1.is_finite() {
            let (from, to) = ((x.at(arrow.at.0), y.at(arrow.at.1)), (x.at(end.0), y.at(end.1)));
            path.push_str(&with_head(from, to));
        }
    }
    path
}

fn feet(view: &View, x: &Scale, y: &Scale) -> String {
    spotted(view.arrows.iter().map(|a| (x.at(a.at.0), y.at(a.at.1))))
}

/// Share of the rows that lie below an amount, before and after, with a limit if there is one. Both lists ascend.
#[must_use]
pub fn cumulative(
    language: Language,
    title: &Text,
    before: &[f64],
    after: &[f64],
    limit: Option<(f64, &Text)>,
) -> Markup {
    let (left, right, top, bottom) = (60.0, WIDTH - 20.0, 42.0, 242.0);
    let largest = before.last().copied().unwrap_or(1.0).max(limit.map_or(0.0, |l| 1.1 * l.0));
    let x = Scale::new((0.0, largest), (left, right));
    let y = Scale::new((0.0, 1.0), (bottom, top));
    let below = |values: &[f64]| {
        limit.map(|(l, _)| values.iter().filter(|v| **v <= l).count() as f64 / values.len().max(1) as f64)
    };
    let size = both!("size of the gap of a row, {MICROMETRES}", "расхождение в строке, {MICROMETRES:#}");
    let body = html! {
        (before_and_after(language, left))
        (rect("frame", (left, top), right - left, bottom - top))
        (ticks_below(language, &x, 7, top, bottom))
        @for share in [0.0, 0.25, 0.5, 0.75, 0.95, 1.0] {
            (line("axis", (left, y.at(share)), (right, y.at(share))))
            @if (share - 0.95_f64).abs() > 1e-9 { (text(left - 6.0, y.at(share) + 4.0, "m e", percent(share).in_language(language))) }
        }
        (text(left - 6.0, y.at(0.95) + 9.0, "m e", "95 %"))
        path class="line s1" d=(steps(before, &x, &y)) {}
        path class="line s0" d=(steps(after, &x, &y)) {}
        @if let Some((value, name)) = limit {
            (line("limit", (x.at(value), top), (x.at(value), bottom)))
            (text(x.at(value), top - 7.0, "", Text::join([name, &number(value), &MICROMETRES], " ").in_language(language)))
        }
        (text(0.5 * (left + right), bottom + 30.0, "m c", size.in_language(language)))
    };
    let described = match (below(before), below(after), limit) {
        (Some(b), Some(a), Some((l, _))) => {
            let (b, l, a) = (percent(b), number(l), percent(a));
            both!(
                "{b} of the rows are below {l} {MICROMETRES} before, {a} after",
                "ниже {l:#} {MICROMETRES:#}: {b:#} строк до, {a:#} после"
            )
        }
        _ => {
            let largest = number(largest);
            both!("largest {largest} {MICROMETRES} before", "наибольшее до: {largest:#} {MICROMETRES:#}")
        }
    };
    svg(language, bottom + 38.0, title, &described, &body)
}

/// Points of a curve are as many as can be seen.
const MOST: usize = 240;

fn steps(values: &[f64], x: &Scale, y: &Scale) -> String {
    let count = values.len();
    let mut path = format!("M{} {}", px(x.at(0.0)), px(y.at(0.0)));
    let every = count.div_ceil(MOST).max(1);
    for (at, value) in values.iter().enumerate().filter(|(at, _)| (at + 1) % every == 0 || at + 1 == count) {
        path.push_str(&format!("H{}V{}", px(x.at(*value)), px(y.at((at + 1) as f64 / count as f64))));
    }
    path.push_str(&format!("H{}", px(x.to)));
    path
}
