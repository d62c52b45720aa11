//! All tests of the room in one program, linked once.

mod machines;
mod stan_s500;

mod effects;
mod engines;
mod published;
mod rigid_body;
mod second_order;
mod turning;
