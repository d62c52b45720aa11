//! Machine descriptions as values: TOML and CSV in, [`machine_model`] inputs out.
//!
//! The format is the contract's `format = 1`. Files are read by a function the caller gives; errors know
//! the file and the bytes they speak of. What a column or key means is said where it is read: [`load`].

mod axes;
mod control;
mod doubts;
mod effects;
mod error;
mod field;
mod format;
mod lathe;
mod load;
mod loader;
mod number;
mod profile;
mod program;
mod show;
mod tables;
mod toml_error;
mod tools;
mod touched;
mod write;
mod zeros;

pub use effects::EngineError;
pub use error::ProfileError;
pub use field::MeasuredField;
pub use load::load;
pub use loader::Read;
pub use profile::{
    AfterChange, BareLengths, Calibrated, CorrectionOptions, EffectEntry, Kinematics, LatheParts, LeftAlone,
    MeasuringFrame, Nose, Outside, Profile, ProgramRules,
};
pub use show::{plus_turns, schema};
pub use tables::ErrorRows;
pub use write::{ProfileText, rename_tables};
pub use zeros::{Found, TouchPlace, TouchedBy, ZeroFound};
