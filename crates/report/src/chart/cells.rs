//! Cells coloured or shaded by an amount: slices through the machine, and tables of likeness.

use diagnostic::{Language, Text, both};
use maud::{Markup, html};

use super::amounts::{Amounts, shade};
use super::{WIDTH, rect, right_and_up, svg, text};
use crate::numbers::{digits, number};
use crate::scale::{Scale, px};
use crate::text::short;

/// Mean amounts over a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Which plane.
    pub title: Text,
    /// Names of the axis to the right and the axis up.
    pub axes: [&'static str; 2],
    /// Ranges of both.
    pub ranges: [(f64, f64); 2],
    /// Cells to the right and up.
    pub cells: [usize; 2],
    /// Amounts, row by row from below; `None` where nothing was measured.
    pub values: Vec<Option<f64>>,
}

/// How alike things are, 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// Names of the rows.
    pub rows: Vec<Text>,
    /// Names of the columns.
    pub columns: Vec<Text>,
    /// Row by row; `None` where it was not asked.
    pub values: Vec<Option<f64>>,
    /// From here on two things cannot be told apart.
    pub limit: f64,
}

const PER_ROW: usize = 3;
const SIDE: f64 = 168.0;

/// Slices, three in a row, all coloured alike.
#[must_use]
pub fn slices(language: Language, title: &Text, all: &[Slice], amounts: &Amounts<'_>) -> Markup {
    let step = (SIDE + 68.0, SIDE + 64.0);
    let place = |at: usize| (46.0 + step.0 * (at % PER_ROW) as f64, 22.0 + step.1 * (at / PER_ROW) as f64);
    let largest = amounts.largest_said();
    let unmeasured = both!("not measured", "не измерялось");
    let height = 22.0 + step.1 * all.len().div_ceil(PER_ROW) as f64;
    let body = html! {
        @for (at, slice) in all.iter().enumerate() {
            @let (left, top) = place(at);
            @let x = Scale::new(slice.ranges[0], (left, left + SIDE));
            @let y = Scale::new(slice.ranges[1], (top + SIDE, top));
            @let size = [SIDE / slice.cells[0].max(1) as f64, SIDE / slice.cells[1].max(1) as f64];
            (text(left, top - 6.0, "", slice.title.in_language(language)))
            @for (cell, value) in slice.values.iter().enumerate() {
                @let column = (cell % slice.cells[0].max(1)) as f64;
                @let row = (cell / slice.cells[0].max(1)) as f64;
                @let corner = (left + column * size[0], top + SIDE - (row + 1.0) * size[1]);
                @let class = value.map_or_else(|| "cell none".to_owned(), |v| format!("cell {}", amounts.class(v)));
                (rect(&class, corner, size[0], size[1]))
            }
            @for (value, label) in x.ticks(3, language) { (text(x.at(value), top + SIDE + 14.0, "m c", &label)) }
            @for (value, label) in y.ticks(3, language) { (text(left - 5.0, y.at(value) + 4.0, "m e", &label)) }
            (text(left + 0.5 * SIDE, top + SIDE + 28.0, "m c", right_and_up(slice.axes).in_language(language)))
        }
        (amounts.key(language, (46.0, height)))
        @if all.iter().any(|slice| slice.values.iter().any(Option::is_none)) {
            @let behind = 46.0 + amounts.width() + 44.0;
            (rect("cell none", (behind, height), 24.0, 10.0))
            (text(behind + 30.0, height + 9.0, "m", unmeasured.in_language(language)))
        }
    };
    let described = both!(
        "one scale for all slices, 0 to {largest}",
        "общая шкала для всех сечений, от 0 до {largest:#}"
    );
    svg(language, height + 30.0, title, &described, &body)
}

/// A table of likeness, darker where more alike.
#[must_use]
pub fn matrix(language: Language, title: &Text, m: &Matrix) -> Markup {
    const LEFT: f64 = 176.0;
    const TOP: f64 = 132.0;
    let width = ((WIDTH - LEFT - 70.0) / m.columns.len().max(1) as f64).min(46.0);
    let height = 24.0;
    let text_size = if width < 30.0 { "font-size:9px" } else { "font-size:11px" };
    let body = html! {
        @for (column, name) in m.columns.iter().enumerate() {
            @let (name, x) = (name.in_language(language), LEFT + (column as f64 + 0.5) * width + 4.0);
            text.long[name.chars().count() > 14] x=(px(x)) y=(px(TOP - 6.0)) transform={ "rotate(-55 " (px(x)) " " (px(TOP - 6.0)) ")" } { (short(name, 24)) }
        }
        @for (row, name) in m.rows.iter().enumerate() {
            @let y = TOP + row as f64 * height;
            (super::name(LEFT - 8.0, y + 16.0, "e", &short(name.in_language(language), 24)))
            @for column in 0..m.columns.len() {
                @let x = LEFT + column as f64 * width;
                @match m.values.get(row * m.columns.len() + column).copied().flatten() {
                    None => (rect("cell none", (x, y), width, height)),
                    Some(value) => {
                        @let shade = shade(value, 1.0);
                        (rect(&format!("cell h{shade}"), (x, y), width, height))
                        @if value >= m.limit { (rect("whisker", (x + 1.5, y + 1.5), width - 3.0, height - 3.0)) }
                        text.c.(if shade < 5 { "on0" } else { "on1" }) x=(px(x + 0.5 * width)) y=(px(y + 16.0)) style=(text_size) {
                            (digits(value, 2).in_language(language))
                        }
                    }
                }
            }
        }
    };
    let alike = m.values.iter().flatten().filter(|v| **v >= m.limit).count();
    let limit = number(m.limit);
    let described =
        both!("{alike} pairs are more alike than {limit}", "пар, сходных больше чем на {limit:#}: {alike}");
    svg(language, TOP + height * m.rows.len() as f64 + 8.0, title, &described, &body)
}
