//! The mode in which the control keeps to the path, and how a dialect says it.

use nc_dialect::{Dialect, Keeps, PathCode, PathKey};
use nc_syntax::GCode;
use units::decimal::Decimal;

use crate::words::word;

/// Of the distances that are written, millimetres or inches.
const DECIMALS: u8 = 6;

/// What the output tells the control of keeping to the path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PathMode {
    /// What the program says.
    #[default]
    AsPosted,
    /// On the path, with exact stops.
    Exact,
    /// So near, mm.
    Within(f64),
}

impl PathMode {
    /// How much of the tolerance is the control's, mm.
    #[must_use]
    pub const fn share_mm(self) -> f64 {
        if let Self::Within(mm) = self { mm } else { 0.0 }
    }

    /// How far the control may leave the path, mm.
    pub(crate) const fn most_mm(self) -> f64 {
        match self {
            Self::AsPosted => f64::INFINITY,
            Self::Exact => 0.0,
            Self::Within(mm) => mm,
        }
    }

    /// The block that says it in a unit of so many mm, and how far the control leaves the path behind it, mm; `None` where the
    /// dialect has no words for it.
    #[must_use]
    pub fn block(self, dialect: &Dialect, unit_mm: f64) -> Option<(String, f64)> {
        match self {
            Self::AsPosted => None,
            Self::Exact => exact(dialect).map(|code| (code.to_string(), 0.0)),
            Self::Within(mm) => dialect.path_control.iter().find_map(|row| match row {
                PathCode { key: PathKey::Code(code), keeps: Keeps::Words(letters) } => {
                    let steps = f64::from(10_u32.pow(DECIMALS.into()));
                    let counts = (mm / unit_mm / letters.len() as f64 * steps).floor();
                    let number = Decimal { mantissa: counts as i64, decimals: DECIMALS };
                    let words = letters.iter().map(|letter| format!(" {}", word(*letter, number)));
                    let block = words.fold(code.to_string(), |block, word| block + &word);
                    let off_mm = counts / steps * unit_mm * letters.len() as f64;
                    (counts > 0.0).then_some((block, off_mm))
                }
                _ => None,
            }),
        }
    }
}

/// The code by which the control keeps to the path.
pub(crate) fn exact(dialect: &Dialect) -> Option<GCode> {
    dialect.path_control.iter().find_map(|row| match row {
        PathCode { key: PathKey::Code(code), keeps: Keeps::Exact } => Some(*code),
        _ => None,
    })
}
