//! All tests of the room in one program, linked once.

mod common;

mod one_block;
mod properties;
mod provenance;
mod samples;
mod several_pieces;
