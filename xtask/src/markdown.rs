//! Tables in Markdown.

/// A table; every row has as many cells as the head.
pub(crate) fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let line =
        |cells: &mut dyn Iterator<Item = &str>| format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "));
    let mut text = line(&mut head.iter().copied());
    text += &line(&mut head.iter().map(|_| "---"));
    for row in rows {
        text += &line(&mut row.iter().map(String::as_str));
    }
    text
}

/// A number with a fixed number of decimals; the sign of zero is not shown.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| b == b'0' || b == b'.') => digits.to_owned(),
        _ => text,
    }
}

/// Three components with a fixed number of decimals.
pub(crate) fn vector(v: &machine_model::Vector, decimals: usize) -> String {
    v.iter().map(|c| fixed(*c, decimals)).collect::<Vec<_>>().join(" ")
}

/// An upper bound as a power of ten: `≤ 1e-11`.
pub(crate) fn at_most(value: f64) -> String {
    let mut exponent = -16;
    let mut bound = 1e-16;
    while value > bound {
        exponent += 1;
        bound *= 10.0;
    }
    if value == 0.0 { "0".to_owned() } else { format!("≤ 1e{exponent}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_have_no_negative_zero() {
        assert_eq!(fixed(-0.0001, 3), "0.000");
        assert_eq!(fixed(-0.0006, 3), "-0.001");
        assert_eq!(at_most(3e-12), "≤ 1e-11");
        assert_eq!(at_most(0.0), "0");
    }
}
