//! Results as one page.
//!
//! The building blocks that every report of vpost shares: text that cannot act ([`text`]), scales with readable ticks
//! ([`scale`]), drawings made of lines, dots, bars and cells ([`chart`]), what stands in a section ([`body`], with its
//! [`numbers`]), and the page that holds them ([`page`]).
//!
//! A page is one file: styles and drawings inside it, no script, no network, the same bytes for the same results. It can be
//! read in the light and in the dark, printed, walked through with the keyboard and read aloud; every drawing has its
//! numbers in a table behind it. The one page that runs a script is [`viewer`]'s, and its policy names it. Texts from files enter through [`maud`], which escapes them, after [`text::shown`] has made
//! what is invisible visible.

pub mod body;
pub mod chart;
pub mod numbers;
pub mod page;
pub mod scale;
mod table;
pub mod text;
pub mod viewer;

pub use page::STYLE;
