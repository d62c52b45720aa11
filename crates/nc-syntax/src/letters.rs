//! Letters of words, as sets.

/// Capital letters as bits: `A` is bit 0.
///
/// ```
/// use nc_syntax::Letters;
///
/// const AXES: Letters = Letters::of(b"XYZ");
/// let block = Letters::of(b"GXZF");
/// assert_eq!(block.and(AXES).names(), "X, Z");
/// assert!(block.any(AXES) && !block.contains(b'Y'));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Letters(u32);

impl Letters {
    /// None.
    pub const NONE: Self = Self(0);

    /// These capitals.
    #[must_use]
    pub const fn of(letters: &[u8]) -> Self {
        let (mut bits, mut at) = (0, 0);
        while at < letters.len() {
            bits |= 1 << (letters[at] - b'A');
            at += 1;
        }
        Self(bits)
    }

    /// Those of X, Y, Z that are in, by index.
    #[must_use]
    pub fn of_axes(axes: [bool; 3]) -> Self {
        let letters = b"XYZ".iter().zip(axes).filter(|(_, is_in)| *is_in);
        letters.fold(Self::NONE, |all, (letter, _)| all.or(Self::of(&[*letter])))
    }

    /// As text: `X, Z`.
    #[must_use]
    pub fn names(self) -> String {
        let names = (b'A'..=b'Z').filter(|letter| self.contains(*letter));
        names.map(|letter| (letter as char).to_string()).collect::<Vec<_>>().join(", ")
    }

    /// This capital is one of them.
    #[must_use]
    pub const fn contains(self, letter: u8) -> bool {
        self.any(Self::of(&[letter]))
    }

    /// Some letter is in both.
    #[must_use]
    pub const fn any(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Those that are in both.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Those of either.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Those that are not in the other.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// The alphabetically first; `Z` where there is none.
    #[must_use]
    pub const fn first(self) -> u8 {
        let at = self.0.trailing_zeros();
        if at < 26 { b'A' + at as u8 } else { b'Z' }
    }

    /// How many they are.
    #[must_use]
    pub const fn count(self) -> u32 {
        self.0.count_ones()
    }

    /// There is none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }
}
