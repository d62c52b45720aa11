//! People's tables and instrument files: bytes in, values with places out.
//!
//! One way for all of them: bytes → text ([`decoded`]: UTF-8, UTF-16, Windows-1251, CP866) → cells with places (comments,
//! quotes, the separator found) → columns by the registry (name, unit, kind, plausible range; headers as people write
//! them) → the decimal mark found → numbers in the unit that a column's key ends with. What two readings are possible of
//! is refused. A kind of file is a list of keys, [`Kind`], and what is made of its rows.
//!
//! No files, no clocks, no messages to a terminal: a [`Refusal`] knows its place and what to write instead.
//!
//! ```
//! use diagnostic::Text;
//! use measurement_files::{Codes, Kind, Sheet, codes};
//!
//! let kind = Kind {
//!     columns: "run x_mm dx_um",
//!     expected: Text::pair("expected: run,x_mm,dx_um", "ожидалось: run,x_mm,dx_um"),
//!     passes_over: None,
//!     may_be_empty: false,
//!     codes: Codes::all(codes::UNREADABLE),
//! };
//! // As a spreadsheet saves it where the comma is the decimal mark.
//! let sheet = Sheet::read("a.csv", "Серия;X, мм;dx [um]\na;12,5;-0,3\n".as_bytes(), &kind, None).expect("a table");
//! let row = sheet.row(0).expect("a row");
//! assert_eq!((row.number("x_mm"), row.number("dx_um")), (Ok(Some(12.5)), Ok(Some(-0.3))));
//!
//! let refusal = Sheet::read("a.csv", b"run;x_mm;dx_um\na;12,5;-0.3\n", &kind, None).expect_err("two marks");
//! assert_eq!(refusal.diagnostic.message.english(), "`12,5` has a comma where `-0.3` has a point");
//! ```

mod bar;
pub mod codes;
mod columns;
mod foreign;
mod header;
mod number;
mod points;
mod refusal;
pub mod series;
mod sheet;
mod sizes;
mod table;
mod text;
mod unit;

pub use bar::Bar;
pub use columns::Column;
pub use points::Points;
pub use refusal::{Codes, Refusal};
pub use sheet::{Kind, Row, Sheet};
pub use sizes::{OddSizes, micro};
pub use text::{Piece, decoded, numbered, utf8_or_1251};
pub use unit::{Quantity, Unit};
