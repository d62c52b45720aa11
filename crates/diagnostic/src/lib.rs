//! What went wrong, and where.
//!
//! One type for every message of the product. A diagnostic knows a byte range of the text it speaks
//! of, never a file name, line or column: those are found where the message is printed (`vpost`).
//! The list of codes with cause and remedy is `docs/diagnostics.md`.

mod closest;
mod edit;
mod entry;
mod language;
mod message;
mod others;
mod refusal;
mod speaks;
mod text;

pub use closest::closest;
pub use edit::Edit;
pub use entry::Entry;
pub use language::{Language, russian_plural};
pub use message::{Code, Diagnostic, Severity, WayOut};
pub use others::{of_system, of_toml};
pub use refusal::Refusal;
pub use speaks::Speaks;
pub use text::Text;
