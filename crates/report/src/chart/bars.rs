//! Horizontal bars: amounts, what is taken off them, intervals.

use diagnostic::{Language, Text, both};
use maud::{Markup, html};

use super::{WIDTH, line, name, rect, svg, text, ticks_below};
use crate::numbers::{digits, number, percent};
use crate::scale::Scale;
use crate::text::{MICROMETRES, short};

/// A labelled amount.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// What it is.
    pub label: Text,
    /// How much.
    pub value: f64,
}

/// A labelled amount that is known between two ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// What it is.
    pub label: Text,
    /// What it is at least.
    pub low: f64,
    /// What it may be.
    pub high: f64,
    /// Drawn faintly: not significant.
    pub faint: bool,
}

/// A forecast with its interval, and what came of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Low end.
    pub low: f64,
    /// Best value.
    pub mid: f64,
    /// High end.
    pub high: f64,
    /// What was found, where it was tried.
    pub achieved: Option<f64>,
}

const LEFT: f64 = 200.0;
const RIGHT: f64 = WIDTH - 70.0;
const STEP: f64 = 24.0;
const BAR: f64 = 14.0;
const TOP: f64 = 8.0;

fn finite(value: f64) -> f64 {
    if value.is_finite() { value.max(0.0) } else { 0.0 }
}

fn scale_to(largest: f64) -> Scale {
    Scale::new((0.0, if largest > 0.0 { largest } else { 1.0 }), (LEFT, RIGHT))
}

/// Amounts from top to bottom: a faint bar for what remains at each step, a strong one for what the step took off.
/// `floor`: an amount below which nothing can go, with its name.
#[must_use]
pub fn waterfall(language: Language, title: &Text, bars: &[Bar], floor: Option<(f64, &Text)>) -> Markup {
    let values: Vec<f64> = bars.iter().map(|b| finite(b.value)).collect();
    let scale = scale_to(values.iter().copied().fold(floor.map_or(0.0, |f| finite(f.0)), f64::max));
    let bottom = TOP + STEP * bars.len() as f64;
    let described = bars.iter().map(|Bar { label, value }| {
        let value = number(*value);
        both!("{label} {value} {MICROMETRES}", "{label:#} {value:#} {MICROMETRES:#}")
    });
    let body = html! {
        (ticks_below(language, &scale, 6, TOP, bottom))
        (text(RIGHT + 8.0, bottom + 14.0, "m", MICROMETRES.in_language(language)))
        @for (at, bar) in bars.iter().enumerate() {
            @let y = TOP + STEP * at as f64 + 0.5 * (STEP - BAR);
            @let before = if at == 0 { values[at] } else { values[at - 1] };
            @let (low, high) = (values[at].min(before), values[at].max(before));
            (name(LEFT - 10.0, y + 11.0, "e", &short(bar.label.in_language(language), 30)))
            (rect(if at == 0 || values[at] > before { "gone" } else { "bar" }, (LEFT, y), scale.at(low) - LEFT, BAR))
            @if at > 0 {
                (rect(if values[at] > before { "gone" } else { "faint" }, (scale.at(low), y), scale.at(high) - scale.at(low), BAR))
            }
            (text(scale.at(high) + 6.0, y + 11.0, "", number(bar.value).in_language(language)))
        }
        @if let Some((value, name)) = floor {
            @let x = scale.at(finite(value));
            (line("floor", (x, TOP), (x, bottom)))
            (text(x, bottom + 28.0, "c", &format!("{} {}", name.in_language(language), number(value).in_language(language))))
        }
    };
    svg(language, bottom + 34.0, title, &Text::join(&described.collect::<Vec<_>>(), "; "), &body)
}

/// Shares between 0 and 1: a bar to the low end, a whisker from there to the high end.
#[must_use]
pub fn ranges(language: Language, title: &Text, all: &[Range]) -> Markup {
    let scale = Scale::new((0.0, 1.0), (LEFT, RIGHT));
    let bottom = TOP + STEP * all.len() as f64;
    let described = |r: &Range| {
        let (label, low, high) = (&r.label, percent(r.low), percent(r.high));
        both!("{label} {low} to {high}", "{label:#} от {low:#} до {high:#}")
    };
    let described: Vec<Text> = all.iter().map(described).collect();
    let body = html! {
        @for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
            (line("axis", (scale.at(share), TOP), (scale.at(share), bottom)))
            (text(scale.at(share), bottom + 14.0, "m c", percent(share).in_language(language)))
        }
        @for (at, range) in all.iter().enumerate() {
            @let y = TOP + STEP * at as f64 + 0.5 * (STEP - BAR);
            @let (low, high) = (scale.at(finite(range.low)), scale.at(finite(range.high)));
            @let middle = y + 0.5 * BAR;
            (name(LEFT - 10.0, y + 11.0, if range.faint { "e m" } else { "e" }, &short(range.label.in_language(language), 30)))
            (rect(if range.faint { "faint" } else { "bar" }, (LEFT, y), low - LEFT, BAR))
            @if range.high > range.low {
                (line("whisker", (low, middle), (high, middle)))
                (line("whisker", (high, middle - 4.0), (high, middle + 4.0)))
            }
            @let words = if range.high - range.low >= 0.005 {
                Text::join(&[digits(100.0 * range.low, 0), percent(range.high)], "\u{2013}")
            } else {
                percent(range.low)
            };
            (text(high + 8.0, y + 11.0, "", words.in_language(language)))
        }
    };
    svg(language, bottom + 22.0, title, &Text::join(&described, "; "), &body)
}

/// A forecast of a share and what was achieved, on one line from nothing to all.
#[must_use]
pub fn interval(language: Language, title: &Text, forecast: &Interval) -> Markup {
    let ends = [Some(forecast.low), forecast.achieved, Some(0.0)];
    let lowest = ends.into_iter().flatten().filter(|v| v.is_finite()).fold(0.0, f64::min).max(-1.0);
    let scale = Scale::new((lowest, 1.0), (LEFT, RIGHT));
    let (predicted, achieved) = (TOP + 10.0, TOP + 36.0);
    let [low, mid, high] = [forecast.low, forecast.mid, forecast.high].map(percent);
    let came = forecast.achieved.map_or(Text::EMPTY, |share| {
        let share = percent(share);
        both!(", achieved {share}", ", достигнуто {share:#}")
    });
    let described =
        both!("predicted {mid} ({low} to {high}){came}", "прогноз {mid:#} (от {low:#} до {high:#}){came:#}");
    let [predicted_said, achieved_said] =
        [both!("predicted", "прогноз"), both!("achieved on unseen points", "на новых точках")];
    let bottom = TOP + 52.0;
    let body = html! {
        @for (value, _) in scale.ticks(5, language) {
            (line("axis", (scale.at(value), TOP), (scale.at(value), bottom)))
            (text(scale.at(value), bottom + 14.0, "m c", percent(value).in_language(language)))
        }
        (text(LEFT - 10.0, predicted + 4.0, "e", predicted_said.in_language(language)))
        (rect("faint", (scale.at(forecast.low), predicted - 7.0), scale.at(forecast.high) - scale.at(forecast.low), BAR))
        (line("whisker", (scale.at(forecast.mid), predicted - 9.0), (scale.at(forecast.mid), predicted + 9.0)))
        (text(scale.at(forecast.high) + 6.0, predicted + 4.0, "", mid.in_language(language)))
        @if let Some(value) = forecast.achieved {
            (text(LEFT - 10.0, achieved + 4.0, "e", achieved_said.in_language(language)))
            (line("floor", (scale.at(value), predicted - 9.0), (scale.at(value), achieved + 9.0)))
            (rect("gone", (scale.at(value) - 4.0, achieved - 4.0), 8.0, 8.0))
            (text(scale.at(value) + 9.0, achieved + 4.0, "", percent(value).in_language(language)))
        }
    };
    svg(language, bottom + 22.0, title, &described, &body)
}
