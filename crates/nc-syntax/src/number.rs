//! The decimal grammar, by hand: no float parser of any library reads what a control reads.

use units::decimal::Decimal;

use crate::{Invalid, Number, Sign};

/// Largest mantissa plus one: 15 digits are exact in an `f64` and more than any control reads.
const MANTISSA_LIMIT: u64 = 1_000_000_000_000_000;
/// Most decimals; [`Decimal::to_f64`] is correctly rounded up to here.
const MOST_DECIMALS: usize = 22;

/// Space and tab: what may stand inside a number in dialects that say so.
const fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t')
}

/// First byte at or after `at` that is neither space nor tab.
pub(crate) fn skip_spaces(bytes: &[u8], mut at: usize) -> usize {
    while bytes.get(at).is_some_and(|byte| is_space(*byte)) {
        at += 1;
    }
    at
}

/// Reads a number that starts at `at` with a sign, a digit or a point; returns where it ends.
///
/// Grammar: `[+-] digits [. digits]` with at least one digit. Anything glued to it that would make a reader
/// see another number (`1E5`, `1.2.3`, `--1`, `1-2`, `1,5`) is [`Invalid::Number`], which then covers all of it.
pub(crate) fn number(bytes: &[u8], at: usize, spaces_inside: bool) -> (Result<Number, Invalid>, usize) {
    let mut next = at;
    let sign = match bytes.get(next) {
        Some(b'+') => Sign::Plus,
        Some(b'-') => Sign::Minus,
        _ => Sign::None,
    };
    if sign != Sign::None {
        next += 1;
        if spaces_inside {
            next = skip_spaces(bytes, next);
        }
    }
    let leading_digit = bytes.get(next).is_some_and(u8::is_ascii_digit);
    let (mut mantissa, mut digits, mut overflow) = (0_u64, 0_usize, false);
    // Digits that had been read when the point came.
    let mut point = None;
    // The first decimal that was left out rounds up: beyond 15 digits no control holds any.
    let mut rounds_up = None;
    loop {
        match bytes.get(next) {
            Some(byte @ b'0'..=b'9')
                if point.is_some_and(|before| {
                    mantissa >= MANTISSA_LIMIT / 10 || digits - before >= MOST_DECIMALS
                }) =>
            {
                rounds_up.get_or_insert(*byte >= b'5');
                next += 1;
            }
            Some(byte @ b'0'..=b'9') => {
                overflow |= mantissa >= MANTISSA_LIMIT;
                mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
                digits += 1;
                next += 1;
            }
            Some(b'.') if point.is_none() => {
                point = Some(digits);
                next += 1;
            }
            Some(b' ' | b'\t') if spaces_inside => {
                let after = skip_spaces(bytes, next);
                match bytes.get(after) {
                    Some(b'0'..=b'9') => next = after,
                    Some(b'.') if point.is_none() => next = after,
                    _ => break,
                }
            }
            _ => break,
        }
    }
    if digits == 0 || glued(bytes, next) {
        return (Err(Invalid::Number), end_of_garbage(bytes, next));
    }
    let mut decimals = point.map_or(0, |before| digits - before);
    mantissa += u64::from(rounds_up == Some(true));
    if mantissa == MANTISSA_LIMIT && decimals > 0 {
        (mantissa, decimals) = (mantissa / 10, decimals - 1);
    }
    if overflow || mantissa >= MANTISSA_LIMIT {
        return (Err(Invalid::TooManyDigits), next);
    }
    let magnitude = mantissa as i64;
    let mantissa = if sign == Sign::Minus { -magnitude } else { magnitude };
    let decimal = Decimal { mantissa, decimals: decimals as u8 };
    (Ok(Number { decimal, sign, has_point: point.is_some(), leading_digit }), next)
}

/// The same for the numbers nearly every word has: at most 15 digits, no spaces inside, a plain end.
///
/// `None` says nothing but that [`number`] must look. Half of the time of reading a program is spent here.
#[inline(always)]
pub(crate) fn common_number(bytes: &[u8], at: usize, spaces_inside: bool) -> Option<(Number, usize)> {
    let mut next = at;
    let sign = match *bytes.get(at)? {
        b'-' => Sign::Minus,
        b'+' => Sign::Plus,
        _ => Sign::None,
    };
    next += usize::from(sign != Sign::None);
    let whole = next;
    let mut mantissa = 0_i64;
    while let Some(digit) = digit_at(bytes, next) {
        mantissa = mantissa.wrapping_mul(10).wrapping_add(digit);
        next += 1;
    }
    let leading_digit = next > whole;
    let mut digits = next - whole;
    let mut decimals = 0;
    let has_point = bytes.get(next) == Some(&b'.');
    if has_point {
        next += 1;
        let part = next;
        while let Some(digit) = digit_at(bytes, next) {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(digit);
            next += 1;
        }
        decimals = next - part;
        digits += decimals;
    }
    if digits == 0 || digits > 15 {
        return None;
    }
    let starts_word = |byte: &u8| byte.is_ascii_alphabetic() && !byte.eq_ignore_ascii_case(&b'E');
    let plain_end = match bytes.get(next) {
        None | Some(b'\n' | b'\r') => true,
        Some(b' ' | b'\t') => {
            let goes_on = |byte: &u8| !byte.is_ascii_alphabetic() && !matches!(byte, b'(' | b';');
            !spaces_inside || !bytes.get(next + 1).is_some_and(goes_on)
        }
        Some(byte) => starts_word(byte) || matches!(byte, b'(' | b';'),
    };
    if !plain_end {
        return None;
    }
    let mantissa = if sign == Sign::Minus { -mantissa } else { mantissa };
    let decimal = Decimal { mantissa, decimals: decimals as u8 };
    Some((Number { decimal, sign, has_point, leading_digit }, next))
}

#[inline(always)]
fn digit_at(bytes: &[u8], at: usize) -> Option<i64> {
    let digit = bytes.get(at)?.wrapping_sub(b'0');
    (digit <= 9).then_some(i64::from(digit))
}

/// True where what stands at `at` continues the number before it in some reader's eyes.
fn glued(bytes: &[u8], at: usize) -> bool {
    let after = bytes.get(at + 1).copied().unwrap_or(0);
    match bytes.get(at) {
        Some(b'.' | b'+' | b'-') => true,
        Some(b'e' | b'E') => matches!(after, b'0'..=b'9' | b'+' | b'-' | b'.'),
        Some(b',') => after.is_ascii_digit(),
        _ => false,
    }
}

/// Where the unreadable number ends: everything that could belong to a number.
pub(crate) fn end_of_garbage(bytes: &[u8], at: usize) -> usize {
    let rest = bytes.get(at..).unwrap_or_default();
    let length = rest
        .iter()
        .take_while(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'+' | b'-' | b','))
        .count();
    at + length
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str, spaces: bool) -> Option<(i64, u8, usize)> {
        let (found, end) = number(text.as_bytes(), 0, spaces);
        found.ok().map(|n| (n.decimal.mantissa, n.decimal.decimals, end))
    }

    #[test]
    fn every_form_a_control_writes() {
        assert_eq!(read("10.", false), Some((10, 0, 3)));
        assert_eq!(read(".5", false), Some((5, 1, 2)));
        assert_eq!(read("+0.5", false), Some((5, 1, 4)));
        assert_eq!(read("-0.", false), Some((0, 0, 3)));
        assert_eq!(read("-.001Y", false), Some((-1, 3, 5)));
        assert_eq!(read("0001", false), Some((1, 0, 4)));
        assert_eq!(read("1 0 . 5 ", true), Some((105, 1, 7)));
        assert_eq!(read("1 0 . 5", false), Some((1, 0, 1)));
        assert_eq!(read("- 1\t2", true), Some((-12, 0, 5)));
        assert_eq!(read("1.5 .5", true), Some((15, 1, 3)));
    }

    #[test]
    fn what_no_control_writes() {
        for text in ["--1", "+-1", "1.2.3", "1..2", "1E5", "1e-7", "1-2", ".", "+", "-.", "1,5", "1.5E+3"] {
            let (found, end) = number(text.as_bytes(), 0, true);
            assert_eq!((found, end), (Err(Invalid::Number), text.len()), "{text}");
        }
    }

    #[test]
    fn fifteen_digits_and_no_more() {
        assert_eq!(read("999999999999999", false), Some((999_999_999_999_999, 0, 15)));
        assert_eq!(read("0000000000000000000000000000000.5", false), Some((5, 1, 33)));
        // Decimals that no control holds are rounded, once.
        assert_eq!(read("70.59035532994923", false), Some((705_903_553_299_492, 13, 17)));
        assert_eq!(read("0.1234567890123456", false), Some((123_456_789_012_346, 15, 18)));
        assert_eq!(read("0.99999999999999999", false), Some((100_000_000_000_000, 14, 19)));
        assert_eq!(read("0.00000000000000000000001", false), Some((0, 22, 25)));
        assert_eq!(read("999999999999999.9", false), None);
        for text in [
            "1000000000000000",
            "1000000000000000.5",
            "99999999999999999999999999999999",
            "9999999999999999.9",
        ] {
            assert_eq!(number(text.as_bytes(), 0, false).0, Err(Invalid::TooManyDigits), "{text}");
        }
    }

    proptest! {
        #[test]
        fn the_common_way_reads_what_the_long_way_reads(text in "[+\\-]{0,2}[0-9]{0,9}[.]{0,2}[0-9]{0,9}[ \tEeXy.,0-9+-]{0,3}", spaces: bool) {
            if let Some((found, end)) = common_number(text.as_bytes(), 0, spaces) {
                prop_assert_eq!((Ok(found), end), number(text.as_bytes(), 0, spaces));
            }
        }

        #[test]
        fn agrees_with_the_decimal_it_was_written_from(mantissa in 0..1_000_000_000_000_000_i64, decimals in 0..16_usize) {
            let digits = format!("{mantissa:0width$}", width = decimals + 1);
            let text = format!("{}.{}", &digits[..digits.len() - decimals], &digits[digits.len() - decimals..]);
            prop_assert_eq!(read(&text, false), Some((mantissa, decimals as u8, text.len())));
        }
    }
}
