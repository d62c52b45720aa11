//! Which block numbers a program uses.

use nc_syntax::{Block, Number, PlainLine};

/// Largest N that is kept track of: one bit each, 12.5 MB at most.
const LARGEST_TRACKED: u32 = 99_999_999;

/// The N numbers of a program, so that inserted blocks get numbers that occur nowhere else.
///
/// Numbers are labels: they need not increase, but must not repeat. The block `N50` may use the numbers
/// between 50 and the next larger one of the program, and no other block may; so inserted numbers
/// depend on the program only, not on what was inserted before. Filled by one pass over the program.
#[derive(Clone, Debug, Default)]
pub struct BlockNumbers {
    /// Bit `n` is set where `Nn` occurs.
    used: Vec<u64>,
    /// A number occurs twice, or is no whole number: nothing can be said to be free.
    irregular: bool,
    largest: u32,
}

impl BlockNumbers {
    /// No numbers yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Notes the block's N word; true where it has one.
    pub fn see(&mut self, block: &Block<'_>) -> bool {
        let mut seen = false;
        for word in block.words().filter(|word| word.letter == b'N') {
            self.note(word.number());
            seen = true;
        }
        seen
    }

    /// [`BlockNumbers::see`] of a plain line.
    pub fn see_line(&mut self, line: &PlainLine<'_>) -> bool {
        let word = line.words().iter().find(|word| word.letter() == b'N');
        word.map(|word| self.note(Some(word.number()))).is_some()
    }

    fn note(&mut self, number: Option<Number>) {
        let whole = number.and_then(|number| u32::try_from(number.integer()?).ok());
        match whole.filter(|number| *number <= LARGEST_TRACKED) {
            Some(number) => self.set(number),
            None => self.irregular = true,
        }
    }

    fn set(&mut self, number: u32) {
        let (word, bit) = ((number / 64) as usize, 1_u64 << (number % 64));
        if self.used.len() <= word {
            self.used.resize(word + 1, 0);
        }
        self.irregular |= self.used[word] & bit != 0;
        self.used[word] |= bit;
        self.largest = self.largest.max(number);
    }

    /// First of `count` numbers in a row after `number` that occur nowhere; `None` where the gap to the
    /// next number is smaller, or `largest_allowed` would be passed, or the program repeats numbers.
    #[must_use]
    pub fn free_after(&self, number: u32, count: u32, largest_allowed: u32) -> Option<u32> {
        let first = number.checked_add(1)?;
        let last = number.checked_add(count)?;
        let free = |candidate: u32| {
            self.used.get((candidate / 64) as usize).is_none_or(|word| word & (1 << (candidate % 64)) == 0)
        };
        (!self.irregular && last <= largest_allowed && (first > self.largest || (first..=last).all(free)))
            .then_some(first)
    }
}
