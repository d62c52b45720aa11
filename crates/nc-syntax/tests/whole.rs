//! All tests of the room in one program, linked once.

mod common;

mod hostile;
mod plain;
mod reading;
