//! All tests of the room in one program, linked once.

mod control;

mod jump;
mod orientation;
mod path_promise;
mod play;
mod rotary_play;
mod short_line;
mod turning;
