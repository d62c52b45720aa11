//! The machine's volume seen from a corner: places coloured by an amount, arrows, paths.

use diagnostic::{Language, say};
use maud::{Markup, html};

use super::{WIDTH, before_and_after, cells, legend, line, svg, text};
use crate::scale::px;
use crate::text::Numbers;

/// A box that is drawn from a corner, X to the lower right, Y to the upper right, Z up.
///
/// An isometric view: lengths along all three axes are shortened by the same amount, so they can be compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Ranges of X, Y and Z.
    pub ranges: [(f64, f64); 3],
}

/// An amount at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// X, Y, Z.
    pub at: [f64; 3],
    /// How much.
    pub value: f64,
}

/// A stretch of a path with an amount.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// Its places.
    pub places: Vec<[f64; 3]>,
    /// How much.
    pub value: f64,
}

/// Displacements at a place, drawn magnified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displacement {
    /// X, Y, Z.
    pub at: [f64; 3],
    /// Before, already magnified.
    pub before: [f64; 3],
    /// After, already magnified.
    pub after: [f64; 3],
}

/// cos 30°.
const COS: f64 = 0.866_025_403_784_438_6;
const HIGHEST: f64 = 420.0;
const TOP: f64 = 40.0;

/// From millimetres to the drawing.
struct Placed {
    solid: Solid,
    scale: f64,
    shift: (f64, f64),
    bottom: f64,
}

impl Solid {
    /// `room`: share of the box's size left free around it for what reaches out of it.
    fn placed(self, room: f64) -> Placed {
        let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(|k| flat(self.corner(k)));
        let of = |pick: fn(&(f64, f64)) -> f64, fold: fn(f64, f64) -> f64| {
            corners.iter().map(pick).reduce(fold).unwrap_or(0.0)
        };
        let (left, right) = (of(|c| c.0, f64::min), of(|c| c.0, f64::max));
        let (low, high) = (of(|c| c.1, f64::min), of(|c| c.1, f64::max));
        let size = ((right - left).max(1e-9), (high - low).max(1e-9));
        let scale = ((WIDTH - 110.0) / size.0).min(HIGHEST / size.1) / (1.0 + 2.0 * room);
        let height = size.1 * scale * (1.0 + 2.0 * room);
        let middle = (0.5 * (left + right), 0.5 * (low + high));
        let shift = (0.5 * WIDTH - middle.0 * scale, TOP + 0.5 * height + middle.1 * scale);
        Placed { solid: self, scale, shift, bottom: TOP + height }
    }

    /// Corner number `k`, an axis per bit.
    fn corner(&self, k: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { self.ranges[axis].1 } else { self.ranges[axis].0 })
    }
}

/// To the right and up, in millimetres.
fn flat([x, y, z]: [f64; 3]) -> (f64, f64) {
    ((x + y) * COS, (y - x) * 0.5 + z)
}

impl Placed {
    fn at(&self, place: [f64; 3]) -> (f64, f64) {
        let (right, up) = flat(place);
        (self.shift.0 + right * self.scale, self.shift.1 - up * self.scale)
    }

    /// Edges that are behind everything, and those in front of it.
    fn edges(&self, front: bool) -> Markup {
        // Seen from high X, low Y and above: hidden is the corner at low X, high Y, low Z.
        const HIDDEN: usize = 0b010;
        html! {
            @for from in 0..8usize {
                @for axis in 0..3usize {
                    @let to = from | 1 << axis;
                    @if to != from && (from == HIDDEN || to == HIDDEN) != front {
                        (line("zero", self.at(self.solid.corner(from)), self.at(self.solid.corner(to))))
                    }
                }
            }
        }
    }

    /// Names and ends of the axes along the edges that the eye meets first.
    fn labels(&self, language: Language) -> Markup {
        let corner = |k: usize| self.solid.corner(k);
        // X along the lower left edge, Y along the lower right one, Z at the right.
        let edges =
            [(0, 0b000, 0b001, -14.0, 16.0), (1, 0b001, 0b011, 12.0, 16.0), (2, 0b011, 0b111, 10.0, 4.0)];
        html! {
            @for (axis, from, to, right, down) in edges {
                @let (low, high) = self.solid.ranges[axis];
                @let class = if axis == 0 { "m e halo" } else { "m halo" };
                @let (a, b) = (self.at(corner(from)), self.at(corner(to)));
                @for (value, share) in [(low, 0.1), (high, 0.9)] {
                    @let here = (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1));
                    (text(here.0 + right, here.1 + down, class, &language.digits(value, 0)))
                }
                (text(0.5 * (a.0 + b.0) + 1.4 * right, 0.5 * (a.1 + b.1) + 1.2 * down, if axis == 0 { "e halo" } else { "halo" },
                    &format!("{}, {}", ["X", "Y", "Z"][axis], say!(language, "mm", "мм"))))
            }
        }
    }
}

/// Colours of the amounts, below a drawing.
fn key(language: Language, y: f64, largest: f64, unit: &str) -> Markup {
    html! {
        @for k in 0..cells::SHADES {
            (super::rect(&format!("h{k}"), (LEFT + 24.0 * k as f64, y), 24.0, 10.0))
        }
        (text(LEFT, y + 24.0, "m", "0"))
        (text(LEFT + 24.0 * cells::SHADES as f64, y + 24.0, "m e", &format!("{} {unit}", language.number(largest))))
    }
}

const LEFT: f64 = 46.0;

/// Places coloured by an amount, from zero to `largest`, the near ones over the far ones.
#[must_use]
pub fn spots(
    language: Language,
    title: &str,
    solid: Solid,
    all: &[Spot],
    largest: f64,
    unit: &str,
) -> Markup {
    let placed = solid.placed(0.04);
    let mut order: Vec<&Spot> = all.iter().collect();
    let depth = |s: &Spot| s.at[0] - s.at[1] + s.at[2];
    order.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
    let body = html! {
        (placed.edges(false))
        @for spot in order {
            @let (x, y) = placed.at(spot.at);
            circle class={ "spot h" (cells::shade(spot.value, largest)) } cx=(px(x)) cy=(px(y)) r="3.4" {}
        }
        (placed.edges(true))
        (placed.labels(language))
        (key(language, placed.bottom + 34.0, largest, unit))
    };
    let (count, to) = (all.len(), language.number(largest));
    let described = say!(
        language,
        "{count} places coloured from 0 to {to} {unit}",
        "точек: {count}, цвет от 0 до {to} {unit}"
    );
    svg(placed.bottom + 66.0, title, &described, &body)
}

/// Displacements before and after, each from its place.
#[must_use]
pub fn displacements(
    language: Language,
    title: &str,
    solid: Solid,
    all: &[Displacement],
    magnification: f64,
) -> Markup {
    let placed = solid.placed(0.12);
    let times = language.number(magnification);
    let strokes = |which: fn(&Displacement) -> [f64; 3]| {
        all.iter().fold(String::new(), |mut path, d| {
            let by = which(d);
            let end = [0, 1, 2].map(|axis| d.at[axis] + by[axis]);
            let (from, to) = (placed.at(d.at), placed.at(end));
            path.push_str(&format!("M{} {}L{} {}", px(from.0), px(from.1), px(to.0), px(to.1)));
            path
        })
    };
    let feet = all.iter().fold(String::new(), |mut path, d| {
        let (x, y) = placed.at(d.at);
        path.push_str(&format!("M{} {}h0", px(x), px(y)));
        path
    });
    let body = html! {
        (before_and_after(language, LEFT))
        (text(LEFT + 170.0, 14.0, "m", &say!(language, "drawn {times} times their size", "увеличение {times}\u{d7}")))
        (placed.edges(false))
        path class="line s1" d=(strokes(|d| d.before)) {}
        path class="line s0" style="stroke-width:2" d=(strokes(|d| d.after)) {}
        path class="dots s3" style="stroke-width:2" d=(feet) {}
        (placed.edges(true))
        (placed.labels(language))
    };
    let count = all.len();
    let described = say!(
        language,
        "{count} errors drawn {times} times their size",
        "погрешностей: {count}, увеличение {times}\u{d7}"
    );
    svg(placed.bottom + 40.0, title, &described, &body)
}

/// A path coloured by an amount, stretch by stretch.
#[must_use]
pub fn path(
    language: Language,
    title: &str,
    solid: Solid,
    all: &[Stretch],
    largest: f64,
    unit: &str,
) -> Markup {
    let placed = solid.placed(0.04);
    let body = html! {
        (placed.edges(false))
        (placed.edges(true))
        // Below the colours, so that dark ones are seen in the dark and bright ones in the light.
        path class="casing" d=(all.iter().map(|s| way(&placed, &s.places)).collect::<String>()) {}
        @for stretch in all {
            path class={ "path v" (cells::shade(stretch.value, largest)) } d=(way(&placed, &stretch.places)) {}
        }
        (placed.labels(language))
        (key(language, placed.bottom + 34.0, largest, unit))
    };
    let (count, to) = (all.len(), language.number(largest));
    let described = say!(
        language,
        "{count} stretches coloured from 0 to {to} {unit}",
        "участков: {count}, цвет от 0 до {to} {unit}"
    );
    svg(placed.bottom + 66.0, title, &described, &body)
}

/// A path in pieces, with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// Classes of its sign in the legend, and of its lines.
    pub class: (&'static str, &'static str),
    /// What it is.
    pub words: String,
    /// Places that follow one another.
    pub pieces: Vec<Vec<[f64; 3]>>,
}

/// Paths beside one another, the last on top.
#[must_use]
pub fn ways(language: Language, title: &str, solid: Solid, all: &[Way]) -> Markup {
    let placed = solid.placed(0.08);
    let names: Vec<(&str, &str)> = all.iter().map(|way| (way.class.0, way.words.as_str())).collect();
    let body = html! {
        (legend(LEFT, 14.0, &names))
        (placed.edges(false))
        (placed.edges(true))
        @for one in all {
            path class={ "path " (one.class.1) } d=(one.pieces.iter().map(|piece| way(&placed, piece)).collect::<String>()) {}
        }
        (placed.labels(language))
    };
    let described: Vec<&str> = names.iter().map(|(_, words)| *words).collect();
    svg(placed.bottom + 40.0, title, &described.join(", "), &body)
}

fn way(placed: &Placed, places: &[[f64; 3]]) -> String {
    places.iter().fold(String::new(), |mut path, place| {
        let (x, y) = placed.at(*place);
        path.push(if path.is_empty() { 'M' } else { 'L' });
        path.push_str(&format!("{} {}", px(x), px(y)));
        path
    })
}
