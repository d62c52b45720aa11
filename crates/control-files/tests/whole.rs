//! All tests of the room in one program, linked once.

mod any_text;
mod linuxcnc;
mod machines;
mod messages;
