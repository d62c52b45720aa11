//! From values to places on the drawing.

use diagnostic::Language;

use crate::numbers;

/// A linear scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Value at `from`.
    pub low: f64,
    /// Value at `to`.
    pub high: f64,
    /// Place of the lowest value, drawing units.
    pub from: f64,
    /// Place of the highest value.
    pub to: f64,
}

impl Scale {
    /// A scale over a range; a range of no width becomes one of width one about it.
    #[must_use]
    pub fn new((low, high): (f64, f64), (from, to): (f64, f64)) -> Self {
        let usable = low.is_finite() && high.is_finite() && high - low > 1e-12 * low.abs().max(high.abs());
        let (low, high) = match (usable, low.is_finite()) {
            (true, _) => (low, high),
            (false, true) => (low - 0.5, low + 0.5),
            (false, false) => (0.0, 1.0),
        };
        Self { low, high, from, to }
    }

    /// Place of a value; values beyond the ends stay at the ends.
    #[must_use]
    pub fn at(&self, value: f64) -> f64 {
        let share = ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0);
        self.from + share * (self.to - self.from)
    }

    /// Round values on the scale, about `count` of them, with their labels.
    #[must_use]
    pub fn ticks(&self, count: usize, language: Language) -> Vec<(f64, String)> {
        let step = nice((self.high - self.low) / count.max(1) as f64);
        let digits = digits(step);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        (first..=last)
            .map(|k| k as f64 * step)
            .map(|value| (value, numbers::digits(value, digits).in_language(language).to_owned()))
            .collect()
    }
}

/// The smallest of 1, 2, 5, 10 … that is not below a positive value, to a thousandth.
#[must_use]
pub fn nice(value: f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return 1.0;
    }
    // Decades by multiplication: a logarithm's last digits are the platform's.
    let mut decade = 1.0;
    while decade > value {
        decade /= 10.0;
    }
    while decade * 10.0 <= value {
        decade *= 10.0;
    }
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * decade)
        .find(|v| *v >= 0.999 * value)
        .unwrap_or(10.0 * decade)
}

fn digits(step: f64) -> usize {
    let mut digits = 0;
    let mut unit = step;
    while unit < 0.999 && digits < 6 {
        unit *= 10.0;
        digits += 1;
    }
    digits
}

/// A place as it is written: a tenth of a drawing unit is finer than any screen or paper.
#[must_use]
pub fn px(value: f64) -> String {
    let tenths = (10.0 * value).round() as i64;
    let (sign, size) = (if tenths < 0 { "-" } else { "" }, tenths.unsigned_abs());
    if size % 10 == 0 { format!("{sign}{}", size / 10) } else { format!("{sign}{}.{}", size / 10, size % 10) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        let labels = |low, high, count| -> Vec<String> {
            Scale::new((low, high), (0.0, 1.0))
                .ticks(count, Language::English)
                .into_iter()
                .map(|(_, l)| l)
                .collect()
        };
        assert_eq!(labels(0.0, 315.0, 4), ["0", "100", "200", "300"]);
        assert_eq!(labels(-0.3, 0.3, 3), ["\u{2212}0.2", "0.0", "0.2"]);
        assert_eq!(labels(5.0, 5.0, 2), ["4.5", "5.0", "5.5"]);
    }

    #[test]
    fn places() {
        let scale = Scale::new((0.0, 10.0), (100.0, 0.0));
        assert_eq!((scale.at(0.0), scale.at(10.0), scale.at(20.0)), (100.0, 0.0, 0.0));
        assert_eq!((px(-0.04), px(1.25), px(-3.0)), ("0".to_owned(), "1.3".to_owned(), "-3".to_owned()));
        assert_eq!((nice(0.03), nice(7.0), nice(10.0), nice(0.0)), (0.05, 10.0, 10.0, 1.0));
    }
}
