//! What a control's words mean: grammar tables as values.
//!
//! A dialect is a file in `grammars/`: how numbers and comments are written, what each code does, what the
//! control takes back. [`load`] reads such a text and checks it; [`builtin`] gives those that are shipped.
//! `docs/dialects.md` explains every field and lists every code of every shipped dialect ([`rows`]) with the
//! test that proves it.

mod action;
mod assumptions;
mod checks;
mod control;
mod describe;
mod inherited;
mod load;
mod russian;
mod shipped;
mod table;
mod texts;

pub use action::{action_name, action_named, action_names};
pub use assumptions::assumption;
pub use control::{
    Action, Called, CodeEntry, Codes, Command, ControlCall, CornerForm, CurveCode, CycleBack, CycleLevels,
    Dialect, Flow, FramePart, FrameRules, Keeps, LatheSign, LengthAfter, LengthAtChange, MCode, MOTION_GROUP,
    Numbers, OffsetL20, Output, PathCode, PathKey, PlaneCode, Pockets, PointFree, RefusedWord, RotaryFeed,
    Side, System, TWord, TipSwitch, Turning, TurningCycle, WrittenCycles,
};
pub use describe::{Row, Rows, Treatment, rows, treatment};
pub use load::load;
pub use shipped::{builtin, builtin_names};
