//! The main job: a program in, the corrected one out; and whether two programs cut alike.
//!
//! The one room where the text wing and the mathematics wing meet. `nc-syntax` reads blocks, `nc-program` says what they
//! make the axes do, `correction` says what they should be told instead, `nc-emit` writes it. Nothing flows back. No
//! files, clocks or messages: bytes and a [`Job`] in; bytes, [`Figures`] and diagnostics out, in one piece ([`correct`])
//! or in chunks on several threads ([`Source`]). [`check`] puts both programs through the machine.
//!
//! ```
//! use correction::{Options, Outside};
//! use machine_model::Models;
//! use rewrite::{Datums, Guards, Job, correct};
//!
//! let profile = include_str!("../../../machine-profiles/stan_s500.toml");
//! # let tables = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machine-profiles");
//! let profile = machine_profile::load(profile, &|table| std::fs::read(format!("{tables}/{table}"))).expect("a profile");
//! let engine = profile.engine(profile.correction.engine, &Default::default()).expect("an engine");
//! let job = Job {
//!     dialect: nc_dialect::builtin("fanuc").expect("it is shipped"),
//!     setup: &nc_program::Setup {
//!         work_offsets: vec![("G54".to_owned(), [140.0, 110.0, 20.0])],
//!         ..Default::default()
//!     },
//!     models: Models { axes: engine.path_model().expect("it corrects programs"), tip: None },
//!     datums: &Datums::default(),
//!     options: Options { tolerance_mm: 1e-3, accept_mm: 0.0, outside: Outside::Refuse, minimum_segment_mm: 0.0, orientation_rad: 5e-5, orientation: correction::Orientation::Tip },
//!     decimals_mm: [3; 3],
//!     rotary_steps: [(3, 1); 3],
//!     force: false,
//!     provenance: "AN EXAMPLE",
//!     guards: Guards::None,
//!     interpolator: toolpath::Interpolator { blending_mm: Some(0.0), ..Default::default() },
//!     path_mode: rewrite::PathMode::AsPosted,
//! };
//! let posted = b"G21 G90 G54\nG0 X10. Y10. Z30.\nG1 X90. F500.\nM30\n";
//! let corrected = correct::<Vec<diagnostic::Diagnostic>>(posted, &job, |line| line, |_| Ok(())).expect("inside the volume");
//! assert!(corrected.text != posted && corrected.figures.after.0 <= 1.9e-3);
//! assert!(String::from_utf8_lossy(&corrected.text).contains("(CORRECTED BY VPOST AN EXAMPLE)"));
//! ```

mod check;
mod chunks;
mod control;
mod curves;
mod cutter;
mod datum;
mod feed;
mod figures;
mod guards;
mod job;
mod keep_to_path;
mod lag;
mod large;
mod lengthless;
mod lowered;
mod nose;
mod notices;
mod pass;
mod path_mode;
mod plain;
mod restart;
mod sink;
mod state;
mod stream;
mod survey;
mod tally;
mod whole;
mod words;

pub use check::{Checked, Unreadable, check, courses};
pub use control::ControlPart;
pub use datum::{Datum, Datums, Touch, TouchTool, Touches, Zero};
pub use figures::{Corrected, Figures, Held};
pub use job::*;
pub use large::{Digest, Large, LargeEnd, Manner, Part, Source};
pub use path_mode::PathMode;
pub use restart::{Brought, NO_RESTART, Restarted, brought_about, changes_tool, restart};
pub use survey::all_refusals;
pub use whole::{correct, correct_plain, corrected_before};
