//! Numbers of messages about files.

use diagnostic::Code;

/// A point file that cannot be used.
pub const POINTS: Code = Code(901);
/// A measurement file that cannot be read.
pub const UNREADABLE: Code = Code(910);
/// A column is missing, unknown, twice, or contradicts another.
pub const COLUMN: Code = Code(911);
/// A cell is not what its column says.
pub const CELL: Code = Code(912);
/// Numbers that cannot be in the unit of their column.
pub const UNIT: Code = Code(913);
/// Axes that do not fit.
pub const AXES: Code = Code(1101);
/// Runs or targets that are missing or unequal.
pub const RUNS: Code = Code(1104);
/// Too few data.
pub const OPEN: Code = Code(1105);
/// Something only the user can say.
pub const QUESTION: Code = Code(1106);
