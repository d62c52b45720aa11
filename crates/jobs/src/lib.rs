//! Jobs: profile, dialect and options in, answers and messages out.
//!
//! What the command and the Python package share. A job reads the profile that it is given, the tables and the grammar
//! that the profile names, and the folders of subprograms; programs, points and measurements come as bytes, and nothing
//! is written or printed: messages are values that [`message::Wording`] makes text of.

pub mod at_line;
pub mod budget;
pub mod calibrate;
pub mod causes;
pub mod check;
pub mod conditions;
pub mod correct;
pub mod datums;
pub mod diagnose;
pub mod expand;
pub mod export;
pub mod figures;
pub mod flow;
pub mod lines;
pub mod map;
pub mod message;
pub mod options;
pub mod points;
pub mod predict;
pub mod profile;
pub mod restart;
pub mod settings;
mod setup;
pub mod shown;
pub mod solve;
mod stored;
pub mod summary;
pub mod turned;
pub mod values;
