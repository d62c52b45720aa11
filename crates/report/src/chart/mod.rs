//! Drawings made of lines, dots, bars and cells.
//!
//! Each takes numbers and texts and gives an `svg` element that says what it shows (`title`, `desc`) and takes its colours
//! from the page's styles.

mod amounts;
mod bands;
mod bars;
mod cells;
mod curves;
mod dots;
mod fitted;
mod lines;
mod polar;
pub mod solid;

use diagnostic::{Language, Text, both};
use maud::{Markup, html};

pub use amounts::Amounts;
pub use bands::{Band, Bands, bands};
pub use bars::{Bar, Interval, Range, interval, ranges, waterfall};
pub use cells::{Matrix, Slice, matrix, slices};
pub use curves::{Curves, Histogram, curves, curves_with, histogram};
pub use dots::{Panel, Points, panels};
pub use fitted::{Fitted, fitted};
pub use lines::{Arrow, View, cumulative, views};
pub use polar::{Magnification, Polar, Round, polar};

use crate::scale::{Scale, px};
use crate::text::shown;

/// Width of every drawing, in its own units.
pub const WIDTH: f64 = 720.0;

/// Drawings that are higher than this share of their width have a printed page for themselves; of others two stand on one.
const TALL: f64 = 0.75;

/// An `svg` element with its words.
fn svg(language: Language, height: f64, title: &Text, description: &Text, body: &Markup) -> Markup {
    html! {
        svg.tall[height > TALL * WIDTH] xmlns="http://www.w3.org/2000/svg" viewBox={ "0 0 " (px(WIDTH)) " " (px(height)) } role="img" {
            (named(language, title, description, body))
        }
    }
}

/// A drawing that is legible as wide as a telephone; several stand side by side where there is room.
fn narrow(
    language: Language,
    (width, height): (f64, f64),
    title: &Text,
    description: &Text,
    body: &Markup,
) -> Markup {
    html! {
        svg.narrow xmlns="http://www.w3.org/2000/svg" viewBox={ "0 0 " (px(width)) " " (px(height)) } role="img" {
            (named(language, title, description, body))
        }
    }
}

fn named(language: Language, title: &Text, description: &Text, body: &Markup) -> Markup {
    html! {
        title { (shown(title.in_language(language))) }
        desc { (shown(description.in_language(language))) }
        (body)
    }
}

/// A line through places, in the drawing's units.
fn joined(places: impl IntoIterator<Item = (f64, f64)>) -> String {
    places.into_iter().fold(String::new(), |path, (x, y)| {
        let pen = if path.is_empty() { 'M' } else { 'L' };
        path + &format!("{pen}{} {}", px(x), px(y))
    })
}

/// Places as strokes of no length, which round ends make dots.
fn spotted(places: impl IntoIterator<Item = (f64, f64)>) -> String {
    places.into_iter().map(|(x, y)| format!("M{} {}h0", px(x), px(y))).collect()
}

fn text(x: f64, y: f64, class: &str, words: &str) -> Markup {
    html! { text x=(px(x)) y=(px(y)) class=(class) { (shown(words)) } }
}

/// A name left of a bar or a row. A telephone writes larger, but for long ones, for which there is no room.
fn name(x: f64, y: f64, class: &str, words: &str) -> Markup {
    const SHORT: usize = 18;
    let is_long = words.chars().count() > SHORT;
    text(x, y, &format!("{class}{}", if is_long { " long" } else { "" }), words)
}

/// A line with a head, where it is long enough for one to be seen.
fn with_head((x1, y1): (f64, f64), (x2, y2): (f64, f64)) -> String {
    /// Length of a head, and half its width as a part of that, drawing units.
    const HEAD: f64 = 5.0;
    const HALF: f64 = 0.45;
    /// Shorter lines are a direction without a head.
    const SHORTEST: f64 = 3.0;
    let mut path = format!("M{} {}L{} {}", px(x1), px(y1), px(x2), px(y2));
    let (dx, dy) = (x2 - x1, y2 - y1);
    let length = (dx * dx + dy * dy).sqrt();
    if length > SHORTEST {
        let head = HEAD.min(0.6 * length) / length;
        let (back, aside) = ((dx * head, dy * head), (-dy * head * HALF, dx * head * HALF));
        let side = |way: f64| (px(x2 - back.0 + way * aside.0), px(y2 - back.1 + way * aside.1));
        let (left, right) = (side(1.0), side(-1.0));
        path.push_str(&format!("M{} {}L{} {}L{} {}", left.0, left.1, px(x2), px(y2), right.0, right.1));
    }
    path
}

fn line(class: &str, (x1, y1): (f64, f64), (x2, y2): (f64, f64)) -> Markup {
    html! { path class=(class) d={ "M" (px(x1)) " " (px(y1)) "L" (px(x2)) " " (px(y2)) } {} }
}

fn rect(class: &str, (x, y): (f64, f64), width: f64, height: f64) -> Markup {
    html! { rect class=(class) x=(px(x)) y=(px(y)) width=(px(width.max(0.0))) height=(px(height)) {} }
}

/// Vertical lines and labels of a horizontal scale.
fn ticks_below(language: Language, scale: &Scale, count: usize, top: f64, bottom: f64) -> Markup {
    html! {
        @for (value, label) in scale.ticks(count, language) {
            (line("axis", (scale.at(value), top), (scale.at(value), bottom)))
            (text(scale.at(value), bottom + 14.0, "m c", &label))
        }
    }
}

/// Horizontal lines and labels of a vertical scale.
fn ticks_left(language: Language, scale: &Scale, count: usize, left: f64, right: f64) -> Markup {
    html! {
        @for (value, label) in scale.ticks(count, language) {
            (line("axis", (left, scale.at(value)), (right, scale.at(value))))
            (text(left - 5.0, scale.at(value) + 4.0, "m e", &label))
        }
    }
}

/// The legend of what was and of what is left.
fn before_and_after(language: Language, x: f64) -> Markup {
    legend(language, x, 14.0, &[("k1", both!("before", "до")), ("k0", both!("after", "после"))])
}

/// What an axis to the right and one up are called.
fn right_and_up([right, up]: [&str; 2]) -> Text {
    both!("{right} to the right, {up} up", "{right} вправо, {up} вверх")
}

/// Squares with words: what the colours mean.
fn legend(language: Language, x: f64, y: f64, entries: &[(&str, Text)]) -> Markup {
    // One text, so that entries follow one another however large the page writes them: on telephones larger.
    html! {
        text x=(px(x)) y=(px(y)) {
            @for (k, (class, words)) in entries.iter().enumerate() {
                tspan class=(class) dx=[(k > 0).then_some("14")] { "\u{25a0}" }
                tspan dx="4" { (shown(words.in_language(language))) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_from_files_are_escaped_in_drawings() {
        let hostile = "\"><script>alert(1)</script>";
        let hostile = Text::same(hostile);
        let bar = Bar { label: hostile.clone(), value: 1.0 };
        let drawing =
            waterfall(Language::English, &hostile, &[bar.clone(), bar], Some((0.5, &hostile))).into_string();
        assert!(!drawing.contains("<script") && drawing.contains("&lt;script&gt;"), "{drawing}");
    }

    #[test]
    fn arrows_have_a_head_where_it_is_seen() {
        assert_eq!(with_head((0.0, 0.0), (2.0, 0.0)), "M0 0L2 0");
        assert_eq!(with_head((0.0, 0.0), (20.0, 0.0)), "M0 0L20 0M15 2.3L20 0L15 -2.3");
    }

    #[test]
    fn nothing_that_is_no_number_is_written() {
        let bars = [
            Bar { label: Text::same("a"), value: f64::NAN },
            Bar { label: Text::same("b"), value: f64::INFINITY },
        ];
        let drawing = waterfall(Language::English, &Text::same("t"), &bars, None).into_string();
        assert!(!drawing.contains("NaN") && !drawing.contains("inf"), "{drawing}");
    }
}
