//! Blocks to tool path motions.
//!
//! [`Interpreter::step`] takes one block of `nc-syntax` and says what it makes the axes do, as motions
//! of `toolpath` in axis commands, with the [`Context`] in which they happen. It checks the whole block,
//! then commits it: after an error the state is what it was before. What it cannot tell with certainty
//! it refuses, and names the word, the reason and the way out ([`codes`]).
//!
//! # Positions
//!
//! * The axes stand nowhere known at the start ([`Setup::start_mm`] may say otherwise), after G28, G30 and probe moves
//!   (the axes named; all where none is named), after M codes whose row says so (behind a tool change the setup may
//!   know better), after G53 under G91, and behind motions that block delete may skip. G53 under G90 makes its axes
//!   known.
//! * A rapid may start from and lead to partly unknown positions. A feed move, an arc, a cycle and an
//!   increment need the positions they start from.
//! * A change of work offset or tool length moves nothing: the axis commands stay, and the program's
//!   coordinates of the same place change.
//! * Rotary axes that the machine has are unknown until programmed; a block that turns only them is
//!   [`Motion::Uncorrected`](toolpath::Motion::Uncorrected), and its linear axes stay where they are. They
//!   may turn together with linear axes at rapid, not at feed rate.
//!
//! # Blocks
//!
//! * Codes that set something are executed before the motion of their block, in whatever order they
//!   stand. Two codes of one modal group, or one letter twice, are refused; G80 may stand beside the
//!   code that follows it.
//! * Axis words belong to the code that takes them: a dwell's X is a time, G28's an intermediate point.
//!   Two takers in one block are refused.
//! * I, J, K that are missing are 0, but an arc without any and without R is refused: neither is modal.
//! * A cycle makes a hole in each block that has an axis word or R, none for F, S, M or P alone, none for
//!   K0 or L0. Its initial level is the normal axis where the series of cycles began.
//! * `/`: see the module `delete`: blocks of one switch behind each other are executed all or skipped all; settings
//!   that would differ behind them are refused, positions are forgotten.
//! * Words no code here asks for (S, T, D, E, unknown M) pass; unknown M codes are counted ([`Evidence`]). What they
//!   mean for the part: [`process`]. Unknown G codes, variables, flow and bracket commands are refused.
//! * The first `%` opens the program, the next one, M2 or M30 ends it; nothing after that is looked at.

mod alike;
mod arc;
mod brackets;
mod call;
mod circular;
pub mod codes;
mod context;
mod curves;
mod cycle;
mod delete;
mod direction;
mod environment;
mod evidence;
mod feed;
mod frame_state;
mod frames;
mod interpreter;
pub mod modal;
mod motion;
mod moved;
mod naming;
mod offset;
mod path_control;
mod plain;
mod position;
pub mod process;
mod refusals;
mod settings;
mod setup;
mod swivel;
mod tilted;
mod tip;
mod tool_length;
mod transform;
mod turning;
mod under_way;
mod words;
mod work_offset;

pub use alike::looks_like;
pub use context::Context;
pub use direction::DirectionWords;
pub use environment::Owner;
pub use evidence::{Evidence, Finding, Place, Questions};
pub use interpreter::{Interpreter, Step};
pub use modal::{Compensation, LastFeed, Modal, PathControl, ToolLength, Units, WorkOffset};
pub use moved::CurvePart;
pub use plain::{PlainEnd, PlainFeeds};
pub use setup::{AfterChange, BetweenVectors, Setup, TipControl};
pub use under_way::Offset;
pub use work_offset::name_of as work_offset_name;
