//! A page in which the error moves: a path in space, its error magnified, causes switched on and off.
//!
//! Beside the scriptless reports of [`crate::page`]. The page is one file as well, makes no request and is the same for the
//! same results; it runs one script, its own, which its policy names by hash. Without WebGL, or without any script, it
//! shows the path as a drawing with the same words.
//!
//! * [`scene`]: what is drawn: places with their displacements, thinned by a bound that the page prints.
//! * `words`: every text of the page in both languages.
//! * `page`: the file.

mod encode;
mod page;
mod policy;
pub mod scene;
pub mod thinning;
mod words;

pub use page::{Figures, Kind, SCRIPT, Viewer, line_of};
pub use policy::source;
pub use words::cause;
