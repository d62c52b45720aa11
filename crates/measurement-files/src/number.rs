//! Decimal numbers with a point or with a comma.

/// What stands between the whole number and its decimals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mark {
    /// `1.5`
    Point,
    /// `1,5`
    Comma,
}

/// What a number says of the mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// No mark, or no number.
    Silent,
    /// `1.5`
    Point,
    /// `0,5`, `12,5`: a decimal comma.
    Comma,
    /// `1,234`: a decimal comma, or a mark between thousands.
    Either,
    /// `1,234.5`, `1 234,5`: marked thousands.
    Thousands,
}

impl Shape {
    pub(crate) fn of(cell: &str) -> Self {
        let digits = cell.trim_start_matches(['+', '-']);
        let is_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | 'e' | 'E' | '+' | '-');
        let spaces = |c: char| matches!(c, ' ' | '\u{a0}' | '\u{202f}' | '\'');
        if !digits.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | ',')) {
            return Self::Silent;
        }
        if digits.chars().all(|c| is_number(c) || spaces(c)) && digits.contains(spaces) {
            return Self::Thousands;
        }
        if !digits.chars().all(is_number) {
            return Self::Silent;
        }
        match (digits.matches('.').count(), digits.matches(',').count()) {
            (0, 0) => Self::Silent,
            (_, 0) => Self::Point,
            (0, 1) => {
                let (whole, decimals) = digits.split_once(',').unwrap_or_default();
                let is_group = (1..=3).contains(&whole.len()) && !whole.starts_with('0');
                if is_group && decimals.len() == 3 { Self::Either } else { Self::Comma }
            }
            _ => Self::Thousands,
        }
    }
}

impl Mark {
    /// The number; `None` where it is none, or infinite.
    pub(crate) fn number(self, cell: &str) -> Option<f64> {
        let number = match self {
            Self::Comma if cell.contains(',') => cell.replacen(',', ".", 1).parse::<f64>(),
            _ => cell.parse::<f64>(),
        };
        number.ok().filter(|value| value.is_finite())
    }
}
