//! Decimal numbers as integers of a step.

/// A decimal number exactly as written: `mantissa × 10^-decimals`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decimal {
    /// All digits as one signed integer.
    pub mantissa: i64,
    /// How many of them stand behind the point.
    pub decimals: u8,
}

const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

impl Decimal {
    /// The nearest `f64`.
    ///
    /// Correctly rounded while the mantissa is below 2^53 and there are at most 22 decimals: both
    /// operands of the division are exact then. `nc-syntax` refuses longer numbers.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        self.mantissa as f64 / POWERS[usize::from(self.decimals.min(22))]
    }
}

/// How a number is spelt: the habits of the file it goes into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spelling {
    /// Write all decimals of the step, or drop trailing zeros.
    pub trailing_zeros: bool,
    /// `10.` rather than `10` when no decimals remain.
    pub trailing_point: bool,
    /// `0.5` rather than `.5`.
    pub leading_zero: bool,
    /// `+0.5` rather than `0.5`.
    pub plus: bool,
}

impl Spelling {
    /// `0.500`, `-12.000`: what most posts write.
    pub const FIXED: Self =
        Self { trailing_zeros: true, trailing_point: true, leading_zero: true, plus: false };
}

/// Nearest whole number of steps, ties away from zero.
///
/// `per_unit` is the number of steps in one unit (1000 for a step of 0.001 mm): a whole number, so
/// that the only rounding is this one. `None` where the result does not fit 53 bits or is not a number.
#[must_use]
pub fn counts(value: f64, per_unit: f64) -> Option<i64> {
    let scaled = (value * per_unit).round();
    (scaled.abs() < 9.007_199_254_740_992e15).then_some(scaled as i64)
}

/// Nearest whole number, ties away from zero: `value.round() as i64`, without a call where the processor has no such
/// instruction.
#[must_use]
#[inline]
pub fn round(value: f64) -> i64 {
    /// 2⁵²: from here on every number is whole.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    if value.abs() < WHOLE {
        let whole = value as i64;
        let rest = value - whole as f64;
        whole + i64::from(rest >= 0.5) - i64::from(rest <= -0.5)
    } else {
        value.round() as i64
    }
}

/// Nearest whole number, ties away from zero: [`round`] without a branch, for several numbers side by side.
///
/// `value` is below 2⁵¹.
#[must_use]
#[inline]
pub fn nearest_whole(value: f64) -> f64 {
    /// Beside it no fraction has room: what is added to it is rounded, ties to the even number.
    const ROUNDS: f64 = 6_755_399_441_055_744.0;
    let even = (value + ROUNDS) - ROUNDS;
    let rest = value - even;
    let up = if (rest >= 0.5) & (value > 0.0) { 1.0 } else { 0.0 };
    let down = if (rest <= -0.5) & (value < 0.0) { 1.0 } else { 0.0 };
    even + up - down
}

/// All numbers of two digits, one after the other.
const PAIRS: [u8; 200] = {
    let mut pairs = [0; 200];
    let mut at = 0;
    while at < 100 {
        pairs[2 * at] = b'0' + (at / 10) as u8;
        pairs[2 * at + 1] = b'0' + (at % 10) as u8;
        at += 1;
    }
    pairs
};

/// Room for a number's text.
const ROOM: usize = 40;
/// As much is copied at once, without a call; nearly every number is shorter.
const AT_ONCE: usize = 16;

/// Appends `counts × 10^-decimals` as text. Never writes an exponent or a negative zero.
#[inline]
pub fn write(out: &mut Vec<u8>, counts: i64, decimals: u8, spelling: Spelling) {
    // From the last digit to the sign, then out at once.
    let mut text = [b'0'; ROOM + AT_ONCE];
    let decimals = usize::from(decimals.min(18));
    let mut left = counts.unsigned_abs();
    let point = ROOM - decimals;
    let mut at = ROOM;
    while at >= point + 2 {
        let pair = 2 * (left % 100) as usize;
        left /= 100;
        at -= 2;
        [text[at], text[at + 1]] = [PAIRS[pair], PAIRS[pair + 1]];
    }
    if at > point {
        at -= 1;
        (left, text[at]) = (left / 10, b'0' + (left % 10) as u8);
    }
    let mut end = ROOM;
    if !spelling.trailing_zeros {
        while end > point && text[end - 1] == b'0' {
            end -= 1;
        }
    }
    let whole = end == point;
    if !whole || (spelling.trailing_point && (decimals > 0 || !spelling.trailing_zeros)) {
        at -= 1;
        text[at] = b'.';
    }
    // The point takes the place of a digit: from here on `at` is where the next one goes.
    if left > 0 || spelling.leading_zero || whole {
        while left >= 100 {
            let pair = 2 * (left % 100) as usize;
            left /= 100;
            at -= 2;
            [text[at], text[at + 1]] = [PAIRS[pair], PAIRS[pair + 1]];
        }
        let pair = 2 * left as usize;
        at -= 1;
        text[at] = PAIRS[pair + 1];
        if left >= 10 {
            at -= 1;
            text[at] = PAIRS[pair];
        }
    }
    if counts < 0 || spelling.plus {
        at -= 1;
        text[at] = if counts < 0 { b'-' } else { b'+' };
    }
    let length = end - at;
    if length <= AT_ONCE {
        let before = out.len();
        out.extend_from_slice(&text[at..at + AT_ONCE]);
        out.truncate(before + length);
    } else {
        out.extend_from_slice(&text[at..end]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(counts: i64, decimals: u8, spelling: Spelling) -> String {
        let mut out = Vec::new();
        write(&mut out, counts, decimals, spelling);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn spellings() {
        let fixed = Spelling::FIXED;
        let short = Spelling { trailing_zeros: false, ..fixed };
        assert_eq!(text(-12_500, 3, fixed), "-12.500");
        assert_eq!(text(0, 3, fixed), "0.000");
        assert_eq!(text(-5, 3, fixed), "-0.005");
        assert_eq!(text(10_000, 3, short), "10.");
        assert_eq!(text(10_000, 3, Spelling { trailing_point: false, ..short }), "10");
        assert_eq!(text(500, 3, Spelling { leading_zero: false, ..short }), ".5");
        assert_eq!(text(0, 3, Spelling { leading_zero: false, ..short }), "0.");
        assert_eq!(text(7, 0, Spelling { plus: true, trailing_point: false, ..fixed }), "+7");
        assert_eq!(text(i64::MIN, 18, fixed), "-9.223372036854775808");
    }

    #[test]
    fn counts_refuses_what_does_not_fit() {
        assert_eq!(counts(0.0005, 1000.0), Some(1));
        assert_eq!(counts(-0.0005, 1000.0), Some(-1));
        assert_eq!(counts(f64::NAN, 1000.0), None);
        assert_eq!(counts(1e14, 1000.0), None);
    }

    #[test]
    fn rounds_as_the_library_does_where_it_is_close() {
        let near =
            [0.0, 0.5, 1.0, 1.5, 2.5, 0.1, 1e6 + 0.5, 2f64.powi(51) + 0.5, 2f64.powi(52), 1e300, f64::NAN];
        for value in near.into_iter().flat_map(|v| [v.next_down(), v, v.next_up()]).flat_map(|v| [v, -v]) {
            assert_eq!(round(value), value.round() as i64, "{value}");
            if value.abs() < 2f64.powi(51) {
                assert_eq!(nearest_whole(value), value.round(), "{value}");
            }
        }
    }

    proptest! {
        #[test]
        fn rounds_as_the_library_does(value in prop_oneof![-1e7f64..1e7, (-20_000_000..20_000_000).prop_map(|halves| f64::from(halves) / 2.0)]) {
            prop_assert_eq!(round(value), value.round() as i64);
            prop_assert_eq!(nearest_whole(value), value.round());
        }

        #[test]
        fn written_numbers_read_back(counts in -1_000_000_000_000i64..1_000_000_000_000, decimals in 0u8..9,
                                     trailing_zeros: bool, trailing_point: bool, leading_zero: bool, plus: bool) {
            let written = text(counts, decimals, Spelling { trailing_zeros, trailing_point, leading_zero, plus });
            prop_assert!(!written.contains('e') && !written.starts_with("-0") || counts != 0);
            let value: f64 = written.parse().unwrap();
            prop_assert_eq!(value, Decimal { mantissa: counts, decimals }.to_f64());
        }
    }
}
