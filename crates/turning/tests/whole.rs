//! All tests of the room in one program, linked once.

mod judge;
mod oracles;
