//! All tests of the room in one program, linked once.

mod any_text;
mod errors;
mod field;
mod shipped;
