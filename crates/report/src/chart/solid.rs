//! The machine's volume seen from a corner: places coloured by an amount, arrows, paths.

use diagnostic::{Language, Text, both};
use maud::{Markup, html};

use super::amounts::{Amounts, shade};
use super::{WIDTH, before_and_after, joined, legend, line, spotted, svg, text, with_head};
use crate::numbers::number;
use crate::scale::{Scale, px};

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
    right: f64,
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
        let right = shift.0 + right * scale;
        Placed { solid: self, scale, shift, bottom: TOP + height, right }
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

/// Where an edge of the box lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    /// Behind everything.
    Back,
    /// In front of it.
    Front,
}

/// An edge of the box along which an axis has its numbers.
struct Edge {
    axis: usize,
    /// Corners.
    from: usize,
    to: usize,
    /// The way outwards.
    out: (f64, f64),
    class: &'static str,
}

/// X along the lower left edge, Y along the lower right one, Z at the right.
const EDGES: [Edge; 3] = [
    Edge { axis: 0, from: 0b000, to: 0b001, out: (-0.6, 0.8), class: "m e halo" },
    Edge { axis: 1, from: 0b001, to: 0b011, out: (0.6, 0.8), class: "m halo" },
    Edge { axis: 2, from: 0b011, to: 0b111, out: (1.0, 0.0), class: "m halo" },
];

impl Placed {
    fn at(&self, place: [f64; 3]) -> (f64, f64) {
        let (right, up) = flat(place);
        (self.shift.0 + right * self.scale, self.shift.1 - up * self.scale)
    }

    /// Edges of the box.
    fn edges(&self, side: Side) -> Markup {
        // Seen from high X, low Y and above: hidden is the corner at low X, high Y, low Z.
        const HIDDEN: usize = 0b010;
        html! {
            @for from in 0..8usize {
                @for axis in 0..3usize {
                    @let to = from | 1 << axis;
                    @if to != from && (from == HIDDEN || to == HIDDEN) == (side == Side::Back) {
                        (line("zero", self.at(self.solid.corner(from)), self.at(self.solid.corner(to))))
                    }
                }
            }
        }
    }

    /// Names and ticks of the axes along the edges that the eye meets first.
    ///
    /// * `away` – how far what is drawn reaches out of the box, drawing units
    fn labels(&self, language: Language, away: f64) -> Markup {
        html! {
            @for Edge { axis, from, to, out, class } in EDGES {
                @let (a, b) = (self.at(self.solid.corner(from)), self.at(self.solid.corner(to)));
                @let here = |share: f64, far: f64| (a.0 + share * (b.0 - a.0) + far * out.0, a.1 + share * (b.1 - a.1) + far * out.1);
                @for (value, label) in Scale::new(self.solid.ranges[axis], (0.0, 1.0)).ticks(4, language) {
                    @let share = Scale::new(self.solid.ranges[axis], (0.0, 1.0)).at(value);
                    @let away = if axis == 2 { away } else { 0.0 };
                    @let place = here(share, away + 9.0);
                    (line("zero", here(share, 0.0), here(share, 5.0)))
                    (text(place.0, place.1 + if axis == 2 { 4.0 } else { 8.0 }, class, &label))
                }
                // Z has its name above its end: beside the numbers there is no room.
                @let place = if axis == 2 { (b.0 + 9.0, b.1 - 14.0) } else { here(0.5, 44.0) };
                (text(place.0, place.1 + 4.0, if axis == 0 { "e halo" } else { "halo" },
                    both!("{}, mm", "{}, мм", ["X", "Y", "Z"][axis]).in_language(language)))
            }
        }
    }
}

const LEFT: f64 = 46.0;
/// Numbers stand no farther from the box.
const FARTHEST: f64 = 40.0;

/// Places coloured by an amount, the near ones over the far ones.
#[must_use]
pub fn spots(language: Language, title: &Text, solid: Solid, all: &[Spot], amounts: &Amounts<'_>) -> Markup {
    let placed = solid.placed(0.04);
    let mut order: Vec<&Spot> = all.iter().collect();
    let depth = |s: &Spot| s.at[0] - s.at[1] + s.at[2];
    order.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
    let body = html! {
        (placed.edges(Side::Back))
        @for spot in order {
            @let (x, y) = placed.at(spot.at);
            circle class={ "spot " (amounts.class(spot.value)) } cx=(px(x)) cy=(px(y)) r="3.4" {}
        }
        (placed.edges(Side::Front))
        (placed.labels(language, 0.0))
        (amounts.key(language, (LEFT, placed.bottom + 34.0)))
    };
    let (count, to) = (all.len(), amounts.largest_said());
    let described = both!("{count} places coloured from 0 to {to}", "точек: {count}, цвет от 0 до {to:#}");
    svg(language, placed.bottom + 66.0, title, &described, &body)
}

/// Displacements before and after, each from its place.
#[must_use]
pub fn displacements(
    language: Language,
    title: &Text,
    solid: Solid,
    all: &[Displacement],
    magnification: f64,
) -> Markup {
    let placed = solid.placed(0.12);
    let times = number(magnification);
    let magnified = both!("drawn {times} times their size", "увеличение {times:#}\u{d7}");
    // To the right, where numbers stand.
    let right = |d: &Displacement, by: [f64; 3]| {
        flat(by).0.max(0.0) * placed.scale - (placed.right - placed.at(d.at).0)
    };
    let out =
        all.iter().flat_map(|d| [right(d, d.before), right(d, d.after)]).fold(0.0, f64::max).min(FARTHEST);
    let strokes = |which: fn(&Displacement) -> [f64; 3]| {
        all.iter().fold(String::new(), |path, d| {
            let by = which(d);
            let end = [0, 1, 2].map(|axis| d.at[axis] + by[axis]);
            path + &with_head(placed.at(d.at), placed.at(end))
        })
    };
    let body = html! {
        (before_and_after(language, LEFT))
        (text(LEFT + 170.0, 14.0, "m", magnified.in_language(language)))
        (placed.edges(Side::Back))
        path class="line s1" d=(strokes(|d| d.before)) {}
        path class="line s0" style="stroke-width:2" d=(strokes(|d| d.after)) {}
        path class="dots s3" style="stroke-width:2" d=(spotted(all.iter().map(|d| placed.at(d.at)))) {}
        (placed.edges(Side::Front))
        (placed.labels(language, out))
    };
    let count = all.len();
    let described = both!(
        "{count} errors drawn {times} times their size",
        "погрешностей: {count}, увеличение {times:#}\u{d7}"
    );
    svg(language, placed.bottom + 40.0, title, &described, &body)
}

/// A path coloured by an amount, stretch by stretch, and where it begins.
#[must_use]
pub fn path(
    language: Language,
    title: &Text,
    solid: Solid,
    all: &[Stretch],
    start: Option<[f64; 3]>,
    amounts: &Amounts<'_>,
) -> Markup {
    let placed = solid.placed(0.04);
    let begins = both!("start", "начало");
    let body = html! {
        (placed.edges(Side::Back))
        (placed.edges(Side::Front))
        // Below the colours, so that dark ones are seen in the dark and bright ones in the light.
        path class="casing" d=(all.iter().map(|s| way(&placed, &s.places)).collect::<String>()) {}
        @for stretch in all {
            path class={ "path v" (shade(stretch.value, amounts.largest)) } d=(way(&placed, &stretch.places)) {}
        }
        @if let Some(start) = start {
            @let (x, y) = placed.at(start);
            circle class="start" cx=(px(x)) cy=(px(y)) r="5" {}
            // Towards the middle: beside the box stand the names of its axes.
            @let (aside, class) = if x > 0.5 * WIDTH { (-9.0, "e halo") } else { (9.0, "halo") };
            (text(x + aside, y - 7.0, class, begins.in_language(language)))
        }
        (placed.labels(language, 0.0))
        (amounts.key(language, (LEFT, placed.bottom + 34.0)))
    };
    let (count, to) = (all.len(), amounts.largest_said());
    let described =
        both!("{count} stretches coloured from 0 to {to}", "участков: {count}, цвет от 0 до {to:#}");
    svg(language, placed.bottom + 66.0, title, &described, &body)
}

/// A path in pieces, with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// Classes of its sign in the legend, and of its lines.
    pub class: (&'static str, &'static str),
    /// What it is.
    pub words: Text,
    /// Places that follow one another.
    pub pieces: Vec<Vec<[f64; 3]>>,
}

/// Paths beside one another, the last on top.
#[must_use]
pub fn ways(language: Language, title: &Text, solid: Solid, all: &[Way]) -> Markup {
    let placed = solid.placed(0.08);
    let names: Vec<(&str, Text)> = all.iter().map(|way| (way.class.0, way.words.clone())).collect();
    let body = html! {
        (legend(language, LEFT, 14.0, &names))
        (placed.edges(Side::Back))
        (placed.edges(Side::Front))
        @for one in all {
            path class={ "path " (one.class.1) } d=(one.pieces.iter().map(|piece| way(&placed, piece)).collect::<String>()) {}
        }
        (placed.labels(language, 0.0))
    };
    let described = Text::join(all.iter().map(|way| &way.words), ", ");
    svg(language, placed.bottom + 40.0, title, &described, &body)
}

fn way(placed: &Placed, places: &[[f64; 3]]) -> String {
    joined(places.iter().map(|place| placed.at(*place)))
}
