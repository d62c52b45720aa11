//! What a number without a point is.

use nc_syntax::Number;
use serde::Deserialize;
use units::decimal::Decimal;

/// What a number without a decimal point means for lengths.
///
/// ```
/// use nc_dialect::PointFree;
///
/// let meaning = |dialect| nc_dialect::builtin(dialect).unwrap().numbers.point_free;
/// assert_eq!((meaning("fanuc"), meaning("linuxcnc")), (PointFree::LeastIncrement, PointFree::Unit));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointFree {
    /// `X100` is 100 mm (calculator type, LinuxCNC).
    Unit,
    /// `X100` is 100 least increments (conventional type, IS-B).
    LeastIncrement,
}

/// How numbers are written and read.
///
/// ```
/// use nc_syntax::{Block, Reader};
///
/// let (text, mut block) = (b"X100 Y100.\n", Block::default());
/// let read = |dialect: &str, block: &mut Block<'static>| {
///     let dialect = nc_dialect::builtin(dialect).unwrap();
///     assert!(Reader::new(text, dialect).next(block));
///     [b'X', b'Y'].map(|axis| dialect.numbers.length(block.word(axis).unwrap().number().unwrap(), false).to_f64())
/// };
/// // A hundred steps of a micrometre on one control, a hundred millimetres on the other.
/// assert_eq!(read("fanuc", &mut block), [0.1, 100.0]);
/// assert_eq!(read("linuxcnc", &mut block), [100.0, 100.0]);
/// // Steps of an inch are ten-thousandths.
/// let hundred = block.word(b'X').unwrap().number().unwrap();
/// assert_eq!(nc_dialect::builtin("fanuc").unwrap().numbers.length(hundred, true).to_f64(), 0.01);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    /// Meaning of a length without a point.
    pub point_free: PointFree,
    /// Decimals of the least input increment in mm (3 for IS-B).
    pub least_increment_decimals_mm: u8,
    /// The same in inches (4 for IS-B).
    pub least_increment_decimals_inch: u8,
}

impl Numbers {
    /// A length word's value in the unit in force, exact.
    ///
    /// A number without a point counts least increments where [`PointFree::LeastIncrement`] says so. For
    /// lengths only (X Y Z I J K R Q…): F, S, P, H, A, B, C follow their own rules.
    #[must_use]
    pub fn length(&self, number: Number, inch: bool) -> Decimal {
        let Decimal { mantissa, decimals } = number.decimal;
        if number.has_point || self.point_free == PointFree::Unit {
            return number.decimal;
        }
        let step = if inch { self.least_increment_decimals_inch } else { self.least_increment_decimals_mm };
        Decimal { mantissa, decimals: decimals + step }
    }
}
