//! All tests of the room in one program, linked once.

mod ballbar;
mod functions;
mod iso230_2;
mod lathe_causes;
mod measured_line;
mod rtest;
mod synthetic;
mod tracker;
mod turning;
mod undetectable;
