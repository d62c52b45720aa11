//! Deviations about a circle, magnified: the plot of a ball bar.

use diagnostic::{Language, Text, both};
use maud::{Markup, html};
use units::math;

use super::{legend, line, narrow, text};
use crate::numbers::digits;
use crate::scale::{nice, px};
use crate::text::MICROMETRES;

/// One closed or open curve.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Round {
    /// Class of the line: `round s0`.
    pub class: &'static str,
    /// Angle, radians, counted from the axis to the right to the one that points up, and deviation; angles rising.
    pub at: Vec<(f64, f64)>,
}

/// What is drawn about one circle.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Polar {
    /// Names of the axis to the right and the axis up.
    pub axes: [&'static str; 2],
    /// Radius of the circle, in the unit of the deviations.
    pub radius: f64,
    /// Curves.
    pub curves: Vec<Round>,
    /// Class of a square and what that colour means.
    pub keys: Vec<(&'static str, Text)>,
}

/// How many times larger than the circle its deviations are drawn, and the distance of the rings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnification {
    /// Deviations against the circle.
    pub times: f64,
    /// Between two rings, in the unit of the deviations.
    pub ring: f64,
}

/// Width and height of a drawing.
const SIDE: f64 = 360.0;
const MIDDLE: f64 = 0.5 * SIDE;
/// Where no deviation is.
const CIRCLE: f64 = 96.0;
/// Farthest that a deviation is drawn from there.
const REACH: f64 = 56.0;
/// Height of a line of the legend.
const KEY: f64 = 18.0;
/// Readings farther apart than this are not joined, radians: nothing was read between them.
const JOINED_RAD: f64 = 0.27;

impl Magnification {
    /// A round one by which the largest of these deviations is drawn as large as there is room for.
    #[must_use]
    pub fn of(largest: f64, radius: f64) -> Self {
        let largest = if largest.is_finite() && largest > 0.0 { largest } else { 1.0 };
        let most = (REACH / largest) * (radius / CIRCLE);
        let above = nice(most);
        let times = if above > 1.001 * most { nice(above / 2.5) } else { above };
        Self { times, ring: nice(0.3 * REACH * radius / (CIRCLE * times)) }
    }

    /// Drawing units for a deviation.
    fn px(self, deviation: f64, radius: f64) -> f64 {
        (self.times * deviation * CIRCLE / radius).clamp(-CIRCLE, MIDDLE - CIRCLE)
    }
}

/// Curves about the circle of no deviation, with rings at round deviations.
#[must_use]
pub fn polar(language: Language, title: &Text, described: &Text, p: &Polar, m: Magnification) -> Markup {
    let rings = rings(m, p.radius);
    let decimals =
        usize::from(m.ring < 0.999) + usize::from(m.ring < 0.0999) + usize::from(m.ring < 0.009_99);
    let out = MIDDLE - 18.0;
    let in_unit = both!("rings in {MICROMETRES}", "кольца, {MICROMETRES:#}");
    let body = html! {
        @for value in &rings {
            @let radius = CIRCLE + m.px(*value, p.radius);
            circle class=(if *value == 0.0 { "zero" } else { "axis" }) cx=(px(MIDDLE)) cy=(px(MIDDLE)) r=(px(radius)) {}
        }
        (line("axis", (MIDDLE - out, MIDDLE), (MIDDLE + out, MIDDLE)))
        (line("axis", (MIDDLE, MIDDLE - out), (MIDDLE, MIDDLE + out)))
        (text(SIDE - 4.0, MIDDLE + 4.0, "e", &format!("{}+", p.axes[0])))
        (text(MIDDLE, 12.0, "c", &format!("{}+", p.axes[1])))
        @for curve in &p.curves { path class=(curve.class) d=(curve_path(curve, m, p.radius)) {} }
        @for value in &rings {
            @let radius = CIRCLE + m.px(*value, p.radius);
            @let label = format!("{}{}", if *value > 0.0 { "+" } else { "" }, digits(*value, decimals).in_language(language));
            // Up to the left, where neither axis runs.
            (text(MIDDLE - 0.707 * radius, MIDDLE - 0.707 * radius + 4.0, "m c halo", &label))
        }
        (text(4.0, SIDE - 6.0, "m", in_unit.in_language(language)))
        @for (row, (class, words)) in p.keys.iter().enumerate() {
            (legend(language, 4.0, SIDE + 14.0 + KEY * row as f64, &[(class, words.clone())]))
        }
    };
    narrow(language, (SIDE, SIDE + KEY * p.keys.len() as f64), title, described, &body)
}

/// Inside and outside of no deviation, as far as deviations are drawn.
fn rings(m: Magnification, radius: f64) -> Vec<f64> {
    let there = |k: i32| f64::from(k) * m.ring;
    (-3..=3).map(there).filter(|v| (m.times * v * CIRCLE / radius).abs() <= REACH + 4.0).collect()
}

fn curve_path(curve: &Round, m: Magnification, radius: f64) -> String {
    let turn = std::f64::consts::TAU;
    let known: Vec<(f64, f64)> =
        curve.at.iter().copied().filter(|(a, v)| a.is_finite() && v.is_finite()).collect();
    let mut out = String::new();
    let mut last: Option<f64> = None;
    // Round to the first again, where it is near.
    let closing = known.first().map(|(a, v)| (a + turn, *v));
    for (angle, value) in known.iter().copied().chain(closing) {
        let joined = last.is_some_and(|last| angle - last <= JOINED_RAD);
        let is_end = angle >= turn && !joined;
        last = Some(angle);
        if is_end {
            continue;
        }
        let at = CIRCLE + m.px(value, radius);
        let (x, y) = (MIDDLE + at * math::cos(angle), MIDDLE - at * math::sin(angle));
        out.push_str(&format!("{}{} {}", if joined { "L" } else { "M" }, px(x), px(y)));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnification_is_round_and_leaves_room() {
        for largest in [0.3, 1.0, 4.7, 120.0] {
            let m = Magnification::of(largest, 100_000.0);
            assert!((nice(m.times) - m.times).abs() < 1e-9 * m.times, "{}", m.times);
            let drawn = m.px(largest, 100_000.0);
            assert!(drawn <= REACH + 1e-9 && drawn > 0.3 * REACH, "{largest}: {drawn}");
            assert!(rings(m, 100_000.0).len() >= 3, "{largest}");
        }
    }

    #[test]
    fn gaps_are_not_bridged() {
        let half = |count: usize| (0..count).map(|k| (0.1 * k as f64, 0.0)).collect::<Vec<_>>();
        let open = Round { class: "round s0", at: half(32) };
        let m = Magnification::of(1.0, 100.0);
        let path = curve_path(&open, m, 100.0);
        assert_eq!((path.matches('M').count(), path.matches('L').count()), (1, 31));
        let closed = curve_path(&Round { at: half(62), ..open }, m, 100.0);
        assert_eq!((closed.matches('M').count(), closed.matches('L').count()), (1, 62));
    }
}
