//! All tests of the room in one program, linked once.

mod common;

mod arcs;
mod curves;
mod cycles;
mod evidence;
mod frames;
mod messages;
mod naming;
mod offset;
mod properties;
mod rules;
mod samples;
mod sinumerik;
mod swivel;
