//! Numbers and names as results show them.

use diagnostic::{Text, both};
use machine_model::Vector;
use report::numbers::figures;

/// A number with fixed decimals, never a negative zero.
#[must_use]
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    if text.starts_with('-') && text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.')) {
        text[1..].to_owned()
    } else {
        text
    }
}

/// A number with at most so many decimals, without zeros at its end and without minus zero.
#[must_use]
pub fn short(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Micrometres with two decimals.
#[must_use]
pub fn um(mm: f64) -> String {
    fixed(mm * 1e3, 2)
}

/// A temperature.
#[must_use]
pub fn celsius(value: f64) -> Text {
    let value = figures(short(value, 2));
    both!("{value} \u{b0}C", "{value:#} \u{b0}C")
}

/// Three numbers, apart by blanks.
#[must_use]
pub fn triple(v: &Vector, decimals: usize) -> String {
    [v.x, v.y, v.z].map(|value| fixed(value, decimals)).join(" ")
}

/// A name on one line: control characters could act on a terminal.
#[must_use]
pub fn printable(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// Millimetres to a nanometre, for JSON.
#[must_use]
pub fn millimetres(v: &Vector) -> [f64; 3] {
    [v.x, v.y, v.z].map(|value| round(value, 6))
}

/// Micrometres, to a tenth of a nanometre.
#[must_use]
pub fn rounded_um(mm: f64) -> f64 {
    round(mm * 1e3, 4)
}

/// Decimals beyond the last that means something would only be rounding noise. Never a negative zero.
#[must_use]
pub fn round(value: f64, decimals: usize) -> f64 {
    format!("{value:.decimals$}").parse::<f64>().unwrap_or(value) + 0.0
}
